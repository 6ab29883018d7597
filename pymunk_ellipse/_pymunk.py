"""All that this package needs of what pymunk keeps private: a new pymunk is this one file's work."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from typing import Any, Protocol, TypeVar

from pymunk import Arbiter, Shape, Space
from pymunk._chipmunk_cffi import ffi, lib
from pymunk._collision_handler import CollisionHandler
from pymunk._util import _dead_ref
from pymunk.arbiter import _contact_to_dict

from .narrowphase.placement import Frame

__all__ = ["CollisionHandler", "ffi", "lib"]

# States of an arbiter (chipmunk_structs.h).
FIRST_COLLISION = 0
NORMAL = 1
IGNORE = 2
CACHED = 3

# Phases of a collision, as handlers name them.
PHASES = ("begin", "pre_solve", "post_solve", "separate")

NULL = ffi.NULL

# Chipmunk's wildcard for a collision type.
_ANY_TYPE = int(ffi.cast("uintptr_t", ~0))

_NOTHING = ffi.addressof(lib, "DoNothing")

# What a shape without a space refers to.
NO_SPACE = _dead_ref

_GLOBAL = (None, None)


def address(pointer: Any) -> int:
    """The address that a C pointer holds."""
    return int(ffi.cast("uintptr_t", pointer))


def contact_name(arbiter: Any) -> int:
    """What the hash of an arbiter's contact is set to: the arbiter's address, and in its lowest bit the shapes' order.

    Chipmunk may swap the two shapes from step to step.
    """
    in_order: bool = arbiter.a < arbiter.b
    return int(ffi.cast("uintptr_t", arbiter)) | in_order


def contact_at(pointer: Any) -> Any:
    """The cpContact that an arbiter's data points to."""
    return ffi.cast("struct cpContact *", pointer)


def shape_at(cp_shape: Any) -> Shape:
    """The pymunk shape that stands behind a C shape."""
    shape: Shape = ffi.from_handle(lib.cpShapeGetUserData(cp_shape))
    return shape


class CCallback(Protocol):
    """A compiled callback, as numba.cfunc makes it."""

    address: int


def c_callback(callback: CCallback) -> Any:
    """A callback as the C function pointer that collision handlers hold; it keeps the callback alive."""
    pointer = ffi.cast("cpCollisionPreSolveFunc", callback.address)
    _kept.append(callback)
    return pointer


_kept: list[CCallback] = []


Callback = Callable[[Arbiter, Space, Any], None]


def _users_callback(phase: str) -> property:
    """A property that holds the user's callback for a phase, and wires the C callbacks anew when it is set."""
    attribute = f"_{phase}"

    def get(handler: ChainedHandler) -> Callback | None:
        callback: Callback | None = getattr(handler, attribute)
        return callback

    def set(handler: ChainedHandler, callback: Callback | None) -> None:
        setattr(handler, attribute, callback)
        handler.wire()

    return property(get, set, doc=f"The user's callback for {phase}.")


class ChainedHandler(CollisionHandler):
    """A handler that stands between pymunk's C callbacks and the user's.

    To pymunk, in space.on_collision and in copies of the space, it shows the user's callbacks.
    The C callbacks see dispatcher: an object with _space, data, and the four methods _begin,
    _pre_solve, _post_solve and _separate. wire says which of them are called at all.
    """

    def __init__(self, handler: Any, space: Space) -> None:
        super().__init__(handler, space)
        self._data.update(dict.fromkeys(PHASES))
        self._dispatcher = self.make_dispatcher()
        self._dispatcher_handle = ffi.new_handle(self._dispatcher)
        handler.userData = self._dispatcher_handle
        self.wire()

    begin = _users_callback("begin")
    pre_solve = _users_callback("pre_solve")
    post_solve = _users_callback("post_solve")
    separate = _users_callback("separate")

    def make_dispatcher(self) -> Dispatcher:
        """What the C callbacks call."""
        return Dispatcher(self)

    def wire(self) -> None:
        """Have C call the phases for which the user has a callback."""
        self.call_begin(self._begin is not None)
        self.call_pre_solve(self._pre_solve is not None)
        self.call_post_solve(self._post_solve is not None)
        self.call_separate(self._separate is not None)

    def call_begin(self, wanted: bool) -> None:
        """Have C call the dispatcher's _begin, or not."""
        function = lib.ext_cpCollisionBeginFunc if wanted else _NOTHING
        self._handler.beginFunc = function

    def call_pre_solve(self, wanted: bool, compiled: Any | None = None) -> None:
        """Have C call the dispatcher's _pre_solve, or else a compiled callback or nothing."""
        function = lib.ext_cpCollisionPreSolveFunc if wanted else compiled
        self._handler.preSolveFunc = _NOTHING if function is None else function

    def call_post_solve(self, wanted: bool) -> None:
        """Have C call the dispatcher's _post_solve, or not."""
        function = lib.ext_cpCollisionPostSolveFunc if wanted else _NOTHING
        self._handler.postSolveFunc = function

    def call_separate(self, wanted: bool) -> None:
        """Have C call the dispatcher's _separate, or not."""
        function = lib.ext_cpCollisionSeparateFunc if wanted else _NOTHING
        self._handler.separateFunc = function


class Dispatcher:
    """Calls the user's callbacks of a handler."""

    def __init__(self, handler: ChainedHandler) -> None:
        self._handler = handler
        self._space = handler._space
        self.data = handler.data

    def _begin(self, arbiter: Arbiter, space: Space, data: Any) -> None:
        if self._handler._begin is not None:
            self._handler._begin(arbiter, space, data)

    def _pre_solve(self, arbiter: Arbiter, space: Space, data: Any) -> None:
        if self._handler._pre_solve is not None:
            self._handler._pre_solve(arbiter, space, data)

    def _post_solve(self, arbiter: Arbiter, space: Space, data: Any) -> None:
        if self._handler._post_solve is not None:
            self._handler._post_solve(arbiter, space, data)

    def _separate(self, arbiter: Arbiter, space: Space, data: Any) -> None:
        if self._handler._separate is not None:
            self._handler._separate(arbiter, space, data)


class ContactHandler(ChainedHandler):
    """The handler of all collisions in a space with ellipses: resolves the contact, then calls the user's callback.

    It takes the place that space.on_collision(None, None, ...) looks up, so that callbacks the
    user sets there, earlier or later, chain with the contacts instead of replacing them.

    python is pre_solve in Python, and find_compiled returns the C function pointer that does
    the same, or None; it is asked when the first ellipse enters. frames are those of the
    ellipses in the space, by their C shapes.
    """

    def __init__(
        self,
        handler: Any,
        space: Space,
        python: Callable[[dict[Any, Frame], Any], None],
        find_compiled: Callable[[], Any | None],
    ) -> None:
        self.frames: dict[Any, Frame] = {}
        self.python = python
        self.find_compiled = find_compiled
        self.compiled: Any | None = None
        # Until the first contact of the space, which may be a copy of one at work.
        self.adopts = True
        self._adopted: list[Any] = []
        super().__init__(handler, space)
        self._data[SavedContacts] = SavedContacts(space)

    def make_dispatcher(self) -> Dispatcher:
        return _ContactDispatcher(self)

    def wire(self) -> None:
        super().wire()
        self.call_resolve(self._pre_solve is not None)

    def call_resolve(self, chained: bool) -> None:
        """Have C resolve contacts, by way of the dispatcher if a callback is chained."""
        if not self.frames:
            self.call_pre_solve(chained)
        else:
            self.call_pre_solve(
                chained or self.adopts or self.compiled is None, self.compiled
            )

    def enter(self, cp_shape: Any, frame: Frame) -> None:
        """Resolve the contacts of an ellipse from now on; again with another frame when it changes."""
        if not self.frames:
            self.compiled = self.find_compiled()
        self.frames[cp_shape] = frame
        self.wire()

    def leave(self, cp_shape: Any) -> None:
        """Forget an ellipse that leaves the space."""
        self.frames.pop(cp_shape, None)
        if not self.frames:
            self.wire()

    def resolve(self, arbiter: Any) -> None:
        """Write the exact contact into an arbiter, if it has an ellipse."""
        if self.adopts:
            self.adopt_contacts(arbiter)
        if self.compiled is not None:
            self.compiled(arbiter, NULL, NULL)
        else:
            self.python(self.frames, arbiter)

    def adopt_contacts(self, current: Any) -> None:
        """Take over the contacts of a space that this one is a copy of, when the first of them is at hand.

        pymunk restores arbiters with their contacts, but not with the data that points to them,
        and the contact of the arbiter at hand is gone already.
        """
        self.adopts = False
        self.wire()
        saved = self._data[SavedContacts].by_pair()
        for arbiter in self._space._get_arbiters():
            contact = saved.get((address(arbiter.a), address(arbiter.b)))
            if contact is not None:
                arbiter.data = adopted = ffi.new("struct cpContact *", contact)
                adopted.hash = contact_name(arbiter)
                self._adopted.append(adopted)
            elif (
                # A pymunk that does not copy a handler's data.
                not saved
                and arbiter != current
                and arbiter.count > 0
                and (arbiter.a in self.frames or arbiter.b in self.frames)
            ):
                arbiter.contacts[0].hash = contact_name(arbiter)
                arbiter.data = arbiter.contacts


class _ContactDispatcher(Dispatcher):
    """Resolves the contact before the user's callback sees it."""

    _handler: ContactHandler

    def _pre_solve(self, arbiter: Arbiter, space: Space, data: Any) -> None:
        handler = self._handler
        handler.resolve(arbiter._arbiter)
        if handler._pre_solve is not None:
            handler._pre_solve(arbiter, space, data)


class SavedContacts:
    """The contacts of a space's arbiters, gathered when a copy or a pickle of the space is made.

    It is among the data of a handler, with which pymunk copies it.
    """

    def __init__(self, space: Space) -> None:
        self._space = weakref.ref(space)
        self._contacts: list[tuple[Shape, Shape, dict[str, Any]]] = []

    def by_pair(self) -> dict[tuple[int, int], dict[str, Any]]:
        """The contacts by the addresses of the two shapes, in either order."""
        pairs = {}
        for first, second, contact in self._contacts:
            a, b = address(first._shape), address(second._shape)
            pairs[a, b] = contact
            pairs[b, a] = {**contact, "r1": contact["r2"], "r2": contact["r1"]}
        return pairs

    def __getstate__(self) -> list[tuple[Shape, Shape, dict[str, Any]]]:
        space = self._space()
        if space is None:
            return []
        return [
            (
                shape_at(arbiter.a),
                shape_at(arbiter.b),
                _contact_to_dict(contact_at(arbiter.data)),
            )
            for arbiter in space._get_arbiters()
            if arbiter.data and arbiter.state < CACHED
        ]

    def __setstate__(self, contacts: list[tuple[Shape, Shape, dict[str, Any]]]) -> None:
        self._space = NO_SPACE
        self._contacts = contacts


def global_handler(space: Space) -> CollisionHandler | None:
    """The handler that space.on_collision(None, None) made, if any."""
    return space._handlers.get(_GLOBAL)


_Handler = TypeVar("_Handler", bound=ChainedHandler)


def install(
    space: Space,
    make: Callable[[Any, Space], _Handler],
    collision_type_a: int | None = None,
    collision_type_b: int | None = None,
) -> _Handler:
    """Put a handler in the place of the space's handler for two collision types, with the callbacks that one had."""
    key = collision_type_a, collision_type_b
    if key not in space._handlers:
        Space.on_collision(space, collision_type_a, collision_type_b)
    old = space._handlers[key]
    handler = make(old._handler, space)
    handler._data.update(old.data)
    for phase in PHASES:
        setattr(handler, phase, getattr(old, phase))
    space._handlers[key] = handler
    return handler


def call_all_handlers(
    phase: str, arbiter: Any, space: Space, last: ContactHandler
) -> None:
    """Call the callbacks for a phase of all handlers of an arbiter, as Chipmunk does (cpSpaceCollideShapes).

    This may be called while it calls one of them, with the shapes swapped for that one.
    """
    swapped = arbiter.swapped
    first = arbiter.handlerAB.typeA
    arbiter.swapped = first not in (lib.cpShapeGetCollisionType(arbiter.a), _ANY_TYPE)
    function = {"begin": "beginFunc", "separate": "separateFunc"}[phase]
    handlers = (
        arbiter.handlerAB,
        arbiter.handlerBA,
        arbiter.handlerA,
        arbiter.handlerB,
        last._handler,
    )
    for i, handler in enumerate(handlers):
        swaps = i % 2 == 1
        if swaps:
            arbiter.swapped = not arbiter.swapped
        getattr(handler, function)(arbiter, space._space, handler.userData)
        if swaps:
            arbiter.swapped = not arbiter.swapped
    arbiter.swapped = swapped
