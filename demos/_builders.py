"""What the scenes are made of: shapes that stand for ellipses and the spaces they move in, floors and walls, a pile and a gas."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from math import cos, pi, sin

import pymunk

from pymunk_ellipse import Ellipse, Space, moment_for_ellipse

from ._oracles import Flyer, distance
from ._shapes import circle_of_equal_area, inscribed_polygon

GRAVITY = 500.0
# Enough that nothing slips where a scene is about rolling.
NO_SLIP = 10.0

# Makes the shape that stands for an ellipse with these semi-axes.
Make = Callable[[pymunk.Body, float, float], pymunk.Shape]


@dataclass(frozen=True)
class Kind:
    """What stands for an ellipse in a scene: a shape, and the space that it moves in."""

    make: Make
    make_space: Callable[[], pymunk.Space] = pymunk.Space

    def new_space(self, gravity: float = GRAVITY) -> pymunk.Space:
        space = self.make_space()
        space.gravity = 0.0, -gravity
        return space


ELLIPSE = Kind(Ellipse)
EXACT_IMPACTS = Kind(Ellipse, partial(Space, exact_impacts=True))
CIRCLE = Kind(circle_of_equal_area)


def polygon(count: int) -> Kind:
    """With its vertices on the ellipse."""
    return Kind(partial(inscribed_polygon, count=count))


def add_wall(
    space: pymunk.Space,
    start: tuple[float, float],
    end: tuple[float, float],
    friction: float = NO_SLIP,
) -> pymunk.Segment:
    wall = pymunk.Segment(space.static_body, start, end, 0.0)
    wall.friction = friction
    space.add(wall)
    return wall


def add_floor(space: pymunk.Space, friction: float = NO_SLIP) -> pymunk.Segment:
    return add_wall(space, (-1e4, 0.0), (1e4, 0.0), friction)


def add_body(
    space: pymunk.Space,
    make: Make,
    a: float,
    b: float,
    x: float,
    y: float,
    angle: float = 0.0,
    mass: float = 1.0,
    friction: float = NO_SLIP,
) -> pymunk.Body:
    body = pymunk.Body()
    body.position = x, y
    body.angle = angle
    shape = make(body, a, b)
    shape.mass = mass
    shape.friction = friction
    space.add(body, shape)
    return body


def steps(space: pymunk.Space, seconds: float, dt: float) -> Iterator[float]:
    """Step the space, and give the time after each step."""
    for i in range(round(seconds / dt)):
        space.step(dt)
        yield (i + 1) * dt


def energy(body: pymunk.Body) -> float:
    """Kinetic and potential energy."""
    # body.kinetic_energy is twice the kinetic energy.
    return body.kinetic_energy / 2.0 + body.mass * GRAVITY * body.position.y


def separation(
    first: pymunk.Body, a1: float, b1: float, second: pymunk.Body, a2: float, b2: float
) -> float:
    """Distance of two ellipses, or minus their penetration depth, found independently of the package."""
    flyers = (
        Flyer(a, b, *body.position, body.angle)
        for body, a, b in ((first, a1, b1), (second, a2, b2))
    )
    return distance(*flyers)[0]


def add_pile(
    space: pymunk.Space, make: Make, count: int = 60, seed: int = 5
) -> list[pymunk.Body]:
    """Ellipses of aspect ratio 2 above the floor of a box, six in a row, about to fall; returns their bodies."""
    a, b, half_width = 20.0, 10.0, 130.0
    rng = random.Random(seed)
    add_floor(space, 0.5)
    for side in (-1.0, 1.0):
        add_wall(space, (side * half_width, 0.0), (side * half_width, 2e3), 0.5)
    bodies = []
    for i in range(count):
        row, column = divmod(i, 6)
        x = (column - 2.5) * 42.0 + rng.uniform(-0.5, 0.5)
        y = 25.0 + 42.0 * row
        angle = rng.uniform(-pi / 2.0, pi / 2.0)
        bodies.append(add_body(space, make, a, b, x, y, angle, friction=0.5))
    return bodies


def mean_square_speed(bodies: list[pymunk.Body]) -> float:
    """Of bodies of mass 1, with what they spin counted by its energy."""
    return sum(body.kinetic_energy for body in bodies) / len(bodies)


def add_gas(
    space: pymunk.Space,
    make: Make,
    a: float = 10.0,
    b: float = 5.0,
    columns: int = 5,
    rows: int = 4,
) -> None:
    """Elastic shapes of mass 1 without friction in a closed box, all as fast at first; the space should have no gravity."""
    rng = random.Random(1)
    pitch = 2.4 * a
    width, height = columns * pitch, rows * pitch
    corners = (0.0, 0.0), (width, 0.0), (width, height), (0.0, height)
    for i, corner in enumerate(corners):
        wall = add_wall(space, corners[i - 1], corner, 0.0)
        wall.elasticity = 1.0
    for i in range(columns * rows):
        body = pymunk.Body(1.0, moment_for_ellipse(1.0, a, b))
        row, column = divmod(i, columns)
        body.position = (column + 0.5) * pitch, (row + 0.5) * pitch
        body.angle = rng.uniform(0.0, pi)
        direction = rng.uniform(0.0, 2.0 * pi)
        body.velocity = 100.0 * cos(direction), 100.0 * sin(direction)
        shape = make(body, a, b)
        shape.elasticity = 1.0
        space.add(body, shape)


def kinetic_energy(space: pymunk.Space) -> float:
    """Of all bodies."""
    # body.kinetic_energy is twice the kinetic energy.
    return sum(body.kinetic_energy for body in space.bodies) / 2.0


def gas_energy(kind: Kind, dt: float, seconds: float) -> float:
    """The energy that an elastic gas has after some time, by that at the start."""
    space = kind.new_space(0.0)
    add_gas(space, kind.make)
    start = kinetic_energy(space)
    for _ in steps(space, seconds, dt):
        pass
    return kinetic_energy(space) / start
