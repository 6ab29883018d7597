"""Impacts at their time, as pure functions: against bodies that are moved and pushed, and motions that can be solved."""

from __future__ import annotations

import random
from dataclasses import replace
from math import cos, hypot, inf, pi, sin

import pytest

from demos._oracles import Flyer, Rolling, half_a_step_on, hit
from pymunk_ellipse.narrowphase.ellipse_ellipse import ellipse_ellipse
from pymunk_ellipse.narrowphase.impact import (
    carried_on,
    contact_mass,
    lasting_speed,
    meeting_earlier,
    predicted_impulse,
    relative_velocity,
    seen_earlier,
)


def motion(body):
    return body.x, body.y, body.vx, body.vy, body.spin


def frame(body):
    return body.a, body.b, cos(body.angle), sin(body.angle), body.x, body.y


def inertia(body):
    return 1 / body.mass, 1 / (body.mass * body.square)


def pairs(count=30):
    rng = random.Random(2)
    for _ in range(count):
        one, other = (
            Flyer(
                rng.uniform(10, 20),
                rng.uniform(5, 10),
                x,
                rng.uniform(-5, 5),
                rng.uniform(0, pi),
                rng.uniform(-50, 50),
                rng.uniform(-50, 50),
                rng.uniform(-9, 9),
                rng.uniform(0.5, 4),
            )
            for x in (0.0, 28.0)
        )
        yield one, other


def meeting_of(one, other):
    distance, nx, ny, px, py = ellipse_ellipse(frame(one), frame(other), 0.0, 0.0)
    ox, oy = one.x + px + distance * nx, one.y + py + distance * ny
    return distance, nx, ny, px, py, ox - other.x, oy - other.y


def test_meeting_earlier_is_that_of_both_moved_back():
    for one, other in pairs():
        time = 0.05
        seen = seen_earlier(frame(one), motion(one), motion(other), time)
        contact = ellipse_ellipse(seen, frame(other), 0.0, 0.0)
        found = meeting_earlier(contact, seen, motion(one), motion(other), time)
        expected = meeting_of(one.after(-time), other.after(-time))
        assert found == pytest.approx(expected, abs=1e-9)


def test_meeting_of_an_ellipse_beside_its_centre_of_gravity():
    # A quarter turn ago the arm of 3 pointed down; both have come 1 to the right.
    wheel = 5.0, 5.0, 1.0, 0.0, 3.0, 0.0
    body = 0.0, 0.0, 2.0, 0.0, pi
    floor = 0.0, -20.0, 2.0, 0.0, 0.0
    seen = seen_earlier(wheel, body, floor, 0.5)
    assert seen[4:] == pytest.approx((0.0, -3.0))
    found = meeting_earlier((12.0, 0.0, -1.0, 0.0, -5.0), seen, body, floor, 0.5)
    assert found == pytest.approx((12.0, 0.0, -1.0, 0.0, -8.0, 0.0, 0.0))


def test_relative_velocity_is_that_of_the_touching_points():
    for one, other in pairs():
        meeting = meeting_of(one, other)
        _distance, nx, ny, px, py, qx, qy = meeting
        vx, vy = one.velocity_at(px, py)
        wx, wy = other.velocity_at(qx, qy)
        across = (wy - vy) * nx - (wx - vx) * ny
        along = (wx - vx) * nx + (wy - vy) * ny
        found = relative_velocity(motion(one), motion(other), meeting)
        assert found == pytest.approx((along, across))


def test_contact_mass_is_what_a_push_does():
    for one, other in pairs():
        meeting = meeting_of(one, other)
        _distance, nx, ny, *_arms = meeting

        def velocity(jx, jy, one=one, other=other, meeting=meeting):
            pushed = (
                one.pushed(-jx, -jy, *meeting[3:5]),
                other.pushed(jx, jy, *meeting[5:]),
            )
            return relative_velocity(*map(motion, pushed), meeting)

        rest, normal, tangential = velocity(0, 0), velocity(nx, ny), velocity(-ny, nx)
        nn, nt, tt = contact_mass(inertia(one), inertia(other), meeting)
        assert normal[0] - rest[0] == pytest.approx(nn)
        assert normal[1] - rest[1] == pytest.approx(nt)
        assert tangential[0] - rest[0] == pytest.approx(nt)
        assert tangential[1] - rest[1] == pytest.approx(tt)


@pytest.mark.parametrize("friction", [0.0, 0.2, 0.8])
@pytest.mark.parametrize("elasticity", [0.0, 0.7, 1.0])
def test_predicted_impulse_tends_to_the_laws_of_impact(elasticity, friction):
    for one, other in pairs():
        meeting = meeting_of(one, other)
        _distance, nx, ny, px, py, qx, qy = meeting
        un, ut = relative_velocity(motion(one), motion(other), meeting)
        if un > -1.0:
            continue
        mass = contact_mass(inertia(one), inertia(other), meeting)
        jn, jt = predicted_impulse(mass, un, ut, elasticity, friction, 3000)
        jx, jy = jn * nx - jt * ny, jn * ny + jt * nx
        expected = hit((one, other), (nx, ny), elasticity, friction)
        # Arms of the two at the normal, as if they just touched.
        assert one.pushed(-jx, -jy, px, py).spin == pytest.approx(
            expected[0].spin, abs=1e-6
        )
        assert other.pushed(jx, jy, qx, qy).vx == pytest.approx(
            expected[1].vx, abs=1e-6
        )


def test_predicted_impulse_of_no_approach_is_none():
    assert predicted_impulse((1.0, 0.2, 1.0), 0.5, 3.0, 0.5, 1.0, 10) == (0.0, 0.0)


@pytest.mark.parametrize("time", [0.0, 0.2, 0.7, 1.0])
@pytest.mark.parametrize("elasticity", [0.3, 0.8, 1.0])
def test_a_bounce_goes_on_as_in_flight(elasticity, time):
    """The velocity of half a step on, and the place, of a point that hit the floor a part of the step ago, by the flight."""
    dt, gravity, speed = 0.01, -500.0, -60.0
    time *= dt
    struck = Flyer(1.0, 1.0, 0.0, 0.0, vy=speed)
    before = half_a_step_on(struck, -dt + 2 * time, (0.0, gravity))
    after = replace(struck, vy=-elasticity * speed).after(time + dt / 2, (0.0, gravity))
    rise, _, moved, bounce = carried_on(
        before.vy, (gravity, 0.0), elasticity, time, dt, 0.1
    )
    assert -elasticity * before.vy + rise == pytest.approx(after.vy)
    assert (moved, bounce) == (time, elasticity)


def test_what_friction_stops_is_accelerated_again():
    dt, time = 0.01, 0.003
    _, along, _, _ = carried_on(-60.0, (0.0, 40.0), 0.5, time, dt, 0.1)
    assert along == pytest.approx(40.0 * (time + dt / 2))


def test_what_does_not_bounce_stays_in_touch():
    dt, time, slop = 0.01, 0.008, 0.1
    for elasticity in (0.0, 0.01):
        rise, along, moved, bounce = carried_on(
            -60.0, (-500.0, 7.0), elasticity, time, dt, slop
        )
        assert (rise, along, bounce) == (0.0, 0.0, 0.0)
        # As far back as leaves the slop.
        assert 60.0 * (time - moved) == pytest.approx(slop)
    assert carried_on(-60.0, (0.0, 0.0), 0.0, 1e-4, dt, slop)[2] == 0.0


@pytest.mark.parametrize("dt", [1 / 30, 1 / 60, 1 / 240])
def test_rolling_is_no_impact(dt):
    """Wherever an ellipse is met that rolls on, its approach is one that lasts."""
    rolling = Rolling(20.0, 10.0, 500.0)
    angle, spin = 0.1, -6.0
    floor = 0.0, 0.0, 0.0, 0.0, 0.0
    for _ in range(100):
        angle, spin, _way = rolling.after(angle, spin, 0.02, 20)
        # The velocities of a step are those of its middle, the contact that of its end.
        middle, middle_spin, _way = rolling.after(angle, spin, -dt / 2, 20)
        body = (0.0, 0.0, *rolling.velocity(middle, middle_spin), middle_spin)
        h = rolling.height(angle)
        arm = -rolling.slope(angle), -h
        meeting = (0.0, 0.0, -1.0, *arm, *arm)
        un, _ut = relative_velocity(body, floor, meeting)
        radius = (20.0 * 10.0) ** 2 / h**3
        speed = lasting_speed(body, floor, meeting, radius, 0.0, 500.0, dt)
        assert -un < speed
    assert hypot(*arm) > 10.0


@pytest.mark.parametrize("dt", [1 / 30, 1 / 60, 1 / 240])
def test_what_has_not_touched_for_a_step_is_no_impact(dt):
    """An ellipse that rolls, and on nothing for a step, comes down no faster than what lasts."""
    rolling = Rolling(20.0, 10.0, 500.0)
    floor = 0.0, 0.0, 0.0, 0.0, 0.0
    for angle in (0.0, 0.3, 1.0, pi / 2, 2.0):
        # Its velocity is that of the first step's middle, and gravity's of one step.
        middle, spin, _way = rolling.after(angle, 5.0, dt / 2, 20)
        x, y = rolling.velocity(middle, spin)
        left = Flyer(20.0, 10.0, 0.0, rolling.height(angle), angle, x, y, spin)
        once = left.after(dt)
        back = replace(once, vy=once.vy - 500.0 * dt).after(dt)
        px, py = back.support(0.0, -1.0)
        meeting = (0.0, 0.0, -1.0, px, py, px, py)
        un, _ut = relative_velocity(motion(back), floor, meeting)
        radius = (20.0 * 10.0) ** 2 / rolling.height(back.angle) ** 3
        speed = lasting_speed(motion(back), floor, meeting, radius, 0.0, 500.0, dt)
        # To the order of the step.
        assert -un < speed * (1 + 3 * dt)


def test_a_throw_is_an_impact():
    body, floor = (0.0, 0.0, 0.0, -30.0, 0.0), (0.0, 0.0, 0.0, 0.0, 0.0)
    meeting = -0.1, 0.0, -1.0, 0.0, -10.0, 0.0, 0.0
    assert lasting_speed(body, floor, meeting, 40.0, 0.0, 500.0, 1 / 60) < 30.0
    assert lasting_speed(body, floor, meeting, 40.0, 0.0, inf, 1 / 60) == inf
