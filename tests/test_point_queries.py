"""Point queries: distances, nearest points and gradients, against brute force and closed forms; of a shape and of a space."""

import itertools
from math import cos, hypot, inf, isfinite, pi, sin

import numpy as np
import pymunk
import pymunk.batch
import pytest
from crowds import (
    ALL,
    COUNT,
    MASKS,
    SPACES,
    crowd,
    ellipses_in,
    hull_of,
    in_frame,
    not_ellipses,
    random_ellipses,
    random_points,
    seen,
    separations,
)
from pymunk import ShapeFilter, Vec2d

from pymunk_ellipse import Ellipse, Space


def test_distances_are_those_of_brute_force():
    rng = np.random.default_rng(1)
    rows, shapes = random_ellipses(rng, COUNT)
    points = random_points(rng, rows)
    hits = [
        shape.point_query(point) for shape, point in zip(shapes, points, strict=True)
    ]
    distance = np.array([hit.distance for hit in hits])
    size = rows[:, :2].max(axis=1)
    assert np.all(np.abs(distance - separations(rows, points)) < 1e-9 * size)
    assert 0.4 < np.mean(distance < 0) < 0.6

    # The nearest point is on the surface, at that distance, where the gradient is normal.
    nearest = np.array([hit.point for hit in hits])
    gradient = np.array([hit.gradient for hit in hits])
    u, v = in_frame(rows, nearest)
    a, b = rows[:, 0], rows[:, 1]
    assert np.all(np.abs(np.hypot(u / a, v / b) - 1) < 1e-9)
    away = points - nearest
    assert np.all(np.abs(away - distance[:, None] * gradient) < 1e-9 * size[:, None])
    c, s = np.cos(rows[:, 4]), np.sin(rows[:, 4])
    nx, ny = u / a**2, v / b**2
    normal = np.column_stack([c * nx - s * ny, s * nx + c * ny])
    normal /= np.hypot(nx, ny)[:, None]
    assert np.all(np.abs(normal - gradient) < 1e-7)
    assert all(hit.shape is shape for hit, shape in zip(hits, shapes, strict=True))


@pytest.mark.parametrize("size", [1e-40, 1e-6, 1.0, 1e6, 1e40])
@pytest.mark.parametrize("aspect", [1.0, 1.5, 30.0, 1e3, 1e6])
@pytest.mark.parametrize("tall", [False, True])
def test_distance_along_a_normal(size, aspect, tall):
    """From a point of the surface outwards, and inwards up to the smallest radius of curvature."""
    longer, shorter = size, size / aspect
    a, b = (shorter, longer) if tall else (longer, shorter)
    shape = Ellipse(None, a, b)
    inwards = shorter * shorter / longer
    for t in np.linspace(0, 2 * pi, 33):
        n = Vec2d(b * cos(t) / size, a * sin(t) / size).normalized()
        surface = Vec2d(a * cos(t), b * sin(t))
        for d in (1e6 * size, 3 * size, shorter, inwards, 0.0, -0.9 * inwards):
            hit = shape.point_query(surface + d * n)
            assert hit.distance == pytest.approx(d, rel=1e-9, abs=1e-15 * size)
            assert hit.point.x == pytest.approx(surface.x, abs=1e-9 * (size + abs(d)))
            assert hit.point.y == pytest.approx(surface.y, abs=1e-9 * (size + abs(d)))
            assert hit.gradient.length == pytest.approx(1)


def test_points_on_the_axes():
    shape = Ellipse(None, 4, 2)
    assert shape.point_query((6, 0))[1:] == ((4, 0), 2, (1, 0))
    assert shape.point_query((-6, 0))[1:] == ((-4, 0), 2, (-1, 0))
    assert shape.point_query((0, -7))[1:] == ((0, -2), 5, (0, -1))
    # Between an end and its centre of curvature the end is nearest, farther in it is not.
    assert shape.point_query((3.5, 0))[1:] == ((4, 0), -0.5, (1, 0))
    point = shape.point_query((1.5, 0)).point
    assert point.x == pytest.approx(2)
    assert abs(point.y) == pytest.approx(2 * 0.75**0.5)


@pytest.mark.parametrize("a, b", [(4, 2), (2, 4), (3, 3)])
def test_center(a, b):
    hit = Ellipse(None, a, b, (7, 8)).point_query((7, 8))
    assert hit.distance == -min(a, b)
    assert hit.gradient.length == 1
    assert (hit.point - (7, 8)).length == min(a, b)
    assert hit.point == (7, 8) + min(a, b) * hit.gradient


@pytest.mark.parametrize("a, b", [(1.0, 1.0), (1.0, 1e-6), (1e-3, 1.0), (1e50, 1e44)])
def test_no_point_is_too_far_or_too_near(a, b):
    shape = Ellipse(None, a, b)
    places = [0.0, 5e-324, 1e-310, 1e-200, 1e-10, 0.5, 1.0, 1e10, 1e160, 1e307]
    for x, y in itertools.product(places, places):
        hit = shape.point_query((x, -y))
        numbers = (*hit.point, hit.distance, *hit.gradient)
        assert all(isfinite(number) for number in numbers), (x, y, hit)
        assert hit.gradient.length == pytest.approx(1)
        assert hypot(hit.point.x / a, hit.point.y / b) == pytest.approx(1)
        if max(x, y) > 100 * max(a, b):
            assert hit.distance == pytest.approx(hypot(x, y), rel=0.02)


def test_a_round_one_answers_as_a_circle_does():
    rng = np.random.default_rng(2)
    body = pymunk.Body(1, 1)
    body.position = 3, 4
    body.angle = 1
    egg = Ellipse(body, 5, 5, (1, 2), 0.5)
    circle = pymunk.Circle(body, 5, (1, 2))
    circle.cache_bb()
    assert egg.bb == pytest.approx(circle.bb)

    def numbers(hit):
        return [*hit[1], hit[2], *hit[3]] if hit else None

    hits = 0
    for _ in range(2000):
        start, end = rng.uniform(-20, 20, (2, 2)).tolist()
        assert egg.point_query(start)[2] == pytest.approx(
            circle.point_query(start).distance
        )
        assert egg.point_query(start)[1] == pytest.approx(
            circle.point_query(start).point
        )
        for radius in (0, 0.5, 4):
            one = egg.segment_query(start, end, radius)
            two = circle.segment_query(start, end, radius)
            assert (one is None) == (two is None)
            if one:
                hits += 1
                assert one.alpha == pytest.approx(two.alpha, abs=1e-9)
                assert one.point == pytest.approx(two.point, abs=1e-9)
                assert one.normal == pytest.approx(two.normal, abs=1e-9)
    assert hits > 1000


@pytest.mark.parametrize("mask", MASKS)
def test_points_in_a_space(mask):
    """Each ellipse that is near enough is found, and no other, with the shape's own answer; other shapes' hits are pymunk's, in its order."""
    rng = np.random.default_rng(6)
    space = crowd(rng)
    shape_filter = ShapeFilter(mask=mask)
    found = 0
    limits = [0.0, 5.0, -1.0, inf, -2.5, 0.3]
    for point, limit in zip(
        rng.uniform(-50, 50, (COUNT, 2)), itertools.cycle(limits), strict=False
    ):
        hits = space.point_query(point, limit, shape_filter)
        plain = pymunk.Space.point_query(space, tuple(point), limit, shape_filter)
        assert not_ellipses(hits) == not_ellipses(plain)
        expected = {
            hit.shape: hit
            for hit in (e.point_query(point) for e in ellipses_in(space))
            if hit.distance < limit and seen(hit.shape, mask)
        }
        ours = {hit.shape: hit for hit in hits if hit.shape in expected}
        assert ours == expected
        assert len(hits) == len(expected) + len(not_ellipses(plain))
        found += len(expected)

        nearest = space.point_query_nearest(point, limit, shape_filter)
        if hits:
            assert nearest in hits
            assert nearest.distance == min(hit.distance for hit in hits)
        else:
            assert nearest is None
    assert found > COUNT


@SPACES
def test_deep_points_of_a_hull_are_not_deep_in_the_ellipse(Space):
    space = Space()
    shape = Ellipse(space.static_body, 20, 10)
    space.add(shape)
    assert hull_of(shape).point_query((0, 9)).distance < -1.1
    assert not space.point_query((0, 9), -1.05, ALL)
    assert space.point_query((0, 9), -0.95, ALL)
    assert space.point_query_nearest((0, 9), -1.05, ALL) is None
    assert space.point_query_nearest((0, 9), -0.95, ALL).distance == -1


def test_the_maximal_distance_itself_is_too_far():
    space = Space()
    egg = Ellipse(space.static_body, 4, 2)
    space.add(egg)
    assert egg.point_query((6, 0)).distance == 2
    for limit, found in ((2, 0), (2.001, 1)):
        assert len(space.point_query((6, 0), limit, ALL)) == found
        assert bool(space.point_query_nearest((6, 0), limit, ALL)) == found


@SPACES
def test_the_nearest_is_not_the_one_with_the_nearest_hull(Space):
    space = Space()
    egg = Ellipse(space.static_body, 20, 10)
    space.add(egg)
    point = max(egg.get_vertices(), key=lambda v: v.y) + Vec2d(0, egg.radius + 3)
    hull = hull_of(egg).point_query(point).distance
    distance = egg.point_query(point).distance
    assert hull < distance
    between = (hull + distance) / 2
    circle = pymunk.Circle(space.static_body, 1, point + Vec2d(0, between + 1))
    space.add(circle)
    nearest = space.point_query_nearest(point, 9, ALL)
    assert nearest.shape is circle
    assert nearest == circle.point_query(point)
    assert space.point_query_nearest(point, hull, ALL) is None
