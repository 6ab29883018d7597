"""Which of the two pre_solves resolves contacts: compiled by numba, or in Python."""

from __future__ import annotations

import os
import warnings
from functools import cache
from typing import Any

from ._layout import unproved
from ._pymunk import c_callback

VARIABLE = "PYMUNK_ELLIPSE_BACKEND"


def wanted() -> str:
    """What the environment variable PYMUNK_ELLIPSE_BACKEND asks for: auto, python or compiled.

    Raises ValueError for anything else.
    """
    value = os.environ.get(VARIABLE, "auto")
    if value not in ("auto", "python", "compiled"):
        raise ValueError(f"{VARIABLE} must be auto, python or compiled, got {value!r}")
    return value


@cache
def compiled_pre_solve() -> Any | None:
    """The C callback to use, or None where Python resolves contacts.

    Raises ImportError if PYMUNK_ELLIPSE_BACKEND is compiled and numba is missing.
    """
    choice = wanted()
    if choice == "python":
        return None
    try:
        import numba  # noqa: F401
    except ImportError as error:
        if choice == "auto":
            return None
        raise ImportError(
            f"{VARIABLE} is compiled, which needs numba: "
            'pip install "pymunk-ellipse[fast]"'
        ) from error
    problem = unproved()
    if problem is not None:
        warnings.warn(
            f"pymunk_ellipse resolves contacts in Python: this pymunk keeps {problem} elsewhere than known",
            RuntimeWarning,
            stacklevel=2,
        )
        return None
    from .compiled import compile_pre_solve

    return c_callback(compile_pre_solve())


def backend() -> str:
    """Which backend resolves contacts in this process: "compiled" or "python".

    Compiled code is used where numba is installed, unless the environment variable
    PYMUNK_ELLIPSE_BACKEND is set to python before the first ellipse is added to a space; if it
    is set to compiled, a missing numba is an error instead of a reason to use Python.

    Raises ValueError if the variable is not auto, python or compiled, and ImportError if it is
    compiled and numba is missing.

    >>> backend() in ("compiled", "python")
    True
    """
    return "python" if compiled_pre_solve() is None else "compiled"
