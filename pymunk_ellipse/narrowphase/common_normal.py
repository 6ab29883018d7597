"""The fit itself: turn a normal until one circle fits each ellipse there, and prove that no other normal does better.

All of it happens in the frame of the first ellipse. A pair is the tuple

    (a1, b1, a2, b2, c, s, dx, dy)

with the first ellipse's centre at the origin and its semi-axis a1 along x, the second one's
centre at (dx, dy) and its semi-axis a2 along the unit vector (c, s). A circle is an ellipse
with equal semi-axes, a point is one without size.

For a unit vector n that points from the first to the second, let

    f(n) = n . d - h1(n) - h2(n)

with h the support functions. The largest f over all n is the distance between the two, and
minus their penetration depth when they overlap; the n it belongs to is the contact normal.

Scalars go in and come out: the same functions run as they are, and compiled by numba.
"""

from __future__ import annotations

from math import acos, atan2, cos, pi, sin, sqrt

from .frame import Frame

Pair = tuple[float, float, float, float, float, float, float, float]
Cone = tuple[float, float, float, float]

# f, n (x, y) and the first ellipse's support point (x, y).
Maximum = tuple[float, float, float, float, float]

# The fit ends when the next turn of the normal is smaller (radians), and promises to change the
# depth by less than this part of the shorter semi-axis: where circles are large, a small turn
# moves the contact far. That turn is then made without a look at what it leads to.
TURN_TOLERANCE = 1e-6
RISE_TOLERANCE = 1e-9

# A larger turn is cut to this (radians, nearly): Newton's step does not see past a sharp end.
MAX_TURN = 0.5

# No other normal gives a depth that is smaller by more than this part of the smallest semi-axis.
DEPTH_TOLERANCE = 5e-7

# A step must gain this part of what the slope promised (Armijo's rule), or steps across a sharp peak could go on.
SUFFICIENT_RISE = 0.1

# Roundoff of f and f' where the two touch, as a part of the longer semi-axes.
ROUNDOFF = 2e-15

# Bounds on the loops, far above what the climb (30) and the sweep (60) were seen to take at aspect ratio 1000.
MAX_TURNS = 100
MAX_JUMPS = 300

# Keeps a point, whose support function is zero, from dividing by it. Lengths that matter are above 1e-50.
TINY = 1e-290

ALL_ROUND: Cone = (0.0, 0.0, 0.0, 0.0)


def pair_of(first: Frame, second: Frame) -> Pair:
    """Two ellipses in the world, brought into the frame of the first."""
    a1, b1, c1, s1, x1, y1 = first
    a2, b2, c2, s2, x2, y2 = second
    dx = x2 - x1
    dy = y2 - y1
    return (
        a1,
        b1,
        a2,
        b2,
        c1 * c2 + s1 * s2,
        c1 * s2 - s1 * c2,
        c1 * dx + s1 * dy,
        c1 * dy - s1 * dx,
    )


def fitted_circles(
    pair: Pair, mx: float, my: float
) -> tuple[float, float, float, float, float, float, float, float]:
    """Fit a circle to the first ellipse where its normal is n and to the second where it is -n.

    n is (mx, my) brought to unit length here, because the division need not be waited for.

    Returns f, its derivative f' along the counterclockwise turn of n, the distance along n
    between the centres of the two circles, n (x, y), the first ellipse's support point (x, y)
    and the radius of its circle.

    Support point and radius of curvature of an ellipse in the direction u are
    (a^2 ux, b^2 uy)/h and a^2 b^2/h^3, with h = sqrt(a^2 ux^2 + b^2 uy^2).
    """
    a1, b1, a2, b2, c, s, dx, dy = pair
    length = sqrt(mx * mx + my * my)
    shorten = 1.0 / length

    ax1 = a1 * mx
    by1 = b1 * my
    inverse1 = 1.0 / (sqrt(ax1 * ax1 + by1 * by1) + TINY)
    p1x = a1 * ax1 * inverse1
    p1y = b1 * by1 * inverse1
    inverse1 *= length
    mean1 = a1 * b1 * inverse1
    radius1 = mean1 * mean1 * inverse1

    ax2 = a2 * (c * mx + s * my)
    by2 = b2 * (c * my - s * mx)
    inverse2 = 1.0 / (sqrt(ax2 * ax2 + by2 * by2) + TINY)
    p2x = a2 * ax2 * inverse2
    p2y = b2 * by2 * inverse2
    inverse2 *= length
    mean2 = a2 * b2 * inverse2
    radius2 = mean2 * mean2 * inverse2

    # From the first ellipse's support point to the second's.
    qx = dx - p1x - (c * p2x - s * p2y)
    qy = dy - p1y - (s * p2x + c * p2y)
    nx = mx * shorten
    ny = my * shorten
    f = qx * nx + qy * ny
    slope = qy * nx - qx * ny
    return f, slope, f + radius1 + radius2, nx, ny, p1x, p1y, radius1


def first_guess(pair: Pair) -> tuple[float, float]:
    """A normal to start from, of any length: at d, that of the ellipse with the squared support function h1^2 + h2^2."""
    a1, b1, a2, b2, c, s, dx, dy = pair
    xx = a1 * a1 + a2 * a2 * c * c + b2 * b2 * s * s
    yy = b1 * b1 + a2 * a2 * s * s + b2 * b2 * c * c
    xy = (a2 * a2 - b2 * b2) * c * s
    nx = yy * dx - xy * dy
    ny = xx * dy - xy * dx
    size = abs(nx) + abs(ny)
    if not size > TINY:
        return 0.0, 1.0
    return nx / size, ny / size


def sharpest(pair: Pair) -> float:
    """The smallest radius of curvature that the Minkowski sum of the two ellipses can have."""
    a1, b1, a2, b2, _c, _s, _dx, _dy = pair
    radius = b1 / a1 * b1
    if a2 > 0.0:
        radius += b2 / a2 * b2
    return radius


def climb(pair: Pair, nx: float, ny: float, cone: Cone) -> Maximum:
    """Turn n uphill to a maximum of f within the cone.

    The cone's four numbers are the unit vectors (x, y) where it begins and, counterclockwise,
    ends; ALL_ROUND has no limits. Newton's step for f' = 0 turns n to the line that joins the
    centres of the two fitted circles; a step that leaves the cone or gains too little is halved.
    """
    noise = ROUNDOFF * (pair[0] + pair[2])
    least_rise = RISE_TOLERANCE * pair[1]
    f, slope, between, nx, ny, px, py, radius = fitted_circles(pair, nx, ny)
    for _ in range(MAX_TURNS):
        if between > 0.0:
            if abs(slope) <= noise:
                break
            turn = slope / between
            if turn > MAX_TURN:
                turn = MAX_TURN
            elif turn < -MAX_TURN:
                turn = -MAX_TURN
        else:
            # Near a minimum of f Newton's step leads downhill.
            turn = MAX_TURN if slope >= 0.0 else -MAX_TURN

        uphill = False
        while abs(turn) > TURN_TOLERANCE or turn * slope > least_rise:
            mx = nx - turn * ny
            my = ny + turn * nx
            if in_cone(cone, mx, my):
                circles = fitted_circles(pair, mx, my)
                if circles[0] >= f + SUFFICIENT_RISE * slope * turn - noise:
                    uphill = True
                    break
            turn *= 0.5
        if not uphill:
            break
        f, slope, between, nx, ny, px, py, radius = circles

    # The last turn, on the two circles; the square of n's error is left.
    turn = slope / between if between > 0.0 else 0.0
    if abs(turn) <= TURN_TOLERANCE and in_cone(cone, nx - turn * ny, ny + turn * nx):
        half_square = 0.5 * turn * turn
        step_x = -turn * ny - half_square * nx
        step_y = turn * nx - half_square * ny
        f += 0.5 * slope * turn
        nx += step_x
        ny += step_y
        px += radius * step_x
        py += radius * step_y
    return f, nx, ny, px, py


def in_cone(cone: Cone, nx: float, ny: float) -> bool:
    """Whether n is in a cone that is narrower than a half circle, or in ALL_ROUND."""
    first_x, first_y, last_x, last_y = cone
    return first_x * ny >= first_y * nx and nx * last_y >= ny * last_x


def sweep(
    pair: Pair, nx: float, ny: float, extent: float, cone: Cone, best: Maximum
) -> Maximum:
    """The best maximum, after proving that f exceeds it nowhere on the arc of the given extent, counterclockwise from n.

    Where it does, climb within the cone and go on with the better maximum. If that is above
    zero, the two are apart and it is the only one. A disc as small as the sharpest ends, of
    radius r, rolls freely inside the Minkowski sum of the two (Blaschke's rolling theorem);
    from its position at n,

        f(n turned by phi) <= (f + r) cos phi + f' sin phi - r

    so one jump passes every n for which the right side stays below best.
    """
    a1, b1, a2, b2, _c, _s, _dx, _dy = pair
    r = sharpest(pair)
    slack = DEPTH_TOLERANCE * (b2 if 0.0 < b2 < b1 else b1)
    slack = max(slack, ROUNDOFF * (a1 + a2))
    swept = 0.0
    for _ in range(MAX_JUMPS):
        f, slope, _between, nx, ny, _px, _py, _radius = fitted_circles(pair, nx, ny)
        if f > best[0]:
            best = climb(pair, nx, ny, cone)
        ceiling = best[0] + slack + r
        reach = sqrt((f + r) * (f + r) + slope * slope)
        if best[0] > 0.0 or ceiling >= reach:
            break
        crossing = acos(max(-1.0, ceiling / reach))
        jump = atan2(slope, f + r) - crossing
        if jump < 0.0:
            jump += 2.0 * pi
        swept += jump
        if swept >= extent:
            break
        turned_x = nx * cos(jump) - ny * sin(jump)
        ny = ny * cos(jump) + nx * sin(jump)
        nx = turned_x
    return best
