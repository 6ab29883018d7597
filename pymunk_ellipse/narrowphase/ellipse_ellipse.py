"""Contact of an ellipse with an ellipse; with a circle or a point as an ellipse of equal semi-axes or none."""

from __future__ import annotations

from math import pi

from .common_normal import (
    ALL_ROUND,
    climb,
    first_guess,
    fitted_circles,
    sharpest,
    sweep,
)

# Distance, normal from the ellipse (x, y), contact point on it from its centre (x, y), evaluations.
Contact = tuple[float, float, float, float, float, int]


def ellipse_ellipse(
    a1: float,
    b1: float,
    c1: float,
    s1: float,
    a2: float,
    b2: float,
    c2: float,
    s2: float,
    dx: float,
    dy: float,
    nx: float,
    ny: float,
    margin: float,
) -> Contact:
    """Distance, contact normal and contact point of two ellipses.

    Semi-axes are a >= b, the one of length a along (c, s); the second centre lies at (dx, dy)
    from the first. (nx, ny) is a normal to start from, last step's say; zero if there is none.

    Returns the distance (negative: minus the penetration depth, the least translation that
    parts the two), the unit normal from the first to the second, the contact point on the
    first, from its centre, and the number of evaluations. The contact point on the second lies
    from there at the distance along the normal. Two that are apart by more than margin may
    come back as soon as that is certain, with a distance between margin and the true one.
    """
    # Into the first ellipse's frame.
    c = c1 * c2 + s1 * s2
    s = c1 * s2 - s1 * c2
    pair = (a1, b1, a2, b2, c, s, c1 * dx + s1 * dy, c1 * dy - s1 * dx)
    mx = c1 * nx + s1 * ny
    my = c1 * ny - s1 * nx
    if mx == 0.0 and my == 0.0:
        mx, my = first_guess(pair)

    f, mx, my, px, py, evaluations = climb(pair, mx, my, ALL_ROUND, margin)
    # Only deeper than the sharpest ends are round can another normal be better; most are not
    # as deep as the first one's.
    if f * a1 < -b1 * b1 and f < -sharpest(pair):
        _f, mx, my, swept = sweep(pair, mx, my, 2.0 * pi, ALL_ROUND, f, mx, my, margin)
        f, _slope, _between, mx, my, px, py = fitted_circles(pair, mx, my)
        evaluations += swept + 1

    return (
        f,
        c1 * mx - s1 * my,
        s1 * mx + c1 * my,
        c1 * px - s1 * py,
        s1 * px + c1 * py,
        evaluations,
    )
