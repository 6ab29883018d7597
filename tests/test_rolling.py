"""Rolling in time: with restitution, off the centre of gravity, and where a callback says how elastic it is."""

from __future__ import annotations

import random
from math import hypot, log2

import pymunk
import pytest

from demos._oracles import Rolling
from demos._stability import add_roller
from demos._variants import (
    shipped,
    with_elastic_rolling,
    without_rolling_of_wheels,
)
from pymunk_ellipse import Ellipse, Space
from pymunk_ellipse.narrowphase.rolling import with_restitution

GRAVITY = 500.0
RATES = 60, 120, 240, 480


def test_restitution_makes_no_energy_of_rolling():
    rng = random.Random(1)
    for _ in range(1000):
        along, elasticity = rng.uniform(-9, 9), rng.uniform(0, 1)
        speed = rng.uniform(-9, 9)
        x, y = with_restitution(along, 2.0, 1.0, 0.0, elasticity)
        # A solver gives what restitution makes of the speed, less this.
        after = -elasticity * speed - x
        assert abs(after) <= max(abs(speed), abs(along)) * (1 + 1e-12)
        assert y == 2.0
        # True rolling has that speed, and goes on.
        assert -elasticity * along - x == pytest.approx(-along)


def test_without_restitution_rolling_is_what_it_was():
    rng = random.Random(2)
    for _ in range(1000):
        x, y, nx, ny = (rng.uniform(-9, 9) for _ in range(4))
        assert with_restitution(x, y, nx, ny, 0.0) == (x, y)


def roll(body, shape, rolling, spin, elasticity, seconds, dt, space, prepare=None):
    """Let a body that is at the angle zero roll on a floor without slip, from a velocity of half a step on."""
    space.gravity = 0, -GRAVITY
    add_roller(space, body, shape, rolling, spin, dt, elasticity)
    if prepare is not None:
        prepare(space)
    for _ in range(round(seconds / dt)):
        space.step(dt)


def errors_of_rolling(elasticity, make_space=pymunk.Space, prepare=None, seconds=3.0):
    """Of an ellipse of 20 by 14, by the way that it has rolled."""
    rolling = Rolling(20.0, 14.0, GRAVITY)
    angle, _spin, way = rolling.after(0.0, -5.0, seconds, 20000)
    errors = []
    for rate in RATES:
        body = pymunk.Body(1, (400 + 196) / 4)
        shape = Ellipse(body, 20, 14)
        space = make_space()
        arguments = rolling, -5.0, elasticity, seconds, 1 / rate, space, prepare
        roll(body, shape, *arguments)
        errors.append(hypot(body.position.x - way, 14 * (body.angle - angle)) / way)
    return errors


def order(errors):
    return log2(errors[0] / errors[-1]) / (len(errors) - 1)


def test_elastic_rolling_is_of_second_order(backend):
    assert order(errors_of_rolling(0.5)) >= 2.0


def test_elastic_rolling_is_of_first_order_where_restitution_reverses_it():
    with with_elastic_rolling():
        assert order(errors_of_rolling(0.5)) < 1.3


@pytest.mark.parametrize("make_space", [pymunk.Space, Space])
@pytest.mark.parametrize("key", [(0, 0), (0, None), (None, None)])
def test_restitution_that_a_callback_sets_is_that_of_rolling(backend, make_space, key):
    def callback(arbiter, space, data):
        arbiter.restitution = 0.5

    def prepare(space):
        space.on_collision(*key, pre_solve=callback)

    by_callback = errors_of_rolling(1.0, make_space, prepare, 0.5)
    assert by_callback == errors_of_rolling(0.5, make_space, None, 0.5)


def test_a_surface_velocity_that_a_callback_sets_leaves_rolling(backend):
    """In both kinds of space: one of zero changes nothing."""

    def callback(arbiter, space, data):
        arbiter.surface_velocity = 0, 0

    def prepare(space):
        space.on_collision(0, 0, pre_solve=callback)

    for make_space in (pymunk.Space, Space):
        by_callback = errors_of_rolling(0.0, make_space, prepare, 0.5)
        assert by_callback == errors_of_rolling(0.0, make_space, None, 0.5)


def energy_kept(ratio, seconds=10.0, dt=1 / 240):
    """By a wheel that rolls with its centre of gravity beside the centre."""
    rolling = Rolling(10.0 * ratio, 10.0, GRAVITY, (-3.0, 0.0), 50.0)
    body = pymunk.Body(1, 50)
    shape = Ellipse(body, 10 * ratio, 10, (3, 0))
    roll(body, shape, rolling, -8.0, 0.0, seconds, dt, pymunk.Space())
    # The velocity is that of half a step on.
    height = body.position.y + body.velocity.y * dt / 2
    energy = body.kinetic_energy / 2 + GRAVITY * height
    return energy / rolling.energy(0.0, -8.0)


def test_a_wheel_off_its_centre_of_gravity_keeps_its_energy(backend):
    kept = energy_kept(1.0)
    assert kept == pytest.approx(1.0, abs=1e-3)
    assert kept == pytest.approx(energy_kept(1 + 1e-9), abs=1e-6)
    assert kept == pytest.approx(energy_kept(1 + 1e-15), abs=1e-9)


def test_a_wheel_loses_its_energy_without_the_rolling_correction():
    with without_rolling_of_wheels():
        assert energy_kept(1.0) < 0.95
    with shipped():
        assert energy_kept(1.0) > 0.999
