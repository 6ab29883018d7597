"""Where pymunk's bodies and shapes are in the world, as numbers."""

from __future__ import annotations

from math import sqrt
from typing import Any

from pymunk import Shape

from ._layout import neighbor_tangents
from ._pymunk import lib

# Position (x, y) and rotation vector (x, y) of a body: from local to world coordinates.
Transform = tuple[float, float, float, float]
IDENTITY: Transform = (0.0, 0.0, 1.0, 0.0)


def transform_of(cp_body: Any) -> Transform:
    """The transform of a C body."""
    position = lib.cpBodyGetPosition(cp_body)
    rotation = lib.cpBodyGetRotation(cp_body)
    return position.x, position.y, rotation.x, rotation.y


def body_transform(shape: Shape) -> Transform | None:
    """The transform of a shape's body, None if it has none."""
    body = shape.body
    return None if body is None else transform_of(body._body)


def center_of_gravity(cp_body: Any, transform: Transform) -> tuple[float, float]:
    """The point in the world from which Chipmunk measures contact points on a body."""
    x, y, cos, sin = transform
    local = lib.cpBodyGetCenterOfGravity(cp_body)
    local_x = local.x
    local_y = local.y
    return x + cos * local_x - sin * local_y, y + sin * local_x + cos * local_y


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


def spin(cp_body: Any) -> float:
    """The angular velocity of a body."""
    omega: float = lib.cpBodyGetAngularVelocity(cp_body)
    return omega


def surface_velocity(cp_a: Any, cp_b: Any) -> tuple[float, float]:
    """The surface velocity of shape b minus that of shape a."""
    a = lib.cpShapeGetSurfaceVelocity(cp_a)
    b = lib.cpShapeGetSurfaceVelocity(cp_b)
    return b.x - a.x, b.y - a.y
