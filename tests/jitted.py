"""The compiled functions as numba makes them in this process, from the same source that the library is built from."""

from functools import cache
from types import SimpleNamespace


@cache
def kernel():
    """The entries that the library has, compiled here, and the fields of structs that they touch.

    Raises ImportError without numba.
    """
    from kernel import emit, numba_structs

    fields = set()
    look_up = numba_structs._Attributes.generic_resolve

    def noting(self, value, name):
        kind = look_up(self, value, name)
        if kind is not None:
            fields.add((value.name.removeprefix("struct "), name))
        return kind

    numba_structs._Attributes.generic_resolve = noting
    try:
        emit.module()
    finally:
        numba_structs._Attributes.generic_resolve = look_up
    return SimpleNamespace(fields=fields)
