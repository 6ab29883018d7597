"""The kernel in Python: the resolver, the narrow phase and the class of ellipses as they are written."""

from __future__ import annotations

from typing import Any

from ..chipmunk.private import box_query_function, pre_solve_function
from ..chipmunk.shape_class import (
    cast_now,
    collect_touched,
    keep_for_ever,
    nearest_now,
    python_class,
)
from ..chipmunk.structs import address, ffi, hull_at, shape_at
from ..narrowphase.cast import Hit
from ..narrowphase.nearest import Nearest
from ..narrowphase.rows import contacts_of_rows, nearest_of_rows
from .pair import ShapeContact, shape_contact
from .resolver import complete, resolve


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
