"""Translates structs.h into the module that cffi loads in half a millisecond, where parsing would take thirty: `python -m kernel.declare`."""

from __future__ import annotations

import tempfile
from pathlib import Path

import cffi

CHIPMUNK = Path(__file__).parent.parent / "pymunk_ellipse" / "chipmunk"


def declared(structs: str) -> str:
    """The text of pymunk_ellipse/chipmunk/_declared.py for that of structs.h."""
    ffi = cffi.FFI()
    ffi.cdef(structs)
    ffi.set_source("pymunk_ellipse.chipmunk._declared", None)
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder, "_declared.py")
        ffi.emit_python_code(str(place))
        return place.read_text()


if __name__ == "__main__":
    text = declared((CHIPMUNK / "structs.h").read_text())
    (CHIPMUNK / "_declared.py").write_text(text)
