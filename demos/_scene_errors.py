"""What a user sees of a shape that stands for an ellipse: errors in small scenes with exact outcomes, and a pile's cost."""

from __future__ import annotations

import random
from dataclasses import dataclass, field
from functools import cache
from math import exp, hypot, inf, log, pi, sqrt
from statistics import median
from time import thread_time

import pymunk

from ._builders import (
    CIRCLE,
    GRAVITY,
    Kind,
    add_body,
    add_floor,
    add_pile,
    gas_energy,
    mean_square_speed,
    steps,
)
from ._oracles import (
    Flyer,
    Rolling,
    bouncing,
    colliding,
    half_a_step_on,
    height,
    hit,
    time_to_floor,
)
from ._stability import ROLLING, one_segment, rock, roll

A, B, TILT = 20.0, 10.0, 0.2
DOWN = 0.0, -GRAVITY


def semi_axes(kind: Kind) -> tuple[float, float]:
    """Of what the shape is: a circle is held against what circles do."""
    return (sqrt(A * B), sqrt(A * B)) if kind is CIRCLE else (A, B)


def period_error(kind: Kind, dt: float) -> float:
    """Of the first swing of a rocking ellipse; 1 if it does not swing back twice."""
    space = kind.new_space()
    add_floor(space)
    body = add_body(space, kind.make, A, B, 0.0, height(A, B, TILT), TILT)
    crossings = []
    last = TILT
    expected = Rolling(A, B, GRAVITY).period(TILT)
    for time in steps(space, 3.0 * expected, dt):
        if last > 0.0 >= body.angle:
            crossings.append(time - dt * body.angle / (body.angle - last))
        last = body.angle
    if len(crossings) < 2:
        return 1.0
    return min(1.0, abs((crossings[1] - crossings[0]) / expected - 1.0))


def swing_lost(kind: Kind, dt: float) -> float:
    """Part of the swing of a rocking ellipse that is lost or gained in 10 s."""
    return rock(kind, dt, 10.0)


def rolling_error(kind: Kind, dt: float, seconds: float = 4.0) -> float:
    """How far off an ellipse is after rolling for some seconds, by the way it should have rolled."""
    a, b, spin = ROLLING
    path, _energy = roll(kind, dt, one_segment, seconds)
    _angle, _spin, way = Rolling(a, b, GRAVITY).after(0.0, spin, seconds)
    return float(abs(path[-1, 0] / way - 1.0))


def add_flyer(space: pymunk.Space, kind: Kind, flyer: Flyer) -> pymunk.Body:
    """Add an elastic shape without friction, with the mass and the moment of inertia of an ellipse."""
    body = pymunk.Body(flyer.mass, flyer.mass * flyer.square)
    body.position, body.angle = (flyer.x, flyer.y), flyer.angle
    body.velocity, body.angular_velocity = (flyer.vx, flyer.vy), flyer.spin
    shape = kind.make(body, flyer.a, flyer.b)
    shape.elasticity = 1.0
    space.add(body, shape)
    return body


@cache
def collisions(
    a: float, b: float, count: int, seconds: float
) -> list[tuple[tuple[Flyer, ...], tuple[Flyer, ...]]]:
    """Pairs in free flight that hit each other once, before and after."""
    rng = random.Random(4)
    found = []
    while len(found) < count:
        first = Flyer(
            *(a, b, -60.0, 0.0, rng.uniform(0.0, pi), 100.0, 0.0),
            rng.uniform(-3.0, 3.0),
        )
        second = Flyer(
            *(a, b, 60.0, rng.uniform(-15.0, 15.0), rng.uniform(0.0, pi)),
            *(-100.0, 0.0, rng.uniform(-3.0, 3.0)),
        )
        ends, hits = colliding((first, second), seconds, 1.0, 0.0)
        if hits == 1:
            found.append(((first, second), ends))
    return found


def collision_error(kind: Kind, dt: float, count: int = 30) -> float:
    """How far off velocities and spins are after elastic hits of two ellipses, rms, by the speed at which they met."""
    a, b = semi_axes(kind)
    total = 0.0
    for pair, ends in collisions(a, b, count, 1.1):
        space = kind.new_space(0.0)
        bodies = [add_flyer(space, kind, flyer) for flyer in pair]
        for _ in steps(space, 1.1, dt):
            pass
        for body, end in zip(bodies, ends, strict=True):
            x, y = body.velocity - (end.vx, end.vy)
            spin = body.angular_velocity - end.spin
            total += x * x + y * y + end.square * spin * spin
    return sqrt(total / count) / 200.0


@cache
def throws(a: float, b: float, count: int) -> list[tuple[Flyer, float, Flyer]]:
    """Elastic ellipses that hit a floor two to four times, none soon after another: start, seconds and end."""
    rng = random.Random(5)
    found: list[tuple[Flyer, float, Flyer]] = []
    while len(found) < count:
        start = Flyer(
            *(a, b, 0.0, rng.uniform(40.0, 60.0), rng.uniform(-1.5, 1.5)),
            *(rng.uniform(-30.0, 30.0), 0.0, rng.uniform(-3.0, 3.0)),
        )
        end, hits = bouncing(start, 1.2, DOWN, 1.0, 0.0)
        if hits in (2, 3, 4) and apart(start, 1.2):
            found.append((start, 1.2, end))
    return found


def apart(flyer: Flyer, seconds: float) -> bool:
    """Whether no two hits, nor a hit and the end, come within two steps of 1/60 s."""
    while (time := time_to_floor(flyer, DOWN, seconds)) < seconds:
        if time < 1.0 / 30.0:
            return False
        (flyer,) = hit((flyer.after(time, DOWN),), (0.0, 1.0), 1.0, 0.0)
        seconds -= time
    return seconds > 1.0 / 30.0


def bounces_error(kind: Kind, dt: float, varies: float = 0.0, count: int = 60) -> float:
    """How far poses are off after two to four bounces, by the long semi-axis: the geometric mean, with a turn counted as the way of the long end.

    Steps may vary at random by a part of dt.
    """
    a, b = semi_axes(kind)
    rng = random.Random(7)
    logs = 0.0
    for start, seconds, end in throws(a, b, count):
        space = kind.new_space()
        floor = add_floor(space, 0.0)
        floor.elasticity = 1.0
        lengths = [
            1.0 + varies * rng.uniform(-1.0, 1.0) for _ in range(round(seconds / dt))
        ]
        lengths = [length * seconds / sum(lengths) for length in lengths]
        body = add_flyer(space, kind, half_a_step_on(start, lengths[0], DOWN))
        for length in lengths:
            space.step(length)
        x, y = body.position - (end.x, end.y)
        logs += log(hypot(x, y, a * (body.angle - end.angle)) / a)
    return exp(logs / count)


def gas_error(kind: Kind, dt: float) -> float:
    """The part of its energy that an elastic gas gains or loses in a minute."""
    return abs(gas_energy(kind, dt, 60.0) - 1.0)


@dataclass(eq=False)
class TimedPile:
    """A pile that is stepped and timed."""

    kind: Kind
    dt: float
    seconds: list[float] = field(default_factory=list)
    squares: list[float] = field(default_factory=list)
    settling: float = 0.0

    def __post_init__(self) -> None:
        self.space = self.kind.new_space()
        self.bodies = add_pile(self.space, self.kind.make)

    def settle(self, seconds: float) -> None:
        """Step for some time of the pile's own, and note how long that takes."""
        start = thread_time()
        for _ in steps(self.space, seconds, self.dt):
            pass
        self.settling = thread_time() - start

    def time(self, seconds: float) -> None:
        """Step for some time of the pile's own, and note how long a second of it takes."""
        count = round(seconds / self.dt)
        # The processor's time: what else the machine does drops out.
        start = thread_time()
        for _ in range(count):
            self.space.step(self.dt)
        self.seconds.append((thread_time() - start) / (count * self.dt))
        self.squares.append(mean_square_speed(self.bodies))

    @property
    def milliseconds(self) -> float:
        """The median of milliseconds of work per second of the pile."""
        return 1e3 * median(self.seconds)

    @property
    def speed(self) -> float:
        """At rest, by that of a fall from the height b."""
        if any(body.position.y < 0.0 for body in self.bodies):
            return inf
        return sqrt(sum(self.squares) / len(self.squares) / (2.0 * GRAVITY * B))

    @property
    def height(self) -> float:
        """Mean height of the centres."""
        return sum(body.position.y for body in self.bodies) / len(self.bodies)
