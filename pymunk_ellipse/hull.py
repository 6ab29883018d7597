"""The polygon with rounded corners that stands for an ellipse in pymunk's broad phase."""

from __future__ import annotations

from math import cos, pi, sin

from .narrowphase.frame import Frame

# As round as not to fall through chains of segments: once the polygon itself, without its radius,
# overlaps a chain, Chipmunk may report none of its segments. That costs 1 to 3% of a pile's step over
# the fastest, which has a rounding of 0.2 (`python -m demos hulls`).
VERTICES = 8
ROUNDING = 0.8

# Hulls are larger by this part of the longer semi-axis, so that roundoff cannot cut the ellipse.
MARGIN = 1e-9

# A linear map and a translation, in the order of pymunk.Transform.
Stretch = tuple[float, float, float, float, float, float]


def unit_polygon(count: int) -> list[tuple[float, float]]:
    """Counterclockwise vertices of a regular polygon around the unit circle, the first one on the x axis."""
    around = 1.0 / cos(pi / count)
    return [
        (around * cos(2.0 * pi * i / count), around * sin(2.0 * pi * i / count))
        for i in range(count)
    ]


def stretch(frame: Frame, rounding: float) -> tuple[Stretch, float]:
    """What makes the hull of an ellipse from a polygon around the unit circle: a map for its vertices, and a radius.

    With a radius of rounding times the shorter semi-axis, the polygons of two ellipses that
    touch do not overlap without their radius, which spares Chipmunk the search for how deep
    they do (EPA).

    An ellipse is contained in the one whose semi-axes are shorter by r, widened by r on all
    sides: the support functions are the lengths of the vectors (a nx, b ny), and of
    ((a - r) nx, (b - r) ny) plus that of r n. The vertices lie around the smaller ellipse.

    >>> stretch((2.0, 1.0, 0.0, 1.0, 7.0, 9.0), 0.5)[0]
    (0.0, 1.5, -0.5, 0.0, 7.0, 9.0)
    """
    a, b, c, s, x, y = frame
    radius = rounding * b
    a_inside = a - radius
    b_inside = b - radius
    return (
        (a_inside * c, a_inside * s, -b_inside * s, b_inside * c, x, y),
        radius + MARGIN * a,
    )
