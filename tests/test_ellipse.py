"""The shape: arguments, contacts asked for directly, mass, and all that any pymunk shape can do."""

import copy
import json
import pickle
import re
from decimal import Decimal
from fractions import Fraction
from math import cos, hypot, inf, nan, pi, sin
from pathlib import Path

import numpy as np
import pymunk
import pytest
from pairs import Placed, from_reference
from pymunk import Vec2d

from pymunk_ellipse import Ellipse, area_for_ellipse, moment_for_ellipse

REFERENCES = json.loads((Path(__file__).parent / "contacts.json").read_text())["cases"]


# A shape does not keep its body alive.
BODIES = []


@pytest.fixture(autouse=True)
def no_bodies_left():
    yield
    BODIES.clear()


def body_at(x=0.0, y=0.0, angle=0.0):
    body = pymunk.Body(1, 1)
    BODIES.append(body)
    body.position = x, y
    body.angle = angle
    return body


def as_shape(body, shape):
    """A shape of the references, on a body."""
    if isinstance(shape, Placed):
        return Ellipse(body, shape.a, shape.b, (shape.x, shape.y), shape.angle)
    if len(shape.vertices) == 1:
        return pymunk.Circle(body, shape.radius, shape.vertices[0])
    if len(shape.vertices) == 2:
        return pymunk.Segment(body, *shape.vertices, shape.radius)
    return pymunk.Poly(body, shape.vertices, radius=shape.radius)


# Arguments


def test_properties():
    body = body_at()
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
    body = body_at()
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
    egg = Ellipse(body_at(), 3, 2, (1, 1), 1)
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


# Contacts asked for directly


@pytest.mark.parametrize("case", REFERENCES)
def test_shapes_collide_reference(case):
    ellipse, other = from_reference(case)
    egg, shape = as_shape(body_at(), ellipse), as_shape(body_at(), other)
    found = egg.shapes_collide(shape)
    if case["depth"] < 0:
        assert found.points == ()
        assert found.normal == (0, 0)
        return
    (point,) = found.points
    assert point.distance == pytest.approx(-case["depth"], abs=1e-8 * ellipse.b)
    assert found.normal == pytest.approx(case["normal"], abs=1e-5)
    assert point.point_b - point.point_a == pytest.approx(
        point.distance * found.normal, abs=1e-9
    )


def test_reference_in_a_moved_world():
    """Bodies moved and turned by the same amount see the same contact."""
    for case in REFERENCES[:80]:
        if case["depth"] < 0:
            continue
        ellipse, other = from_reference(case)
        egg = as_shape(body_at(1e3, -2e3, 2.5), ellipse)
        shape = as_shape(body_at(1e3, -2e3, 2.5), other)
        found = egg.shapes_collide(shape)
        assert found.points[0].distance == pytest.approx(-case["depth"], abs=1e-8)
        normal = Vec2d(*case["normal"]).rotated(2.5)
        assert found.normal == pytest.approx(normal, abs=1e-5)


def test_reference_far_from_the_origin():
    """At 1e7 a coordinate is right to 1e-9, and so is the depth."""
    for case in REFERENCES:
        if case["depth"] < 0:
            continue
        ellipse, other = from_reference(case)
        egg = as_shape(body_at(1e7, -1e7), ellipse)
        found = egg.shapes_collide(as_shape(body_at(1e7, -1e7), other))
        assert found.points[0].distance == pytest.approx(-case["depth"], abs=1e-7)
        assert found.normal == pytest.approx(case["normal"], abs=1e-3)


def test_same_as_native_circle():
    """An ellipse with a == b has pymunk's own contact with every kind of shape."""
    random = np.random.default_rng(0)
    touched = 0
    for _ in range(2000):
        x, y, angle, size, radius = random.uniform(-1, 1, 5).tolist()
        body = body_at(x, y, angle)
        egg = Ellipse(body, 1.5, 1.5, (0.3, 0.2), 1.0)
        circle = pymunk.Circle(body, 1.5, (0.3, 0.2))
        other_body = body_at(2 * y, 3 * x, angle)
        radius = abs(radius)
        box = pymunk.Poly.create_box(other_body, (1 + size, 2), radius)
        others = (
            pymunk.Circle(other_body, radius + 0.1, (size, 0)),
            pymunk.Segment(other_body, (size, 1), (2, size), radius),
            box,
            Ellipse(other_body, radius + 0.1, radius + 0.1),
        )
        for other in others:
            found = egg.shapes_collide(other)
            if isinstance(other, Ellipse):
                other = pymunk.Circle(other_body, radius + 0.1)
            native = native_contact(circle, other)
            assert bool(found.points) == bool(native.points)
            if not native.points:
                continue
            # pymunk gives two points, or an inexact one, for cores that overlap.
            if found.points[0].distance < -1.5:
                continue
            touched += 1
            assert found.normal == pytest.approx(native.normal, abs=1e-6)
            assert found.points[0].distance == pytest.approx(
                native.points[0].distance, abs=1e-9
            )
            assert found.points[0].point_a == pytest.approx(
                native.points[0].point_a, abs=1e-6
            )
            assert found.points[0].point_b == pytest.approx(
                native.points[0].point_b, abs=1e-6
            )
    assert touched > 2000


def native_contact(circle, other):
    """pymunk's contact of two of its own shapes; none where it asserts that they touch."""
    circle.cache_bb()
    other.cache_bb()
    try:
        return circle.shapes_collide(other)
    except AssertionError:
        return pymunk.ContactPointSet(Vec2d.zero(), ())


def test_convention():
    egg = Ellipse(body_at(), 2, 1)
    ball = pymunk.Circle(body_at(0, 1.8), 1)
    found = egg.shapes_collide(ball)
    assert found.normal == pytest.approx((0, 1))
    (point,) = found.points
    assert point.distance == pytest.approx(-0.2)
    assert point.point_a == pytest.approx((0, 1))
    assert point.point_b == pytest.approx((0, 0.8))


def test_apart_has_no_points():
    egg = Ellipse(body_at(), 2, 1)
    for other in (
        pymunk.Circle(body_at(0, 2.1), 1),
        pymunk.Segment(body_at(), (-3, 1.01), (3, 1.01), 0),
        pymunk.Poly.create_box(body_at(3.1, 0), (2, 2)),
        Ellipse(body_at(0, 3.01), 1, 2),
    ):
        found = egg.shapes_collide(other)
        assert (found.normal, found.points) == ((0, 0), ())


def test_touching_counts():
    assert Ellipse(body_at(), 2, 1).shapes_collide(Ellipse(body_at(4, 0), 2, 1)).points


def test_hulls_that_overlap_are_not_a_contact():
    egg = Ellipse(body_at(), 2, 1)
    corner = Ellipse(body_at(2.9, 1.4), 2, 1)
    assert egg.bb.intersects(corner.bb)
    assert not egg.shapes_collide(corner).points


def test_swapping_ellipses():
    one, two = Ellipse(body_at(), 3, 1), Ellipse(body_at(3, 1, 1), 1, 2)
    found, swapped = one.shapes_collide(two), two.shapes_collide(one)
    assert swapped.normal == pytest.approx(-found.normal, abs=1e-6)
    assert swapped.points[0].distance == pytest.approx(found.points[0].distance)
    assert swapped.points[0].point_a == pytest.approx(found.points[0].point_b, abs=1e-6)


def test_longer_axis_may_be_either():
    ball = pymunk.Circle(body_at(0, 2.5), 1)
    tall = Ellipse(body_at(), 1, 2).shapes_collide(ball)
    turned = Ellipse(body_at(), 2, 1, angle=pi / 2).shapes_collide(ball)
    assert tall.points[0].distance == pytest.approx(-0.5)
    assert turned.points[0].distance == pytest.approx(-0.5)


def test_offset_and_angle():
    body = body_at(10, 20, pi / 2)
    # The centre is at (10, 25), and a along the world's x.
    egg = Ellipse(body, 2, 1, (5, 0), -pi / 2)
    found = egg.shapes_collide(pymunk.Circle(body_at(10, 26.5), 1))
    assert found.points[0].distance == pytest.approx(-0.5)
    assert found.normal == pytest.approx((0, 1))
    found = egg.shapes_collide(pymunk.Circle(body_at(12.5, 25), 1))
    assert found.points[0].distance == pytest.approx(-0.5)


def test_without_a_body():
    egg = Ellipse(None, 2, 1, (1, 0))
    ball = pymunk.Circle(None, 1, (1, 1.5))
    assert egg.shapes_collide(ball).points[0].distance == pytest.approx(-0.5)
    egg.update(pymunk.Transform.translation(0, 0.25))
    assert egg.shapes_collide(ball).points[0].distance == pytest.approx(-0.75)
    egg.update(pymunk.Transform.rotation(pi / 2))
    other = Ellipse(None, 1, 1, (0, 3.5))
    assert egg.shapes_collide(other).points[0].distance == pytest.approx(-0.5)


def test_update_returns_the_box_of_the_hull():
    egg = Ellipse(None, 2, 1)
    box = egg.update(pymunk.Transform.translation(10, 0))
    assert box == egg.bb
    assert box.left <= 8
    assert box.right >= 12
    assert box.bottom <= -1
    assert box.top >= 1
    assert box.right < 12.5


@pytest.mark.parametrize(
    "transform",
    [
        pymunk.Transform.scaling(2),
        pymunk.Transform(a=1, b=1),
        pymunk.Transform(a=1, d=-1),
        pymunk.Transform(a=nan),
    ],
)
def test_update_needs_a_rigid_transform(transform):
    with pytest.raises(ValueError, match="transform must be a rotation"):
        Ellipse(None, 2, 1).update(transform)


def test_moved_body_is_seen_at_once():
    egg = Ellipse(body_at(), 2, 1)
    ball = pymunk.Circle(body_at(0, 10), 1)
    assert not egg.shapes_collide(ball).points
    ball.body.position = 0, 1.5
    assert egg.shapes_collide(ball).points
    egg.body.angle = pi / 2
    assert egg.shapes_collide(ball).points[0].distance == pytest.approx(-1.5)


@pytest.mark.parametrize("other", [None, 5, "egg", pymunk.Body()])
def test_only_shapes_collide(other):
    with pytest.raises(TypeError, match=r"b must be a pymunk\.Shape, got"):
        Ellipse(body_at(), 2, 1).shapes_collide(other)


@pytest.mark.parametrize("count", [3, 4, 5, 6, 7, 9, 20])
def test_polygons_of_any_size(count):
    """Chipmunk stores large polygons elsewhere than small ones."""
    corners = [
        (5 * cos(2 * pi * i / count), 5 * sin(2 * pi * i / count)) for i in range(count)
    ]
    apothem = 5 * cos(pi / count)
    polygon = pymunk.Poly(body_at(0, 0, 0.3), corners, radius=0.25)
    middle = 0.3 + pi / count
    place = (apothem + 1) * cos(middle), (apothem + 1) * sin(middle)
    egg = Ellipse(body_at(*place, middle), 1, 2)
    found = egg.shapes_collide(polygon)
    assert found.points[0].distance == pytest.approx(-0.25)
    assert found.normal == pytest.approx((-cos(middle), -sin(middle)))


def test_degenerate_polygons():
    egg = Ellipse(body_at(), 2, 1)
    point = pymunk.Poly(body_at(0, 1.2), [(0, 0)], radius=0.5)
    assert egg.shapes_collide(point).points[0].distance == pytest.approx(-0.3)
    line = pymunk.Poly(body_at(0, 1.2), [(-1, 0), (1, 0)], radius=0.5)
    assert egg.shapes_collide(line).points[0].distance == pytest.approx(-0.3)


def test_unsafe_setters():
    egg = Ellipse(body_at(), 2, 1)
    ball = pymunk.Circle(body_at(0, 2.5), 1)
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
    egg = Ellipse(body_at(), 2, 1)
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


# What any shape can do


def test_attributes_of_any_shape():
    egg = Ellipse(body_at(), 2, 1)
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
    egg = Ellipse(body_at(10, 0), 2, 1)
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
        egg = Ellipse(body_at(x, 0), 2, 1)
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
    ball = body_at(0, 6)
    ball.moment = inf
    round_shape = pymunk.Circle(ball, 1)
    space.add(ground, hill, ball, round_shape)
    for _ in range(200):
        space.step(0.01)
    assert ball.position == pytest.approx((0, 6), abs=0.11)
    assert ground.position == (0, 0)


# Mass


def test_area_functions():
    assert area_for_ellipse(3, 2) == pytest.approx(6 * pi)
    assert area_for_ellipse(2, 2) == pytest.approx(pymunk.area_for_circle(0, 2))


def test_moment_function():
    assert moment_for_ellipse(5, 2, 2) == pytest.approx(
        pymunk.moment_for_circle(5, 0, 2)
    )
    assert moment_for_ellipse(5, 2, 2, (3, 4)) == pytest.approx(
        pymunk.moment_for_circle(5, 0, 2, (3, 4))
    )
    assert moment_for_ellipse(4, 3, 1) == pytest.approx(10)
    # As the sum over a fine grid.
    u, v = np.meshgrid(np.linspace(-3, 3, 1201), np.linspace(-1, 1, 401))
    inside = (u / 3) ** 2 + v**2 <= 1
    distance2 = (u[inside] + 2) ** 2 + (v[inside] - 1) ** 2
    assert moment_for_ellipse(1, 3, 1, (2, -1)) == pytest.approx(
        distance2.mean(), rel=1e-3
    )


@pytest.mark.parametrize(
    "function", [area_for_ellipse, lambda *s: moment_for_ellipse(1, *s)]
)
@pytest.mark.parametrize(
    ("a", "b", "error", "message"),
    [
        (-1, 1, ValueError, "a must be positive, got -1"),
        (1, nan, ValueError, "b must be finite, got nan"),
        (1, "1", TypeError, "b must be a number, got '1'"),
    ],
)
def test_area_and_moment_check(function, a, b, error, message):
    with pytest.raises(error, match=message):
        function(a, b)


def test_moment_checks_mass_and_offset():
    with pytest.raises(ValueError, match="mass must be finite, got nan"):
        moment_for_ellipse(nan, 2, 1)
    with pytest.raises(TypeError, match=r"offset\[0\] must be a number, got 'x'"):
        moment_for_ellipse(1, 2, 1, ("x", 0))


def total(parts):
    """Mass, moment about the centre of gravity and centre of gravity of (mass, a, b, offset)."""
    mass = sum(part[0] for part in parts)
    x = sum(m * offset[0] for m, _, _, offset in parts) / mass
    y = sum(m * offset[1] for m, _, _, offset in parts) / mass
    moment = sum(
        m * ((a * a + b * b) / 4 + hypot(offset[0] - x, offset[1] - y) ** 2)
        for m, a, b, offset in parts
    )
    return mass, moment, (x, y)


def check_mass(body, parts):
    mass, moment, center = total(parts)
    assert body.mass == pytest.approx(mass, rel=1e-12)
    assert body.moment == pytest.approx(moment, rel=1e-9)
    assert body.center_of_gravity == pytest.approx(center, abs=1e-9)


@pytest.mark.parametrize("when", ["before", "after"])
@pytest.mark.parametrize("how", ["mass", "density"])
@pytest.mark.parametrize("aspect", [1.0, 2.0, 100.0])
def test_mass(aspect, how, when):
    space = pymunk.Space()
    body = pymunk.Body()
    egg = Ellipse(body, aspect, 1, angle=0.4)

    def weigh():
        setattr(egg, how, 3)

    if when == "before":
        weigh()
    space.add(body, egg)
    if when == "after":
        weigh()
    mass = 3 if how == "mass" else 3 * pi * aspect
    check_mass(body, [(mass, aspect, 1, (0, 0))])
    assert egg.mass == pytest.approx(mass)
    assert egg.density == pytest.approx(mass / (pi * aspect))
    assert egg.moment == pytest.approx(mass * (aspect**2 + 1) / 4, rel=1e-9)
    assert egg.center_of_gravity == pytest.approx((0, 0), abs=1e-12)
    space.step(0.01)
    check_mass(body, [(mass, aspect, 1, (0, 0))])


@pytest.mark.parametrize("when", ["before", "after"])
def test_several_on_a_body(when):
    space = pymunk.Space()
    body = pymunk.Body()
    parts = [(2, 3, 1, (4, 0)), (5, 1, 2, (-1, 2)), (1, 1, 1, (0, -7))]
    eggs = [Ellipse(body, a, b, offset, 0.3 * a) for _, a, b, offset in parts]
    if when == "after":
        space.add(body, *eggs)
    for egg, (mass, *_) in zip(eggs, parts, strict=True):
        egg.mass = mass
    if when == "before":
        space.add(body, *eggs)
    check_mass(body, parts)

    # Changed later, and one fewer.
    eggs[1].mass = 10
    parts[1] = (10, *parts[1][1:])
    check_mass(body, parts)
    space.remove(eggs[0])
    check_mass(body, parts[1:])


def test_with_a_native_shape():
    space = pymunk.Space()
    body = pymunk.Body()
    egg = Ellipse(body, 2, 1, (3, 0))
    ball = pymunk.Circle(body, 2, (-3, 0))
    space.add(body, egg, ball)
    egg.mass = ball.mass = 1
    check_mass(body, [(1, 2, 1, (3, 0)), (1, 2, 2, (-3, 0))])


def test_mass_follows_the_semi_axes():
    """As for pymunk's own shapes, mass stays and the moment follows."""
    space = pymunk.Space()
    body = pymunk.Body()
    egg = Ellipse(body, 2, 1)
    egg.mass = 3
    space.add(body, egg)
    egg.unsafe_set_semi_axes(4, 2)
    check_mass(body, [(3, 4, 2, (0, 0))])
    egg.unsafe_set_offset((5, 0))
    check_mass(body, [(3, 4, 2, (5, 0))])


def test_changes_leave_the_bodys_own_mass_alone():
    space = pymunk.Space()
    egg = Ellipse(body_at(), 2, 1)
    space.add(egg.body, egg)
    egg.unsafe_set_semi_axes(4, 2)
    assert egg.body.mass == 1
    assert egg.body.moment == 1


def test_heavier_falls_as_fast():
    space = pymunk.Space()
    space.gravity = 0, -10
    body = pymunk.Body()
    egg = Ellipse(body, 2, 1, (3, 1))
    egg.density = 2
    space.add(body, egg)
    for _ in range(100):
        space.step(0.01)
    assert body.velocity == pytest.approx((0, -10))
    assert body.angular_velocity == 0


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
        ball = pymunk.Circle(body_at(*place), 1)
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
