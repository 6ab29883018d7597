"""What a user sees of a shape that stands for an ellipse: errors in small scenes with exact outcomes, and a pile's cost."""

from __future__ import annotations

import random
from dataclasses import dataclass, field
from functools import cache
from math import cos, hypot, inf, pi, sin, sqrt
from statistics import median
from time import thread_time

import numpy as np
import pymunk
from numpy.typing import NDArray

from ._stability import (
    GRAVITY,
    ROLLING,
    Make,
    add_body,
    add_floor,
    add_pile,
    height,
    mean_square_speed,
    new_space,
    one_segment,
    rock,
    roll,
    seconds_to_turn,
    separation,
    steps,
)

A, B, TILT = 20.0, 10.0, 0.2


def period_error(make: Make, dt: float) -> float:
    """Of the first swing of a rocking ellipse; 1 if it does not swing back twice."""
    space = new_space()
    add_floor(space)
    body = add_body(space, make, A, B, 0.0, height(A, B, TILT), TILT)
    crossings = []
    last = TILT
    expected = 4.0 * seconds_to_turn(A, B, TILT, 0.0)
    for time in steps(space, 3.0 * expected, dt):
        if last > 0.0 >= body.angle:
            crossings.append(time - dt * body.angle / (body.angle - last))
        last = body.angle
    if len(crossings) < 2:
        return 1.0
    return min(1.0, abs((crossings[1] - crossings[0]) / expected - 1.0))


def swing_lost(make: Make, dt: float) -> float:
    """Part of the swing of a rocking ellipse that is lost or gained in 10 s."""
    return rock(make, dt, 10.0)


def rolled_way(seconds: float, count: int = 20000) -> float:
    """How far an ellipse rolls on a flat floor without slip, by its energy (Runge and Kutta's fourth order)."""
    a, b, spin = ROLLING
    spread = (a * a + b * b) / 4.0

    def inertia(angle: float) -> float:
        h = height(a, b, angle)
        slope = (a * a - b * b) * sin(angle) * cos(angle) / h
        return spread + h * h + slope * slope

    start = inertia(0.0) * spin * spin / 2.0 + GRAVITY * b

    def speed(angle: float) -> float:
        return sqrt(2.0 * (start - GRAVITY * height(a, b, angle)) / inertia(angle))

    angle = way = 0.0
    step = seconds / count
    for _ in range(count):
        k1 = speed(angle)
        k2 = speed(angle + step / 2.0 * k1)
        k3 = speed(angle + step / 2.0 * k2)
        k4 = speed(angle + step * k3)
        middle = angle + step / 2.0 * k2
        end = angle + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        way += (
            step
            / 6.0
            * (
                k1 * height(a, b, angle)
                + 4.0 * speed(middle) * height(a, b, middle)
                + speed(end) * height(a, b, end)
            )
        )
        angle = end
    return way


def rolling_error(make: Make, dt: float, seconds: float = 4.0) -> float:
    """How far off an ellipse is after rolling for some seconds, by the way it should have rolled."""
    path, _energy = roll(make, dt, one_segment, seconds)
    return float(abs(path[-1, 0] / rolled_way(seconds) - 1.0))


@dataclass(frozen=True)
class Flight:
    """Two ellipses in free flight that will hit: positions, angles, velocities and spins."""

    positions: tuple[tuple[float, float], tuple[float, float]]
    angles: tuple[float, float]
    velocities: tuple[tuple[float, float], tuple[float, float]]
    spins: tuple[float, float]

    def bodies(self, space: pymunk.Space, make: Make) -> list[pymunk.Body]:
        bodies = []
        for position, angle, velocity, spin in zip(
            self.positions, self.angles, self.velocities, self.spins, strict=True
        ):
            body = add_body(space, make, A, B, *position, angle, friction=0.0)
            body.velocity = velocity
            body.angular_velocity = spin
            bodies.append(body)
        for shape in space.shapes:
            shape.elasticity = 1.0
        return bodies


def flights(count: int, seed: int = 4) -> list[Flight]:
    rng = random.Random(seed)
    result = []
    for _ in range(count):
        aside = rng.uniform(-15.0, 15.0)
        result.append(
            Flight(
                ((-60.0, 0.0), (60.0, aside)),
                (rng.uniform(0.0, pi), rng.uniform(0.0, pi)),
                ((100.0, 0.0), (-100.0, 0.0)),
                (rng.uniform(-3.0, 3.0), rng.uniform(-3.0, 3.0)),
            )
        )
    return result


@cache
def outcomes(count: int) -> list[tuple[Flight, NDArray[np.float64]]]:
    """Flights and how each ends."""
    return [(flight, exact_outcome(flight)) for flight in flights(count)]


def exact_outcome(flight: Flight) -> NDArray[np.float64]:
    """Velocities (x, y) and spins times the radius of gyration after an elastic hit without friction, in rows.

    The time of contact is found by steps that cannot pass it, the normal by looking in all directions.
    """
    pair = [pymunk.Body(1.0, 1.0), pymunk.Body(1.0, 1.0)]

    def place(time: float) -> float:
        for i, body in enumerate(pair):
            (x, y), (vx, vy) = flight.positions[i], flight.velocities[i]
            body.position = x + time * vx, y + time * vy
            body.angle = flight.angles[i] + time * flight.spins[i]
        return separation(pair[0], A, B, pair[1], A, B)

    # No point of one comes closer to the other faster than this, so the steps end at the contact.
    fastest = sum(hypot(*velocity) for velocity in flight.velocities)
    fastest += A * sum(abs(spin) for spin in flight.spins)
    time = 0.0
    while (distance := place(time)) > 1e-4:
        time += distance / fastest

    normal = contact_normal(pair)
    arms = []
    for body, sign in zip(pair, (1.0, -1.0), strict=True):
        c, s = body.rotation_vector
        u, v = c * normal.x + s * normal.y, c * normal.y - s * normal.x
        size = sign / hypot(A * u, B * v)
        x, y = A * A * u * size, B * B * v * size
        arms.append(pymunk.Vec2d(c * x - s * y, s * x + c * y).cross(normal))
    square = (A * A + B * B) / 4.0
    velocities = [pymunk.Vec2d(*velocity) for velocity in flight.velocities]
    closing = (velocities[0] - velocities[1]).dot(normal)
    closing += arms[0] * flight.spins[0] - arms[1] * flight.spins[1]
    impulse = 2.0 * closing / (2.0 + (arms[0] ** 2 + arms[1] ** 2) / square)
    rows = []
    for velocity, spin, arm, sign in zip(
        velocities, flight.spins, arms, (-1.0, 1.0), strict=True
    ):
        after = velocity + sign * impulse * normal
        rows.append((*after, (spin + sign * impulse * arm / square) * sqrt(square)))
    return np.array(rows)


def contact_normal(pair: list[pymunk.Body]) -> pymunk.Vec2d:
    """The direction in which two ellipses are farthest apart, from a scan and a parabola through its highest points."""
    count = 20000
    turn = 2.0 * pi / count
    angles = np.arange(count) * turn
    dx, dy = pair[1].position - pair[0].position
    gap = dx * np.cos(angles) + dy * np.sin(angles)
    for body in pair:
        t = angles - body.angle
        gap -= np.hypot(A * np.cos(t), B * np.sin(t))
    i = int(np.argmax(gap))
    before, at, after = gap[i - 1], gap[i], gap[(i + 1) % count]
    shift = (before - after) / (before - 2.0 * at + after) / 2.0
    return pymunk.Vec2d.from_polar(1.0, float((i + shift) * turn))


def collision_error(make: Make, dt: float, count: int = 30) -> float:
    """How far off velocities and spins are right after elastic hits of two ellipses, rms, by the speed at which they met."""
    square = (A * A + B * B) / 4.0
    total = 0.0
    for flight, expected in outcomes(count):
        space = new_space(0.0)
        bodies = flight.bodies(space, make)
        for body in bodies:
            # A polygon's own would be an error of another kind.
            body.moment = square
        before = bodies[0].velocity
        for _ in steps(space, 1.5, dt):
            if bodies[0].velocity != before:
                break
        found = np.array(
            [(*body.velocity, body.angular_velocity * sqrt(square)) for body in bodies]
        )
        total += float(np.sum((found - expected) ** 2))
    return sqrt(total / count) / 200.0


@dataclass(eq=False)
class TimedPile:
    """A pile that is stepped and timed."""

    make: Make
    dt: float
    seconds: list[float] = field(default_factory=list)
    squares: list[float] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.space = new_space()
        self.bodies = add_pile(self.space, self.make)

    def settle(self, seconds: float) -> None:
        for _ in steps(self.space, seconds, self.dt):
            pass

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
