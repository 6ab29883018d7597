"""Switches exact contacts on in a space, and tells them which ellipses it holds."""

from __future__ import annotations

from typing import Any

from pymunk import Space

from . import resolver
from ._pymunk import ContactHandler, global_handler, install
from .narrowphase.placement import Frame


class EllipseContacts:
    """The ellipses of one space and the pre_solve that resolves their contacts."""

    def __init__(self) -> None:
        self.frames: dict[Any, Frame] = {}

    def resolve(self, arbiter: Any) -> None:
        resolver.pre_solve(self.frames, arbiter)


def enter(space: Space, cp_shape: Any, frame: Frame) -> None:
    """Resolve the contacts of an ellipse from now on; again with another frame when it changes."""
    handler = global_handler(space)
    if not isinstance(handler, ContactHandler):
        handler = install(space, EllipseContacts())
    handler.contacts.frames[cp_shape] = frame


def leave(space: Space, cp_shape: Any) -> None:
    """Forget an ellipse that leaves the space."""
    handler = global_handler(space)
    if isinstance(handler, ContactHandler):
        handler.contacts.frames.pop(cp_shape, None)
