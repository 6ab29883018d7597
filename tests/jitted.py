"""The kernel as numba compiles it in this process, from the source that the library is built from."""

from functools import cache

import pymunk

from pymunk_ellipse.chipmunk import structs
from pymunk_ellipse.chipmunk.private import pre_solve_function
from pymunk_ellipse.contacts.library import Library, load


class Jitted(Library):
    """The library with numba's own pre_solve; shapes are those of the library's class."""

    name = "numba"

    def __init__(self):
        from numba import cfunc, njit, types

        from kernel import emit, numba_structs

        self._lib = load()._lib
        polygons = structs.shape_at(pymunk.Poly.create_box(None)._shape).shape_class
        emit.teach_numba(self.make_class(polygons))
        # Which fields of which structs the code touches.
        self.fields = set()
        look_up = numba_structs._Attributes.generic_resolve

        def note(attributes, value, name):
            found = look_up(attributes, value, name)
            if found is not None:
                self.fields.add((value.name.removeprefix("struct "), name))
            return found

        numba_structs._Attributes.generic_resolve = note
        try:
            compiled = {
                entry.py_func.__name__: entry for entry in emit.compiled_entries()
            }
        finally:
            numba_structs._Attributes.generic_resolve = look_up

        resolve = compiled["resolve"]
        complete = compiled["complete"]
        signature = types.void(types.int64, types.int64, types.voidptr)

        @cfunc(signature)
        def call(arbiter, space, data):
            resolve(arbiter, space, False)
            complete(arbiter, space)

        @cfunc(signature)
        def call_with_impacts(arbiter, space, data):
            resolve(arbiter, space, True)
            complete(arbiter, space)

        self._calls = call, call_with_impacts
        self.pre_solve = pre_solve_function(call.address)
        self.pre_solve_with_impacts = pre_solve_function(call_with_impacts.address)

        def on_hull(function):
            """A function of a hull, as one of an address that Python can call."""
            hull_at = structs.hull_at
            return njit(lambda place, *numbers: function(hull_at(place), *numbers))

        self.functions = {
            name: on_hull(compiled[name])
            for name in ("cache_data", "nearest_updated", "cast_updated")
        }


@cache
def kernel():
    """The one of this process. Raises ImportError without numba."""
    return Jitted()
