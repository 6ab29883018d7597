"""Switches exact contacts on in a space, and tells them which ellipses it holds."""

from __future__ import annotations

from typing import Any

from pymunk import Space

from ._pymunk import ContactHandler, global_handler, install
from .backend import compiled_pre_solve
from .narrowphase.placement import Frame
from .resolver import pre_solve


def contact_handler(handler: Any, space: Space) -> ContactHandler:
    """The handler that resolves contacts in a plain pymunk.Space."""
    return ContactHandler(handler, space, pre_solve, compiled_pre_solve)


def enter(space: Space, cp_shape: Any, frame: Frame) -> None:
    """Resolve the contacts of an ellipse from now on; again with another frame when it changes."""
    handler = global_handler(space)
    if not isinstance(handler, ContactHandler):
        handler = install(space, contact_handler)
    handler.enter(cp_shape, frame)


def leave(space: Space, cp_shape: Any) -> None:
    """Forget an ellipse that leaves the space."""
    handler = global_handler(space)
    if isinstance(handler, ContactHandler):
        handler.leave(cp_shape)
