"""Whether two convex shapes overlap, decided without contact normals or depths, and with 40 digits.

Ellipses by the contact function of J. W. Perram and M. S. Wertheim ("Statistical mechanics of
hard ellipsoids"), an ellipse and a polygon by the affine map that makes the ellipse a circle.
"""

import math
from decimal import Decimal, localcontext

DIGITS = 40

# Golden section of the logit of lambda: needles have their maximum within 1e-24 of an end.
WIDEST = 80
GOLDEN = (Decimal(5).sqrt() - 1) / 2
STEPS = 60


def in_frame(ellipse, x, y):
    """The world's point (x, y) seen from an ellipse (a, b, x, y, angle), in Decimal."""
    _a, _b, center_x, center_y, angle = ellipse
    c, s = Decimal(math.cos(angle)), Decimal(math.sin(angle))
    dx, dy = Decimal(x) - Decimal(center_x), Decimal(y) - Decimal(center_y)
    return c * dx + s * dy, c * dy - s * dx


def matrix(ellipse):
    """Entries xx, xy, yy of the matrix whose eigenvalues are the squared semi-axes."""
    a, b = Decimal(ellipse[0]), Decimal(ellipse[1])
    c, s = Decimal(math.cos(ellipse[4])), Decimal(math.sin(ellipse[4]))
    return (
        a * a * c * c + b * b * s * s,
        (a * a - b * b) * c * s,
        a * a * s * s + b * b * c * c,
    )


def contact_function(first, second):
    """The square of the factor by which both ellipses must grow about their centres to touch: less than one if they overlap.

    It is the maximum over lambda in [0, 1] of lambda (1 - lambda) d C^-1 d with C = (1 -
    lambda) A + lambda B, concave in lambda.
    """
    with localcontext() as context:
        context.prec = DIGITS
        dx, dy = (
            Decimal(second[2]) - Decimal(first[2]),
            Decimal(second[3]) - Decimal(first[3]),
        )
        one, two = matrix(first), matrix(second)

        def at(logit):
            odds = logit.exp()
            left = 1 / (1 + odds)
            right = odds * left
            xx, xy, yy = (left * p + right * q for p, q in zip(one, two, strict=True))
            square = yy * dx * dx - 2 * xy * dx * dy + xx * dy * dy
            return left * right * square / (xx * yy - xy * xy)

        low, top = Decimal(-WIDEST), Decimal(WIDEST)
        inner_low, inner_top = (
            low + (1 - GOLDEN) * (top - low),
            low + GOLDEN * (top - low),
        )
        f_low, f_top = at(inner_low), at(inner_top)
        for _ in range(STEPS):
            if f_low >= f_top:
                top, inner_top, f_top = inner_top, inner_low, f_low
                inner_low = low + (1 - GOLDEN) * (top - low)
                f_low = at(inner_low)
            else:
                low, inner_low, f_low = inner_low, inner_top, f_top
                inner_top = low + GOLDEN * (top - low)
                f_top = at(inner_top)
        return max(f_low, f_top)


def polygon_function(ellipse, vertices):
    """The square of the factor by which an ellipse must grow about its centre to touch a polygon or segment; zero from inside."""
    with localcontext() as context:
        context.prec = DIGITS
        a, b = Decimal(ellipse[0]), Decimal(ellipse[1])
        corners = []
        for x, y in vertices:
            u, v = in_frame(ellipse, x, y)
            corners.append((u / a, v / b))
        nearest = min(
            square_of_distance_to_segment(*corners[i - 1], *corner)
            for i, corner in enumerate(corners)
        )
        sides = [
            corners[i - 1][0] * corner[1] - corners[i - 1][1] * corner[0]
            for i, corner in enumerate(corners)
        ]
        if len(corners) > 2 and min(sides) > 0:
            return Decimal(0)
        return nearest


def square_of_distance_to_segment(ax, ay, bx, by):
    """From the origin to the segment from a to b."""
    ex, ey = bx - ax, by - ay
    length = ex * ex + ey * ey
    along = -(ax * ex + ay * ey) / length if length else Decimal(0)
    along = min(max(along, Decimal(0)), Decimal(1))
    return (ax + along * ex) ** 2 + (ay + along * ey) ** 2
