"""Many random pairs against brute force: the tests run some of them, this file all that are asked for.

python tests/exactness.py --outlines 100000 --sizes 50000
"""

import argparse
from math import cos, hypot, pi, sin

import brute_force
import numpy as np
from pairs import Placed, Round, contact


def support_point(ellipse, nx, ny):
    """The farthest point of an ellipse along n."""
    a, b, x, y, angle = ellipse
    c, s = cos(angle), sin(angle)
    u, v = a * (c * nx + s * ny), b * (c * ny - s * nx)
    h = hypot(u, v)
    u, v = a * u / h, b * v / h
    return x + c * u - s * v, y + s * u + c * v


def random_outline(random):
    """Corners of a convex polygon around the origin, counterclockwise, none of them flat."""
    count = int(random.integers(3, 9))
    size = np.exp(random.uniform(np.log(0.3), np.log(30)))
    flat = random.uniform(0.1, 1)
    steps = random.uniform(0.3, 1, count)
    at = np.cumsum(steps) * 2 * np.pi / steps.sum()
    return size * np.column_stack([np.cos(at), flat * np.sin(at)])


def with_extra_vertices(random, corners):
    """The same outline with 0 to 3 more vertices on each edge, anywhere, and some corners twice."""
    vertices = []
    for corner, following in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        count = int(random.integers(0, 4))
        parts = random.uniform(0, 1, count)
        near = random.uniform(size=count) < 0.2
        parts[near] = 10.0 ** random.uniform(-17, 0, near.sum())
        far = random.uniform(size=count) < 0.2
        parts[far] = 1 - 10.0 ** random.uniform(-17, 0, far.sum())
        vertices.append(corner)
        vertices += [corner + part * (following - corner) for part in sorted(parts)]
    return np.array(vertices)


def moved(points, angle, place):
    """Points rotated about the origin, then moved."""
    c, s = np.cos(angle), np.sin(angle)
    x, y = np.asarray(points).T
    return np.column_stack([c * x - s * y, s * x + c * y]) + place


def as_tuples(points):
    return tuple(map(tuple, np.asarray(points).tolist()))


def outline_case(random):
    """An ellipse near a corner or an edge of a polygon, the polygon's corners, and the polygon with more vertices."""
    corners = random_outline(random)
    more = with_extra_vertices(random, corners)
    turn, angle = random.uniform(-pi, pi, 2)
    place = random.uniform(-1, 1, 2) * 10.0 ** random.uniform(-1, 4)
    corners, more = moved(corners, turn, place), moved(more, turn, place)
    b = np.exp(random.uniform(np.log(0.3), np.log(3)))
    ellipse = Placed(b * 10 ** random.uniform(0, 1), b, 0.0, 0.0, angle)
    edge = int(random.integers(len(corners)))
    start, end = corners[edge - 1], corners[edge]
    along = end - start
    nx, ny = np.array([-along[1], along[0]]) / np.hypot(*along)
    if random.uniform() < 0.3:
        phi = random.uniform(-pi, pi)
        nx, ny = cos(phi), sin(phi)
    gap = random.uniform(-0.9, 0.5) * b
    px, py = support_point(ellipse, nx, ny)
    qx, qy = start + random.uniform(0, 1) * along
    ellipse = ellipse._replace(x=qx - px - gap * nx, y=qy - py - gap * ny)
    return ellipse, as_tuples(corners), as_tuples(more)


def outline_errors(seed, count):
    """For each of many pairs the error of the distance, in semi-axes b, and whether overlap was decided wrongly."""
    random = np.random.default_rng(seed)
    errors, wrong = np.zeros(count), np.zeros(count, bool)
    for i in range(count):
        ellipse, corners, more = outline_case(random)
        _rows, values, _angles = brute_force.polygon_peaks(ellipse, corners, 0.0, 128)
        truth = values.max()
        found = contact(ellipse, Round(more)).distance
        errors[i] = abs(found - truth) / ellipse.b
        wrong[i] = (found > 0) != (truth > 0) and abs(truth) > 1e-6 * ellipse.b
    return errors, wrong


def size_case(random):
    """Two ellipses, one of them 100 to 1e6 times as large as the other, that overlap or gape by up to half the smaller's b."""
    sizes = [1.0, 10.0 ** random.uniform(2, 6)]
    random.shuffle(sizes)
    first, second = (
        Placed(
            size * 10 ** random.uniform(0, 1), size, 0.0, 0.0, random.uniform(-pi, pi)
        )
        for size in sizes
    )
    phi = random.uniform(-pi, pi)
    nx, ny = cos(phi), sin(phi)
    gap = random.uniform(-0.5, 0.5)
    px, py = support_point(first, nx, ny)
    qx, qy = support_point(second, -nx, -ny)
    return first, second._replace(x=px - qx + gap * nx, y=py - qy + gap * ny)


def size_errors(seed, count):
    """For each of many pairs how far the contact's two points are from where the surfaces have its normal, in semi-axes b of the smaller."""
    random = np.random.default_rng(seed)
    errors = np.zeros(count)
    for i in range(count):
        first, second = size_case(random)
        found = contact(first, second)
        ax, ay = support_point(first, found.nx, found.ny)
        bx, by = support_point(second, -found.nx, -found.ny)
        x, y = found.x + found.distance * found.nx, found.y + found.distance * found.ny
        errors[i] = max(hypot(found.x - ax, found.y - ay), hypot(x - bx, y - by))
    return errors


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--outlines", type=int, default=1000, metavar="N")
    parser.add_argument("--sizes", type=int, default=1000, metavar="N")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    errors, wrong = outline_errors(arguments.seed, arguments.outlines)
    print(f"outlines: {arguments.outlines} pairs, {wrong.sum()} decided wrongly")
    print(f"largest error {errors.max():.2g} b, {(errors > 1e-6).sum()} above 1e-6 b")
    errors = size_errors(arguments.seed, arguments.sizes)
    print(f"sizes: {arguments.sizes} pairs, points off by {errors.max():.2g} b")


if __name__ == "__main__":
    main()
