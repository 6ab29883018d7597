"""Segment queries: where a moving circle touches first, against brute force and closed forms; of a shape and of a space."""

import itertools
from math import cos, inf, isfinite, pi, sin

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


def first_crossing(rows, starts, ends, count=400):
    """Where segments first enter ellipses, as a part of the way, inf if nowhere: by small steps, then bisection."""
    a, b = rows[:, :1], rows[:, 1:2]
    u0, v0 = (part[:, None] for part in in_frame(rows, starts))
    u1, v1 = (part[:, None] for part in in_frame(rows, ends))

    def inside(alpha):
        u, v = u0 + alpha * (u1 - u0), v0 + alpha * (v1 - v0)
        return (u / a) ** 2 + (v / b) ** 2 <= 1

    alphas = np.linspace(0, 1, count + 1)[None, :]
    entered = inside(alphas)
    hit = entered.any(axis=1)
    index = np.argmax(entered, axis=1)
    low, high = (index[:, None] - 1) / count, index[:, None] / count
    for _ in range(60):
        middle = (low + high) / 2
        inner = inside(middle)
        low, high = np.where(inner, low, middle), np.where(inner, middle, high)
    return np.where(hit, high[:, 0], inf)


def first_touch(rows, starts, ends, radii, count=720):
    """Where circles moving along segments first touch ellipses: the least way to a circle around any of many points of the surface, refined."""
    a, b = rows[:, :1], rows[:, 1:2]
    u0, v0 = (part[:, None] for part in in_frame(rows, starts))
    u1, v1 = (part[:, None] for part in in_frame(rows, ends))
    du, dv = u1 - u0, v1 - v0
    length = du * du + dv * dv
    r = radii[:, None]

    def way(t):
        x, y = u0 - a * np.cos(t), v0 - b * np.sin(t)
        half = x * du + y * dv
        square = half * half - length * (x * x + y * y - r * r)
        root = np.sqrt(np.maximum(square, 0))
        alpha = (-half - root) / length
        return np.where((square >= 0) & (alpha >= 0) & (alpha <= 1), alpha, inf)

    step = 2 * pi / count
    t = np.arange(count)[None, :] * step
    best = np.full((len(rows), 1), inf)
    center = np.zeros((len(rows), 1))
    for _ in range(9):
        alphas = way(t)
        least = np.argmin(alphas, axis=1)[:, None]
        found = np.take_along_axis(alphas, least, axis=1)
        center = np.where(
            found < best, np.take_along_axis(t + 0 * center, least, axis=1), center
        )
        best = np.minimum(best, found)
        t = center + np.linspace(-step, step, 33)[None, :]
        step /= 12
    return best[:, 0]


def random_segments(rng, rows):
    """Ways that start outside of each ellipse and lead past or into it."""
    reach = rows[:, :2].max(axis=1)[:, None]
    direction = rng.uniform(0, 2 * pi, len(rows))
    outwards = np.column_stack([np.cos(direction), np.sin(direction)])
    starts = rows[:, 2:4] + outwards * reach * rng.uniform(1.5, 4, (len(rows), 1))
    middle = random_points(rng, rows)
    ends = starts + (middle - starts) * rng.uniform(0.5, 2.5, (len(rows), 1))
    return starts, ends


def compare_with_brute_force(rows, shapes, starts, ends, radii, expected):
    """Check the hits of segments, and return how many there were."""
    hits = 0
    doubtful = []
    for i, shape in enumerate(shapes):
        start, end, radius = Vec2d(*starts[i]), Vec2d(*ends[i]), radii[i]
        hit = shape.segment_query(start, end, radius)
        if (hit is None) != (expected[i] == inf):
            doubtful.append(i)
        elif hit is not None:
            hits += 1
            size = max(shape.a, shape.b)
            at = start.interpolate_to(end, hit.alpha)
            assert hit.shape is shape
            # Newton's answer is on the mark, brute force only as near as the segment is steep.
            nearest = shape.point_query(at)
            assert abs(nearest.distance - radius) < 1e-9 * size
            assert abs(hit.point - (at - radius * hit.normal)) < 1e-9 * size
            assert abs(hit.point - nearest.point) < 1e-9 * size
            steepness = -hit.normal.dot((end - start).normalized())
            assert steepness > -1e-6
            if steepness > 0.01:
                way = (end - start).length
                assert abs(hit.alpha - expected[i]) * way < 1e-9 * size
    # The two disagree only about segments that graze.
    assert len(doubtful) < 0.002 * len(shapes)
    for i in doubtful:
        alphas = np.linspace(0, 1, 2000)[:, None]
        along = starts[i] + alphas * (ends[i] - starts[i])
        nearest = separations(np.repeat(rows[i : i + 1], 2000, axis=0), along).min()
        assert abs(nearest - radii[i]) < 1e-3 * rows[i, :2].max()
    return hits


def test_segments_enter_where_brute_force_finds_it():
    rng = np.random.default_rng(3)
    rows, shapes = random_ellipses(rng, COUNT)
    starts, ends = random_segments(rng, rows)
    expected = first_crossing(rows, starts, ends)
    radii = np.zeros(COUNT)
    hits = compare_with_brute_force(rows, shapes, starts, ends, radii, expected)
    assert COUNT / 3 < hits < 0.9 * COUNT


def test_wide_segments_touch_where_brute_force_finds_it():
    rng = np.random.default_rng(4)
    rows, shapes = random_ellipses(rng, COUNT)
    starts, ends = random_segments(rng, rows)
    radii = rows[:, :2].max(axis=1) * 10 ** rng.uniform(-1, 0.5, COUNT)
    outside = separations(rows, starts) > radii
    expected = first_touch(rows, starts, ends, radii)
    chosen = np.nonzero(outside)[0]
    hits = compare_with_brute_force(
        rows[chosen],
        [shapes[i] for i in chosen],
        starts[chosen],
        ends[chosen],
        radii[chosen],
        expected[chosen],
    )
    assert len(chosen) > COUNT / 2
    assert hits > COUNT / 4
    # The others touch at the start.
    for i in np.nonzero(~outside)[0]:
        assert shapes[i].segment_query(starts[i], ends[i], radii[i]).alpha == 0


@pytest.mark.parametrize("radius", [0.0, 0.25])
def test_touching_at_the_start(radius):
    shape = Ellipse(None, 4, 2)
    inside = shape.segment_query((3.5, 0), (9, 9), radius)
    assert inside.alpha == 0
    assert inside.point == (9, 9)
    assert inside.normal == (-1, 0)
    if radius:
        near = shape.segment_query((4.2, 0), (9, 9), radius)
        assert (near.alpha, near.point, near.normal) == (0, (9, 9), (1, 0))
    assert shape.segment_query((4.3, 0), (9, 9), radius) is None


@pytest.mark.parametrize("radius", [0.0, 1.0])
def test_the_end_counts(radius):
    shape = Ellipse(None, 4, 2)
    hit = shape.segment_query((0, 10), (0, 2 + radius), radius)
    assert hit.alpha == 1
    assert hit.point == (0, 2)
    assert shape.segment_query((0, 10), (0, 2.001 + radius), radius) is None
    assert shape.segment_query((0, 10), (0, 12), radius) is None


@pytest.mark.parametrize("radius", [0.0, 1.0])
def test_a_segment_without_length(radius):
    shape = Ellipse(None, 4, 2)
    assert shape.segment_query((0, 5), (0, 5), radius) is None
    assert shape.segment_query((0, 1), (0, 1), radius).alpha == 0


def test_a_negative_radius_is_a_depth():
    hit = Ellipse(None, 4, 2).segment_query((0, 10), (0, 0), -0.5)
    assert hit.alpha == pytest.approx(0.85)
    assert hit.point == pytest.approx((0, 2))
    assert Ellipse(None, 4, 2).segment_query((0, 10), (0, 0), -3) is None


@pytest.mark.parametrize("radius", [0.0, 0.25])
def test_segments_that_graze(radius):
    """Within roundoff of touching, on either side, nothing is worse than a miss or a touch at the right place."""
    shape = Ellipse(None, 4, 2)
    for gap in (1e-3, 1e-6, 1e-9, 1e-12, 1e-15):
        y = 2 + radius
        assert shape.segment_query((-9, y + gap), (9, y + gap), radius) is None or (
            gap < 1e-14
        )
        hit = shape.segment_query((-9, y - gap), (9, y - gap), radius)
        if gap > 1e-14:
            assert abs(hit.point.y - 2) < 2 * gap
            assert abs(hit.normal.x) < 1e-1


@pytest.mark.parametrize("size", [1e-40, 1e-6, 1.0, 1e6, 1e40])
@pytest.mark.parametrize("aspect", [1.0, 30.0, 1e6])
@pytest.mark.parametrize("radius", [0.0, 0.5, 2.0])
def test_segments_at_any_scale(size, aspect, radius):
    a, b = size, size / aspect
    shape = Ellipse(None, a, b)
    radius *= b
    for t in np.linspace(0.1, 6.2, 15):
        n = Vec2d(b * cos(t) / size, a * sin(t) / size).normalized()
        surface = Vec2d(a * cos(t), b * sin(t))
        for way in (b, a, 1e6 * a):
            for turn in (0.0, 0.7, -1.2):
                start = surface + radius * n + way * n.rotated(turn)
                for past in (0.0, 0.5, 1e6 * a / way):
                    end = start - (1 + past) * way * n.rotated(turn)
                    hit = shape.segment_query(start, end, radius)
                    if past == 0:
                        continue
                    tolerance = 1e-9 * (a + way)
                    assert abs(hit.point - surface) < max(tolerance, 1e-7 * b)
                    assert hit.alpha * (1 + past) == pytest.approx(
                        1, abs=tolerance / way
                    )


def test_segments_far_beyond_any_scene():
    shape = Ellipse(None, 3, 1)
    for x, y in itertools.product([0.0, 1e-300, 2.0, 1e100, 1e307], repeat=2):
        for radius in (0, 1, 1e200):
            hit = shape.segment_query((-x, y), (y, -x), radius)
            if hit is not None:
                assert all(isfinite(number) for number in (*hit.normal, hit.alpha))


def assert_same_hit(found, expected):
    """To the last digit, but for the normal at a start that is touched, which Chipmunk takes from the point."""
    if expected.alpha > 0:
        assert found == expected
    else:
        assert found._replace(normal=None) == expected._replace(normal=None)
        assert found.normal == pytest.approx(tuple(expected.normal), abs=1e-9)


@pytest.mark.parametrize("mask", MASKS)
def test_segments_in_a_space(mask):
    """As for points. Each ellipse in the way of the circle is found, however far the middle of it passes from the hull."""
    rng = np.random.default_rng(7)
    space = crowd(rng)
    shape_filter = ShapeFilter(mask=mask)
    found = missed_by_middle = 0
    for i, (start, end) in enumerate(rng.uniform(-50, 50, (COUNT // 4, 2, 2))):
        if i % 3 == 0:
            end = start + (end - start) / 10
        for radius in (0.0, 2.0, 0.01, 9.0):
            hits = space.segment_query(start, end, radius, shape_filter)
            plain = pymunk.Space.segment_query(
                space, tuple(start), tuple(end), radius, shape_filter
            )
            assert not_ellipses(hits) == not_ellipses(plain)
            expected = {
                hit.shape: hit
                for hit in (
                    e.segment_query(start, end, radius) for e in ellipses_in(space)
                )
                if hit and seen(hit.shape, mask)
            }
            ours = {hit.shape: hit for hit in hits if hit.shape in expected}
            assert ours.keys() == expected.keys()
            for shape, hit in expected.items():
                assert_same_hit(ours[shape], hit)
            assert len(hits) == len(expected) + len(not_ellipses(plain))
            # A plain space finds those whose boxes the middle of the circle crosses.
            missed = set(expected) - {hit.shape for hit in plain}
            assert not missed or radius > 0
            found += len(expected)
            missed_by_middle += len(missed)

            first = space.segment_query_first(start, end, radius, shape_filter)
            before = [hit for hit in hits if hit.alpha < 1]
            if before:
                assert first in before
                assert first.alpha == min(hit.alpha for hit in before)
            else:
                assert first is None
    assert found > COUNT
    assert missed_by_middle > 100


@SPACES
def test_a_segment_along_a_face_of_the_hull(Space):
    """Chipmunk takes no notice of a face that the segment is parallel to."""
    space = Space()
    shape = Ellipse(space.static_body, 20, 20)
    space.add(shape)
    vertices = shape.get_vertices()
    along = vertices[1] - vertices[0]
    normal = -along.perpendicular_normal()
    start = (20 + 1e-7) * normal - 0.3 * along
    end = (20 - 3e-7) * normal + 0.3 * along
    assert shape.segment_query(start, end) is not None
    assert hull_of(shape).segment_query(start, end) is None
    assert len(space.segment_query(start, end, 0, ALL)) == 1
    assert space.segment_query_first(start, end, 0, ALL).shape is shape


def test_segments_and_ellipses_smaller_than_chipmunks_tolerances():
    space = Space()
    shape = Ellipse(space.static_body, 2e-6, 1e-6)
    space.add(shape)
    [hit] = space.segment_query((0, 1e-5), (0, -1e-5), 0, ALL)
    assert hit.alpha == pytest.approx(0.45)
    assert space.segment_query_first((0, 1e-5), (0, -1e-5), 0, ALL) == hit


@SPACES
def test_what_is_behind_a_hull_is_first(Space):
    """Past an ellipse, but through its hull."""
    space = Space()
    egg = Ellipse(space.static_body, 20, 10)
    space.add(egg)
    x = min(v.x for v in egg.get_vertices()) - egg.radius + 0.01
    assert x < -20
    way = (x, 30), (x, -30), 0, ALL
    assert hull_of(egg).segment_query(*way[:3]) is not None
    assert space.segment_query_first(*way) is None
    # What is touched only at the end does not count.
    corners = [(x - 10, -40), (x + 10, -20), (x + 10, -60)]
    floor = pymunk.Poly(space.static_body, corners)
    space.add(floor)
    assert floor.segment_query(*way[:3]).alpha == 1
    assert [hit.shape for hit in space.segment_query(*way)] == [floor]
    assert space.segment_query_first(*way) is None
    circle = pymunk.Circle(space.static_body, 2, (x, -20))
    space.add(circle)
    hit = space.segment_query_first(*way)
    assert hit == circle.segment_query(*way[:3])
