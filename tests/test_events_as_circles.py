"""Events of round ellipses in a long play with callbacks that interfere, against those of pymunk's circles."""

import itertools
import random
from collections import Counter
from functools import cache
from typing import NamedTuple

import pymunk
import pytest
from scenes import FLOOR, PHASES, add_body, add_floor
from touching import as_circle, as_ellipse, body_at, put, rank, still

from pymunk_ellipse import Ellipse, Space
from pymunk_ellipse.contacts.events import EventSpace

pytestmark = pytest.mark.usefixtures("backend", "mistakes")


KEYS = [(None, None), (1, None), (2, None), (1, 1), (1, 2), (2, 1), (2, 2)]


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


@cache
def events_of_circles(policy, keys):
    """The same for both backends."""
    return by_pair(Play(1, pymunk.Space(), as_circle, policy, keys).run(60))


@pytest.mark.parametrize(("policy", "keys"), PLAYS, ids=str)
def test_same_events_as_circles(policy, keys, mistakes):
    expected = events_of_circles(policy, tuple(keys))
    found = by_pair(Play(1, Space(), as_ellipse, policy, keys).run(60))
    if policy == "errors":
        assert {type(mistake) for mistake in mistakes} == {RuntimeError}
        mistakes.clear()
    assert len(expected) > 30
    for which in sorted({*expected, *found}):
        one, two = expected.get(which, []), found.get(which, [])
        assert [e[:-1] for e in two] == [e[:-1] for e in one], which
        for a, b in zip(one, two, strict=True):
            pairs = zip(a.numbers, b.numbers, strict=True)
            assert all(abs(x - y) <= 1e-6 for x, y in pairs), (a, b)


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
