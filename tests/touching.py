"""Pairs that tests make touch and part, and logs of the callbacks that are called."""

from math import cos, sin, sqrt

import pymunk
import pytest
from scenes import PHASES, data_in_a_copy

from pymunk_ellipse import Ellipse, Space

# What pymunk loses in a copy.
LOST = pytest.mark.xfail(
    not data_in_a_copy(),
    strict=True,
    reason="where pymunk does not copy the data of handlers, one pair of a copy begins again",
)


def still(space):
    """Nothing moves by itself: shapes are where they are put, whatever the solver did."""
    space.gravity = 0, 0
    # No correction of overlaps.
    space.collision_bias = 1
    return space


def put(body, position, angle=0.0):
    body.position = position
    body.angle = angle
    body.velocity = 0, 0
    body.angular_velocity = 0
    if body.body_type == pymunk.Body.STATIC and body.space is not None:
        body.space.reindex_shapes_for_body(body)


def body_at(space, position=(0, 0), angle=0.0, kind=pymunk.Body.DYNAMIC):
    body = pymunk.Body(1, 1, kind)
    put(body, position, angle)
    space.add(body)
    return body


def listen(space, log, *keys, phases=PHASES, data=None):
    """Append (phase, key) to a log at every call."""
    for key in keys or [(None, None)]:
        for phase in phases:
            space.on_collision(
                *key,
                **{phase: lambda *_, phase=phase, key=key: log.append((phase, key))},
                data=data,
            )


def phases_of(log):
    """The phases in a log, in order, and none of it left there."""
    found = [phase for phase, *_ in log]
    log.clear()
    return found


def check_exact(arbiter):
    """Normal and points are those of the shapes where they are, in the order of arbiter.shapes."""
    first, second = arbiter.shapes
    found = arbiter.contact_point_set
    flip = not isinstance(first, Ellipse)
    exact = second.shapes_collide(first) if flip else first.shapes_collide(second)
    (point,), (expected,) = found.points, exact.points
    assert point.distance == pytest.approx(expected.distance, abs=1e-9)
    sign = -1 if flip else 1
    assert arbiter.normal == found.normal
    assert (sign * found.normal).get_distance(exact.normal) < 1e-5
    one, two = point.point_a, point.point_b
    if flip:
        one, two = two, one
    assert one.get_distance(expected.point_a) < 1e-4
    assert two.get_distance(expected.point_b) < 1e-4


def hulls_apart_from_ellipses():
    """Places of an ellipse 20 x 10 beside one at the origin, not touching, where their hulls overlap."""
    places = []
    for i in range(100):
        n = pymunk.Vec2d(cos(i), sin(i))
        h = sqrt((20 * n.x) ** 2 + (10 * n.y) ** 2)
        point = pymunk.Vec2d(400 * n.x / h, 100 * n.y / h)
        place = 2 * point + 0.01 * n
        bodies = pymunk.Body(), pymunk.Body()
        bodies[1].position = place
        one, two = (Ellipse(body, 20, 10) for body in bodies)
        one.cache_bb()
        two.cache_bb()
        if pymunk.Shape.shapes_collide(one, two).points:
            assert not one.shapes_collide(two).points
            places.append((place, n))
    assert len(places) > 10
    return places


def pair_between_touches(which=0):
    """A space, its two ellipses, and two functions that make them touch and part while their hulls overlap."""
    space = still(Space())
    place, normal = hulls_apart_from_ellipses()[which]
    one = Ellipse(body_at(space), 20, 10)
    other = Ellipse(body_at(space), 20, 10)
    one.collision_type, other.collision_type = 1, 2
    space.add(one, other)

    def touch():
        put(one.body, (0, 0))
        put(other.body, place - 0.02 * normal)
        space.step(0.01)

    def part():
        put(one.body, (0, 0))
        put(other.body, place)
        space.step(0.01)

    return space, one, other, touch, part


def far_away(space, other):
    for shape in space.shapes:
        put(shape.body, (0, 0))
    put(other.body, (100, 0))
    space.step(0.01)


TOUCH = ["begin", "pre_solve", "post_solve"]


def rank(key):
    """How specific a key is; the order among equals is up to which shape pymunk has first."""
    return (key[0] is None) + (key[1] is None)


def as_circle(body, radius):
    return pymunk.Circle(body, radius)


def as_ellipse(body, radius):
    return Ellipse(body, radius, radius, angle=0.7)


def circles_between_touches():
    """pair_between_touches with pymunk's circles, for what pymunk does."""
    space = still(pymunk.Space())
    bodies = body_at(space), body_at(space)
    one, other = (pymunk.Circle(body, 10) for body in bodies)
    one.collision_type, other.collision_type = 1, 2
    space.add(one, other)

    def go(distance):
        put(bodies[0], (0, 0))
        put(bodies[1], (distance, 0))
        space.step(0.01)

    return space, one, other, lambda: go(19.9), lambda: go(20.1)
