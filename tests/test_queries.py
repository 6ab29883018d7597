"""Queries of the shape and of the space: distances, points, normals and ways, against brute force and closed forms."""

import itertools
import json
from math import cos, hypot, inf, isfinite, nan, pi, sin
from pathlib import Path

import numpy as np
import pymunk
import pymunk.batch
import pytest
from brute_force import ellipse_separations
from pairs import Placed, from_reference
from pymunk import BB, ShapeFilter, Transform, Vec2d
from scenes import add_body, add_box, add_ellipse

from pymunk_ellipse import Ellipse, Space

ALL = ShapeFilter()
REFERENCES = json.loads((Path(__file__).parent / "contacts.json").read_text())["cases"]
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


# Points


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


# Segments


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


# Bounding boxes


def test_bounding_boxes_touch_the_ellipse():
    rng = np.random.default_rng(5)
    rows, shapes = random_ellipses(rng, 500)
    t = np.linspace(0, 2 * pi, 20001)
    for (a, b, x, y, angle), shape in zip(rows, shapes, strict=True):
        u, v = a * np.cos(t), b * np.sin(t)
        px = x + cos(angle) * u - sin(angle) * v
        py = y + sin(angle) * u + cos(angle) * v
        expected = [px.min(), py.min(), px.max(), py.max()]
        assert list(shape.bb) == pytest.approx(expected, abs=1e-7 * max(a, b))


def test_bounding_boxes_are_where_the_body_is():
    body = pymunk.Body(1, 1)
    shape = Ellipse(body, 4, 2, (1, 0))
    body.position = 10, 20
    body.angle = pi / 2
    expected = pytest.approx((8, 17, 12, 25))
    assert shape.bb == expected
    assert isinstance(shape.bb, BB)
    assert shape.cache_bb() == expected


def test_update_returns_the_bounding_box():
    shape = Ellipse(None, 4, 2)
    assert shape.bb == (-4, -2, 4, 2)
    assert shape.update(Transform.translation(10, 20)) == (6, 18, 14, 22)
    assert shape.bb == (6, 18, 14, 22)
    assert shape.point_query((10, 23)).distance == 1
    assert shape.segment_query((10, 30), (10, 20)).alpha == 0.8


def test_the_hull_is_where_update_puts_it():
    """Chipmunk's own copy of the hull must follow, or the broad phase would look elsewhere."""
    space = pymunk.Space()
    space.add(pymunk.Circle(space.static_body, 1, (50, 50)))
    shape = Ellipse(None, 4, 2)
    assert not space.shape_query(shape)
    shape.update(Transform.translation(50, 50))
    assert space.shape_query(shape)
    body = pymunk.Body(1, 1)
    shape = Ellipse(body, 4, 2)
    body.position = 50, 50
    shape.cache_bb()
    assert pymunk.Poly.point_query(shape, (50, 50)).distance < -1
    assert pymunk.Poly.point_query(shape, (0, 0)).distance > 60


# The space


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


def hull_of(ellipse):
    """What pymunk's broad phase sees, as a shape of its own."""
    hull = pymunk.Poly(ellipse.body, ellipse.get_vertices(), radius=ellipse.radius)
    hull.cache_bb()
    return hull


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
    # Where the hull reaches farthest out: beside its highest corner.
    corner = max(egg.get_vertices(), key=lambda v: (v.y, v.x)) - Vec2d(0, egg.radius)
    point = corner + (2 * egg.radius + 3) * Vec2d(0.4, 1).normalized()
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


def test_hits_keep_the_order_of_their_hulls():
    rng = np.random.default_rng(8)
    space = crowd(rng)
    plain = pymunk.Space.point_query(space, (0, 0), inf, ALL)
    ours = space.point_query((0, 0), inf, ALL)
    assert [hit.shape for hit in ours] == [hit.shape for hit in plain]
    plain = pymunk.Space.segment_query(space, (-50, -50), (50, 50), 0, ALL)
    ours = space.segment_query((-50, -50), (50, 50), 0, ALL)
    order = [hit.shape for hit in plain]
    places = [order.index(hit.shape) for hit in ours]
    assert len(places) > 5
    assert places == sorted(places)


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


def test_boxes_in_a_space():
    rng = np.random.default_rng(9)
    space = crowd(rng)
    fewer = 0
    for corner, size in zip(
        rng.uniform(-50, 50, (COUNT, 2)), rng.uniform(0, 9, (COUNT, 2)), strict=True
    ):
        box = BB(*corner, *(corner + size))
        for shape_filter in (ALL, ShapeFilter(mask=0b101)):
            found = space.bb_query(box, shape_filter)
            assert found == pymunk.Space.bb_query(space, box, shape_filter)
            expected = {
                shape
                for shape in space.shapes
                if shape.bb.intersects(box) and seen(shape, shape_filter.mask)
            }
            assert set(found) == expected
            fewer += sum(
                hull_of(shape).bb.intersects(box)
                for shape in ellipses_in(space)
                if shape not in expected and seen(shape, shape_filter.mask)
            )
    assert fewer > 100
    everywhere = space.bb_query(BB(-inf, -inf, inf, inf), ALL)
    assert len(everywhere) == len(space.shapes)


# Shapes


def row_of(ellipse):
    angle = ellipse.body.angle + ellipse.angle
    center = ellipse.body.local_to_world(ellipse.offset)
    return ellipse.a, ellipse.b, angle, center.x, center.y


def test_ellipses_that_overlap_are_found():
    rng = np.random.default_rng(10)
    space = crowd(rng, 40)
    touching = hulls_only = 0
    for shape in ellipses_in(space):
        plain = pymunk.Space.shape_query(space, shape)
        hits = {hit.shape: hit for hit in space.shape_query(shape)}
        others = [other for other in ellipses_in(space) if other is not shape]
        a, b, angle, x, y = row_of(shape)
        rows = np.array(
            [
                (a, b, angle, p, q, turn, u - x, v - y)
                for p, q, turn, u, v in map(row_of, others)
            ]
        )
        for other, separation in zip(others, ellipse_separations(rows), strict=True):
            assert (other in hits) == (separation <= 0)
            if other in hits:
                touching += 1
                contact = hits[other].contact_point_set
                [point] = contact.points
                assert point.distance == pytest.approx(separation, abs=1e-9)
                assert shape.point_query(point.point_a).distance == pytest.approx(
                    0, abs=1e-9
                )
                assert other.point_query(point.point_b).distance == pytest.approx(
                    0, abs=1e-9
                )
                assert contact.normal.dot(point.point_a - point.point_b) > 0
            else:
                hulls_only += any(hit.shape is other for hit in plain)
    assert touching > 20
    assert hulls_only > 2


def kinds(body):
    return [
        Ellipse(body, 5, 2, (1, 1), 0.3),
        pymunk.Circle(body, 4, (1, 1)),
        pymunk.Segment(body, (-4, 0), (5, 2), 0.5),
        pymunk.Poly(body, [(-3, -2), (4, -1), (3, 3)], radius=0.5),
    ]


@pytest.mark.parametrize("kind", range(4))
@pytest.mark.parametrize("place", ["in the space", "on its own body", "updated"])
def test_any_shape_finds_ellipses(kind, place):
    """Its contacts lead from it to what it finds: moved back by the depth it only just touches."""
    rng = np.random.default_rng(11)
    found = 0
    for _ in range(150):
        space = Space()
        egg = add_ellipse(space, 6, 3, tuple(rng.uniform(-9, 9, 2)), rng.uniform(0, pi))
        egg.filter = ShapeFilter(group=1)
        circle = pymunk.Circle(space.static_body, 2, (3, 3))
        space.add(circle)
        body = pymunk.Body(1, 1)
        body.position = tuple(rng.uniform(-5, 5, 2))
        body.angle = rng.uniform(-pi, pi)
        if place == "updated":
            shape = kinds(None)[kind]
            turn = Transform.rotation(body.angle)
            shape.update(Transform.translation(*body.position) @ turn)
            twin = kinds(body)[kind]
        else:
            shape = twin = kinds(body)[kind]
        if place == "in the space":
            space.add(body, shape)
        hits = {hit.shape: hit.contact_point_set for hit in space.shape_query(shape)}
        assert shape not in hits

        exact = egg.shapes_collide(twin)
        assert (egg in hits) == bool(exact.points)
        if egg in hits:
            found += 1
            [point] = hits[egg].points
            assert point.distance == pytest.approx(exact.points[0].distance)
            assert abs(hits[egg].normal + exact.normal) < 1e-9
            assert abs(point.point_a - exact.points[0].point_b) < 1e-9
            assert abs(point.point_b - exact.points[0].point_a) < 1e-9
            depth = -point.distance
            egg.body.position += hits[egg].normal * (depth - 1e-6)
            assert egg.shapes_collide(twin).points
            egg.body.position += hits[egg].normal * 2e-6
            assert not egg.shapes_collide(twin).points
        if kind:
            plain = pymunk.Space.shape_query(space, shape)
            [theirs] = [h for h in plain if h.shape is circle] or [None]
            ours = hits.get(circle)
            assert repr(ours) == repr(theirs and theirs.contact_point_set)
    assert found > 50


@pytest.mark.parametrize("case", [c for c in REFERENCES if c["depth"] >= 0])
def test_contacts_found_in_a_space_are_right_to_nine_digits(case):
    space = Space()
    (a, b, x, y, angle), other = from_reference(case)
    space.add(Ellipse(space.static_body, a, b, (x, y), angle))
    if isinstance(other, Placed):
        shape = Ellipse(None, *other[:2], other[2:4], other.angle)
    elif len(other.vertices) == 1:
        shape = pymunk.Circle(None, other.radius, other.vertices[0])
    elif len(other.vertices) == 2:
        shape = pymunk.Segment(None, *other.vertices, other.radius)
    else:
        shape = pymunk.Poly(None, other.vertices, radius=other.radius)
    shape.update(Transform.identity())
    [hit] = space.shape_query(shape)
    contact = hit.contact_point_set
    [point] = contact.points
    normal = -Vec2d(*case["normal"])
    assert point.distance == pytest.approx(-case["depth"], abs=1e-9 * max(a, b))
    assert abs(contact.normal - normal) < 1e-9
    assert abs(point.point_b - point.point_a - point.distance * normal) < 1e-9 * a
    assert hit.shape.point_query(point.point_b).distance == pytest.approx(0, abs=1e-9)
    # Where the ellipse has that normal.
    u = -normal.rotated(-angle)
    support = Vec2d(a * a * u.x, b * b * u.y) / hypot(a * u.x, b * u.y)
    touched = Vec2d(x, y) + support.rotated(angle)
    assert abs(point.point_b - touched) < 1e-9 * max(a, b)


def test_groups_and_masks_count_in_shape_queries():
    space = Space()
    egg = add_ellipse(space, 6, 3)
    shape = Ellipse(space.static_body, 2, 1)
    assert [hit.shape for hit in space.shape_query(shape)] == [egg]
    egg.filter = shape.filter = ShapeFilter(group=1)
    assert not space.shape_query(shape)
    egg.filter = ShapeFilter(categories=2)
    shape.filter = ShapeFilter(mask=1)
    assert not space.shape_query(shape)
    shape.filter = ShapeFilter(mask=2)
    assert space.shape_query(shape)
    egg.sensor = True
    assert space.shape_query(shape)


def test_shapes_collide_takes_other_shapes_where_update_put_them():
    egg = Ellipse(None, 4, 2)
    for other in kinds(None)[1:]:
        assert egg.shapes_collide(other).points
        other.update(Transform.translation(30, 0))
        assert not egg.shapes_collide(other).points
        egg.update(Transform.translation(30, 0))
        assert egg.shapes_collide(other).points
        egg.update(Transform.identity())


def test_shapes_that_nothing_has_placed_are_at_the_origin():
    for other, touches in (
        (pymunk.Circle(None, 1, (4.5, 0)), True),
        (pymunk.Circle(None, 1, (30, 0)), False),
        (pymunk.Segment(None, (3, 0), (30, 0), 1), True),
        (pymunk.Segment(None, (20, 0), (30, 0), 1), False),
        (pymunk.Poly(None, [(3, 0), (30, 0), (30, 9)]), True),
        (pymunk.Poly(None, [(20, 0), (30, 0), (30, 9)]), False),
    ):
        assert bool(Ellipse(None, 4, 2).shapes_collide(other).points) == touches


def test_a_face_touched_next_to_its_corner_is_a_face():
    egg = Ellipse(None, 4, 2)
    corners = [(-1e-6, -1.9), (9, -1.9), (9, -9), (-1e-6, -9)]
    contact = egg.shapes_collide(pymunk.Poly(None, corners))
    assert contact.normal == pytest.approx((0, -1), abs=1e-12)
    assert contact.points[0].point_a == pytest.approx((0, -2), abs=1e-12)


def test_a_face_with_a_corner_close_behind_it_is_a_face():
    contact = Ellipse(None, 4, 2, (0, 1.999)).shapes_collide(
        pymunk.Poly(None, [(-10, 0), (10, 0), (0, -0.01)])
    )
    assert contact.points[0].distance == pytest.approx(-0.001, abs=1e-12)


@pytest.mark.parametrize("size", [1e-6, 1e-3, 1.0, 1e3, 1e6])
def test_shape_queries_at_any_scale(size):
    rng = np.random.default_rng(12)
    space = Space()
    eggs = []
    for _ in range(60):
        body = add_body(space, tuple(size * rng.uniform(-5, 5, 2)), rng.uniform(0, pi))
        eggs.append(Ellipse(body, size, size / 3))
        space.add(eggs[-1])
    for kind in (
        pymunk.Circle(space.static_body, size / 2, (size, size)),
        pymunk.Segment(space.static_body, (-size, 0), (2 * size, size), size / 9),
        pymunk.Poly.create_box(space.static_body, (3 * size, size), size / 9),
        eggs[0],
    ):
        expected = {
            egg for egg in eggs if egg is not kind and egg.shapes_collide(kind).points
        }
        assert {hit.shape for hit in space.shape_query(kind)} == expected
        assert expected


# Scenes


def test_a_space_without_ellipses_answers_as_pymunk_does():
    rng = np.random.default_rng(13)
    space = crowd(rng, 1)
    space.remove(*ellipses_in(space))
    for start, end in rng.uniform(-40, 40, (300, 2, 2)).tolist():
        for query, arguments in (
            ("point_query", (start, 30, ALL)),
            ("point_query_nearest", (start, 30, ALL)),
            ("segment_query", (start, end, 1, ALL)),
            ("segment_query_first", (start, end, 1, ALL)),
            ("bb_query", (BB(*start, *(start[i] + 9 for i in (0, 1))), ALL)),
        ):
            expected = getattr(pymunk.Space, query)(space, *arguments)
            assert getattr(space, query)(*arguments) == expected


def test_queries_follow_shapes_that_move_change_and_go():
    space = Space()
    egg = add_ellipse(space, 4, 2, velocity=(10, 0))
    space.step(1)
    assert space.point_query_nearest((15, 0), 5, ALL).distance == pytest.approx(1)
    egg.body.position = 50, 0
    space.reindex_shapes_for_body(egg.body)
    assert space.point_query_nearest((55, 0), 5, ALL).distance == pytest.approx(1)
    egg.unsafe_set_semi_axes(4.5, 1)
    space.reindex_shape(egg)
    assert space.point_query_nearest((55, 0), 5, ALL).distance == pytest.approx(0.5)
    space.remove(egg)
    assert space.point_query_nearest((55, 0), 5, ALL) is None


def test_queries_in_callbacks():
    space = Space()
    add_ellipse(space, 4, 2)
    add_ellipse(space, 4, 2, (1, 1))
    answers = []

    def ask(arbiter, space, data):
        answers.append(space.point_query_nearest((9, 0), 20, ALL))
        answers.append(space.segment_query_first((0, 9), (0, 0), 0, ALL))
        answers.extend(space.segment_query((0, 9), (0, 0), 1, ALL))
        answers.extend(space.shape_query(arbiter.shapes[0]))

    space.on_collision(begin=ask)
    space.step(1e-6)
    assert len(answers) == 5
    assert all(answers)


@pytest.mark.parametrize("make", [pymunk.Space, Space])
def test_batches_are_exact(make, backend):
    """What pymunk.batch reads of a scene in bulk: positions of bodies, and contacts, which are the ellipses'."""
    space = make()
    space.gravity = 0, -100
    add_box(space, 30, 100)
    rng = np.random.default_rng(14)
    for i in range(30):
        add_ellipse(space, 4, 2, tuple(rng.uniform((-20, 5), (20, 60))), i)
    for _ in range(300):
        space.step(1 / 120)

    fields = pymunk.batch.BodyFields.POSITION | pymunk.batch.BodyFields.ANGLE
    bodies = pymunk.batch.Buffer()
    pymunk.batch.get_space_bodies(space, fields, bodies)
    table = np.frombuffer(bodies.float_buf()).reshape(-1, 3)
    everybody = [*space.bodies, space.static_body]
    expected = sorted((*body.position, body.angle) for body in everybody)
    assert sorted(map(tuple, table)) == expected

    F = pymunk.batch.ArbiterFields
    arbiters = pymunk.batch.Buffer()
    pymunk.batch.get_space_arbiters(
        space,
        F.BODY_A_ID
        | F.BODY_B_ID
        | F.NORMAL
        | F.CONTACT_COUNT
        | F.POINT_A_1
        | F.POINT_B_1
        | F.DISTANCE_1,
        arbiters,
    )
    ids = np.frombuffer(arbiters.int_buf(), dtype=np.intp).reshape(-1, 3)
    numbers = np.frombuffer(arbiters.float_buf()).reshape(-1, 7)
    by_id = {body.id: body for body in everybody}
    touching = 0
    for (id_a, id_b, count), row in zip(ids, numbers, strict=True):
        # A pair that does not touch any more, or of which only hulls touch, is without contacts.
        if count == 0:
            continue
        touching += 1
        assert count == 1
        normal, point_a, point_b = (Vec2d(*row[i : i + 2]) for i in (0, 2, 4))
        # Positions have not moved since the contact was found.
        eggs_a = ellipses_on(by_id[id_a])
        eggs_b = ellipses_on(by_id[id_b])
        for egg, point, outward in (
            *((egg, point_a, normal) for egg in eggs_a),
            *((egg, point_b, -normal) for egg in eggs_b),
        ):
            hit = egg.point_query(point)
            assert hit.distance == pytest.approx(0, abs=1e-9)
            assert hit.gradient == pytest.approx(outward, abs=1e-5)
        assert row[6] == pytest.approx((point_b - point_a).dot(normal), abs=1e-9)
    assert touching > 30


def ellipses_on(body):
    return [shape for shape in body.shapes if isinstance(shape, Ellipse)]


# Bad arguments


BAD_POINTS = [
    ((0, nan), ValueError, r"{}\[1\] must be finite, got nan"),
    ((inf, 0), ValueError, r"{}\[0\] must be finite, got inf"),
    ((0, "x"), TypeError, r"{}\[1\] must be a number, got 'x'"),
    ((0,), ValueError, r"{} must be two numbers, got \(0,\)"),
    (None, TypeError, r"{} must be two numbers, got None"),
]


def egg_space():
    space = Space()
    space.add(Ellipse(space.static_body, 4, 2))
    return space


@pytest.mark.parametrize("bad, error, message", BAD_POINTS)
def test_bad_points_are_named(bad, error, message):
    space = egg_space()
    [shape] = space.shapes
    for name, call in (
        ("p", lambda: shape.point_query(bad)),
        ("start", lambda: shape.segment_query(bad, (0, 0))),
        ("end", lambda: shape.segment_query((0, 0), bad)),
        ("point", lambda: space.point_query(bad, 1, ALL)),
        ("point", lambda: space.point_query_nearest(bad, 1, ALL)),
        ("start", lambda: space.segment_query(bad, (0, 0), 0, ALL)),
        ("end", lambda: space.segment_query((0, 0), bad, 0, ALL)),
        ("start", lambda: space.segment_query_first(bad, (0, 0), 0, ALL)),
        ("end", lambda: space.segment_query_first((0, 0), bad, 0, ALL)),
    ):
        with pytest.raises(error, match=message.format(name)):
            call()


@pytest.mark.parametrize("bad, error", [(nan, ValueError), ("1", TypeError)])
def test_bad_numbers_are_named(bad, error):
    space = egg_space()
    [shape] = space.shapes
    for name, call in (
        ("radius", lambda: shape.segment_query((9, 9), (0, 0), bad)),
        ("radius", lambda: space.segment_query((9, 9), (0, 0), bad, ALL)),
        ("radius", lambda: space.segment_query_first((9, 9), (0, 0), bad, ALL)),
        ("max_distance", lambda: space.point_query((0, 0), bad, ALL)),
        ("max_distance", lambda: space.point_query_nearest((0, 0), bad, ALL)),
        ("bb.top", lambda: space.bb_query((0, 0, 1, bad), ALL)),
    ):
        with pytest.raises(error, match=f"{name} must be .*, got {bad!r}"):
            call()


@pytest.mark.parametrize("bad", [None, 3, (0, 0, 1)])
def test_bad_boxes_and_shapes_are_named(bad):
    space = egg_space()
    with pytest.raises((TypeError, ValueError), match="bb must be four numbers, got"):
        space.bb_query(bad, ALL)
    with pytest.raises(TypeError, match=r"shape must be a pymunk.Shape, got"):
        space.shape_query(bad)
