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

from math import sqrt

from .frame import Frame

Pair = tuple[float, float, float, float, float, float, float, float]

# f, its derivative f' along the counterclockwise turn of n, the distance along n between the
# centres of the two circles, the derivative of the sum of their radii, n (x, y), the first
# ellipse's support point (x, y), the radius of its circle and that radius's derivative.
Circles = tuple[float, float, float, float, float, float, float, float, float, float]

# f, n (x, y) and the first ellipse's support point (x, y).
Maximum = tuple[float, float, float, float, float]

# The climb ends when the next turn of the normal is smaller (radians), and promises to change the
# depth by less than this part of the smaller shape's shorter semi-axis: where circles are large,
# a small turn moves the contact far. That turn is then made without a look at what it leads to;
# the cube of the normal's error is left.
TURN_TOLERANCE = 1e-5
RISE_TOLERANCE = 1e-9

# A larger turn is cut to this (radians, nearly): a step does not see past a sharp end.
MAX_TURN = 0.5

# What the change of the radii may add to Newton's step, as a part of it.
MAX_CORRECTION = 0.5

# No other normal gives a depth that is smaller by more than this part of the smallest semi-axis.
DEPTH_TOLERANCE = 5e-7

# A step must gain this part of what the slope promised (Armijo's rule), or steps across a sharp peak could go on.
SUFFICIENT_RISE = 0.1

# Roundoff of f and f' where the two touch, as a part of the longer semi-axes.
ROUNDOFF = 2e-15

# Bounds on the loops, far above what the climb (30) and the sweep (60) were seen to take at aspect ratio 1000.
MAX_TURNS = 200
MAX_JUMPS = 300

# Keeps a point, whose support function is zero, from dividing by it. Lengths that matter are above 1e-50.
TINY = 1e-290


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


def fitted_circles(pair: Pair, mx: float, my: float) -> Circles:
    """Fit a circle to the first ellipse where its normal is n and to the second where it is -n.

    n is (mx, my) brought to unit length here, because the division need not be waited for.

    Support point and radius of curvature of an ellipse in the direction u are
    (a^2 ux, b^2 uy)/h and a^2 b^2/h^3, with h = sqrt(a^2 ux^2 + b^2 uy^2). As u turns, h
    changes by as much as the support point lies aside of u.
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

    p2x, p2y = c * p2x - s * p2y, s * p2x + c * p2y
    # From the first ellipse's support point to the second's.
    qx = dx - p1x - p2x
    qy = dy - p1y - p2y
    nx = mx * shorten
    ny = my * shorten
    f = qx * nx + qy * ny
    slope = qy * nx - qx * ny
    change1 = -3.0 * radius1 * inverse1 * (p1y * nx - p1x * ny)
    change2 = -3.0 * radius2 * inverse2 * (p2y * nx - p2x * ny)
    between = f + radius1 + radius2
    return f, slope, between, change1 + change2, nx, ny, p1x, p1y, radius1, change1


def first_guess(pair: Pair) -> tuple[float, float]:
    """A normal to start from, of any length: at d, that of the ellipse with the squared support function h1^2 + h2^2."""
    a1, b1, a2, b2, c, s, dx, dy = pair
    far = max(abs(dx), abs(dy))
    if far == 0.0:
        return 0.0, 1.0
    dx /= far
    dy /= far
    xx = a1 * a1 + a2 * a2 * c * c + b2 * b2 * s * s
    yy = b1 * b1 + a2 * a2 * s * s + b2 * b2 * c * c
    xy = (a2 * a2 - b2 * b2) * c * s
    nx = yy * dx - xy * dy
    ny = xx * dy - xy * dx
    if nx == 0.0 and ny == 0.0:
        return 0.0, 1.0
    return nx, ny


def smallest_axis(pair: Pair) -> float:
    """The shorter semi-axis of the smaller of the two; a point's does not count."""
    return pair[3] if 0.0 < pair[3] < pair[1] else pair[1]


def inscribed_radius(pair: Pair, nx: float, ny: float) -> float:
    """The radius of the largest disc in the Minkowski sum of the two that touches its surface where the normal is n.

    In an ellipse the largest disc that touches at a point has its centre where the normal there
    meets the longer semi-axis (the medial axis of an ellipse), and so the radius b^2/h.
    """
    a1, b1, a2, b2, c, s, _dx, _dy = pair
    along1 = a1 * nx
    across1 = b1 * ny
    along2 = a2 * (c * nx + s * ny)
    across2 = b2 * (c * ny - s * nx)
    h1 = sqrt(along1 * along1 + across1 * across1) + TINY
    h2 = sqrt(along2 * along2 + across2 * across2) + TINY
    return b1 * (b1 / h1) + b2 * (b2 / h2)


def climb(pair: Pair, nx: float, ny: float) -> Maximum:
    """Turn n uphill to a maximum of f; a step that gains too little is halved."""
    noise = ROUNDOFF * (pair[0] + pair[2])
    least_rise = max(RISE_TOLERANCE * smallest_axis(pair), noise)
    f = -1.0 / TINY
    slope = 0.0
    between = 0.0
    px = 0.0
    py = 0.0
    radius = 0.0
    change1 = 0.0
    turn = 0.0
    mx = nx
    my = ny
    for _ in range(MAX_TURNS):
        g, g_slope, g_between, change, mx, my, qx, qy, g_radius, g_change1 = (
            fitted_circles(pair, mx, my)
        )
        if g >= f + SUFFICIENT_RISE * slope * turn - noise:
            f = g
            slope = g_slope
            between = g_between
            nx = mx
            ny = my
            px = qx
            py = qy
            radius = g_radius
            change1 = g_change1
            turn = next_turn(slope, between, change)
            if between > 0.0 and abs(slope) <= noise:
                break
        else:
            turn *= 0.5
        if abs(turn) <= TURN_TOLERANCE and turn * slope <= least_rise:
            break
        mx = nx - turn * ny
        my = ny + turn * nx

    # The last turn, on the two circles and with what the first one's radius changes by.
    if abs(turn) <= TURN_TOLERANCE:
        half_square = 0.5 * turn * turn
        along = radius * turn + change1 * half_square
        inward = radius * half_square
        f += turn * slope - half_square * between
        px -= along * ny + inward * nx
        py += along * nx - inward * ny
        nx, ny = (
            nx - turn * ny - half_square * nx,
            ny + turn * nx - half_square * ny,
        )
    return f, nx, ny, px, py


def next_turn(slope: float, between: float, change: float) -> float:
    """The tangent of the angle to turn n by.

    Newton's step for f' = 0 turns n to the line that joins the centres of the two fitted
    circles. While n turns, the radii change; Chebyshev's method allows for it, which leaves the
    cube of n's error instead of the square.
    """
    if between > 0.0:
        inverse = 1.0 / between
        turn = slope * inverse
        correction = 0.5 * change * inverse * turn
        if abs(correction) < MAX_CORRECTION:
            turn -= correction * turn
        if turn > MAX_TURN:
            turn = MAX_TURN
        elif turn < -MAX_TURN:
            turn = -MAX_TURN
        return turn
    # Near a minimum of f Newton's step leads downhill.
    return MAX_TURN if slope >= 0.0 else -MAX_TURN


def sweep(pair: Pair, best: Maximum) -> Maximum:
    """The best maximum, after proving that no n has a larger f.

    Once around from the maximum; where f is larger, climb from there and go on with the better
    one. If that is above zero, the two are apart and there is no other.
    """
    _f, nx, ny, _px, _py = best
    noise = ROUNDOFF * (pair[0] + pair[2])
    slack = max(DEPTH_TOLERANCE * smallest_axis(pair), noise)
    turned_x = 1.0
    turned_y = 0.0
    for _ in range(MAX_JUMPS):
        circles = fitted_circles(pair, nx, ny)
        f, slope, _between, _change, nx, ny, _px, _py, _radius, _change1 = circles
        if f > best[0] + noise:
            best = climb(pair, nx, ny)
        cos, sin = jump_past(f, slope, inscribed_radius(pair, nx, ny), best[0] + slack)
        before_x = turned_x
        before_y = turned_y
        turned_x = cos * before_x - sin * before_y
        turned_y = sin * before_x + cos * before_y
        if best[0] > 0.0 or not comes_later(turned_x, turned_y, before_x, before_y):
            break
        nx, ny = cos * nx - sin * ny, sin * nx + cos * ny
    return best


def jump_past(
    f: float, slope: float, radius: float, ceiling: float
) -> tuple[float, float]:
    """The cosine and sine of the largest angle that n may turn by, counterclockwise, and f stays below the ceiling for certain.

    A disc of the given radius that touches the Minkowski sum of the two from within, where its
    normal is n, bounds the sum's support function from below, so that

        f(n turned by phi) <= (f + radius) cos phi + f' sin phi - radius

    A full turn is (1, 0). There are no angles in it: the C libraries' functions of them differ
    from platform to platform in the last bits, products and roots do not.
    """
    height = f + radius
    reach = sqrt(height * height + slope * slope)
    if ceiling + radius >= reach:
        return 1.0, 0.0
    peak_x = height / reach
    peak_y = slope / reach
    level = max(-1.0, (ceiling + radius) / reach)
    half_width = sqrt((1.0 - level) * (1.0 + level))
    return (
        peak_x * level + peak_y * half_width,
        peak_y * level - peak_x * half_width,
    )


def comes_later(mx: float, my: float, nx: float, ny: float) -> bool:
    """Whether m comes after n on the way around from (1, 0), counterclockwise.

    >>> comes_later(0.0, 1.0, 1.0, 0.0), comes_later(1.0, 0.0, 0.0, 1.0)
    (True, False)
    """
    m_is_above = my > 0.0 or (my == 0.0 and mx > 0.0)
    n_is_above = ny > 0.0 or (ny == 0.0 and nx > 0.0)
    if m_is_above != n_is_above:
        return n_is_above
    return nx * my - ny * mx > 0.0
