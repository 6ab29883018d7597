"""Chipmunk's structs: fields by name, for the same code in Python and compiled.

They are declared in structs.h. `arbiter.body_a.p.x` is an attribute of cffi's in Python, about 40 ns
for each dot, and one load in compiled code. A cast of an address costs 240 ns: one for a contact is
enough, from there pointers lead on.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..narrowphase.frame import Frame
from ._declared import ffi as ffi

# Kinds of shapes, as a class names them.
CIRCLE = 0
SEGMENT = 1
POLYGON = 2

# States of an arbiter.
FIRST_COLLISION = 0
IGNORE = 2
CACHED = 3

# A polygon of more vertices keeps its planes outside of its struct.
INLINE_VERTICES = 6


def _at(kind: str) -> Callable[[Any], Any]:
    """Makes the function that takes an address, or a pointer to another struct, for a struct of this kind."""
    pointer = ffi.typeof(f"{kind} *")
    cast = ffi.cast

    def at(address: Any) -> Any:
        return cast(pointer, address)

    return at


arbiter_at = _at("Arbiter")
contact_at = _at("Contact")
space_at = _at("Space")
body_at = _at("Body")
shape_at = _at("Shape")
circle_at = _at("Circle")
segment_at = _at("Segment")
polygon_at = _at("Poly")
hull_at = _at("Hull")
ray_at = _at("WideRay")


def behind(doubles: Any, count: int) -> Any:
    """The place that many doubles behind a pointer to doubles."""
    return doubles + count


def frame_in(doubles: Any) -> Frame:
    """The frame of an ellipse in six doubles."""
    a, b, c, s, x, y = doubles
    return a, b, c, s, x, y


def address(pointer: Any) -> int:
    """The address that a pointer of C holds, of any FFI."""
    return int(ffi.cast("intptr_t", pointer))


def ellipse_class() -> int:
    """The address of the class that makes a shape an ellipse; zero before there is one."""
    return _ellipse_class


def set_ellipse_class(place: int) -> None:
    """Tell where the class of ellipses is; see shape_class."""
    global _ellipse_class
    _ellipse_class = place


_ellipse_class = 0
