"""The time per step of one pile of circles, of polygons and of ellipses, taken in turn."""

from __future__ import annotations

import csv
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from matplotlib.figure import Figure

from pymunk_ellipse import Ellipse

from ._box import STEP
from ._picture import save
from ._race import Course, Runner, race
from ._shapes import circle_of_equal_area, inscribed_polygon

# Semi-axes of aspect ratio 2 and 4, with almost the same area.
SHAPES = (14.0, 7.0), (20.0, 5.0)
POLYGONS = 8, 12, 16, 32, 64
BACKENDS = "python", "compiled"
YARDSTICKS = "circles", "8-gons", "12-gons", "32-gons"

# A round is so long that the caches hold the pile whose turn it is, as if there were no other.
# A pile about as high as wide. In a wider one overlaps are shallower, and polygons cost less.
FULL = Course(500, 16, steps_per_round=30)
QUICK = Course(60, 8, steps_per_round=4)
ROUNDS = 10
QUICK_ROUNDS = 8
# Several piles of each kind, because one may happen to settle with more contacts than others.
SEEDS = 1, 2, 3
QUICK_SEEDS = (1,)


def runners(a: float, b: float, course: Course) -> dict[str, Runner]:
    """The same pile of each kind of shape."""
    reach = max(a, b)
    result = {"circles": Runner(partial(circle_of_equal_area, a=a, b=b), reach, course)}
    for n in POLYGONS:
        polygon = partial(inscribed_polygon, a=a, b=b, count=n)
        result[f"{n}-gons"] = Runner(polygon, reach, course)
    for name in BACKENDS:
        ellipse = partial(Ellipse, a=a, b=b)
        result[f"ellipses ({name})"] = Runner(ellipse, reach, course, name)
    return result


@dataclass
class Row:
    """What is told of a kind of shape: milliseconds per step, and its time by that of each yardstick."""

    milliseconds: float
    ratios: dict[str, float]


Table = dict[str, Row]


def run(out: Path, quick: bool) -> None:
    """Time piles of 500 bodies, or 60 for a quick run, and compare them."""
    course = QUICK if quick else FULL
    rounds = QUICK_ROUNDS if quick else ROUNDS
    seeds = QUICK_SEEDS if quick else SEEDS
    times = race(
        {
            (a, b, name, seed): runner
            for a, b in SHAPES
            for seed in seeds
            for name, runner in runners(a, b, replace(course, seed=seed)).items()
        },
        rounds,
    )
    tables: dict[tuple[float, float], Table] = {}
    for a, b in SHAPES:
        names = [
            n for n in runners(a, b, course) if (a, b, n, seeds[0]) in times.seconds
        ]
        tables[a, b] = {
            name: Row(
                times.milliseconds(*((a, b, name, seed) for seed in seeds)),
                {
                    yardstick: times.ratio(
                        ((a, b, name, seed), (a, b, yardstick, seed)) for seed in seeds
                    )
                    for yardstick in YARDSTICKS
                },
            )
            for name in names
        }
    print(
        f"{course.bodies} bodies, dt=1/{1 / STEP:.0f}, median of {rounds} rounds of "
        f"{course.steps_per_round} steps, {len(seeds)} piles of each kind"
    )
    for (a, b), table in tables.items():
        print(f"a={a:g}, b={b:g}")
        print_table(table)
    write(tables, out / "speed.csv")
    save(draw(tables, course), out / "speed.png")


def print_table(table: Table) -> None:
    width = max(map(len, table))
    print(f"{'shapes':{width}}  ms/step" + "".join(f"  / {y:8}" for y in YARDSTICKS))
    for name, row in table.items():
        print(
            f"{name:{width}}  {row.milliseconds:7.3f}"
            + "".join(f"  {row.ratios[yardstick]:10.2f}" for yardstick in YARDSTICKS)
        )


def write(tables: dict[tuple[float, float], Table], path: Path) -> None:
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(
            ["a", "b", "shapes", "ms per step", *(f"ratio to {y}" for y in YARDSTICKS)]
        )
        for (a, b), table in tables.items():
            for name, row in table.items():
                ratios = [f"{row.ratios[yardstick]:.3f}" for yardstick in YARDSTICKS]
                writer.writerow(
                    [f"{a:g}", f"{b:g}", name, f"{row.milliseconds:.4f}", *ratios]
                )
    print(f"table: {path}")


def draw(tables: dict[tuple[float, float], Table], course: Course) -> Figure:
    """A bar for each kind of shape, a panel for each aspect ratio."""
    figure = Figure(figsize=(8.0, 3.5 * len(tables)), layout="constrained")
    panels = figure.subplots(len(tables), 1, sharex=True, squeeze=False)
    # The bars of the Python backend would leave no room for the others: they are cut.
    longest = 1.9 * max(
        row.milliseconds
        for table in tables.values()
        for name, row in table.items()
        if name != "ellipses (python)"
    )
    for (axes,), ((a, b), table) in zip(panels, tables.items(), strict=True):
        names = list(table)
        axes.barh(
            names,
            [row.milliseconds for row in table.values()],
            color=["C1" if name.startswith("ellipses") else "C0" for name in names],
        )
        for place, row in enumerate(table.values()):
            inside = row.milliseconds > 0.9 * longest
            cut = row.milliseconds > longest
            if cut:
                # A bar that goes on beyond the frame is seen to be broken.
                for end in 0.96, 0.98:
                    axes.plot(
                        [end * longest, (end + 0.01) * longest],
                        [place + 0.5, place - 0.5],
                        color="white",
                        linewidth=3.0,
                    )
            axes.annotate(
                f"{row.milliseconds:.2f} ms, {row.ratios['12-gons']:.2f} times 12-gons"
                + (": longer than the frame" if cut else ""),
                (0.0 if inside else row.milliseconds, place),
                textcoords="offset points",
                xytext=(4.0, 0.0),
                va="center",
            )
        axes.set_xlim(0.0, longest)
        axes.invert_yaxis()
        axes.set_title(f"a pile of {course.bodies} bodies, aspect ratio {a / b:g}")
        axes.spines[["top", "right"]].set_visible(False)
    panels[-1, 0].set_xlabel("milliseconds per step")
    return figure
