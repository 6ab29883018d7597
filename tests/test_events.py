"""When collision callbacks are called in a space with exact events, against truth from geometry."""

import itertools
import random
from collections import Counter
from math import cos, pi, sin, sqrt

import pymunk
import pytest
from scenes import PHASES, calls_of_wildcard
from touching import (
    TOUCH,
    body_at,
    check_exact,
    far_away,
    hulls_apart_from_ellipses,
    listen,
    pair_between_touches,
    phases_of,
    put,
    still,
)

from pymunk_ellipse import Ellipse, Space

pytestmark = pytest.mark.usefixtures("backend", "mistakes")


KEYS = [(None, None), (1, None), (2, None), (1, 1), (1, 2), (2, 1), (2, 2)]


class Wander:
    """Shapes of all kinds that are put somewhere near each other in every step."""

    def __init__(self, seed, space):
        self.random = random.Random(seed)
        self.space = still(space)
        self.shapes = []
        kinds = (
            pymunk.Body.DYNAMIC,
            pymunk.Body.DYNAMIC,
            pymunk.Body.KINEMATIC,
            pymunk.Body.DYNAMIC,
        )
        for i in range(12):
            kind = pymunk.Body.STATIC if i in (3, 9) else kinds[i % 4]
            body = body_at(space, self.somewhere(), self.random.uniform(0, 7), kind)
            shape = self.shape(i, body)
            shape.collision_type = self.random.choice((1, 2, 2, 3))
            shape.sensor = i in (2, 7)
            space.add(shape)
            self.shapes.append(shape)

    def somewhere(self):
        return self.random.uniform(-25, 25), self.random.uniform(-25, 25)

    def shape(self, i, body):
        if i == 8:
            return pymunk.Circle(body, 6)
        if i == 9:
            return pymunk.Segment(body, (-20, 0), (20, 0), 1)
        if i == 10:
            return pymunk.Poly.create_box(body, (12, 8), 0.5)
        if i == 11:
            return pymunk.Segment(body, (-6, 0), (6, 0), 2)
        return Ellipse(body, self.random.uniform(2, 12), self.random.uniform(1, 5))

    def move(self):
        """Near where they are, for pairs to part and touch anew while their hulls overlap."""
        for shape in self.shapes:
            body = shape.body
            if body.body_type != pymunk.Body.STATIC:
                x, y = body.position
                step = self.random.choice((0.3, 0.3, 1.0, 4.0))
                x += self.random.uniform(-step, step) - 0.02 * x
                y += self.random.uniform(-step, step) - 0.02 * y
                angle = body.angle + self.random.uniform(-0.1, 0.1) * step
                put(body, (x, y), angle)

    def pairs(self):
        """All pairs with an ellipse that can meet, the ellipse first."""
        for one, other in itertools.combinations(self.shapes, 2):
            types = {one.body.body_type, other.body.body_type}
            if isinstance(one, Ellipse) and types != {pymunk.Body.STATIC}:
                yield one, other

    def touching(self):
        return {
            (one, other)
            for one, other in self.pairs()
            if one.shapes_collide(other).points
        }


def calls_for(pair, key):
    """How often the callback of a key is called for a pair."""
    one, two = (shape.collision_type for shape in pair)
    a, b = key
    if a is None:
        return 1
    if b is None:
        return min((one == a) + (two == a), calls_of_wildcard())
    return int(key in ((one, two), (two, one)))


def solved(pair):
    """Whether pymunk resolves a contact, and calls post_solve for it."""
    fixed = [shape.body.body_type != pymunk.Body.DYNAMIC for shape in pair]
    return not all(fixed) and not any(shape.sensor for shape in pair)


@pytest.mark.parametrize(
    "keys",
    [
        [(None, None)],
        KEYS,
        [(1, None)],
        [(2, 1)],
        [(2, 2), (1, 2)],
    ],
    ids=str,
)
def test_events_are_those_of_the_ellipses(keys):
    """Every call of every callback in a long wander, sensors and bodies that do not give way included."""
    world = Wander(5, Space())
    log = []
    firsts = {}

    def note(phase, key):
        def callback(arbiter, space, data):
            assert data == (phase, key)
            first, second = arbiter.shapes
            if not any(isinstance(shape, Ellipse) for shape in (first, second)):
                return
            a, b = key
            # pymunk does not sort the shapes for calls that come from a removal.
            if a is not None and not arbiter.is_removal:
                assert first.collision_type == a
                assert b is None or second.collision_type == b
            pair = (first, second)
            if pair not in known:
                pair = (second, first)
            assert pair in known
            if phase != "separate":
                check_exact(arbiter)
                firsts[pair] = arbiter.is_first_contact
            else:
                assert not arbiter.is_first_contact
            log.append((phase, key, pair))

        return callback

    known = set(world.pairs())
    for key in keys:
        for phase in PHASES:
            world.space.on_collision(
                *key, **{phase: note(phase, key)}, data=(phase, key)
            )

    before = set()
    count = Counter()
    for _ in range(150):
        world.move()
        now = world.touching()
        log.clear()
        firsts.clear()
        world.space.step(0.01)
        expected = Counter()
        for phase, pairs in (
            ("begin", now - before),
            ("pre_solve", now),
            ("post_solve", set(filter(solved, now))),
            ("separate", before - now),
        ):
            for pair, key in itertools.product(pairs, keys):
                expected[phase, key, pair] = calls_for(pair, key)
        assert Counter(log) == +expected
        assert all(first == (pair not in before) for pair, first in firsts.items())
        count.update(phase for phase, *_ in log)
        before = now
    assert min(count[phase] for phase in PHASES) > 20


@pytest.mark.parametrize("sensor", [False, True])
def test_removing_ends_a_touch(sensor):
    """Every begin has one separate, with shapes that come and go between steps, and in the end all go."""
    world = Wander(8, Space())
    for shape in world.shapes:
        shape.sensor = shape.sensor or sensor
    touching = set()
    counts = Counter()

    def begin(arbiter, space, data):
        pair = frozenset(arbiter.shapes)
        assert pair not in touching
        touching.add(pair)
        counts["begin"] += 1

    def separate(arbiter, space, data):
        # Fails with a KeyError, which pymunk would swallow, where there was no begin.
        pair = frozenset(arbiter.shapes)
        counts["orphans"] += pair not in touching
        touching.discard(pair)
        counts["separate"] += 1
        counts["removed"] += arbiter.is_removal
        assert arbiter.is_removal == (None in [s.space for s in arbiter.shapes])

    world.space.on_collision(begin=begin, separate=separate)
    gone = []
    for i in range(200):
        world.move()
        world.space.step(0.01)
        in_space = {frozenset(pair) for pair in world.touching()}
        exact = {p for p in touching if any(isinstance(s, Ellipse) for s in p)}
        here = {p for p in in_space if all(s.space is not None for s in p)}
        assert exact == here
        if i % 7 == 0:
            shape = world.random.choice(world.shapes)
            if shape.space is not None:
                world.space.remove(shape)
                gone.append(shape)
                assert not any(shape in pair for pair in touching)
        if i % 7 == 4 and gone:
            world.space.add(gone.pop())
    world.space.remove(*world.space.shapes)
    assert not touching
    assert counts["orphans"] == 0
    assert counts["begin"] == counts["separate"] > 50
    assert counts["removed"] > 5


def angles_and_offsets():
    return [(0.0, 0.0), (0.0, 11.0), (pi / 2, 0.0), (0.3, 4.0), (1.2, -3.0)]


@pytest.mark.parametrize(("angle", "offset"), angles_and_offsets())
@pytest.mark.parametrize("sensor", [False, True])
def test_head_on_pass(angle, offset, sensor):
    """Two equal parallel ellipses pass through each other, and touch while one's centre is in an ellipse of twice the size."""
    a, b = 20, 10
    # Where the line y = offset enters that ellipse.
    c, s = cos(angle), sin(angle)
    p = (c / a) ** 2 + (s / b) ** 2
    q = offset * c * s * (1 / a**2 - 1 / b**2)
    r = offset**2 * ((s / a) ** 2 + (c / b) ** 2) - 4
    enters, leaves = ((-q - sign * sqrt(q * q - p * r)) / p for sign in (1, -1))

    space = still(Space())
    still_one = body_at(space, angle=angle)
    passing = body_at(space, angle=angle)
    one, two = Ellipse(still_one, a, b), Ellipse(passing, a, b)
    two.sensor = sensor
    space.add(one, two)
    log = []

    def ghost(arbiter, space, data):
        arbiter.process_collision = False

    listen(space, log)
    space.on_collision(0, 0, begin=ghost)
    speed = 0.217
    start = enters - 20.5 * speed
    steps = {}
    places = [start + i * speed for i in range(int((leaves - start) / speed) + 20)]
    for i, x in enumerate(places):
        put(passing, (x, offset))
        put(passing, (x, offset), angle)
        space.step(0.01)
        for phase in phases_of(log):
            steps.setdefault(phase, []).append(i)
    inside = [i for i, x in enumerate(places) if enters <= x <= leaves]
    assert steps == {
        "begin": inside[:1],
        "pre_solve": inside,
        "separate": [inside[-1] + 1],
    }


@pytest.mark.parametrize("sensor", [False, True])
def test_no_event_when_only_hulls_overlap(sensor):
    space = still(Space())
    log = []
    listen(space, log, (None, None), (0, None), (0, 0))
    one = Ellipse(body_at(space), 20, 10)
    other = Ellipse(body_at(space), 20, 10)
    other.sensor = sensor
    space.add(one, other)
    for place, _normal in hulls_apart_from_ellipses():
        put(one.body, (0, 0))
        put(other.body, place)
        space.step(0.01)
        assert one.body.velocity == other.body.velocity == (0, 0)
    # Neither when they go apart, nor when one is removed.
    put(other.body, (100, 0))
    for _ in range(5):
        space.step(0.01)
    put(other.body, place)
    space.step(0.01)
    space.remove(one)
    space.step(0.01)
    assert log == []


def test_touching_again_while_hulls_overlap():
    space, _one, _other, touch, part = pair_between_touches()
    log = []
    listen(space, log)
    for _ in range(3):
        touch()
        assert phases_of(log) == TOUCH
        touch()
        assert phases_of(log) == TOUCH[1:]
        part()
        assert phases_of(log) == ["separate"]
        part()
        assert phases_of(log) == []


@pytest.mark.parametrize("steps", [1, 2, 3, 4, 5])
def test_touching_again_after_some_steps(steps):
    """pymunk keeps an arbiter for collision_persistence steps after the shapes part."""
    space, one, other, touch, _part = pair_between_touches()
    log = []
    listen(space, log)
    for _ in range(3):
        touch()
        assert phases_of(log) == TOUCH
        for i in range(steps):
            put(other.body, (100, 0))
            put(one.body, (0, 0))
            space.step(0.01)
            assert phases_of(log) == ["separate"] * (i == 0)


@pytest.mark.parametrize(
    ("phase", "keys"),
    [
        *((phase, [(None, None)]) for phase in PHASES),
        *(
            (phase, keys)
            for phase in PHASES
            for keys in ([(1, None), (2, None)], [(1, 2), (2, 1)])
        ),
    ],
    ids=str,
)
def test_a_single_callback(phase, keys):
    """Called as if the others were there too, with the shapes in the order of the key."""
    for key in keys:
        space, one, other, touch, part = pair_between_touches()
        order = (one, other) if key[0] == 1 else (other, one)
        seen = []
        space.on_collision(
            *key,
            **{phase: lambda arbiter, *_, seen=seen: seen.append(arbiter.shapes)},
        )
        for move, expected in (
            (part, ()),
            (touch, TOUCH),
            (touch, TOUCH[1:]),
            (part, ["separate"]),
            (part, ()),
            (touch, TOUCH),
            (lambda space=space, other=other: far_away(space, other), ["separate"]),
            (lambda space=space, other=other: far_away(space, other), ()),
        ):
            move()
            assert len(seen) == (phase in expected)
            if seen and key[0] is not None:
                assert seen == [order]
            seen.clear()


def test_separate_has_the_normal_of_the_last_touch():
    """As in pymunk, where two that part have no new contact."""
    for which in range(10):
        space, _one, _other, touch, part = pair_between_touches(which)
        normals = []

        def note(arbiter, space, data, normals=normals):
            normals.append(arbiter.normal)

        space.on_collision(pre_solve=note, separate=note)
        touch()
        part()
        last, at_parting = normals
        assert at_parting.get_distance(last) < 1e-6
