"""Which kernel resolves contacts and answers queries: the compiled library, or Python."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TypeAlias

import pymunk

from ..chipmunk.private import box_query_function, pre_solve_function
from ..chipmunk.shape_class import (
    cast_now,
    collect_touched,
    keep_for_ever,
    nearest_now,
    python_class,
)
from ..chipmunk.structs import address, ffi, hull_at, set_ellipse_class, shape_at
from ..narrowphase.cast import Hit
from ..narrowphase.nearest import Nearest
from ..narrowphase.rows import contacts_of_rows, nearest_of_rows
from .pair import ShapeContact, shape_contact
from .resolver import complete, resolve

if TYPE_CHECKING:
    from .library import Library

VARIABLE = "PYMUNK_ELLIPSE_BACKEND"


class Python:
    """The kernel in Python. The functions take C shapes of pymunk's."""

    name = "python"

    def __init__(self) -> None:
        def pre_solve(arbiter: int, space: int, data: Any) -> None:
            resolve(arbiter, space, False)
            complete(arbiter, space)

        def pre_solve_with_impacts(arbiter: int, space: int, data: Any) -> None:
            resolve(arbiter, space, True)
            complete(arbiter, space)

        calls = [
            ffi.callback("void(intptr_t, intptr_t, void *)", function)
            for function in (pre_solve, pre_solve_with_impacts)
        ]
        collect = ffi.callback("void(intptr_t, intptr_t)", collect_touched)
        keep_for_ever((calls, collect))
        self.pre_solve, self.pre_solve_with_impacts = (
            pre_solve_function(address(call)) for call in calls
        )
        self.collect_touched = box_query_function(address(collect))

    def make_class(self, polygons: Any) -> int:
        """Make the class of ellipses from that of polygons; returns its address."""
        return python_class(polygons)

    def resolve(self, arbiter: Any, space: Any, exact_impacts: bool) -> None:
        """See contacts.resolver."""
        resolve(address(arbiter), address(space), exact_impacts)

    def complete(self, arbiter: Any, space: Any) -> None:
        """See contacts.resolver."""
        complete(address(arbiter), address(space))

    def shape_contact(self, ellipse: Any, shape: Any) -> ShapeContact:
        """See contacts.pair."""
        return shape_contact(hull_at(ellipse), shape_at(shape))

    def nearest_now(self, ellipse: Any, x: float, y: float) -> Nearest:
        """See chipmunk.shape_class."""
        return nearest_now(hull_at(ellipse), x, y)

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
        return cast_now(hull_at(ellipse), start_x, start_y, end_x, end_y, radius)

    def contacts_of_rows(
        self, first: Any, first_step: int, second: Any, second_step: int, result: Any
    ) -> None:
        """See narrowphase.rows; the arguments are arrays of numpy's, one row of the result for each pair."""
        _in_lists(contacts_of_rows, first, first_step, second, second_step, result)

    def nearest_of_rows(
        self,
        ellipses: Any,
        ellipse_step: int,
        points: Any,
        point_step: int,
        result: Any,
    ) -> None:
        """See narrowphase.rows; the arguments are arrays of numpy's, one row of the result for each pair."""
        _in_lists(nearest_of_rows, ellipses, ellipse_step, points, point_step, result)


def _in_lists(
    function: Any,
    first: Any,
    first_step: int,
    second: Any,
    second_step: int,
    result: Any,
) -> None:
    """Call a function of rows with lists, whose numbers are Python's own and several times as fast as numpy's."""
    numbers = result.ravel().tolist()
    function(
        len(result),
        first.ravel().tolist(),
        first_step,
        second.ravel().tolist(),
        second_step,
        numbers,
    )
    result.ravel()[:] = numbers


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
    if choice == "python":
        return Python()
    # Not when the package is imported, as this imports twice as much as all the rest does.
    from .library import Unusable, load

    try:
        library = load()
        problem = "the package has no library for this machine"
    except Unusable as error:
        library = None
        problem = str(error)
        if choice == "auto":
            warnings.warn(
                f"pymunk_ellipse works in Python, many times slower: {problem}",
                RuntimeWarning,
                stacklevel=2,
            )
    if library is not None:
        return library
    if choice == "auto":
        return Python()
    raise ImportError(f"{VARIABLE} is compiled, but {problem}")


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
