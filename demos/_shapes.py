"""What people use where they have no ellipse: polygons and circles that stand for one."""

from __future__ import annotations

from math import cos, pi, sin, sqrt

import pymunk


def inscribed_polygon(body: pymunk.Body, a: float, b: float, count: int) -> pymunk.Poly:
    """A polygon with its vertices on an ellipse, one at an end of a."""
    angles = [2.0 * pi * i / count for i in range(count)]
    return pymunk.Poly(body, [(a * cos(t), b * sin(t)) for t in angles])


def circle_of_equal_area(body: pymunk.Body, a: float, b: float) -> pymunk.Circle:
    """A circle with the area of an ellipse."""
    return pymunk.Circle(body, sqrt(a * b))
