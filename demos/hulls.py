"""How many vertices and how much rounding an ellipse's hull should have: the time per step of piles."""

from __future__ import annotations

import csv
from dataclasses import replace
from functools import cache, partial
from math import atan2, cos, pi, sin, sqrt
from pathlib import Path
from statistics import geometric_mean, median
from typing import Any

import pymunk
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse as EllipsePatch
from matplotlib.patches import Polygon

from pymunk_ellipse import Ellipse, backend
from pymunk_ellipse.chipmunk.private import c_points
from pymunk_ellipse.hull import ROUNDING, VERTICES, unit_polygon

from ._picture import OUTLINE, save
from ._race import Course, Runner, race

# No fewer: only a hull of more than six vertices leaves room for the ellipse in its struct.
COUNTS = 7, 8, 10, 12, 16
ROUNDINGS = 0.0, 0.05, 0.1, 0.2, 0.3, 0.5
QUICK_COUNTS = (VERTICES,)
FULL_ASPECT_RATIOS = 1.0, 1.5, 2.0, 4.0, 7.0, 10.0
ASPECT_RATIOS = 1.0, 2.0, 4.0, 10.0
QUICK_ASPECT_RATIOS = (2.0,)
# The same area for all: a b.
MEAN_RADIUS = 10.0

FULL = Course(500, 30, steps_per_round=5)
QUICK = Course(60, 8, steps_per_round=4)
ROUNDS = 16
QUICK_ROUNDS = 5
# A pile that has happened to settle more densely takes longer, so several are timed of each kind.
FULL_SEEDS = 1, 2, 3
SEEDS = 1, 2
QUICK_SEEDS = (1,)

# What makes the hull of an ellipse: a polygon around the unit circle, and a rounding.
HullKind = tuple[int, float]


class EllipseWithHull(Ellipse):
    """An ellipse with another hull than its own."""

    def __init__(
        self, body: pymunk.Body | None, a: float, b: float, hull_kind: HullKind
    ) -> None:
        count, rounding = hull_kind
        self._unit_polygon = polygon_of(count)
        self._rounding = rounding
        super().__init__(body, a, b)


@cache
def polygon_of(count: int) -> Any:
    return c_points(unit_polygon(count))


def kind(count: int, rounding: float) -> str:
    return f"{count} vertices, {rounding:g}"


CHOSEN = kind(VERTICES, ROUNDING)


def hulls(counts: tuple[int, ...]) -> dict[str, HullKind]:
    """What makes each kind of hull."""
    made = {
        kind(count, rounding): (count, rounding)
        for count in counts
        for rounding in ROUNDINGS
    }
    # The one in use is what all are compared with, whichever that is.
    return {**made, CHOSEN: (VERTICES, ROUNDING)}


def semi_axes(aspect_ratio: float) -> tuple[float, float]:
    return MEAN_RADIUS * sqrt(aspect_ratio), MEAN_RADIUS / sqrt(aspect_ratio)


class Timing:
    """Times of the kinds of hull at one aspect ratio: of a step, and of that with the chosen hull, for each seed."""

    def __init__(
        self,
        made: dict[str, HullKind],
        aspect_ratio: float,
        course: Course,
        rounds: int,
        seeds: tuple[int, ...],
    ) -> None:
        a, b = semi_axes(aspect_ratio)
        runners = {
            (name, seed): Runner(
                partial(EllipseWithHull, a=a, b=b, hull_kind=hull_kind),
                max(a, b),
                replace(course, seed=seed),
            )
            for name, hull_kind in made.items()
            for seed in seeds
        }
        times = race(runners, rounds)
        self.milliseconds = {
            name: times.milliseconds(*((name, seed) for seed in seeds)) for name in made
        }
        self.ratios = {
            name: [times.ratio([((name, seed), (CHOSEN, seed))]) for seed in seeds]
            for name in made
        }

    def ratio(self, name: str) -> float:
        """The median of all piles' ratios."""
        return median(self.ratios[name])


def run(out: Path, quick: bool, full: bool = False) -> None:
    """Time piles at some aspect ratios, a full run at all; a quick run has smaller and fewer."""
    course = QUICK if quick else FULL
    rounds = QUICK_ROUNDS if quick else ROUNDS
    counts = QUICK_COUNTS if quick else COUNTS
    seeds = QUICK_SEEDS if quick else FULL_SEEDS if full else SEEDS
    ratios = QUICK_ASPECT_RATIOS if quick else ASPECT_RATIOS
    if full:
        ratios = FULL_ASPECT_RATIOS
    made = hulls(counts)
    timed = {
        aspect_ratio: Timing(made, aspect_ratio, course, rounds, seeds)
        for aspect_ratio in ratios
    }
    overall = {
        name: geometric_mean(timing.ratio(name) for timing in timed.values())
        for name in made
    }

    print(
        f"{course.bodies} ellipses, {backend()} backend: time per step, of that with "
        f"{VERTICES} vertices and a rounding of {ROUNDING:g}, by rounding"
    )
    for aspect_ratio, timing in timed.items():
        print(f"aspect ratio {aspect_ratio:g}, {timing.milliseconds[CHOSEN]:.3f} ms")
        print_table({name: timing.ratio(name) for name in made}, counts)
    print("mean of all aspect ratios")
    print_table(overall, counts)
    fastest = min(overall, key=overall.__getitem__)
    print(f"fastest ({fastest}) to chosen ({CHOSEN}): {overall[fastest]:.3f}")
    write(timed, out / "hulls.csv")
    save(draw(timed, overall, counts), out / "hulls.png")


def print_table(ratios: dict[str, float], counts: tuple[int, ...]) -> None:
    """A row for each number of vertices, a column for each rounding."""
    print("vertices" + "".join(f"{rounding:8g}" for rounding in ROUNDINGS))
    for count in counts:
        row = [ratios[kind(count, rounding)] for rounding in ROUNDINGS]
        print(f"{count:8}" + "".join(f"{ratio:8.3f}" for ratio in row))


def write(timed: dict[float, Timing], path: Path) -> None:
    """Save every kind's time, and the lowest and highest ratio of its piles."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(
            ["aspect ratio", "hull", "ms per step", "ratio", "lowest", "highest"]
        )
        for aspect_ratio, timing in timed.items():
            for name, milliseconds in timing.milliseconds.items():
                ratios = timing.ratios[name]
                numbers = timing.ratio(name), min(ratios), max(ratios)
                table.writerow(
                    [f"{aspect_ratio:g}", name, f"{milliseconds:.4f}"]
                    + [f"{number:.3f}" for number in numbers]
                )
    print(f"table: {path}")


def draw(
    timed: dict[float, Timing], overall: dict[str, float], counts: tuple[int, ...]
) -> Figure:
    """What some hulls look like, and a panel of times for each aspect ratio and for their mean."""
    panels = {
        f"aspect ratio {aspect_ratio:g}": {n: timing.ratio(n) for n in overall}
        for aspect_ratio, timing in timed.items()
    }
    panels["mean of all"] = overall
    rows = 2 if len(panels) > 3 else 1
    columns = (len(panels) + rows) // rows
    figure = Figure(figsize=(3.1 * columns, 3.2 * rows + 0.5), layout="constrained")
    shape_axes, *times_axes = figure.subplots(rows, columns).flat
    for axes, (title, ratios) in zip(times_axes, panels.items(), strict=True):
        for index, count in enumerate(counts):
            axes.plot(
                ROUNDINGS,
                [ratios[kind(count, rounding)] for rounding in ROUNDINGS],
                marker="o",
                markersize=4.0,
                color=f"C{index}",
                label=f"{count} vertices",
            )
        axes.axhline(1.0, color="gray", linestyle=":", linewidth=1.0)
        axes.plot(
            [ROUNDING],
            [1.0],
            marker="o",
            markersize=11.0,
            markerfacecolor="none",
            markeredgecolor=OUTLINE,
            linestyle="none",
            label=f"in use: {VERTICES} vertices, {ROUNDING:g}",
        )
        axes.set_title(title)
        axes.set_xlabel("rounding / shorter semi-axis")
        axes.spines[["top", "right"]].set_visible(False)
    limits = [axes.get_ylim() for axes in times_axes]
    for axes in times_axes:
        axes.set_ylim(min(low for low, _ in limits), max(high for _, high in limits))
    for axes in times_axes[columns - 1 :: columns] if rows > 1 else ():
        axes.set_ylabel("time per step / that in use")
    times_axes[0].set_ylabel("time per step / that in use")
    handles, labels = times_axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))

    a, b = semi_axes(2.0)
    shown: dict[str, HullKind] = {
        f"{VERTICES} vertices, 0": (VERTICES, 0.0),
        f"{VERTICES} vertices, {ROUNDING:g}": (VERTICES, ROUNDING),
    }
    for row, (label, hull_kind) in enumerate(shown.items()):
        y = -2.8 * b * row
        draw_hull(shape_axes, a, b, y, hull_kind)
        shape_axes.add_patch(
            EllipsePatch((0.0, y), 2.0 * a, 2.0 * b, fill=False, edgecolor=OUTLINE)
        )
        shape_axes.annotate(label, (0.0, y), ha="center", va="center", fontsize="small")
    shape_axes.set_title("hulls of an ellipse")
    shape_axes.axis("off")
    shape_axes.autoscale_view()
    shape_axes.set_aspect("equal")
    return figure


def draw_hull(
    axes: Axes, a: float, b: float, y: float, hull_kind: HullKind, steps: int = 16
) -> None:
    """Draw the hull of an ellipse: its vertices, counterclockwise, widened by its radius."""
    hull = EllipseWithHull(None, a, b, hull_kind)
    vertices = [(vertex.x, vertex.y + y) for vertex in hull.get_vertices()]
    radius = hull.radius
    outline = []
    for i, (x, y) in enumerate(vertices):
        first = outward(vertices[i - 1], (x, y))
        turn = (outward((x, y), vertices[(i + 1) % len(vertices)]) - first) % (2.0 * pi)
        for step in range(steps + 1):
            angle = first + turn * step / steps
            outline.append((x + radius * cos(angle), y + radius * sin(angle)))
    axes.add_patch(Polygon(outline, color="C0", alpha=0.3))


def outward(start: tuple[float, float], end: tuple[float, float]) -> float:
    """Angle of the outward normal of a polygon's edge."""
    return atan2(start[0] - end[0], end[1] - start[1])
