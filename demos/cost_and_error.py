"""The README's chart: what a shape costs in a pile, and how far the normals of its contacts are off."""

from __future__ import annotations

import csv
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from math import cos, degrees, pi
from pathlib import Path
from time import thread_time

import numpy as np
import pymunk
from matplotlib.figure import Figure

from pymunk_ellipse import Ellipse, backend, ellipse_contacts

from ._box import MakeShape
from ._methods import Floats, Method, Pairs, Polygons, random_pairs, score
from ._picture import OUTLINE, save
from ._race import Course, Runner, race
from ._shapes import inscribed_polygon

A, B = 14.0, 7.0
POLYGONS = 8, 16, 32, 64
ELLIPSE = "ellipse"
# By b, as in the chart of all methods.
DEPTHS = 0.003, 0.1
FULL = Course(500, 16, steps_per_round=30)
QUICK = Course(60, 8, steps_per_round=4)
SEEDS = 1, 2, 3


@dataclass(frozen=True)
class Seen:
    """The milliseconds of a step of the pile, and by how many degrees normals are off, in the median and at worst."""

    milliseconds: float
    off: float
    worst: float


def run(out: Path, quick: bool) -> None:
    """Time piles of 500 bodies, or 60 for a quick run, and compare the contacts of 400 pairs, or 60."""
    course = QUICK if quick else FULL
    seeds = SEEDS[:1] if quick else SEEDS
    shapes: dict[str, MakeShape] = {
        f"{count}-gon": partial(polygon_around, a=A, b=B, count=count)
        for count in POLYGONS
    }
    shapes[ELLIPSE] = partial(Ellipse, a=A, b=B)
    finders: dict[str, Callable[[Pairs], tuple[float, Floats]]] = {
        f"{count}-gon": Polygons(count, circumscribed=True) for count in POLYGONS
    }
    finders[ELLIPSE] = exact
    times = race(
        {
            (name, seed): Runner(make, A, replace(course, seed=seed))
            for name, make in shapes.items()
            for seed in seeds
        },
        4 if quick else 10,
    )
    pairs = random_pairs(A / B, *DEPTHS, 60 if quick else 400, seed=1)
    seen = {}
    for name, find in finders.items():
        seconds, found = find(pairs)
        method = Method(name, 0, True, find, [seconds], found)
        median, worst = score(method, pairs).normal
        milliseconds = times.milliseconds(*((name, seed) for seed in seeds))
        seen[name] = Seen(milliseconds, degrees(median), degrees(worst))
    print(f"{course.bodies} bodies, ellipses {backend()}; {len(pairs)} pairs")
    print("shape      ms/step  normal off by (degrees, median)  (worst)")
    for name, row in seen.items():
        print(f"{name:8}  {row.milliseconds:8.3f}  {row.off:31.2g}  {row.worst:7.2g}")
    write(seen, out / "cost_and_error.csv")
    save(draw(seen, course), out / "cost_and_error.png", dpi=110)


def exact(pairs: Pairs) -> tuple[float, Floats]:
    """The contacts of the package, in rows of depth and normal."""
    a1, b1, a2, b2, c, s, x, y = pairs.numbers.T
    zero = np.zeros(len(pairs))
    first = np.column_stack((a1, b1, zero, zero, zero))
    second = np.column_stack((a2, b2, x, y, np.arctan2(s, c)))
    start = thread_time()
    found = ellipse_contacts(first, second)
    taken = thread_time() - start
    return taken, np.column_stack((-found.distance, found.normal))


def polygon_around(body: pymunk.Body, a: float, b: float, count: int) -> pymunk.Shape:
    """A polygon around the ellipse: one inside of it misses shallow contacts."""
    larger = 1.0 / cos(pi / count)
    return inscribed_polygon(body, larger * a, larger * b, count)


def write(seen: dict[str, Seen], path: Path) -> None:
    with open(path, "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(
            ("shape", "ms per step", "normal off (degrees), median", "worst")
        )
        for name, row in seen.items():
            numbers = f"{row.milliseconds:.3f}", f"{row.off:.2g}", f"{row.worst:.2g}"
            table.writerow((name, *numbers))
    print(f"table: {path}")


def draw(seen: dict[str, Seen], course: Course) -> Figure:
    figure = Figure(figsize=(7.6, 3.8), layout="constrained")
    largest = max(row.off for row in seen.values())
    axes = figure.subplots()
    for name, row in seen.items():
        ours = name == ELLIPSE
        place = row.milliseconds, row.off
        axes.plot(
            *place,
            marker="*" if ours else "o",
            markersize=18 if ours else 9,
            color="#d1495b" if ours else "#2e9cca",
            linestyle="",
        )
        axes.annotate(
            name,
            place,
            (12, -4),
            textcoords="offset points",
            fontsize="large",
            fontweight="bold" if ours else "normal",
        )
    axes.set_xlim(0.0, 1.25 * max(row.milliseconds for row in seen.values()))
    axes.set_ylim(-0.04 * largest, 1.15 * largest)
    axes.set_xlabel(f"time: milliseconds per step of a pile of {course.bodies}")
    axes.set_ylabel("error: direction of the push\nis off by (degrees)")
    axes.grid(True, which="major", color="0.9")
    axes.annotate(
        "faster and more exact",
        (0.012, 0.06),
        (0.05, 0.3),
        xycoords="axes fraction",
        color=OUTLINE,
        arrowprops={"arrowstyle": "->", "color": OUTLINE},
    )
    axes.spines[["top", "right"]].set_visible(False)
    return figure
