"""Contact of an ellipse with a convex polygon or a segment, each with a radius."""

from __future__ import annotations

from collections.abc import Sequence
from math import acos, sqrt

from .common_normal import ROUNDOFF, TINY, climb, fitted_circles, sweep
from .ellipse_ellipse import Contact, ellipse_ellipse

# Distance, normal from the ellipse (x, y), contact point on it from its centre (x, y),
# evaluations, the index of the vertex that is touched or FACE.
FeatureContact = tuple[float, float, float, float, float, int, int]

FACE = -1

# The distance to a segment whose touched end does not count.
UNTOUCHED = 1.0 / TINY


def ellipse_polygon(
    a: float,
    b: float,
    c: float,
    s: float,
    cx: float,
    cy: float,
    planes: Sequence[float],
    count: int,
    radius: float,
    margin: float,
) -> FeatureContact:
    """Distance, contact normal and contact point of an ellipse and a convex polygon with a radius.

    The ellipse has its centre at (cx, cy) and its semi-axis a >= b along (c, s). planes holds
    four numbers for each of the polygon's count vertices, counterclockwise: the vertex and the
    outward normal of the face that ends there (Chipmunk's splitting planes).

    Between the normals of two neighbouring faces the polygon is the point they share, so f has
    its largest value either along the normal of a face or at a stationary point of f for one
    vertex, in the cone between the normals of its two faces. If the face with the largest f
    does not have the ellipse's support point in front of it, f rises into the cone at that end
    of the face, and the maximum is there.

    Returns what ellipse_ellipse does, and the index of the vertex that is touched, or FACE.
    """
    best = -1.0 / TINY
    face = 0
    nx = 0.0
    ny = 0.0
    support = 0.0
    for i in range(count):
        ux, uy = normal_to_face(c, s, planes, i)
        vx, vy = vertex_in_frame(c, s, cx, cy, planes, i)
        au = a * ux
        bu = b * uy
        h = sqrt(au * au + bu * bu)
        f = vx * ux + vy * uy - h - radius
        if f > best and h > 0.0:
            best, face, nx, ny, support = f, i, ux, uy, h
    evaluations = count
    if support == 0.0:
        # No face has a length: the polygon is a point.
        f, nx, ny, px, py, evaluations = ellipse_ellipse(
            a,
            b,
            c,
            s,
            radius,
            radius,
            1.0,
            0.0,
            planes[0] - cx,
            planes[1] - cy,
            0.0,
            0.0,
            margin,
        )
        return f, nx, ny, px, py, evaluations, 0

    # The support point in that direction, and how far it lies past the two ends of the face.
    feature = FACE
    px = a * a * nx / support
    py = b * b * ny / support
    start = (face - 1) % count
    vx, vy = vertex_in_frame(c, s, cx, cy, planes, face)
    past_end = (px - vx) * ny - (py - vy) * nx
    vx, vy = vertex_in_frame(c, s, cx, cy, planes, start)
    before_start = (vx - px) * ny - (vy - py) * nx

    if best <= margin and (past_end > 0.0 or before_start > 0.0):
        feature = face if past_end > 0.0 else start
        pair, cone = vertex_pair(a, b, c, s, cx, cy, planes, count, radius, feature)
        best, nx, ny, px, py, climbed = climb(pair, nx, ny, cone, margin)
        evaluations += climbed

    if best < -(b / a * b + radius):
        for i in range(count):
            pair, cone = vertex_pair(a, b, c, s, cx, cy, planes, count, radius, i)
            cosine = cone[0] * cone[2] + cone[1] * cone[3]
            extent = acos(min(1.0, max(-1.0, cosine)))
            g, ux, uy, swept = sweep(
                pair, cone[0], cone[1], extent, cone, best, nx, ny, margin
            )
            evaluations += swept
            # At its ends the cone's f is that of a face, and roundoff must not make a vertex of it.
            if g > best + 4.0 * ROUNDOFF * (a + radius):
                best, nx, ny, feature = g, ux, uy, i
                _f, _slope, _between, nx, ny, px, py = fitted_circles(pair, nx, ny)

    return (
        best,
        c * nx - s * ny,
        s * nx + c * ny,
        c * px - s * py,
        s * px + c * py,
        evaluations,
        feature,
    )


def ellipse_segment(
    a: float,
    b: float,
    c: float,
    s: float,
    cx: float,
    cy: float,
    start_x: float,
    start_y: float,
    end_x: float,
    end_y: float,
    before_x: float,
    before_y: float,
    after_x: float,
    after_y: float,
    radius: float,
    margin: float,
) -> Contact:
    """Distance, contact normal and contact point of an ellipse and a segment with a radius.

    before and after lead from the segment's two ends to the other ends of its neighbours, and
    are zero where it has none. An end that the ellipse touches from over its neighbour does
    not count (Chipmunk's rule for circles); the neighbour itself is then taken, because
    Chipmunk decides by the hull which segment of a chain is touched, and the hull's nearest
    point may lie over one and the ellipse's over the next. Where the neighbour is not touched
    either, the distance is UNTOUCHED.

    For the rest see ellipse_ellipse.
    """
    f, nx, ny, px, py, evaluations, feature = ellipse_line(
        a, b, c, s, cx, cy, start_x, start_y, end_x, end_y, radius, margin
    )
    joint = feature
    if feature == 0 and nx * before_x + ny * before_y < 0.0:
        end_x = start_x + before_x
        end_y = start_y + before_y
    elif feature == 1 and nx * after_x + ny * after_y < 0.0:
        start_x = end_x + after_x
        start_y = end_y + after_y
    else:
        return f, nx, ny, px, py, evaluations

    f, nx, ny, px, py, more, feature = ellipse_line(
        a, b, c, s, cx, cy, start_x, start_y, end_x, end_y, radius, margin
    )
    # Where two of a chain meet, roundoff may let each leave the contact to the other.
    if feature != FACE and feature != joint:
        f = UNTOUCHED
    return f, nx, ny, px, py, evaluations + more


def ellipse_line(
    a: float,
    b: float,
    c: float,
    s: float,
    cx: float,
    cy: float,
    start_x: float,
    start_y: float,
    end_x: float,
    end_y: float,
    radius: float,
    margin: float,
) -> FeatureContact:
    """The contact of an ellipse and a segment without neighbours: a polygon of two vertices, start and end."""
    ex = end_x - start_x
    ey = end_y - start_y
    length = sqrt(ex * ex + ey * ey) + TINY
    nx = ey / length
    ny = -ex / length
    planes = (start_x, start_y, -nx, -ny, end_x, end_y, nx, ny)
    return ellipse_polygon(a, b, c, s, cx, cy, planes, 2, radius, margin)


def normal_to_face(
    c: float, s: float, planes: Sequence[float], i: int
) -> tuple[float, float]:
    """The contact normal into face i, in the ellipse's frame."""
    nx = planes[4 * i + 2]
    ny = planes[4 * i + 3]
    return -(c * nx + s * ny), s * nx - c * ny


def vertex_in_frame(
    c: float, s: float, cx: float, cy: float, planes: Sequence[float], i: int
) -> tuple[float, float]:
    """Vertex i in the ellipse's frame."""
    x = planes[4 * i] - cx
    y = planes[4 * i + 1] - cy
    return c * x + s * y, c * y - s * x


def vertex_pair(
    a: float,
    b: float,
    c: float,
    s: float,
    cx: float,
    cy: float,
    planes: Sequence[float],
    count: int,
    radius: float,
    i: int,
) -> tuple[
    tuple[float, float, float, float, float, float, float, float],
    tuple[float, float, float, float],
]:
    """The pair of the ellipse and vertex i, a circle of the given radius, and the cone where the vertex counts."""
    vx, vy = vertex_in_frame(c, s, cx, cy, planes, i)
    first_x, first_y = normal_to_face(c, s, planes, i)
    last_x, last_y = normal_to_face(c, s, planes, (i + 1) % count)
    # A vertex that is repeated ends a face without length, which has no normal.
    for j in range(1, count):
        if first_x == 0.0 and first_y == 0.0:
            first_x, first_y = normal_to_face(c, s, planes, (i - j) % count)
        if last_x == 0.0 and last_y == 0.0:
            last_x, last_y = normal_to_face(c, s, planes, (i + 1 + j) % count)
    return (a, b, radius, radius, 1.0, 0.0, vx, vy), (first_x, first_y, last_x, last_y)
