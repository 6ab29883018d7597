"""Bounding boxes, and queries of a space that moves, calls back, has no ellipse or is asked nonsense."""

from math import cos, inf, nan, pi, sin

import numpy as np
import pymunk
import pymunk.batch
import pytest
from crowds import ALL, COUNT, crowd, ellipses_in, hull_of, random_ellipses, seen
from pymunk import BB, ShapeFilter, Transform, Vec2d
from scenes import add_box, add_ellipse

from pymunk_ellipse import Ellipse, Space

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


def test_boxes_in_a_space():
    rng = np.random.default_rng(9)
    space = crowd(rng)
    boxes = {shape: shape.bb for shape in space.shapes}
    hulls = {shape: hull_of(shape).bb for shape in ellipses_in(space)}
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
                for shape, bb in boxes.items()
                if bb.intersects(box) and seen(shape, shape_filter.mask)
            }
            assert set(found) == expected
            fewer += sum(
                bb.intersects(box)
                for shape, bb in hulls.items()
                if shape not in expected and seen(shape, shape_filter.mask)
            )
    assert fewer > 100
    everywhere = space.bb_query(BB(-inf, -inf, inf, inf), ALL)
    assert len(everywhere) == len(space.shapes)


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
