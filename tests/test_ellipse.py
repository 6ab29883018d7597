"""The shape: arguments, and all that any pymunk shape can do."""

import copy
import pickle
import re
from decimal import Decimal
from fractions import Fraction
from math import inf, nan, pi

import numpy as np
import pymunk
import pytest
from pymunk import Vec2d
from scenes import lone_body
from test_mass import check_mass

from pymunk_ellipse import Ellipse, Space

# Arguments


def test_properties():
    body = lone_body()
    egg = Ellipse(body, 20, 10, (3, 4), 0.5)
    assert (egg.a, egg.b, egg.offset, egg.angle) == (20, 10, Vec2d(3, 4), 0.5)
    assert egg.body is body
    assert egg in body.shapes
    assert egg.space is None
    assert egg.area == pytest.approx(200 * pi)


def test_defaults():
    egg = Ellipse(None, 1, 2)
    assert egg.body is None
    assert egg.offset == (0, 0)
    assert egg.angle == 0
    assert (egg.a, egg.b) == (1, 2)


@pytest.mark.parametrize("name", ["a", "b", "offset", "angle", "area"])
def test_properties_are_read_only(name):
    with pytest.raises(AttributeError):
        setattr(Ellipse(None, 2, 1), name, 1)


@pytest.mark.parametrize(
    "number", [3, 3.0, np.float64(3), np.int32(3), Fraction(3), Decimal(3), True + 2]
)
def test_any_real_number_will_do(number):
    egg = Ellipse(None, number, number, (number, number), number)
    assert (egg.a, egg.b, egg.angle) == (3.0, 3.0, 3.0)
    assert egg.offset == (3.0, 3.0)
    assert {type(x) for x in (egg.a, egg.b, egg.angle)} == {float}


@pytest.mark.parametrize("offset", [[1, 2], (1, 2), Vec2d(1, 2), np.array([1, 2])])
def test_any_pair_is_an_offset(offset):
    assert Ellipse(None, 2, 1, offset).offset == Vec2d(1, 2)


WRONG = [
    (inf, ValueError, "finite"),
    (-inf, ValueError, "finite"),
    (nan, ValueError, "finite"),
    ("3", TypeError, "a number"),
    (b"3", TypeError, "a number"),
    (1j, TypeError, "a number"),
    (None, TypeError, "a number"),
    ([1.0], TypeError, "a number"),
    (10**400, (TypeError, ValueError), ""),
]


@pytest.mark.parametrize(("value", "error", "words"), WRONG)
@pytest.mark.parametrize("name", ["a", "b", "angle"])
def test_bad_number(name, value, error, words):
    arguments = {"a": 2.0, "b": 1.0, name: value}
    shown = str(value) if value != 10**400 else "1000"
    with pytest.raises(error, match=f"^{name} must be .*{words}") as caught:
        Ellipse(None, **arguments)
    assert shown.strip("'") in str(caught.value)


@pytest.mark.parametrize("value", [0, -1, -0.0, -1e-300])
@pytest.mark.parametrize("name", ["a", "b"])
def test_semi_axis_must_be_positive(name, value):
    with pytest.raises(ValueError, match=f"^{name} must be positive, got {value}"):
        Ellipse(None, **{"a": 1.0, "b": 1.0, name: float(value)})


@pytest.mark.parametrize("value", [1e-51, 5e-324, 1e51, 1e308])
@pytest.mark.parametrize("name", ["a", "b"])
def test_too_small_or_large(name, value):
    message = f"^{name} must lie between .* got {re.escape(str(value))}"
    with pytest.raises(ValueError, match=message):
        Ellipse(None, **{"a": value, "b": value, "ab".replace(name, ""): 1.0})


def test_too_thin():
    with pytest.raises(ValueError, match=r"a and b .* a=1000001\.0 and b=1\.0"):
        Ellipse(None, 1000001, 1)
    with pytest.raises(ValueError, match=r"a and b .* a=1\.0 and b=1000001\.0"):
        Ellipse(None, 1, 1000001)
    assert Ellipse(None, 1e6, 1).a == 1e6


@pytest.mark.parametrize(
    ("offset", "error", "message"),
    [
        ((nan, 0), ValueError, r"offset\[0\] must be finite, got nan"),
        ((0, inf), ValueError, r"offset\[1\] must be finite, got inf"),
        ((0, "1"), TypeError, r"offset\[1\] must be a number, got '1'"),
        ((0, 1j), TypeError, r"offset\[1\] must be a number, got 1j"),
        ((1, 2, 3), ValueError, r"offset must be two numbers, got \(1, 2, 3\)"),
        ((1,), ValueError, r"offset must be two numbers, got \(1,\)"),
        (5, TypeError, r"offset must be two numbers, got 5"),
        ("12", TypeError, r"offset must be two numbers, got '12'"),
        (None, TypeError, r"offset must be two numbers, got None"),
    ],
)
def test_bad_offset(offset, error, message):
    with pytest.raises(error, match=message):
        Ellipse(None, 2, 1, offset)


def test_bad_arguments_leave_the_body_alone():
    body = lone_body()
    with pytest.raises(ValueError):
        Ellipse(body, 2, -1)
    assert not body.shapes


@pytest.mark.parametrize(
    ("setter", "arguments", "message"),
    [
        ("unsafe_set_semi_axes", (2, -1), "b must be positive"),
        ("unsafe_set_semi_axes", ("2", 1), "a must be a number"),
        ("unsafe_set_offset", ((nan, 0),), r"offset\[0\] must be finite"),
        ("unsafe_set_angle", (inf,), "angle must be finite"),
    ],
)
def test_unsafe_setters_check(setter, arguments, message):
    egg = Ellipse(lone_body(), 3, 2, (1, 1), 1)
    before = (egg.a, egg.b, egg.offset, egg.angle, egg.get_vertices())
    with pytest.raises((TypeError, ValueError), match=message):
        getattr(egg, setter)(*arguments)
    assert (egg.a, egg.b, egg.offset, egg.angle, egg.get_vertices()) == before


def test_hull_cannot_be_set():
    egg = Ellipse(None, 3, 2)
    with pytest.raises(TypeError, match="unsafe_set_semi_axes"):
        egg.unsafe_set_vertices([(0, 0), (1, 0), (0, 1)])
    with pytest.raises(TypeError, match="unsafe_set_semi_axes"):
        egg.unsafe_set_radius(1)


def test_unsafe_setters():
    egg = Ellipse(lone_body(), 2, 1)
    ball = pymunk.Circle(lone_body(0, 2.5), 1)
    assert not egg.shapes_collide(ball).points
    egg.unsafe_set_semi_axes(1, 2)
    assert (egg.a, egg.b) == (1, 2)
    assert egg.area == pytest.approx(2 * pi)
    assert egg.shapes_collide(ball).points[0].distance == pytest.approx(-0.5)
    egg.unsafe_set_angle(pi / 2)
    assert not egg.shapes_collide(ball).points
    egg.unsafe_set_offset((0, 1))
    assert egg.shapes_collide(ball).points[0].distance == pytest.approx(-0.5)
    assert egg.cache_bb().top >= 2


def test_unsafe_setters_change_contacts_at_work():
    space = pymunk.Space()
    egg = Ellipse(lone_body(), 2, 1)
    egg.mass = 1
    floor = pymunk.Segment(space.static_body, (-9, -1.5), (9, -1.5), 0)
    depths = []

    def note(arbiter, space, data):
        depths.append(arbiter.contact_point_set.points[0].distance)

    space.on_collision(post_solve=note)
    space.add(egg.body, egg, floor)
    space.step(1e-9)
    assert depths == []
    egg.unsafe_set_semi_axes(2, 2)
    space.step(1e-9)
    assert depths == [pytest.approx(-0.5)]
    egg.unsafe_set_offset((0, 0.25))
    space.step(1e-9)
    assert depths[1:] == [pytest.approx(-0.25)]
    egg.unsafe_set_semi_axes(3, 1)
    egg.unsafe_set_angle(pi / 2)
    space.step(1e-9)
    assert depths[2:] == [pytest.approx(-1.25)]


def test_unsafe_setters_leave_it_where_it_was_updated_last():
    egg = Ellipse(None, 2, 1, (3, -1), 0.4)
    at = pymunk.Transform.translation(50, 60) @ pymunk.Transform.rotation(0.7)
    egg.update(at)
    egg.unsafe_set_semi_axes(1, 2)
    egg.unsafe_set_offset((5, 4))
    egg.unsafe_set_angle(-0.3)
    [new, same] = Ellipse(None, 1, 2, (5, 4), -0.3), egg
    new.update(at)
    assert same.bb == pytest.approx(new.bb)
    assert same.outline()[0] == pytest.approx(new.outline()[0])


@pytest.mark.parametrize("space_class", [pymunk.Space, Space])
def test_queries_find_what_has_grown_since_the_last_step(space_class):
    space = space_class()
    shapes = Ellipse(lone_body(100, 60), 2, 2), pymunk.Circle(lone_body(-100, 60), 2)
    for shape in shapes:
        space.add(shape.body, shape)
    space.step(0.01)
    egg, ball = shapes
    egg.unsafe_set_semi_axes(3, 3)
    ball.unsafe_set_radius(3)
    for shape in shapes:
        x = shape.body.position.x
        found = space.point_query_nearest((x, 61.5), 0, pymunk.ShapeFilter())
        assert found.shape is shape
        assert found.distance == pytest.approx(-1.5)


@pytest.mark.parametrize("space_class", [pymunk.Space, Space])
@pytest.mark.parametrize("floor_first", [False, True])
def test_what_grows_in_a_callback_still_meets_the_others(space_class, floor_first):
    heights = []
    for shape, grow in (
        (
            pymunk.Circle(lone_body(9, 10), 10),
            lambda s: s.unsafe_set_radius(s.radius + 0.02),
        ),
        (
            Ellipse(lone_body(9, 10), 10, 10),
            lambda s: s.unsafe_set_semi_axes(s.a + 0.02, s.b + 0.02),
        ),
    ):
        space = space_class()
        space.gravity = 0, -900
        floor = pymunk.Segment(space.static_body, (-90, 0), (90, 0), 0)
        wand = pymunk.Circle(space.static_body, 3, (9, 12))
        shape.collision_type = 1
        floors = [floor, wand] if floor_first else [wand, floor]

        def touch(arbiter, space, data, shape=shape, grow=grow, wand=wand):
            grow(shape)
            arbiter.process_collision = wand not in arbiter.shapes

        space.on_collision(1, 0, pre_solve=touch)
        space.add(shape.body, shape, *floors)
        for _ in range(60):
            space.step(1 / 60)
        heights.append(shape.body.position.y)
    assert heights[0] > 10
    assert heights[1] == pytest.approx(heights[0], abs=0.1)


# What any shape can do


def test_attributes_of_any_shape():
    egg = Ellipse(lone_body(), 2, 1)
    egg.friction = 0.7
    egg.elasticity = 0.3
    egg.sensor = True
    egg.collision_type = 7
    egg.surface_velocity = 3, 4
    egg.filter = pymunk.ShapeFilter(group=2)
    assert (egg.friction, egg.elasticity, egg.sensor) == (0.7, 0.3, True)
    assert egg.collision_type == 7
    assert egg.surface_velocity == (3, 4)
    assert egg.filter == pymunk.ShapeFilter(group=2)


def test_queries_find_it():
    space = pymunk.Space()
    egg = Ellipse(lone_body(10, 0), 2, 1)
    space.add(egg.body, egg)
    assert space.point_query_nearest((10, 0.5), 0, pymunk.ShapeFilter()).shape is egg
    hit = space.segment_query_first((0, 0), (20, 0), 0, pymunk.ShapeFilter())
    assert hit.shape is egg
    assert hit.point.x == pytest.approx(8, abs=0.3)
    assert space.bb_query(pymunk.BB(9, -1, 11, 1), pymunk.ShapeFilter()) == [egg]
    assert egg.space is space
    space.remove(egg)
    assert egg.space is None


def test_filter():
    space = pymunk.Space()
    seen = []
    space.on_collision(pre_solve=lambda *_: seen.append(1))
    for x in (0, 1):
        egg = Ellipse(lone_body(x, 0), 2, 1)
        egg.filter = pymunk.ShapeFilter(group=1)
        space.add(egg.body, egg)
    space.step(0.01)
    assert not seen


@pytest.mark.parametrize("kind", ["STATIC", "KINEMATIC"])
def test_on_a_body_that_does_not_give_way(kind):
    space = pymunk.Space()
    space.gravity = 0, -100
    ground = pymunk.Body(body_type=getattr(pymunk.Body, kind))
    hill = Ellipse(ground, 20, 5)
    ball = lone_body(0, 6)
    ball.moment = inf
    round_shape = pymunk.Circle(ball, 1)
    space.add(ground, hill, ball, round_shape)
    for _ in range(200):
        space.step(0.01)
    assert ball.position == pytest.approx((0, 6), abs=0.11)
    assert ground.position == (0, 0)


# Copy and pickle


def duplicates(thing):
    return [copy.deepcopy(thing), thing.copy(), pickle.loads(pickle.dumps(thing))]


def test_copies():
    egg = Ellipse(None, 20, 10, (3, 4), 0.5)
    egg.friction = 0.7
    egg.elasticity = 0.3
    egg.sensor = True
    egg.collision_type = 7
    egg.surface_velocity = 3, 4
    egg.filter = pymunk.ShapeFilter(group=2)
    egg.mass = 12
    for twin in duplicates(egg):
        assert type(twin) is Ellipse
        for name in ("a", "b", "offset", "angle", "friction", "elasticity", "sensor"):
            assert getattr(twin, name) == getattr(egg, name), name
        for name in ("collision_type", "surface_velocity", "filter", "mass", "density"):
            assert getattr(twin, name) == getattr(egg, name), name
        assert twin.get_vertices() == egg.get_vertices()
        assert twin.radius == egg.radius


def test_copies_after_a_change():
    egg = Ellipse(None, 20, 10)
    egg.unsafe_set_semi_axes(3, 5)
    egg.unsafe_set_offset((1, 2))
    egg.unsafe_set_angle(0.25)
    for twin in duplicates(egg):
        assert (twin.a, twin.b, twin.offset, twin.angle) == (3, 5, (1, 2), 0.25)


def test_copies_with_a_body():
    body = pymunk.Body()
    body.position = 5, 6
    body.angle = 0.5
    egg = Ellipse(body, 20, 10, (3, 4), 0.5)
    egg.mass = 12
    pair = body, egg
    for twin_body, twin in (copy.deepcopy(pair), pickle.loads(pickle.dumps(pair))):
        assert twin.body is twin_body
        assert twin_body is not body
        assert twin_body.position == (5, 6)
        place = body.local_to_world((3, 4))
        ball = pymunk.Circle(lone_body(*place), 1)
        found, expected = twin.shapes_collide(ball), egg.shapes_collide(ball)
        assert found.normal == expected.normal
        assert found.points[0].point_a == expected.points[0].point_a
        assert found.points[0].distance == expected.points[0].distance
        space = pymunk.Space()
        space.add(twin_body, twin)
        check_mass(twin_body, [(12, 20, 10, (3, 4))])


def test_subclass_with_its_own_attributes():
    egg = Marked(None, 2, 1)
    egg.colour = "white"
    twin = pickle.loads(pickle.dumps(egg))
    assert type(twin) is Marked
    assert twin.colour == "white"


class Marked(Ellipse):
    """An ellipse that somebody's game knows more about."""
