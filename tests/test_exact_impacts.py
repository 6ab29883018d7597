"""Impacts at their own time: against flights from one event to the next, and no trace where nothing is to be changed."""

from __future__ import annotations

import pickle
import random
from math import exp, hypot, log, log2, pi, sqrt

import pymunk
import pytest
from pymunk import Vec2d

from demos._oracles import (
    Flyer,
    bouncing,
    colliding,
    half_a_step_on,
    hit,
    landing,
    time_to_floor,
)
from pymunk_ellipse import Ellipse, Space

pytestmark = pytest.mark.usefixtures("backend")

DOWN = 0.0, -500.0
WEIGHTLESS = 0.0, 0.0
# So many that a contact with friction is solved to the end.
ITERATIONS = 100
RATES = 60, 120, 240, 480


def new_space(exact=True, gravity=DOWN, iterations=10):
    space = Space(exact_impacts=exact)
    space.gravity = gravity
    space.iterations = iterations
    return space


def add_floor(space, elasticity=0.0, friction=0.0):
    floor = pymunk.Segment(space.static_body, (-1e4, 0), (1e4, 0), 0)
    floor.elasticity = elasticity
    floor.friction = friction
    space.add(floor)
    return floor


def add_flyer(space, flyer, elasticity=1.0, friction=1.0):
    body = pymunk.Body(flyer.mass, flyer.mass * flyer.square)
    body.position = flyer.x, flyer.y
    body.angle = flyer.angle
    body.velocity = flyer.vx, flyer.vy
    body.angular_velocity = flyer.spin
    shape = Ellipse(body, flyer.a, flyer.b)
    shape.elasticity = elasticity
    shape.friction = friction
    space.add(body, shape)
    return body


def step(space, seconds, dt):
    for _ in range(round(seconds / dt)):
        space.step(dt)


def distance(body, flyer):
    """Between two poses, with the turn of the ends counted as a way."""
    x, y = body.position - (flyer.x, flyer.y)
    return hypot(x, y, flyer.a * (body.angle - flyer.angle))


def rms(errors):
    return sqrt(sum(error**2 for error in errors) / len(errors))


def geometric_mean(errors):
    """For chains: they grow by orders of magnitude more in some than in others."""
    return exp(sum(log(error) for error in errors) / len(errors))


def order(errors):
    """The mean one over all halvings of the step."""
    return log2(errors[0] / errors[-1]) / (len(errors) - 1)


def flights(flyer, seconds, gravity, elasticity, friction):
    """How long each takes, the last one unended; none if two hits come within two steps of 1/60 s."""
    times = []
    while (time := time_to_floor(flyer, gravity, seconds)) < seconds:
        if time < 1 / 30:
            return []
        (flyer,) = hit((flyer.after(time, gravity),), (0, 1), elasticity, friction)
        seconds -= time
        times.append(time)
    return [*times, seconds] if seconds > 1 / 30 else []


def thrown(seconds, hits, elasticity, friction=0.0, gravity=DOWN):
    """Ellipses that hit the floor so often in this time, each begun in five parts of a step: an error depends on when in a step it hits."""
    rng = random.Random(5)
    found = []
    while len(found) < 60:
        flyer = Flyer(
            *(20.0, 10.0, 0.0, rng.uniform(40, 60), rng.uniform(-1.5, 1.5)),
            *(rng.uniform(-30, 30), 0.0, rng.uniform(-3, 3)),
        )
        whole = seconds + 1 / 60
        times = flights(flyer, whole, gravity, elasticity, friction)
        if len(times) - 1 in hits:
            found += [flyer.after(i / 300, gravity) for i in range(5)]
    return found


def bounce_errors(
    hits, seconds, elasticity, friction=0.0, gravity=DOWN, exact=True, mean=rms
):
    flyers = thrown(seconds, hits, elasticity, friction, gravity)
    ends = [
        bouncing(flyer, seconds, gravity, elasticity, friction)[0] for flyer in flyers
    ]
    errors = []
    for rate in RATES:
        offs = []
        for flyer, end in zip(flyers, ends, strict=True):
            space = new_space(exact, gravity, ITERATIONS)
            add_floor(space, elasticity, friction)
            body = add_flyer(space, half_a_step_on(flyer, 1 / rate, gravity))
            step(space, seconds, 1 / rate)
            offs.append(distance(body, end))
        errors.append(mean(offs))
    return errors


@pytest.mark.parametrize("elasticity", [1.0, 0.8])
def test_a_bounce_is_of_second_order(elasticity):
    assert order(bounce_errors((1,), 0.6, elasticity)) >= 1.9
    assert order(bounce_errors((1,), 0.6, elasticity, exact=False)) < 1.3


@pytest.mark.parametrize(("elasticity", "friction"), [(0.8, 0.4), (1.0, 10.0)])
@pytest.mark.parametrize("gravity", [DOWN, (300.0, -400.0)])
def test_a_bounce_with_friction_is_of_second_order(elasticity, friction, gravity):
    """Also on a slope, where gravity accelerates what friction has stopped."""
    assert order(bounce_errors((1,), 0.6, elasticity, friction, gravity)) >= 1.9


@pytest.mark.parametrize("elasticity", [1.0, 0.8])
def test_a_chain_of_bounces_is_of_second_order(elasticity):
    exact, plain = (
        bounce_errors((2, 3, 4), 1.2, elasticity, exact=switch, mean=geometric_mean)
        for switch in (True, False)
    )
    assert order(exact) >= 1.9
    assert plain[0] > 10 * exact[0]


def test_a_landing_is_of_second_order():
    seconds = 0.8
    errors = []
    flyers = thrown(0.4, (1,), 0.0)[::2]
    ends = [landing(flyer, seconds, 500.0) for flyer in flyers]
    for rate in RATES:
        offs = []
        for flyer, (angle, _spin, x) in zip(flyers, ends, strict=True):
            space = new_space()
            # What lands sinks by the slop, and rolls on as on a floor so much lower.
            space.collision_slop = 1e-3
            add_floor(space, friction=1e3)
            start = half_a_step_on(flyer, 1 / rate, DOWN)
            body = add_flyer(space, start, elasticity=0.0)
            step(space, seconds, 1 / rate)
            offs.append(hypot(body.position.x - x, 20 * (body.angle - angle)))
        errors.append(rms(offs))
    assert order(errors) >= 1.9


def pairs(count, seed=1):
    """Ellipses that hit each other once, with and without friction."""
    rng = random.Random(seed)
    found = []
    while len(found) < count:
        first = Flyer(
            *(20.0, 10.0, -60.0, 0.0, rng.uniform(0, pi), 100.0, 0.0),
            rng.uniform(-3, 3),
        )
        second = Flyer(
            *(20.0, 10.0, 60.0, rng.uniform(-15, 15), rng.uniform(0, pi)),
            *(-100.0, 0.0, rng.uniform(-3, 3), rng.choice((1.0, 3.0))),
        )
        pair = first, second
        if all(
            colliding(pair, 1.1, elasticity, friction)[1] == 1
            for elasticity in (0.5, 1.0)
            for friction in (0.0, 0.5)
        ):
            found.append(pair)
    return found


def run_pair(pair, dt, elasticity, friction, exact=True, iterations=ITERATIONS):
    space = new_space(exact, WEIGHTLESS, iterations)
    bodies = [
        add_flyer(space, flyer, sqrt(elasticity), sqrt(friction)) for flyer in pair
    ]
    step(space, 1.1, dt)
    return bodies


@pytest.mark.parametrize("friction", [0.0, 0.5])
@pytest.mark.parametrize("elasticity", [1.0, 0.5])
def test_a_collision_in_free_flight_is_exact(elasticity, friction):
    """Nothing of it depends on the step: velocities do not change in flight."""
    for pair in pairs(6):
        expected, _hits = colliding(pair, 1.1, elasticity, friction)
        for rate in (60, 240):
            bodies = run_pair(pair, 1 / rate, elasticity, friction)
            for body, end in zip(bodies, expected, strict=True):
                assert distance(body, end) < 1e-8
            plain = run_pair(pair, 1 / rate, elasticity, friction, exact=False)
            off = sum(map(distance, plain, expected))
            assert off > 1e-3


@pytest.mark.parametrize("iterations", [1, 10])
@pytest.mark.parametrize("friction", [0.0, 0.5])
@pytest.mark.parametrize("elasticity", [1.0, 0.5])
def test_a_collision_keeps_every_momentum(elasticity, friction, iterations):
    """Whatever the solver makes of the contact."""
    for pair in pairs(6):
        one, other = run_pair(pair, 1 / 60, elasticity, friction, iterations=iterations)
        momentum = one.mass * one.velocity + other.mass * other.velocity
        x = sum(flyer.mass * flyer.vx for flyer in pair)
        assert abs(momentum - (x, 0.0)) < 1e-12 * 400
        angular = sum(
            body.mass * body.position.cross(body.velocity)
            + body.moment * body.angular_velocity
            for body in (one, other)
        )
        size = sum(
            flyer.mass * (abs(flyer.x * flyer.vy - flyer.y * flyer.vx) + 20 * 100)
            for flyer in pair
        )
        before = sum(flyer.angular_momentum() for flyer in pair)
        assert abs(angular - before) < 1e-12 * size


def test_total_impulse_is_what_changes_the_velocities():
    space = new_space()
    add_floor(space, 0.8, 0.4)
    flyer = thrown(0.6, (1,), 0.8)[0]
    body = add_flyer(space, flyer)
    impulses = []

    def note(arbiter, space, data):
        sign = 1 if arbiter.bodies[0] is body else -1
        impulses.append(sign * arbiter.total_impulse)

    space.on_collision(post_solve=note)
    before = body.velocity
    for _ in range(40):
        impulses.clear()
        space.step(1 / 60)
        if impulses:
            break
        before = body.velocity
    change = body.velocity - before - Vec2d(*DOWN) / 60
    (impulse,) = impulses
    assert abs(impulse - change) < 1e-9
    assert change.y > 50


# What stays as it is


def drop(exact, prepare=None, shape=None):
    """Where an ellipse is after each step, from a throw on a floor."""
    space = new_space(exact)
    floor = add_floor(space, 0.9, 0.5)
    body = add_flyer(space, Flyer(20.0, 10.0, 0.0, 30.0, 0.3, 20.0, -100.0, 3.0))
    if shape is not None:
        space.remove(*body.shapes)
        other = shape(body)
        other.elasticity = other.friction = 1.0
        space.add(other)
    if prepare is not None:
        prepare(space, body, floor)
    path = []
    for _ in range(60):
        space.step(1 / 60)
        path.append((*body.position, body.angle))
    return path


def sensor(space, body, floor):
    floor.sensor = True


def joint(space, body, floor):
    space.add(pymunk.PivotJoint(body, space.static_body, (0, 100), (0, 100)))


def velocity_function(space, body, floor):
    body.velocity_func = lambda body, gravity, damping, dt: pymunk.Body.update_velocity(
        body, gravity, damping, dt
    )


def position_function(space, body, floor):
    body.position_func = lambda body, dt: pymunk.Body.update_position(body, dt)


def let_through(space, body, floor):
    def callback(arbiter, space, data):
        arbiter.process_collision = False

    space.on_collision(pre_solve=callback)


def let_through_from_the_start(space, body, floor):
    def callback(arbiter, space, data):
        arbiter.process_collision = False

    space.on_collision(0, 0, begin=callback)


def let_through_by_type(space, body, floor):
    def callback(arbiter, space, data):
        arbiter.process_collision = False

    space.on_collision(0, None, pre_solve=callback)


def nothing(space, body, floor):
    pass


def test_the_switch_changes_a_throw():
    off, on = drop(False, nothing), drop(True, nothing)
    assert off[:5] == on[:5]
    assert off != on


@pytest.mark.parametrize(
    "prepare",
    [
        sensor,
        joint,
        velocity_function,
        position_function,
        let_through,
        let_through_from_the_start,
        let_through_by_type,
    ],
)
def test_others_stay_as_they_are(prepare):
    assert drop(True, prepare) == drop(False, prepare)


@pytest.mark.parametrize(
    "shape",
    [
        lambda body: Ellipse(body, 12, 12),
        lambda body: pymunk.Circle(body, 12),
        lambda body: pymunk.Poly.create_box(body, (20, 10)),
    ],
)
def test_round_and_other_shapes_stay_as_they_are(shape):
    assert drop(True, shape=shape) == drop(False, shape=shape)


def test_a_slow_touch_stays_as_it_is():
    """Gravity gives as much in a step."""
    paths = []
    for exact in (False, True):
        space = new_space(exact)
        add_floor(space, 0.9, 0.5)
        body = add_flyer(space, Flyer(20.0, 10.0, 0.0, 10.12, vy=-8.0))
        path = []
        for _ in range(3):
            space.step(1 / 60)
            path.append((*body.position, body.angle))
        paths.append(path)
    assert paths[0] == paths[1]


def test_deep_overlaps_stay_as_they_are():
    """Those that overlapped a step ago have not met in it."""
    paths = []
    for exact in (False, True):
        space = new_space(exact, WEIGHTLESS)
        bodies = [
            add_flyer(space, Flyer(20.0, 10.0, x, 0.0, 0.3, vx=-x))
            for x in (-12.0, 12.0)
        ]
        path = []
        for _ in range(30):
            space.step(1 / 60)
            path.append([(*body.position, body.angle) for body in bodies])
        paths.append(path)
    assert paths[0] == paths[1]


# Callbacks


def test_what_touches_something_else_stays_as_it_is():
    """The impulse of a hit is not that of two bodies alone where one of them lies on a floor."""
    paths = []
    for exact in (True, False):
        space = new_space(exact)
        add_floor(space, friction=1.0)
        lying = Flyer(20.0, 10.0, 0.0, 10.0)
        body = add_flyer(space, lying, elasticity=0.0)
        hitting = add_flyer(space, Flyer(20.0, 10.0, 5.0, 60.0, 0.4, vy=-300.0), 0.5)
        path = []
        for _ in range(12):
            space.step(1 / 60)
            path += [*body.position, body.angle, *hitting.position, hitting.angle]
        assert hitting.velocity.y > -300.0
        paths.append(path)
    assert paths[0] == paths[1]


def test_bodies_that_no_impulse_moves_go_on():
    """A kinematic body that comes upon what is static, or kinematic as well."""
    for body_type in (pymunk.Body.KINEMATIC, pymunk.Body.STATIC):
        space = new_space()
        moving = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        moving.velocity = 400, 0
        still = pymunk.Body(body_type=body_type)
        still.position = 50, 3
        shapes = Ellipse(moving, 20, 10), Ellipse(still, 20, 10)
        space.add(moving, still, *shapes)
        step(space, 0.25, 1 / 60)
        assert moving.position == pytest.approx((100, 0))
        assert still.position == (50, 3)


@pytest.mark.parametrize("prepare", ["sensor", "ignored"])
def test_what_is_no_obstacle_is_not_touched(prepare):
    """An impact within a sensor, or within what a callback ignores, is one at its own time."""
    heights = []
    for there in (True, False):
        space = new_space()
        add_floor(space, elasticity=1.0)
        body = add_flyer(space, Flyer(20.0, 10.0, 0.0, 50.0, 0.3, vy=-200.0))
        if there:
            zone = pymunk.Circle(space.static_body, 1000)
            space.add(zone)
            if prepare == "sensor":
                zone.sensor = True
            else:
                zone.collision_type = 7
                space.on_collision(7, 0, pre_solve=ignore)
        step(space, 0.3, 1 / 60)
        heights.append(body.position.y)
    assert heights[0] == heights[1]


def ignore(arbiter, space, data):
    arbiter.process_collision = False


def test_callbacks_see_the_contact_of_the_impact():
    flyer = thrown(0.6, (1,), 0.8)[0]
    space = new_space()
    add_floor(space, 0.8)
    add_flyer(space, half_a_step_on(flyer, 1 / 60, DOWN), 1.0)
    at_impact = flyer.after(time_to_floor(flyer, DOWN, 1.0), DOWN)
    lowest = at_impact.support(0.0, -1.0)
    seen = []

    def note(arbiter, space, data):
        contact = arbiter.contact_point_set
        first = arbiter.shapes[0]
        side = "point_a" if isinstance(first, Ellipse) else "point_b"
        (body,) = (shape.body for shape in arbiter.shapes if isinstance(shape, Ellipse))
        seen.append((contact, getattr(contact.points[0], side) - body.position))

    space.on_collision(begin=note, pre_solve=note, post_solve=note)
    step(space, 0.6, 1 / 60)
    assert len(seen) == 3
    for contact, arm in seen:
        assert abs(contact.normal.y) == pytest.approx(1.0)
        # To the order of the step squared.
        assert arm == pytest.approx(lowest, abs=0.05)


@pytest.mark.parametrize("key", [(None, None), (0, 0), (0, None)])
@pytest.mark.parametrize("elasticity", [0.0, 0.5])
def test_restitution_that_a_callback_sets_is_that_of_the_impact(key, elasticity):
    def callback(arbiter, space, data):
        arbiter.restitution = elasticity

    paths = []
    for by_callback in (True, False):
        space = new_space()
        add_floor(space, 1.0 if by_callback else elasticity)
        if by_callback:
            space.on_collision(*key, pre_solve=callback)
        body = add_flyer(space, Flyer(20.0, 10.0, 0.0, 40.0, 0.3, 0.0, -100.0, 3.0))
        path = []
        for _ in range(60):
            space.step(1 / 60)
            path.append((*body.position, body.angle))
        paths.append(path)
    assert paths[0] == paths[1]


# What is hit is not carried too far


THIN = {
    "ellipse": lambda body: Ellipse(body, 30, 4),
    "segment": lambda body: pymunk.Segment(body, (-20, 0), (20, 0), 4),
    "polygon": lambda body: pymunk.Poly.create_box(body, (40, 6), 1),
    "circle": lambda body: pymunk.Circle(body, 4),
}


@pytest.mark.parametrize("kind", THIN)
def test_what_is_hit_is_not_carried_through_a_wall(kind):
    """A body on a thin wall, hit at any time of a step so hard that in a step it goes by its own half thickness."""
    for part in range(12):
        space = new_space(True, WEIGHTLESS)
        add_floor(space)
        body = pymunk.Body(1, 1000)
        body.position = 0, 4.5
        shape = THIN[kind](body)
        shape.elasticity = 1
        space.add(body, shape)
        add_flyer(space, Flyer(20.0, 10.0, 0.0, 21.0 + part / 3, vy=-240.0))
        for _ in range(10):
            space.step(1 / 60)
        assert body.position.y > 0


# The switch


def test_the_switch_is_off_by_default():
    space = Space()
    assert space.exact_impacts is False
    space.exact_impacts = True
    assert space.exact_impacts is True
    assert Space(exact_impacts=True).exact_impacts is True
    assert Space(True, exact_impacts=True).threaded


@pytest.mark.parametrize("value", [1, None, "yes"])
def test_the_switch_is_a_bool(value):
    message = f"exact_impacts must be True or False, got {value!r}"
    with pytest.raises(TypeError, match=message):
        Space(exact_impacts=value)
    with pytest.raises(TypeError, match=message):
        Space().exact_impacts = value


def test_the_switch_can_be_turned_while_a_space_runs():
    space = new_space(False)
    add_floor(space, 0.9, 0.5)
    body = add_flyer(space, Flyer(20.0, 10.0, 0.0, 30.0, 0.3, 20.0, -100.0, 3.0))
    space.step(1 / 60)
    space.exact_impacts = True
    path = []
    for _ in range(59):
        space.step(1 / 60)
        path.append((*body.position, body.angle))
    assert path == drop(True)[1:]


WAYS = [lambda space: space.copy(), lambda space: pickle.loads(pickle.dumps(space))]


@pytest.mark.parametrize("way", WAYS)
def test_a_copy_goes_on_as_the_original(way):
    """Also from the step of an impact on, whose way has not been gone yet."""
    space = new_space()
    add_floor(space, 0.9, 0.5)
    body = add_flyer(space, Flyer(20.0, 10.0, 0.0, 30.0, 0.3, 20.0, -100.0, 3.0))
    impacts = 0
    for _ in range(40):
        twin = way(space)
        assert twin.exact_impacts
        before = body.velocity.y
        space.step(1 / 60)
        twin.step(1 / 60)
        impacts += body.velocity.y > before
        (other,) = twin.bodies
        assert abs(other.position - body.position) < 1e-9
        assert other.angle == pytest.approx(body.angle, abs=1e-9)
    assert impacts > 1
