"""Speed against accuracy, per contact and per scene: polygons, the published fit and the common-normal fit."""

from __future__ import annotations

import csv
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from math import inf, isclose, nan
from pathlib import Path
from statistics import mean
from typing import Any

from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from tqdm import tqdm

from pymunk_ellipse import backend
from pymunk_ellipse.narrowphase import common_normal
from pymunk_ellipse.narrowphase.common_normal import TURN_TOLERANCE
from pymunk_ellipse.narrowphase.ellipse_ellipse import ellipse_ellipse

from ._builders import CIRCLE, ELLIPSE, EXACT_IMPACTS, Kind, polygon
from ._methods import Method, Pairs, Score, methods, random_pairs, score
from ._picture import OUTLINE, save
from ._scene_errors import (
    TimedPile,
    bounces_error,
    collision_error,
    gas_error,
    period_error,
    rolling_error,
    swing_lost,
)
from ._variants import replaced

ASPECT_RATIOS = 1.2, 2.0, 5.0, 20.0
QUICK_ASPECT_RATIOS = 2.0, 20.0
# By b: from less than the collision slop of a shape ten units wide to a hard hit.
DEPTHS = 0.003, 0.1
SEED = 1

Scores = dict[Method, Score]
# Median and worst of what a method is off by.
Accuracy = Callable[[Score], tuple[float, float]]

REFERENCE = "scan and bisection"

FAMILIES = {
    "polygons inside": ("C0", "s"),
    "polygons around": ("C9", "D"),
    "alternating fit": ("C2", "o"),
    "common normal, cold": ("C1", "v"),
    "common normal, warm": ("C3", "^"),
    "as shipped, cold": ("C1", "*"),
    "as shipped, warm": ("C3", "*"),
    REFERENCE: ("C7", "X"),
}
# What cannot be told from roundoff is drawn here.
ROUNDOFF = 1e-15


def run(out: Path, quick: bool) -> None:
    """Time and compare all methods; a quick run has fewer pairs, rounds and scenes, and compiles nothing."""
    contacts(out, quick)
    tolerances(out, quick)
    scenes(out, quick)


def contacts(out: Path, quick: bool) -> None:
    """The chart per contact."""
    pairs = 30 if quick else 400
    rounds = 1 if quick else 9
    compared = methods(machine_code=not quick)
    table = {
        ratio: time_methods(
            compared,
            random_pairs(ratio, *DEPTHS, pairs, SEED),
            rounds,
            f"aspect ratio {ratio:g}",
        )
        for ratio in (QUICK_ASPECT_RATIOS if quick else ASPECT_RATIOS)
    }
    write(table, out / "speed_accuracy.csv")
    read(table, pairs)
    save(draw(table, pairs), out / "speed_accuracy.png", dpi=110)


def time_methods(
    compared: list[Method], pairs: Pairs, rounds: int, label: str
) -> Scores:
    """Run all methods in turn, round after round, on the same pairs."""
    for method in compared:
        method.seconds.clear()
    for _ in tqdm(range(rounds), label, unit="round"):
        for method in compared:
            taken, method.found = method.run(pairs)
            method.seconds.append(taken)
    return {method: score(method, pairs) for method in compared}


def write(table: dict[float, Scores], path: Path) -> None:
    with open(path, "w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        rows.writerow(
            (
                "aspect ratio",
                "method",
                "number",
                "machine code",
                "microseconds",
                "depth off / b, median",
                "worst",
                "normal off (rad), median",
                "worst",
                "missed",
            )
        )
        for ratio, scores in table.items():
            for method, found in scores.items():
                offs = (f"{off:.3g}" for off in (*found.depth, *found.normal))
                rows.writerow(
                    (
                        ratio,
                        method.family,
                        method.count,
                        method.compiled,
                        f"{1e6 * found.seconds:.4g}",
                        *offs,
                        found.missed,
                    )
                )
    print(f"table: {path}")


def front(scores: Scores, accuracy: Accuracy) -> list[Method]:
    """The methods than which none is both faster and more accurate in the median, the fastest first."""
    best = inf
    result = []
    for method, found in sorted(scores.items(), key=lambda item: item[1].seconds):
        off = max(accuracy(found)[0], ROUNDOFF)
        if off < best and method.family != REFERENCE:
            best = off
            result.append(method)
    return result


def read(table: dict[float, Scores], pairs: int) -> None:
    """Say in numbers what the chart shows."""
    print(
        f"{pairs} pairs for each aspect ratio, depths from {DEPTHS[0]:g} b to {DEPTHS[1]:g} b"
    )
    for ratio, scores in table.items():
        print(f"aspect ratio {ratio:g}, machine code unless it says Python:")
        for method, found in scores.items():
            shown = method.family.startswith("as shipped") or (
                method.family,
                method.count,
            ) in (
                ("polygons inside", 8),
                ("polygons inside", 64),
                ("polygons around", 64),
                ("alternating fit", 10),
                ("common normal, warm", 2),
            )
            if shown:
                where = "" if method.compiled else " (Python)"
                print(
                    f"  {method.label + where:32} {1e6 * found.seconds:8.3f} us, depth off by "
                    f"{found.depth[0]:.1e} b (worst {found.depth[1]:.1e}), normal by "
                    f"{found.normal[0]:.1e} (worst {found.normal[1]:.1e}), missed {found.missed}"
                )
        best = front(scores, lambda found: found.normal)
        print(
            "  front in the normal: "
            + "; ".join(
                method.label + ("" if method.compiled else " (Python)")
                for method in best
            )
        )


def draw(table: dict[float, Scores], pairs: int) -> Figure:
    """A column for each aspect ratio, a row for the depth and one for the normal."""
    figure = Figure(figsize=(3.6 * len(table), 7.6), layout="constrained")
    rows = figure.subplots(2, len(table), sharex=True, sharey="row", squeeze=False)
    accuracies: tuple[Accuracy, Accuracy] = (
        lambda found: found.depth,
        lambda found: found.normal,
    )
    labels = "depth off by (in b)", "normal off by (radians)"
    for row, accuracy, label in zip(rows, accuracies, labels, strict=True):
        for axes, (ratio, scores) in zip(row, table.items(), strict=True):
            draw_panel(axes, scores, accuracy)
            axes.set_title(f"aspect ratio {ratio:g}", fontsize="medium")
            axes.set_xlabel("microseconds per pair")
        row[0].set_ylabel(label)
    handles = [
        Line2D([], [], color=color, marker=marker, linestyle="", label=family)
        for family, (color, marker) in FAMILIES.items()
    ]
    handles += [
        Line2D([], [], color=OUTLINE, label="front of all"),
        Line2D([], [], color=OUTLINE, linestyle=":", label="front in Python"),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=5)
    figure.suptitle(
        f"{pairs} overlapping pairs, {DEPTHS[0]:g} b to {DEPTHS[1]:g} b deep. Marks: median, the whisker ends at the worst; "
        "filled: machine code, hollow: Python.\nNumbers: vertices, sweeps or steps. "
        "Left and low is better.",
        fontsize="medium",
    )
    return figure


def draw_panel(axes: Axes, scores: Scores, accuracy: Accuracy) -> None:
    for method, found in scores.items():
        color, marker = FAMILIES[method.family]
        time = 1e6 * found.seconds
        typical, worst = (max(off, ROUNDOFF) for off in accuracy(found))
        axes.plot(
            time,
            typical,
            color=color,
            marker=marker,
            markersize=11 if marker == "*" else 6,
            markerfacecolor=color if method.compiled else "white",
            linestyle="",
            zorder=3,
        )
        axes.plot([time, time], [typical, worst], color=color, linewidth=0.6, alpha=0.7)
        if method.count and method.compiled:
            axes.annotate(
                str(method.count),
                (time, typical),
                (4, 3),
                textcoords="offset points",
                fontsize="xx-small",
                color=color,
            )
    python = {m: found for m, found in scores.items() if not m.compiled}
    for chosen, style in ((scores, "-"), (python, ":")):
        best = [chosen[method] for method in front(chosen, accuracy)]
        axes.plot(
            [1e6 * found.seconds for found in best],
            [max(accuracy(found)[0], ROUNDOFF) for found in best],
            drawstyle="steps-post",
            color=OUTLINE,
            linestyle=style,
            linewidth=1.0,
        )
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.spines[["top", "right"]].set_visible(False)


# Of the last turn (radians), the package's own among them.
TOLERANCES = 1e-1, 1e-2, 1e-3, 1e-4, TURN_TOLERANCE, 1e-8


class Counted:
    """A function that counts its calls."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.function = function
        self.calls = 0

    def __call__(self, *arguments: Any) -> Any:
        self.calls += 1
        return self.function(*arguments)


def tolerances(out: Path, quick: bool) -> None:
    """What the package's tolerance costs and gives: evaluations and errors, from the normal of a step before."""
    path = out / "speed_accuracy_tolerances.csv"
    print(
        "evaluations per contact (mean), worst normal (rad) and depth (b), by tolerance"
    )
    with open(path, "w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        rows.writerow(("aspect ratio", "tolerance", "evaluations", "normal", "depth"))
        for ratio in QUICK_ASPECT_RATIOS if quick else ASPECT_RATIOS:
            pairs = random_pairs(ratio, *DEPTHS, 30 if quick else 400, SEED)
            numbers = pairs.numbers.tolist()
            for tolerance in TOLERANCES:
                counted = Counted(common_normal.fitted_circles)
                normal = depth = 0.0
                with replaced(
                    (common_normal, "TURN_TOLERANCE", tolerance),
                    (common_normal, "fitted_circles", counted),
                ):
                    for pair, start, exact in zip(
                        numbers, pairs.warm.tolist(), pairs.exact.tolist(), strict=True
                    ):
                        a1, b1, *second = pair
                        first = a1, b1, 1.0, 0.0, 0.0, 0.0
                        found = ellipse_ellipse(first, tuple(second), *start)
                        sine = found[1] * exact[2] - found[2] * exact[1]
                        normal = max(normal, abs(sine))
                        depth = max(depth, abs(-found[0] - exact[0]))
                mean_evaluations = counted.calls / len(pairs)
                rows.writerow(
                    (
                        ratio,
                        tolerance,
                        f"{mean_evaluations:.2f}",
                        f"{normal:.1e}",
                        f"{depth:.1e}",
                    )
                )
                print(
                    f"  aspect ratio {ratio:<4g} tolerance {tolerance:.0e}: "
                    f"{mean_evaluations:5.2f}, {normal:.1e}, {depth:.1e}"
                )
    print(f"table: {path}")


POLYGONS = 8, 16, 32, 64, 128
QUICK_POLYGONS = 8, 32
RATES = 60, 120, 240, 480
QUICK_RATES = (240,)
SHIPPED = "ellipse"
WITH_IMPACTS = "ellipse, exact impacts"
IN_PYTHON = "ellipse (Python)"
A_CIRCLE = "circle"
RATE_COMPARED = 240

# What a circle does not do.
OF_ELLIPSES = {
    "period of rocking, off by": period_error,
    "swing lost in 10 s": swing_lost,
    "way rolled in 4 s, off by": rolling_error,
}
OF_ALL = {
    "outcome of an elastic hit, off by": collision_error,
    "pose after 2 to 4 bounces, off by (in a)": bounces_error,
    "energy of an elastic gas, off in a minute by": gas_error,
}
ERRORS = OF_ELLIPSES | OF_ALL
RESTLESSNESS = "speed in a pile at rest"
PILE_HEIGHT = "height of the pile, off the ellipses' mean by"


@dataclass
class Seen:
    """What a shape at a step costs, in milliseconds per second of a pile, and how large its errors are."""

    milliseconds: float
    errors: dict[str, float]


# By the name of the shape and the steps per second.
SeenAt = dict[tuple[str, int], Seen]


def scenes(out: Path, quick: bool) -> None:
    """The chart per scene."""
    kinds = {SHIPPED: ELLIPSE, WITH_IMPACTS: EXACT_IMPACTS, A_CIRCLE: CIRCLE}
    for count in QUICK_POLYGONS if quick else POLYGONS:
        kinds[f"{count}-gon"] = polygon(count)
    rates = QUICK_RATES if quick else RATES
    piles = time_piles(kinds, rates, quick)
    seen: SeenAt = {}
    heights = [pile.height for (name, _), pile in piles.items() if name == SHIPPED]
    height = mean(heights)
    for (name, rate), pile in tqdm(piles.items(), "scenes", unit="shape and step"):
        if name == IN_PYTHON:
            # It differs from machine code in nothing but time.
            errors = dict(seen[SHIPPED, rate].errors)
        else:
            errors = {
                label: nan
                if name == A_CIRCLE and label in OF_ELLIPSES
                else error(kinds[name], 1.0 / rate)
                for label, error in ERRORS.items()
            }
        errors[RESTLESSNESS] = pile.speed
        errors[PILE_HEIGHT] = nan if name == A_CIRCLE else pile.height / height - 1.0
        seen[name, rate] = Seen(pile.milliseconds, errors)
    with open(
        out / "speed_accuracy_scenes.csv", "w", newline="", encoding="utf-8"
    ) as file:
        rows = csv.writer(file)
        rows.writerow(
            (
                "shape",
                "steps per second",
                "ms per second",
                *ERRORS,
                RESTLESSNESS,
                PILE_HEIGHT,
            )
        )
        for (name, rate), found in seen.items():
            errors = (f"{error:.3g}" for error in found.errors.values())
            rows.writerow((name, rate, f"{found.milliseconds:.4g}", *errors))
    print(f"table: {out / 'speed_accuracy_scenes.csv'}")
    read_scenes(seen)
    times: dict[str, Callable[[TimedPile], float]] = {
        "at rest": lambda pile: pile.milliseconds,
        "that settles": lambda pile: pile.settling,
    }
    for part, seconds in times.items():
        ratios = [
            seconds(piles[WITH_IMPACTS, rate]) / seconds(piles[SHIPPED, rate])
            for rate in rates
        ]
        text = ", ".join(f"{ratio:.3f}" for ratio in ratios)
        print(f"a pile {part} with exact impacts, by the time of one without: {text}")
    scatter = (max(heights) - min(heights)) / height
    print(f"the piles of ellipses differ in height among themselves by {scatter:.2g}")
    save(draw_scenes(seen), out / "speed_accuracy_scenes.png", dpi=110)


def time_piles(
    kinds: dict[str, Kind], rates: Sequence[int], quick: bool
) -> dict[tuple[str, int], TimedPile]:
    """Let the piles come to rest, then step them in turn, round after round."""
    piles = {
        (name, rate): TimedPile(kind, 1.0 / rate)
        for name, kind in kinds.items()
        for rate in rates
    }
    if backend() == "compiled":
        with replaced():
            for rate in rates:
                piles[IN_PYTHON, rate] = TimedPile(ELLIPSE, 1.0 / rate)

    def at_work(name: str) -> AbstractContextManager[None]:
        """The backend that a pile was made for: no other knows its ellipses."""
        return replaced() if name == IN_PYTHON else nullcontext()

    for (name, _), pile in tqdm(piles.items(), "piles settle", unit="pile"):
        with at_work(name):
            pile.settle(2.0 if quick else 6.0)
    for _ in tqdm(range(2 if quick else 15), "piles timed", unit="round"):
        for (name, _), pile in piles.items():
            with at_work(name):
                pile.time(0.1)
    return piles


def read_scenes(seen: SeenAt) -> None:
    """Say which polygon, if any, is as accurate as the ellipse, at what price, and how errors fall with the step."""
    ellipse = seen[SHIPPED, RATE_COMPARED]
    print(
        f"ellipse at 1/{RATE_COMPARED} s: {ellipse.milliseconds:.1f} ms per second of a pile of 60"
    )
    polygons = {
        (name, rate): found
        for (name, rate), found in seen.items()
        if name.endswith("-gon")
    }
    for label, error in ellipse.errors.items():
        if label == PILE_HEIGHT:
            # Piles differ by chance.
            continue
        rivals = [
            (found.milliseconds / ellipse.milliseconds, name, rate)
            for (name, rate), found in polygons.items()
            if found.errors[label] <= error
        ]
        best = min(
            (found.errors[label], name, rate)
            for (name, rate), found in polygons.items()
        )
        print(
            f"  {label} {error:.2g}; best polygon: {best[1]} at 1/{best[2]} s, {best[0]:.2g}; as accurate: "
            + (
                "{1} at 1/{2} s, at {0:.2f} times the cost".format(*min(rivals))
                if rivals
                else "none"
            )
        )
    rates = sorted({rate for _, rate in seen})
    for label in OF_ALL:
        print(f"{label}, by steps per second {rates}:")
        for name in dict.fromkeys(name for name, _ in seen):
            if name != IN_PYTHON:
                errors = [seen[name, rate].errors[label] for rate in rates]
                print(f"  {name:24}" + "".join(f"{error:10.2g}" for error in errors))


def draw_scenes(seen: SeenAt) -> Figure:
    """A panel for each error, a line for each shape through its steps."""
    labels = [*ERRORS, RESTLESSNESS, PILE_HEIGHT]
    names = list(dict.fromkeys(name for name, _rate in seen))
    figure = Figure(figsize=(13.0, 7.6), layout="constrained")
    panels = figure.subplots(2, 4, sharex=True).flat
    shades = colormaps["viridis"]
    polygons = [name for name in names if name.endswith("-gon")]
    colors = {
        SHIPPED: "C3",
        IN_PYTHON: "C3",
        WITH_IMPACTS: "C1",
        A_CIRCLE: OUTLINE,
    } | {
        name: shades(0.85 * index / max(1, len(polygons) - 1))
        for index, name in enumerate(polygons)
    }
    for axes, label in zip(panels, labels, strict=True):
        logarithmic = label != PILE_HEIGHT
        least = 1e-13 if logarithmic else -1.0
        for name in names:
            points = [
                (found.milliseconds, max(found.errors[label], least), rate)
                for (other, rate), found in seen.items()
                if other == name
            ]
            ours = name.startswith(SHIPPED)
            axes.plot(
                [point[0] for point in points],
                [point[1] for point in points],
                color=colors[name],
                linestyle=":" if name == IN_PYTHON else "-",
                # Where it changes nothing it shows behind the line of the ellipse.
                linewidth=5.0 if name == WITH_IMPACTS else 2.0 if ours else 1.0,
                zorder=1.5 if name == WITH_IMPACTS else 2.0,
                marker="o",
                markersize=4,
                label=name,
            )
            if ours:
                for time, error, rate in points:
                    shipped = seen[SHIPPED, rate].errors[label]
                    if name == WITH_IMPACTS and isclose(error, shipped, rel_tol=0.5):
                        continue
                    axes.annotate(
                        f"1/{rate}",
                        (time, error),
                        (4, 4),
                        textcoords="offset points",
                        fontsize="xx-small",
                    )
        axes.set_xscale("log")
        axes.set_yscale("log" if logarithmic else "linear")
        axes.set_title(label, fontsize="medium")
        axes.set_xlabel("ms of work per second of a pile of 60", fontsize="small")
        axes.spines[["top", "right"]].set_visible(False)
    handles, texts = axes.get_legend_handles_labels()
    figure.legend(handles, texts, loc="outside lower center", ncols=len(texts))
    figure.suptitle(
        "Errors in scenes with known outcomes against the cost of a pile; the points of a line are steps of "
        + ", ".join(f"1/{rate}" for rate in dict.fromkeys(rate for _, rate in seen))
        + " s.\nRelative errors; 1 where nothing is left. Left and low is better.",
        fontsize="medium",
    )
    return figure
