"""Ellipses from what is at hand: points, an outline, an image mask or a bounding box."""

from __future__ import annotations

from math import atan2, frexp, hypot, sqrt
from typing import Any, NamedTuple

import numpy as np
import pymunk
from numpy.typing import ArrayLike, NDArray
from pymunk import Vec2d

from . import _checks

__all__ = [
    "EllipseParameters",
    "ellipse_from_bb",
    "ellipse_from_mask",
    "ellipse_from_outline",
    "ellipse_from_points",
]


class EllipseParameters(NamedTuple):
    """What an Ellipse is made of, in the order of its arguments, as in ``Ellipse(body, *parameters)``."""

    #: The semi-axis at the angle.
    a: float
    #: The semi-axis across it.
    b: float
    #: The centre.
    offset: Vec2d
    #: The angle of a (radians), from -pi/2 to pi/2; 0 where a and b are equal.
    angle: float


def ellipse_from_points(points: ArrayLike) -> EllipseParameters:
    """The ellipse with the mean and the second moments of points that are spread over a shape.

    points are n rows of x and y, evenly distributed over the area of what they stand for, and
    not only along its edge; that is what :py:func:`ellipse_from_outline` is for. a is not
    shorter than b.

    An ellipse that is evenly filled has the variances a^2/4 and b^2/4 along its axes.

    Raises TypeError or ValueError for points that are not finite numbers in rows of two, for
    fewer than three, and for those that lie on a line.

    >>> a, b, offset, angle = ellipse_from_points([(2, 0), (-2, 0), (0, 1), (0, -1)])
    >>> round(a, 3), round(b, 3), offset, angle
    (2.828, 1.414, Vec2d(0.0, 0.0), 0.0)
    """
    array = _rows_of_two("points", points)
    if len(array) < 3:
        raise ValueError(f"points must be three or more, got {len(array)}")
    array, scale = _scaled(array)
    center = array.mean(axis=0)
    x, y = (array - center).T
    moments = float(np.mean(x * x)), float(np.mean(x * y)), float(np.mean(y * y))
    return _ellipse("points", float(center[0]), float(center[1]), *moments, scale)


def ellipse_from_outline(vertices: ArrayLike) -> EllipseParameters:
    """The ellipse with the centroid and the second moments of the area that a polygon encloses.

    vertices are those of a polygon that does not cross itself, convex or not, in order, in
    either direction; pymunk.Poly.get_vertices gives such. a is not shorter than b.

    Raises TypeError or ValueError for vertices that are not finite numbers in rows of two, for
    fewer than three, and for those that enclose no area.

    >>> a, b, offset, angle = ellipse_from_outline([(0, 0), (6, 0), (6, 2), (0, 2)])
    >>> round(a / b, 3), offset, angle
    (3.0, Vec2d(3.0, 1.0), 0.0)
    """
    array = _rows_of_two("vertices", vertices)
    if len(array) < 3:
        raise ValueError(f"vertices must be three or more, got {len(array)}")
    array, scale = _scaled(array)
    # Near the origin, sums of products lose the fewest digits.
    origin = array.mean(axis=0)
    x, y = (array - origin).T
    # Each edge and the origin make a triangle, whose moments are polynomials of the two ends.
    next_x = np.roll(x, -1)
    next_y = np.roll(y, -1)
    twice_area = x * next_y - next_x * y
    area = float(np.sum(twice_area)) / 2.0
    extent = float(np.ptp(x)) * float(np.ptp(y))
    if not abs(area) > 1e-12 * extent:
        raise ValueError("vertices must enclose an area")
    mean_x = float(np.sum(twice_area * (x + next_x))) / (6.0 * area)
    mean_y = float(np.sum(twice_area * (y + next_y))) / (6.0 * area)
    xx = np.sum(twice_area * (x * x + x * next_x + next_x * next_x)) / (12.0 * area)
    yy = np.sum(twice_area * (y * y + y * next_y + next_y * next_y)) / (12.0 * area)
    products = 2.0 * (x * y + next_x * next_y) + x * next_y + next_x * y
    xy = np.sum(twice_area * products) / (24.0 * area)
    return _ellipse(
        "vertices",
        float(origin[0]) + mean_x,
        float(origin[1]) + mean_y,
        float(xx) - mean_x * mean_x,
        float(xy) - mean_x * mean_y,
        float(yy) - mean_y * mean_y,
        scale,
    )


def ellipse_from_mask(mask: Any) -> EllipseParameters:
    """The ellipse with the centroid and the second moments of what an image shows.

    mask has a row for each row of pixels. Its entries are weights, not negative: True and
    False, or how opaque a pixel is. A ``pygame.Mask`` will do as well. Pixels are squares of
    side 1; x counts columns and y counts rows from the corner of the first pixel, as in an
    image, with y down. Where the first row is the top and y is to point up, pass ``mask[::-1]``.
    a is not shorter than b.

    The arrays of pygame's ``surfarray`` count columns first: for those pass the transpose, as
    in ``ellipse_from_mask(pygame.surfarray.array_alpha(surface).T)``.

    Raises TypeError or ValueError for a mask that is not two-dimensional, has entries that are
    negative or not finite, or is empty.

    >>> a, b, offset, angle = ellipse_from_mask([[0, 0, 0], [1, 1, 1]])
    >>> round(a / b, 3), offset, angle
    (3.0, Vec2d(1.5, 1.5), 0.0)
    """
    weights, _scale = _scaled(_checks.floats("mask", _rows_of_mask(mask)))
    if weights.ndim != 2:
        raise ValueError(f"mask must have two dimensions, got {weights.ndim}")
    if np.any(weights < 0.0):
        raise ValueError(f"mask must not be negative, got {weights.min() * _scale!s}")
    total = float(weights.sum())
    if not total > 0.0:
        raise ValueError("mask must have a pixel that is not zero")
    columns = weights.sum(axis=0) / total
    rows = weights.sum(axis=1) / total
    x = np.arange(len(columns)) + 0.5
    y = np.arange(len(rows)) + 0.5
    center_x = float(columns @ x)
    center_y = float(rows @ y)
    x -= center_x
    y -= center_y
    # Each pixel adds the moments of a square about its own centre.
    square = 1.0 / 12.0
    return _ellipse(
        "mask",
        center_x,
        center_y,
        float(columns @ (x * x)) + square,
        float(y @ weights @ x) / total,
        float(rows @ (y * y)) + square,
        1.0,
    )


def _rows_of_mask(mask: Any) -> Any:
    """The pixels of a pygame.Mask in rows, and anything else as it is.

    numpy would read the packed bits of a Mask as numbers. pygame is not imported for this.
    """
    if not (hasattr(mask, "get_at") and hasattr(mask, "get_size")):
        return mask
    width, height = mask.get_size()
    return [[mask.get_at((x, y)) for x in range(width)] for y in range(height)]


def ellipse_from_bb(bb: pymunk.BB) -> EllipseParameters:
    """The ellipse that touches the four sides of a bounding box: a along x, b along y.

    Raises ValueError for a box that is not finite or has no extent.

    >>> ellipse_from_bb(pymunk.BB(left=-20, bottom=0, right=20, top=10))
    EllipseParameters(a=20.0, b=5.0, offset=Vec2d(0.0, 5.0), angle=0.0)
    """
    left, bottom, right, top = (
        _checks.number(f"bb.{side}", getattr(bb, side, None))
        for side in ("left", "bottom", "right", "top")
    )
    if not (left < right and bottom < top):
        raise ValueError(f"bb must have an extent in x and y, got {bb!r}")
    # Halves first, for the width of a box may be too large for a float.
    a, b = right / 2.0 - left / 2.0, top / 2.0 - bottom / 2.0
    return _parameters(
        "bb", a, b, left / 2.0 + right / 2.0, bottom / 2.0 + top / 2.0, 0.0
    )


def _scaled(array: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
    """The array divided by a power of two near its largest number, and that: squares neither over- nor underflow."""
    largest = float(np.max(np.abs(array), initial=0.0))
    scale = 2.0 ** (frexp(largest)[1] - 1) if largest > 0.0 else 1.0
    return array / scale, scale


def _rows_of_two(name: str, value: ArrayLike) -> NDArray[np.float64]:
    array = _checks.floats(name, value)
    if array.ndim != 2 or array.shape[1] != 2:
        raise ValueError(f"{name} must be rows of x and y, got shape {array.shape}")
    return array


def _ellipse(
    name: str, x: float, y: float, xx: float, xy: float, yy: float, scale: float
) -> EllipseParameters:
    """The ellipse with this centre and these second moments per area about it, enlarged by scale."""
    middle = (xx + yy) / 2.0
    half_difference = hypot((xx - yy) / 2.0, xy)
    longest = middle + half_difference
    # The determinant: middle - half_difference would cancel for a thin one.
    shortest = (xx * yy - xy * xy) / longest if longest > 0.0 else 0.0
    # Less is roundoff, or beyond the aspect ratio that an Ellipse can have.
    if not shortest > longest / _checks.LARGEST_ASPECT_RATIO**2:
        raise ValueError(f"{name} must not lie on a line")
    # Equal but for roundoff: no direction is that of the longer axis.
    isotropic = half_difference <= 1e-12 * middle
    angle = 0.0 if isotropic else atan2(2.0 * xy, xx - yy) / 2.0
    a, b = 2.0 * sqrt(longest) * scale, 2.0 * sqrt(shortest) * scale
    return _parameters(name, a, b, x * scale, y * scale, angle)


def _parameters(
    name: str, a: float, b: float, x: float, y: float, angle: float
) -> EllipseParameters:
    """Parameters that an Ellipse takes, or an error that names the argument they come from."""
    try:
        _checks.semi_axes(a, b)
        offset = _checks.offset((x, y), a, b)
    except ValueError as error:
        raise ValueError(f"{name} must give an ellipse that can be: {error}") from error
    return EllipseParameters(a, b, offset, angle)
