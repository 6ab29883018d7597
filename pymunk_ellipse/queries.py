"""What a space's queries need besides the ellipse: checked arguments, shapes near a segment, and contacts seen from the other side."""

from __future__ import annotations

from collections.abc import Iterator
from math import isnan
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
from .geometry import IDENTITY, Transform

# Boxes that cover a segment. More of them hold fewer shapes that are not near it, and each
# costs a query.
PIECES = 8

# Boxes are larger by this part of the coordinates, so that roundoff cannot lose a shape.
MARGIN = 1e-12

# Bytes from one of a polygon's splitting planes to the next: two vectors.
PLANE_SIZE = 32


def has_ellipses(space: pymunk.Space) -> bool:
    """Whether there are ellipses in a space."""
    handler = global_handler(space)
    return isinstance(handler, ContactHandler) and bool(handler.frames)


def max_distance(value: Any) -> float:
    """value as a distance, which may be negative or infinite."""
    if value in (float("inf"), float("-inf")):
        return float(value)
    return _checks.number("max_distance", value)


def box(value: Any) -> BB:
    """value as a bounding box, which may be infinite."""
    try:
        numbers = tuple(float(number) for number in value)
    except (TypeError, ValueError) as error:
        raise TypeError(f"bb must be four numbers, got {value!r}") from error
    if len(numbers) != 4 or any(isnan(number) for number in numbers):
        raise ValueError(f"bb must be four numbers, got {value!r}")
    return BB(*numbers)


def shapes_along(
    space: pymunk.Space,
    start: Vec2d,
    end: Vec2d,
    radius: float,
    shape_filter: ShapeFilter,
) -> Iterator[tuple[float, Shape]]:
    """Every shape that a circle of the given radius may touch on its way from start to end, and a few more.

    Each comes with a part of the way, 0 to 1, before which neither it nor any that follow can
    be touched. pymunk's segment query does not serve for this: Chipmunk looks for shapes whose
    boxes the segment itself crosses, whatever the radius, and takes no notice of a face of
    which the segment's ends lie less than 1e-5 apart.
    """
    seen = set()
    size = max(abs(start.x), abs(start.y), abs(end.x), abs(end.y))
    reach = max(radius, 0.0) + MARGIN * size
    pieces = PIECES if start != end else 1
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


def updated_transform(shape: Shape) -> Transform:
    """Where update has put one of pymunk's shapes that has no body, if that was a rotation and a translation.

    pymunk does not tell: it is read from the shape's struct. Where structs are not as known,
    and before any update, the shape is at the origin.
    """
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


def _point(place: int) -> Vec2d:
    field = ffi.cast("double *", place)
    return Vec2d(field[0], field[1])
