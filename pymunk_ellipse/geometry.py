"""Where pymunk's bodies and shapes are in the world, as numbers."""

from __future__ import annotations

from math import sqrt
from typing import Any

from pymunk import Shape

from ._layout import (
    BODY_POSITION,
    BODY_SPIN,
    BODY_TRANSFORM,
    neighbor_tangents,
    unproved,
)
from ._pymunk import ffi, lib

# Position (x, y) and rotation vector (x, y) of a body: from local to world coordinates.
Transform = tuple[float, float, float, float]
IDENTITY: Transform = (0.0, 0.0, 1.0, 0.0)

# Fields of a body, counted in doubles.
_COS = BODY_TRANSFORM // 8
_SIN = _COS + 1
_X = _COS + 4
_Y = _COS + 5
_GRAVITY_X = BODY_POSITION // 8
_GRAVITY_Y = _GRAVITY_X + 1
_SPIN = BODY_SPIN // 8


def transform_of(cp_body: Any) -> Transform:
    """The transform of a C body."""
    position = lib.cpBodyGetPosition(cp_body)
    rotation = lib.cpBodyGetRotation(cp_body)
    return position.x, position.y, rotation.x, rotation.y


def state_of(cp_body: Any) -> tuple[float, float, float, float, float, float, float]:
    """The transform (four numbers), the centre of gravity in the world (x, y) and the angular velocity of a C body.

    Chipmunk measures contact points from the centre of gravity.
    """
    if unproved() is None:
        body = ffi.cast("double *", cp_body)
        return (
            body[_X],
            body[_Y],
            body[_COS],
            body[_SIN],
            body[_GRAVITY_X],
            body[_GRAVITY_Y],
            body[_SPIN],
        )
    x, y, cos, sin = transform_of(cp_body)
    local = lib.cpBodyGetCenterOfGravity(cp_body)
    return (
        x,
        y,
        cos,
        sin,
        x + cos * local.x - sin * local.y,
        y + sin * local.x + cos * local.y,
        lib.cpBodyGetAngularVelocity(cp_body),
    )


def body_transform(shape: Shape) -> Transform | None:
    """The transform of a shape's body, None if it has none."""
    body = shape.body
    return None if body is None else transform_of(body._body)


def circle_in_world(cp_shape: Any, transform: Transform) -> tuple[float, float, float]:
    """Center (x, y) and radius of a circle."""
    x, y, cos, sin = transform
    offset = lib.cpCircleShapeGetOffset(cp_shape)
    ox = offset.x
    oy = offset.y
    radius = lib.cpCircleShapeGetRadius(cp_shape)
    return x + cos * ox - sin * oy, y + sin * ox + cos * oy, radius


def segment_in_world(
    cp_shape: Any, transform: Transform
) -> tuple[tuple[float, float, float, float], tuple[float, float, float, float], float]:
    """Both ends of a segment, the tangents there that lead to its neighbours, and its radius."""
    x, y, cos, sin = transform
    start = lib.cpSegmentShapeGetA(cp_shape)
    sx = start.x
    sy = start.y
    end = lib.cpSegmentShapeGetB(cp_shape)
    ex = end.x
    ey = end.y
    ends = (
        x + cos * sx - sin * sy,
        y + sin * sx + cos * sy,
        x + cos * ex - sin * ey,
        y + sin * ex + cos * ey,
    )
    bx, by, ax, ay = neighbor_tangents(cp_shape)
    tangents = (
        cos * bx - sin * by,
        sin * bx + cos * by,
        cos * ax - sin * ay,
        sin * ax + cos * ay,
    )
    return ends, tangents, lib.cpSegmentShapeGetRadius(cp_shape)


def polygon_in_world(
    cp_shape: Any, transform: Transform
) -> tuple[list[float], int, float]:
    """Splitting planes (vertex and outward normal of the face that ends there), their number, and radius of a polygon."""
    x, y, cos, sin = transform
    count = lib.cpPolyShapeGetCount(cp_shape)
    corners = []
    for i in range(count):
        vertex = lib.cpPolyShapeGetVert(cp_shape, i)
        vx = vertex.x
        vy = vertex.y
        corners.append((x + cos * vx - sin * vy, y + sin * vx + cos * vy))
    planes: list[float] = []
    last_x, last_y = corners[-1]
    for vx, vy in corners:
        ex = vx - last_x
        ey = vy - last_y
        length = sqrt(ex * ex + ey * ey)
        if length > 0.0:
            planes += (vx, vy, ey / length, -ex / length)
        else:
            planes += (vx, vy, 0.0, 0.0)
        last_x = vx
        last_y = vy
    return planes, count, lib.cpPolyShapeGetRadius(cp_shape)


def surface_velocity(cp_a: Any, cp_b: Any) -> tuple[float, float]:
    """The surface velocity of shape b minus that of shape a."""
    a = lib.cpShapeGetSurfaceVelocity(cp_a)
    b = lib.cpShapeGetSurfaceVelocity(cp_b)
    return b.x - a.x, b.y - a.y
