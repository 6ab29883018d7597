"""What exact_impacts is for: chains of bounces and an elastic gas with and without it, beside a circle and a polygon."""

from __future__ import annotations

import csv
import random
from collections.abc import Callable
from math import cos, exp, hypot, log, pi, sin, sqrt
from pathlib import Path
from time import thread_time

import pymunk
from matplotlib.figure import Figure

from pymunk_ellipse import Ellipse, Space, moment_for_ellipse

from ._oracles import Flyer, bouncing, half_a_step_on, hit, time_to_floor
from ._picture import save
from ._shapes import inscribed_polygon

RATES = 60, 120, 240, 480
GRAVITY = 0.0, -500.0
A, B = 20.0, 10.0
# Part of the mean step by which steps vary at random, where they do.
VARIES = 0.2

MakeSpace = Callable[[], pymunk.Space]
MakeShape = Callable[[pymunk.Body, float, float], pymunk.Shape]


def exact() -> pymunk.Space:
    return Space(exact_impacts=True)


def polygon(body: pymunk.Body, a: float, b: float) -> pymunk.Shape:
    return inscribed_polygon(body, a, b, 64)


def circle(body: pymunk.Body, a: float, b: float) -> pymunk.Shape:
    """As large as the ellipse."""
    return pymunk.Circle(body, sqrt(a * b))


COLORS = {
    "circle": "#30343b",
    "64-gon": "#2e9cca",
    "ellipse": "#edae49",
    "ellipse, exact impacts": "#d1495b",
    "ellipse, exact impacts, steps vary by 20%": "#7a6ff0",
}

# By the name in the chart: the space, the shape, and by what part of itself a step varies.
BOUNCES: dict[str, tuple[MakeSpace, MakeShape, float]] = {
    "64-gon": (pymunk.Space, polygon, 0.0),
    "ellipse": (Space, Ellipse, 0.0),
    "ellipse, exact impacts": (exact, Ellipse, 0.0),
    "ellipse, exact impacts, steps vary by 20%": (exact, Ellipse, VARIES),
}
GASES: dict[str, tuple[MakeSpace, MakeShape]] = {
    "circle": (pymunk.Space, circle),
    "64-gon": (pymunk.Space, polygon),
    "ellipse": (Space, Ellipse),
    "ellipse, exact impacts": (exact, Ellipse),
}


def run(out: Path, quick: bool) -> None:
    """Chart both; a quick run has fewer throws and a shorter gas."""
    rates = RATES[:2] if quick else RATES
    throws = thrown(5 if quick else 60)
    bounces = {
        name: [chain_error(throws, rate, *kind) for rate in rates]
        for name, kind in BOUNCES.items()
    }
    seconds = 2.0 if quick else 60.0
    gases = {
        name: [gas(rate, seconds, *kind) for rate in rates]
        for name, kind in GASES.items()
    }
    write(out / "impacts.csv", rates, bounces, gases)
    for name, errors in bounces.items():
        order = log(errors[0] / errors[-1], rates[-1] / rates[0])
        print(f"chain of bounces, {name}: {errors[0]:.3g} at 1/60 s, order {order:.2f}")
    for name, found in gases.items():
        text = ", ".join(f"{energy:.4f}" for energy, _ in found)
        print(f"gas, {name}: energy {text}")
    save(draw(rates, bounces, gases), out / "impacts.png")


def thrown(count: int) -> list[tuple[Flyer, float, Flyer]]:
    """Elastic ellipses that hit a floor two to four times, none soon after another: start, seconds and end."""
    rng = random.Random(5)
    found: list[tuple[Flyer, float, Flyer]] = []
    while len(found) < count:
        start = Flyer(
            *(A, B, 0.0, rng.uniform(40.0, 60.0), rng.uniform(-1.5, 1.5)),
            *(rng.uniform(-30.0, 30.0), 0.0, rng.uniform(-3.0, 3.0)),
        )
        end, hits = bouncing(start, 1.2, GRAVITY, 1.0, 0.0)
        if hits in (2, 3, 4) and apart(start, 1.2):
            found.append((start, 1.2, end))
    return found


def apart(flyer: Flyer, seconds: float) -> bool:
    """Whether no two hits, nor a hit and the end, come within two steps of 1/60 s."""
    while (time := time_to_floor(flyer, GRAVITY, seconds)) < seconds:
        if time < 1.0 / 30.0:
            return False
        (flyer,) = hit((flyer.after(time, GRAVITY),), (0.0, 1.0), 1.0, 0.0)
        seconds -= time
    return seconds > 1.0 / 30.0


def chain_error(
    throws: list[tuple[Flyer, float, Flyer]],
    rate: int,
    make_space: MakeSpace,
    make: MakeShape,
    varies: float,
) -> float:
    """How far poses are off in the end: the geometric mean, with a turn counted as the way of the long end."""
    rng = random.Random(7)
    logs = 0.0
    for start, seconds, end in throws:
        space = make_space()
        space.gravity = GRAVITY
        floor = pymunk.Segment(space.static_body, (-1e4, 0.0), (1e4, 0.0), 0.0)
        floor.elasticity = 1.0
        steps = [
            (1.0 + varies * rng.uniform(-1.0, 1.0)) / rate
            for _ in range(round(seconds * rate))
        ]
        steps = [step * seconds / sum(steps) for step in steps]
        flyer = half_a_step_on(start, steps[0], GRAVITY)
        body = pymunk.Body(1.0, moment_for_ellipse(1.0, A, B))
        body.position, body.angle = (flyer.x, flyer.y), flyer.angle
        body.velocity, body.angular_velocity = (flyer.vx, flyer.vy), flyer.spin
        shape = make(body, A, B)
        shape.elasticity = 1.0
        space.add(floor, body, shape)
        for step in steps:
            space.step(step)
        x, y = body.position - (end.x, end.y)
        logs += log(hypot(x, y, A * (body.angle - end.angle)))
    return exp(logs / len(throws))


def gas(
    rate: int, seconds: float, make_space: MakeSpace, make: MakeShape
) -> tuple[float, float]:
    """Energy of 20 elastic shapes in a box without friction and gravity, by that at the start, and milliseconds for a step."""
    rng = random.Random(0)
    space = make_space()
    half = 60.0
    corners = [(-half, -half), (half, -half), (half, half), (-half, half)]
    for i, corner in enumerate(corners):
        wall = pymunk.Segment(space.static_body, corners[i - 1], corner, 2.0)
        wall.elasticity = 1.0
        space.add(wall)
    a, b = 10.0, 5.0
    for i in range(20):
        body = pymunk.Body(1.0, moment_for_ellipse(1.0, a, b))
        body.position = -44.0 + 22.0 * (i % 5), -40.0 + 25.0 * (i // 5)
        body.angle = rng.uniform(0.0, 2.0 * pi)
        direction = rng.uniform(0.0, 2.0 * pi)
        body.velocity = 100.0 * cos(direction), 100.0 * sin(direction)
        shape = make(body, a, b)
        shape.elasticity = 1.0
        space.add(body, shape)
    before = sum(body.kinetic_energy for body in space.bodies)
    count = round(seconds * rate)
    start = thread_time()
    for _ in range(count):
        space.step(1.0 / rate)
    taken = thread_time() - start
    after = sum(body.kinetic_energy for body in space.bodies)
    return after / before, 1e3 * taken / count


def write(
    path: Path,
    rates: tuple[int, ...],
    bounces: dict[str, list[float]],
    gases: dict[str, list[tuple[float, float]]],
) -> None:
    """A row for each scene, method and step."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        rows.writerow(("scene", "method", "steps per second", "found", "ms per step"))
        for name, errors in bounces.items():
            for rate, error in zip(rates, errors, strict=True):
                rows.writerow(("chain of bounces", name, rate, f"{error:.4g}", ""))
        for name, found in gases.items():
            for rate, (energy, cost) in zip(rates, found, strict=True):
                rows.writerow(("gas", name, rate, f"{energy:.6f}", f"{cost:.4f}"))
    print(f"table: {path}")


def draw(
    rates: tuple[int, ...],
    bounces: dict[str, list[float]],
    gases: dict[str, list[tuple[float, float]]],
) -> Figure:
    """Errors of the bounces, and what the gas has gained or lost, against the step."""
    figure = Figure(figsize=(10.0, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    for name, errors in bounces.items():
        left.plot(rates, errors, "o-", label=name, color=COLORS[name])
    left.set_title("two to four bounces of an ellipse 40 by 20")
    left.set_ylabel("pose off by")
    for name, found in gases.items():
        changes = [max(abs(energy - 1.0), 1e-6) for energy, _ in found]
        right.plot(rates, changes, "o-", label=name, color=COLORS[name])
    right.set_title("elastic gas of 20, a minute")
    right.set_ylabel("energy off by, as a part")
    for axes in (left, right):
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xticks(rates, [f"1/{rate}" for rate in rates])
        axes.set_xticks([], minor=True)
        axes.set_xlabel("step (s)")
        axes.grid(alpha=0.3)
        axes.spines[["top", "right"]].set_visible(False)
    left.set_ylim(1e-4, None)
    for axes, place in ((left, "lower left"), (right, "center right")):
        axes.legend(fontsize="small", loc=place)
    return figure
