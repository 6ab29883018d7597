"""How many vertices and how much rounding an ellipse's hull should have: the time per step of piles."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import atan2, cos, pi, sin, sqrt
from pathlib import Path

import pymunk
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse as EllipsePatch
from matplotlib.patches import Polygon

from pymunk_ellipse import Ellipse, backend
from pymunk_ellipse.hull import ROUNDING, VERTICES, Hull, hull_with_moment, rounded_hull

from ._box import STEP
from ._picture import OUTLINE, save
from ._race import Course, Runner, Times, race

COUNTS = 6, 8, 10, 12
ROUNDINGS = 0.0, 0.1, 0.2, 0.3, 0.5
# The hull whose vertices give the ellipse's moment, instead of a rounding.
MOMENT = "moment"
ASPECT_RATIOS = 1.0, 2.0, 5.0, 10.0
QUICK_ASPECT_RATIOS = (2.0,)
# The same area for all: a b.
MEAN_RADIUS = 10.0
SETTLING = 2.0

FULL = Course(500, 20, round(SETTLING / STEP), rounds=30, steps_per_round=5)
QUICK = Course(60, 8, round(SETTLING / STEP), rounds=5, steps_per_round=4)

MakeHull = Callable[[float, float, float, float, float], Hull]


class EllipseWithHull(Ellipse):
    """An ellipse with another hull than its own."""

    def __init__(
        self, body: pymunk.Body, a: float, b: float, make_hull: MakeHull
    ) -> None:
        self._make_hull = make_hull
        super().__init__(body, a, b)

    def _hull(self) -> Hull:
        return self._make_hull(self.a, self.b, self.angle, *self.offset)


def kind(count: int, rounding: float | str) -> str:
    return f"{count} vertices, {rounding}"


def hulls(quick: bool) -> dict[str, MakeHull]:
    """What makes each kind of hull."""
    result: dict[str, MakeHull] = {}
    for count in (VERTICES,) if quick else COUNTS:
        for rounding in ROUNDINGS:
            result[kind(count, rounding)] = partial(
                rounded_hull, count=count, rounding=rounding
            )
        result[kind(count, MOMENT)] = partial(hull_with_moment, count=count)
    return result


def semi_axes(aspect_ratio: float) -> tuple[float, float]:
    return MEAN_RADIUS * sqrt(aspect_ratio), MEAN_RADIUS / sqrt(aspect_ratio)


def run(out: Path, quick: bool) -> None:
    """Time the piles of each aspect ratio in turn; a quick run has smaller and fewer."""
    course = QUICK if quick else FULL
    made = hulls(quick)
    counts = (VERTICES,) if quick else COUNTS
    chosen = kind(VERTICES, ROUNDING)
    print(
        f"{course.bodies} ellipses, {backend()} backend: time per step, "
        f"of that with {VERTICES} vertices and a rounding of {ROUNDING:g}"
    )
    raced: dict[float, Times] = {}
    for aspect_ratio in QUICK_ASPECT_RATIOS if quick else ASPECT_RATIOS:
        a, b = semi_axes(aspect_ratio)
        raced[aspect_ratio] = times = race(
            {
                name: Runner(
                    partial(EllipseWithHull, a=a, b=b, make_hull=make_hull),
                    max(a, b),
                    backend(),
                )
                for name, make_hull in made.items()
            },
            course,
        )
        print(f"aspect ratio {aspect_ratio:g}, {times.milliseconds(chosen):.3f} ms")
        print("vertices" + "".join(f"{column:>8}" for column in (*ROUNDINGS, MOMENT)))
        for count in counts:
            ratios = [
                times.ratio(kind(count, column), chosen)
                for column in (*ROUNDINGS, MOMENT)
            ]
            print(f"{count:8}" + "".join(f"{ratio:8.3f}" for ratio in ratios))
    save(draw(raced, counts), out / "hulls.png")


def draw(raced: dict[float, Times], counts: tuple[int, ...]) -> Figure:
    """A panel of times for each aspect ratio, and what some hulls look like."""
    figure = Figure(figsize=(3.0 * (len(raced) + 1), 3.8), layout="constrained")
    shape_axes, *times_axes = figure.subplots(1, len(raced) + 1)
    columns = [f"{rounding:g}" for rounding in ROUNDINGS] + [MOMENT]
    chosen = kind(VERTICES, ROUNDING)
    for axes, (aspect_ratio, times) in zip(times_axes, raced.items(), strict=True):
        for count in counts:
            axes.plot(
                columns,
                [
                    times.ratio(kind(count, column), chosen)
                    for column in (*ROUNDINGS, MOMENT)
                ],
                marker="o",
                label=f"{count} vertices",
            )
        axes.axhline(1.0, color="gray", linestyle=":")
        axes.tick_params(axis="x", labelsize="small")
        axes.set_xlabel("rounding")
        axes.set_title(f"aspect ratio {aspect_ratio:g}")
        axes.spines[["top", "right"]].set_visible(False)
    highest = max(axes.get_ylim()[1] for axes in times_axes)
    for axes in times_axes:
        axes.set_ylim(0.0, highest)
    times_axes[0].set_ylabel(f"time per step / {VERTICES} vertices, {ROUNDING:g}")
    times_axes[0].legend(loc="lower left")

    a, b = semi_axes(2.0)
    shown: dict[str, MakeHull] = {
        f"{VERTICES} vertices, 0": partial(rounded_hull, rounding=0.0),
        f"{VERTICES} vertices, {ROUNDING:g}": rounded_hull,
        f"{VERTICES} vertices, {MOMENT}": hull_with_moment,
    }
    for row, (label, make_hull) in enumerate(shown.items()):
        y = -2.8 * b * row
        draw_hull(shape_axes, make_hull(a, b, 0.0, 0.0, y))
        shape_axes.add_patch(
            EllipsePatch((0.0, y), 2.0 * a, 2.0 * b, fill=False, edgecolor=OUTLINE)
        )
        shape_axes.annotate(label, (0.0, y), ha="center", va="center", fontsize="small")
    shape_axes.set_title("hulls of an ellipse")
    shape_axes.axis("off")
    shape_axes.autoscale_view()
    shape_axes.set_aspect("equal")
    return figure


def draw_hull(axes: Axes, hull: Hull, steps: int = 16) -> None:
    """Draw a hull: its vertices, counterclockwise, widened by its radius."""
    vertices, radius = hull
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
