"""The last contacts of a space on their way into a copy or a pickle of it, where pymunk keeps arbiters but not what they point to."""

from __future__ import annotations

import weakref
from typing import Any

from pymunk import Body, Shape, Space

from ..chipmunk.private import (
    NO_SPACE,
    arbiters_of,
    c_body,
    contact_at,
    contact_state,
    new_contact,
    shape_behind,
)
from ..chipmunk.structs import CACHED, address, body_at, ellipse_class, shape_at

Saved = tuple[Shape, Shape, dict[str, Any]]
Bias = tuple[Body, float, float, float]


class SavedContacts:
    """The contacts of a space's arbiters, gathered when a copy or a pickle of the space is made.

    It is among the data of a handler, with which pymunk copies it.
    """

    def __init__(self, space: Space) -> None:
        self._space = weakref.ref(space)
        self._contacts: list[Saved] = []

    def by_pair(self) -> dict[tuple[int, int], dict[str, Any]]:
        """The contacts by the addresses of the two shapes, in either order."""
        pairs = {}
        for first, second, contact in self._contacts:
            a, b = address(first._shape), address(second._shape)
            pairs[a, b] = contact
            pairs[b, a] = {**contact, "r1": contact["r2"], "r2": contact["r1"]}
        return pairs

    def __getstate__(self) -> list[Saved]:
        space = self._space()
        if space is None:
            return []
        return [
            (
                shape_behind(arbiter.a),
                shape_behind(arbiter.b),
                contact_state(contact_at(arbiter.data)),
            )
            for arbiter in arbiters_of(space)
            if arbiter.data and arbiter.state < CACHED
        ]

    def __setstate__(self, contacts: list[Saved]) -> None:
        self._space = NO_SPACE
        self._contacts = contacts


def adopt(saved: SavedContacts, space: Space, current: Any) -> list[Any]:
    """Have the arbiters of a copied space point to the contacts that came with it, and return those.

    pymunk has restored the arbiters; the contact of the current one, which Chipmunk is about to
    solve, is gone already.
    """
    adopted = []
    by_pair = saved.by_pair()
    for arbiter in arbiters_of(space):
        contact = by_pair.get((address(arbiter.a), address(arbiter.b)))
        if contact is not None:
            arbiter.data = kept = new_contact(contact)
            kept.hash = contact_name(arbiter)
            adopted.append(kept)
        elif (
            # A pymunk that does not copy a handler's data.
            not by_pair
            and arbiter != current
            and arbiter.count > 0
            and with_ellipse(arbiter)
        ):
            arbiter.contacts[0].hash = contact_name(arbiter)
            arbiter.data = arbiter.contacts
    return adopted


def bias_velocities(space: Space) -> list[Bias]:
    """Bodies that the next step moves by what the last one's contacts have left, with those velocities (x, y) and spins."""
    found = []
    for body in space.bodies:
        struct = body_at(c_body(body))
        bias = struct.v_bias
        numbers = bias.x, bias.y, struct.w_bias
        if any(numbers):
            found.append((body, *numbers))
    return found


def set_bias_velocities(saved: list[Bias]) -> None:
    """Have the next step move the bodies of a copied space so as well; pymunk does not copy this."""
    for body, x, y, spin in saved:
        struct = body_at(c_body(body))
        struct.v_bias.x = x
        struct.v_bias.y = y
        struct.w_bias = spin


def contact_name(arbiter: Any) -> int:
    """What the hash of an arbiter's contact is set to: the arbiter's address, and in its lowest bit the shapes' order."""
    in_order: bool = arbiter.a < arbiter.b
    return address(arbiter) | in_order


def with_ellipse(arbiter: Any) -> bool:
    """Whether one of the shapes of a C arbiter is an ellipse."""
    made = ellipse_class()
    return made in (shape_at(arbiter.a).klass, shape_at(arbiter.b).klass)
