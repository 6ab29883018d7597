"""Where a circle that moves along a straight line first touches an ellipse."""

from __future__ import annotations

from math import inf, sqrt

from .frame import Frame
from .nearest import ROUNDOFF, length_of, nearest_on_axes

# Part of the segment before the hit (above 1 where there is none), normal (x, y) and point of the surface (x, y).
Hit = tuple[float, float, float, float, float]

MISS: Hit = (inf, 0.0, 0.0, 0.0, 0.0)

# Bound on the loop. Five steps are usual; 29 were seen for circles that graze.
MAX_STEPS = 100


# A box that a segment crosses is taken to be smaller by this part of the coordinates.
BOX_ROUNDOFF = 1e-9


def crosses_box(
    left: float,
    bottom: float,
    right: float,
    top: float,
    start_x: float,
    start_y: float,
    end_x: float,
    end_y: float,
) -> bool:
    """Whether a segment crosses a box, by more than roundoff: no line parallel to a side, or to the segment, parts the two.

    >>> crosses_box(0.0, 0.0, 2.0, 1.0, -1.0, 0.5, 3.0, 0.5)
    True
    >>> crosses_box(0.0, 0.0, 2.0, 1.0, -1.0, 0.0, 1.0, 3.0)
    False
    """
    size = max(abs(left), abs(bottom), abs(right), abs(top))
    roundoff = BOX_ROUNDOFF * (size + abs(start_x) + abs(start_y))
    half_width = (right - left) / 2.0 - roundoff
    half_height = (top - bottom) / 2.0 - roundoff
    x = (right + left) / 2.0
    y = (top + bottom) / 2.0
    if max(start_x, end_x) < x - half_width or min(start_x, end_x) > x + half_width:
        return False
    if max(start_y, end_y) < y - half_height or min(start_y, end_y) > y + half_height:
        return False
    dx = end_x - start_x
    dy = end_y - start_y
    aside = abs(dx * (y - start_y) - dy * (x - start_x))
    return aside <= abs(dx) * half_height + abs(dy) * half_width


def segment_hit(
    ellipse: Frame,
    start_x: float,
    start_y: float,
    end_x: float,
    end_y: float,
    radius: float,
) -> Hit:
    """Where a circle of the given radius first touches an ellipse on its straight way from start to end; MISS if nowhere.

    Returns the part of the way that lies before (0 to 1), the ellipse's outward normal and the
    point of its surface that is touched. If the circle touches already at the start, the part
    is zero, the normal points from the nearest point of the surface to the start, into the
    ellipse then if the start is inside, and the point is the segment's end: so say all of
    pymunk's shapes.

    >>> segment_hit((2.0, 1.0, 1.0, 0.0, 0.0, 0.0), 8.0, 0.0, -2.0, 0.0, 1.0)
    (0.5, 1.0, 0.0, 2.0, 0.0)
    """
    a, b, c, s, cx, cy = ellipse
    dx = start_x - cx
    dy = start_y - cy
    x = c * dx + s * dy
    y = c * dy - s * dx
    dx = end_x - start_x
    dy = end_y - start_y
    length = length_of(dx, dy)
    ux = 0.0
    uy = 0.0
    if length > 0.0:
        dx /= length
        dy /= length
        ux = c * dx + s * dy
        uy = c * dy - s * dx

    # The circle around the ellipse, a little too large.
    reach = a + max(radius, 0.0)
    middle = -(x * ux + y * uy)
    along = min(max(middle, 0.0), length)
    roundoff = ROUNDOFF * (length_of(x, y) + length)
    if length_of(x + along * ux, y + along * uy) > 1.001 * reach + roundoff:
        return MISS

    distance, nx, ny, _px, _py = nearest_on_axes(a, b, x, y)
    if distance <= radius:
        if distance < 0.0:
            nx = -nx
            ny = -ny
        return 0.0, c * nx - s * ny, s * nx + c * ny, end_x, end_y

    if radius == 0.0:
        way = way_to_ellipse(a, b, x, y, ux, uy)
    else:
        way = way_to_offset(a, b, x, y, ux, uy, radius)
    if way > length:
        return MISS
    _distance, nx, ny, px, py = nearest_on_axes(a, b, x + way * ux, y + way * uy)
    return (
        way / length,
        c * nx - s * ny,
        s * nx + c * ny,
        cx + c * px - s * py,
        cy + s * px + c * py,
    )


def way_to_ellipse(
    a: float, b: float, x: float, y: float, ux: float, uy: float
) -> float:
    """How far it is from (x, y), outside an ellipse, to its surface in the unit direction (ux, uy); infinite if it is not met.

    Lengths along the ellipse's longer semi-axis are shortened to make it a circle of radius b.
    """
    flat = b / a
    x *= flat
    ux *= flat
    start = length_of(x, y)
    speed = sqrt(ux * ux + uy * uy)
    towards = -(x * ux + y * uy)
    past = abs(x * uy - y * ux)
    if towards <= 0.0 or past > b * speed:
        return inf
    half_chord = sqrt((b * speed - past) * (b * speed + past))
    return max(0.0, (start - b) * (start + b) / (towards + half_chord))


def way_to_offset(
    a: float, b: float, x: float, y: float, ux: float, uy: float, radius: float
) -> float:
    """How far it is from (x, y) in the unit direction (ux, uy) to where the ellipse is at the distance radius; infinite if nowhere.

    (x, y) must be farther away than that. Along a straight line the distance to a convex shape
    is a convex function, so Newton's method approaches the first such point from this side.
    """
    way = 0.0
    for _ in range(MAX_STEPS):
        distance, nx, ny, _px, _py = nearest_on_axes(a, b, x + way * ux, y + way * uy)
        left = distance - radius
        slope = nx * ux + ny * uy
        if left <= ROUNDOFF * (a + abs(radius)):
            break
        if slope >= 0.0:
            return inf
        way -= left / slope
    return way
