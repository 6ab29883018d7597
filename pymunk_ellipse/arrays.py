"""Contacts and nearest points of arrays of ellipses, given as numbers: without bodies, shapes or a space."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from . import _checks
from .contacts.backend import kernel
from .narrowphase.rows import CONTACT, ELLIPSE, NEAREST, POINT

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

# numpy is imported where it is needed: it takes longer than the rest of the package.


class EllipseContacts(NamedTuple):
    """What :py:func:`ellipse_contacts` found: arrays of the pairs' shape, or for one pair floats and tuples of two floats."""

    #: The distance of the two surfaces, negative where the ellipses overlap: minus the
    #: penetration depth, the least translation that parts the two.
    distance: Any
    #: The unit normal from the first ellipse to the second, x and y along the last axis.
    normal: Any
    #: The point of the first ellipse that is nearest to the second or, where they overlap,
    #: deepest in it; x and y along the last axis.
    first_point: Any
    #: The same of the second ellipse: at the distance along the normal from first_point.
    second_point: Any


class NearestPoints(NamedTuple):
    """What :py:func:`nearest_points` found: arrays of the pairs' shape, or for one pair floats and tuples of two floats."""

    #: The distance of the point from the surface, negative inside the ellipse.
    distance: Any
    #: The outward unit normal of the ellipse at the nearest point, x and y along the last axis.
    normal: Any
    #: The nearest point of the surface, x and y along the last axis.
    point: Any


def ellipse_contacts(first: ArrayLike, second: ArrayLike) -> EllipseContacts:
    """Whether ellipses collide, how deep and where: the exact contacts of many pairs in one call.

    first and second are arrays of the shape (..., 5). The last axis has a, b, x, y, angle: the
    semi-axes, of which either may be the longer, the centre, and the angle of a (radians). The
    axes before are broadcast as numpy does: N ellipses against N are N pairs, one against N as
    well, and shapes (N, 1, 5) and (M, 5) give every one of N with every one of M. One pair,
    both of the shape (5,), gives plain floats and tuples.

    The contact is at the largest value, over all directions, of the distance of the two support
    lines. It is found by circles fitted to both ellipses at the same normal (after N. Hori,
    "Collision of Ellipses"), and proved to be the largest where the overlap is deep.

    Raises TypeError for what is not an array of numbers, and ValueError for shapes that do not
    fit, for numbers that are not finite and for semi-axes that no Ellipse can have.

    >>> ellipse_contacts((2, 1, 0, 0, 0), (1, 2, 5, 0, 0))
    EllipseContacts(distance=2.0, normal=(1.0, 0.0), first_point=(2.0, 0.0), second_point=(4.0, 0.0))

    One ellipse against three:

    >>> others = [(1, 1, x, 0, 0) for x in (2.5, 3, 4)]
    >>> ellipse_contacts((2, 1, 0, 0, 0), others).distance
    array([-0.5,  0. ,  1. ])
    """
    one = _ellipses("first", first)
    two = _ellipses("second", second)
    result, shape = _pairs(
        ("first", one, ELLIPSE),
        ("second", two, ELLIPSE),
        kernel().contacts_of_rows,
        CONTACT,
    )
    if shape == ():
        distance, nx, ny, x1, y1, x2, y2 = result.tolist()
        return EllipseContacts(distance, (nx, ny), (x1, y1), (x2, y2))
    return EllipseContacts(
        result[..., 0], result[..., 1:3], result[..., 3:5], result[..., 5:7]
    )


def nearest_points(ellipses: ArrayLike, points: ArrayLike) -> NearestPoints:
    """The points of ellipses that are nearest to given points, with the distances: many pairs in one call.

    ellipses is an array of the shape (..., 5) as for :py:func:`ellipse_contacts`, and points
    one of the shape (..., 2). The axes before the last are broadcast as numpy does.

    Source: D. Eberly, "Distance from a Point to an Ellipse", with Newton's method on the
    secular equation.

    Raises TypeError for what is not an array of numbers, and ValueError for shapes that do not
    fit, for numbers that are not finite and for semi-axes that no Ellipse can have.

    >>> nearest_points((2, 1, 0, 0, 0), (0, 4))
    NearestPoints(distance=3.0, normal=(0.0, 1.0), point=(0.0, 1.0))
    >>> nearest_points((2, 1, 0, 0, 0), [(5, 0), (0, 0)]).distance
    array([ 3., -1.])
    """
    one = _ellipses("ellipses", ellipses)
    two = _rows("points", points, POINT)
    result, shape = _pairs(
        ("ellipses", one, ELLIPSE),
        ("points", two, POINT),
        kernel().nearest_of_rows,
        NEAREST,
    )
    if shape == ():
        distance, nx, ny, x, y = result.tolist()
        return NearestPoints(distance, (nx, ny), (x, y))
    return NearestPoints(result[..., 0], result[..., 1:3], result[..., 3:5])


def _rows(name: str, value: ArrayLike, length: int) -> NDArray[Any]:
    """value as an array of rows of so many finite numbers."""
    array = _checks.floats(name, value)
    if array.ndim == 0 or array.shape[-1] != length:
        raise ValueError(
            f"{name} must have the shape (..., {length}), got {array.shape}"
        )
    return array


def _ellipses(name: str, value: ArrayLike) -> NDArray[Any]:
    """value as rows of a, b, x, y, angle that an Ellipse can have."""
    import numpy as np

    array = _rows(name, value, ELLIPSE)
    a, b = array[..., 0], array[..., 1]
    least = min(a.min(initial=1.0), b.min(initial=1.0))
    largest = max(a.max(initial=1.0), b.max(initial=1.0))
    if (
        least >= _checks.SMALLEST_SEMI_AXIS
        and largest <= _checks.LARGEST_SEMI_AXIS
        and largest <= _checks.LARGEST_ASPECT_RATIO * least
    ):
        # All of them by their extremes, which is several times as fast.
        return array
    shorter = np.minimum(a, b)
    longer = np.maximum(a, b)
    wrong = (
        (shorter < _checks.SMALLEST_SEMI_AXIS)
        | (longer > _checks.LARGEST_SEMI_AXIS)
        | (longer > _checks.LARGEST_ASPECT_RATIO * shorter)
    )
    if np.any(wrong):
        row = np.argwhere(wrong)[0]
        place = "".join(f"[{i}]" for i in row)
        try:
            _checks.semi_axes(float(a[tuple(row)]), float(b[tuple(row)]))
        except ValueError as error:
            raise ValueError(f"{name}{place}: {error}") from None
    return array


def _pairs(
    first: tuple[str, NDArray[Any], int],
    second: tuple[str, NDArray[Any], int],
    function: Any,
    length: int,
) -> tuple[NDArray[Any], tuple[int, ...]]:
    """The rows that a function of rows gives for all pairs, in the pairs' shape, and that."""
    import numpy as np

    shapes = first[1].shape[:-1], second[1].shape[:-1]
    try:
        shape = np.broadcast_shapes(*shapes)
    except ValueError:
        raise ValueError(
            f"{first[0]} and {second[0]} must have shapes that broadcast, "
            f"got {first[1].shape} and {second[1].shape}"
        ) from None
    count = int(np.prod(shape, dtype=np.int64))
    arguments: list[Any] = []
    for _name, array, size in (first, second):
        if array.size == size:
            # The same for all pairs.
            arguments += [np.ascontiguousarray(array), 0]
        else:
            whole = np.broadcast_to(array, (*shape, size))
            arguments += [np.ascontiguousarray(whole), size]
    result = np.empty((count, length))
    if count:
        function(*arguments, result)
    return result.reshape((*shape, length)), shape
