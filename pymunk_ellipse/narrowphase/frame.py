"""An ellipse in the world: where its frame goes with its body, its normal at a point and its bounding box."""

from __future__ import annotations

from math import cos, sin, sqrt

# Semi-axes (the longer first), the unit vector along the longer one (x, y) and the centre (x, y).
Frame = tuple[float, float, float, float, float, float]


def frame_of(a: float, b: float, x: float, y: float, angle: float) -> Frame:
    """The frame of an ellipse with a at an angle (radians) and its centre at (x, y); either semi-axis may be the longer.

    >>> frame_of(1.0, 2.0, 5.0, 6.0, 0.0)
    (2.0, 1.0, -0.0, 1.0, 5.0, 6.0)
    """
    c = cos(angle)
    s = sin(angle)
    if a >= b:
        return a, b, c, s, x, y
    return b, a, -s, c, x, y


def placed(frame: Frame, x: float, y: float, cos: float, sin: float) -> Frame:
    """The frame in the world of an ellipse on a body at (x, y) with the rotation vector (cos, sin)."""
    a, b, c, s, ox, oy = frame
    return (
        a,
        b,
        cos * c - sin * s,
        sin * c + cos * s,
        x + cos * ox - sin * oy,
        y + sin * ox + cos * oy,
    )


def normal_at(frame: Frame, px: float, py: float) -> tuple[float, float]:
    """The outward normal, of any length, of an ellipse at a point on or near it; zero at the centre."""
    a, b, c, s, x, y = frame
    dx = px - x
    dy = py - y
    flattening = (a / b) * (a / b)
    u = c * dx + s * dy
    v = (c * dy - s * dx) * flattening
    return c * u - s * v, s * u + c * v


def curvature_radius(frame: Frame, nx: float, ny: float) -> float:
    """The radius of curvature of an ellipse where its normal is along the unit vector (nx, ny).

    >>> curvature_radius((2.0, 1.0, 0.0, 1.0, 7.0, 9.0), 0.0, -1.0)
    0.5
    """
    a, b, c, s, _x, _y = frame
    along = a * (c * nx + s * ny)
    across = b * (c * ny - s * nx)
    h = sqrt(along * along + across * across)
    area = a * b
    return area / h * (area / h) / h


def half_extents(frame: Frame) -> tuple[float, float]:
    """Half the width and half the height of an ellipse's bounding box.

    >>> half_extents((2.0, 1.0, 0.0, 1.0, 7.0, 9.0))
    (1.0, 2.0)
    """
    a, b, c, s, _x, _y = frame
    along_x = a * c
    across_x = b * s
    along_y = a * s
    across_y = b * c
    return (
        sqrt(along_x * along_x + across_x * across_x),
        sqrt(along_y * along_y + across_y * across_y),
    )


def seen_from(frame: Frame, x: float, y: float, cos: float, sin: float) -> Frame:
    """The frame, in a body's coordinates, of an ellipse in the world; the body is at (x, y) with the rotation vector (cos, sin).

    >>> seen_from((2.0, 1.0, 1.0, 0.0, 5.0, 0.0), 4.0, -3.0, 0.0, 1.0)
    (2.0, 1.0, 0.0, -1.0, 3.0, -1.0)
    """
    a, b, c, s, wx, wy = frame
    dx = wx - x
    dy = wy - y
    return (
        a,
        b,
        cos * c + sin * s,
        cos * s - sin * c,
        cos * dx + sin * dy,
        cos * dy - sin * dx,
    )
