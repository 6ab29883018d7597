"""Separations found by looking in every direction: slow, plain and independent of the package's narrow phase.

The separation of two convex shapes along a unit vector n, from the first to the second, is
the gap between the two planes perpendicular to n that touch them. Its largest value over all n
is the distance of the shapes, or minus their penetration depth.
"""

import numpy as np

GOLDEN = (5**0.5 - 1) / 2


def support(a, b, angle, cosine, sine):
    """Support function of an ellipse about its centre in the direction (cosine, sine)."""
    c, s = np.cos(angle), np.sin(angle)
    return np.hypot(a * (c * cosine + s * sine), b * (c * sine - s * cosine))


def normals(a, b, angle, count):
    """The angles of an ellipse's normals at count points, evenly spaced in its parameter, in ascending order."""
    t = np.linspace(-np.pi, np.pi, count, endpoint=False)
    return np.arctan2(a * np.sin(t), b * np.cos(t)) + angle


def peaks(separation, angles, slack):
    """All local maxima of a separation within slack of the largest one that a scan sees.

    separation takes the numbers of some rows, and cosines and sines of directions for each.
    angles has one row of ascending angles, once around, for each problem. Returns the maxima's
    rows, values and angles.
    """
    rows = np.arange(len(angles))[:, None]
    f = separation(rows, np.cos(angles), np.sin(angles))
    high = f >= f.max(axis=1, keepdims=True) - slack
    peak = high & (f >= np.roll(f, 1, axis=1)) & (f >= np.roll(f, -1, axis=1))
    row, column = np.nonzero(peak)
    last = angles.shape[1] - 1
    turn = 2 * np.pi
    low = angles[row, column - 1] - turn * (column == 0)
    top = angles[row, (column + 1) % (last + 1)] + turn * (column == last)

    # Golden section.
    def at(phi):
        return separation(row, np.cos(phi), np.sin(phi))

    inner_low = top - GOLDEN * (top - low)
    inner_top = low + GOLDEN * (top - low)
    f_low, f_top = at(inner_low), at(inner_top)
    while np.max(top - low) > 1e-9:
        left = f_low >= f_top
        low, top = np.where(left, low, inner_low), np.where(left, inner_top, top)
        new = np.where(left, top - GOLDEN * (top - low), low + GOLDEN * (top - low))
        f_new = at(new)
        inner_low, inner_top = (
            np.where(left, new, inner_top),
            np.where(left, inner_low, new),
        )
        f_low, f_top = np.where(left, f_new, f_top), np.where(left, f_low, f_new)
    value, phi = np.maximum(f_low, f_top), np.where(f_low > f_top, inner_low, inner_top)
    # A peak with a kink at the scan's own angle is the value there.
    scanned = f[row, column] > value
    value = np.where(scanned, f[row, column], value)
    return row, value, np.where(scanned, angles[row, column], phi)


def ellipse_peaks(pairs, count):
    """The peaks of many pairs of ellipses, from scans over count normals of each.

    pairs is an array of rows (a1, b1, angle1, a2, b2, angle2, dx, dy).
    """
    a1, b1, angle1, a2, b2, angle2, dx, dy = (column[:, None] for column in pairs.T)

    def separation(rows, cosine, sine):
        one = (number[rows, 0] for number in (a1, b1, angle1))
        two = (number[rows, 0] for number in (a2, b2, angle2))
        along = dx[rows, 0] * cosine + dy[rows, 0] * sine
        return along - support(*one, cosine, sine) - support(*two, cosine, sine)

    # Between two neighbours of a scan f, whose second derivative is less than the radius of
    # curvature of the Minkowski sum, rises by less than this.
    slack = (a1 + b1 + a2 + b2) * (2 * np.pi / count) ** 2 / 2
    scans = [
        peaks(separation, normals(a1, b1, angle1, count), slack),
        peaks(separation, normals(a2, b2, angle2, count), slack),
    ]
    return tuple(np.concatenate(parts) for parts in zip(*scans, strict=True))


def ellipse_separations(pairs, count=128, at_a_time=4000):
    """The separation of each of many pairs of ellipses."""
    best = np.full(len(pairs), -np.inf)
    for start in range(0, len(pairs), at_a_time):
        rows, values, _angles = ellipse_peaks(pairs[start : start + at_a_time], count)
        np.maximum.at(best, start + rows, values)
    return best


def polygon_separation(ellipse, vertices, radius):
    """The separation of an ellipse (a, b, x, y, angle) and the convex hull of some vertices with a radius, as a function of direction."""
    a, b, x, y, angle = ellipse
    corners = np.asarray(vertices, float) - (x, y)

    def separation(rows, cosine, sine):
        del rows
        nearest = np.min(
            [vx * cosine + vy * sine for vx, vy in corners],
            axis=0,
        )
        return nearest - support(a, b, angle, cosine, sine) - radius

    return separation


def polygon_peaks(ellipse, vertices, radius, count):
    """The peaks of an ellipse and a convex polygon, segment (two vertices) or circle (one vertex)."""
    a, b, _x, _y, angle = ellipse
    corners = np.asarray(vertices, float)
    edges = np.roll(corners, -1, axis=0) - corners
    faces = np.arctan2(edges[:, 1], edges[:, 0]) + np.pi / 2
    even = np.linspace(0, 2 * np.pi, count, endpoint=False)
    several = (normals(a, b, angle, count), faces, faces + np.pi, even)
    angles = np.unique(np.concatenate(several) % (2 * np.pi))[None, :]
    return peaks(polygon_separation(ellipse, vertices, radius), angles, np.inf)
