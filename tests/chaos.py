"""Random operations on spaces with ellipses, to be run in a process of its own; prints what was done and what went wrong.

    python tests/chaos.py exact ellipse 1000 0

does 1000 operations in pymunk_ellipse.Space, from the seed 0 on; `plain` takes pymunk.Space, and
`circle` circles in the place of ellipses, to tell pymunk's own faults from this package's. The
environment variable PYMUNK_ELLIPSE_BACKEND chooses the backend.
"""

from __future__ import annotations

import copy
import faulthandler
import gc
import json
import pickle
import random
import sys
import weakref
from collections import Counter
from math import hypot, pi
from typing import Any

import pymunk

import pymunk_ellipse
from pymunk_ellipse import Ellipse
from pymunk_ellipse.contacts.handler import contact_handler

# Operations with one space; then another begins.
SCENE = 250
MOST_SHAPES = 16
SIZE = 60
TYPES = 4
PHASES = ("begin", "pre_solve", "post_solve", "separate")
KEYS: list[tuple[int | None, int | None]] = [(0, None), (1, 2), (2, 1), (3, 3)]
ALL = pymunk.ShapeFilter()


# Chipmunk aborts or hangs sooner or later after a body has been put to sleep that touches others.
SLEEP_ANYWHERE = False


def touches(body: pymunk.Body) -> bool:
    seen: list[pymunk.Arbiter] = []
    body.each_arbiter(seen.append)
    return bool(seen) or bool(body.constraints)


class Mischief(Exception):
    """What callbacks raise."""


class Chaos:
    """One space, and what its user knows of it."""

    def __init__(self, seed: int, exact: bool, ellipses: bool, done: Counter) -> None:
        self.random = random.Random(seed)
        self.ellipses = ellipses
        self.done = done
        self.faults: list[str] = []
        self.touching: set[frozenset[int]] = set()
        # Shapes that came with a copy: which of them touched is for pymunk to know.
        self.heirs: set[int] = set()
        self.seen: list[weakref.ref] = []
        self.raising = False
        self.meddling = False
        self.stepping = False
        # In the callbacks of a step, which take effect at its end.
        self.leaving: set[pymunk.Shape] = set()
        self.added = 0
        make = pymunk_ellipse.Space if exact else pymunk.Space
        self.exact = exact
        self.space = make(threaded=seed % 4 == 3)
        self.space.gravity = 0, -300
        self.space.damping = 0.7
        self.space.sleep_time_threshold = 0.2
        self.seen.append(weakref.ref(self.space))
        for ends in (((-SIZE, 0), (SIZE, 0)), ((-SIZE, 0), (-SIZE, SIZE))):
            wall = pymunk.Segment(self.space.static_body, *ends, 1)
            wall.friction = 1
            self.space.add(wall)
        self.listen()

    # What is checked.

    def listen(self) -> None:
        self.space.on_collision(
            begin=self.begin,
            pre_solve=self.pre_solve,
            post_solve=self.post_solve,
            separate=self.separate,
        )

    def pair(self, arbiter: pymunk.Arbiter) -> frozenset[int]:
        return frozenset(map(id, arbiter.shapes))

    def expect_begun(self, arbiter: pymunk.Arbiter, phase: str) -> None:
        pair = self.pair(arbiter)
        if pair not in self.touching:
            if not pair <= self.heirs:
                self.faults.append(f"{phase} of a pair that has not begun")
            self.touching.add(pair)

    def begin(self, arbiter: pymunk.Arbiter, space: pymunk.Space, data: Any) -> None:
        pair = self.pair(arbiter)
        if pair in self.touching and not pair <= self.heirs:
            self.faults.append("begin of a pair that has begun")
        self.touching.add(pair)
        self.meddle(arbiter)

    def pre_solve(
        self, arbiter: pymunk.Arbiter, space: pymunk.Space, data: Any
    ) -> None:
        self.expect_begun(arbiter, "pre_solve")
        self.meddle(arbiter)

    def separate(self, arbiter: pymunk.Arbiter, space: pymunk.Space, data: Any) -> None:
        self.expect_begun(arbiter, "separate")
        self.touching.discard(self.pair(arbiter))
        self.meddle(arbiter)

    def post_solve(
        self, arbiter: pymunk.Arbiter, space: pymunk.Space, data: Any
    ) -> None:
        self.expect_begun(arbiter, "post_solve")
        shapes = arbiter.shapes
        if any(isinstance(shape, Ellipse) for shape in shapes):
            self.check_contact(arbiter, *shapes)
        self.meddle(arbiter)

    def check_contact(
        self, arbiter: pymunk.Arbiter, one: pymunk.Shape, other: pymunk.Shape
    ) -> None:
        found = arbiter.contact_point_set
        sign = 1
        if not isinstance(one, Ellipse):
            one, other, sign = other, one, -1
        expected = one.shapes_collide(other)
        if not len(found.points) == len(expected.points) == 1:
            # Roundoff decides at a distance of zero.
            if len(found.points) != 1 or found.points[0].distance < -1e-9:
                self.faults.append(f"a contact of {found} instead of {expected}")
            return
        self.done["contacts"] += 1
        distance = expected.points[0].distance
        axes = [sorted((s.a, s.b)) for s in (one, other) if isinstance(s, Ellipse)]
        # In deeper overlaps two normals may be as good.
        shallow = -distance < min(b * b / a for b, a in axes) / 2
        if abs(found.points[0].distance - distance) > 1e-5 * min(axes)[0]:
            self.faults.append(f"a depth of {found} instead of {expected}")
        if shallow and (found.normal * sign - expected.normal).length > 1e-4:
            self.faults.append(f"a normal of {found} instead of {expected}")

    def check_space(self) -> None:
        """What the package keeps for the space is what is in it."""
        handler = contact_handler(self.space)
        if handler is None:
            return
        ellipses = [s for s in self.space.shapes if isinstance(s, Ellipse)]
        if handler.ellipses != len(ellipses):
            self.faults.append("the handler's ellipses are not the space's")
        touching = getattr(getattr(handler, "touches", None), "touching", ())
        known = set(self.space._get_arbiters())
        if not set(touching) <= known:
            self.faults.append("a touch of an arbiter that is gone")

    def meddle(self, arbiter: pymunk.Arbiter) -> None:
        """What callbacks do besides."""
        if self.meddling and self.stepping:
            chance = self.random.random()
            shape = self.random.choice(arbiter.shapes)
            if chance < 0.02 and shape.body is not self.space.static_body:
                if shape not in self.leaving:
                    self.leaving.add(shape)
                    self.space.remove(shape)
            elif chance < 0.04 and len(self.space.shapes) + self.added < MOST_SHAPES:
                self.added += 1
                self.space.add(self.shape_for(arbiter.shapes[0].body))
            elif chance < 0.07:
                arbiter.process_collision = False
            elif chance < 0.1:
                self.space.add_post_step_callback(lambda *_: None, arbiter)
            elif chance < 0.12:
                gc.collect()
            elif chance < 0.2:
                self.space.point_query(self.place(), 30, ALL)
        if self.raising and self.random.random() < 0.1:
            raise Mischief

    # What is done.

    def place(self) -> tuple[float, float]:
        return self.random.uniform(-SIZE, SIZE), self.random.uniform(0, SIZE)

    def any_body(self, *kinds: int) -> pymunk.Body | None:
        bodies = [b for b in self.space.bodies if not kinds or b.body_type in kinds]
        return self.random.choice(bodies) if bodies else None

    def any_shape(self) -> pymunk.Shape | None:
        shapes = [s for s in self.space.shapes if s.body is not self.space.static_body]
        return self.random.choice(shapes) if shapes else None

    def shape_for(self, body: pymunk.Body | None) -> pymunk.Shape:
        rng = self.random
        kind = rng.choice(["ellipse"] * 5 + ["circle", "box", "segment"])
        offset = rng.choice([(0, 0), (rng.uniform(-9, 9), rng.uniform(-9, 9))])
        shape: pymunk.Shape
        if kind == "ellipse" and self.ellipses:
            a = rng.uniform(3, 15)
            b = a / rng.choice([1, rng.uniform(1, 3), rng.uniform(1, 50)])
            shape = Ellipse(body, a, b, offset, rng.uniform(-pi, pi))
        elif kind in ("ellipse", "circle"):
            shape = pymunk.Circle(body, rng.uniform(2, 8), offset)
        elif kind == "box":
            shape = pymunk.Poly.create_box(
                body, (rng.uniform(3, 12), rng.uniform(3, 12)), rng.choice([0, 1])
            )
        else:
            shape = pymunk.Segment(body, offset, (9, 3), rng.choice([0, 2]))
        shape.friction = rng.uniform(0, 1)
        shape.elasticity = rng.choice([0, 0, 0.5])
        shape.collision_type = rng.randrange(TYPES)
        shape.sensor = rng.random() < 0.1
        if rng.random() < 0.5:
            shape.density = rng.uniform(0.1, 2)
        self.seen.append(weakref.ref(shape))
        return shape

    def wake(self) -> None:
        """Contacts of those that sleep are kept as they are, so what they touch must not change."""
        for body in self.space.bodies:
            if body.is_sleeping:
                body.activate()

    def settle(self, space: pymunk.Space) -> None:
        """Keep pymunk from bodies that it cannot step: without mass, or lost in space."""
        for body in space.bodies:
            if body.body_type == pymunk.Body.DYNAMIC:
                if not 1e-9 < body.mass < 1e9:
                    body.mass = 1
                if not 1e-9 < body.moment < 1e12:
                    body.moment = 50
            x, y = body.position
            if not hypot(x, y) < 1000:
                body.position = self.place()
            if not body.velocity.length < 2000:
                body.velocity = 0, 0
            if not abs(body.angular_velocity) < 100:
                body.angular_velocity = 0

    def add_body(self) -> None:
        if len(self.space.shapes) > MOST_SHAPES:
            return self.remove_body()
        kind = self.random.choice([pymunk.Body.DYNAMIC] * 6 + [pymunk.Body.KINEMATIC])
        body = pymunk.Body(1, 50, kind)
        body.position, body.angle = self.place(), self.random.uniform(-pi, pi)
        self.seen.append(weakref.ref(body))
        shapes = [self.shape_for(body) for _ in range(self.random.choice([1, 1, 1, 3]))]
        self.space.add(body, *shapes)
        if kind == pymunk.Body.KINEMATIC:
            body.velocity = self.random.uniform(-9, 9), 0
        return None

    def remove_body(self) -> None:
        body = self.any_body()
        if body is not None:
            self.wake()
            # A body knows of joints that have left the space, too.
            joints = [c for c in self.space.constraints if body in (c.a, c.b)]
            shapes = [s for s in self.space.shapes if s.body is body]
            self.space.remove(*shapes, *joints)
            self.space.remove(body)

    def add_shape(self) -> None:
        if len(self.space.shapes) <= MOST_SHAPES:
            self.space.add(self.shape_for(self.any_body() or self.space.static_body))

    def remove_shape(self) -> None:
        shape = self.any_shape()
        if shape is not None:
            self.space.remove(shape)

    def reparent(self) -> None:
        shape, body = self.any_shape(), self.any_body()
        if shape is not None and body is not None:
            self.space.remove(shape)
            if self.random.random() < 0.3:
                shape.body = None
            shape.body = body
            self.space.add(shape)

    def leave_and_return(self) -> None:
        shape = self.any_shape()
        if shape is not None:
            self.space.remove(shape)
            if self.random.random() < 0.5:
                self.step()
            if shape.body is not None and shape.body.space is self.space:
                self.space.add(shape)

    def change(self) -> None:
        shape = self.any_shape()
        if shape is None:
            return
        rng = self.random
        which = rng.randrange(8)
        if which == 0:
            shape.sensor = not shape.sensor
        elif which == 1:
            shape.friction, shape.elasticity = rng.random(), rng.random()
        elif which == 2:
            shape.surface_velocity = rng.uniform(-30, 30), rng.uniform(-9, 9)
        elif which == 3:
            shape.filter = pymunk.ShapeFilter(group=rng.choice([0, 0, 1]))
        elif which == 4:
            shape.collision_type = rng.randrange(TYPES)
        elif which == 5:
            shape.mass = rng.choice([0, 1, 5])
        elif which == 6:
            shape.filter = pymunk.ShapeFilter(mask=rng.choice([0, 0xFFFFFFFF]))
        else:
            self.space.reindex_shape(shape)

    def reshape(self) -> None:
        shape = self.any_shape()
        rng = self.random
        self.wake()
        if isinstance(shape, Ellipse):
            which = rng.randrange(3)
            if which == 0:
                shape.unsafe_set_semi_axes(rng.uniform(2, 12), rng.uniform(2, 12))
            elif which == 1:
                shape.unsafe_set_offset((rng.uniform(-9, 9), rng.uniform(-9, 9)))
            else:
                shape.unsafe_set_angle(rng.uniform(-9, 9))
        elif isinstance(shape, pymunk.Circle):
            shape.unsafe_set_radius(rng.uniform(2, 8))
        elif isinstance(shape, pymunk.Segment):
            shape.unsafe_set_endpoints((0, 0), (rng.uniform(2, 9), 3))
        if shape is not None:
            self.space.reindex_shape(shape)

    def move(self) -> None:
        body = self.any_body()
        if body is None:
            return
        rng = self.random
        self.wake()
        body.position = self.place()
        body.angle = rng.uniform(-9, 9)
        body.velocity = rng.uniform(-300, 300), rng.uniform(-300, 300)
        body.angular_velocity = rng.uniform(-20, 20)
        if rng.random() < 0.5:
            self.space.reindex_shapes_for_body(body)

    def turn_kinematic_or_back(self) -> None:
        body = self.any_body()
        # A joint needs a dynamic body.
        if body is None or body.constraints:
            return
        self.wake()
        if body.body_type == pymunk.Body.DYNAMIC:
            body.body_type = pymunk.Body.KINEMATIC
        else:
            body.body_type = pymunk.Body.DYNAMIC

    def sleep_or_wake(self) -> None:
        body = self.any_body(pymunk.Body.DYNAMIC)
        if body is None:
            return
        if body.is_sleeping:
            body.activate()
        elif SLEEP_ANYWHERE or not touches(body):
            body.sleep()

    def join(self) -> None:
        one, other = self.any_body(pymunk.Body.DYNAMIC), self.any_body()
        if one is None or other is None or one is other:
            return
        self.wake()
        joint: pymunk.Constraint = self.random.choice(
            [
                lambda: pymunk.PivotJoint(one, other, one.position),
                lambda: pymunk.PinJoint(one, other, (1, 0), (0, 1)),
                lambda: pymunk.DampedSpring(one, other, (0, 0), (0, 0), 20, 20, 2),
                lambda: pymunk.SimpleMotor(one, other, 2),
            ]
        )()
        joint.max_force = 1e5
        joint.collide_bodies = self.random.random() < 0.5
        self.space.add(joint)

    def part(self) -> None:
        joints = list(self.space.constraints)
        if joints:
            self.wake()
            self.space.remove(self.random.choice(joints))

    def replace_by_copy(self) -> None:
        ways = (
            lambda space: space.copy(),
            copy.deepcopy,
            lambda space: pickle.loads(pickle.dumps(space)),
        )
        self.settle(self.space)
        old = self.space
        nothing = dict.fromkeys(PHASES, pymunk.empty_callback)
        for key in [(None, None), *KEYS]:
            # Bound methods would take all of this object along.
            old.on_collision(*key, **nothing)
        twin = self.random.choice(ways)(old)
        self.settle(twin)
        numbers = {id(shape): i for i, shape in enumerate(old.shapes)}
        shapes = list(twin.shapes)
        self.seen += map(weakref.ref, (twin, *twin.shapes, *twin.bodies))
        if self.random.random() < 0.3:
            # The copy is dropped.
            twin.step(0.01)
        else:
            self.touching = {
                frozenset(id(shapes[numbers[i]]) for i in pair)
                for pair in self.touching
            }
            self.space = twin
            old.step(0.01)
        self.heirs = set(map(id, self.space.shapes))
        self.listen()

    def callbacks(self) -> None:
        rng = self.random
        wanted = {
            phase: rng.choice([pymunk.empty_callback, self.noise]) for phase in PHASES
        }
        self.space.on_collision(*rng.choice(KEYS), **wanted)

    def noise(self, arbiter: pymunk.Arbiter, space: pymunk.Space, data: Any) -> None:
        self.meddle(arbiter)

    def raise_or_stop(self) -> None:
        self.raising = not self.raising

    def meddle_or_stop(self) -> None:
        self.meddling = not self.meddling

    def collect(self) -> None:
        gc.collect()

    def query(self) -> None:
        space, shape = self.space, self.any_shape()
        space.point_query(self.place(), 20, ALL)
        space.point_query_nearest(self.place(), 50, ALL)
        space.segment_query(self.place(), self.place(), 1, ALL)
        space.segment_query_first(self.place(), self.place(), 0, ALL)
        space.bb_query(pymunk.BB(-20, 0, 20, 20), ALL)
        if shape is not None:
            space.shape_query(shape)

    def step(self) -> None:
        for _ in range(self.random.choice([1, 2, 5, 10])):
            self.settle(self.space)
            self.stepping = True
            self.space.step(self.random.choice([1 / 60, 1 / 120, 1 / 240]))
            self.stepping = False
            self.leaving.clear()
            self.added = 0
            self.done["steps"] += 1
        # Those that are gone cannot touch, and their ids may be used again.
        ids = set(map(id, self.space.shapes))
        gone = {pair for pair in self.touching if not pair <= ids}
        if any(not pair <= self.heirs for pair in gone):
            self.faults.append("a pair without separate when a shape was removed")
        self.touching -= gone

    OPERATIONS = (
        [step] * 12
        + [add_body] * 5
        + [add_shape, remove_shape, remove_body, reparent, leave_and_return]
        + [change, change, reshape, move, turn_kinematic_or_back]
        + [sleep_or_wake, join, part, replace_by_copy, callbacks]
        + [raise_or_stop, meddle_or_stop, collect, query]
    )

    def run(self, count: int) -> None:
        for _ in range(count):
            operation = self.random.choice(self.OPERATIONS)
            ids = set(map(id, self.space.shapes))
            operation(self)
            # A shape that a removal has left alone separates at once; forget ids that may come back.
            left = ids - set(map(id, self.space.shapes))
            self.touching = {pair for pair in self.touching if not pair & left}
            self.heirs -= left
            self.done["operations"] += 1
            self.done[operation.__name__] += 1
            self.check_space()


def main() -> int:
    faulthandler.enable()
    which, kind, count, seed = sys.argv[1:]
    done: Counter = Counter()
    faults: Counter = Counter()
    for start in range(0, int(count), SCENE):
        number = int(seed) + start // SCENE
        chaos = Chaos(number, which == "exact", kind == "ellipse", done)
        chaos.run(min(SCENE, int(count) - start))
        faults.update(f"seed {number}: {fault}" for fault in chaos.faults)
        seen = chaos.seen
        del chaos
        gc.collect()
        alive = [reference() for reference in seen]
        done["objects"] += len(alive)
        alive = [thing for thing in alive if thing is not None]
        if alive:
            faults[f"seed {number}: {Counter(map(type, alive))} not collected"] += 1
    report = {
        "backend": pymunk_ellipse.backend(),
        "done": done,
        "faults": faults,
    }
    print(json.dumps(report, indent=1))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
