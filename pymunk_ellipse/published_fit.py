"""The published alternating circle fit: how deep two ellipses overlap, by circles fitted to each in turn.

The package itself fits both circles at a common normal (narrowphase/common_normal.py); this is
the method it grew from, to compare with.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import asin, copysign, cos, hypot, isfinite, pi, sin
from operator import index
from typing import Any, NamedTuple

from . import _checks

# The search for a normal ends when it turns the parameter by less than this (radians), or after so many turns.
TURN_TOLERANCE = 1e-14
MAX_TURNS = 100

# The fit has converged when a sweep moves no circle by more than this part of the largest length.
MOVE_TOLERANCE = 1e-13


class PlacedEllipse(NamedTuple):
    """An ellipse in the world: its semi-axes, its centre, and the angle of a (radians)."""

    #: The semi-axis at the angle.
    a: float
    #: The semi-axis across it.
    b: float
    #: The centre's first coordinate.
    x: float
    #: The centre's second coordinate.
    y: float
    #: The angle of a (radians).
    angle: float = 0.0


class FittedCircle(NamedTuple):
    """An osculating circle of an ellipse: its centre in the world, and its radius."""

    #: The centre's first coordinate.
    x: float
    #: The centre's second coordinate.
    y: float
    #: The radius.
    radius: float


class CircleFit(NamedTuple):
    """What circle_fit found."""

    #: The circle fitted to the first ellipse.
    first: FittedCircle
    #: The circle fitted to the second ellipse.
    second: FittedCircle
    #: Penetration depth of the two circles: the sum of their radii less the distance of their
    #: centres. Negative when they are apart.
    depth: float
    #: Unit vector from the centre of the first circle to that of the second; zero where they coincide.
    normal: tuple[float, float]
    #: Sweeps done: fewer than asked for if nothing moved any more.
    sweeps: int
    #: Whether the last sweep left both circles where they were.
    converged: bool


def circle_fit(
    first: PlacedEllipse | Sequence[float],
    second: PlacedEllipse | Sequence[float],
    sweeps: int = 10,
) -> CircleFit:
    """Fit a circle to each of two ellipses where it faces the other's circle.

    Each ellipse is given as (a, b, x, y, angle): semi-axes of any order, centre, and the angle
    of a in radians. In every sweep each ellipse gets the osculating circle at a point whose
    normal passes through the centre of the other's last circle, at first through the centre of
    the other ellipse.

    Source: N. Hori, "Collision of Ellipses", on top of the "Simple Method for Distance to
    Ellipse". It is meant for small depths. In deep overlaps and for thin ellipses the circles
    may never settle, or settle where the depth is wrong: see CircleFit.converged for the
    first, there is no sign of the second. As published it does not return where a centre of
    curvature falls on the other's target, as for concentric circles. Here that circle stays
    where it is, and the result is finite and not converged.

    Raises TypeError for an ellipse that is not four or five numbers and for a number of sweeps
    that is not an integer, and ValueError for numbers that are not finite, for semi-axes that
    no Ellipse can have, for centres whose distance is not finite, and for less than one sweep.

    The published example:

    >>> fit = circle_fit((2, 1.5, 0.5, 0.5, 0.2), (1.5, 1, 2, 2.5, 2))
    >>> round(fit.depth, 6), fit.converged
    (0.429863, True)
    >>> [round(length, 3) for length in fit.first]
    [1.027, 0.396, 1.563]
    """
    one = _checked("first", first)
    two = _checked("second", second)
    origin_x, origin_y = one.x, one.y
    # From the first centre on, so that far from the origin nothing drowns in its coordinates.
    one = one._replace(x=0.0, y=0.0)
    two = two._replace(x=two.x - origin_x, y=two.y - origin_y)
    if not isfinite(hypot(two.x, two.y)):
        raise ValueError(
            f"second must not be infinitely far from first, got {second!r} and {first!r}"
        )
    try:
        sweeps_left = index(sweeps)
    except TypeError as error:
        raise TypeError(f"sweeps must be an integer, got {sweeps!r}") from error
    if sweeps_left < 1:
        raise ValueError(f"sweeps must be at least 1, got {sweeps!r}")

    circle1 = FittedCircle(one.x, one.y, 0.0)
    circle2 = FittedCircle(two.x, two.y, 0.0)
    done = 0
    converged = False
    while done < sweeps_left and not converged:
        last1, last2 = circle1, circle2
        circle1, settled1 = _circle_towards(one, last2.x, last2.y)
        circle2, settled2 = _circle_towards(two, last1.x, last1.y)
        done += 1
        lengths = (one.a, one.b, two.a, two.b, circle1.radius, circle2.radius)
        moved = max(
            abs(new - old)
            for new, old in zip((*circle1, *circle2), (*last1, *last2), strict=True)
        )
        converged = settled1 and settled2 and moved <= MOVE_TOLERANCE * max(lengths)

    dx = circle2.x - circle1.x
    dy = circle2.y - circle1.y
    distance = hypot(dx, dy)
    normal = (dx / distance, dy / distance) if distance > 0.0 else (0.0, 0.0)
    depth = circle1.radius + circle2.radius - distance
    circle1 = circle1._replace(x=circle1.x + origin_x, y=circle1.y + origin_y)
    circle2 = circle2._replace(x=circle2.x + origin_x, y=circle2.y + origin_y)
    return CircleFit(circle1, circle2, depth, normal, done, converged)


def _circle_towards(
    ellipse: PlacedEllipse, x: float, y: float
) -> tuple[FittedCircle, bool]:
    """The osculating circle at a point whose normal passes through a target (x, y), and whether there is one such point."""
    a, b, center_x, center_y, angle = ellipse
    c = cos(angle)
    s = sin(angle)
    u = c * (x - center_x) + s * (y - center_y)
    v = c * (y - center_y) - s * (x - center_x)
    t, settled = _parameter_towards(a, b, abs(u), abs(v))

    ex, ey = _evolute(a, b, cos(t), sin(t))
    ex = copysign(1.0, u) * ex
    ey = copysign(1.0, v) * ey
    slope = hypot(a * sin(t), b * cos(t))
    radius = slope / a * slope / b * slope
    return (
        FittedCircle(
            center_x + c * ex - s * ey,
            center_y + s * ex + c * ey,
            radius,
        ),
        settled,
    )


def _parameter_towards(a: float, b: float, u: float, v: float) -> tuple[float, bool]:
    """The parameter t in [0, pi/2] of (a cos t, b sin t) where the normal passes through (u, v), both not negative.

    The osculating circle at t stands in for the ellipse: t moves by the arc, on that circle,
    from the ellipse's point to the one that faces the target.
    """
    t = pi / 4.0
    for _ in range(MAX_TURNS):
        x = a * cos(t)
        y = b * sin(t)
        ex, ey = _evolute(a, b, cos(t), sin(t))
        rx = x - ex
        ry = y - ey
        qx = u - ex
        qy = v - ey
        radius = hypot(rx, ry)
        distance = hypot(qx, qy)
        if distance == 0.0:
            return t, False
        sine = (rx * qy - ry * qx) / radius / distance
        arc = radius * asin(min(1.0, max(-1.0, sine)))
        last = t
        t += arc / hypot(a * sin(t), b * cos(t))
        t = min(pi / 2.0, max(0.0, t))
        if abs(t - last) <= TURN_TOLERANCE:
            return t, True
    return t, False


def _evolute(a: float, b: float, cosine: float, sine: float) -> tuple[float, float]:
    """The centre of curvature of an ellipse at (a cosine, b sine), in its own frame."""
    across = (a - b) * (a + b)
    return across / a * cosine**3, -across / b * sine**3


def _checked(name: str, ellipse: Any) -> PlacedEllipse:
    try:
        placed = PlacedEllipse(*ellipse)
    except TypeError as error:
        raise TypeError(
            f"{name} must be four or five numbers (a, b, x, y, angle), got {ellipse!r}"
        ) from error
    try:
        a, b = _checks.semi_axes(placed.a, placed.b)
        x = _checks.number("x", placed.x)
        y = _checks.number("y", placed.y)
        angle = _checks.number("angle", placed.angle)
    except (TypeError, ValueError) as error:
        raise type(error)(f"{name}.{error}") from error
    return PlacedEllipse(a, b, x, y, angle)
