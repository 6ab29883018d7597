"""All that this package needs of what pymunk keeps private: a new pymunk is this one file's work."""

from __future__ import annotations

from math import isclose, sqrt
from typing import Any, Callable, Optional, Protocol

from pymunk import Arbiter, Segment, Shape, Space
from pymunk import Transform as _Transform
from pymunk._chipmunk_cffi import ffi, lib
from pymunk._collision_handler import CollisionHandler
from pymunk._util import _dead_ref

# States of an arbiter (chipmunk_structs.h).
FIRST_COLLISION = 0
NORMAL = 1
IGNORE = 2

NULL = ffi.NULL

# What a shape without a space refers to.
NO_SPACE = _dead_ref

# Position (x, y) and rotation vector (x, y) of a body: from local to world coordinates.
Transform = tuple[float, float, float, float]
IDENTITY: Transform = (0.0, 0.0, 1.0, 0.0)

_GLOBAL = (None, None)


def address(pointer: Any) -> int:
    """The address that a C pointer holds."""
    return int(ffi.cast("uintptr_t", pointer))


def contact_at(pointer: Any) -> Any:
    """The cpContact that an arbiter's data points to."""
    return ffi.cast("struct cpContact *", pointer)


def shape_at(cp_shape: Any) -> Shape:
    """The pymunk shape that stands behind a C shape."""
    shape: Shape = ffi.from_handle(lib.cpShapeGetUserData(cp_shape))
    return shape


def transform_of(cp_body: Any) -> Transform:
    """The transform of a C body."""
    position = lib.cpBodyGetPosition(cp_body)
    rotation = lib.cpBodyGetRotation(cp_body)
    return position.x, position.y, rotation.x, rotation.y


def body_transform(shape: Shape) -> Optional[Transform]:
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


def circle_in_world(
    cp_shape: Any, transform: Transform
) -> tuple[float, float, float]:
    """Center (x, y) and radius of a circle."""
    x, y, cos, sin = transform
    offset = lib.cpCircleShapeGetOffset(cp_shape)
    ox = offset.x
    oy = offset.y
    radius = lib.cpCircleShapeGetRadius(cp_shape)
    return x + cos * ox - sin * oy, y + sin * ox + cos * oy, radius


def segment_in_world(
    cp_shape: Any, transform: Transform
) -> tuple[
    tuple[float, float, float, float], tuple[float, float, float, float], float
]:
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
    planes = []
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


class Contacts(Protocol):
    """What resolves the contacts of a space."""

    def resolve(self, arbiter: Any) -> None:
        """Write the exact contact into a cpArbiter."""


class ContactHandler(CollisionHandler):
    """The handler of every collision in a space with ellipses: resolves the contact, then calls the user's callbacks.

    It takes the place that space.on_collision(None, None, ...) looks up, so that callbacks the
    user sets there, earlier or later, chain with the contacts instead of replacing them. To
    pymunk, and in copies of the space, it shows the user's callbacks only.
    """

    def __init__(self, handler: Any, space: Space, contacts: Contacts) -> None:
        super().__init__(handler, space)
        self.contacts = contacts
        self._data["pre_solve"] = None
        self._dispatcher = _Dispatcher(self)
        self._dispatcher_handle = ffi.new_handle(self._dispatcher)
        handler.userData = self._dispatcher_handle
        self.pre_solve = None

    @property
    def pre_solve(self) -> Optional[Callable[[Arbiter, Space, Any], None]]:
        """The user's callback."""
        return self._pre_solve

    @pre_solve.setter
    def pre_solve(
        self, func: Optional[Callable[[Arbiter, Space, Any], None]]
    ) -> None:
        self._pre_solve = func
        self._handler.preSolveFunc = lib.ext_cpCollisionPreSolveFunc


class _Dispatcher:
    """What pymunk's C callbacks see of a ContactHandler."""

    def __init__(self, handler: ContactHandler) -> None:
        self._handler = handler
        self._space = handler._space
        self.data = handler.data

    def _begin(self, arbiter: Arbiter, space: Space, data: Any) -> None:
        assert self._handler.begin is not None
        self._handler.begin(arbiter, space, data)

    def _pre_solve(self, arbiter: Arbiter, space: Space, data: Any) -> None:
        handler = self._handler
        handler.contacts.resolve(arbiter._arbiter)
        if handler._pre_solve is not None:
            handler._pre_solve(arbiter, space, data)

    def _post_solve(self, arbiter: Arbiter, space: Space, data: Any) -> None:
        assert self._handler.post_solve is not None
        self._handler.post_solve(arbiter, space, data)

    def _separate(self, arbiter: Arbiter, space: Space, data: Any) -> None:
        assert self._handler.separate is not None
        self._handler.separate(arbiter, space, data)


def global_handler(space: Space) -> Optional[CollisionHandler]:
    """The handler that space.on_collision(None, None) made, if any."""
    return space._handlers.get(_GLOBAL)


def install(space: Space, contacts: Contacts) -> ContactHandler:
    """Put a ContactHandler in the place of the space's global handler, with the callbacks it had."""
    if _GLOBAL not in space._handlers:
        space.on_collision(None, None)
    old = space._handlers[_GLOBAL]
    handler = ContactHandler(old._handler, space, contacts)
    handler._data.update(old.data)
    handler.begin = old.begin
    handler.pre_solve = old.pre_solve
    handler.post_solve = old.post_solve
    handler.separate = old.separate
    space._handlers[_GLOBAL] = handler
    return handler


def _doubles_at(pointer: Any, offset: int, count: int) -> list[float]:
    """Doubles in a C struct."""
    field = ffi.cast("double *", ffi.cast("char *", pointer) + offset)
    return [field[i] for i in range(count)]


# Where a cpSegmentShape's own fields begin, behind its cpShape, by the size of a pointer
# (chipmunk_structs.h of Munk2D): a, b and n, the same three in the world, r, and the tangents
# at a and b, all doubles.
_SEGMENT_FIELDS = {8: 192, 4: 160}.get(ffi.sizeof("void *"), 0)
_SEGMENT_TANGENTS = _SEGMENT_FIELDS + 13 * 8


def _segment_fields_are_proved() -> bool:
    """Whether a segment of known numbers has each where _SEGMENT_FIELDS says, read one by one up to the first miss."""
    segment = Segment(None, (1.5, 2.5), (4.5, 6.5), 7.25)
    segment.set_neighbors((11.5, 13.5), (17.5, 19.5))
    segment.update(_Transform.identity())
    expected = (1.5, 2.5, 4.5, 6.5, 0.8, -0.6) * 2 + (7.25, 10.0, 11.0, 13.0, 13.0)
    return _SEGMENT_FIELDS > 0 and all(
        isclose(_doubles_at(segment._shape, _SEGMENT_FIELDS + 8 * i, 1)[0], number)
        for i, number in enumerate(expected)
    )


_READS_TANGENTS = _segment_fields_are_proved()


def neighbor_tangents(cp_shape: Any) -> tuple[float, float, float, float]:
    """From the two ends of a segment to the far ends of its neighbours, in local coordinates; zero without any.

    Chipmunk has no getter for what Segment.set_neighbors set, so it is read from the struct,
    and taken for zero where the struct is not as known.
    """
    if not _READS_TANGENTS:
        return 0.0, 0.0, 0.0, 0.0
    before_x, before_y, after_x, after_y = _doubles_at(cp_shape, _SEGMENT_TANGENTS, 4)
    return before_x, before_y, after_x, after_y
