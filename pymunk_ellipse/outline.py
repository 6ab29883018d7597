"""The outline of an ellipse as a polygon, fine enough for a screen."""

from __future__ import annotations

from functools import lru_cache
from math import asin, ceil, cos, pi, sin, sqrt

from pymunk import Transform, Vec2d

from .narrowphase.frame import Frame

# How far an ellipse may bulge over an edge of its outline: in the units of the screen, and as a
# part of the longer semi-axis, because matplotlib scales the picture afterwards.
LARGEST_BULGE = 0.1
LARGEST_RELATIVE_BULGE = 1e-3

# Enough for a semi-axis of 20000 pixels.
MOST_VERTICES = 1000


def outline_vertices(
    frame: Frame, from_longer: bool, transform: Transform
) -> list[Vec2d]:
    """Vertices of a polygon that looks like an ellipse.

    transform leads from where the frame is to where it is drawn, in pixels say. The vertices lie
    on the ellipse, counterclockwise before the transform, the first one at the end of the
    longer semi-axis, or of the shorter one, a quarter turn clockwise from there.

    >>> egg = 20.0, 10.0, 1.0, 0.0, 0.0, 0.0
    >>> vertices = outline_vertices(egg, True, Transform.scaling(2))
    >>> vertices[0], len(vertices)
    (Vec2d(40.0, 0.0), 71)
    """
    longer, shorter, c, s, x, y = frame
    center = transform @ Vec2d(x, y)
    long_axis = transform @ Vec2d(x + longer * c, y + longer * s) - center
    short_axis = transform @ Vec2d(x - shorter * s, y + shorter * c) - center
    first, second = (long_axis, short_axis) if from_longer else (-short_axis, long_axis)
    center_x, center_y = center
    first_x, first_y = first
    second_x, second_y = second
    return [
        Vec2d(
            center_x + cosine * first_x + sine * second_x,
            center_y + cosine * first_y + sine * second_y,
        )
        for cosine, sine in directions(vertices_for(max(first.length, second.length)))
    ]


@lru_cache
def directions(count: int) -> list[tuple[float, float]]:
    """Unit vectors all round, so many, from x on."""
    step = 2.0 * pi / count
    return [(cos(i * step), sin(i * step)) for i in range(count)]


def vertices_for(size: float) -> int:
    """How many vertices the outline of an ellipse needs whose longer semi-axis is size on the screen.

    In the middle, an edge that spans the angle 2 phi of a circle lies 1 - cos(phi) of the
    radius inside.
    """
    bulge = LARGEST_RELATIVE_BULGE
    if bulge * size > LARGEST_BULGE:
        bulge = LARGEST_BULGE / size
    phi = 2.0 * asin(sqrt(bulge / 2.0))
    return min(ceil(pi / phi), MOST_VERTICES)
