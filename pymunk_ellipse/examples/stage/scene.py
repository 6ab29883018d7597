"""What all scenes have in common: a space, a clock, walls, and answers to the mouse and the keys."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from typing import TYPE_CHECKING, ClassVar

import pymunk
from pymunk import Vec2d

from pymunk_ellipse import Space

from .plane import Point, View

if TYPE_CHECKING:
    from .debug_draw import SpaceCanvas

STEP = 1.0 / 240.0


class Scene:
    """A space to step, look at and measure.

    A scene fills self.space when it is made, and says in numbers, by their labels, what came
    of it. It may do something before each step, and answer the mouse and the keys.
    """

    # Left, bottom, right and top of what is shown.
    view: ClassVar[View]
    seconds: ClassVar[float] = 6.0
    # When the picture is taken (seconds), if not at the end.
    picture_at: ClassVar[float | None] = None
    # Pixels of the animation's longer side; the picture has twice as many.
    pixels: ClassVar[int] = 420
    # What the mouse and the keys do, for the window to tell.
    hint: ClassVar[str] = ""

    def __init__(self) -> None:
        self.space = Space()
        self.space.gravity = 0.0, -500.0
        self.steps = 0

    @property
    def time(self) -> float:
        """Seconds since the start."""
        return self.steps * STEP

    def add_walls(
        self, *points: Point, friction: float = 0.5, elasticity: float = 0.0
    ) -> None:
        """Add a static wall that leads from point to point."""
        for start, end in pairwise(points):
            wall = pymunk.Segment(self.space.static_body, start, end, 2.0)
            wall.friction = friction
            wall.elasticity = elasticity
            self.space.add(wall)

    def step(self) -> None:
        self.before_step()
        self.space.step(STEP)
        self.steps += 1

    def before_step(self) -> None:
        """What the scene does before each step: nothing, if it says nothing else."""

    def play(self) -> None:
        """What stands in for the player, before each step, where there is no window."""

    def captions(self) -> list[tuple[str, Point]]:
        """Lines of text to show, and where each begins in the world."""
        return []

    def draw(self, canvas: SpaceCanvas) -> None:
        """Draw the scene as it is now: the space and the captions, if it says nothing else."""
        canvas.draw_space(self.space)
        for line, point in self.captions():
            canvas.write(line, point, "midleft")

    def numbers(self) -> dict[str, float]:
        """What came of it."""
        raise NotImplementedError

    def press(self, point: Vec2d) -> None:
        """The mouse button goes down at a point of the world."""

    def drag(self, point: Vec2d) -> None:
        """The mouse moves."""

    def release(self) -> None:
        """The mouse button goes up."""

    def key(self, name: str, down: bool) -> None:
        """A key goes down or up; names are those of pygame.key.name."""


def steps_to_picture(make: type[Scene]) -> int:
    """After how many steps a scene's picture is taken."""
    return round((make.picture_at or make.seconds) / STEP)


def energy(bodies: Iterable[pymunk.Body], gravity: float) -> float:
    """Kinetic energy of bodies and potential energy above y = 0."""
    # body.kinetic_energy is twice the kinetic energy.
    return sum(
        body.kinetic_energy / 2.0 + body.mass * gravity * center_of_gravity(body).y
        for body in bodies
    )


def center_of_gravity(body: pymunk.Body) -> Vec2d:
    """Where a body's centre of gravity is in the world."""
    return body.local_to_world(body.center_of_gravity)
