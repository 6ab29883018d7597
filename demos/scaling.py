"""How the time per step grows with the number of bodies, up to 5000 (--full: 20,000): circles, 16-gons and ellipses."""

from __future__ import annotations

import csv
from functools import partial
from math import ceil, sqrt
from pathlib import Path

from matplotlib.figure import Figure

from pymunk_ellipse import Ellipse, backend

from ._box import STEP, MakeShape
from ._picture import save
from ._race import Course, Runner, Times, race
from ._shapes import circle_of_equal_area, inscribed_polygon

A = 14.0
B = 7.0
FULL_SIZES = 100, 200, 500, 1000, 2000, 5000, 10000, 20000
SIZES = 100, 200, 500, 1000, 2000, 5000
QUICK_SIZES = 100, 200, 500, 1000
# From here on costs are compared: smaller piles spend much of a step outside of contacts.
REFERENCE = 500
ROUNDS = 10
# Bodies times steps in a round: the larger the pile, the fewer of its steps are timed.
BODY_STEPS = 4000
# Rows of bodies in the grid that falls. Larger piles are wider, not deeper, so that they settle
# in the same time into the same packing, and differ in nothing but their number.
ROWS = 16

Raced = Times[tuple[str, int]]


def course(bodies: int) -> Course:
    # A small pile is as wide as it is high.
    columns = max(ceil(bodies / ROWS), ceil(sqrt(bodies)))
    return Course(bodies, columns, max(2, round(BODY_STEPS / bodies)))


def runners(bodies: int) -> dict[str, Runner]:
    """The same pile of each kind of shape."""
    makers: dict[str, MakeShape] = {
        "circles": partial(circle_of_equal_area, a=A, b=B),
        "16-gons": partial(inscribed_polygon, a=A, b=B, count=16),
        "ellipses": partial(Ellipse, a=A, b=B),
    }
    return {
        name: Runner(make_shape, A, course(bodies))
        for name, make_shape in makers.items()
    }


def run(out: Path, quick: bool, full: bool = False) -> None:
    """Time piles of 100 to 5000 bodies, to 20,000 for a full run, or to 1000 for a quick one."""
    sizes = QUICK_SIZES if quick else FULL_SIZES if full else SIZES
    names = list(runners(REFERENCE))
    times = race(
        {
            (name, bodies): runner
            for bodies in sizes
            for name, runner in runners(bodies).items()
        },
        ROUNDS,
    )
    print(f"a={A:g}, b={B:g}, dt=1/{1 / STEP:.0f}, {backend()} backend")
    print("ms per step, and microseconds per pair that touches")
    print("bodies" + "".join(f"{name:>18}" for name in names))
    for bodies in sizes:
        row = [
            f"{times.milliseconds((name, bodies)):10.3f}"
            f"{cost(times, name, bodies):8.3f}"
            for name in names
        ]
        print(f"{bodies:6}" + "".join(row))
    for name in names:
        grown = growth(times, name, max(sizes))
        print(
            f"cost per contact, {max(sizes)} to {REFERENCE} bodies, {name}: {grown:.3f}"
        )
    write(times, out / "scaling.csv")
    save(draw(times, names, sizes), out / "scaling.png")


def cost(times: Raced, name: str, bodies: int) -> float:
    """Microseconds of a step for each pair that touches."""
    return 1e3 * times.milliseconds((name, bodies)) / times.contacts[name, bodies]


def growth(times: Raced, name: str, bodies: int) -> float:
    """How many times as much a contact costs as in the pile of the reference size."""
    large = name, bodies
    reference = name, REFERENCE
    contacts = times.contacts[large] / times.contacts[reference]
    return times.ratio([(large, reference)]) / contacts


def write(times: Raced, path: Path) -> None:
    with open(path, "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(
            ["shapes", "bodies", "ms per step", "contacts", "us per contact"]
        )
        for name, bodies in times.seconds:
            milliseconds = times.milliseconds((name, bodies))
            contacts = times.contacts[name, bodies]
            microseconds = cost(times, name, bodies)
            table.writerow(
                [name, bodies, f"{milliseconds:.4f}", contacts, f"{microseconds:.4f}"]
            )
    print(f"table: {path}")


def draw(times: Raced, names: list[str], sizes: tuple[int, ...]) -> Figure:
    """Time per step and cost per contact against the number of bodies."""
    figure = Figure(figsize=(10.0, 4.2), layout="constrained")
    step_axes, contact_axes = figure.subplots(1, 2)
    colors = dict(zip(names, ("C0", "C2", "C1"), strict=True))
    for name in names:
        step_axes.loglog(
            sizes,
            [times.milliseconds((name, bodies)) for bodies in sizes],
            marker="o",
            color=colors[name],
            label=name,
        )
        contact_axes.loglog(
            sizes,
            [cost(times, name, bodies) for bodies in sizes],
            marker="o",
            color=colors[name],
            label=name,
        )
    step_axes.axhline(1e3 / 60.0, color="gray", linestyle=":")
    step_axes.annotate(
        "a step for each of 60 frames in a second",
        (sizes[0], 1e3 / 60.0),
        textcoords="offset points",
        xytext=(0.0, 4.0),
        color="gray",
    )
    step_axes.set_title("milliseconds per step")
    contact_axes.set_title("microseconds per pair that touches")
    contact_axes.set_yticks(
        ticks := [0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0], map(str, ticks)
    )
    contact_axes.minorticks_off()
    for axes in (step_axes, contact_axes):
        axes.set_xticks(sizes, [f"{bodies:,}" for bodies in sizes], rotation=30)
        axes.minorticks_off()
        axes.set_xlabel("bodies")
        axes.spines[["top", "right"]].set_visible(False)
    step_axes.legend(loc="lower right")
    return figure
