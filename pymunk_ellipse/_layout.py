"""Where Chipmunk's structs keep their fields, proved on shapes and bodies of known numbers before anything relies on it."""

from __future__ import annotations

from functools import cache
from math import isclose, pi
from typing import Any

import pymunk
from pymunk import Transform

from ._pymunk import address, ffi
from .narrowphase.placement import Frame

# Offsets in bytes on a 64-bit machine, from chipmunk_structs.h of Munk2D as pymunk 7 ships it.
# Each field is a double unless it says otherwise.
BODY_CENTER_OF_GRAVITY = 48  # x, y, local
BODY_POSITION = 64  # x, y, of the centre of gravity in the world
BODY_SPIN = 120
BODY_TRANSFORM = (
    136  # the matrix's columns: cos, sin, -sin, cos, then x, y of the body's origin
)
SHAPE_CLASS = 0  # a pointer to a struct that starts with the kind, an int
SHAPE_MASS = 24
SHAPE_MOMENT_PER_MASS = 32
SHAPE_CENTER_OF_GRAVITY = 40  # x, y, local
SHAPE_AREA = 56
SHAPE_SURFACE_VELOCITY = 120  # x, y
CIRCLE_CENTER = 208  # x, y, in the world
CIRCLE_RADIUS = 224
SEGMENT_START = 240  # x, y, in the world
SEGMENT_END = 256  # x, y, in the world
SEGMENT_RADIUS = 288
SEGMENT_TANGENTS = 296  # x, y at the start, x, y at the end, local
POLYGON_RADIUS = 192
POLYGON_COUNT = 200  # an int
POLYGON_PLANES = (
    208  # a pointer to vertex x, y and normal x, y in the world; local ones follow
)
POLYGON_INLINE_PLANES = 216  # where the planes are while they are few
INLINE_VERTICES = 6

CIRCLE, SEGMENT, POLYGON = 0, 1, 2

# An ellipse's hull has more vertices than fit inline, so that its struct has room for the
# ellipse's frame: a mark that no other shape can have there, and six doubles.
ELLIPSE_MARK = POLYGON_INLINE_PLANES
ELLIPSE_FRAME = ELLIPSE_MARK + 8
MARK = 0x45_6C_6C_69_70_73_65_21


def _at(pointer: Any, offset: int, kind: str) -> Any:
    return ffi.cast(f"{kind} *", ffi.cast("char *", pointer) + offset)


def _mismatch(pointer: Any, offset: int, expected: tuple[float, ...]) -> bool:
    field = _at(pointer, offset, "double")
    return not all(
        isclose(field[i], number, rel_tol=1e-12) for i, number in enumerate(expected)
    )


@cache
def unproved() -> str | None:
    """What was not found where this file says, or None if everything was.

    Numbers are compared in the order in which they lie in memory, each struct up to the first
    that differs, so that nothing is read behind what was found.
    """
    if ffi.sizeof("void *") != 8:
        return "pointers are not 64 bits wide"
    return (
        _unproved_of_kinds()
        or _unproved_of_body()
        or _unproved_of_circle()
        or _unproved_of_segment()
        or _unproved_of_polygon()
    )


_TRANSFORM = Transform(0.6, 0.8, -0.8, 0.6, 31.5, 47.25)


def _unproved_of_kinds() -> str | None:
    # The pointer to a shape's class, before it is followed: one for each kind, and none of them
    # null or a small number.
    shapes = (
        pymunk.Circle(None, 1.0),
        pymunk.Circle(None, 2.0),
        pymunk.Segment(None, (0.0, 0.0), (1.0, 0.0), 1.0),
        pymunk.Poly.create_box(None),
    )
    classes = [address(_at(shape._shape, SHAPE_CLASS, "void *")[0]) for shape in shapes]
    if min(classes) < 0x10000 or classes[0] != classes[1] or len(set(classes)) != 3:
        return "a shape's class"
    return None


def _unproved_of_body() -> str | None:
    body = pymunk.Body(2.0, 3.0)
    body.center_of_gravity = 1.5, 2.5
    body.angle = 0.5
    body.position = 31.5, 47.25
    body.angular_velocity = 8.75
    pointer = body._body
    cos, sin = body.rotation_vector
    gravity = body.local_to_world(body.center_of_gravity)
    for name, offset, expected in (
        ("center of gravity", BODY_CENTER_OF_GRAVITY, (1.5, 2.5)),
        ("position", BODY_POSITION, (gravity.x, gravity.y)),
        ("angular velocity", BODY_SPIN, (8.75,)),
        ("transform", BODY_TRANSFORM, (cos, sin, -sin, cos, 31.5, 47.25)),
    ):
        if _mismatch(pointer, offset, expected):
            return f"a body's {name}"
    return None


def _unproved_of_shape(shape: pymunk.Shape, kind: int) -> str | None:
    shape.mass = 1.75
    shape.surface_velocity = 3.25, -4.75
    for name, offset, expected in (
        ("mass", SHAPE_MASS, (1.75,)),
        ("moment", SHAPE_MOMENT_PER_MASS, (shape.moment / shape.mass,)),
        ("center of gravity", SHAPE_CENTER_OF_GRAVITY, shape.center_of_gravity),
        ("area", SHAPE_AREA, (shape.area,)),
        ("surface velocity", SHAPE_SURFACE_VELOCITY, (3.25, -4.75)),
    ):
        if _mismatch(shape._shape, offset, expected):
            return f"a shape's {name}"
    if _at(_at(shape._shape, SHAPE_CLASS, "void *")[0], 0, "int")[0] != kind:
        return "a shape's kind"
    shape.update(_TRANSFORM)
    return None


def _unproved_of_circle() -> str | None:
    circle = pymunk.Circle(None, 5.5, (1.5, 2.5))
    center = _TRANSFORM @ circle.offset
    problem = _unproved_of_shape(circle, CIRCLE)
    if problem:
        return problem
    if _mismatch(circle._shape, CIRCLE_CENTER, center):
        return "a circle's center"
    if _mismatch(circle._shape, CIRCLE_RADIUS, (circle.radius,)):
        return "a circle's radius"
    return None


def _unproved_of_segment() -> str | None:
    segment = pymunk.Segment(None, (1.5, 2.5), (4.5, 6.5), 7.25)
    segment.set_neighbors((11.5, 13.5), (17.5, 19.5))
    start = _TRANSFORM @ segment.a
    end = _TRANSFORM @ segment.b
    problem = _unproved_of_shape(segment, SEGMENT)
    if problem:
        return problem
    for name, offset, expected in (
        ("start", SEGMENT_START, start),
        ("end", SEGMENT_END, end),
        ("radius", SEGMENT_RADIUS, (7.25,)),
        ("neighbors", SEGMENT_TANGENTS, (10.0, 11.0, 13.0, 13.0)),
    ):
        if _mismatch(segment._shape, offset, expected):
            return f"a segment's {name}"
    return None


def _unproved_of_polygon() -> str | None:
    corners = [
        (8.0, 1.0),
        (6.0, 6.5),
        (1.0, 8.5),
        (-5.5, 6.0),
        (-7.5, -3.0),
        (2.5, -9.5),
    ]
    for count in (INLINE_VERTICES, 3):
        polygon = pymunk.Poly(None, corners[:count], radius=7.25)
        problem = _unproved_of_shape(polygon, POLYGON)
        if problem:
            return problem
        pointer = polygon._shape
        if _mismatch(pointer, POLYGON_RADIUS, (7.25,)):
            return "a polygon's radius"
        if _at(pointer, POLYGON_COUNT, "int")[0] != count:
            return "a polygon's vertex count"
        planes = address(pointer) + POLYGON_INLINE_PLANES
        if address(_at(pointer, POLYGON_PLANES, "void *")[0]) != planes:
            return "a polygon's planes"
        world = [_TRANSFORM @ vertex for vertex in polygon.get_vertices()]
        for i, vertex in enumerate(world):
            normal = (vertex - world[i - 1]).normalized().perpendicular()
            plane = (vertex.x, vertex.y, -normal.x, -normal.y)
            if _mismatch(pointer, POLYGON_INLINE_PLANES + 32 * i, plane):
                return "a polygon's vertices and normals"
        for i, vertex in enumerate(polygon.get_vertices()):
            offset = POLYGON_INLINE_PLANES + 32 * (count + i)
            if _mismatch(pointer, offset, tuple(vertex)):
                return "a polygon's local vertices"
    many = pymunk.Poly(None, [*corners, (5.0, -8.0)])
    if address(many._shape) + POLYGON_INLINE_PLANES == address(
        _at(many._shape, POLYGON_PLANES, "void *")[0]
    ):
        return "how many planes are inline in a polygon"
    return None


def write_ellipse(cp_shape: Any, frame: Frame) -> None:
    """Make a hull the ellipse's own, where the structs are as known: mark it, with the frame, and set mass properties.

    Those are the moment of inertia per mass, the centre of gravity and the area, which pymunk
    has taken from the hull.

    Raises ValueError for a hull of so few vertices that it needs the room itself.
    """
    if _at(cp_shape, POLYGON_COUNT, "int")[0] <= INLINE_VERTICES:
        raise ValueError(f"a hull needs more than {INLINE_VERTICES} vertices")
    a, b, _c, _s, x, y = frame
    mass_info = _at(cp_shape, SHAPE_MOMENT_PER_MASS, "double")
    for i, number in enumerate(((a * a + b * b) / 4.0, x, y, pi * a * b)):
        mass_info[i] = number
    fields = _at(cp_shape, ELLIPSE_FRAME, "double")
    for i, number in enumerate(frame):
        fields[i] = number
    mark = _at(cp_shape, ELLIPSE_MARK, "uint64_t")
    mark[0] = MARK ^ address(cp_shape)


def neighbor_tangents(cp_shape: Any) -> tuple[float, float, float, float]:
    """From the two ends of a segment to the far ends of its neighbours, in local coordinates; zero without any.

    Chipmunk has no getter for what Segment.set_neighbors sets. Where the structs are not as
    known, no segment has neighbours.
    """
    if unproved() is not None:
        return 0.0, 0.0, 0.0, 0.0
    field = _at(cp_shape, SEGMENT_TANGENTS, "double")
    return field[0], field[1], field[2], field[3]
