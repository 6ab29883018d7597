"""The polygon with rounded corners that stands for an ellipse in pymunk's broad phase."""

from __future__ import annotations

from math import cos, hypot, pi, sin, sqrt

# Chosen from the table that `python -m demos hulls` makes over aspect ratios from 1 to 10.
VERTICES = 8
ROUNDING = 0.2

# Hulls are larger by this part of the longer semi-axis, so that roundoff cannot cut the ellipse.
MARGIN = 1e-9

Hull = tuple[list[tuple[float, float]], float]


def rounded_hull(
    a: float,
    b: float,
    angle: float,
    x: float,
    y: float,
    count: int = VERTICES,
    rounding: float = ROUNDING,
) -> Hull:
    """Vertices and radius of a polygon that contains an ellipse.

    The ellipse has the semi-axes a and b, a at the given angle (radians), and its centre at
    (x, y). With a radius of rounding times the shorter semi-axis, the polygons of two ellipses
    that touch do not overlap without their radius, which spares Chipmunk the search for how
    deep they do (EPA).

    An ellipse is contained in the one whose semi-axes are shorter by r, widened by r on all
    sides: the support functions are the lengths of the vectors (a nx, b ny), and of
    ((a - r) nx, (b - r) ny) plus that of r n. The vertices are those of a regular polygon
    around a circle, stretched to lie around the smaller ellipse, one in line with a.

    >>> vertices, radius = rounded_hull(2.0, 1.0, 0.0, 0.0, 0.0)
    >>> len(vertices), round(vertices[0][0], 3), round(radius, 3)
    (8, 1.948, 0.2)
    """
    radius = rounding * min(a, b)
    around = 1.0 / cos(pi / count)
    vertices = stretched_polygon(
        around * (a - radius), around * (b - radius), angle, x, y, count
    )
    return vertices, radius + MARGIN * max(a, b)


def hull_with_moment(
    a: float, b: float, angle: float, x: float, y: float, count: int = VERTICES
) -> Hull:
    """Vertices and radius of a polygon that contains an ellipse and has the same moment of inertia.

    pymunk takes mass properties from the vertices alone. Those of a regular polygon, stretched
    like the ellipse and larger by sqrt(3/(2 + cos(2 pi/count))), have the moment per mass
    (a^2 + b^2)/4. The radius covers what the faces cut off the ellipse: a constant part of its
    support function there, so the largest support function counts.

    It costs more time than rounded_hull and serves where the moment cannot be set otherwise.

    >>> vertices, radius = hull_with_moment(2.0, 1.0, 0.0, 0.0, 0.0)
    >>> len(vertices), round(vertices[0][0], 3), round(radius, 3)
    (8, 2.105, 0.046)
    """
    step = 2.0 * pi / count
    scale = sqrt(3.0 / (2.0 + cos(step)))
    vertices = stretched_polygon(scale * a, scale * b, angle, x, y, count)
    supports = [
        1.0 / hypot(cos((i + 0.5) * step) / a, sin((i + 0.5) * step) / b)
        for i in range(count)
    ]
    radius = (1.0 - scale * cos(step / 2.0)) * max(supports)
    return vertices, radius + MARGIN * max(a, b)


def stretched_polygon(
    a: float, b: float, angle: float, x: float, y: float, count: int
) -> list[tuple[float, float]]:
    """Counterclockwise vertices on an ellipse, those of a regular polygon before stretching, the first at the end of a."""
    cos_angle = cos(angle)
    sin_angle = sin(angle)
    vertices = []
    for i in range(count):
        u = a * cos(2.0 * pi * i / count)
        v = b * sin(2.0 * pi * i / count)
        vertices.append(
            (x + cos_angle * u - sin_angle * v, y + sin_angle * u + cos_angle * v)
        )
    return vertices
