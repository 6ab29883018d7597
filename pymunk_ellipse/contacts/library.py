"""The compiled library: found by the machine's name, proved to be built from the sources at hand, and loaded for good."""

from __future__ import annotations

import ctypes
import hashlib
from atexit import register
from contextlib import ExitStack, suppress
from functools import cached_property
from importlib.resources import as_file, files
from typing import Any

from ..chipmunk.private import box_query_function, pre_solve_function
from ..chipmunk.structs import address, ffi
from ..narrowphase.cast import Hit
from ..narrowphase.nearest import Nearest
from .machine import own_library_name
from .pair import ShapeContact

# What is compiled, and nothing else.
SOURCES = (
    "chipmunk/structs.h",
    "chipmunk/shape_class.py",
    "contacts/handover.py",
    "contacts/impacts.py",
    "contacts/pair.py",
    "contacts/resolver.py",
    "narrowphase",
)

# Lists the libraries beside it as they were built, in the format of sha256sum.
SUMS = "_kernel-sums.txt"

_PACKAGE = __package__.rpartition(".")[0]

# Keeps files that are unpacked from an archive.
_unpacked = ExitStack()


@register
def _remove_unpacked() -> None:
    # Windows keeps a file that is loaded as a library.
    with suppress(PermissionError):
        _unpacked.close()


def digest(package: Any) -> str | None:
    """A hash of the sources that the library is built from, None where they are not at hand, as in a frozen program."""
    found = hashlib.sha256()
    for name in SOURCES:
        source = package.joinpath(name)
        parts = [source]
        if source.is_dir():
            parts = sorted(
                (part for part in source.iterdir() if part.name.endswith(".py")),
                key=lambda part: part.name,
            )
        for part in parts:
            try:
                found.update(part.read_bytes().replace(b"\r\n", b"\n"))
            except OSError:
                return None
    return found.hexdigest()


def line_in_sums(name: str, library: bytes) -> bytes:
    """The line that SUMS has for a library of this name."""
    return f"{hashlib.sha256(library).hexdigest()}  {name}".encode()


class Library:
    """The kernel in compiled code. The functions take C shapes of pymunk's."""

    name = "compiled"

    def __init__(self, path: str) -> None:
        # ctypes never unloads a library, and at the interpreter's exit shapes are freed after modules.
        ctypes.CDLL(path)
        self._lib = ffi.dlopen(path)

    def digest(self) -> str:
        """The hash of the sources that it was built from."""
        text: bytes = ffi.string(self._lib.pe_digest())
        return text.decode()

    @cached_property
    def pre_solve(self) -> Any:
        """What Chipmunk calls to resolve a contact."""
        place = ffi.addressof(self._lib, "pe_pre_solve")
        return pre_solve_function(address(place))

    @cached_property
    def pre_solve_with_impacts(self) -> Any:
        """The same, with impacts at their own time."""
        place = ffi.addressof(self._lib, "pe_pre_solve_with_impacts")
        return pre_solve_function(address(place))

    @cached_property
    def collect_touched(self) -> Any:
        """What Chipmunk calls for each shape near a wide ray; see chipmunk.shape_class."""
        place = ffi.addressof(self._lib, "pe_collect_touched")
        return box_query_function(address(place))

    def make_class(self, polygons: Any) -> int:
        """Make the class of ellipses from that of polygons; returns its address."""
        return address(self._lib.pe_shape_class(polygons))

    def resolve(self, arbiter: Any, space: Any, exact_impacts: bool) -> None:
        """See contacts.resolver."""
        self._lib.pe_resolve(arbiter, space, exact_impacts)

    def complete(self, arbiter: Any, space: Any) -> None:
        """See contacts.resolver."""
        self._lib.pe_complete(arbiter, space)

    def shape_contact(self, ellipse: Any, shape: Any) -> ShapeContact:
        """See contacts.pair."""
        result = ffi.new("double[7]")
        self._lib.pe_shape_contact(ellipse, shape, result)
        contact: ShapeContact = tuple(ffi.unpack(result, 7))
        return contact

    def nearest_now(self, ellipse: Any, x: float, y: float) -> Nearest:
        """See chipmunk.shape_class."""
        result = ffi.new("double[5]")
        self._lib.pe_nearest_now(ellipse, x, y, result)
        nearest: Nearest = tuple(ffi.unpack(result, 5))
        return nearest

    def cast_now(
        self,
        ellipse: Any,
        start_x: float,
        start_y: float,
        end_x: float,
        end_y: float,
        radius: float,
    ) -> Hit:
        """See chipmunk.shape_class."""
        result = ffi.new("double[5]")
        self._lib.pe_cast_now(ellipse, start_x, start_y, end_x, end_y, radius, result)
        hit: Hit = tuple(ffi.unpack(result, 5))
        return hit

    def contacts_of_rows(
        self, first: Any, first_step: int, second: Any, second_step: int, result: Any
    ) -> None:
        """See narrowphase.rows; the arguments are arrays of numpy's, one row of the result for each pair."""
        self._lib.pe_contacts_of_rows(
            len(result),
            _doubles(first),
            first_step,
            _doubles(second),
            second_step,
            _doubles(result),
        )

    def nearest_of_rows(
        self,
        ellipses: Any,
        ellipse_step: int,
        points: Any,
        point_step: int,
        result: Any,
    ) -> None:
        """See narrowphase.rows; the arguments are arrays of numpy's, one row of the result for each pair."""
        self._lib.pe_nearest_of_rows(
            len(result),
            _doubles(ellipses),
            ellipse_step,
            _doubles(points),
            point_step,
            _doubles(result),
        )


def _doubles(array: Any) -> Any:
    """A pointer to the numbers of one of numpy's arrays."""
    return ffi.from_buffer("double[]", array)


class Unusable(Exception):
    """Why a library that is there cannot be used."""


def load() -> Library | None:
    """The library for this machine, None if the package has none for it.

    Raises Unusable for one that is damaged, does not load, or was built from other sources.
    """
    package = files(_PACKAGE)
    name = own_library_name()
    source = package.joinpath(name)
    if not source.is_file():
        return None
    try:
        # A file that lacks its end may load, and crash where that is read. A frozen program has no
        # sums, because what freezes it may sign the library.
        sums = package.joinpath(SUMS)
        if sums.is_file():
            line = line_in_sums(name, source.read_bytes())
            if line not in sums.read_bytes().splitlines():
                raise Unusable(f"{name} is damaged: {SUMS} has another sum for it")
        library = Library(str(_unpacked.enter_context(as_file(source))))
    except OSError as error:
        raise Unusable(f"{name} does not load: {error}") from error
    sources = digest(package)
    if sources is not None and sources != library.digest():
        raise Unusable(f"{name} was built from other sources than those at hand")
    return library
