"""Contact of an ellipse with a convex polygon or a segment, each with a radius."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, pi, sin, sqrt

from .common_normal import (
    DEPTH_TOLERANCE,
    MAX_JUMPS,
    ROUNDOFF,
    TINY,
    climb,
    jump_past,
)
from .ellipse_ellipse import Contact, ellipse_ellipse, turned
from .frame import Frame

Vector = tuple[float, float]

FACE = -1

# The normal at a joint may be aside by this part of the way to the neighbour's end and still count, so
# that roundoff does not have both segments leave the contact to the other.
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
    if nx == 0.0 and ny == 0.0:
        corner = (radius, radius, 1.0, 0.0, planes[0], planes[1])
        return ellipse_ellipse(ellipse, corner, 0.0, 0.0), 0

    feature = FACE
    contact, past_end = along_normal(ellipse, planes, face, radius, nx, ny)
    start = (face - 1) % count
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
    """Turn n uphill to a maximum of f, which belongs to the vertex that is nearest along n, whichever that is.

    Vertices count by where they are alone, so that any number of them may lie on one edge, up
    to roundoff.
    """
    i = nearest_vertex(ellipse, planes, count, nx, ny)
    contact = around_vertex(ellipse, planes, i, radius, nx, ny)
    if is_nearest(ellipse, planes, count, i, contact):
        return contact, i

    # On the way another vertex came nearer. f rises for one and falls for the other along the
    # normal to both, if that is where the maximum is and nothing else is nearer there.
    _f, mx, my, _px, _py = contact
    j = nearest_vertex(ellipse, planes, count, mx, my)
    sense = 1.0 if nx * my >= ny * mx else -1.0
    for _ in range(count):
        ex = planes[4 * j] - planes[4 * i]
        ey = planes[4 * j + 1] - planes[4 * i + 1]
        length = sense * sqrt(ex * ex + ey * ey)
        nx = -ey / length
        ny = ex / length
        face, slope = along_normal(ellipse, planes, i, radius, nx, ny)
        if is_nearest(ellipse, planes, count, i, face):
            break
        k = nearest_vertex(ellipse, planes, count, nx, ny)
        _contact, slope = along_normal(ellipse, planes, k, radius, nx, ny)
        if sense * slope > 0.0:
            i = k
        else:
            j = k
    if sense * slope >= 0.0:
        i = j
        _contact, slope = along_normal(ellipse, planes, j, radius, nx, ny)
        if sense * slope <= 0.0:
            return face, FACE
    contact = around_vertex(ellipse, planes, i, radius, nx, ny)
    if is_nearest(ellipse, planes, count, i, contact):
        return contact, i
    return face, FACE


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
    swept = 0.0
    for _ in range(MAX_JUMPS):
        i = nearest_vertex(ellipse, planes, count, nx, ny)
        contact, slope = along_normal(ellipse, planes, i, radius, nx, ny)
        f, _nx, _ny, px, py = contact
        if f > best[0] + noise:
            better, i = climb_polygon(ellipse, planes, count, radius, nx, ny)
            if better[0] > best[0]:
                best = better
                feature = i
        inscribed = b * b / (px * nx + py * ny) + radius
        jump = jump_past(f, slope, inscribed, best[0] + slack)
        swept += jump
        if best[0] > 0.0 or swept >= 2.0 * pi:
            break
        nx, ny = nx * cos(jump) - ny * sin(jump), ny * cos(jump) + nx * sin(jump)
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
    not count (Chipmunk's rule for circles). But Chipmunk decides by the hull which segment of a
    chain it reports, and may report this one alone while the ellipse stands on another. So
    where an end does not count, what the chain does there is taken instead: the segment's own
    line, if the neighbour rises on the ellipse's side of it; else the neighbour, or its line
    where the chain is so dense that the neighbour's far end would be touched.

    For the rest see ellipse_ellipse.
    """
    contact, joint = line_contact(ellipse, start, end, radius)
    if joint == FACE:
        return contact
    tx, ty = before if joint == 0 else after
    least = JOINT_TOLERANCE * (abs(tx) + abs(ty))
    distance, nx, ny, _px, _py = contact
    if nx * tx + ny * ty >= -least:
        return contact

    mx, my = normal_to_line(ellipse, start, (end[0] - start[0], end[1] - start[1]))
    if distance <= 0.0 and mx * tx + my * ty < -least:
        return face_contact(ellipse, start, radius, mx, my)
    corner = start if joint == 0 else end
    far = (corner[0] + tx, corner[1] + ty)
    contact, feature = line_contact(ellipse, corner, far, radius)
    if feature == 1:
        mx, my = normal_to_line(ellipse, corner, (tx, ty))
        return face_contact(ellipse, corner, radius, mx, my)
    return contact


def normal_to_line(ellipse: Frame, start: Vector, along: Vector) -> Vector:
    """The unit normal from an ellipse's centre to the line through a point in a direction of any length."""
    tx, ty = along
    length = sqrt(tx * tx + ty * ty) + TINY
    nx = ty / length
    ny = -tx / length
    if (start[0] - ellipse[4]) * nx + (start[1] - ellipse[5]) * ny < 0.0:
        return -nx, -ny
    return nx, ny


def face_contact(
    ellipse: Frame, point: Vector, radius: float, nx: float, ny: float
) -> Contact:
    """The contact with the plane through a point that has the unit normal n, from the ellipse to it."""
    planes = (point[0], point[1])
    contact, _slope = along_normal(ellipse, planes, 0, radius, nx, ny)
    return contact


def line_contact(
    ellipse: Frame, start: Vector, end: Vector, radius: float
) -> tuple[Contact, int]:
    """The contact of an ellipse and a segment without neighbours: a polygon of two vertices, start and end."""
    ex = end[0] - start[0]
    ey = end[1] - start[1]
    length = sqrt(ex * ex + ey * ey) + TINY
    nx = ey / length
    ny = -ex / length
    planes = (start[0], start[1], -nx, -ny, end[0], end[1], nx, ny)
    return polygon_contact(ellipse, planes, 2, radius)


def nearest_vertex(
    ellipse: Frame, planes: Sequence[float], count: int, nx: float, ny: float
) -> int:
    """The vertex that is least far along n."""
    _a, _b, _c, _s, x, y = ellipse
    nearest = 0
    least = 1.0 / TINY
    for i in range(count):
        far = (planes[4 * i] - x) * nx + (planes[4 * i + 1] - y) * ny
        if far < least:
            least = far
            nearest = i
    return nearest


def is_nearest(
    ellipse: Frame, planes: Sequence[float], count: int, i: int, contact: Contact
) -> bool:
    """Whether no vertex is less far along the contact's normal than vertex i, by more than roundoff."""
    a, _b, _c, _s, x, y = ellipse
    _f, nx, ny, _px, _py = contact
    least = (planes[4 * i] - x) * nx + (planes[4 * i + 1] - y) * ny
    least -= ROUNDOFF * (a + abs(x) + abs(y))
    nearest = True
    for k in range(count):
        far = (planes[4 * k] - x) * nx + (planes[4 * k + 1] - y) * ny
        nearest = nearest and far >= least
    return nearest


def along_normal(
    ellipse: Frame, planes: Sequence[float], i: int, radius: float, nx: float, ny: float
) -> tuple[Contact, float]:
    """The contact along the unit vector n as if the plane through vertex i were touched, and f' for that vertex."""
    a, b, c, s, x, y = ellipse
    u = a * (c * nx + s * ny)
    v = b * (c * ny - s * nx)
    h = sqrt(u * u + v * v)
    u *= a / h
    v *= b / h
    px = c * u - s * v
    py = s * u + c * v
    dx = planes[4 * i] - x
    dy = planes[4 * i + 1] - y
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
