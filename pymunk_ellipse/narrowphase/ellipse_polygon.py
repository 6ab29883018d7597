"""Contact of an ellipse with a convex polygon or a segment, each with a radius."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, sqrt

from .common_normal import (
    DEPTH_TOLERANCE,
    MAX_JUMPS,
    ROUNDOFF,
    TINY,
    climb,
    comes_later,
    jump_past,
)
from .ellipse_ellipse import Contact, ellipse_ellipse, turned
from .frame import Frame

Vector = tuple[float, float]

FACE = -1

# Bound on a loop; so often a half turn can be halved.
MAX_HALVINGS = 60

# How much of a neighbour's length the normal may lead back along it where an end still counts:
# at a joint of a straight floor neither of the two segments may leave the contact to the other.
JOINT_TOLERANCE = 1e-9


def ellipse_polygon(
    ellipse: Frame, planes: Sequence[float], count: int, radius: float
) -> Contact:
    """Distance, contact normal and contact point of an ellipse and a convex polygon with a radius.

    planes holds four numbers for each of the polygon's count vertices, counterclockwise: the
    vertex and the outward normal of the face that ends there (Chipmunk's splitting planes).
    For what comes back see ellipse_ellipse.
    """
    return polygon_contact(ellipse, planes, count, radius)[0]


def polygon_contact(
    ellipse: Frame, planes: Sequence[float], count: int, radius: float
) -> tuple[Contact, int]:
    """The contact of an ellipse and a convex polygon, and the index of the vertex that is touched, or FACE.

    f has its largest value either along the normal of a face, with the ellipse's support point
    in front of it, or where it is stationary for a vertex, with no other vertex nearer along
    the normal. If the face with the largest f does not have the support point in front of it,
    f rises from there around the vertex at that end.
    """
    a, b, c, s, x, y = ellipse
    best = -1.0 / TINY
    face = 0
    nx = 0.0
    ny = 0.0
    along = 0.0
    across = 0.0
    support = 0.0
    for i in range(count):
        outward_x = planes[4 * i + 2]
        outward_y = planes[4 * i + 3]
        u = a * (c * outward_x + s * outward_y)
        v = b * (c * outward_y - s * outward_x)
        h = sqrt(u * u + v * v)
        dx = x - planes[4 * i]
        dy = y - planes[4 * i + 1]
        f = dx * outward_x + dy * outward_y - h - radius
        # A face between two equal vertices has no normal.
        if f > best and h > 0.0:
            best, face, nx, ny = f, i, -outward_x, -outward_y
            along, across, support = u, v, h
    if support == 0.0:
        corner = (radius, radius, 1.0, 0.0, planes[0], planes[1])
        return ellipse_ellipse(ellipse, corner, 0.0, 0.0), 0

    feature = FACE
    along *= -a / support
    across *= -b / support
    px = c * along - s * across
    py = s * along + c * across
    contact = (best, nx, ny, px, py)
    dx = planes[4 * face] - x
    dy = planes[4 * face + 1] - y
    past_end = (dy - py) * nx - (dx - px) * ny
    start = face - 1 if face > 0 else count - 1
    ex = planes[4 * face] - planes[4 * start]
    ey = planes[4 * face + 1] - planes[4 * start + 1]
    past_start = past_end + ex * ny - ey * nx
    if past_end > 0.0 or past_start < 0.0:
        feature = face if past_end > 0.0 else start
        contact = around_vertex(ellipse, planes, feature, radius, nx, ny)
        if not is_nearest(ellipse, planes, count, feature, contact):
            contact, feature = climb_polygon(ellipse, planes, count, radius, nx, ny)
    if contact[0] < -(b / a * b + radius):
        contact, feature = sweep_polygon(
            ellipse, planes, count, radius, contact, feature
        )
    return contact, feature


def climb_polygon(
    ellipse: Frame,
    planes: Sequence[float],
    count: int,
    radius: float,
    nx: float,
    ny: float,
) -> tuple[Contact, int]:
    """Turn n uphill to a maximum of f, around one vertex of the polygon's convex hull after the other.

    Only the places of the vertices count here, so that any number of them may lie on one edge
    or on one another, up to roundoff.
    """
    i = nearest_vertex(planes, count, nx, ny)
    contact, slope = along_normal(ellipse, vertex(planes, i), radius, nx, ny)
    sense = 1.0 if slope >= 0.0 else -1.0
    for _ in range(count):
        touched = around_vertex(ellipse, planes, i, radius, nx, ny)
        if is_nearest(ellipse, planes, count, i, touched):
            return touched, i
        # On the way another vertex came nearer. Turn to where the first one does.
        j = next_vertex(planes, count, i, nx, ny, sense)
        mx, my = normal_to_edge(planes, i, j, sense)
        contact, slope = along_normal(ellipse, vertex(planes, i), radius, mx, my)
        if sense * slope < 0.0:
            return climb_between(ellipse, planes, count, radius, i, nx, ny, mx, my), i
        nx = mx
        ny = my
        i = j
        _contact, slope = along_normal(ellipse, vertex(planes, i), radius, nx, ny)
        if sense * slope <= 0.0:
            break
    return contact, FACE


def climb_between(
    ellipse: Frame,
    planes: Sequence[float],
    count: int,
    radius: float,
    i: int,
    nx: float,
    ny: float,
    mx: float,
    my: float,
) -> Contact:
    """A maximum of f around vertex i, which is the nearest from n to m; f rises from both into the arc between.

    The arc is halved until the climb does not leave it.
    """
    contact, slope = along_normal(ellipse, vertex(planes, i), radius, nx, ny)
    sense = 1.0 if slope >= 0.0 else -1.0
    for _ in range(MAX_HALVINGS):
        middle_x = nx + mx - sense * (ny - my)
        middle_y = ny + my + sense * (nx - mx)
        length = sqrt(middle_x * middle_x + middle_y * middle_y)
        middle_x /= length
        middle_y /= length
        contact = around_vertex(ellipse, planes, i, radius, middle_x, middle_y)
        if is_nearest(ellipse, planes, count, i, contact):
            break
        contact, slope = along_normal(
            ellipse, vertex(planes, i), radius, middle_x, middle_y
        )
        if sense * slope > 0.0:
            nx = middle_x
            ny = middle_y
        else:
            mx = middle_x
            my = middle_y
    return contact


def sweep_polygon(
    ellipse: Frame,
    planes: Sequence[float],
    count: int,
    radius: float,
    best: Contact,
    feature: int,
) -> tuple[Contact, int]:
    """The best contact and its feature, after proving that no n has a larger f: what sweep does, for a polygon."""
    a, b, _c, _s, _x, _y = ellipse
    _f, nx, ny, px, py = best
    noise = ROUNDOFF * (a + radius)
    if best[0] >= -(b * b / (px * nx + py * ny) + radius):
        return best, feature
    slack = max(DEPTH_TOLERANCE * b, noise)
    turned_x = 1.0
    turned_y = 0.0
    for _ in range(MAX_JUMPS):
        i = nearest_vertex(planes, count, nx, ny)
        contact, slope = along_normal(ellipse, vertex(planes, i), radius, nx, ny)
        f, _nx, _ny, px, py = contact
        if f > best[0] + noise:
            best, feature = climb_polygon(ellipse, planes, count, radius, nx, ny)
        inscribed = b * b / (px * nx + py * ny) + radius
        cos, sin = jump_past(f, slope, inscribed, best[0] + slack)
        before_x = turned_x
        before_y = turned_y
        turned_x = cos * before_x - sin * before_y
        turned_y = sin * before_x + cos * before_y
        if best[0] > 0.0 or not comes_later(turned_x, turned_y, before_x, before_y):
            break
        nx, ny = cos * nx - sin * ny, sin * nx + cos * ny
    return best, feature


def ellipse_segment(
    ellipse: Frame,
    start: Vector,
    end: Vector,
    before: Vector,
    after: Vector,
    radius: float,
) -> Contact:
    """Distance, contact normal and contact point of an ellipse and a segment with a radius.

    before and after lead from the segment's start and end to the other ends of its neighbours,
    and are zero where it has none. An end that the ellipse touches from over its neighbour does
    not count (Chipmunk's rule for circles). Chipmunk has chosen this segment by the hull, which
    may touch a neighbour or another one further on, and may report none of those. So this one
    stands in for them: where the neighbour rises towards an ellipse that overlaps the segment,
    with its own line, which lies below the chain; else with the neighbour, and beyond the
    neighbour's other end with the neighbour's line.

    For the rest see ellipse_ellipse.
    """
    contact, feature = line_contact(ellipse, start, end, radius)
    if feature == FACE:
        return contact
    joint = start if feature == 0 else end
    tx, ty = before if feature == 0 else after
    distance, nx, ny, _px, _py = contact
    level = JOINT_TOLERANCE * sqrt(tx * tx + ty * ty)
    if nx * tx + ny * ty >= -level:
        return contact
    nx, ny = normal_to_line(ellipse, start, (end[0] - start[0], end[1] - start[1]))
    if distance <= 0.0 and nx * tx + ny * ty < -level:
        return along_normal(ellipse, joint, radius, nx, ny)[0]
    contact, feature = line_contact(
        ellipse, joint, (joint[0] + tx, joint[1] + ty), radius
    )
    if feature == 1:
        nx, ny = normal_to_line(ellipse, joint, (tx, ty))
        return along_normal(ellipse, joint, radius, nx, ny)[0]
    return contact


def line_contact(
    ellipse: Frame, start: Vector, end: Vector, radius: float
) -> tuple[Contact, int]:
    """The contact of an ellipse and a segment without neighbours: a polygon of two vertices, start and end."""
    nx, ny = perpendicular(end[0] - start[0], end[1] - start[1])
    planes = (start[0], start[1], -nx, -ny, end[0], end[1], nx, ny)
    return polygon_contact(ellipse, planes, 2, radius)


def normal_to_line(ellipse: Frame, point: Vector, along: Vector) -> Vector:
    """The unit normal from an ellipse's centre to a line through a point; zero for a line without direction."""
    nx, ny = perpendicular(along[0], along[1])
    if (point[0] - ellipse[4]) * nx + (point[1] - ellipse[5]) * ny < 0.0:
        return -nx, -ny
    return nx, ny


def perpendicular(x: float, y: float) -> Vector:
    """The unit vector a quarter turn clockwise from a vector; zero if that is zero."""
    length = sqrt(x * x + y * y)
    if length == 0.0:
        return 0.0, 0.0
    return y / length, -x / length


def nearest_vertex(planes: Sequence[float], count: int, nx: float, ny: float) -> int:
    """The vertex that is least far along n.

    Compares differences, which are exact where two vertices are the same up to roundoff.
    """
    nearest = 0
    for i in range(1, count):
        dx = planes[4 * i] - planes[4 * nearest]
        dy = planes[4 * i + 1] - planes[4 * nearest + 1]
        if dx * nx + dy * ny < 0.0:
            nearest = i
    return nearest


def is_nearest(
    ellipse: Frame, planes: Sequence[float], count: int, i: int, contact: Contact
) -> bool:
    """Whether no vertex is less far along the contact's normal than vertex i, by more than roundoff."""
    a, _b, _c, _s, x, y = ellipse
    _f, nx, ny, _px, _py = contact
    dx = planes[4 * i] - x
    dy = planes[4 * i + 1] - y
    roundoff = ROUNDOFF * (a + abs(x) + abs(y) + abs(dx) + abs(dy))
    least = dx * nx + dy * ny - roundoff
    nearest = True
    for k in range(count):
        far = (planes[4 * k] - x) * nx + (planes[4 * k + 1] - y) * ny
        nearest = nearest and far >= least
    return nearest


def next_vertex(
    planes: Sequence[float], count: int, i: int, nx: float, ny: float, sense: float
) -> int:
    """The vertex that comes nearest next after vertex i as n turns, counterclockwise for a sense of 1.

    Gift wrapping (R. A. Jarvis, "On the identification of the convex hull of a finite set of
    points in the plane", 1973).
    """
    following = i
    soon = False
    dx = 0.0
    dy = 0.0
    for k in range(count):
        ex = planes[4 * k] - planes[4 * i]
        ey = planes[4 * k + 1] - planes[4 * i + 1]
        if ex == 0.0 and ey == 0.0:
            continue
        # Less than a quarter turn away or more, so that of two on one line with vertex i the
        # one behind does not count.
        sooner = sense * (ex * ny - ey * nx) > 0.0
        if following == i or (sooner and not soon):
            better = True
        else:
            better = sooner == soon and sense * (ex * dy - ey * dx) > 0.0
        if better:
            following, soon, dx, dy = k, sooner, ex, ey
    return following


def normal_to_edge(
    planes: Sequence[float], i: int, j: int, sense: float
) -> tuple[float, float]:
    """The contact normal into the edge from vertex i to vertex j, which follows in the given sense of turning."""
    ex = planes[4 * j] - planes[4 * i]
    ey = planes[4 * j + 1] - planes[4 * i + 1]
    length = sense * sqrt(ex * ex + ey * ey)
    return -ey / length, ex / length


def vertex(planes: Sequence[float], i: int) -> Vector:
    """Where vertex i is."""
    return planes[4 * i], planes[4 * i + 1]


def nearest_face(planes: Sequence[float], count: int) -> float:
    """How far the nearest face of a polygon is from the mean of its vertices.

    >>> nearest_face((3.0, -1.0, 0.0, -1.0, 3.0, 1.0, 1.0, 0.0, -3.0, 1.0, 0.0, 1.0, -3.0, -1.0, -1.0, 0.0), 4)
    1.0
    """
    x = 0.0
    y = 0.0
    for i in range(count):
        px, py = vertex(planes, i)
        x += px / count
        y += py / count
    nearest = inf
    for i in range(count):
        px, py = vertex(planes, i)
        away = (px - x) * planes[4 * i + 2] + (py - y) * planes[4 * i + 3]
        nearest = min(nearest, away)
    return nearest


def along_normal(
    ellipse: Frame, point: Vector, radius: float, nx: float, ny: float
) -> tuple[Contact, float]:
    """The contact along the unit vector n with the plane through a point, and f' for that point."""
    a, b, c, s, x, y = ellipse
    u = a * (c * nx + s * ny)
    v = b * (c * ny - s * nx)
    h = sqrt(u * u + v * v)
    u *= a / h
    v *= b / h
    px = c * u - s * v
    py = s * u + c * v
    dx = point[0] - x
    dy = point[1] - y
    f = dx * nx + dy * ny - h - radius
    return (f, nx, ny, px, py), (dy - py) * nx - (dx - px) * ny


def around_vertex(
    ellipse: Frame, planes: Sequence[float], i: int, radius: float, nx: float, ny: float
) -> Contact:
    """The contact with vertex i alone, a circle of the given radius, uphill from n."""
    a, b, c, s, x, y = ellipse
    dx = planes[4 * i] - x
    dy = planes[4 * i + 1] - y
    pair = (a, b, radius, radius, 1.0, 0.0, c * dx + s * dy, c * dy - s * dx)
    return turned(climb(pair, c * nx + s * ny, c * ny - s * nx), c, s)
