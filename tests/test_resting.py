"""Piles and columns that come to rest, hold by the impulses of the last step, sleep and wake."""

from itertools import permutations
from math import inf

import pymunk
import pytest
from scenes import (
    FLOOR,
    add_box,
    add_ellipse,
    add_floor,
    contacts,
    fill,
    height,
    kinetic_energy_per_mass,
    make_space,
    settle,
)

from pymunk_ellipse import Ellipse

pytestmark = pytest.mark.usefixtures("backend")


def test_pile_comes_to_rest():
    space = make_space((0, -500), 20)
    add_box(space, 50, 400)
    fill(space, 5, 12)
    pushes = []

    def note(arbiter, space, data):
        sign = 1 if arbiter.shapes[1].collision_type == FLOOR else -1
        pushes.append(-sign * arbiter.total_impulse.y)

    space.on_collision(FLOOR, None, post_solve=note)
    dt = 1 / 120
    for _ in range(480):
        space.step(dt)
    for _ in range(60):
        space.step(dt)
        assert kinetic_energy_per_mass(space) < 1
    pushes.clear()
    for _ in range(60):
        space.step(dt)
    weight = 500 * sum(body.mass for body in space.bodies)
    assert abs(sum(pushes)) / 60 / dt == pytest.approx(weight, rel=0.01)
    for body in space.bodies:
        assert abs(body.position.x) < 50
        assert body.position.y > 0
    assert deepest(space) < 0.6


def deepest(space):
    """The depth of the deepest contact."""
    depths = [0.0]

    def note(arbiter):
        depths.extend(-p.distance for p in arbiter.contact_point_set.points)

    for body in space.bodies:
        body.each_arbiter(note)
    return max(depths)


def column_in_a_shaft(count=10):
    """A column that slides freely in a shaft, with one iteration a step."""
    space = make_space((0, -100), iterations=1)
    add_floor(space, friction=0)
    for i in range(count):
        egg = add_ellipse(space, 10, 10, (0, 10 + 20 * i), friction=0, mass=1)
        egg.body.moment = inf
    return space


def forget_impulses(space, name):
    """Break warm starting: what a contact leaves behind is zero."""

    def forget(arbiter, space, data):
        setattr(arbiter._arbiter.contacts[0], name, 0.0)

    space.on_collision(post_solve=forget)


def test_impulses_persist():
    """One iteration a step holds a column only because each step starts with the last one's impulses."""
    space = column_in_a_shaft()
    settle(space)
    assert kinetic_energy_per_mass(space) < 1e-3
    assert deepest(space) < 0.3
    broken = column_in_a_shaft()
    forget_impulses(broken, "jnAcc")
    settle(broken)
    assert deepest(broken) > 1


def test_friction_persists():
    """As above, with gravity aslant: friction alone keeps the column from sliding away."""
    slides = []
    for broken in (False, True):
        space = column_in_a_shaft()
        space.gravity = 30, -100
        for shape in space.shapes:
            shape.friction = 1
        if broken:
            forget_impulses(space, "jtAcc")
        settle(space, 2)
        slides.append(max(abs(body.position.x) for body in space.bodies))
    assert slides[0] < 1
    assert slides[1] > 3 * slides[0]


def test_impulses_persist_while_rolling():
    """The hull's vertices change under a rolling ellipse, and with them the hashes by which pymunk keeps impulses."""
    space = make_space((0, -100), iterations=1)
    add_floor(space, friction=10)
    egg = add_ellipse(space, 10, 9.9, (0, 10), 0, (20, 0), -2, friction=10, mass=1)
    seen = contacts(space)
    settle(space, 2)
    pushes = [abs(impulse.y) for *_, impulse in seen[-120:]]
    assert abs(egg.body.angle) > 2
    assert len(pushes) == 120
    assert min(pushes) > 0.5 * 100 / 120
    assert max(pushes) < 1.5 * 100 / 120


def test_swapped_shapes():
    """pymunk may swap the two shapes of an arbiter between steps; the contact and its impulses go on."""
    swapped = []

    def swap(arbiter, space, data):
        a = arbiter._arbiter
        if (
            space.current_step % 2
            or a.count == 0
            or FLOOR in (shape.collision_type for shape in arbiter.shapes)
        ):
            return
        a.a, a.b = a.b, a.a
        a.body_a, a.body_b = a.body_b, a.body_a
        a.n.x, a.n.y = -a.n.x, -a.n.y
        for i in range(a.count):
            point = a.contacts[i]
            r1 = point.r1.x, point.r1.y
            point.r1.x, point.r1.y = point.r2.x, point.r2.y
            point.r2.x, point.r2.y = r1
        swapped.append(arbiter)

    space = column_in_a_shaft()
    space.on_collision(0, 0, pre_solve=swap)
    for step in range(720):
        space.current_step = step
        space.step(1 / 120)
    assert swapped
    assert kinetic_energy_per_mass(space) < 1e-3
    assert deepest(space) < 0.3


def test_swapped_shapes_roll():
    """Rocking on another ellipse takes no notice of swaps either."""

    def run(swaps):
        space = make_space((0, -500))
        base = Ellipse(space.static_body, 400, 100, (0, -100))
        base.friction = 100
        space.add(base)
        egg = add_ellipse(space, 20, 10, (0, height(20, 10, 0.2)), 0.2, friction=100)
        if swaps:
            space.on_collision(0, 0, pre_solve=swap)
        angles = []
        for step in range(480):
            space.current_step = step
            space.step(1 / 240)
            angles.append(egg.body.angle)
        return angles

    def swap(arbiter, space, data):
        a = arbiter._arbiter
        if space.current_step % 2 == 0:
            a.a, a.b = a.b, a.a
            a.body_a, a.body_b = a.body_b, a.body_a
            a.n.x, a.n.y = -a.n.x, -a.n.y

    assert run(True) == pytest.approx(run(False), abs=1e-4)


def test_unsolved_pair_has_no_impulse():
    """Two kinematic ellipses overlap and are never solved; one carries a third ellipse."""
    for places in permutations([(8, 3), (0, 0), (0, 19.95)]):
        space = make_space((0, -500))
        eggs = [add_ellipse(space, 20, 10, place) for place in places]
        carried = eggs[places.index((0, 19.95))]
        carried.body.moment = inf
        for egg in eggs:
            if egg is not carried:
                egg.body.body_type = pymunk.Body.KINEMATIC
        impulses = []

        def look(arbiter, space, data, carried=carried, impulses=impulses):
            if carried not in arbiter.shapes:
                impulses.append(arbiter._arbiter.contacts[0].jnAcc)

        space.on_collision(pre_solve=look)
        settle(space, 0.5)
        assert impulses
        assert set(impulses) == {0}


def test_sleep_and_wake():
    """A pile falls asleep, is woken by a blow, and comes to rest again."""
    space = make_space((0, -500), 20)
    space.sleep_time_threshold = 0.3
    add_box(space, 40, 300)
    fill(space, 3, 4)
    settle(space, 8)
    assert all(body.is_sleeping for body in space.bodies)
    before = [body.position for body in space.bodies]
    bodies = list(space.bodies)
    bodies[0].activate()
    settle(space, 0.5)
    for body, place in zip(space.bodies, before, strict=True):
        assert body.position.get_distance(place) < 0.5
    bodies[-1].velocity = 0, -100
    settle(space, 0.05)
    assert not all(body.is_sleeping for body in space.bodies)
    settle(space, 8)
    assert all(body.is_sleeping for body in space.bodies)


def test_far_from_the_origin():
    """A small pile at 1e7 rests as it does at the origin."""
    space = make_space((0, -500), 20)
    x, y = 1e7, -1e7
    for start, end in (
        ((-40, 300), (-40, 0)),
        ((-40, 0), (40, 0)),
        ((40, 0), (40, 300)),
    ):
        wall = pymunk.Segment(
            space.static_body, (x + start[0], y + start[1]), (x + end[0], y + end[1]), 0
        )
        wall.friction = 0.5
        space.add(wall)
    for i in range(12):
        add_ellipse(
            space, 8, 4, (x + 18 * (i % 3) - 18, y + 10 + 14 * (i // 3)), 0.7 * i
        )
    settle(space, 4)
    assert kinetic_energy_per_mass(space) < 1
    for body in space.bodies:
        assert abs(body.position.x - x) < 40
        assert 0 < body.position.y - y < 100


def test_same_run_twice_is_the_same():
    def run():
        space = make_space((0, -500))
        add_box(space, 40, 300)
        fill(space, 3, 4)
        settle(space, 1)
        return [(body.position, body.angle) for body in space.bodies]

    assert run() == run()
