"""Mass, moment of inertia and area."""

from math import hypot, nan, pi

import numpy as np
import pymunk
import pytest
from scenes import lone_body

from pymunk_ellipse import Ellipse, area_for_ellipse, moment_for_ellipse


def test_area_functions():
    assert area_for_ellipse(3, 2) == pytest.approx(6 * pi)
    assert area_for_ellipse(2, 2) == pytest.approx(pymunk.area_for_circle(0, 2))


def test_moment_function():
    assert moment_for_ellipse(5, 2, 2) == pytest.approx(
        pymunk.moment_for_circle(5, 0, 2)
    )
    assert moment_for_ellipse(5, 2, 2, (3, 4)) == pytest.approx(
        pymunk.moment_for_circle(5, 0, 2, (3, 4))
    )
    assert moment_for_ellipse(4, 3, 1) == pytest.approx(10)
    # As the sum over a fine grid.
    u, v = np.meshgrid(np.linspace(-3, 3, 1201), np.linspace(-1, 1, 401))
    inside = (u / 3) ** 2 + v**2 <= 1
    distance2 = (u[inside] + 2) ** 2 + (v[inside] - 1) ** 2
    assert moment_for_ellipse(1, 3, 1, (2, -1)) == pytest.approx(
        distance2.mean(), rel=1e-3
    )


@pytest.mark.parametrize(
    "function", [area_for_ellipse, lambda *s: moment_for_ellipse(1, *s)]
)
@pytest.mark.parametrize(
    ("a", "b", "error", "message"),
    [
        (-1, 1, ValueError, "a must be positive, got -1"),
        (1, nan, ValueError, "b must be finite, got nan"),
        (1, "1", TypeError, "b must be a number, got '1'"),
    ],
)
def test_area_and_moment_check(function, a, b, error, message):
    with pytest.raises(error, match=message):
        function(a, b)


def test_moment_checks_mass_and_offset():
    with pytest.raises(ValueError, match="mass must be finite, got nan"):
        moment_for_ellipse(nan, 2, 1)
    with pytest.raises(TypeError, match=r"offset\[0\] must be a number, got 'x'"):
        moment_for_ellipse(1, 2, 1, ("x", 0))


def total(parts):
    """Mass, moment about the centre of gravity and centre of gravity of (mass, a, b, offset)."""
    mass = sum(part[0] for part in parts)
    x = sum(m * offset[0] for m, _, _, offset in parts) / mass
    y = sum(m * offset[1] for m, _, _, offset in parts) / mass
    moment = sum(
        m * ((a * a + b * b) / 4 + hypot(offset[0] - x, offset[1] - y) ** 2)
        for m, a, b, offset in parts
    )
    return mass, moment, (x, y)


def check_mass(body, parts):
    mass, moment, center = total(parts)
    assert body.mass == pytest.approx(mass, rel=1e-12)
    assert body.moment == pytest.approx(moment, rel=1e-9)
    assert body.center_of_gravity == pytest.approx(center, abs=1e-9)


@pytest.mark.parametrize("when", ["before", "after"])
@pytest.mark.parametrize("how", ["mass", "density"])
@pytest.mark.parametrize("aspect", [1.0, 2.0, 100.0])
def test_mass(aspect, how, when):
    space = pymunk.Space()
    body = pymunk.Body()
    egg = Ellipse(body, aspect, 1, angle=0.4)

    def weigh():
        setattr(egg, how, 3)

    if when == "before":
        weigh()
    space.add(body, egg)
    if when == "after":
        weigh()
    mass = 3 if how == "mass" else 3 * pi * aspect
    check_mass(body, [(mass, aspect, 1, (0, 0))])
    assert egg.mass == pytest.approx(mass)
    assert egg.density == pytest.approx(mass / (pi * aspect))
    assert egg.moment == pytest.approx(mass * (aspect**2 + 1) / 4, rel=1e-9)
    assert egg.center_of_gravity == pytest.approx((0, 0), abs=1e-12)
    space.step(0.01)
    check_mass(body, [(mass, aspect, 1, (0, 0))])


@pytest.mark.parametrize("when", ["before", "after"])
def test_several_on_a_body(when):
    space = pymunk.Space()
    body = pymunk.Body()
    parts = [(2, 3, 1, (4, 0)), (5, 1, 2, (-1, 2)), (1, 1, 1, (0, -7))]
    eggs = [Ellipse(body, a, b, offset, 0.3 * a) for _, a, b, offset in parts]
    if when == "after":
        space.add(body, *eggs)
    for egg, (mass, *_) in zip(eggs, parts, strict=True):
        egg.mass = mass
    if when == "before":
        space.add(body, *eggs)
    check_mass(body, parts)

    # Changed later, and one fewer.
    eggs[1].mass = 10
    parts[1] = (10, *parts[1][1:])
    check_mass(body, parts)
    space.remove(eggs[0])
    check_mass(body, parts[1:])


def test_with_a_native_shape():
    space = pymunk.Space()
    body = pymunk.Body()
    egg = Ellipse(body, 2, 1, (3, 0))
    ball = pymunk.Circle(body, 2, (-3, 0))
    space.add(body, egg, ball)
    egg.mass = ball.mass = 1
    check_mass(body, [(1, 2, 1, (3, 0)), (1, 2, 2, (-3, 0))])


def test_mass_follows_the_semi_axes():
    """As for pymunk's own shapes, mass stays and the moment follows."""
    space = pymunk.Space()
    body = pymunk.Body()
    egg = Ellipse(body, 2, 1)
    egg.mass = 3
    space.add(body, egg)
    egg.unsafe_set_semi_axes(4, 2)
    check_mass(body, [(3, 4, 2, (0, 0))])
    egg.unsafe_set_offset((5, 0))
    check_mass(body, [(3, 4, 2, (5, 0))])


def test_changes_leave_the_bodys_own_mass_alone():
    space = pymunk.Space()
    egg = Ellipse(lone_body(), 2, 1)
    space.add(egg.body, egg)
    egg.unsafe_set_semi_axes(4, 2)
    assert egg.body.mass == 1
    assert egg.body.moment == 1


def test_heavier_falls_as_fast():
    space = pymunk.Space()
    space.gravity = 0, -10
    body = pymunk.Body()
    egg = Ellipse(body, 2, 1, (3, 1))
    egg.density = 2
    space.add(body, egg)
    for _ in range(100):
        space.step(0.01)
    assert body.velocity == pytest.approx((0, -10))
    assert body.angular_velocity == 0
