"""The time per step of one pile of circles, of polygons and of ellipses, taken in turn."""

from __future__ import annotations

import csv
from functools import partial
from pathlib import Path

from matplotlib.figure import Figure

from pymunk_ellipse import Ellipse

from ._box import STEP
from ._picture import save
from ._race import Course, Runner, Times, race
from ._shapes import circle_of_equal_area, inscribed_polygon

A = 14.0
B = 7.0
POLYGONS = 8, 12, 16, 32, 64
BACKENDS = "python", "compiled"
YARDSTICKS = "circles", "8-gons", "32-gons"
SETTLING = 2.0

FULL = Course(500, 30, round(SETTLING / STEP), rounds=40, steps_per_round=6)
QUICK = Course(100, 12, round(SETTLING / STEP), rounds=10, steps_per_round=4)


def runners() -> dict[str, Runner]:
    """The same pile of each kind of shape."""
    result = {"circles": Runner(partial(circle_of_equal_area, a=A, b=B), A)}
    for n in POLYGONS:
        result[f"{n}-gons"] = Runner(partial(inscribed_polygon, a=A, b=B, count=n), A)
    for name in BACKENDS:
        result[f"ellipses ({name})"] = Runner(partial(Ellipse, a=A, b=B), A, name)
    return result


def run(out: Path, quick: bool) -> None:
    """Time piles of 500 bodies, or 100 for a quick run, and compare them."""
    course = QUICK if quick else FULL
    times = race(runners(), course)
    names = list(times.seconds)
    width = max(map(len, names))
    print(
        f"{course.bodies} bodies, a={A:g}, b={B:g}, dt=1/{1 / STEP:.0f}, "
        f"median of {course.rounds} rounds of {course.steps_per_round} steps"
    )
    print(f"{'shapes':{width}}  ms/step" + "".join(f"  / {y:8}" for y in YARDSTICKS))
    with open(out / "speed.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(
            ["shapes", "ms per step", *(f"ratio to {y}" for y in YARDSTICKS)]
        )
        for name in names:
            milliseconds = times.milliseconds(name)
            ratios = [times.ratio(name, yardstick) for yardstick in YARDSTICKS]
            table.writerow([name, f"{milliseconds:.4f}", *(f"{r:.3f}" for r in ratios)])
            print(
                f"{name:{width}}  {milliseconds:7.3f}"
                + "".join(f"  {ratio:10.2f}" for ratio in ratios)
            )
    print(f"table: {out / 'speed.csv'}")
    save(draw(times, course), out / "speed.png")


def draw(times: Times, course: Course) -> Figure:
    """A bar for each kind of shape."""
    figure = Figure(figsize=(8.0, 4.0), layout="constrained")
    axes = figure.subplots()
    names = list(times.seconds)
    bars = axes.barh(
        names,
        [times.milliseconds(name) for name in names],
        color=["C1" if name.startswith("ellipses") else "C0" for name in names],
    )
    compared_with = YARDSTICKS[-1]
    labels = [
        f"{times.milliseconds(name):.2f} ms, {times.ratio(name, compared_with):.2f} times {compared_with}"
        for name in names
    ]
    axes.bar_label(bars, labels, padding=4)
    axes.invert_yaxis()
    axes.margins(x=0.4)
    axes.set_xlabel("milliseconds per step")
    axes.set_title(f"a pile of {course.bodies} bodies")
    axes.spines[["top", "right"]].set_visible(False)
    return figure
