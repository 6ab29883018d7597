"""Floors: belts, joined segments and ends of segments."""

from itertools import pairwise
from math import inf, pi

import pymunk
import pytest
from pymunk import Vec2d
from scenes import add_body, add_ellipse, add_floor, make_space, settle

from pymunk_ellipse import Ellipse

pytestmark = pytest.mark.usefixtures("backend")


@pytest.mark.parametrize("carries", ["floor", "ellipse"])
def test_conveyor(carries):
    """As for a box: a belt takes along what lies on it."""
    speeds = []
    for make in (
        lambda body: Ellipse(body, 20, 10),
        lambda body: pymunk.Poly.create_box(body, (40, 20)),
    ):
        space = make_space((0, -100))
        floor = add_floor(space)
        body = add_body(space, (0, 10), 0, (0, 0), 0, 1, inf)
        shape = make(body)
        shape.friction = 1
        space.add(shape)
        (floor if carries == "floor" else shape).surface_velocity = 30, 0
        settle(space, 2)
        speeds.append(body.velocity.x)
    assert abs(speeds[1]) == pytest.approx(30, rel=0.01)
    assert speeds[0] == pytest.approx(speeds[1], rel=1e-3)


def test_conveyor_up_a_slope():
    """The belt's velocity is along the exact tangent, not the hull's."""
    space = make_space((0, -10))
    belt = pymunk.Segment(space.static_body, (-500, -150), (500, 150), 0)
    belt.friction = 2
    belt.surface_velocity = 30 * Vec2d(1, 0.3)
    space.add(belt)
    tilt = Vec2d(1, 0.3).angle
    body = add_body(space, 10 * Vec2d(-0.3, 1).normalized(), tilt, (0, 0), 0, 1, inf)
    egg = Ellipse(body, 20, 10)
    egg.friction = 1
    space.add(egg)
    settle(space, 2)
    along = 30 * Vec2d(1, 0.3)
    assert body.velocity == pytest.approx(along, abs=0.05) or (
        body.velocity == pytest.approx(-along, abs=0.05)
    )


def roll(joints, neighbors=True):
    """Path of an ellipse that rolls over a floor of joined segments, or of one."""
    space = make_space((0, -500))
    if joints is None:
        add_floor(space)
    else:
        for start, end in pairwise(joints):
            segment = pymunk.Segment(space.static_body, (start, 0), (end, 0), 0)
            segment.friction = 1
            if neighbors:
                segment.set_neighbors((2 * start - end, 0), (2 * end - start, 0))
            space.add(segment)
    egg = add_ellipse(space, 20, 16, (0, 19.9), pi / 2 - 0.1, (60, 0), -3, 1)
    path = []
    for _ in range(480):
        space.step(1 / 240)
        path.append((*egg.body.position, egg.body.angle))
    return path


def largest_difference(one, other):
    return max(
        abs(x - y)
        for a, b in zip(one, other, strict=True)
        for x, y in zip(a, b, strict=True)
    )


@pytest.mark.parametrize("length", [40.0, 15.0, 33.3])
def test_joined_segments_are_one_floor(length):
    joints = [-200 + length * i for i in range(round(800 / length))]
    one = roll(None)
    assert one[-1][0] > 60
    assert largest_difference(one, roll(joints)) < 0.01
    # Without neighbours each end is a bump.
    assert largest_difference(one, roll(joints, neighbors=False)) > 0.1


def test_joined_segments_are_one_floor_to_roundoff():
    joints = [-200 + 40 * i for i in range(20)]
    assert largest_difference(roll(None), roll(joints)) < 1e-6


def test_ends_without_neighbours_are_hit():
    """An ellipse slides against the end of a segment and stops."""
    space = make_space((0, -100))
    add_floor(space, friction=0)
    step = pymunk.Segment(space.static_body, (100, 8), (200, 8), 1)
    space.add(step)
    egg = add_ellipse(space, 20, 10, (0, 10), 0, (100, 0), friction=0)
    egg.body.moment = inf
    settle(space, 2)
    assert egg.body.velocity.x < 1
    assert egg.body.position.x < 100
