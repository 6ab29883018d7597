"""Puts the compiled library for this machine into a frozen program, and none of the others."""

from pathlib import Path

import pymunk_ellipse
from pymunk_ellipse.contacts.machine import own_library_name

_package = Path(pymunk_ellipse.__file__).parent
_library = _package / own_library_name()

binaries = [(str(_library), _package.name)] if _library.exists() else []
