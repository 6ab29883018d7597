"""Contact of an ellipse with a convex polygon or a segment, each with a radius."""

from __future__ import annotations

from collections.abc import Sequence
from math import acos, sqrt

from .common_normal import ROUNDOFF, TINY, Cone, Pair, climb, sweep
from .ellipse_ellipse import Contact, ellipse_ellipse, turned
from .frame import Frame

Vector = tuple[float, float]

FACE = -1

# The distance to a segment whose touched end does not count.
UNTOUCHED = 1.0 / TINY


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

    Between the normals of two neighbouring faces the polygon is the point they share, so f has
    its largest value either along the normal of a face or at a stationary point of f for one
    vertex, in the cone between the normals of its two faces. If the face with the largest f
    does not have the ellipse's support point in front of it, f rises into the cone at that end
    of the face, and the maximum is there.
    """
    a, b, c, s, _x, _y = ellipse
    best = -1.0 / TINY
    face = 0
    nx = 0.0
    ny = 0.0
    support = 0.0
    for i in range(count):
        ux, uy = normal_to_face(ellipse, planes, i)
        vx, vy = vertex_in_frame(ellipse, planes, i)
        au = a * ux
        bu = b * uy
        h = sqrt(au * au + bu * bu)
        f = vx * ux + vy * uy - h - radius
        if f > best and h > 0.0:
            best, face, nx, ny, support = f, i, ux, uy, h
    if support == 0.0:
        # No face has a length: the polygon is a point.
        corner = (radius, radius, 1.0, 0.0, planes[0], planes[1])
        return ellipse_ellipse(ellipse, corner, 0.0, 0.0), 0

    # The support point in that direction, and how far it lies past the two ends of the face.
    feature = FACE
    px = a * a * nx / support
    py = b * b * ny / support
    contact = (best, nx, ny, px, py)
    start = (face - 1) % count
    vx, vy = vertex_in_frame(ellipse, planes, face)
    past_end = (px - vx) * ny - (py - vy) * nx
    vx, vy = vertex_in_frame(ellipse, planes, start)
    before_start = (vx - px) * ny - (vy - py) * nx

    if past_end > 0.0 or before_start > 0.0:
        feature = face if past_end > 0.0 else start
        pair, cone = vertex_pair(ellipse, planes, count, radius, feature)
        contact = climb(pair, nx, ny, cone)

    if contact[0] < -(b / a * b + radius):
        for i in range(count):
            pair, cone = vertex_pair(ellipse, planes, count, radius, i)
            first_x, first_y, last_x, last_y = cone
            cosine = first_x * last_x + first_y * last_y
            extent = acos(min(1.0, max(-1.0, cosine)))
            better = sweep(pair, first_x, first_y, extent, cone, contact)
            # At its ends the cone's f is that of a face, and roundoff must not make a vertex of it.
            if better[0] > contact[0] + 4.0 * ROUNDOFF * (a + radius):
                contact = better
                feature = i
    return turned(contact, c, s), feature


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
    not count (Chipmunk's rule for circles); the neighbour itself is then taken, because
    Chipmunk decides by the hull which segment of a chain is touched, and the hull's nearest
    point may lie over one and the ellipse's over the next. Where the neighbour is not touched
    either, the distance is UNTOUCHED.

    For the rest see ellipse_ellipse.
    """
    contact, joint = line_contact(ellipse, start, end, radius)
    _distance, nx, ny, _px, _py = contact
    if joint == 0 and nx * before[0] + ny * before[1] < 0.0:
        end = (start[0] + before[0], start[1] + before[1])
    elif joint == 1 and nx * after[0] + ny * after[1] < 0.0:
        start = (end[0] + after[0], end[1] + after[1])
    else:
        return contact

    contact, feature = line_contact(ellipse, start, end, radius)
    # Where two of a chain meet, roundoff may let each leave the contact to the other.
    if feature != FACE and feature != joint:
        _distance, nx, ny, px, py = contact
        return UNTOUCHED, nx, ny, px, py
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


def normal_to_face(ellipse: Frame, planes: Sequence[float], i: int) -> Vector:
    """The contact normal into face i, in the ellipse's frame."""
    _a, _b, c, s, _x, _y = ellipse
    nx = planes[4 * i + 2]
    ny = planes[4 * i + 3]
    return -(c * nx + s * ny), s * nx - c * ny


def vertex_in_frame(ellipse: Frame, planes: Sequence[float], i: int) -> Vector:
    """Vertex i in the ellipse's frame."""
    _a, _b, c, s, cx, cy = ellipse
    x = planes[4 * i] - cx
    y = planes[4 * i + 1] - cy
    return c * x + s * y, c * y - s * x


def vertex_pair(
    ellipse: Frame, planes: Sequence[float], count: int, radius: float, i: int
) -> tuple[Pair, Cone]:
    """The pair of the ellipse and vertex i, a circle of the given radius, and the cone where the vertex counts."""
    vx, vy = vertex_in_frame(ellipse, planes, i)
    first_x, first_y = normal_to_face(ellipse, planes, i)
    last_x, last_y = normal_to_face(ellipse, planes, (i + 1) % count)
    # A vertex that is repeated ends a face without length, which has no normal.
    for j in range(1, count):
        if first_x == 0.0 and first_y == 0.0:
            first_x, first_y = normal_to_face(ellipse, planes, (i - j) % count)
        if last_x == 0.0 and last_y == 0.0:
            last_x, last_y = normal_to_face(ellipse, planes, (i + 1 + j) % count)
    pair = (ellipse[0], ellipse[1], radius, radius, 1.0, 0.0, vx, vy)
    return pair, (first_x, first_y, last_x, last_y)
