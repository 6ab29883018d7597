"""Checks of arguments: each names the argument and the value it does not take."""

from __future__ import annotations

from collections.abc import Mapping, Set
from math import isfinite, isnan
from numbers import Real
from typing import TYPE_CHECKING, Any

from pymunk import BB, Vec2d

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

# Chipmunk multiplies up to four lengths for a moment; beyond these bounds that over- or underflows.
SMALLEST_SEMI_AXIS = 1e-50
LARGEST_SEMI_AXIS = 1e50

# The contact of a thinner ellipse would drown in roundoff: its depth is right to about 1e-15 of the longer semi-axis.
LARGEST_ASPECT_RATIO = 1e6

# Farther from its body an ellipse would drown in the roundoff of its centre.
FARTHEST_OFFSET = 1e12


def number(name: str, value: Any) -> float:
    """value as a finite float.

    Raises TypeError for what is no real number, and ValueError for what is not finite.
    """
    result = _real(name, value)
    if not isfinite(result):
        raise ValueError(f"{name} must be finite, got {value!r}")
    return result


def _real(name: str, value: Any) -> float:
    """value as a float, of whatever is a real number: Python's, numpy's, a Decimal or a Fraction."""
    if type(value) is float:
        return value
    if type(value) is not int and not is_real(value):
        raise TypeError(f"{name} must be a number, got {value!r}")
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise TypeError(f"{name} must be a number, got {value!r}") from error


def is_real(value: Any) -> bool:
    """Whether value is of a type for real numbers, for which float() leaves nothing out.

    float() takes strings as well, drops the imaginary parts of numpy's complex numbers and the
    masks of its masked arrays, and counts days for dates.
    """
    if isinstance(value, Real):
        return True
    # Here, because its import takes a sixth of that of this package.
    from decimal import Decimal

    if isinstance(value, Decimal):
        return True
    if is_masked(value):
        return False
    kind = getattr(getattr(value, "dtype", None), "kind", None)
    return kind in REAL_KINDS


def is_masked(value: Any) -> bool:
    """Whether value is one of numpy's masked arrays, which hide some of their numbers."""
    return any(base.__module__.startswith("numpy.ma") for base in type(value).__mro__)


# Kinds of numpy's types: truth values, integers and floats.
REAL_KINDS = ("b", "i", "u", "f")


def switch(name: str, value: Any) -> bool:
    """value, which must be a bool."""
    if not isinstance(value, bool):
        raise TypeError(f"{name} must be True or False, got {value!r}")
    return value


def point(name: str, value: Any) -> Vec2d:
    """value as a vector of two finite floats.

    Raises TypeError for what is not a pair in order, and for what number() does not take;
    ValueError for more or fewer numbers, and for those that are not finite.
    """
    # Whether other types have an order is slow to find out.
    if type(value) not in (tuple, Vec2d, list) and (
        isinstance(value, (str, bytes, bytearray, Set, Mapping)) or is_masked(value)
    ):
        raise TypeError(f"{name} must be two numbers, got {value!r}")
    try:
        x, y = value
    except TypeError as error:
        raise TypeError(f"{name} must be two numbers, got {value!r}") from error
    except ValueError as error:
        raise ValueError(f"{name} must be two numbers, got {value!r}") from error
    return Vec2d(number(f"{name}[0]", x), number(f"{name}[1]", y))


def number_or_infinity(name: str, value: Any) -> float:
    """value as a float that is not NaN."""
    result = _real(name, value)
    if isnan(result):
        raise ValueError(f"{name} must be finite or infinite, got {value!r}")
    return result


def box(name: str, value: Any) -> BB:
    """value as a bounding box, which may be infinite."""
    try:
        left, bottom, right, top = value
    except TypeError as error:
        raise TypeError(f"{name} must be four numbers, got {value!r}") from error
    except ValueError as error:
        raise ValueError(f"{name} must be four numbers, got {value!r}") from error
    return BB(
        number_or_infinity(f"{name}.left", left),
        number_or_infinity(f"{name}.bottom", bottom),
        number_or_infinity(f"{name}.right", right),
        number_or_infinity(f"{name}.top", top),
    )


def floats(name: str, value: Any) -> NDArray[np.float64]:
    """value as an array of finite floats.

    Raises TypeError for what is no array of real numbers, and ValueError for numbers that are
    not finite.
    """
    import numpy as np

    if value is None or isinstance(value, (Set, Mapping)) or is_masked(value):
        raise TypeError(f"{name} must be an array of numbers, got {value!r}")
    try:
        array = np.asarray(value)
        # Numbers of several types, or Python's own.
        if array.dtype.kind == "O" and all(map(is_real, array.flat)):
            array = array.astype(np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise TypeError(f"{name} must be an array of numbers, got {value!r}") from error
    if array.dtype.kind not in REAL_KINDS:
        raise TypeError(f"{name} must be an array of numbers, got {value!r}")
    array = array.astype(np.float64, copy=False)
    if not np.all(np.isfinite(array)):
        wrong = array[~np.isfinite(array)][0]
        raise ValueError(f"{name} must be finite, got {wrong!s}")
    return array


def semi_axes(a: Any, b: Any) -> tuple[float, float]:
    """a and b as lengths that an ellipse can have."""
    result = number("a", a), number("b", b)
    for name, length in zip("ab", result, strict=True):
        if length <= 0.0:
            raise ValueError(f"{name} must be positive, got {length!r}")
        if not SMALLEST_SEMI_AXIS <= length <= LARGEST_SEMI_AXIS:
            raise ValueError(
                f"{name} must lie between {SMALLEST_SEMI_AXIS} and {LARGEST_SEMI_AXIS}, got {length!r}"
            )
    if max(result) > LARGEST_ASPECT_RATIO * min(result):
        raise ValueError(
            f"a and b must not differ by more than a factor of {LARGEST_ASPECT_RATIO:.0e}, "
            f"got a={result[0]!r} and b={result[1]!r}"
        )
    return result


def offset(value: Any, a: float, b: float) -> Vec2d:
    """value as the centre of an ellipse with these semi-axes, in body local coordinates."""
    center = point("offset", value)
    farthest = FARTHEST_OFFSET * min(a, b)
    if max(abs(center.x), abs(center.y)) > farthest:
        raise ValueError(
            f"offset must not be farther than {FARTHEST_OFFSET:.0e} of the shorter semi-axis, "
            f"which is {farthest!r}, got {value!r}"
        )
    return center
