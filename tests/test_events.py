"""Collision callbacks of a space with exact events, against truth from geometry and against pymunk's own with circles."""

import copy
import itertools
import pickle
import random
import sys
from collections import Counter
from math import cos, pi, sin, sqrt
from typing import NamedTuple

import pymunk
import pytest
from scenes import (
    FLOOR,
    add_body,
    add_ellipse,
    add_floor,
    calls_of_wildcard,
    data_in_a_copy,
)

import pymunk_ellipse
from pymunk_ellipse import Ellipse
from pymunk_ellipse.contacts.events import EventSpace

Space = getattr(pymunk_ellipse, "Space", EventSpace)

PHASES = ("begin", "pre_solve", "post_solve", "separate")
KEYS = [(None, None), (1, None), (2, None), (1, 1), (1, 2), (2, 1), (2, 2)]

# What pymunk loses in a copy.
LOST = pytest.mark.xfail(
    not data_in_a_copy(),
    strict=True,
    reason="where pymunk does not copy the data of handlers, one pair of a copy begins again",
)

WAYS = [
    pytest.param(lambda space: space.copy(), id="copy"),
    pytest.param(copy.deepcopy, id="deepcopy"),
    pytest.param(lambda space: pickle.loads(pickle.dumps(space)), id="pickle"),
]


pytestmark = pytest.mark.usefixtures("backend")


@pytest.fixture(autouse=True)
def mistakes(monkeypatch):
    """What callbacks raise, which pymunk reports but does not pass on; none but what a test expects and clears."""
    reports = []
    monkeypatch.setattr(
        sys, "unraisablehook", lambda report: reports.append(report.exc_value)
    )
    yield reports
    for mistake in reports:
        raise mistake


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


# Against geometry


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


# Against pymunk's circles


class Event(NamedTuple):
    """One call of a callback, with what the user can read there."""

    step: int
    phase: str
    key: tuple
    pair: tuple
    first: bool
    removal: bool
    processed: bool
    numbers: tuple


class Play:
    """Circles, segments and polygons that are moved by a script, and callbacks that interfere.

    Every choice follows from the seed and the names of shapes, not from the order of calls.
    """

    def __init__(self, seed, space, make, policy, keys):
        self.random = random.Random(seed)
        self.space = still(space)
        self.policy = policy
        self.step = -1
        self.over = False
        self.log = []
        self.names = {}
        self.shapes = []
        self.away = {}
        for i in range(10):
            fixed = {3: pymunk.Body.STATIC, 6: pymunk.Body.KINEMATIC}
            fixed[8] = pymunk.Body.KINEMATIC
            body = body_at(space, kind=fixed.get(i, pymunk.Body.DYNAMIC))
            put(body, (self.random.uniform(-14, 14), self.random.uniform(-14, 14)))
            if i == 3:
                shape = pymunk.Segment(body, (-30, -4), (30, 2), 0.5)
            elif i == 4:
                shape = pymunk.Poly.create_box(body, (9, 7), 0.4)
            elif i == 5:
                shape = pymunk.Circle(body, 3)
            else:
                shape = make(body, self.random.uniform(2, 6))
            shape.collision_type = self.random.choice((1, 2, 3))
            shape.sensor = i in (2, 8)
            shape.friction = 0.1 * i
            shape.elasticity = 0.05 * i
            self.names[shape] = i
            self.shapes.append(shape)
            space.add(shape)
        for key in keys:
            self.listen(key)

    def listen(self, key):
        for phase in PHASES:
            self.space.on_collision(*key, **{phase: self.callback(phase, key)})

    def callback(self, phase, key):
        def note(arbiter, space, data):
            # pymunk removes the shapes of a space that is collected.
            if not self.over:
                self.log.append(self.event(phase, key, arbiter))
                self.interfere(phase, key, arbiter)

        return note

    def event(self, phase, key, arbiter):
        """The event with its shapes in the order of the key; where that says nothing, in that of their names."""
        first, second = pair = tuple(self.names[shape] for shape in arbiter.shapes)
        normal = arbiter.normal
        points = []
        # pymunk has no contact point set for two that part.
        if phase != "separate":
            contact = arbiter.contact_point_set
            points = [(*p.point_a, *p.point_b, p.distance) for p in contact.points]
            assert normal == contact.normal
        types = [shape.collision_type for shape in arbiter.shapes]
        # pymunk does not sort the shapes for calls that come from a removal.
        unsorted = key[0] is None or types[0] == types[1] or arbiter.is_removal
        if unsorted and first > second:
            pair = second, first
            normal = -normal
            points = [(*p[2:4], *p[:2], p[4]) for p in points]
        numbers = (*normal, *itertools.chain(*points)) if phase != "separate" else ()
        return Event(
            self.step,
            phase,
            key,
            pair,
            arbiter.is_first_contact,
            arbiter.is_removal,
            arbiter.process_collision,
            (*numbers, arbiter.friction, arbiter.restitution),
        )

    def interfere(self, phase, key, arbiter):
        one, two = sorted(arbiter.shapes, key=self.names.get)
        number = 7 * self.names[one] + 3 * self.names[two]
        now = number + self.step
        if self.policy == "off in begin" and phase == "begin":
            arbiter.process_collision = number % 2 == 0
        if self.policy == "off in pre_solve" and phase == "pre_solve":
            if now % 3 == 0:
                arbiter.process_collision = False
            if now % 3 == 1:
                arbiter.process_collision = True
        if self.policy == "off in separate" and phase == "separate":
            arbiter.process_collision = False
        if self.policy == f"remove in {phase}" and now % 5 == 0:
            for shape in (one, two)[: 1 + number % 2]:
                if shape.space is not None:
                    self.away.setdefault(shape, self.step + 4)
                    self.space.remove(shape)
        if self.policy == "errors" and (now + len(phase)) % 3 == 0:
            raise RuntimeError(phase)

    def run(self, steps):
        for self.step in range(steps):
            for shape in self.shapes:
                body = shape.body
                if body.body_type != pymunk.Body.STATIC:
                    x, y = body.position
                    size = self.random.choice((0.2, 0.5, 4.0))
                    x += self.random.uniform(-size, size) - 0.05 * x
                    y += self.random.uniform(-size, size) - 0.05 * y
                    put(body, (x, y), self.random.uniform(-3, 3))
            for shape, until in list(self.away.items()):
                if self.step > until:
                    del self.away[shape]
                    self.space.add(shape)
            self.act()
            self.space.step(0.01)
        self.over = True
        return self.log

    def act(self):
        """What the policy does between two steps."""
        if self.policy == "remove between steps" and self.step % 4 == 0:
            shape = self.shapes[self.step // 4 % len(self.shapes)]
            if shape.space is not None:
                self.away[shape] = self.step + 3
                self.space.remove(shape)
        if self.policy == "come and go":
            key = KEYS[self.step % len(KEYS)]
            phase = PHASES[self.step // 3 % 4]
            self.space.on_collision(*key, **{phase: pymunk.empty_callback})
            key = KEYS[(3 * self.step + 1) % len(KEYS)]
            phase = PHASES[self.step // 2 % 4]
            self.space.on_collision(*key, **{phase: self.callback(phase, key)})
        if self.policy == "toggle sensors" and self.step % 3 == 0:
            shape = self.shapes[self.step % len(self.shapes)]
            shape.sensor = not shape.sensor


def rank(key):
    """How specific a key is; the order among equals is up to which shape pymunk has first."""
    return (key[0] is None) + (key[1] is None)


def by_pair(log):
    """A log as one list of events for each step and pair: the order of pairs is up to the broad phase."""
    found = {}
    for event in log:
        found.setdefault((event.step, *sorted(event.pair)), []).append(event)
    result = {}
    for which, events in found.items():
        result[which] = []
        for _, group in itertools.groupby(events, lambda e: (e.phase, rank(e.key))):
            group = list(group)
            # What one sets the next finds.
            flags = [event.processed for event in group]
            group.sort(key=lambda event: str(event[:4]))
            result[which] += [
                event._replace(processed=flag)
                for event, flag in zip(group, flags, strict=True)
            ]
    return result


def as_circle(body, radius):
    return pymunk.Circle(body, radius)


def as_ellipse(body, radius):
    return Ellipse(body, radius, radius, angle=0.7)


POLICIES = [
    "nothing",
    "off in begin",
    "off in pre_solve",
    "off in separate",
    "remove in begin",
    "remove in pre_solve",
    "remove in post_solve",
    "remove in separate",
    "remove between steps",
    "errors",
    "come and go",
    "toggle sensors",
]
SOME_KEYS = [[(2, 1)], [(1, None), (2, None)], [(1, 2), (2, 2)]]


PLAYS = [
    *((policy, KEYS) for policy in POLICIES),
    *((policy, [(None, None)]) for policy in POLICIES[:-3]),
    ("toggle sensors", [(None, None)]),
    ("errors", [(None, None)]),
    *(("nothing", keys) for keys in SOME_KEYS),
]


@pytest.mark.parametrize(("policy", "keys"), PLAYS, ids=str)
def test_same_events_as_circles(policy, keys, mistakes):
    expected = by_pair(Play(1, pymunk.Space(), as_circle, policy, keys).run(60))
    found = by_pair(Play(1, Space(), as_ellipse, policy, keys).run(60))
    if policy == "errors":
        assert {type(mistake) for mistake in mistakes} == {RuntimeError}
        mistakes.clear()
    assert len(expected) > 30
    for which in sorted({*expected, *found}):
        one, two = expected.get(which, []), found.get(which, [])
        assert [e[:-1] for e in two] == [e[:-1] for e in one], which
        for a, b in zip(one, two, strict=True):
            assert b.numbers == pytest.approx(a.numbers, abs=1e-6), (a, b)


def test_pairs_without_an_ellipse_are_untouched():
    """To the last bit, with an ellipse somewhere in the same space."""

    def run(space):
        space.gravity = 0, -500
        log, separates = [], []
        add_floor(space, elasticity=0.5)
        names = {}
        for i in range(12):
            body = add_body(space, (7 * (i % 4), 10 + 9 * (i // 4)), 0.3 * i)
            body.mass, body.moment = 1, 20
            shape = (
                pymunk.Circle(body, 4),
                pymunk.Poly.create_box(body, (8, 6), 0.2),
                pymunk.Segment(body, (-3, 0), (3, 1), 2),
            )[i % 3]
            shape.elasticity = 0.4
            shape.collision_type = i % 2
            names[shape] = i
            space.add(shape)
        # In pymunk's own space the hull alone, for the broad phase to find pairs in the same order.
        distant = add_body(space, (5000, 0), mass=1, moment=1)
        egg = Ellipse(distant, 4, 2)
        if not isinstance(space, EventSpace):
            egg = pymunk.Poly(distant, egg.get_vertices(), radius=egg.radius)
        space.add(egg)

        def note(phase, key):
            def callback(arbiter, space, data):
                pair = tuple(names.get(shape) for shape in arbiter.shapes)
                event = phase, key, pair, arbiter.is_first_contact, arbiter.normal
                if phase == "separate":
                    # pymunk's own order of pairs follows from addresses here.
                    separates.append((steps, event))
                else:
                    points = arbiter.contact_point_set.points
                    log.append(
                        (*event, [(p.point_a, p.point_b, p.distance) for p in points])
                    )

            return callback

        for key in [(None, None), (0, None), (0, 1), (1, 0), (0, FLOOR)]:
            for phase in PHASES:
                space.on_collision(*key, **{phase: note(phase, key)})
        for steps in range(120):  # noqa: B007
            space.step(1 / 120)
        return log, Counter(separates)

    expected = run(pymunk.Space())
    assert {phase for phase, *_ in expected[0]} == set(PHASES[:3])
    assert len(expected[1]) > 20
    assert run(Space()) == expected


# Callbacks


def test_data():
    space, _one, _other, touch, part = pair_between_touches()
    data = {phase: object() for phase in PHASES}
    seen = []
    for phase in PHASES:
        space.on_collision(
            1,
            2,
            **{phase: lambda arbiter, where, datum: seen.append((where, datum))},
            data=data[phase],
        )
    touch()
    part()
    assert [where for where, _ in seen] == [space] * 4
    assert [datum for _, datum in seen] == [data[phase] for phase in PHASES]


def test_the_more_specific_is_called_first():
    space, _one, _other, touch, part = pair_between_touches()
    log = []
    listen(space, log, (None, None), (2, None), (1, None), (2, 1), (1, 2))
    touch()
    part()
    for phase in PHASES:
        keys = [key for called, key in log if called == phase]
        assert [rank(key) for key in keys] == [0, 0, 1, 1, 2]
        assert len(set(keys)) == 5


def test_replaced_and_removed_callbacks():
    space, _one, _other, touch, part = pair_between_touches()
    first, second = [], []
    listen(space, first)
    touch()
    assert phases_of(first) == TOUCH
    listen(space, second)
    touch()
    assert (phases_of(first), phases_of(second)) == ([], TOUCH[1:])
    space.on_collision(pre_solve=pymunk.empty_callback)
    touch()
    assert phases_of(second) == ["post_solve"]
    space.on_collision(separate=pymunk.empty_callback)
    part()
    touch()
    assert phases_of(second) == ["begin", "post_solve"]
    for phase in ("begin", "post_solve"):
        space.on_collision(**{phase: pymunk.empty_callback})
    part()
    touch()
    assert (first, second) == ([], [])


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


LEAVING = [
    pytest.param(lambda space, other, part: part(), id="by a little"),
    pytest.param(lambda space, other, part: far_away(space, other), id="far"),
    pytest.param(lambda space, other, part: space.remove(other), id="removed"),
]


@pytest.mark.parametrize("leave", LEAVING)
@pytest.mark.parametrize(
    ("heard", "again"),
    [(True, 0), (True, 1), (False, 1), (False, 0)],
)
@pytest.mark.parametrize("phases", [PHASES, ("separate",)], ids=str)
def test_callbacks_set_while_two_touch(phases, heard, again, leave):
    """They miss the begin, and hear of all that comes after."""
    logs = []
    for make in (circles_between_touches, pair_between_touches):
        space, _one, other, touch, part = make()
        log = []
        if heard:
            space.on_collision(1, 2, pre_solve=lambda *_: None)
        touch()
        touch()
        listen(space, log, phases=phases)
        for _ in range(again):
            touch()
        leave(space, other, part)
        logs.append(phases_of(log))
    expected, found = logs
    assert expected.count("separate") == 1
    assert found == expected


def test_callbacks_set_in_a_callback():
    logs = []
    for make in (circles_between_touches, pair_between_touches):
        space, _one, _other, touch, part = make()
        log = []

        def subscribe(arbiter, space, data, log=log):
            log.append(("subscribe", None))
            listen(space, log)

        space.on_collision(1, 2, begin=subscribe)
        touch()
        part()
        touch()
        logs.append(phases_of(log))
    # That of the same step may be too late for a begin, in both.
    assert [phase for phase in logs[0] if phase != "begin"] == [
        phase for phase in logs[1] if phase != "begin"
    ]
    assert logs[1].count("begin") in (1, 2)


@pytest.mark.parametrize("phase", PHASES)
def test_shapes_added_in_a_callback(phase):
    """A third ellipse enters where the first is, and its events begin in the next step."""
    space, one, _other, touch, part = pair_between_touches()
    added, log = [], []

    def add(arbiter, space, data):
        if not added:
            body = pymunk.Body(1, 1)
            body.position = one.body.position
            shape = Ellipse(body, 5, 3)
            shape.collision_type = 3
            added.append(shape)
            space.add(body, shape)

    space.on_collision(1, 2, **{phase: add})
    listen(space, log, (3, 1))
    touch()
    if phase == "separate":
        part()
    assert phases_of(log) == []
    touch()
    assert phases_of(log) == TOUCH
    space.remove(*added)
    assert phases_of(log) == ["separate"]


@pytest.mark.parametrize(
    ("phase", "key"),
    [
        *itertools.product(PHASES, [(1, 2), (2, None)]),
        *((phase, (None, None)) for phase in PHASES),
    ],
)
def test_errors_in_callbacks(phase, key, mistakes, monkeypatch, capfd):
    """Reported as pymunk does, and events go on as if nothing had happened."""
    # cffi's own report, which is what a user sees.
    monkeypatch.setattr(sys, "unraisablehook", sys.__unraisablehook__)
    heads, logs = [], []
    for make in (circles_between_touches, pair_between_touches):
        space, _one, other, touch, part = make()
        log = []

        def fail(arbiter, space, data, log=log):
            log.append((phase, key))
            raise RuntimeError("the user's mistake")

        listen(space, log, key)
        space.on_collision(*key, **{phase: fail})
        for move in (touch, touch, part, part, touch, part, touch):
            move()
        space.remove(other)
        for _ in range(5):
            space.step(0.01)
        space.add(other)
        touch()
        # Not when the space is collected.
        space.on_collision(*key, **{phase: pymunk.empty_callback})
        logs.append(log)
        lines = capfd.readouterr().err.splitlines()
        assert "RuntimeError: the user's mistake" in lines
        heads.append(
            [line.split(" at ")[0] for line in lines if "cffi callback" in line]
        )
    assert logs[0] == logs[1]
    assert heads[0] == heads[1]
    assert len(heads[0]) == sum(called == phase for called, _ in logs[0])


def test_process_collision_set_in_begin_lasts_until_the_two_part():
    space, one, other, touch, part = pair_between_touches()
    flags = []

    def begin(arbiter, space, data):
        arbiter.process_collision = False

    space.on_collision(
        begin=begin,
        pre_solve=lambda arbiter, *_: flags.append(arbiter.process_collision),
        post_solve=lambda *_: flags.append("solved"),
    )
    for _ in range(3):
        touch()
        touch()
        assert one.body.velocity == other.body.velocity == (0, 0)
    space.on_collision(begin=pymunk.empty_callback)
    touch()
    assert flags == [False] * 7
    part()
    touch()
    assert flags[7:] == [True, "solved"]


def test_process_collision_set_in_pre_solve():
    """It stays until it is set again."""
    space, _one, _other, touch, part = pair_between_touches()
    flags, wanted = [], []

    def pre_solve(arbiter, space, data):
        flags.append(arbiter.process_collision)
        if wanted:
            arbiter.process_collision = wanted.pop()

    space.on_collision(
        pre_solve=pre_solve, post_solve=lambda *_: flags.append("solved")
    )
    touch()
    wanted.append(False)
    touch()
    touch()
    assert flags == [True, "solved", True, False]
    wanted.append(True)
    touch()
    touch()
    assert flags[4:] == [False, "solved", True, "solved"]
    wanted.append(False)
    touch()
    part()
    touch()
    assert flags[8:] == [True, True, "solved"]


# Sleep


@pytest.mark.parametrize("leave", ["removed", "lifted"])
def test_a_touch_lasts_while_the_two_sleep(leave):
    logs = []
    for shape_of in (as_circle, as_ellipse, lambda body, r: Ellipse(body, 2 * r, r)):
        space = Space() if shape_of is not as_circle else pymunk.Space()
        space.gravity = 0, -100
        space.sleep_time_threshold = 0.2
        floor = add_floor(space)
        log = []
        listen(space, log, phases=("begin", "separate"))
        body = add_body(space, (0, 4.9), mass=1, moment=20)
        shape = shape_of(body, 5)
        shape.friction = 1
        sensor = pymunk.Circle(space.static_body, 3)
        sensor.sensor = True
        space.add(shape, sensor)
        for _ in range(200):
            space.step(0.01)
        assert body.is_sleeping
        assert phases_of(log) == ["begin", "begin"]
        body.activate()
        for _ in range(3):
            space.step(0.01)
        assert log == []
        for _ in range(200):
            space.step(0.01)
        assert body.is_sleeping
        if leave == "removed":
            space.remove(shape)
        else:
            body.position = 0, 30
            space.step(0.01)
        logs.append(phases_of(log))
        del floor
    assert logs == [["separate", "separate"]] * 3


# Copies


seen = []


def note_begin(arbiter, space, data):
    seen.append(("begin", data, arbiter.is_first_contact))


def note_pre_solve(arbiter, space, data):
    seen.append(("pre_solve", data, arbiter.is_first_contact))


def note_post_solve(arbiter, space, data):
    seen.append(("post_solve", data, arbiter.is_first_contact))


def note_separate(arbiter, space, data):
    seen.append(("separate", data, arbiter.is_first_contact))


NOTES = {
    "begin": note_begin,
    "pre_solve": note_pre_solve,
    "post_solve": note_post_solve,
    "separate": note_separate,
}


@LOST
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("key", [(None, None), (1, None), (1, 2), (2, 1)])
def test_copies_go_on_with_their_own_events(way, key):
    """The copy of two that touch has no second begin, but pre_solve, post_solve, one separate and what follows."""
    space, _one, _other, touch, part = pair_between_touches()
    for phase in PHASES:
        space.on_collision(*key, **{phase: NOTES[phase]}, data=phase)
    touch()
    touch()
    seen.clear()
    twin = way(space)
    assert type(twin) is Space
    assert seen == []
    one, other = twin.shapes
    place = other.body.position
    for moved, expected in (
        ((0, 0), ["pre_solve", "post_solve"]),
        ((0, 0), ["pre_solve", "post_solve"]),
        ((100, 0), ["separate"]),
        ((100, 0), []),
        ((0, 0), TOUCH),
    ):
        put(one.body, (0, 0))
        put(other.body, place + moved)
        twin.step(0.01)
        assert [phase for phase, *_ in seen] == expected
        assert all(data == phase for phase, data, _ in seen)
        assert [first for *_, first in seen] == ["begin" in expected] * len(expected)
        seen.clear()
    # The original has not noticed.
    touch()
    assert phases_of(seen) == TOUCH[1:]
    part()
    assert phases_of(seen) == ["separate"]


@LOST
@pytest.mark.parametrize("way", WAYS)
def test_copy_of_two_that_touch_ends_the_touch(way):
    """Also if they part, or one goes, before the copy has made a step with them touching."""
    for leave in ("part", "remove"):
        space, _one, _other, touch, part = pair_between_touches()
        space.on_collision(begin=note_begin, separate=note_separate)
        part()
        apart = [body.position for body in space.bodies]
        touch()
        twin = way(space)
        seen.clear()
        if leave == "remove":
            twin.remove(list(twin.shapes)[-1])
        else:
            for body, place in zip(twin.bodies, apart, strict=True):
                put(body, place)
            twin.step(0.01)
        assert phases_of(seen) == ["separate"]


# What it costs


def functions_called(function):
    """The code of all Python functions that run while a function does."""
    called = set()

    def note(frame, event, argument):
        if event == "call":
            called.add(frame.f_code.co_name)

    sys.setprofile(note)
    try:
        function()
    finally:
        sys.setprofile(None)
    return called


@pytest.mark.parametrize("was_heard", [False, True])
def test_without_callbacks_python_has_nothing_to_do(backend, was_heard):
    if backend == "python":
        pytest.skip("Python resolves contacts")
    space = Space()
    space.gravity = 0, -500
    add_floor(space)
    for i in range(5):
        add_ellipse(space, 6, 4, (i, 5 + 9 * i))
    if was_heard:
        log = []
        listen(space, log, (None, None), (0, None), (0, FLOOR))
        for _ in range(60):
            space.step(0.01)
        assert log
        for key in [(None, None), (0, None), (0, FLOOR)]:
            for phase in PHASES:
                space.on_collision(*key, **{phase: pymunk.empty_callback})
    for _ in range(60):
        space.step(0.01)

    def run():
        for _ in range(60):
            space.step(0.01)

    assert functions_called(run) <= {"run", "step", "add", "remove"}
    space.on_collision(pre_solve=lambda *_: None)
    assert "ext_cpCollisionPreSolveFunc" in functions_called(run)
