"""Contacts and nearest points of arrays: as exact as the shapes', in every shape that numpy broadcasts, and in both backends."""

from math import inf, nan

import numpy as np
import pymunk
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from pymunk_ellipse import Ellipse, ellipse_contacts, nearest_points

pytestmark = pytest.mark.usefixtures("backend")


def random_ellipses(rng, shape, aspect=5.0, spread=4.0):
    rows = np.empty((*shape, 5))
    rows[..., 0] = np.exp(rng.uniform(-1, 1, shape))
    rows[..., 1] = rows[..., 0] * np.exp(rng.uniform(-1, 1, shape) * np.log(aspect))
    rows[..., 2:4] = rng.uniform(-spread, spread, (*shape, 2))
    rows[..., 4] = rng.uniform(-7, 7, shape)
    return rows


def supports(rows, directions):
    """Support functions of ellipses about their centres, in their rows of directions."""
    a, b, _x, _y, angle = (column[:, None] for column in rows.T)
    return np.hypot(a * np.cos(directions - angle), b * np.sin(directions - angle))


def separation(first, second, directions):
    """f of each pair in its row of directions: its largest value is the distance."""
    difference = second[:, 2:4] - first[:, 2:4]
    along = difference[:, :1] * np.cos(directions) + difference[:, 1:] * np.sin(
        directions
    )
    return along - supports(first, directions) - supports(second, directions)


def evenly_curved(rows, count):
    """Directions of the normals where points are even on an ellipse: many where it is sharp."""
    t = np.linspace(0, 2 * np.pi, count, endpoint=False)
    a, b, _x, _y, angle = (column[:, None] for column in rows.T)
    return np.arctan2(a * np.sin(t), b * np.cos(t)) + angle


def brute_force(first, second, count=400):
    """Distances, by looking in many directions and refining around the best."""
    directions = np.concatenate(
        (evenly_curved(first, count), evenly_curved(second, count)), axis=1
    )
    directions = np.sort(directions % (2 * np.pi), axis=1)
    best = np.argmax(separation(first, second, directions), axis=1)
    rows = np.arange(len(first))
    middle = directions[rows, best]
    before = directions[rows, best - 1] - 2 * np.pi * (best == 0)
    after = directions[rows, (best + 1) % directions.shape[1]]
    after = after + 2 * np.pi * (best == directions.shape[1] - 1)
    low, high = before, after
    for _ in range(90):
        left = low + (high - low) / 3
        right = high - (high - low) / 3
        worse = (
            separation(first, second, left[:, None])
            < separation(first, second, right[:, None])
        )[:, 0]
        low, high = np.where(worse, left, low), np.where(worse, high, right)
    found = separation(first, second, ((low + high) / 2)[:, None])[:, 0]
    return np.maximum(found, separation(first, second, middle[:, None])[:, 0])


def on_surface(rows, points):
    """How far points are from the ellipses' surfaces, to first order, by the shorter semi-axis."""
    a, b, x, y, angle = rows.T
    dx, dy = points[:, 0] - x, points[:, 1] - y
    u = np.cos(angle) * dx + np.sin(angle) * dy
    v = np.cos(angle) * dy - np.sin(angle) * dx
    size = np.hypot(u / a, v / b)
    slope = np.hypot(u / a**2, v / b**2)
    return np.abs(size**2 - 1) / (2 * slope) / np.minimum(a, b)


@pytest.mark.parametrize(
    ("aspect", "count"), [(1.5, 500), (5.0, 1000), (50.0, 500), (1000.0, 500)]
)
def test_against_brute_force(aspect, count):
    rng = np.random.default_rng(int(aspect * 10))
    first = random_ellipses(rng, (count,), aspect)
    second = random_ellipses(rng, (count,), aspect)
    found = ellipse_contacts(first, second)
    smallest = np.minimum(first[:, :2].min(axis=1), second[:, :2].min(axis=1))
    expected = brute_force(first, second)
    assert np.all(np.abs(found.distance - expected) <= 1e-6 * smallest)
    assert_allclose(np.hypot(*found.normal.T), 1, rtol=1e-12)
    for rows, points in ((first, found.first_point), (second, found.second_point)):
        assert np.all(on_surface(rows, points) < 1e-6)
    assert_allclose(
        found.second_point - found.first_point,
        found.distance[:, None] * found.normal,
        atol=1e-12 * np.max(np.abs(first[:, :4])) * 10,
    )


def test_very_different_sizes():
    rng = np.random.default_rng(3)
    first = random_ellipses(rng, (300,), 3.0, 0.5)
    second = random_ellipses(rng, (300,), 3.0, 0.5)
    scale = 10.0 ** rng.uniform(2, 6, 300)
    first[:, :4] *= scale[:, None]
    # The small one about the surface of the large one.
    t = rng.uniform(0, 7, 300)
    contact = nearest_points(
        first, first[:, 2:4] + 9 * scale[:, None] * np.stack((np.cos(t), np.sin(t)), -1)
    )
    second[:, 2:4] += contact.point
    found = ellipse_contacts(first, second)
    smallest = second[:, :2].min(axis=1)
    expected = brute_force(first, second)
    assert np.all(np.abs(found.distance - expected) <= 1e-6 * smallest)
    assert np.all(on_surface(second, found.second_point) < 1e-6)


def test_the_same_as_the_shapes():
    rng = np.random.default_rng(5)
    first, second = random_ellipses(rng, (2, 200))
    found = ellipse_contacts(first, second)
    body = pymunk.Body()
    for i in range(200):
        one, two = (
            Ellipse(body, a, b, (x, y), angle)
            for a, b, x, y, angle in (first[i].tolist(), second[i].tolist())
        )
        expected = one.distance(two)
        assert found.distance[i] == pytest.approx(expected.distance, abs=1e-12)
        assert tuple(found.normal[i]) == pytest.approx(tuple(expected.normal))
        assert tuple(found.second_point[i]) == pytest.approx(tuple(expected.point_b))


def test_nearest_points_are_those_of_the_shapes():
    rng = np.random.default_rng(6)
    ellipses = random_ellipses(rng, (200,))
    points = rng.uniform(-8, 8, (200, 2))
    found = nearest_points(ellipses, points)
    for i in range(200):
        a, b, x, y, angle = ellipses[i].tolist()
        hit = Ellipse(None, a, b, (x, y), angle).point_query(points[i].tolist())
        assert found.distance[i] == pytest.approx(hit.distance, abs=1e-12)
        assert tuple(found.point[i]) == pytest.approx(tuple(hit.point), abs=1e-12)
        assert tuple(found.normal[i]) == pytest.approx(tuple(hit.gradient), abs=1e-12)


@pytest.mark.parametrize(
    ("first", "second", "pairs"),
    [
        ((4,), (4,), (4,)),
        ((), (4,), (4,)),
        ((4,), (), (4,)),
        ((1,), (4,), (4,)),
        ((1,), (1,), (1,)),
        ((3, 1), (4,), (3, 4)),
        ((2, 3, 1), (3, 4), (2, 3, 4)),
        ((0,), (0,), (0,)),
        ((), (0,), (0,)),
        ((0, 1), (4,), (0, 4)),
        ((1, 1), (1,), (1, 1)),
    ],
)
def test_broadcasting(first, second, pairs):
    rng = np.random.default_rng(7)
    first = random_ellipses(rng, first)
    second = random_ellipses(rng, second)
    found = ellipse_contacts(first, second)
    assert found.distance.shape == pairs
    assert found.normal.shape == (*pairs, 2)
    assert found.first_point.shape == found.second_point.shape == (*pairs, 2)
    one = np.broadcast_to(first, (*pairs, 5))
    two = np.broadcast_to(second, (*pairs, 5))
    for place in np.ndindex(pairs):
        alone = ellipse_contacts(one[place], two[place])
        assert alone.distance == found.distance[place]
        assert alone.normal == tuple(found.normal[place])


def test_one_pair_gives_plain_numbers():
    found = ellipse_contacts([2, 1, 0, 0, 0], (1, 1, 4, 0, 0))
    assert found == (1.0, (1.0, 0.0), (2.0, 0.0), (3.0, 0.0))
    assert type(found.distance) is type(found.normal[0]) is float
    near = nearest_points(np.array([2, 1, 0, 0, 0]), (0, 3))
    assert near == (2.0, (0.0, 1.0), (0.0, 1.0))
    assert type(near.distance) is float


def test_arrays_of_any_kind_and_layout():
    rng = np.random.default_rng(8)
    first, second = random_ellipses(rng, (2, 30)).astype(np.float32)
    expected = ellipse_contacts(first.astype(float), second.astype(float))
    wide = np.zeros((60, 10), np.float32)
    wide[::2, ::2] = first
    for one, two in (
        (first, second),
        (np.asfortranarray(first), second),
        (wide[::2, ::2], second[:, ::-1][:, ::-1]),
        (first.tolist(), [tuple(row) for row in second.tolist()]),
        (first.astype(object), second),
    ):
        before = np.array(one, copy=True)
        assert_array_equal(ellipse_contacts(one, two).distance, expected.distance)
        assert_array_equal(np.asarray(one), before)
    whole = np.array([[3, 2, 0, 0, 0]])
    assert ellipse_contacts(whole, (3, 2, 7, 0, 0)).distance == [1]


@pytest.mark.parametrize(
    ("first", "error", "problem"),
    [
        (None, TypeError, "first must be an array of numbers, got None"),
        ("ellipse", TypeError, "first must be an array of numbers"),
        ([1j, 1, 0, 0, 0], TypeError, "first must be an array of numbers"),
        (3.0, ValueError, r"first must have the shape \(\.\.\., 5\), got \(\)"),
        ([2, 1, 0, 0], ValueError, r"first must have the shape \(\.\.\., 5\)"),
        (np.ones((5, 4)), ValueError, r"first must have the shape .* \(5, 4\)"),
        ([2, 1, nan, 0, 0], ValueError, "first must be finite, got nan"),
        ([2, 1, 0, 0, inf], ValueError, "first must be finite, got inf"),
        ([2, 0, 0, 0, 0], ValueError, "first: b must be positive, got 0.0"),
        (
            [[2, 1, 0, 0, 0], [1, -2, 0, 0, 0]],
            ValueError,
            r"first\[1\]: b must be positive, got -2.0",
        ),
        ([1e60, 1e60, 0, 0, 0], ValueError, "first: a must lie between"),
        ([1e7, 1, 0, 0, 0], ValueError, "first: a and b must not differ"),
        (np.ones((3, 5)), ValueError, r"first and second .* \(3, 5\) and \(2, 5\)"),
    ],
)
def test_what_is_refused(first, error, problem):
    second = np.ones((2, 5))
    with pytest.raises(error, match=f"^{problem}"):
        ellipse_contacts(first, second)


def test_what_is_refused_of_points():
    with pytest.raises(ValueError, match=r"^points must have the shape \(\.\.\., 2\)"):
        nearest_points((2, 1, 0, 0, 0), (1, 2, 3))
    with pytest.raises(ValueError, match=r"^ellipses: a must be positive"):
        nearest_points((-2, 1, 0, 0, 0), (1, 2))


def test_sizes_that_differ_among_the_pairs_only():
    """The extremes of all together are not those of one ellipse."""
    sizes = np.array([[1e-40, 1e-40, 0, 0, 0], [1e40, 1e40, 0, 0, 0]])
    found = ellipse_contacts(sizes, sizes + np.array([0, 0, 1, 0, 0]))
    assert np.all(np.isfinite(found.distance))
