"""All that this package needs of what pymunk keeps private: a new pymunk is this one file's work."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from typing import Any, Protocol

from pymunk import Arbiter, Shape, Space
from pymunk._chipmunk_cffi import ffi, lib
from pymunk._collision_handler import CollisionHandler
from pymunk._util import _dead_ref
from pymunk.arbiter import _contact_to_dict

from .narrowphase.placement import Frame

__all__ = ["ffi", "lib"]

# States of an arbiter (chipmunk_structs.h).
FIRST_COLLISION = 0
NORMAL = 1
IGNORE = 2

NULL = ffi.NULL

# What a shape without a space refers to.
NO_SPACE = _dead_ref

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


class CCallback(Protocol):
    """A compiled callback, as numba.cfunc makes it."""

    address: int


def c_callback(callback: CCallback) -> Any:
    """A callback as the C function pointer that collision handlers hold; it keeps the callback alive."""
    pointer = ffi.cast("cpCollisionPreSolveFunc", callback.address)
    _kept.append(callback)
    return pointer


_kept: list[CCallback] = []


class ContactHandler(CollisionHandler):
    """The handler of every collision in a space with ellipses: resolves the contact, then calls the user's callbacks.

    It takes the place that space.on_collision(None, None, ...) looks up, so that callbacks the
    user sets there, earlier or later, chain with the contacts instead of replacing them. To
    pymunk, and in copies of the space, it shows the user's callbacks only.

    resolve is pre_solve in Python, compiled the C function pointer that does the same, or None.
    frames are those of the ellipses in the space by their C shapes, for resolve.
    """

    def __init__(
        self,
        handler: Any,
        space: Space,
        resolve: Callable[[dict[Any, Frame], Any], None],
        compiled: Any | None,
    ) -> None:
        super().__init__(handler, space)
        self.frames: dict[Any, Frame] = {}
        self.resolve = resolve
        self.compiled = compiled
        # Until the first contact of the space, which may be a copy of one at work.
        self.adopts = True
        self._data["pre_solve"] = None
        self._data[SavedContacts] = SavedContacts(space)
        self._dispatcher = _Dispatcher(self)
        self._dispatcher_handle = ffi.new_handle(self._dispatcher)
        handler.userData = self._dispatcher_handle
        self.pre_solve = None

    @property
    def pre_solve(self) -> Callable[[Arbiter, Space, Any], None] | None:
        """The user's callback."""
        return self._pre_solve

    @pre_solve.setter
    def pre_solve(self, func: Callable[[Arbiter, Space, Any], None] | None) -> None:
        self._pre_solve = func
        self._wire()

    def _wire(self) -> None:
        if self.compiled is None or self._pre_solve is not None or self.adopts:
            self._handler.preSolveFunc = lib.ext_cpCollisionPreSolveFunc
        else:
            self._handler.preSolveFunc = self.compiled

    def adopt_contacts(self, current: Any) -> None:
        """Take over the contacts of a space that this one is a copy of, when the first of them is resolved.

        pymunk restores arbiters with their contacts and impulses, but not with the data that
        points to them. The contact of the arbiter at hand is gone already and comes from
        SavedContacts.
        """
        self.adopts = False
        self._wire()
        for arbiter in self._space._get_arbiters():
            if arbiter.data or arbiter.state != NORMAL:
                continue
            if arbiter.a not in self.frames and arbiter.b not in self.frames:
                continue
            if arbiter == current:
                saved = self._data[SavedContacts].find(
                    shape_at(arbiter.a), shape_at(arbiter.b)
                )
                if saved is not None:
                    self._first_contact = ffi.new("struct cpContact *", saved)
                    self._first_contact.hash = address(arbiter.a)
                    arbiter.data = self._first_contact
            elif arbiter.count > 0:
                arbiter.contacts[0].hash = address(arbiter.a)
                arbiter.data = arbiter.contacts


class SavedContacts:
    """The contacts of a space's arbiters, gathered when a copy or a pickle of the space is made.

    It is among the data of a handler, with which pymunk copies it.
    """

    def __init__(self, space: Space) -> None:
        self._space = weakref.ref(space)
        self._contacts: list[tuple[Shape, Shape, dict[str, Any]]] = []

    def find(self, a: Shape, b: Shape) -> dict[str, Any] | None:
        """The contact of two shapes when the copy was made, None if they did not touch."""
        for first, second, contact in self._contacts:
            if first is a and second is b:
                return contact
            if first is b and second is a:
                return {**contact, "r1": contact["r2"], "r2": contact["r1"]}
        return None

    def __getstate__(self) -> list[tuple[Shape, Shape, dict[str, Any]]]:
        space = self._space()
        if space is None:
            return []
        return [
            (
                shape_at(arbiter.a),
                shape_at(arbiter.b),
                _contact_to_dict(arbiter.contacts[0]),
            )
            for arbiter in space._get_arbiters()
            if arbiter.data and arbiter.count > 0
        ]

    def __setstate__(self, contacts: list[tuple[Shape, Shape, dict[str, Any]]]) -> None:
        self._space = NO_SPACE
        self._contacts = contacts


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
        if handler.adopts:
            handler.adopt_contacts(arbiter._arbiter)
        if handler.compiled is not None:
            handler.compiled(arbiter._arbiter, NULL, NULL)
        else:
            handler.resolve(handler.frames, arbiter._arbiter)
        if handler._pre_solve is not None:
            handler._pre_solve(arbiter, space, data)

    def _post_solve(self, arbiter: Arbiter, space: Space, data: Any) -> None:
        assert self._handler.post_solve is not None
        self._handler.post_solve(arbiter, space, data)

    def _separate(self, arbiter: Arbiter, space: Space, data: Any) -> None:
        assert self._handler.separate is not None
        self._handler.separate(arbiter, space, data)


def global_handler(space: Space) -> CollisionHandler | None:
    """The handler that space.on_collision(None, None) made, if any."""
    return space._handlers.get(_GLOBAL)


def install(
    space: Space,
    resolve: Callable[[dict[Any, Frame], Any], None],
    compiled: Any | None,
) -> ContactHandler:
    """Put a ContactHandler in the place of the space's global handler, with the callbacks it had."""
    if _GLOBAL not in space._handlers:
        space.on_collision(None, None)
    old = space._handlers[_GLOBAL]
    handler = ContactHandler(old._handler, space, resolve, compiled)
    handler._data.update(old.data)
    handler.begin = old.begin
    handler.pre_solve = old.pre_solve
    handler.post_solve = old.post_solve
    handler.separate = old.separate
    space._handlers[_GLOBAL] = handler
    return handler
