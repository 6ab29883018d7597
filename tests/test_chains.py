"""Chains of joined segments, as pymunk.autogeometry makes them: nothing falls through, and an ellipse rolls as on one floor.

CHAINS=10 makes ten times as many starts, 640.
"""

import os
import random
from bisect import bisect
from math import atan2, cos, hypot, pi, sin

import pymunk
import pytest

from pymunk_ellipse import Ellipse

STARTS = 2 * int(os.environ.get("CHAINS", "1"))

GROUNDS = {
    "flat": lambda x: 0.0,
    "valley": lambda x: x * x / 400,
    "hill": lambda x: 30 * cos(x / 60),
}
HALF_WIDTH = 220
RING = 100


def add_chain(space, points, closed=False, friction=0.7):
    count = len(points)
    for i in range(count if closed else count - 1):
        start, end = points[i], points[(i + 1) % count]
        segment = pymunk.Segment(space.static_body, start, end, 0)
        segment.friction = friction
        if closed:
            segment.set_neighbors(points[i - 1], points[(i + 2) % count])
        else:
            segment.set_neighbors(points[max(i - 1, 0)], points[min(i + 2, count - 1)])
        space.add(segment)


def points_of(kind, length):
    if kind == "ring":
        count = max(8, round(2 * pi * RING / length))
        turns = [2 * pi * i / count for i in range(count)]
        return [(RING * cos(t), RING * sin(t)) for t in turns]
    ground = GROUNDS[kind]
    points = []
    x = -HALF_WIDTH
    while x < HALF_WIDTH:
        points.append((x, ground(x)))
        x += length / hypot(1, (ground(x + 1e-4) - ground(x)) / 1e-4)
    return points


def depth_below(points, closed, place):
    """How far a point is below the segment that is under it."""
    count = len(points)
    if closed:
        i = int(atan2(place.y, place.x) % (2 * pi) / (2 * pi / count)) % count
    else:
        i = min(max(bisect([x for x, _ in points], place.x) - 1, 0), count - 2)
    (x1, y1), (x2, y2) = points[i], points[(i + 1) % count]
    across = (x2 - x1) * (place.y - y1) - (y2 - y1) * (place.x - x1)
    return -across / hypot(x2 - x1, y2 - y1)


def depth(points, closed, body, a, b):
    return max(
        depth_below(points, closed, body.local_to_world((a * cos(t), b * sin(t))))
        for t in (pi * i / 24 for i in range(48))
    )


def thrown(kind, length, start):
    """Whether an ellipse that is thrown on a chain falls through, and how deep it lies in the end."""
    a, b, x, height, angle = start
    space = pymunk.Space()
    space.gravity = 0, -500
    points = points_of(kind, length * a)
    closed = kind == "ring"
    add_chain(space, points, closed)
    body = pymunk.Body(1, (a * a + b * b) / 4)
    body.angle = angle
    ground = -RING if closed else GROUNDS[kind](x)
    body.position = (0.3 * x if closed else x), ground + height
    shape = Ellipse(body, a, b)
    shape.friction = 0.7
    space.add(body, shape)
    deepest = speed = 0.0
    for i in range(300):
        space.step(1 / 60)
        if abs(body.position.x) > HALF_WIDTH - 2 * a:
            break
        if depth_below(points, closed, body.position) > 0:
            return True, deepest
        # What hits in a step is in as deep as it is fast, and takes a second to come out.
        speed = max(0.98 * speed, body.velocity.length)
        if i >= 270 and speed < 5:
            deepest = max(deepest, depth(points, closed, body, a, b))
    return False, deepest


@pytest.mark.parametrize("length", [0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 1, 2])
@pytest.mark.parametrize("kind", [*GROUNDS, "ring"])
def test_nothing_falls_through(backend, kind, length):
    if backend == "python" and length < 0.2:
        pytest.skip("the same code, and many segments take long in Python")
    rng = random.Random(f"{kind} {length}")
    for _ in range(STARTS):
        a, b = rng.choice([(20, 10), (20, 5), (15, 12), (30, 6)])
        x = rng.uniform(-60, 60)
        start = a, b, x, a + rng.uniform(2, 20), rng.uniform(0, 2 * pi)
        fell, deepest = thrown(kind, length, start)
        assert not fell
        # The collision slop is 0.1.
        assert deepest < 0.3


def rolled(length, spin, seconds=6.0):
    """Where an ellipse is that begins to roll on its end."""
    a, b = 20, 10
    space = pymunk.Space()
    space.gravity = 0, -500
    count = 1 if length is None else round(1000 / length)
    add_chain(space, [(-100 + 1000 * i / count, 0) for i in range(count + 1)], False, 1)
    body = pymunk.Body(1, (a * a + b * b) / 4)
    body.position = 0, a
    body.angle = pi / 2
    body.angular_velocity = -spin
    body.velocity = spin * a, 0
    shape = Ellipse(body, a, b)
    shape.friction = 1
    space.add(body, shape)
    for _ in range(round(seconds * 120)):
        space.step(1 / 120)
    return body.position.x


@pytest.mark.parametrize("spin", [0.5, 2.5, 4.0])
@pytest.mark.parametrize("length", [0.5, 1, 2, 4, 9, 40])
def test_an_ellipse_rolls_as_far_as_on_one_segment(length, spin):
    whole = rolled(None, spin)
    assert whole > 150
    assert rolled(length, spin) == pytest.approx(whole, rel=2e-3)


@pytest.mark.parametrize("length", [40, 8, 2])
def test_a_chain_holds_nothing_beyond_its_end(length):
    """An ellipse slides over the end, and tips over it as over that of one segment."""

    def slide(length):
        space = pymunk.Space()
        space.gravity = 0, -500
        count = round(200 / length)
        points = [(-200 + 200 * i / count, 0) for i in range(count + 1)]
        add_chain(space, points, False, 0.3)
        body = pymunk.Body(1, 125)
        body.position = -10, 9.95
        body.velocity = 30, 0
        shape = Ellipse(body, 20, 10)
        shape.friction = 0.3
        space.add(body, shape)
        path = []
        for _ in range(480):
            space.step(1 / 240)
            path.append((*body.position, body.angle))
        return path

    for expected, place in zip(slide(200), slide(length), strict=True):
        assert place == pytest.approx(expected, abs=0.02)


def falls_into(make, half_width, a, b, x, neighbors=True):
    """Whether a shape that falls into a V gets through it."""
    space = pymunk.Space()
    space.gravity = 0, -100
    left, corner, right = (-half_width, 50), (0, 0), (half_width, 50)
    for start, end in ((left, corner), (corner, right)):
        segment = pymunk.Segment(space.static_body, start, end, 0)
        segment.friction = 0.5
        if neighbors:
            segment.set_neighbors(left, right)
        space.add(segment)
    body = pymunk.Body()
    body.position = x, 70
    body.angle = 0.4
    shape = make(body, a, b)
    shape.mass = 1
    shape.friction = 0.5
    space.add(body, shape)
    for _ in range(900):
        space.step(1 / 240)
        if body.position.y < -1:
            return True
    return False


def polygon(body, a, b):
    turns = [pi * i / 16 for i in range(32)]
    return pymunk.Poly(body, [(a * cos(t), b * sin(t)) for t in turns])


@pytest.mark.parametrize("half_width", [20, 26, 35, 50, 70, 84])
def test_concave_corners_hold_as_those_of_a_polygon_do(half_width):
    """Angles of 44 to 120 degrees, where Chipmunk may report neither segment."""
    starts = [
        (half_width, a, b, x)
        for a, b in ((5, 0.5), (2, 1), (5, 1), (8, 3))
        for x in (0, 0.3, -1.7)
    ]
    fell = sum(falls_into(Ellipse, *start) for start in starts)
    assert fell <= sum(falls_into(polygon, *start) for start in starts)
    assert not any(falls_into(Ellipse, *start, neighbors=False) for start in starts)
