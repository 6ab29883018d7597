"""Which kernel resolves contacts and answers queries: the compiled library, or Python."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, TypeAlias

import pymunk

from ..chipmunk.structs import set_ellipse_class, shape_at

# Each kernel is imported when it is chosen: they take longer than the rest of the package.
if TYPE_CHECKING:
    from .interpreted import Python
    from .library import Library

VARIABLE = "PYMUNK_ELLIPSE_BACKEND"


Kernel: TypeAlias = "Library | Python"


def wanted() -> str:
    """What the environment variable PYMUNK_ELLIPSE_BACKEND asks for: auto, python or compiled; auto if it is empty.

    Raises ValueError for anything else.
    """
    value = os.environ.get(VARIABLE) or "auto"
    if value not in ("auto", "python", "compiled"):
        raise ValueError(f"{VARIABLE} must be auto, python or compiled, got {value!r}")
    return value


def choose() -> Kernel:
    """The kernel that the environment asks for.

    Warns, and takes Python, if there is a library that cannot be used. Raises ImportError
    instead where the compiled one is asked for.
    """
    choice = wanted()
    if choice != "python":
        from .library import Unusable, load

        problem = "the package has no library for this machine"
        try:
            library = load()
            if library is not None:
                return library
        except Unusable as error:
            problem = str(error)
            if choice == "auto":
                warnings.warn(
                    f"pymunk_ellipse works in Python, many times slower: {problem}",
                    RuntimeWarning,
                    stacklevel=2,
                )
        if choice == "compiled":
            raise ImportError(f"{VARIABLE} is compiled, but {problem}")
    from .interpreted import Python

    return Python()


# PyPy wants a name's type before the first function that says it is global.
_kernel: Kernel | None = None
_classes: dict[str, int] = {}


def kernel() -> Kernel:
    """The kernel of this process, chosen when the first ellipse is made."""
    global _kernel
    if _kernel is None:
        use(choose())
    assert _kernel is not None
    return _kernel


def use(chosen: Kernel) -> None:
    """Have all ellipses that are made from now on use a kernel.

    Raises RuntimeError where pymunk's structs are not as known.
    """
    global _kernel
    from ..chipmunk.proof import prove_structs

    prove_structs()
    if chosen.name not in _classes:
        box = pymunk.Poly.create_box(None)
        _classes[chosen.name] = chosen.make_class(shape_at(box._shape).shape_class)
    set_ellipse_class(_classes[chosen.name])
    _kernel = chosen


@contextmanager
def using(chosen: Kernel) -> Iterator[None]:
    """Use a kernel for a while; ellipses made in it must not outlive it in a space that steps."""
    before = kernel()
    use(chosen)
    try:
        yield
    finally:
        use(before)


def backend() -> str:
    """Which backend resolves contacts in this process: "compiled" or "python".

    The package comes with compiled code for most machines. Python does the same, many times
    slower, where it has none, or where the environment variable PYMUNK_ELLIPSE_BACKEND is set
    to python before the first ellipse is made; set to compiled, it makes a missing library an
    error.

    Raises ValueError if the variable is not auto, python or compiled, ImportError if it is
    compiled and there is no library for this machine, and RuntimeError if pymunk is of a
    version whose structs are not known.

    >>> backend() in ("compiled", "python")
    True
    """
    return kernel().name
