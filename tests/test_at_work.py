"""Both backends at work: the same contacts, with nothing stale and nothing left behind."""

import gc
import json
import os
import random
import sys
import threading
from math import cos, pi, sin
from pathlib import Path

import pymunk
import pytest
from processes import run_code
from scenes import (
    add_body,
    add_box,
    add_ellipse,
    add_floor,
    functions_called,
    make_space,
)

from pymunk_ellipse import Ellipse
from pymunk_ellipse.chipmunk.structs import address

PILE = """
import json
import pymunk, pymunk_ellipse
from scenes import crowded_pile
space = crowded_pile(pymunk.Space())
path = []
for _ in range(120):
    space.step(1 / 120)
    path.append([(*body.position, body.angle) for body in space.bodies])
print(json.dumps([pymunk_ellipse.backend(), path]))
"""


def test_a_pile_moves_alike_in_both_backends(built):
    paths = {}
    for choice in ("python", "compiled"):
        printed, _ = run_code(PILE, PYMUNK_ELLIPSE_BACKEND=choice)
        used, paths[choice] = json.loads(printed)
        assert used == choice
    start, end = paths["python"][0], paths["python"][-1]
    assert max(abs(a[1] - b[1]) for a, b in zip(start, end, strict=True)) > 50
    # To the last bit.
    assert paths["compiled"] == paths["python"]


# Python's part in it


def small_pile(**options):
    space = make_space((0, -500), **options)
    add_box(space, 20, 100)
    for i in range(8):
        add_ellipse(space, 6, 3, (12 * (i % 3) - 12, 5 + 8 * (i // 3)), 0.4 * i)
    return space


def steps(space, count, dt=1 / 120):
    for _ in range(count):
        space.step(dt)


def test_no_python_for_each_contact(backend):
    space = small_pile()
    steps(space, 60)
    called = functions_called(lambda: steps(space, 50))
    if backend == "compiled":
        assert set(called) <= {"<lambda>", "steps", "step", "add"}
    else:
        # Without pymunk's Arbiter.
        assert called["pre_solve"] > 300
        assert "ext_cpCollisionPreSolveFunc" not in called


def test_users_callbacks_are_chained(backend):
    space = small_pile()
    counts = {"pre_solve": 0, "post_solve": 0}

    def count(arbiter, space, data):
        if data == "post_solve":
            assert len(arbiter.contact_point_set.points) == 1
        counts[data] += 1

    for phase in counts:
        space.on_collision(**{phase: count}, data=phase)
    steps(space, 120)
    assert counts["post_solve"] > 300
    # It is called for hulls that overlap, too.
    assert counts["pre_solve"] >= counts["post_solve"]
    for phase in counts:
        space.on_collision(**{phase: pymunk.empty_callback})
    before = dict(counts)
    steps(space, 20)
    assert counts == before


# Nothing stale


def regular(count, radius):
    return [
        (radius * cos(2 * pi * i / count), 0.7 * radius * sin(2 * pi * i / count))
        for i in range(count)
    ]


class Traffic:
    """Shapes of every kind that come, change and go in a space, and a check of each contact."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        self.watch(make_space((0, -300)))
        add_box(self.space, 30, 200)
        self.checked = {}

    def watch(self, space):
        self.space = space
        space.on_collision(post_solve=self.check)

    def check(self, arbiter, space, data):
        one, two = arbiter.shapes
        if not isinstance(one, Ellipse):
            one, two = two, one
        found = arbiter.contact_point_set.points
        if isinstance(one, Ellipse):
            (exact,) = one.shapes_collide(two).points
            assert len(found) == 1
            assert found[0].distance == pytest.approx(exact.distance, abs=1e-9)
        else:
            # pymunk's own, whose shapes_collide may give distances the other sign.
            exact = sorted(abs(p.distance) for p in one.shapes_collide(two).points)
            depths = sorted(abs(p.distance) for p in found)
            assert depths == pytest.approx(exact, abs=1e-9)
        kinds = type(one), type(two)
        self.checked[kinds] = self.checked.get(kinds, 0) + 1

    def movable(self):
        return [s for s in self.space.shapes if s.body is not self.space.static_body]

    def some(self):
        return self.random.choice(self.movable())

    def shape(self, body):
        kind = self.random.randrange(7)
        size = self.random.uniform(2, 5)
        if kind < 3:
            return Ellipse(body, size, self.random.uniform(1, 6), (0.3, 0))
        if kind == 3:
            return pymunk.Circle(body, size)
        if kind == 4:
            return pymunk.Segment(
                body, (-size, 0), (size, 0), self.random.uniform(0.5, 2)
            )
        # As large a struct as an ellipse's, with its planes inside or not.
        count = 5 if kind == 5 else 9
        return pymunk.Poly(body, regular(count, 1.5 * size), radius=0.2)

    def enter(self):
        body = pymunk.Body()
        body.position = self.random.uniform(-22, 22), self.random.uniform(10, 60)
        body.angle = self.random.uniform(0, 6)
        shape = self.shape(body)
        shape.density = 1
        shape.friction = 0.5
        self.space.add(body, shape)

    def leave(self):
        shape = self.some()
        self.space.remove(shape, shape.body)

    def change(self):
        shape = self.some()
        size = self.random.uniform(2, 5)
        if isinstance(shape, Ellipse):
            change = self.random.randrange(3)
            if change == 0:
                shape.unsafe_set_semi_axes(size, self.random.uniform(1, 6))
            elif change == 1:
                shape.unsafe_set_offset((self.random.uniform(-1, 1), 0.5))
            else:
                shape.unsafe_set_angle(size)
        elif isinstance(shape, pymunk.Circle):
            shape.unsafe_set_radius(size)
            shape.unsafe_set_offset((self.random.uniform(-1, 1), 0.5))
        elif isinstance(shape, pymunk.Segment):
            shape.unsafe_set_endpoints((-size, 0.2), (size, -0.3))
            shape.unsafe_set_radius(0.3 * size)
        else:
            shape.unsafe_set_vertices(regular(self.random.randrange(4, 12), 1.5 * size))
            shape.unsafe_set_radius(0.1 * size)

    def replace_shape(self):
        """Another shape on the same body."""
        shape = self.some()
        body = shape.body
        self.space.remove(shape)
        # So that its memory is free for the next.
        body._shapes.pop(shape, None)
        del shape
        other = self.shape(body)
        other.density = 1
        self.space.add(other)

    def copy(self):
        space = self.space
        space.on_collision(post_solve=pymunk.empty_callback)
        self.watch(space.copy())

    def run(self, steps):
        for _ in range(6):
            self.enter()
        for _ in range(steps):
            what = self.random.random()
            count = len(self.movable())
            if what < 0.15 and count < 22:
                self.enter()
            elif what < 0.28 and count > 4:
                self.leave()
            elif what < 0.5:
                self.change()
            elif what < 0.6:
                self.replace_shape()
            elif what < 0.605:
                self.copy()
            elif what < 0.62:
                gc.collect()
            self.space.step(1 / 120)


@pytest.mark.parametrize("seed", range(2))
def test_nothing_stale(backend, seed, monkeypatch):
    mistakes = []
    monkeypatch.setattr(
        sys, "unraisablehook", lambda report: mistakes.append(report.exc_value)
    )
    traffic = Traffic(seed)
    traffic.run(500)
    for mistake in mistakes:
        raise mistake
    kinds = {kind for pair in traffic.checked for kind in pair}
    assert kinds == {Ellipse, pymunk.Circle, pymunk.Segment, pymunk.Poly}
    assert len(traffic.checked) >= 8
    assert sum(traffic.checked.values()) > 3000


def test_addresses_are_used_again(backend):
    """Ellipses and large polygons take turns at the same addresses, and each has its own contacts."""
    choice = random.Random(4).choice
    # As many vertices as a hull has, for all that is allocated to be of one size, and flat below.
    vertices = [(9 * cos(t), 9 * sin(t)) for t in (pi / 8 * i for i in range(1, 17, 2))]
    space = make_space()
    space.add(pymunk.Poly.create_box(space.static_body, (40, 20)))
    places = {Ellipse: set(), pymunk.Poly: set()}
    seen = []

    def look(arbiter, space, data):
        seen.append([point.distance for point in arbiter.contact_point_set.points])

    space.on_collision(post_solve=look)
    for i in range(400):
        kind = choice((Ellipse, pymunk.Poly))
        body = pymunk.Body(1, 1)
        if kind is Ellipse:
            body.position, depths = (0, 17.9), [-0.1]
            shape = Ellipse(body, 9, 8)
        else:
            body.position, depths = (0, 9.9 + 9 * cos(pi / 8)), [-0.1, -0.1]
            shape = pymunk.Poly(body, vertices)
        places[kind].add(address(shape._shape))
        space.add(body, shape)
        space.step(1e-6)
        assert seen == [pytest.approx(depths, abs=1e-9)]
        seen.clear()
        space.remove(shape, body)
        if i % 40 == 0:
            del shape, body
            gc.collect()
    assert places[Ellipse] & places[pymunk.Poly]


# Nothing left behind


def resident():
    """Memory of this process, in bytes."""
    try:
        pages = int(Path("/proc/self/statm").read_text().split()[1])
    except FileNotFoundError:
        pytest.skip("needs /proc")
    return pages * os.sysconf("SC_PAGE_SIZE")


def test_memory_of_ellipses_that_come_and_go(backend):
    space = make_space((0, -500))
    add_floor(space)

    def come_and_go(count):
        for i in range(count):
            pair = [add_ellipse(space, 4, 2, (i % 9, 3 + 3 * k)) for k in (0, 1)]
            if i % 5 == 0:
                space.step(0.001)
            for shape in pair:
                space.remove(shape, shape.body)
        gc.collect()

    # pymunk forgets what was removed when it steps.
    come_and_go(501)
    before = resident()
    come_and_go(2501)
    # They would take about ten megabytes.
    assert resident() - before < 2e6
    assert len(space.shapes) == 1


def test_memory_of_many_steps(backend):
    space = make_space((0, -500))
    add_box(space, 15, 100)
    eggs = [add_ellipse(space, 6, 4, (0, 5 + 9 * i), 0.3 * i) for i in range(3)]
    count = 20_000 if backend == "compiled" else 4_000
    steps(space, 1000)
    before = resident()
    steps(space, count)
    assert resident() - before < 1e6
    assert all(0 < egg.body.position.y < 30 for egg in eggs)


# Threads


def test_threaded_space(backend):
    paths = []
    for threads in (1, 2):
        space = small_pile(threaded=True)
        space.threads = threads
        steps(space, 60)
        paths.append([(*body.position, body.angle) for body in space.bodies])
        energy = sum(body.kinetic_energy for body in space.bodies)
        assert 0 <= energy < 1e6
    # Solved in two halves, so not the same, but as deep in the box.
    for one, other in zip(*paths, strict=True):
        assert other[1] == pytest.approx(one[1], abs=3)


def test_spaces_in_two_threads(backend):
    """pymunk releases the interpreter's lock while it steps."""

    def path(seed):
        space = small_pile()
        body = add_body(space, (0, 60), 0.1 * seed, mass=100, moment=2000)
        space.add(pymunk.Poly.create_box(body, (9, 6)))
        steps(space, 200)
        return [(*body.position, body.angle) for body in space.bodies]

    alone = [path(seed) for seed in range(4)]
    together = [None] * 4

    def work(seed):
        together[seed] = path(seed)

    threads = [threading.Thread(target=work, args=(seed,)) for seed in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert together == alone
