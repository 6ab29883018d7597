"""A box that many like shapes fall into, and what can be measured on it."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass, field
from math import ceil, pi
from typing import Any

import pymunk

GRAVITY = 500.0
STEP = 1.0 / 120.0
FRICTION = 0.5
GAP = 1.0
BOX = 1

MakeShape = Callable[[pymunk.Body], pymunk.Shape]


@dataclass
class Box:
    """A floor between two walls, and the shapes in it."""

    width: float
    space: pymunk.Space = field(default_factory=pymunk.Space)
    shapes: list[pymunk.Shape] = field(default_factory=list)
    impulse: pymunk.Vec2d = field(default_factory=pymunk.Vec2d.zero)

    def __post_init__(self) -> None:
        self.space.gravity = 0.0, -GRAVITY
        # High enough for whatever falls, without a lid.
        height = 10.0 * self.width
        for start, end in (
            ((0.0, 0.0), (self.width, 0.0)),
            ((0.0, 0.0), (0.0, height)),
            ((self.width, 0.0), (self.width, height)),
        ):
            side = pymunk.Segment(self.space.static_body, start, end, 0.0)
            side.friction = FRICTION
            side.collision_type = BOX
            self.space.add(side)

    def weigh(self) -> None:
        """Measure from now on the impulse that each step's contacts give to the floor and the walls."""
        self.space.on_collision(BOX, None, post_solve=self._add_impulse)

    def _add_impulse(
        self, arbiter: pymunk.Arbiter, space: pymunk.Space, data: Any
    ) -> None:
        self.impulse += arbiter.total_impulse

    def add(
        self, make_shape: MakeShape, position: tuple[float, float], angle: float
    ) -> None:
        """Add a body of mass 1 at this position and angle."""
        body = pymunk.Body()
        body.position = position
        body.angle = angle
        shape = make_shape(body)
        shape.mass = 1.0
        shape.friction = FRICTION
        self.space.add(body, shape)
        self.shapes.append(shape)

    def step(self) -> None:
        self.impulse = pymunk.Vec2d.zero()
        self.space.step(STEP)

    def count_contacts(self) -> int:
        """Step once more, and count the pairs of shapes that touch in it."""
        touching = 0

        def count(arbiter: pymunk.Arbiter, space: pymunk.Space, data: Any) -> None:
            nonlocal touching
            touching += 1

        self.space.on_collision(None, None, post_solve=count)
        self.step()
        return touching

    @property
    def bodies(self) -> list[pymunk.Body]:
        return [shape.body for shape in self.shapes if shape.body is not None]

    @property
    def mass(self) -> float:
        return sum(body.mass for body in self.bodies)

    @property
    def energy_per_mass(self) -> float:
        """Kinetic energy of all bodies by their mass."""
        # body.kinetic_energy is twice the kinetic energy.
        return sum(body.kinetic_energy for body in self.bodies) / 2.0 / self.mass

    @property
    def load(self) -> float:
        """Force of the last step's contacts on the floor and the walls, downwards, by the weight of the bodies."""
        return -self.impulse.y / STEP / (self.mass * GRAVITY)

    @property
    def outside(self) -> int:
        """How many bodies have left the box."""
        return sum(
            not (0.0 < body.position.x < self.width and body.position.y > 0.0)
            for body in self.bodies
        )


def filled_box(
    make_shape: MakeShape,
    reach: float,
    count: int,
    columns: int,
    seed: int = 1,
    space: pymunk.Space | None = None,
) -> Box:
    """A box above whose floor count shapes hang in a grid, at random angles, about to fall.

    reach is the distance from a body to the farthest point of its shape: there is a GAP between
    any two, whatever their angles. Half of it is random, so that circles do not fall into
    columns that only roundoff makes buckle. The space is a plain one if none is given.
    """
    pitch = pitch_of_grid(reach)
    rng = random.Random(seed)
    box = Box(columns * pitch, space or pymunk.Space())
    for i in range(count):
        row, column = divmod(i, columns)
        shift = rng.uniform(-GAP / 4.0, GAP / 4.0)
        position = (column + 0.5) * pitch + shift, (row + 0.5) * pitch
        box.add(make_shape, position, rng.uniform(-pi / 2.0, pi / 2.0))
    return box


def pitch_of_grid(reach: float) -> float:
    """The distance from one body to the next in the grid of filled_box."""
    return 2.0 * reach + GAP


def height_of_grid(reach: float, count: int, columns: int) -> float:
    """How high the grid of filled_box reaches."""
    return ceil(count / columns) * pitch_of_grid(reach)
