"""The contact of an ellipse and any shape, read from Chipmunk's structs: one branch for each kind of shape."""

from __future__ import annotations

from typing import Any

from ..chipmunk.shape_class import frame_now
from ..chipmunk.structs import (
    CIRCLE,
    SEGMENT,
    behind,
    circle_at,
    ellipse_class,
    frame_in,
    hull_at,
    polygon_at,
    segment_at,
    shape_at,
)
from ..narrowphase.ellipse_ellipse import Contact, ellipse_ellipse
from ..narrowphase.ellipse_polygon import ellipse_polygon, ellipse_segment, nearest_face
from ..narrowphase.frame import Frame, seen_from

# Distance, normal from the first to the second (x, y), and a point on each surface (x, y).
ShapeContact = tuple[float, float, float, float, float, float, float]


def contact_of(ellipse: Frame, shape: Any, nx: float, ny: float) -> Contact:
    """The contact of an ellipse in the world and any shape, where that was updated last, found from the normal (nx, ny) on."""
    if shape.klass == ellipse_class():
        return ellipse_ellipse(ellipse, frame_in(hull_at(shape).world), nx, ny)
    return contact_with(ellipse, shape, False, nx, ny)


def half_thickness(shape: Any) -> float:
    """How far from the middle of any shape its nearest outline is: a circle's radius, an ellipse's shorter semi-axis."""
    if shape.klass == ellipse_class():
        return frame_in(hull_at(shape).local)[1]
    kind = shape.shape_class.type
    if kind == CIRCLE:
        half: float = circle_at(shape).r
    elif kind == SEGMENT:
        half = segment_at(shape).r
    else:
        polygon = polygon_at(shape)
        half = polygon.r + nearest_face(polygon.planes, polygon.count)
    return half


def contact_with(
    ellipse: Frame, shape: Any, local: bool, nx: float, ny: float
) -> Contact:
    """The contact of an ellipse and one of pymunk's own shapes, found from the normal (nx, ny) on.

    With local the shape is taken in its body's coordinates, and the ellipse must be given in
    them; else both are in the world, the shape where it was updated last.
    """
    kind = shape.shape_class.type
    if kind == CIRCLE:
        circle = circle_at(shape)
        center = circle.c if local else circle.tc
        radius = circle.r
        return ellipse_ellipse(
            ellipse, (radius, radius, 1.0, 0.0, center.x, center.y), nx, ny
        )
    if kind == SEGMENT:
        segment = segment_at(shape)
        start = segment.a if local else segment.ta
        end = segment.b if local else segment.tb
        normal = segment.n
        turned = normal if local else segment.tn
        # By the normal, for the tangents to the neighbours are kept in local coordinates only.
        cos = normal.x * turned.x + normal.y * turned.y
        sin = normal.x * turned.y - normal.y * turned.x
        before = segment.a_tangent
        after = segment.b_tangent
        return ellipse_segment(
            ellipse,
            (start.x, start.y),
            (end.x, end.y),
            (cos * before.x - sin * before.y, sin * before.x + cos * before.y),
            (cos * after.x - sin * after.y, sin * after.x + cos * after.y),
            segment.r,
        )
    polygon = polygon_at(shape)
    count = polygon.count
    planes = polygon.planes
    if local:
        planes = behind(planes, 4 * count)
    return ellipse_polygon(ellipse, planes, count, polygon.r)


def shape_contact(first: Any, second: Any) -> ShapeContact:
    """The contact of an ellipse and any shape where their bodies are now; without a body, where they were updated last.

    The result is in the world.
    """
    ellipse = frame_now(hull_at(first))
    shape = shape_at(second)
    if shape.klass == ellipse_class():
        other = frame_now(hull_at(second))
        distance, nx, ny, px, py = ellipse_ellipse(ellipse, other, 0.0, 0.0)
    elif shape.on_body == 0:
        box = shape.bb
        # The box of a shape that was never updated, and is at the origin, is zero.
        local = box.left == 0.0 == box.right and box.bottom == 0.0 == box.top
        distance, nx, ny, px, py = contact_with(ellipse, shape, local, 0.0, 0.0)
    else:
        # Seen from the shape's body nothing of the shape has to be moved.
        at = shape.body.transform
        seen = seen_from(ellipse, at.tx, at.ty, at.a, at.b)
        distance, mx, my, qx, qy = contact_with(seen, shape, True, 0.0, 0.0)
        nx = at.a * mx - at.b * my
        ny = at.b * mx + at.a * my
        px = at.a * qx - at.b * qy
        py = at.b * qx + at.a * qy
    x = ellipse[4] + px
    y = ellipse[5] + py
    return distance, nx, ny, x, y, x + distance * nx, y + distance * ny
