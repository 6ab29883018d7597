"""Area and moment of inertia of an ellipse."""

from __future__ import annotations

from math import isfinite, pi

from . import _checks


def area_for_ellipse(a: float, b: float) -> float:
    """Area of an ellipse with the semi-axes a and b: pi a b.

    Raises TypeError or ValueError for semi-axes that no Ellipse can have.

    >>> area_for_ellipse(2, 1) / 3.141592653589793
    2.0
    """
    a, b = _checks.semi_axes(a, b)
    return pi * a * b


def moment_for_ellipse(
    mass: float, a: float, b: float, offset: tuple[float, float] = (0, 0)
) -> float:
    """Moment of inertia of a solid ellipse about the body's centre of gravity: mass ((a^2 + b^2)/4 + d^2), with d the offset's length.

    offset is the ellipse's centre in body local coordinates, as in pymunk.moment_for_circle.
    The angle of the ellipse makes no difference.

    Raises TypeError or ValueError for a mass or offset that is not finite and for semi-axes
    that no Ellipse can have.

    >>> moment_for_ellipse(10, 2, 1)
    12.5
    >>> moment_for_ellipse(10, 2, 1, offset=(3, 0))
    102.5
    """
    mass = _checks.number("mass", mass)
    a, b = _checks.semi_axes(a, b)
    center = _checks.point("offset", offset)
    distance_squared = center.x * center.x + center.y * center.y
    moment = mass * ((a * a + b * b) / 4.0 + distance_squared)
    if not isfinite(moment):
        raise ValueError(
            f"offset and mass must give a finite moment, got offset={offset!r}, mass={mass!r}"
        )
    return moment
