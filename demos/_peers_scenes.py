"""Scenes of ellipses, or of what stands for them, stepped by one engine or another: a pile, a rocking one, an elastic gas."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from statistics import mean, median
from typing import NamedTuple, Protocol

import numpy as np
import pymunk
from numpy.typing import NDArray
from tqdm import tqdm

from pymunk_ellipse import Ellipse

from . import pile, rocking
from ._box import GRAVITY, STEP, filled_box
from ._builders import CIRCLE, Make, add_gas, kinetic_energy, polygon
from ._peers_pairs import touching
from ._race import CLOCK

# The scenes with gravity are as large as they have to be for it to be the earth's.
METRE = GRAVITY / 9.81

POLYGON_COUNTS = 8, 16, 32


class World(Protocol):
    """A space as an engine has it."""

    def step(self, count: int) -> None:
        """So many steps."""

    def write_back(self) -> None:
        """Give the space's bodies the positions and velocities that they have come to."""


@dataclass(frozen=True)
class Engine:
    """An engine with the shape that stands for an ellipse in it."""

    family: str
    shape: str
    make: Make
    # From a space, the step (seconds) and how long a metre is in the space's units.
    translate: Callable[[pymunk.Space, float, float], World]

    def __str__(self) -> str:
        return f"{self.family}, {self.shape}"


class PymunkWorld:
    """The space itself."""

    def __init__(self, space: pymunk.Space, step: float, metre: float) -> None:
        self.space = space
        self.seconds = step

    def step(self, count: int) -> None:
        for _ in range(count):
            self.space.step(self.seconds)

    def write_back(self) -> None:
        pass


def engines_of_pymunk() -> list[Engine]:
    return [
        Engine("pymunk_ellipse", "ellipses", Ellipse, PymunkWorld),
        Engine("pymunk", "circles", CIRCLE.make, PymunkWorld),
        *(
            Engine("pymunk", f"{count}-gons", polygon(count).make, PymunkWorld)
            for count in POLYGON_COUNTS
        ),
    ]


@dataclass
class Seen:
    """What an engine's scenes cost and how they went."""

    # Milliseconds per step of the pile at rest.
    milliseconds: float = 0.0
    # The pile's kinetic energy in the end, as the height (by b) to which it would lift all bodies.
    restless: float = 0.0
    # Of the pile's shapes and walls, by b: the mean of those that overlap, and the deepest.
    overlap: tuple[float, float] = (0.0, 0.0)
    outside: int = 0
    # By the tilt: the error of the period, none if it does not rock, and the part of the swing that is kept.
    rocking: dict[float, rocking.Rocking] = field(default_factory=dict)
    # By the steps per second: the energy in the end, by that at the start.
    gas: dict[int, float] = field(default_factory=dict)


def period_off(found: Seen, tilt: float) -> float | None:
    """Relative error of the period; none if it does not swing back."""
    swing = found.rocking.get(tilt)
    if swing is None or swing.period is None:
        return None
    return swing.period / rocking.analytic_period(tilt) - 1.0


def swing_off(found: Seen) -> float | None:
    """The largest part of the swing that is lost or gained; none for what cannot rock."""
    return max(
        (abs(swing.amplitude_kept - 1.0) for swing in found.rocking.values()),
        default=None,
    )


class PileSize(NamedTuple):
    count: int
    columns: int
    # Seconds until it is looked at.
    settling: float
    rounds: int
    steps_per_round: int


def piles(engines: list[Engine], size: PileSize, seen: dict[Engine, Seen]) -> None:
    """Let a pile come to rest in each engine, then step them in turn, round after round."""
    boxes = {
        engine: filled_box(
            partial(engine.make, a=pile.A, b=pile.B), pile.A, size.count, size.columns
        )
        for engine in engines
    }
    worlds = {
        engine: engine.translate(box.space, STEP, METRE)
        for engine, box in boxes.items()
    }
    for world in tqdm(worlds.values(), "piles settle", unit="pile"):
        world.step(round(size.settling / STEP))
    seconds: dict[Engine, list[float]] = {engine: [] for engine in engines}
    energies: dict[Engine, list[float]] = {engine: [] for engine in engines}
    for _ in tqdm(range(size.rounds), "piles timed", unit="round"):
        for engine, world in worlds.items():
            start = CLOCK()
            world.step(size.steps_per_round)
            seconds[engine].append((CLOCK() - start) / size.steps_per_round)
            world.write_back()
            energies[engine].append(boxes[engine].energy_per_mass)
    for engine, box in boxes.items():
        found = seen[engine]
        found.milliseconds = 1e3 * median(seconds[engine])
        found.restless = mean(energies[engine]) / (GRAVITY * pile.B)
        depths = overlaps(box.space) / pile.B
        if len(depths):
            found.overlap = float(depths.mean()), float(depths.max())
        found.outside = box.outside


def overlaps(space: pymunk.Space) -> NDArray[np.float64]:
    """How deep any two shapes overlap that do so."""
    # The ellipses first: pymunk's own shapes would see their hulls.
    shapes = sorted(space.shapes, key=lambda shape: not isinstance(shape, Ellipse))
    boxes = np.array([shape.cache_bb() for shape in shapes])
    left, bottom, right, top = boxes.T
    meets = (left[:, None] <= right) & (bottom[:, None] <= top)
    depths = []
    for i, j in np.argwhere(np.triu(meets & meets.T, 1)).tolist():
        if shapes[i].body is shapes[j].body:
            # Two walls.
            continue
        if (contacts := touching(shapes[i], shapes[j])) is not None:
            depths.append(max(-point.distance for point in contacts.points))
    found = np.array(depths)
    return found[found > 0.0]


def rock(engine: Engine, tilt: float) -> rocking.Rocking:
    """An ellipse rocks on a floor with friction of 1, enough that nothing slips."""
    make = partial(engine.make, a=rocking.A, b=rocking.B)
    space, body = rocking.scene(make, tilt, friction=1.0)
    world = engine.translate(space, rocking.STEP, METRE)
    angles = [tilt]
    for _ in range(round(rocking.DURATION / rocking.STEP)):
        world.step(1)
        world.write_back()
        angles.append(body.angle)
    return rocking.measure(np.array(angles), tilt)


# So that the speeds suit Box2D, which takes no hit below 1 m/s for elastic and moves nothing by more than 2 m in a step.
GAS_METRE = 10.0


def gas(engine: Engine, rate: int, seconds: float) -> float:
    """The energy that an elastic gas has after some time, by that at the start."""
    space = pymunk.Space()
    add_gas(space, engine.make)
    world = engine.translate(space, 1.0 / rate, GAS_METRE)
    start = kinetic_energy(space)
    world.step(round(seconds * rate))
    world.write_back()
    return kinetic_energy(space) / start
