"""Translates structs.h into the module that cffi loads in half a millisecond, where parsing would take thirty: `python -m kernel.declare`."""

from __future__ import annotations

from pathlib import Path

import cffi

CHIPMUNK = Path(__file__).parent.parent / "pymunk_ellipse" / "chipmunk"


def declared() -> str:
    """The text of pymunk_ellipse/chipmunk/_declared.py."""
    ffi = cffi.FFI()
    ffi.cdef((CHIPMUNK / "structs.h").read_text())
    ffi.set_source("pymunk_ellipse.chipmunk._declared", None)
    place = CHIPMUNK / "_declared.py"
    ffi.emit_python_code(str(place))
    return place.read_text()


if __name__ == "__main__":
    declared()
