"""EventSpace: collision callbacks that begin, last and end with the contact of the ellipses, not of their hulls."""

from __future__ import annotations

from typing import Any

import pymunk
from pymunk import Arbiter

from ..chipmunk.private import CollisionHandler, call_all_handlers, call_python
from ..chipmunk.structs import CACHED, FIRST_COLLISION, IGNORE
from .handler import Callback, ChainedHandler, ContactHandler, Dispatcher, install
from .saved import with_ellipse


class Touches:
    """Tells the user when pairs with an ellipse begin and cease to touch.

    Chipmunk calls begin and separate when hulls begin and cease to overlap. The first callback
    that it calls for a pair in a step resolves the contact here, and tells the user of a touch
    that begins or ends by calling the handlers again, as Chipmunk would. Whether two touched in
    the last step is seen from the arbiter's data, see resolver.pre_solve.
    """

    def __init__(self, contacts: ContactHandler) -> None:
        self.contacts = contacts
        # Whether a call comes from here, rather than from Chipmunk.
        self.telling = False
        # The pair that was resolved last in this step.
        self.current: Any = None
        # The first shape and the normal (x, y) of pairs when they touched last.
        self.normals: dict[Any, tuple[Any, float, float]] = {}

    def touch(self, arbiter: Any, space: pymunk.Space) -> bool:
        """Whether the two shapes touch, after telling of it if that is new."""
        if arbiter != self.current:
            self.current = arbiter
            if self.contacts.adopts:
                self.contacts.adopt(arbiter)
            touched = arbiter.data and arbiter.state != FIRST_COLLISION
            self.contacts.resolve(arbiter)
            if arbiter.state == IGNORE:
                if touched:
                    self._part(arbiter, space)
            else:
                normal = arbiter.n
                self.normals[arbiter] = arbiter.a, normal.x, normal.y
                if arbiter.state == FIRST_COLLISION:
                    self._tell("begin", arbiter, space)
        return bool(arbiter.state != IGNORE)

    def _part(self, arbiter: Any, space: pymunk.Space) -> None:
        # As it is when Chipmunk calls separate: without contact points, and with the normal of
        # the last touch.
        arbiter.state = CACHED
        normal = arbiter.n
        last = self.normals.pop(arbiter, (arbiter.a, normal.x, normal.y))
        sign = 1.0 if last[0] == arbiter.a else -1.0
        normal.x = sign * last[1]
        normal.y = sign * last[2]
        self._tell("separate", arbiter, space)
        arbiter.state = IGNORE
        # What a callback set lasts until the two part.
        arbiter.processCollision = True

    def _tell(self, phase: str, arbiter: Any, space: pymunk.Space) -> None:
        self.telling = True
        try:
            call_all_handlers(phase, arbiter, space)
        finally:
            self.telling = False


class _EventDispatcher(Dispatcher):
    """Passes Chipmunk's calls on to the user for the pairs that it judges rightly, and exact ones for the others."""

    def __init__(self, handler: ChainedHandler, touches: Touches) -> None:
        super().__init__(handler)
        self._touches = touches

    def _begin(self, arbiter: Arbiter, space: pymunk.Space, data: Any) -> None:
        touches = self._touches
        if touches.telling or not with_ellipse(arbiter._arbiter):
            super()._begin(arbiter, space, data)

    def _pre_solve(self, arbiter: Arbiter, space: pymunk.Space, data: Any) -> None:
        touches = self._touches
        pair = arbiter._arbiter
        if not with_ellipse(pair) or touches.touch(pair, space):
            super()._pre_solve(arbiter, space, data)

    def _separate(self, arbiter: Arbiter, space: pymunk.Space, data: Any) -> None:
        touches = self._touches
        pair = arbiter._arbiter
        exact = with_ellipse(pair)
        if exact and touches.contacts.adopts:
            touches.contacts.adopt(pair)
        if touches.telling or not exact or pair.data:
            super()._separate(arbiter, space, data)


class _GlobalEventDispatcher(_EventDispatcher):
    """The same for the last handler that Chipmunk calls: it completes the contact."""

    def _pre_solve(self, arbiter: Arbiter, space: pymunk.Space, data: Any) -> None:
        try:
            super()._pre_solve(arbiter, space, data)
        finally:
            self._touches.contacts.complete(arbiter._arbiter)


def listens(handler: CollisionHandler) -> bool:
    """Whether a handler has a callback of the user that depends on whether two ellipses touch."""
    return not (handler.begin is handler.pre_solve is handler.separate is None)


class EventHandler(ChainedHandler):
    """The handler of one pair of collision types."""

    def __init__(self, handler: Any, space: pymunk.Space, touches: Touches) -> None:
        self._touches = touches
        super().__init__(handler, space)

    def make_dispatcher(self) -> Dispatcher:
        return _EventDispatcher(self, self._touches)

    def wire(self) -> None:
        super().wire()
        call_python(self._handler, "pre_solve", listens(self))


class GlobalEventHandler(ContactHandler):
    """The handler of all pairs, the last one that Chipmunk calls."""

    def make_dispatcher(self) -> Dispatcher:
        self.touches = Touches(self)
        return _GlobalEventDispatcher(self, self.touches)

    def in_python(self) -> bool:
        return listens(self)


class EventSpace(pymunk.Space):
    """A pymunk.Space in which collision callbacks are those of the ellipses."""

    def __init__(self, threaded: bool = False) -> None:
        super().__init__(threaded)
        self._touches = install(self, GlobalEventHandler).touches

    def on_collision(
        self,
        collision_type_a: int | None = None,
        collision_type_b: int | None = None,
        begin: Callback | None = None,
        pre_solve: Callback | None = None,
        post_solve: Callback | None = None,
        separate: Callback | None = None,
        data: Any = None,
    ) -> None:
        """Set callbacks for the phases of a collision, see pymunk.Space.on_collision.

        For a pair with an ellipse begin is called in the first step in which the two shapes
        touch, pre_solve and post_solve in all in which they do, and separate in the first in
        which they do not, or when one is removed. The arbiter has their exact contact.
        """
        key = collision_type_a, collision_type_b
        if key not in self._handlers:
            install(self, self._event_handler, *key)
        super().on_collision(
            collision_type_a,
            collision_type_b,
            begin,
            pre_solve,
            post_solve,
            separate,
            data,
        )

    def _event_handler(self, handler: Any, space: pymunk.Space) -> EventHandler:
        return EventHandler(handler, space, self._touches)

    def step(self, dt: float) -> None:
        """Update the space for the given time step, see pymunk.Space.step.

        Raises RuntimeError in a callback of the same space: some of them are called while Chipmunk
        goes through its pairs, which a step within the step would change.
        """
        if self._locked:
            raise RuntimeError(
                "step must not be called in a callback of the same space"
            )
        self._touches.current = None
        super().step(dt)
