"""Hulls that overlap while the ellipses do not leave no trace."""

from math import cos, hypot, sin

import pymunk
import pytest
from pymunk import Vec2d
from scenes import FLOOR, add_ellipse, add_floor, contacts, make_space, settle

pytestmark = pytest.mark.usefixtures("backend")


def near_pair(space, gap=0.05, **options):
    """Two ellipses, not touching, placed where their hulls overlap."""
    for phi in (0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.3):
        n = Vec2d(cos(phi), sin(phi))
        h = hypot(20 * n.x, 10 * n.y)
        point = Vec2d(400 * n.x / h, 100 * n.y / h)
        probe = pymunk.Space()
        hits = []
        probe.on_collision(pre_solve=lambda *_, hits=hits: hits.append(1))
        add_ellipse(probe, 20, 10)
        add_ellipse(probe, 20, 10, 2 * point + gap * n)
        probe.step(1e-9)
        if hits:
            one = add_ellipse(space, 20, 10, **options)
            two = add_ellipse(space, 20, 10, 2 * point + gap * n, **options)
            assert not one.shapes_collide(two).points
            return one, two, n
    raise AssertionError("no hulls overlap")


def arbiters(body):
    found = []
    body.each_arbiter(found.append)
    return found


def test_hull_overlap_leaves_no_trace():
    space = make_space()
    one, two, _n = near_pair(space)
    flags = []
    seen = contacts(space)

    def look(arbiter, space, data):
        flags.append(arbiter.process_collision)

    space.on_collision(0, 0, pre_solve=look)
    for _ in range(5):
        space.step(0.01)
    assert flags == [True] * 5
    assert seen == []
    assert arbiters(one.body) == arbiters(two.body) == []
    assert one.body.velocity == two.body.velocity == (0, 0)
    assert one.body.angular_velocity == 0


def test_first_contact_after_hulls_overlapped():
    space = make_space()
    one, two, n = near_pair(space, 0.05)
    looks, firsts = [], []

    def look(arbiter, space, data):
        looks.append(one.shapes_collide(two).points != ())

    def note(arbiter, space, data):
        firsts.append(arbiter.is_first_contact)
        # Two contacts that are apart and touch again must not start from old impulses.
        one.body.velocity = two.body.velocity = 0, 0
        one.body.angular_velocity = two.body.angular_velocity = 0

    space.on_collision(0, 0, pre_solve=look)
    space.on_collision(post_solve=note)

    def approach(speed, steps):
        for _ in range(steps):
            two.body.velocity = speed * n
            space.step(0.01)
            two.body.velocity = 0, 0

    approach(-2, 6)
    assert looks == [False] * 2 + [True] * 4
    assert firsts == [True, False, False, False]
    count = len(firsts)
    approach(8, 1)
    assert len(firsts) == count
    assert looks[-1] is False
    approach(-8, 1)
    assert len(firsts) == count + 1
    assert firsts[-1] is True


@pytest.mark.parametrize("gap", [0.2, 30])
def test_no_stale_impulse_after_a_gap(gap):
    """Touch hard and part for a step, the hulls too or not: the next touch starts from nothing."""
    space = make_space()
    one, two, n = near_pair(space, 1e-6)
    seen = contacts(space)
    starts = []

    def look(arbiter, space, data):
        point = arbiter._arbiter.contacts[0]
        starts.append((arbiter.is_first_contact, point.jnAcc, point.jtAcc))

    space.on_collision(pre_solve=look)
    two.body.velocity = -50 * n
    space.step(0.001)
    (hard,) = seen
    assert hard[-1].length > 1000
    for s in (one, two):
        s.body.velocity = 0, 0
        s.body.angular_velocity = 0
    two.body.position += gap * n
    space.step(0.001)
    assert len(seen) == 1
    two.body.position -= gap * n
    two.body.velocity = -0.01 * n
    space.step(0.001)
    assert len(seen) == 2
    assert seen[1][-1].length < 0.01 * hard[-1].length
    assert two.body.velocity.length < 1
    assert starts[0] == starts[-1] == (True, 0, 0)


def test_users_process_collision_stays():
    """False is kept while only hulls overlap, and while the ellipses do."""
    space = make_space((0, -100))
    add_floor(space)
    egg = add_ellipse(space, 20, 10, (0, 40), 0.6)
    seen = contacts(space)

    def ignore(arbiter, space, data):
        arbiter.process_collision = False

    space.on_collision(0, FLOOR, begin=ignore)
    settle(space, 1)
    assert egg.body.position.y < 0
    assert seen == []


@pytest.mark.parametrize("key", [(None, None), (0, None), (0, FLOOR), (FLOOR, 0)])
def test_process_collision_in_pre_solve(key):
    space = make_space((0, -100))
    add_floor(space)
    egg = add_ellipse(space, 20, 10, (0, 40), 0.6)

    def ignore(arbiter, space, data):
        arbiter.process_collision = False

    space.on_collision(*key, pre_solve=ignore)
    settle(space, 1)
    assert egg.body.position.y < 0
    assert egg.body.angular_velocity == 0


def test_near_bodies_sleep_alone():
    space = make_space()
    space.sleep_time_threshold = 0.1
    one, two, _n = near_pair(space)
    settle(space, 0.5)
    assert one.body.is_sleeping
    assert two.body.is_sleeping
    one.body.activate()
    space.step(0.01)
    assert two.body.is_sleeping
    assert not one.body.is_sleeping


def test_near_kinematic_body_keeps_nobody_awake():
    space = make_space()
    space.sleep_time_threshold = 0.1
    one, two, _n = near_pair(space)
    one.body.body_type = pymunk.Body.KINEMATIC
    settle(space, 0.5)
    assert two.body.is_sleeping


def test_touching_bodies_sleep_together():
    space = make_space()
    space.sleep_time_threshold = 0.1
    one = add_ellipse(space, 20, 10)
    two = add_ellipse(space, 20, 10, (0, 19.95))
    settle(space, 0.5)
    assert one.body.is_sleeping
    assert two.body.is_sleeping
    one.body.activate()
    space.step(0.01)
    assert not two.body.is_sleeping
