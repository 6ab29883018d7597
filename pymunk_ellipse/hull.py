"""The polygon with rounded corners that stands for an ellipse in pymunk's broad phase and in its mass."""

from __future__ import annotations

from math import cos, hypot, pi, sin, sqrt

# Found by measuring steps of a pile over aspect ratios and vertex counts, see demos/hulls.py.
DEFAULT_VERTICES = 8

# The rounded polygon is larger by this part of the longer semi-axis, so that roundoff cannot cut the ellipse.
MARGIN = 1e-9


def hull(
    a: float,
    b: float,
    angle: float,
    x: float,
    y: float,
    count: int = DEFAULT_VERTICES,
) -> tuple[list[tuple[float, float]], float]:
    """Vertices and radius of a polygon that contains an ellipse and has the same moment of inertia.

    The ellipse has the semi-axes a and b, a at the given angle (radians), and its centre at
    (x, y). The vertices are those of a regular polygon, stretched like the ellipse: one at an
    end of a, all larger by sqrt(3/(2 + cos(2 pi/count))), for which the moment of inertia per
    mass about the centre is (a^2 + b^2)/4. pymunk takes mass properties from the vertices
    alone, so the radius is free to cover what the polygon's faces cut off the ellipse: a
    distance that is largest for one of the faces, where it is a constant part of the support
    function.

    >>> vertices, radius = hull(2.0, 1.0, 0.0, 0.0, 0.0)
    >>> len(vertices), round(vertices[0][0], 3), round(radius, 3)
    (8, 2.105, 0.046)
    """
    step = 2.0 * pi / count
    scale = sqrt(3.0 / (2.0 + cos(step)))
    cos_angle = cos(angle)
    sin_angle = sin(angle)
    vertices = []
    farthest_face = 0.0
    for i in range(count):
        u = scale * a * cos(i * step)
        v = scale * b * sin(i * step)
        vertices.append(
            (x + cos_angle * u - sin_angle * v, y + sin_angle * u + cos_angle * v)
        )
        # The ellipse's support function along the normal of the face from vertex i to the next.
        middle = (i + 0.5) * step
        support = 1.0 / hypot(cos(middle) / a, sin(middle) / b)
        farthest_face = max(farthest_face, support)
    cut_off = 1.0 - scale * cos(step / 2.0)
    return vertices, cut_off * farthest_face + MARGIN * max(a, b)
