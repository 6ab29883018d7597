"""Contacts of two shapes that are asked for directly."""

from math import cos, nan, pi, sin

import numpy as np
import pymunk
import pytest
from pairs import from_reference
from pymunk import Vec2d
from scenes import REFERENCES, as_shape, lone_body

from pymunk_ellipse import Ellipse


@pytest.mark.parametrize("case", REFERENCES)
def test_shapes_collide_reference(case):
    ellipse, other = from_reference(case)
    egg, shape = as_shape(lone_body(), ellipse), as_shape(lone_body(), other)
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
        egg = as_shape(lone_body(1e3, -2e3, 2.5), ellipse)
        shape = as_shape(lone_body(1e3, -2e3, 2.5), other)
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
        egg = as_shape(lone_body(1e7, -1e7), ellipse)
        found = egg.shapes_collide(as_shape(lone_body(1e7, -1e7), other))
        assert found.points[0].distance == pytest.approx(-case["depth"], abs=1e-7)
        assert found.normal == pytest.approx(case["normal"], abs=1e-3)


def test_same_as_native_circle():
    """An ellipse with a == b has pymunk's own contact with every kind of shape."""
    random = np.random.default_rng(0)
    touched = 0
    for _ in range(2000):
        x, y, angle, size, radius = random.uniform(-1, 1, 5).tolist()
        body = lone_body(x, y, angle)
        egg = Ellipse(body, 1.5, 1.5, (0.3, 0.2), 1.0)
        circle = pymunk.Circle(body, 1.5, (0.3, 0.2))
        other_body = lone_body(2 * y, 3 * x, angle)
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
    egg = Ellipse(lone_body(), 2, 1)
    ball = pymunk.Circle(lone_body(0, 1.8), 1)
    found = egg.shapes_collide(ball)
    assert found.normal == pytest.approx((0, 1))
    (point,) = found.points
    assert point.distance == pytest.approx(-0.2)
    assert point.point_a == pytest.approx((0, 1))
    assert point.point_b == pytest.approx((0, 0.8))


def test_apart_has_no_points():
    egg = Ellipse(lone_body(), 2, 1)
    for other in (
        pymunk.Circle(lone_body(0, 2.1), 1),
        pymunk.Segment(lone_body(), (-3, 1.01), (3, 1.01), 0),
        pymunk.Poly.create_box(lone_body(3.1, 0), (2, 2)),
        Ellipse(lone_body(0, 3.01), 1, 2),
    ):
        found = egg.shapes_collide(other)
        assert (found.normal, found.points) == ((0, 0), ())


def test_touching_counts():
    assert (
        Ellipse(lone_body(), 2, 1).shapes_collide(Ellipse(lone_body(4, 0), 2, 1)).points
    )


def test_hulls_that_overlap_are_not_a_contact():
    egg = Ellipse(lone_body(), 2, 1)
    corner = Ellipse(lone_body(2.9, 1.4), 2, 1)
    assert egg.bb.intersects(corner.bb)
    assert not egg.shapes_collide(corner).points


def test_swapping_ellipses():
    one, two = Ellipse(lone_body(), 3, 1), Ellipse(lone_body(3, 1, 1), 1, 2)
    found, swapped = one.shapes_collide(two), two.shapes_collide(one)
    assert swapped.normal == pytest.approx(-found.normal, abs=1e-6)
    assert swapped.points[0].distance == pytest.approx(found.points[0].distance)
    assert swapped.points[0].point_a == pytest.approx(found.points[0].point_b, abs=1e-6)


def test_longer_axis_may_be_either():
    ball = pymunk.Circle(lone_body(0, 2.5), 1)
    tall = Ellipse(lone_body(), 1, 2).shapes_collide(ball)
    turned = Ellipse(lone_body(), 2, 1, angle=pi / 2).shapes_collide(ball)
    assert tall.points[0].distance == pytest.approx(-0.5)
    assert turned.points[0].distance == pytest.approx(-0.5)


def test_offset_and_angle():
    body = lone_body(10, 20, pi / 2)
    # The centre is at (10, 25), and a along the world's x.
    egg = Ellipse(body, 2, 1, (5, 0), -pi / 2)
    found = egg.shapes_collide(pymunk.Circle(lone_body(10, 26.5), 1))
    assert found.points[0].distance == pytest.approx(-0.5)
    assert found.normal == pytest.approx((0, 1))
    found = egg.shapes_collide(pymunk.Circle(lone_body(12.5, 25), 1))
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
    egg = Ellipse(lone_body(), 2, 1)
    ball = pymunk.Circle(lone_body(0, 10), 1)
    assert not egg.shapes_collide(ball).points
    ball.body.position = 0, 1.5
    assert egg.shapes_collide(ball).points
    egg.body.angle = pi / 2
    assert egg.shapes_collide(ball).points[0].distance == pytest.approx(-1.5)


@pytest.mark.parametrize("other", [None, 5, "egg", pymunk.Body()])
def test_only_shapes_collide(other):
    with pytest.raises(TypeError, match=r"b must be a pymunk\.Shape, got"):
        Ellipse(lone_body(), 2, 1).shapes_collide(other)


@pytest.mark.parametrize("count", [3, 4, 5, 6, 7, 9, 20])
def test_polygons_of_any_size(count):
    """Chipmunk stores large polygons elsewhere than small ones."""
    corners = [
        (5 * cos(2 * pi * i / count), 5 * sin(2 * pi * i / count)) for i in range(count)
    ]
    apothem = 5 * cos(pi / count)
    polygon = pymunk.Poly(lone_body(0, 0, 0.3), corners, radius=0.25)
    middle = 0.3 + pi / count
    place = (apothem + 1) * cos(middle), (apothem + 1) * sin(middle)
    egg = Ellipse(lone_body(*place, middle), 1, 2)
    found = egg.shapes_collide(polygon)
    assert found.points[0].distance == pytest.approx(-0.25)
    assert found.normal == pytest.approx((-cos(middle), -sin(middle)))


def test_degenerate_polygons():
    egg = Ellipse(lone_body(), 2, 1)
    point = pymunk.Poly(lone_body(0, 1.2), [(0, 0)], radius=0.5)
    assert egg.shapes_collide(point).points[0].distance == pytest.approx(-0.3)
    line = pymunk.Poly(lone_body(0, 1.2), [(-1, 0), (1, 0)], radius=0.5)
    assert egg.shapes_collide(line).points[0].distance == pytest.approx(-0.3)
