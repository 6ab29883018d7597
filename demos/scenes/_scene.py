"""What the gallery's scenes have in common: a clock, walls, the mouse, and how they are run and shown."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from pathlib import Path
from typing import ClassVar

import pymunk
from PIL import Image
from pymunk import Vec2d
from tqdm import trange

from pymunk_ellipse import Space

from ._canvas import Canvas

STEP = 1.0 / 240.0
FRAMES_PER_SECOND = 25
QUICK_FRAMES_PER_SECOND = 5
# Pixels of the animation's longer side; the picture has twice as many.
SIZE = 420
# More would show nothing new of a few flat colours.
COLORS = 64

Point = tuple[float, float]


class Scene:
    """A space to step, look at and measure.

    A scene fills self.space when it is made, and says in numbers, by their labels, what came
    of it. It may do something before each step, and answer the mouse.
    """

    # Left, bottom, right and top of what is shown.
    view: ClassVar[tuple[float, float, float, float]]
    seconds: ClassVar[float] = 6.0
    # When the picture is taken (seconds), if not at the end.
    picture_at: ClassVar[float | None] = None

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

    def numbers(self) -> dict[str, float]:
        """What came of it."""
        raise NotImplementedError

    def press(self, point: Vec2d) -> None:
        """The mouse button goes down at a point of the world."""

    def drag(self, point: Vec2d) -> None:
        """The mouse moves."""

    def release(self) -> None:
        """The mouse button goes up."""


def show(make: type[Scene], out: Path, quick: bool, window: bool = False) -> None:
    """Run a scene without a window and leave a picture, an animation and its numbers, or open it in a window.

    The animation of a quick run has fewer frames; everything else is the same.
    """
    if window:
        from ._window import open_window

        open_window(make)
        return
    name = make.__module__.rpartition(".")[2]
    scene = make()
    canvas = Canvas(scene.view, SIZE)
    rate = QUICK_FRAMES_PER_SECOND if quick else FRAMES_PER_SECOND
    steps = round(make.seconds / STEP)
    steps_per_frame = round(1.0 / rate / STEP)
    frames = []
    for step in trange(1, steps + 1, desc=name, unit="step"):
        scene.play()
        scene.step()
        if step % steps_per_frame == 0:
            frames.append(canvas.draw(scene.space))
        if step == steps_to_picture(make):
            picture = out / f"{name}.png"
            drawn = Canvas(scene.view, 2 * SIZE).draw(scene.space)
            quantized(drawn, drawn).save(picture, optimize=True)
    for label, number in scene.numbers().items():
        print(f"{label}: {number:.5g}")
    animation = out / f"{name}.gif"
    save_animation(frames, animation, 1000 // rate)
    print(f"picture: {picture}")
    print(f"animation: {animation}")


def steps_to_picture(make: type[Scene]) -> int:
    """After how many steps a scene's picture is taken."""
    return round((make.picture_at or make.seconds) / STEP)


def save_animation(frames: list[Image.Image], path: Path, milliseconds: int) -> None:
    """Save frames as a GIF, all with the colours that a few of them have."""
    samples = frames[:: max(1, len(frames) // 4)]
    width, height = samples[0].size
    strip = Image.new("RGB", (width, height * len(samples)))
    for i, sample in enumerate(samples):
        strip.paste(sample, (0, i * height))
    first, *rest = (quantized(frame, strip) for frame in frames)
    first.save(path, save_all=True, append_images=rest, duration=milliseconds, loop=0)


def quantized(image: Image.Image, sample: Image.Image) -> Image.Image:
    """An image in the colours of a sample."""
    palette = sample.quantize(COLORS)
    return image.quantize(palette=palette, dither=Image.Dither.NONE)


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
