"""Queries of an ellipse: its nearest point to a point, where a moving circle first touches it, its bounding box, and contacts to the last digit."""

from __future__ import annotations

from math import copysign, hypot, sqrt

from .common_normal import fitted_circles
from .ellipse_ellipse import Contact
from .placement import Frame

# Signed distance (negative inside), outward normal (x, y) and nearest point of the surface (x, y).
Nearest = tuple[float, float, float, float, float]

# Part of the segment before the hit, normal (x, y) and point of the surface (x, y).
Hit = tuple[float, float, float, float, float]

# Roundoff of a sum of two squares that should be one, and of a distance as a part of the lengths that enter it.
ROUNDOFF = 4e-16

# Bounds on the loops. Five steps are usual; 43 were seen for points near the centre of curvature
# of a sharp end, and 29 for circles that graze.
MAX_STEPS = 100

# Settling a contact changes its distance by less than this part of the longer semi-axis.
LARGEST_CHANGE = 1e-9

# From this many semi-axes away an ellipse is a point to double precision.
FAR = 1e100


def nearest_on_axes(a: float, b: float, x: float, y: float) -> Nearest:
    """The nearest point to (x, y) on the ellipse with semi-axes a >= b along x and y, centre at the origin.

    The nearest point lies in the point's own quadrant, where it is (a cos, b sin) with

        cos = (a/b)^2 (x/a) / (w + k)    sin = (y/b) / w    k = (a/b)^2 - 1

    and w > 0 such that cos^2 + sin^2 = 1 (D. Eberly, "Distance from a Point to an Ellipse").
    The sum falls as w grows, and the larger of the two w that make one of the squares equal to
    one is not too large. From there Newton's method on 1/sqrt(sum) = 1 climbs to w without
    passing it: that function is nearly straight (the secular equation of trust regions).

    Among nearest points on both sides of an axis, the one on the positive side is taken.
    """
    if abs(x) > FAR * a or abs(y) > FAR * a:
        scale = max(abs(x), abs(y))
        along_x = x / scale
        along_y = y / scale
        length = hypot(along_x, along_y)
        nx = along_x / length
        ny = along_y / length
        h = hypot(a * nx, b * ny)
        return hypot(x, y), nx, ny, a * (a * nx / h), b * (b * ny / h)

    k = (a - b) / b * ((a + b) / b)
    u = a / b * (abs(x) / b)
    v = abs(y) / b
    w = max(v, u - k)
    if w > 0.0:
        for _ in range(MAX_STEPS):
            cos = u / (w + k)
            sin = v / w
            total = cos * cos + sin * sin
            if total <= 1.0 + ROUNDOFF:
                break
            fall = cos * cos * (w / (w + k)) + sin * sin
            w += w * total * (sqrt(total) - 1.0) / fall
        root = sqrt(total)
        cos /= root
        sin /= root
    else:
        # On the long axis, between the centres of curvature of its ends.
        cos = u / k if k > 0.0 else 0.0
        sin = sqrt(1.0 - cos * cos)
    cos = copysign(cos, x)
    sin = copysign(sin, y)

    length = hypot(b * cos, a * sin)
    nx = b * cos / length
    ny = a * sin / length
    px = a * cos
    py = b * sin
    return (x - px) * nx + (y - py) * ny, nx, ny, px, py


def nearest_point(ellipse: Frame, x: float, y: float) -> Nearest:
    """Signed distance of the point (x, y) to an ellipse, with the normal and the nearest point of its surface.

    The distance is negative inside. The normal is the distance's gradient: it points from the
    nearest point to (x, y), or away from it inside, and is finite everywhere.

    >>> nearest_point((2.0, 1.0, 1.0, 0.0, 10.0, 0.0), 13.0, 0.0)
    (1.0, 1.0, 0.0, 12.0, 0.0)
    >>> nearest_point((2.0, 1.0, 1.0, 0.0, 10.0, 0.0), 10.0, 0.0)
    (-1.0, 0.0, 1.0, 10.0, 1.0)
    """
    a, b, c, s, cx, cy = ellipse
    dx = x - cx
    dy = y - cy
    distance, nx, ny, px, py = nearest_on_axes(a, b, c * dx + s * dy, c * dy - s * dx)
    return (
        distance,
        c * nx - s * ny,
        s * nx + c * ny,
        cx + c * px - s * py,
        cy + s * px + c * py,
    )


def segment_hit(
    ellipse: Frame,
    start_x: float,
    start_y: float,
    end_x: float,
    end_y: float,
    radius: float,
) -> Hit | None:
    """Where a circle of the given radius first touches an ellipse on its straight way from start to end; None if nowhere.

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
    length = hypot(dx, dy)
    ux = uy = 0.0
    if length > 0.0:
        dx /= length
        dy /= length
        ux = c * dx + s * dy
        uy = c * dy - s * dx

    # The circle around the ellipse, a little too large.
    reach = a + max(radius, 0.0)
    middle = -(x * ux + y * uy)
    along = min(max(middle, 0.0), length)
    roundoff = ROUNDOFF * (hypot(x, y) + length)
    if hypot(x + along * ux, y + along * uy) > 1.001 * reach + roundoff:
        return None

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
    if way is None or way > length:
        return None
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
) -> float | None:
    """How far it is from (x, y), outside an ellipse, to its surface in the unit direction (ux, uy); None if it is not met.

    Lengths along the ellipse's longer semi-axis are shortened to make it a circle of radius b.
    """
    flat = b / a
    x *= flat
    ux *= flat
    start = hypot(x, y)
    speed = hypot(ux, uy)
    towards = -(x * ux + y * uy)
    past = abs(x * uy - y * ux)
    if towards <= 0.0 or past > b * speed:
        return None
    half_chord = sqrt((b * speed - past) * (b * speed + past))
    return max(0.0, (start - b) * (start + b) / (towards + half_chord))


def way_to_offset(
    a: float, b: float, x: float, y: float, ux: float, uy: float, radius: float
) -> float | None:
    """How far it is from (x, y) in the unit direction (ux, uy) to where the ellipse is at the distance radius; None if nowhere.

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
            return None
        way -= left / slope
    return way


def half_extents(ellipse: Frame) -> tuple[float, float]:
    """Half the width and half the height of an ellipse's bounding box.

    >>> half_extents((2.0, 1.0, 0.0, 1.0, 7.0, 9.0))
    (1.0, 2.0)
    """
    a, b, c, s, _x, _y = ellipse
    return hypot(a * c, b * s), hypot(a * s, b * c)


def settled(ellipse: Frame, other: Frame, contact: Contact) -> Contact:
    """The contact of two ellipses with the last steps of Newton's method, which the climb leaves out.

    The climb ends when the distance is settled, whose error is the square of the normal's;
    after this the normal and the point are as exact. other may be a circle, or the round
    corner of a shape that is touched there. If they do not have this contact, it comes back as
    it was.
    """
    a1, b1, c1, s1, x1, y1 = ellipse
    a2, b2, c2, s2, x2, y2 = other
    dx = x2 - x1
    dy = y2 - y1
    c = c1 * c2 + s1 * s2
    s = c1 * s2 - s1 * c2
    pair = (a1, b1, a2, b2, c, s, c1 * dx + s1 * dy, c1 * dy - s1 * dx)
    distance, nx, ny, _px, _py, evaluations = contact
    mx = c1 * nx + s1 * ny
    my = c1 * ny - s1 * nx
    for _ in range(2):
        f, slope, between, mx, my, px, py = fitted_circles(pair, mx, my)
        turn = slope / between if between > 0.0 else 0.0
        mx, my = mx - turn * my, my + turn * mx
    f, _slope, _between, mx, my, px, py = fitted_circles(pair, mx, my)
    if not abs(f - distance) <= LARGEST_CHANGE * a1:
        return contact
    return (
        f,
        c1 * mx - s1 * my,
        s1 * mx + c1 * my,
        c1 * px - s1 * py,
        s1 * px + c1 * py,
        evaluations + 3,
    )
