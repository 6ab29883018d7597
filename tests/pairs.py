"""Shapes as plain numbers, and the package's narrow phase on them."""

from contextlib import contextmanager
from math import cos, hypot, pi, sin
from typing import NamedTuple

from pymunk_ellipse.narrowphase import common_normal
from pymunk_ellipse.narrowphase.ellipse_ellipse import ellipse_ellipse
from pymunk_ellipse.narrowphase.ellipse_polygon import ellipse_polygon, ellipse_segment


class Placed(NamedTuple):
    """An ellipse: semi-axes, centre and the angle of a."""

    a: float
    b: float
    x: float = 0.0
    y: float = 0.0
    angle: float = 0.0


class Round(NamedTuple):
    """A circle, segment or convex polygon: one, two or more vertices, counterclockwise, and a radius."""

    vertices: tuple[tuple[float, float], ...]
    radius: float = 0.0


class Found(NamedTuple):
    """A contact: distance, unit normal from the ellipse, point on the ellipse."""

    distance: float
    nx: float
    ny: float
    x: float
    y: float


def frame(ellipse):
    """Semi-axes, the longer first, the unit vector along it and the centre."""
    a, b, x, y, angle = ellipse
    if a < b:
        a, b, angle = b, a, angle + pi / 2
    return a, b, cos(angle), sin(angle), x, y


def splitting_planes(vertices):
    """Four numbers for each vertex: where it is, and the outward normal of the face that ends there."""
    planes = []
    for i, (x, y) in enumerate(vertices):
        ex, ey = x - vertices[i - 1][0], y - vertices[i - 1][1]
        length = hypot(ex, ey) or 1.0
        planes += (x, y, ey / length, -ex / length)
    return planes


def contact(ellipse, other, start=(0.0, 0.0)):
    """The contact of an ellipse with another shape, by the narrow phase."""
    at = frame(ellipse)
    if isinstance(other, Placed):
        return Found(*ellipse_ellipse(at, frame(other), *start))
    vertices, radius = other
    if len(vertices) == 1:
        circle = (radius, radius, 1.0, 0.0, *vertices[0])
        return Found(*ellipse_ellipse(at, circle, *start))
    if len(vertices) == 2:
        alone = (0.0, 0.0)
        return Found(*ellipse_segment(at, *vertices, alone, alone, radius))
    planes = splitting_planes(vertices)
    return Found(*ellipse_polygon(at, planes, len(vertices), radius))


@contextmanager
def counted_evaluations():
    """Counts how often circles are fitted, in a list with one number."""
    count = [0]
    fitted_circles = common_normal.fitted_circles

    def counting(*arguments):
        count[0] += 1
        return fitted_circles(*arguments)

    common_normal.fitted_circles = counting
    try:
        yield count
    finally:
        common_normal.fitted_circles = fitted_circles


def from_reference(case):
    """The two shapes of a case in contacts.json."""
    ellipse = Placed(*(case["ellipse"][key] for key in ("a", "b", "x", "y", "angle")))
    other = case["other"]
    if case["kind"] == "ellipse":
        return ellipse, Placed(*(other[key] for key in ("a", "b", "x", "y", "angle")))
    if case["kind"] == "circle":
        return ellipse, Round(((other["x"], other["y"]),), other["r"])
    vertices = tuple(tuple(vertex) for vertex in other["vertices"])
    return ellipse, Round(counterclockwise(vertices), other["r"])


def counterclockwise(vertices):
    """The vertices of a convex polygon in that order."""
    area = sum(
        x0 * y1 - x1 * y0
        for (x0, y0), (x1, y1) in zip(
            vertices, vertices[1:] + vertices[:1], strict=True
        )
    )
    return vertices if area >= 0 else vertices[::-1]
