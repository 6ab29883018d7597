"""Every name of pymunk's that is not public, so that a new pymunk is the work of this folder."""

from __future__ import annotations

from typing import Any

import pymunk
from pymunk import BB, Body, Shape, ShapeFilter, Space
from pymunk._chipmunk_cffi import ffi, lib
from pymunk._collision_handler import CollisionHandler
from pymunk._util import _dead_ref
from pymunk.arbiter import _contact_to_dict

__all__ = ["CollisionHandler", "ffi", "lib"]

NULL = ffi.NULL

# Phases of a collision, as handlers name them.
PHASES = ("begin", "pre_solve", "post_solve", "separate")

# What a shape without a space refers to.
NO_SPACE = _dead_ref

_DO_NOTHING = ffi.addressof(lib, "DoNothing")

# Chipmunk's wildcard for a collision type.
_ANY_TYPE = int(ffi.cast("uintptr_t", ~0))

_GLOBAL = (None, None)

# The functions that call a handler's dispatcher, and the fields that hold them.
_CALLS = {
    "begin": ("beginFunc", lib.ext_cpCollisionBeginFunc),
    "pre_solve": ("preSolveFunc", lib.ext_cpCollisionPreSolveFunc),
    "post_solve": ("postSolveFunc", lib.ext_cpCollisionPostSolveFunc),
    "separate": ("separateFunc", lib.ext_cpCollisionSeparateFunc),
}


def call_python(handler: Any, phase: str, wanted: bool) -> None:
    """Have Chipmunk call what a C handler's user data stands for in a phase, or nothing."""
    field, function = _CALLS[phase]
    setattr(handler, field, function if wanted else _DO_NOTHING)


def call_compiled(handler: Any, pre_solve: Any) -> None:
    """Have Chipmunk call a C function in a handler's pre_solve."""
    handler.preSolveFunc = pre_solve


def pre_solve_function(place: int) -> Any:
    """The C function at an address, as collision handlers hold it."""
    return ffi.cast("cpCollisionPreSolveFunc", place)


def box_query_function(place: int) -> Any:
    """The C function at an address, as queries for the shapes in a box call it."""
    return ffi.cast("cpSpaceBBQueryFunc", place)


def query_box(
    space: Space, box: BB, shape_filter: ShapeFilter, function: Any, data: int
) -> None:
    """Have Chipmunk call a C function with each shape whose bounding box overlaps a box, and with an address."""
    lib.cpSpaceBBQuery(
        space._space, box, shape_filter, function, ffi.cast("void *", data)
    )


def c_space(space: Space) -> Any:
    """The cpSpace of a space."""
    return space._space


def c_body(body: Body) -> Any:
    """The cpBody of a body."""
    return body._body


def shape_behind(cp_shape: Any) -> Shape:
    """The pymunk shape that stands behind a C shape."""
    shape: Shape = ffi.from_handle(lib.cpShapeGetUserData(cp_shape))
    return shape


def shape_at_address(place: int) -> Shape:
    """The pymunk shape that stands behind the C shape at an address."""
    return shape_behind(ffi.cast("cpShape *", place))


def contact_at(pointer: Any) -> Any:
    """The cpContact that an arbiter's data points to."""
    return ffi.cast("struct cpContact *", pointer)


def contact_state(contact: Any) -> dict[str, Any]:
    """The numbers of a cpContact, as pymunk keeps them in a pickle."""
    state: dict[str, Any] = _contact_to_dict(contact)
    return state


def new_contact(state: dict[str, Any]) -> Any:
    """A cpContact with these numbers, which lives as long as it is referred to."""
    return ffi.new("struct cpContact *", state)


def arbiters_of(space: Space) -> list[Any]:
    """The C arbiters of a space."""
    arbiters: list[Any] = space._get_arbiters()
    return arbiters


def global_handler(space: Space) -> CollisionHandler | None:
    """The handler that space.on_collision(None, None) made, if any."""
    return space._handlers.get(_GLOBAL)


def handler_for(
    space: Space, collision_type_a: int | None, collision_type_b: int | None
) -> CollisionHandler:
    """The space's handler for two collision types, made if there is none."""
    key = collision_type_a, collision_type_b
    if key not in space._handlers:
        Space.on_collision(space, collision_type_a, collision_type_b)
    return space._handlers[key]


def replace_handler(space: Space, old: CollisionHandler, new: CollisionHandler) -> None:
    """Put a handler in the place of another one of the space."""
    for key, handler in space._handlers.items():
        if handler is old:
            space._handlers[key] = new


def call_all_handlers(phase: str, arbiter: Any, space: Space) -> None:
    """Call the callbacks for begin or separate of all handlers of an arbiter, as Chipmunk does (cpSpaceCollideShapes).

    This may be called while Chipmunk calls one of them, with the shapes swapped for that one.
    """
    swapped = arbiter.swapped
    first = arbiter.handlerAB.typeA
    arbiter.swapped = first not in (lib.cpShapeGetCollisionType(arbiter.a), _ANY_TYPE)
    field, _function = _CALLS[phase]
    handlers = (
        arbiter.handlerAB,
        arbiter.handlerBA,
        arbiter.handlerA,
        arbiter.handlerB,
        space._handlers[_GLOBAL]._handler,
    )
    for i, handler in enumerate(handlers):
        swaps = i % 2 == 1
        if swaps:
            arbiter.swapped = not arbiter.swapped
        getattr(handler, field)(arbiter, space._space, handler.userData)
        if swaps:
            arbiter.swapped = not arbiter.swapped
    arbiter.swapped = swapped


def new_polygon(
    shape: pymunk.Poly,
    body: pymunk.Body | None,
    vertices: Any,
    transform: tuple[float, float, float, float, float, float],
    radius: float,
) -> None:
    """Make a pymunk.Poly, which is not initialised yet, of the transformed vertices.

    The constructor takes a list of points; an array of C, with a transform for each shape, takes
    a third of the time.
    """
    cp_body = NULL if body is None else body._body
    shape._init(
        body,
        lib.cpPolyShapeNew(cp_body, len(vertices), vertices, transform, radius),
    )


def set_polygon(
    shape: pymunk.Poly,
    vertices: Any,
    transform: tuple[float, float, float, float, float, float],
    radius: float,
) -> None:
    """Give a pymunk.Poly other vertices, transformed, and another radius."""
    lib.cpPolyShapeSetVerts(shape._shape, len(vertices), vertices, transform)
    lib.cpPolyShapeSetRadius(shape._shape, radius)


def c_points(points: list[tuple[float, float]]) -> Any:
    """Points as an array of C."""
    return ffi.new("cpVect[]", points)
