"""The references of the demos and tests: known numbers, and what every motion conserves."""

from __future__ import annotations

from dataclasses import replace
from math import inf, pi, sqrt

import pytest

from demos._oracles import (
    Flyer,
    Rolling,
    bouncing,
    colliding,
    distance,
    half_a_step_on,
    height,
    hit,
    landing,
    time_to_floor,
)

ROCKER = Rolling(20.0, 10.0, 500.0)
THROWN = Flyer(20.0, 10.0, 0.0, 60.0, 0.3, 10.0, 0.0, 2.0)
DOWN = 0.0, -500.0
MEETING = (
    Flyer(20.0, 10.0, -60.0, 0.0, 0.3, 100.0, 0.0, 2.0),
    Flyer(15.0, 10.0, 60.0, -6.0, 1.2, -100.0, 0.0, -2.0, mass=3.0),
)


def total(pair, quantity):
    return sum(quantity(body) for body in pair)


# Forty-digit quadrature.
@pytest.mark.parametrize(
    ("tilt", "period"), [(0.05, 0.773639), (0.2, 0.831387), (0.5, 1.082325)]
)
def test_period_of_rocking(tilt, period):
    assert ROCKER.period(tilt) == pytest.approx(period, abs=6e-7)


def test_period_of_small_rocking_is_that_of_a_pendulum():
    # k^2 + b^2 turns about the contact, with a^2/b - b to fall: 0.769530.
    small = 2 * pi * sqrt((125 + 100) / (500 * (40 - 10)))
    assert ROCKER.period(1e-3) == pytest.approx(small, rel=1e-5)


@pytest.mark.parametrize("offset", [(0.0, 0.0), (0.0, -3.0)])
def test_rocking_step_by_step_takes_the_period(offset):
    rocker = replace(ROCKER, offset=offset)
    angle, spin, way = rocker.after(0.2, 0.0, rocker.period(0.2))
    assert (angle, spin, way) == pytest.approx((0.2, 0.0, 0.0), abs=1e-8)
    assert rocker.after(0.2, 0.0, rocker.period(0.2) / 4)[0] == pytest.approx(
        0.0, abs=1e-8
    )


@pytest.mark.parametrize("offset", [(0.0, 0.0), (3.0, 1.0)])
@pytest.mark.parametrize("b", [10.0, 6.0])
def test_rolling_keeps_its_energy(b, offset):
    rolling = Rolling(10.0, b, 500.0, offset)
    angle, spin, _way = rolling.after(0.0, 5.0, 4.0)
    assert rolling.energy(angle, spin) == pytest.approx(rolling.energy(0.0, 5.0))


def test_slope_is_the_change_of_the_height():
    rolling = Rolling(20.0, 10.0, 500.0, (3.0, 1.0))
    for angle in (-2.0, 0.1, 1.0):
        change = rolling.height(angle + 1e-5) - rolling.height(angle - 1e-5)
        assert rolling.slope(angle) == pytest.approx(change / 2e-5)
        drop = rolling.height(angle + 0.3) - rolling.height(angle)
        assert rolling.drop(angle + 0.3, angle) == pytest.approx(drop)


def test_wheel_rolls_evenly():
    wheel = Rolling(10.0, 10.0, 500.0)
    assert wheel.after(0.0, -3.0, 2.0) == pytest.approx((-6.0, -3.0, 60.0))


def test_chipmunk_flies_from_half_a_step_on():
    dt = 1 / 60
    body = half_a_step_on(THROWN, dt, DOWN)
    for _ in range(30):
        # As cpBodyUpdatePosition and cpBodyUpdateVelocity do.
        body = replace(
            body,
            x=body.x + dt * body.vx,
            y=body.y + dt * body.vy,
            vy=body.vy - dt * 500,
        )
    later = THROWN.after(0.5, DOWN)
    assert (body.x, body.y) == pytest.approx((later.x, later.y))


def test_floor_is_hit_in_time():
    upright = Flyer(20.0, 10.0, 0.0, 45.0, pi / 2)
    assert time_to_floor(upright, DOWN, 1.0) == pytest.approx(sqrt(2 * 25 / 500))
    assert time_to_floor(upright, DOWN, 0.3) == inf


def test_ball_bounces():
    ball = Flyer(5.0, 5.0, 0.0, 5.0, vx=3.0, vy=100.0)
    # Flights of 0.4, 0.2 and 0.1 seconds, and half of one of 0.05.
    end, hits = bouncing(ball, 0.725, DOWN, 0.5, 0.0)
    assert hits == 3
    top = 5.0 + 12.5**2 / 1000.0
    assert (end.x, end.y, end.vy) == pytest.approx((2.175, top, 0.0), abs=1e-9)


def test_bouncing_without_friction_keeps_the_energy():
    end, hits = bouncing(THROWN, 1.5, DOWN, 1.0, 0.0)
    assert hits > 1
    assert end.energy(DOWN) == pytest.approx(THROWN.energy(DOWN))
    assert end.vx == THROWN.vx


def test_landing_goes_on_without_slip():
    time = time_to_floor(THROWN, DOWN, 1.0)
    angle, spin, x = landing(THROWN, time + 1e-12, 500.0)
    at = THROWN.after(time, DOWN)
    rolling = Rolling(20.0, 10.0, 500.0)
    assert (angle, x) == pytest.approx((at.angle, at.x))
    # About the contact point, which the impulse goes through.
    vx, vy = at.vx, at.vy
    about = at.square * at.spin - height(20.0, 10.0, angle) * vx
    about += rolling.slope(angle) * vy
    assert rolling.inertia(angle) * spin == pytest.approx(about)


@pytest.mark.parametrize("friction", [0.0, 0.1, 0.4, inf])
@pytest.mark.parametrize("elasticity", [0.5, 0.8, 1.0])
def test_collision_conserves_momentum(elasticity, friction):
    after, hits = colliding(MEETING, 1.0, elasticity, friction)
    assert hits == 1
    for quantity in (
        lambda body: body.mass * body.vx,
        lambda body: body.mass * body.vy,
        Flyer.angular_momentum,
    ):
        assert total(after, quantity) == pytest.approx(total(MEETING, quantity))
    before, left = total(MEETING, Flyer.energy), total(after, Flyer.energy)
    if friction == 0.0:
        assert left <= before * (1 + 1e-12)
        assert (left == pytest.approx(before)) == (elasticity == 1.0)


@pytest.mark.parametrize("friction", [0.05, 10.0])
def test_friction_brakes_and_no_more(friction):
    ball = Flyer(5.0, 5.0, 0.0, 5.0, vx=30.0, vy=-100.0)
    (after,) = hit((ball,), (0.0, 1.0), 0.5, friction)
    slip = after.velocity_at(0.0, -5.0)[0]
    assert after.vy == pytest.approx(50.0)
    if friction < 1.0:
        assert ball.vx - after.vx == pytest.approx(150 * friction)
        assert slip > 0.0
    else:
        assert slip == pytest.approx(0.0, abs=1e-12)


def test_distance_of_aligned_ellipses():
    one = Flyer(20.0, 10.0, 0.0, 0.0)
    assert distance(one, Flyer(20.0, 10.0, 43.0, 0.0)) == pytest.approx((3, 1, 0))
    assert distance(one, Flyer(20.0, 10.0, 0.0, -33.0, pi / 2)) == pytest.approx(
        (3, 0, -1), abs=1e-12
    )
    overlapped = distance(one, Flyer(20.0, 10.0, 39.0, 0.0))
    assert overlapped == pytest.approx((-1, 1, 0))
