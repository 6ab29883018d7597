"""Contacts at work in a plain pymunk.Space: dynamics against analytic physics and pymunk's circles, and no trace where nothing touches."""

import gc
import sys
import weakref
from itertools import pairwise, permutations
from math import cos, hypot, inf, pi, sin, sqrt

import pymunk
import pytest
from pymunk import Vec2d
from scenes import (
    FLOOR,
    add_body,
    add_box,
    add_ellipse,
    add_floor,
    contacts,
    crossings,
    height,
    kinetic_energy_per_mass,
    make_space,
    rock,
    rocking_period,
)

from pymunk_ellipse import Ellipse
from pymunk_ellipse.contacts import backend as backends
from pymunk_ellipse.contacts.handler import contact_handler

pytestmark = pytest.mark.usefixtures("backend")


# Against pymunk's circle


def circle_or_ellipse(round_as_ellipse):
    def make(body, radius, offset=(0, 0)):
        if round_as_ellipse:
            return Ellipse(body, radius, radius, offset, 0.7)
        return pymunk.Circle(body, radius, offset)

    return make


def scene_floor(space, make):
    """Thrown on a floor and against a wall, with friction and bounce; never so far that it just touches, which counts here and not for circles."""
    add_floor(space, elasticity=0.7)
    wall = pymunk.Segment(space.static_body, (30, 0), (30, 100), 1)
    wall.friction = wall.elasticity = 0.8
    space.add(wall)
    body = add_body(space, (0.1, 12), 0.3, (60, 5), -3, 2, 30)
    yield body, make(body, 5)


def scene_slope(space, make):
    """Rolling down a polygon and over its corner."""
    slope = pymunk.Poly(space.static_body, [(-50, 0), (20, 0), (-50, 35)])
    slope.friction = 0.9
    space.add(slope)
    add_floor(space)
    body = add_body(space, (-20, 27), 0, (10, 0), 0, 2, 30)
    yield body, make(body, 5)


def scene_balls(space, make):
    """One against a native circle and one of its own kind, off centre."""
    add_floor(space)
    native = add_body(space, (0, 3.99), 0, (0, 0), 0, 1, 8)
    ball = pymunk.Circle(native, 4)
    ball.friction = ball.elasticity = 0.5
    space.add(ball)
    for x, y, speed in ((-20, 4.99, 60), (3, 25, 0)):
        body = add_body(space, (x, y), 0, (speed, 0), 1, 2, 30)
        yield body, make(body, 5)


def scene_offset(space, make):
    """Wheels beside the centre of gravity."""
    add_floor(space)
    body = add_body(space, (0, 8), 0.2, (20, 0), 1, 3, 200)
    body.center_of_gravity = 1, 0.5
    for offset in ((-6, -2), (6, -2)):
        yield body, make(body, 4, offset)


def scene_dynamic_polygon(space, make):
    """A ball rolls into a box and against a corner."""
    add_floor(space)
    box = add_body(space, (15, 4.9), 0, (0, 0), 0, 2, 40)
    shape = pymunk.Poly.create_box(box, (8, 10), 0.2)
    shape.friction = 0.4
    space.add(shape)
    body = add_body(space, (0, 3.99), 0, (50, 0), -10, 2, 30)
    yield body, make(body, 4)


def scene_carried(space, make):
    """A ball on the side of a wheel whose surface moves."""
    ball = add_body(space, (3.9, 10.4), 0, (0, 0), 0, 2, inf)
    shape = pymunk.Circle(ball, 4)
    shape.friction = 5
    space.add(shape)
    wheel = make(space.static_body, 8, (0.5, -1))
    wheel.surface_velocity = 40, 15
    yield space.static_body, wheel


def trajectory(scene, as_ellipse, seconds=1.0, dt=1 / 120):
    # Enough iterations for the order in which contacts are solved not to matter.
    space = make_space((0, -100), 100)
    for _body, shape in scene(space, circle_or_ellipse(as_ellipse)):
        shape.friction = 0.8
        shape.elasticity = 0.6
        space.add(shape)
    path = []
    for _ in range(round(seconds / dt)):
        space.step(dt)
        path.append([(*body.position, body.angle) for body in space.bodies])
    return path


@pytest.mark.parametrize(
    "scene",
    [
        scene_floor,
        scene_slope,
        scene_balls,
        scene_offset,
        scene_dynamic_polygon,
        scene_carried,
    ],
)
def test_equal_axes_follow_a_circle(scene):
    native, ellipse = trajectory(scene, False), trajectory(scene, True)
    moved = 0.0
    for expected, found in zip(native, ellipse, strict=True):
        for one, other in zip(expected, found, strict=True):
            assert other == pytest.approx(one, abs=1e-6)
    for start, end in zip(native[0], native[-1], strict=True):
        moved = max(moved, hypot(end[0] - start[0], end[1] - start[1]))
    assert moved > 3


# Rocking


@pytest.mark.parametrize("tilt", [0.05, 0.2, 0.5])
def test_rocking(tilt):
    dt = 1 / 240
    angles = rock(make_space((0, -500)), 20, 10, tilt, 11.5, dt)
    times = crossings(angles, dt)
    period = (times[-1] - times[0]) / (len(times) - 1)
    expected = rocking_period(20, 10, 500, tilt)
    assert period == pytest.approx(expected, rel=1e-3)
    after_ten = angles[round(10 / dt) : round((10 + period) / dt)]
    assert 0.95 * tilt <= max(map(abs, after_ten)) <= 1.05 * tilt


def test_rocking_periods_of_the_design():
    """The integral used above, against values computed elsewhere."""
    assert rocking_period(20, 10, 500, 0.05) == pytest.approx(0.773639, abs=1e-6)
    assert rocking_period(20, 10, 500, 0.2) == pytest.approx(0.831387, abs=1e-6)
    assert rocking_period(20, 10, 500, 0.5) == pytest.approx(1.082325, abs=1e-6)


def test_rocking_on_other_shapes():
    """A flat polygon and a thick segment are as good a floor."""
    expected = rocking_period(20, 10, 500, 0.2)
    dt = 1 / 240
    for make in (
        lambda body: pymunk.Poly(body, [(-99, -9), (99, -9), (99, 0), (-99, 0)]),
        lambda body: pymunk.Segment(body, (-99, -2), (99, -2), 2),
    ):
        space = make_space((0, -500))
        floor = make(space.static_body)
        floor.friction = 100
        space.add(floor)
        egg = add_ellipse(space, 20, 10, (0, height(20, 10, 0.2)), 0.2, friction=100)
        angles = []
        for _ in range(round(3 / dt)):
            space.step(dt)
            angles.append(egg.body.angle)
        times = crossings(angles, dt)
        assert times[-1] - times[0] == pytest.approx(
            expected * (len(times) - 1), rel=2e-3
        )


@pytest.mark.parametrize("origin", [(1e7, -1e7), (-1e5, 1e5)])
def test_rocking_far_from_the_origin(origin):
    dt = 1 / 240
    near = rock(make_space((0, -500)), 20, 10, 0.2, 2, dt)
    far = rock(make_space((0, -500)), 20, 10, 0.2, 2, dt, origin)
    assert far == pytest.approx(near, abs=1e-3)


# Collisions


def momenta(space):
    """Momentum, angular momentum about the origin and kinetic energy."""
    p, spin, energy = Vec2d.zero(), 0.0, 0.0
    for body in space.bodies:
        p += body.mass * body.velocity
        spin += body.mass * body.position.cross(body.velocity)
        spin += body.moment * body.angular_velocity
        energy += body.kinetic_energy
    return p, spin, energy


@pytest.mark.parametrize("elasticity", [1.0, 0.5, 0.0])
@pytest.mark.parametrize("case", range(6))
def test_collision_in_free_flight(case, elasticity):
    """The outcome is that of the one impulse along the exact normal, at the exact point."""
    space = make_space()
    e = sqrt(elasticity)
    one = add_ellipse(space, 20, 10, (0, 0), 0.4 * case, (30, case), 1.5, 0, e)
    two = add_ellipse(
        space, 5 + 5 * case, 12, (70, 5 - 2 * case), 1.1 * case, (-40, 0), -2, 0, e
    )
    seen = contacts(space)
    while not seen:
        before = [(s.body.velocity, s.body.angular_velocity) for s in (one, two)]
        space.step(1 / 240)
        assert one.body.position.get_distance(two.body.position) < 200
    p, spin, energy = momenta(space)
    found = one.shapes_collide(two)
    (point,) = found.points

    # Both bodies are still where they were when they met.
    n = found.normal
    arms = [point.point_a - one.body.position, point.point_b - two.body.position]
    after = [(s.body.velocity, s.body.angular_velocity) for s in (one, two)]
    approach = sum(
        sign * (v + w * arm.perpendicular()).dot(n)
        for sign, (v, w), arm in zip((1, -1), before, arms, strict=True)
    )
    softness = sum(
        1 / s.body.mass + arm.cross(n) ** 2 / s.body.moment
        for s, arm in zip((one, two), arms, strict=True)
    )
    impulse = (1 + elasticity) * approach / softness
    assert impulse > 0
    for sign, s, (v, w), (v_after, w_after), arm in zip(
        (-1, 1), (one, two), before, after, arms, strict=True
    ):
        assert v_after == pytest.approx(
            tuple(v + sign * impulse / s.body.mass * n), abs=2e-4
        )
        kick = sign * impulse * arm.cross(n) / s.body.moment
        assert w_after == pytest.approx(w + kick, abs=1e-5)

    for s, (v, w) in zip((one, two), before, strict=True):
        s.body.velocity, s.body.angular_velocity = v, w
    p_before, spin_before, energy_before = momenta(space)
    scale = one.body.mass * 100
    assert p == pytest.approx(p_before, abs=1e-9 * scale)
    assert spin == pytest.approx(spin_before, abs=1e-9 * scale * 100)
    if elasticity == 1:
        assert energy == pytest.approx(energy_before, rel=1e-9)
    else:
        assert energy < energy_before


def test_contact_is_felt_when_the_ellipses_touch():
    """Not when their hulls do: the first impulse comes within a step of touching."""
    space = make_space()
    egg = add_ellipse(space, 20, 10, (0, 40), 0.6, (0, -60))
    add_floor(space)
    gap = 40 - height(20, 10, 0.6)
    dt = 1 / 1000
    steps = 0
    while egg.body.angular_velocity == 0:
        space.step(dt)
        steps += 1
    assert steps == pytest.approx(gap / 60 / dt, abs=1.01)


# Rest


def fill(space, columns, rows, a=8, b=4, spacing=18):
    for i in range(columns):
        for j in range(rows):
            x = (i - (columns - 1) / 2) * spacing + (j % 2) * 2 - 1
            add_ellipse(space, a, b, (x, 10 + j * 14), 0.7 * i + 1.3 * j)


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


def settle(space, seconds=6.0, dt=1 / 120):
    for _ in range(round(seconds / dt)):
        space.step(dt)


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


# Hulls that overlap while the ellipses do not


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


# The user's handlers


PHASES = ("begin", "pre_solve", "post_solve", "separate")
KEYS = [(None, None), (1, None), (2, None), (1, 2), (2, 1)]


def falling(space):
    """An ellipse of collision type 1 that will bounce off a floor of type 2 for good."""
    floor = add_floor(space, elasticity=1)
    floor.collision_type = 2
    egg = add_ellipse(space, 20, 10, (0, 22), 0.5, (0, -100), elasticity=1)
    egg.collision_type = 1
    return egg, floor


@pytest.mark.parametrize("when", ["before", "after"])
@pytest.mark.parametrize("key", KEYS)
def test_callbacks_are_called_and_contacts_exact(key, when):
    space = make_space()
    calls = {phase: [] for phase in PHASES}

    def callback(phase):
        def note(arbiter, space, data):
            assert data == {"from": "the user"}
            calls[phase].append(arbiter.shapes)
            if phase == "post_solve":
                check_exact(arbiter)

        return note

    def subscribe():
        for phase in PHASES:
            space.on_collision(
                *key, **{phase: callback(phase)}, data={"from": "the user"}
            )

    if when == "before":
        subscribe()
    egg, floor = falling(space)
    if when == "after":
        subscribe()
    settle(space, 0.5, 1 / 240)
    assert all(calls[phase] for phase in PHASES)
    assert len(calls["begin"]) == len(calls["separate"])
    order = (egg, floor) if key in ((1, None), (1, 2)) else (floor, egg)
    for pairs in calls.values():
        for pair in pairs:
            assert set(pair) == {egg, floor}
            assert key == (None, None) or pair == order
    assert egg.body.velocity.y > 0


def check_exact(arbiter):
    """The arbiter has the one exact contact; shapes[0] to shapes[1] is the direction of its normal."""
    first, second = arbiter.shapes
    found = arbiter.contact_point_set
    if isinstance(first, Ellipse):
        exact, sign = first.shapes_collide(second), 1
    else:
        exact, sign = second.shapes_collide(first), -1
    (point,), (expected,) = found.points, exact.points
    assert found.normal == pytest.approx(tuple(sign * exact.normal), abs=1e-5)
    assert point.distance == pytest.approx(expected.distance, abs=1e-9)
    ends = (expected.point_a, expected.point_b)
    assert (point.point_a, point.point_b) == (
        pytest.approx(tuple(ends[0 if sign > 0 else 1]), abs=1e-3),
        pytest.approx(tuple(ends[1 if sign > 0 else 0]), abs=1e-3),
    )


@pytest.mark.parametrize("key", KEYS)
def test_every_contact_of_a_pile_is_exact(key):
    """With a pre_solve of the user's at any key; all kinds of shapes."""
    space = make_space((0, -500))
    add_box(space, 60, 300)
    fill(space, 4, 3)
    for i in range(4):
        body = add_body(space, (30 * i - 45, 70), 0.3 * i, mass=100, moment=3000)
        shapes = [
            pymunk.Circle(body, 8),
            pymunk.Poly.create_box(body, (14, 9), 1),
            pymunk.Segment(body, (-9, 0), (9, 0), 3),
            pymunk.Poly(body, [(9 * cos(0.7 * k), 9 * sin(0.7 * k)) for k in range(9)]),
        ]
        space.add(shapes[i])
    for i, shape in enumerate(space.shapes):
        shape.collision_type = 1 + i % 2
    checked = []

    def check(arbiter, space, data):
        if any(isinstance(shape, Ellipse) for shape in arbiter.shapes):
            check_exact(arbiter)
            checked.append(arbiter)

    space.on_collision(*key, pre_solve=lambda *_: None, post_solve=check)
    settle(space, 1)
    assert len(checked) > 500


def test_global_pre_solve_sees_the_exact_contact():
    space = make_space()
    seen = []

    def look(arbiter, space, data):
        egg, floor = arbiter.shapes[::-1]
        if not isinstance(egg, Ellipse):
            egg, floor = floor, egg
        if egg.shapes_collide(floor).points:
            check_exact(arbiter)
            seen.append(1)

    space.on_collision(pre_solve=look)
    falling(space)
    settle(space, 0.5, 1 / 240)
    assert seen


@pytest.mark.parametrize("key", KEYS)
def test_replaced_and_removed_callbacks(key):
    space = make_space((0, -500))
    egg = falling(space)[0]
    egg.elasticity = 0
    calls = []

    def subscribe(name):
        for phase in ("pre_solve", "post_solve"):
            space.on_collision(*key, **{phase: lambda *_: calls.append(name)})

    subscribe("first")
    settle(space, 0.5)
    assert set(calls) == {"first"}
    calls.clear()
    subscribe("second")
    settle(space, 0.5)
    assert set(calls) == {"second"}
    calls.clear()
    for phase in PHASES:
        space.on_collision(*key, **{phase: pymunk.empty_callback})
    settle(space, 0.5)
    assert calls == []
    # Still the ellipse, not the hull.
    body = egg.body
    assert body.position.y == pytest.approx(height(20, 10, body.angle), abs=0.2)
    points = []
    body.each_arbiter(lambda arbiter: points.append(arbiter.contact_point_set.points))
    assert [len(found) for found in points] == [1]


def test_all_keys_at_once():
    """Each callback is called once a step, the more specific first."""
    space = make_space((0, -500))
    egg, _floor = falling(space)
    egg.elasticity = 0
    calls = []
    for key in KEYS:
        space.on_collision(*key, pre_solve=lambda *_, key=key: calls.append(key))
    settle(space, 1)
    calls.clear()
    space.step(1 / 120)
    assert sorted(calls, key=str) == sorted(KEYS, key=str)
    assert calls[-1] == (None, None)


def test_users_changes_in_pre_solve_count():
    """A friction set for one contact, as pymunk documents."""
    results = []
    for friction in (None, 0.0):
        space = make_space((0, -100))
        add_floor(space)
        egg = add_ellipse(space, 20, 10, (0, 10), 0, (50, 0))

        def slide(arbiter, space, data, friction=friction):
            if friction is not None:
                arbiter.friction = friction

        space.on_collision(pre_solve=slide)
        settle(space, 0.5)
        results.append(egg.body.velocity.x)
    assert results[0] < 40
    assert results[1] == pytest.approx(50, abs=0.1)


def test_error_in_a_callback_does_not_stop_contacts(monkeypatch):
    """pymunk reports what a callback raises and goes on."""
    reported = []
    monkeypatch.setattr(sys, "unraisablehook", reported.append)
    space = make_space((0, -500))
    egg = falling(space)[0]
    egg.elasticity = 0

    def fail(arbiter, space, data):
        raise RuntimeError("the user's mistake")

    space.on_collision(pre_solve=fail)
    settle(space, 1)
    assert egg.body.position.y == pytest.approx(height(20, 10, egg.body.angle), abs=0.2)
    assert {str(report.exc_value) for report in reported} == {"the user's mistake"}


def test_other_shapes_are_left_alone():
    """Circles and boxes in the same space have pymunk's own contacts."""

    def run(with_ellipse):
        space = make_space((0, -100))
        add_floor(space)
        if with_ellipse:
            add_ellipse(space, 2, 1, (500, 1))
        ball = add_body(space, (0, 30), 0.1, (5, 0), 1, 2, 30)
        box = add_body(space, (4, 12), 0.4, (0, 0), 0, 2, 60)
        space.add(pymunk.Circle(ball, 5), pymunk.Poly.create_box(box, (10, 10)))
        settle(space, 2)
        return ball.position, ball.angle, box.position, box.angle

    assert run(True) == run(False)


# Kinds of spaces


def test_threaded_space():
    space = make_space((0, -500), 20, threaded=True)
    space.threads = 2
    add_box(space, 40, 300)
    fill(space, 3, 6)
    checked = []

    def check(arbiter, space, data):
        check_exact(arbiter)
        checked.append(1)

    space.on_collision(post_solve=check)
    settle(space, 4)
    assert kinetic_energy_per_mass(space) < 1
    assert len(checked) > 1000
    assert space.threads == 2 or space.threads == 1


def test_spatial_hash():
    space = make_space((0, -500), 20)
    space.use_spatial_hash(20, 1000)
    add_box(space, 40, 300)
    fill(space, 3, 6)
    space.on_collision(post_solve=lambda arbiter, *_: check_exact(arbiter))
    settle(space, 4)
    assert kinetic_energy_per_mass(space) < 1


def test_sensor():
    space = make_space((0, -100))
    add_floor(space)
    egg = add_ellipse(space, 20, 10, (0, 40), 0.6)
    egg.sensor = True
    calls = []
    for phase in PHASES:
        space.on_collision(**{phase: lambda *_, phase=phase: calls.append(phase)})
    settle(space, 2)
    assert egg.body.position.y < -20
    assert set(calls) == {"begin", "pre_solve", "separate"}


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


@pytest.mark.parametrize("offset", [(3, 4), (-30, 10)])
def test_centre_of_gravity_beside_the_bodys_origin(offset):
    """Where the body's origin is makes no difference to how an ellipse moves."""
    paths = []
    for shift in (Vec2d.zero(), Vec2d(*offset)):
        space = make_space((0, -500))
        add_floor(space)
        still = add_body(space, (15, 5), mass=50, moment=2000)
        space.add(pymunk.Circle(still, 5))
        body = add_body(space, angle=0.5)
        egg = Ellipse(body, 20, 10, shift)
        egg.mass = 10
        egg.friction = 1
        space.add(egg)
        body.position += Vec2d(0, 40) - body.local_to_world(shift)
        body.velocity = 0, 0
        path = []
        for _ in range(240):
            space.step(1 / 240)
            path.append((*body.local_to_world(shift), body.angle))
        paths.append(path)
    for expected, found in zip(*paths, strict=True):
        assert found == pytest.approx(expected, abs=1e-6)
    assert abs(paths[0][-1][2] - 0.5) > 0.1


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


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_rocking_at_any_scale(scale):
    """Lengths and gravity scaled, with pymunk's slop: the same motion."""
    dt = 1 / 240
    space = make_space((0, -500 * scale))
    space.collision_slop = 0.1 * scale
    plain = rock(make_space((0, -500)), 20, 10, 0.2, 2, dt)
    scaled = rock(space, 20 * scale, 10 * scale, 0.2, 2, dt)
    assert scaled == pytest.approx(plain, abs=1e-6)


# Coming and going


@pytest.mark.parametrize("phase", PHASES)
def test_removed_in_a_callback(phase):
    space = make_space((0, -500))
    add_floor(space, elasticity=1)
    fill(space, 3, 3)
    for shape in space.shapes:
        shape.elasticity = 0.9
    count = len(space.bodies)

    def remove(arbiter, space, data):
        for shape in arbiter.shapes:
            if isinstance(shape, Ellipse) and shape.space is not None:
                space.remove(shape, shape.body)
                break

    space.on_collision(**{phase: remove})
    settle(space, 2)
    assert len(space.bodies) < count


def test_added_in_a_callback():
    """The first ellipse of a space, added while it steps."""
    space = make_space((0, -500))
    add_floor(space)
    ball = add_body(space, (0, 5), mass=1, moment=10)
    space.add(pymunk.Circle(ball, 5))
    bodies = []

    def drop(arbiter, space, data):
        if not bodies:
            body = pymunk.Body()
            body.position = 50, 40
            egg = Ellipse(body, 20, 10)
            egg.density = 1
            egg.friction = 1
            bodies.append(body)
            space.add(body, egg)

    space.on_collision(pre_solve=drop)
    settle(space, 3)
    (body,) = bodies
    assert body.position.y == pytest.approx(10, abs=0.2)


def test_removed_and_added_elsewhere():
    first, second = make_space((0, -500)), make_space((0, -500))
    egg = add_ellipse(first, 20, 10, (0, 12), 0.3)
    body = egg.body
    add_floor(first)
    add_floor(second)
    settle(first, 0.2)
    first.remove(egg, body)
    assert egg.space is None
    second.add(body, egg)
    assert egg.space is second
    seen = contacts(second)
    settle(second, 3)
    assert seen
    assert body.position.y == pytest.approx(height(20, 10, body.angle), abs=0.2)
    second.remove(egg, body)
    first.add(body, egg)
    settle(first, 0.2)
    assert body.position.y == pytest.approx(height(20, 10, body.angle), abs=0.2)


def test_spaces_are_collected():
    references = []
    for _ in range(20):
        space = make_space((0, -500))
        add_floor(space)
        fill(space, 2, 2)
        settle(space, 0.2)
        references.append(weakref.ref(space))
    del space
    gc.collect()
    assert [reference() for reference in references] == [None] * 20


def test_space_forgets_what_left():
    space = make_space()
    eggs = [add_ellipse(space, 20, 10, (50 * i, 0)) for i in range(4)]
    handler = contact_handler(space)
    assert handler.ellipses == 4
    for egg in eggs[:3]:
        space.remove(egg, egg.body)
    assert handler.ellipses == 1


def test_polygon_in_the_place_of_a_removed_ellipse():
    """Nothing is remembered by an address that Chipmunk may use again."""
    space = make_space((0, -500))
    add_floor(space)
    for _ in range(8):
        egg = add_ellipse(space, 20, 10, (0, 12))
        settle(space, 0.05)
        space.remove(egg, egg.body)
        del egg
        gc.collect()
    box = add_body(space, (0, 5), mass=1, moment=100)
    space.add(pymunk.Poly.create_box(box, (10, 10)))
    counts = []
    space.on_collision(
        post_solve=lambda arbiter, *_: counts.append(
            len(arbiter.contact_point_set.points)
        )
    )
    settle(space, 0.5)
    assert set(counts) == {2}


def test_same_run_twice_is_the_same():
    def run():
        space = make_space((0, -500))
        add_box(space, 40, 300)
        fill(space, 3, 4)
        settle(space, 1)
        return [(body.position, body.angle) for body in space.bodies]

    assert run() == run()


def test_both_backends_agree(backend):
    """Compared with Python, whichever is at work."""

    def run():
        space = make_space((0, -500))
        add_box(space, 40, 300)
        fill(space, 3, 4)
        body = add_body(space, (0, 90), 0.3, mass=100, moment=3000)
        space.add(pymunk.Poly.create_box(body, (14, 9), 1))
        settle(space, 0.8)
        return [(*body.position, body.angle) for body in space.bodies]

    found = run()
    with backends.using(backends.Python()):
        expected = run()
    for right, place in zip(expected, found, strict=True):
        assert place == pytest.approx(right, abs=1e-6)
