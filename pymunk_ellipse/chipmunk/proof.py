"""Proves on shapes and bodies of known numbers that Chipmunk's structs are as structs.h declares them, before anything relies on it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from functools import cache
from math import isclose, nan
from typing import Any

import pymunk
from pymunk import Transform, Vec2d

from .private import ffi as pymunk_ffi
from .private import lib
from .structs import (
    CACHED,
    CIRCLE,
    FIRST_COLLISION,
    IGNORE,
    INLINE_VERTICES,
    POLYGON,
    SEGMENT,
    address,
    body_at,
    circle_at,
    ffi,
    polygon_at,
    segment_at,
    shape_at,
    space_at,
)

# The versions that the tests pass on.
KNOWN = "7.0.1 to 7.3.1"

# A field, what was found there and what is right.
Finding = tuple[str, Any, Any]


@cache
def prove_structs() -> None:
    """Compare every field that is used with what pymunk says of it.

    Raises RuntimeError that names the first field that is not where structs.h says.
    """
    problem = first_difference(findings())
    if problem is not None:
        raise RuntimeError(
            f"pymunk_ellipse does not know pymunk {pymunk.version}: it keeps {problem} elsewhere "
            f"than pymunk {KNOWN} does; one of those works"
        )


def first_difference(found: Iterable[Finding]) -> str | None:
    """The first field that is not what is right, or None.

    The fields come in the order in which they lie in memory, and nothing is read behind one
    that differs.
    """
    for name, value, expected in found:
        if isinstance(expected, tuple):
            same = all(
                isclose(number, right, rel_tol=1e-12)
                for number, right in zip(value, expected, strict=True)
            )
        else:
            same = value == expected
        if not same:
            return name
    return None


def findings() -> Iterator[Finding]:
    """All fields that are used."""
    yield from _declared_by_pymunk()
    yield from _classes()
    yield from _body()
    yield from _space()
    yield from _circle()
    yield from _segment()
    yield from _polygon()
    yield from _class_functions()


def _pair(vector: Any) -> tuple[float, float]:
    return vector.x, vector.y


def _declared_by_pymunk() -> Iterator[Finding]:
    for ours, theirs, fields in (
        (
            "Contact",
            "struct cpContact",
            ("r1", "r2", "nMass", "tMass", "bounce", "jnAcc", "jtAcc", "hash"),
        ),
        (
            "Arbiter",
            "struct cpArbiter",
            (
                *("e", "u", "surface_vr", "data", "a", "b", "body_a", "body_b"),
                *("count", "contacts", "n", "state", "processCollision"),
            ),
        ),
        (
            "PointQueryInfo",
            "cpPointQueryInfo",
            ("shape", "point", "distance", "gradient"),
        ),
        (
            "SegmentQueryInfo",
            "cpSegmentQueryInfo",
            ("shape", "point", "normal", "alpha"),
        ),
    ):
        for field in fields:
            yield (
                f"a {theirs.split()[-1]}'s {field}",
                ffi.offsetof(ours, field),
                pymunk_ffi.offsetof(theirs, field),
            )
    yield (
        "an arbiter's states",
        (FIRST_COLLISION, IGNORE, CACHED),
        (
            lib.CP_ARBITER_STATE_FIRST_COLLISION,
            lib.CP_ARBITER_STATE_IGNORE,
            lib.CP_ARBITER_STATE_CACHED,
        ),
    )


def _classes() -> Iterator[Finding]:
    # The pointer to a shape's class, before it is followed: one for each kind, and none of them
    # null or a small number.
    shapes = (
        pymunk.Circle(None, 1.0),
        pymunk.Circle(None, 2.0),
        pymunk.Segment(None, (0.0, 0.0), (1.0, 0.0), 1.0),
        pymunk.Poly.create_box(None),
    )
    classes = [shape_at(shape._shape).klass for shape in shapes]
    distinct = min(classes) >= 0x10000 and len(set(classes)) == 3
    yield "a shape's class", distinct and classes[0] == classes[1], True


def _body() -> Iterator[Finding]:
    body = pymunk.Body(2.0, 4.0)
    found = body_at(body._body)
    for name in ("velocity_func", "position_func"):
        # One after the other, and each alone.
        before = found.velocity_func, found.position_func
        setattr(body, name, lambda *arguments: None)
        after = found.velocity_func, found.position_func
        changed = [one != other for one, other in zip(before, after, strict=True)]
        right = [name == "velocity_func", name == "position_func"]
        yield "a body's velocity and position functions", changed, right
    body.center_of_gravity = 1.5, 2.5
    body.angle = 0.5
    body.position = 31.5, 47.25
    body.velocity = 5.25, -6.5
    body.force = 9.75, -10.25
    body.angular_velocity = 8.75
    body.torque = 11.5
    cos, sin = body.rotation_vector
    gravity = body.local_to_world(body.center_of_gravity)
    yield "a body's inverse mass", (found.m_inv,), (0.5,)
    yield "a body's inverse moment", (found.i_inv,), (0.25,)
    yield "a body's center of gravity", _pair(found.cog), (1.5, 2.5)
    yield "a body's position", _pair(found.p), tuple(gravity)
    yield "a body's velocity", _pair(found.v), (5.25, -6.5)
    yield "a body's force", _pair(found.f), (9.75, -10.25)
    yield "a body's angular velocity", (found.w,), (8.75,)
    yield "a body's torque", (found.t,), (11.5,)
    at = found.transform
    yield (
        "a body's transform",
        (at.a, at.b, at.c, at.d, at.tx, at.ty),
        (cos, sin, -sin, cos, 31.5, 47.25),
    )


def _space() -> Iterator[Finding]:
    space = pymunk.Space()
    space.iterations = 13
    space.gravity = 1.5, -2.5
    space.damping = 0.625
    space.collision_slop = 0.375
    space.collision_bias = 0.25
    space.collision_persistence = 5
    body = pymunk.Body(1.0, 2.0)
    body.velocity = 3.5, -4.5
    body.angular_velocity = 5.5
    wall = pymunk.Circle(space.static_body, 2.0, (1.0, 0.5))
    space.add(body, pymunk.Circle(body, 2.0, (-0.5, 1.0)), wall)
    for _ in range(3):
        space.step(0.0625)
    found = space_at(space._space)
    yield "a space's iterations", found.iterations, 13
    yield "a space's gravity", _pair(found.gravity), (1.5, -2.5)
    yield "a space's damping", (found.damping,), (0.625,)
    yield "a space's collision slop", (found.collisionSlop,), (0.375,)
    yield "a space's collision bias", (found.collisionBias,), (0.25,)
    yield "a space's collision persistence", found.collisionPersistence, 5
    yield "a space's stamp", found.stamp, 3
    yield "a space's time step", (found.curr_dt,), (0.0625,)
    # The words on the way to the last field: the global handler is for all collision types.
    handler = found.global_handler
    yield "a space's global handler", (handler.type_a, handler.type_b), (-1, -1)
    place = address(space._space) + ffi.offsetof("Space", "static_body")
    yield "a space's static body", found.static_body_at, place
    moving = body_at(body._body)
    usual = moving.velocity_func, moving.position_func
    static = found.static_body
    same = static.velocity_func == usual[0], static.position_func == usual[1]
    yield "a static body's functions", same, (True, True)

    # Two that overlap are parted by bias velocities in the step after.
    before, angle = body.position, body.angle
    moved = body.velocity, body.angular_velocity
    bias = (*_pair(moving.v_bias), moving.w_bias)
    yield "a body's space", moving.space, address(space._space)
    yield "a body's joints", moving.constraints, 0
    space.step(0.0625)
    away = (body.position - before) / 0.0625 - moved[0]
    turned = (body.angle - angle) / 0.0625 - moved[1]
    yield "a body's bias velocities", bias, (*away, turned)
    yield "whether a body has bias velocities", all(bias), True
    joint = pymunk.PivotJoint(body, space.static_body, (0.0, 0.0))
    space.add(joint)
    yield "a body's joints", moving.constraints, address(joint._constraint)


_TRANSFORM = Transform(0.6, 0.8, -0.8, 0.6, 31.5, 47.25)


def _shape(shape: pymunk.Shape, kind: int) -> Iterator[Finding]:
    body = pymunk.Body(1.0, 1.0)
    shape.body = body
    shape.mass = 1.75
    shape.surface_velocity = 3.25, -4.75
    shape.sensor = True
    found = shape_at(shape._shape)
    yield "a shape's body", found.on_body, address(body._body)
    yield "a shape's mass", (found.m,), (1.75,)
    yield "a shape's moment", (found.i,), (shape.moment / shape.mass,)
    yield "a shape's center of gravity", _pair(found.cog), shape.center_of_gravity
    yield "a shape's area", (found.area,), (shape.area,)
    yield "a shape's surface velocity", _pair(found.surfaceV), (3.25, -4.75)
    yield "whether a shape is a sensor", found.sensor, 1
    yield "a shape's kind", found.shape_class.type, kind
    box = shape.update(_TRANSFORM)
    bb = found.bb
    yield "a shape's box", (bb.left, bb.bottom, bb.right, bb.top), tuple(box)


def _circle() -> Iterator[Finding]:
    circle = pymunk.Circle(None, 5.5, (1.5, 2.5))
    yield from _shape(circle, CIRCLE)
    found = circle_at(circle._shape)
    yield "a circle's offset", _pair(found.c), (1.5, 2.5)
    yield "a circle's center", _pair(found.tc), tuple(_TRANSFORM @ circle.offset)
    yield "a circle's radius", (found.r,), (5.5,)


def _segment() -> Iterator[Finding]:
    segment = pymunk.Segment(None, (1.5, 2.5), (4.5, 6.5), 7.25)
    segment.set_neighbors((11.5, 13.5), (17.5, 19.5))
    yield from _shape(segment, SEGMENT)
    found = segment_at(segment._shape)
    yield "a segment's a", _pair(found.a), (1.5, 2.5)
    yield "a segment's b", _pair(found.b), (4.5, 6.5)
    local = found.n
    yield "a segment's local normal", _pair(local), (0.8, -0.6)
    yield "a segment's start", _pair(found.ta), tuple(_TRANSFORM @ segment.a)
    yield "a segment's end", _pair(found.tb), tuple(_TRANSFORM @ segment.b)
    turned = 0.6 * local.x - 0.8 * local.y, 0.8 * local.x + 0.6 * local.y
    yield "a segment's normal", _pair(found.tn), turned
    yield "a segment's radius", (found.r,), (7.25,)
    yield "a segment's neighbor at a", _pair(found.a_tangent), (10.0, 11.0)
    yield "a segment's neighbor at b", _pair(found.b_tangent), (13.0, 13.0)


def _polygon() -> Iterator[Finding]:
    corners = [
        (8.0, 1.0),
        (6.0, 6.5),
        (1.0, 8.5),
        (-5.5, 6.0),
        (-8.5, 2.0),
        (-7.5, -3.0),
        (2.5, -9.5),
        (5.0, -8.0),
    ]
    for count in (INLINE_VERTICES, 3):
        polygon = pymunk.Poly(None, corners[:count], radius=7.25)
        yield from _shape(polygon, POLYGON)
        found = polygon_at(polygon._shape)
        yield "a polygon's radius", (found.r,), (7.25,)
        yield "a polygon's vertex count", found.count, count
        inline = address(found.inline_planes)
        yield "a polygon's planes", address(found.planes), inline
        local = polygon.get_vertices()
        world = [_TRANSFORM @ vertex for vertex in local]
        planes = found.planes
        for i, vertex in enumerate(world):
            normal = (world[i - 1] - vertex).normalized().perpendicular()
            plane = tuple(planes[k] for k in range(4 * i, 4 * i + 4))
            yield "a polygon's vertices and normals", plane, (*vertex, *normal)
        for i, vertex in enumerate(local):
            k = 4 * (count + i)
            normal = (local[i - 1] - vertex).normalized().perpendicular()
            plane = tuple(planes[k] for k in range(k, k + 4))
            yield "a polygon's local vertices and normals", plane, (*vertex, *normal)
    many = pymunk.Poly(None, corners[: INLINE_VERTICES + 1])
    found = polygon_at(many._shape)
    outside = address(found.planes) != address(found.inline_planes)
    yield "how many planes are inline in a polygon", outside, True


def _class_functions() -> Iterator[Finding]:
    # With one function of the circles a segment answers the call of that one, and no other, as a
    # circle: where it keeps a circle's middle and radius it has a, then b, and the x of its normal.
    segment = pymunk.Segment(None, (1.5, 2.5), (4.5, 6.5), 0.25)
    found = shape_at(segment._shape)
    circles = shape_at(pymunk.Circle(None, 1.0)._shape).shape_class
    middle = _TRANSFORM @ segment.a
    above = middle + Vec2d(0.0, 10.0)
    corner = Vec2d(0.8, 0.8)
    with _borrowed(found, "cache_data", circles):
        box = tuple(segment.update(_TRANSFORM))
    yield "a class's cache_data", box, (*(middle - corner), *(middle + corner))
    with _borrowed(found, "point_query", circles):
        distance = segment.point_query(above).distance
    yield "a class's point_query", (distance,), (9.2,)
    with _borrowed(found, "segment_query", circles):
        hit = segment.segment_query(above, middle)
    yield "a class's segment_query", (hit.alpha if hit else nan,), (0.92,)


@contextmanager
def _borrowed(shape: Any, function: str, lender: Any) -> Iterator[None]:
    """Give a C shape its class with one function of another class for a while."""
    own = shape.klass
    mixed = ffi.new("ShapeClass *", shape.shape_class[0])
    setattr(mixed, function, getattr(lender, function))
    shape.klass = address(mixed)
    try:
        yield
    finally:
        shape.klass = own
