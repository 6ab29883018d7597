"""The nearest point of an ellipse's surface to a point, with the signed distance."""

from __future__ import annotations

from math import sqrt

from .frame import Frame

# Signed distance (negative inside), outward normal (x, y) and nearest point of the surface (x, y).
Nearest = tuple[float, float, float, float, float]

# Roundoff of a sum of two squares that should be one, and of a distance as a part of the lengths that enter it.
ROUNDOFF = 4e-16

# Bound on the loop. Five steps are usual; 43 were seen for points near the centre of curvature of a sharp end.
MAX_STEPS = 100

# From this many semi-axes away an ellipse is a point to double precision.
FAR = 1e100


def length_of(x: float, y: float) -> float:
    """The length of a vector of any size.

    The platforms' own hypot differ in the last bits.
    """
    scale = max(abs(x), abs(y))
    if scale == 0.0:
        return 0.0
    u = x / scale
    v = y / scale
    return scale * sqrt(u * u + v * v)


def nearest_on_axes(a: float, b: float, x: float, y: float) -> Nearest:
    """The nearest point to (x, y) on the ellipse with semi-axes a >= b along x and y, centre at the origin.

    The nearest point lies in the point's own quadrant, where it is (a cos, b sin) with

        cos = (a/b)^2 (x/a) / (w + k)    sin = (y/b) / w    k = (a/b)^2 - 1

    and w > 0 such that cos^2 + sin^2 = 1 (D. Eberly, "Distance from a Point to an Ellipse").
    The sum falls as w grows, and the larger of the two w that make one of the squares equal to
    one is not too large. From there Newton's method on 1/sqrt(sum) = 1 climbs to w without
    passing it: that function is nearly straight (the secular equation of trust regions).

    Among nearest points on both sides of an axis, the one on the positive side is taken.
    """
    if abs(x) > FAR * a or abs(y) > FAR * a:
        scale = max(abs(x), abs(y))
        along_x = x / scale
        along_y = y / scale
        length = sqrt(along_x * along_x + along_y * along_y)
        nx = along_x / length
        ny = along_y / length
        u = a * nx
        v = b * ny
        h = sqrt(u * u + v * v)
        return scale * length, nx, ny, a * (u / h), b * (v / h)

    k = (a - b) / b * ((a + b) / b)
    u = a / b * (abs(x) / b)
    v = abs(y) / b
    w = max(v, u - k)
    if w > 0.0:
        cos = u / (w + k)
        sin = v / w
        total = cos * cos + sin * sin
        for _ in range(MAX_STEPS):
            if total <= 1.0 + ROUNDOFF:
                break
            fall = cos * cos * (w / (w + k)) + sin * sin
            w += w * total * (sqrt(total) - 1.0) / fall
            cos = u / (w + k)
            sin = v / w
            total = cos * cos + sin * sin
        root = sqrt(total)
        cos /= root
        sin /= root
    else:
        # On the long axis, between the centres of curvature of its ends.
        cos = u / k if k > 0.0 else 0.0
        sin = sqrt(1.0 - cos * cos)
    if x < 0.0:
        cos = -cos
    if y < 0.0:
        sin = -sin

    nx = b * cos
    ny = a * sin
    length = sqrt(nx * nx + ny * ny)
    nx /= length
    ny /= length
    px = a * cos
    py = b * sin
    return (x - px) * nx + (y - py) * ny, nx, ny, px, py


def nearest_point(ellipse: Frame, x: float, y: float) -> Nearest:
    """Signed distance of the point (x, y) to an ellipse, with the normal and the nearest point of its surface.

    The distance is negative inside. The normal is the distance's gradient: it points from the
    nearest point to (x, y), or away from it inside, and is finite everywhere.

    >>> nearest_point((2.0, 1.0, 1.0, 0.0, 10.0, 0.0), 13.0, 0.0)
    (1.0, 1.0, 0.0, 12.0, 0.0)
    >>> nearest_point((2.0, 1.0, 1.0, 0.0, 10.0, 0.0), 10.0, 0.0)
    (-1.0, 0.0, 1.0, 10.0, 1.0)
    """
    a, b, c, s, cx, cy = ellipse
    dx = x - cx
    dy = y - cy
    distance, nx, ny, px, py = nearest_on_axes(a, b, c * dx + s * dy, c * dy - s * dx)
    return (
        distance,
        c * nx - s * ny,
        s * nx + c * ny,
        cx + c * px - s * py,
        cy + s * px + c * py,
    )
