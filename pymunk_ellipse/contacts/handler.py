"""Collision handlers that stand between Chipmunk and the user's callbacks, and the one that resolves contacts."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from pymunk import Arbiter, Space

from ..chipmunk.private import (
    PHASES,
    CollisionHandler,
    c_space,
    call_compiled,
    call_python,
    ffi,
    global_handler,
    handler_for,
    replace_handler,
)
from .backend import kernel
from .saved import SavedContacts, adopt

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
        for phase in PHASES:
            call_python(self._handler, phase, getattr(self, phase) is not None)


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
    """

    def __init__(self, handler: Any, space: Space) -> None:
        # How many ellipses there are in the space.
        self.ellipses = 0
        self._exact_impacts = False
        # Until the first contact of the space, which may be a copy of one at work.
        self.adopts = True
        # Contacts that came with a copy, and that arbiters point to.
        self._adopted: list[Any] = []
        super().__init__(handler, space)
        self._data[SavedContacts] = SavedContacts(space)

    def make_dispatcher(self) -> Dispatcher:
        return _ContactDispatcher(self)

    def in_python(self) -> bool:
        """Whether Python has something to do in pre_solve, besides resolving the contact."""
        return self._pre_solve is not None

    def wire(self) -> None:
        super().wire()
        python = self.in_python() or (self.adopts and self.ellipses > 0)
        call_python(self._handler, "pre_solve", python)
        if self.ellipses > 0 and not python:
            chosen = kernel()
            call_compiled(
                self._handler,
                chosen.pre_solve_with_impacts
                if self.exact_impacts
                else chosen.pre_solve,
            )

    @property
    def exact_impacts(self) -> bool:
        """Whether impacts are resolved at their own time."""
        return self._exact_impacts

    @exact_impacts.setter
    def exact_impacts(self, exact: bool) -> None:
        self._exact_impacts = exact
        self.wire()

    def enter(self) -> None:
        """Resolve contacts from now on: an ellipse has entered the space."""
        self.ellipses += 1
        if self.ellipses == 1:
            self.wire()

    def leave(self) -> None:
        """An ellipse has left the space."""
        self.ellipses -= 1
        if self.ellipses == 0:
            self.wire()

    def resolve(self, arbiter: Any) -> None:
        """Write the exact contact into a C arbiter, if it has an ellipse, before the first callback sees it."""
        if self.adopts:
            self.adopt(arbiter)
        kernel().resolve(arbiter, c_space(self._space), self._exact_impacts)

    def complete(self, arbiter: Any) -> None:
        """Complete a resolved contact by what callbacks have set, after the last of them."""
        kernel().complete(arbiter, c_space(self._space))

    def adopt(self, current: Any) -> None:
        """Take over the contacts of the space that this one is a copy of, when the first of them is at hand."""
        self.adopts = False
        self.wire()
        self._adopted = adopt(self._data[SavedContacts], self._space, current)


class _ContactDispatcher(Dispatcher):
    """Resolves the contact before the user's callback sees it, and completes it afterwards: it is the last that Chipmunk calls."""

    _handler: ContactHandler

    def _pre_solve(self, arbiter: Arbiter, space: Space, data: Any) -> None:
        handler = self._handler
        handler.resolve(arbiter._arbiter)
        try:
            super()._pre_solve(arbiter, space, data)
        finally:
            handler.complete(arbiter._arbiter)


_Handler = TypeVar("_Handler", bound=ChainedHandler)


def install(
    space: Space,
    make: Callable[[Any, Space], _Handler],
    collision_type_a: int | None = None,
    collision_type_b: int | None = None,
) -> _Handler:
    """Put a handler in the place of the space's handler for two collision types, with the callbacks that one had."""
    old = handler_for(space, collision_type_a, collision_type_b)
    handler = make(old._handler, space)
    handler._data.update(old.data)
    for phase in PHASES:
        setattr(handler, phase, getattr(old, phase))
    replace_handler(space, old, handler)
    return handler


def contact_handler(space: Space) -> ContactHandler | None:
    """The handler that resolves contacts in a space, None if there was no ellipse in it yet."""
    handler = global_handler(space)
    return handler if isinstance(handler, ContactHandler) else None


def enter(space: Space) -> None:
    """Resolve the contacts of an ellipse that has entered a space."""
    handler = contact_handler(space)
    if handler is None:
        handler = install(space, ContactHandler)
    handler.enter()


def leave(space: Space) -> None:
    """Forget an ellipse that leaves a space."""
    handler = contact_handler(space)
    if handler is not None:
        handler.leave()


def ellipses_in(space: Space) -> int:
    """How many ellipses there are in a space."""
    handler = contact_handler(space)
    return 0 if handler is None else handler.ellipses
