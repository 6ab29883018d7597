"""Scenes in which something fails: the ellipse keeps the bound that physics sets, and does not without its safeguards."""

from __future__ import annotations

import random
from statistics import median

import pytest

from demos._builders import (
    ELLIPSE,
    EXACT_IMPACTS,
    GRAVITY,
    Kind,
    add_gas,
    kinetic_energy,
    polygon,
    steps,
)
from demos._oracles import Rolling
from demos._stability import (
    SCENES,
    highest_stack,
    joined_segments,
    off_path,
    rock,
    softest_mode,
    stack,
    tiles,
)
from demos._variants import VARIANTS

A, B, _SPIN = 15.0, 10.0, -6.0


def measured(name, kind=ELLIPSE, step=1.0):
    scene = SCENES[name]
    return scene.run(kind, step * scene.step)


@pytest.mark.parametrize("name", SCENES)
def test_ellipse_keeps_the_bound(name):
    assert measured(name) <= SCENES[name].bound


@pytest.mark.parametrize(
    ("name", "variant"),
    [
        ("stack that stands", "no warm start"),
        ("wedge", "no warm start"),
        ("heavy on light", "no warm start"),
        ("pile", "no warm start"),
        ("tiles", "no rolling correction"),
        ("joined segments", "no handover"),
        ("born overlapped", "no sweep"),
        ("born overlapped", "published fit"),
        ("elastic gas", "elastic rolling"),
        ("elastic roller", "elastic rolling"),
        ("elastic roller", "no rolling correction"),
        ("wheel off its centre", "no rolling of wheels"),
    ],
)
def test_bound_is_broken_without_a_safeguard(name, variant):
    with VARIANTS[variant]():
        assert not measured(name) <= SCENES[name].bound


@pytest.mark.parametrize(
    "name",
    [
        "stack that stands",
        "stack that falls",
        "needle on its side",
        "two needles",
        "wedge",
        "heavy on light",
        "born in one place",
        "joined segments",
        "tiles",
        "elastic gas",
        "elastic roller",
        "wheel off its centre",
        "cam",
    ],
)
def test_bound_is_broken_by_a_polygon(name):
    assert not measured(name, polygon(16)) <= SCENES[name].bound


@pytest.mark.parametrize("kind", [ELLIPSE, EXACT_IMPACTS], ids=["plain", "exact"])
@pytest.mark.parametrize("rate", [60, 120])
@pytest.mark.parametrize("aspect_ratio", [1.5, 2.0, 3.0])
def test_gas_keeps_its_energy_and_shares_it(aspect_ratio, rate, kind):
    space = kind.new_space(0.0)
    b = 5.0
    add_gas(space, kind.make, aspect_ratio * b, b)
    start = kinetic_energy(space)
    shares = []
    for time in steps(space, 60.0, 1 / rate):
        energy = kinetic_energy(space)
        assert energy == pytest.approx(start, rel=0.01)
        if time > 10.0:
            turning = sum(
                body.moment * body.angular_velocity**2 for body in space.bodies
            )
            shares.append(turning / 2.0 / energy)
    # One of three degrees of freedom each has.
    assert sum(shares) / len(shares) == pytest.approx(1 / 3, abs=0.05)


@pytest.mark.parametrize("kind", [ELLIPSE, EXACT_IMPACTS], ids=["plain", "exact"])
@pytest.mark.parametrize("aspect_ratio", [1.5, 3.0])
def test_gas_with_friction_gains_nothing(aspect_ratio, kind):
    """In a single hit it may: Newton's law of restitution and Coulomb's of friction do not go together."""
    space = kind.new_space(0.0)
    add_gas(space, kind.make, aspect_ratio * 5.0, 5.0)
    for shape in space.shapes:
        shape.friction = 0.5
    start = kinetic_energy(space)
    energies = [kinetic_energy(space) / start for _ in steps(space, 60.0, 1 / 60)]
    assert max(energies) <= 1.001
    # A quarter of a minute is enough to lose some for certain.
    assert max(energies[900:]) < 0.95


# Those whose end is another with the least change of the start.
CHAOTIC = {"heavy on light", "pile", "elastic gas", "mixed pile", "wedge"}


@pytest.mark.parametrize("name", SCENES)
def test_exact_impacts_make_nothing_worse(name):
    exact = measured(name, EXACT_IMPACTS)
    assert exact <= SCENES[name].bound
    if name not in CHAOTIC:
        assert exact <= 1.1 * measured(name)


def nudged(kind, seed):
    """With bodies that start a little elsewhere."""
    rng = random.Random(seed)

    def make(body, a, b):
        body.position += rng.uniform(-0.01, 0.01), rng.uniform(0.0, 0.02)
        return kind.make(body, a, b)

    return Kind(make, kind.make_space)


@pytest.mark.parametrize("name", sorted(CHAOTIC))
def test_exact_impacts_make_nothing_worse_on_average(name):
    """Medians of 7 starts, which scatter by half of themselves."""
    plain, exact = (
        median(measured(name, nudged(kind, seed)) for seed in range(7))
        for kind in (ELLIPSE, EXACT_IMPACTS)
    )
    assert exact <= max(1.5 * plain, 0.1 * SCENES[name].bound)


@pytest.mark.parametrize(
    "name",
    [
        "needle on its tip",
        "needle on its side",
        "spinning landing",
        "closing walls",
        "pile",
        "tiles",
    ],
)
def test_bound_is_broken_by_a_large_step(name):
    assert not measured(name, step=4.0) <= SCENES[name].bound


def test_rocking_dies_down_without_the_rolling_correction():
    with VARIANTS["no rolling correction"]():
        lost = rock(ELLIPSE, 1 / 240, 20.0)
    assert lost > SCENES["rocking for minutes"].bound
    assert rock(ELLIPSE, 1 / 240, 20.0) < 1e-3


def test_exact_impacts_lose_nothing_that_is_squeezed():
    """Starts in which a light ellipse came out of the box where impacts were those of two bodies alone."""

    def damped(seed):
        def make_space():
            space = EXACT_IMPACTS.make_space()
            space.damping = 1 - 4e-5 * seed
            return space

        return Kind(EXACT_IMPACTS.make, make_space)

    depths = [measured("heavy on light", damped(seed)) for seed in (15, 16, 17, 19, 31)]
    assert max(depths) < 1.0


def test_highest_stacks():
    # a^2 > b^2 for one and a^2 > 3 b^2 for two, by hand.
    assert highest_stack(1.01, 1.0) == 1
    assert highest_stack(3**0.5 - 1e-3, 1.0) == 1
    assert highest_stack(3**0.5 + 1e-3, 1.0) == 2
    assert [highest_stack(ratio, 1.0) for ratio in (3.0, 5.0, 10.0)] == [3, 5, 12]


def test_stack_of_one_rocks_with_the_period_of_an_ellipse():
    square, tilts, _shifts = softest_mode(1, 20.0, 10.0)
    # (k^2 + b^2) / (g (a^2/b - b))
    assert 1 / square == pytest.approx((125 + 100) / (500 * 30))
    assert tilts == [1.0]
    # Released at 0.05, with 40-digit quadrature: 0.773639.
    assert Rolling(20.0, 10.0, GRAVITY).period(0.05) == pytest.approx(
        0.773639, rel=1e-6
    )


def test_highest_stack_stands_and_one_more_falls():
    a, b = 30.0, 10.0
    count = highest_stack(a, b)
    standing = [tilt for _, tilt in stack(ELLIPSE, 1 / 240, count, a, b, 0.005, 6.0)]
    falling = [tilt for _, tilt in stack(ELLIPSE, 1 / 240, count + 1, a, b, 0.005, 6.0)]
    assert max(standing) < 2.0
    assert falling[-1] > 10.0


@pytest.mark.parametrize("length", [0.5, 1.0, 2.0, 5.0])
def test_joined_segments_of_any_length_are_one_floor(length):
    def ground(space):
        joined_segments(space, length * A)

    assert off_path(ELLIPSE, 1 / 240, ground) < SCENES["joined segments"].bound


def test_joints_of_tiles_matter_less_with_shorter_steps():
    coarse, fine = (
        off_path(ELLIPSE, dt, lambda space: tiles(space, A), 2.0)
        for dt in (1 / 240, 1 / 960)
    )
    assert fine < coarse / 3.0
