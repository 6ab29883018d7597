"""Motion in a plain pymunk.Space against analytic physics and pymunk's circles."""

from math import hypot, inf, sqrt

import pymunk
import pytest
from pymunk import Vec2d
from scenes import (
    add_body,
    add_ellipse,
    add_floor,
    contacts,
    crossings,
    height,
    make_space,
    rock,
    rocking_period,
)

from pymunk_ellipse import Ellipse

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
    """A wheel beside the origin of its body, about the centre of gravity."""
    add_floor(space)
    body = add_body(space, (0, 8), 0.2, (20, 0), 1, 3, 200)
    body.center_of_gravity = 6, -2
    yield body, make(body, 4, (6, -2))


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


def test_off_centre_the_motion_is_nearly_that_of_circles():
    """There it rolls as an ellipse does, and a circle loses a little in each step."""
    native, ellipse = trajectory(scene_offset, False), trajectory(scene_offset, True)
    for one, other in zip(native[-1], ellipse[-1], strict=True):
        assert other == pytest.approx(one, abs=1e-3)


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


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_rocking_at_any_scale(scale):
    """Lengths and gravity scaled, with pymunk's slop: the same motion."""
    dt = 1 / 240
    space = make_space((0, -500 * scale))
    space.collision_slop = 0.1 * scale
    plain = rock(make_space((0, -500)), 20, 10, 0.2, 2, dt)
    scaled = rock(space, 20 * scale, 10 * scale, 0.2, 2, dt)
    assert scaled == pytest.approx(plain, abs=1e-6)
