"""Random ellipses, points among them, and spaces full of shapes, for tests of queries."""

from math import pi

import numpy as np
import pymunk
import pymunk.batch
import pytest
from brute_force import ellipse_separations
from pymunk import ShapeFilter, Transform, Vec2d

from pymunk_ellipse import Ellipse, Space

ALL = ShapeFilter()


COUNT = 10_000


SPACES = pytest.mark.parametrize("Space", [pymunk.Space, Space], ids=["plain", "exact"])


def random_ellipses(rng, count, largest_aspect=20.0):
    """Ellipses without a body, each put somewhere: rows (a, b, x, y, angle), and the shapes."""
    size = 10 ** rng.uniform(-1, 1, count)
    ratio = largest_aspect ** rng.uniform(-1, 1, count)
    rows = np.column_stack(
        [
            size * np.sqrt(ratio),
            size / np.sqrt(ratio),
            rng.uniform(-30, 30, count),
            rng.uniform(-30, 30, count),
            rng.uniform(-pi, pi, count),
        ]
    )
    shapes = []
    for a, b, x, y, angle in rows:
        own = rng.uniform(-pi, pi)
        offset = Vec2d(*rng.uniform(-5, 5, 2))
        shape = Ellipse(None, a, b, offset, own)
        center = offset.rotated(angle - own)
        place = Transform.translation(x - center.x, y - center.y)
        shape.update(place @ Transform.rotation(angle - own))
        shapes.append(shape)
    return rows, shapes


def in_frame(rows, points):
    """Points, in the frames of ellipses."""
    x, y = points[:, 0] - rows[:, 2], points[:, 1] - rows[:, 3]
    c, s = np.cos(rows[:, 4]), np.sin(rows[:, 4])
    return c * x + s * y, c * y - s * x


def separations(rows, points):
    """Signed distances of points to ellipses, by looking in every direction."""
    a, b, x, y, angle = rows.T
    zero = np.zeros(len(rows))
    return ellipse_separations(
        np.column_stack(
            [a, b, angle, zero, zero, zero, points[:, 0] - x, points[:, 1] - y]
        )
    )


def random_points(rng, rows):
    """A point in the neighbourhood of each ellipse, half of them inside."""
    t = rng.uniform(0, 2 * pi, len(rows))
    r = np.where(
        rng.uniform(size=len(rows)) < 0.5,
        np.sqrt(rng.uniform(0, 1, len(rows))),
        rng.uniform(1, 4, len(rows)),
    )
    x, y = r * rows[:, 0] * np.cos(t), r * rows[:, 1] * np.sin(t)
    c, s = np.cos(rows[:, 4]), np.sin(rows[:, 4])
    return np.column_stack([rows[:, 2] + c * x - s * y, rows[:, 3] + s * x + c * y])


def crowd(rng, ellipses=24, space=None):
    """A space with ellipses between shapes of every other kind, on bodies of every type."""
    space = space or Space()

    def body():
        kind = rng.choice([pymunk.Body.STATIC, pymunk.Body.DYNAMIC])
        body = pymunk.Body(1, 1, body_type=int(kind))
        body.position = tuple(rng.uniform(-40, 40, 2))
        body.angle = rng.uniform(-pi, pi)
        space.add(body)
        return body

    shapes = []
    for i in range(ellipses):
        ratio = 8 ** rng.uniform(-1, 1)
        shapes.append(
            Ellipse(
                body(),
                6 * ratio**0.5,
                6 / ratio**0.5,
                tuple(rng.uniform(-3, 3, 2)),
                rng.uniform(-pi, pi),
            )
        )
        if i % 4 == 0:
            shapes.append(pymunk.Circle(body(), rng.uniform(1, 5), (1, 2)))
            shapes.append(pymunk.Segment(body(), (-5, 1), (4, -2), i % 8))
            shapes.append(pymunk.Poly.create_box(body(), (6, 3), 0.5))
    for i, shape in enumerate(shapes):
        shape.sensor = i % 5 == 0
        shape.filter = ShapeFilter(categories=1 << (i % 3))
    space.add(*shapes)
    return space


def ellipses_in(space):
    return [shape for shape in space.shapes if isinstance(shape, Ellipse)]


def not_ellipses(hits):
    return [hit for hit in hits if not isinstance(hit.shape, Ellipse)]


def seen(shape, mask):
    return bool(shape.filter.categories & mask)


MASKS = [ShapeFilter.ALL_MASKS(), 0b101]


def hull_of(ellipse):
    """What pymunk's broad phase sees, as a shape of its own."""
    hull = pymunk.Poly(ellipse.body, ellipse.get_vertices(), radius=ellipse.radius)
    hull.cache_bb()
    return hull
