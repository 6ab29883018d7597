"""What queries need besides the ellipse: checked arguments, shapes near a segment, contacts seen from the other side, and where shapes without bodies are."""

from __future__ import annotations

from collections.abc import Iterator
from math import isinf
from typing import Any

import pymunk
from pymunk import BB, ContactPoint, ContactPointSet, Shape, ShapeFilter, Vec2d

from . import _checks
from ._layout import (
    CIRCLE_CENTER,
    POLYGON_PLANES,
    SEGMENT_END,
    SEGMENT_START,
    unproved,
)
from ._pymunk import ContactHandler, address, ffi, global_handler
from .geometry import (
    IDENTITY,
    Transform,
    body_transform,
    circle_in_world,
    polygon_in_world,
    segment_in_world,
)
from .narrowphase.ellipse_ellipse import Contact
from .narrowphase.placement import Frame

# A segment is covered by a box for each so many lengths of the first ellipse's longer semi-axis,
# but not more than this. More of them hold fewer shapes that are not near it, and each costs a query.
PIECE = 4.0
MOST_PIECES = 16

# Boxes are larger by this part of the coordinates, so that roundoff cannot lose a shape.
MARGIN = 1e-12

# Roundoff of the product of a face's unit normal and a unit vector along it.
NO_SLOPE = 1e-14

# Bytes from one of a polygon's splitting planes to the next: two vectors.
PLANE_SIZE = 32


def has_ellipses(space: pymunk.Space) -> bool:
    """Whether there are ellipses in a space."""
    return bool(_frames(space))


def _frames(space: pymunk.Space) -> dict[Any, Frame]:
    handler = global_handler(space)
    return handler.frames if isinstance(handler, ContactHandler) else {}


def number_or_infinity(name: str, value: Any) -> float:
    """value as a float that is not NaN."""
    if isinstance(value, float) and isinf(value):
        return value
    return _checks.number(name, value)


def box(value: Any) -> BB:
    """value as a bounding box, which may be infinite."""
    try:
        left, bottom, right, top = value
    except TypeError as error:
        raise TypeError(f"bb must be four numbers, got {value!r}") from error
    except ValueError as error:
        raise ValueError(f"bb must be four numbers, got {value!r}") from error
    return BB(
        number_or_infinity("bb.left", left),
        number_or_infinity("bb.bottom", bottom),
        number_or_infinity("bb.right", right),
        number_or_infinity("bb.top", top),
    )


def shapes_along(
    space: pymunk.Space,
    start: Vec2d,
    end: Vec2d,
    radius: float,
    shape_filter: ShapeFilter,
) -> Iterator[tuple[float, Shape]]:
    """Every shape in a space with ellipses that a circle of the given radius may touch on its way from start to end, and a few more.

    Each comes with a part of the way, 0 to 1, before which neither it nor any that follow can
    be touched. pymunk's segment query does not serve for this: Chipmunk looks for shapes whose
    boxes the segment itself crosses, whatever the radius, and takes no notice of a face of
    which the segment's ends lie less than 1e-5 apart.
    """
    seen = set()
    size = max(abs(start.x), abs(start.y), abs(end.x), abs(end.y))
    reach = max(radius, 0.0) + MARGIN * size
    typical = next(iter(_frames(space).values()))[0]
    pieces = int(min(1.0 + abs(end - start) / (PIECE * typical), MOST_PIECES))
    for i in range(pieces):
        reached = i / pieces
        near = start.interpolate_to(end, reached)
        far = start.interpolate_to(end, (i + 1) / pieces)
        piece = BB(
            min(near.x, far.x) - reach,
            min(near.y, far.y) - reach,
            max(near.x, far.x) + reach,
            max(near.y, far.y) + reach,
        )
        for shape in pymunk.Space.bb_query(space, piece, shape_filter):
            if shape not in seen:
                seen.add(shape)
                yield reached, shape


def mirrored(contact: ContactPointSet) -> ContactPointSet:
    """The contact of two shapes, seen from the second."""
    return ContactPointSet(
        -contact.normal,
        tuple(ContactPoint(p.point_b, p.point_a, p.distance) for p in contact.points),
    )


def transform_now(shape: Shape) -> Transform:
    """Where one of pymunk's shapes is: with its body, or without one where update has put it, if that was a rotation and a translation.

    Of the latter pymunk does not tell, and it is read from the shape's struct. Where structs
    are not as known, and before any update, the shape is at the origin.
    """
    on_body = body_transform(shape)
    if on_body is not None:
        return on_body
    if unproved() is not None or shape.bb == BB():
        return IDENTITY
    pointer = address(shape._shape)
    if isinstance(shape, pymunk.Circle):
        first = second = shape.offset
        first_now = second_now = _point(pointer + CIRCLE_CENTER)
    elif isinstance(shape, pymunk.Segment):
        first, second = shape.a, shape.b
        first_now = _point(pointer + SEGMENT_START)
        second_now = _point(pointer + SEGMENT_END)
    else:
        assert isinstance(shape, pymunk.Poly)
        vertices = shape.get_vertices()
        middle = len(vertices) // 2
        planes = int(ffi.cast("uintptr_t *", pointer + POLYGON_PLANES)[0])
        first, second = vertices[0], vertices[middle]
        first_now = _point(planes)
        second_now = _point(planes + PLANE_SIZE * middle)
    before = second - first
    now = second_now - first_now
    rotation = Vec2d(before.dot(now), before.cross(now)).normalized()
    if rotation == Vec2d.zero():
        rotation = Vec2d(1.0, 0.0)
    origin = first_now - first.cpvrotate(rotation)
    return origin.x, origin.y, rotation.x, rotation.y


def touched_corner(ellipse: Frame, shape: Shape, contact: Contact) -> Frame | None:
    """The circle that one of pymunk's shapes is where it touches an ellipse, None if that is a face."""
    transform = transform_now(shape)
    if isinstance(shape, pymunk.Circle):
        x, y, radius = circle_in_world(shape._shape, transform)
        return radius, radius, 1.0, 0.0, x, y
    if isinstance(shape, pymunk.Segment):
        ends, _tangents, radius = segment_in_world(shape._shape, transform)
        corners = [Vec2d(*ends[:2]), Vec2d(*ends[2:])]
    else:
        planes, count, radius = polygon_in_world(shape._shape, transform)
        corners = [Vec2d(*planes[4 * i : 4 * i + 2]) for i in range(count)]
    distance, nx, ny, px, py, _evaluations = contact
    normal = Vec2d(nx, ny)
    inner = Vec2d(ellipse[4] + px, ellipse[5] + py) + (distance + radius) * normal
    i = min(range(len(corners)), key=lambda i: inner.get_distance_squared(corners[i]))
    corner = corners[i]
    for neighbor in (corners[i - 1], corners[(i + 1) % len(corners)]):
        face = neighbor - corner
        if abs(face.dot(normal)) <= NO_SLOPE * face.length:
            return None
    return radius, radius, 1.0, 0.0, corner.x, corner.y


def _point(place: int) -> Vec2d:
    field = ffi.cast("double *", place)
    return Vec2d(field[0], field[1])
