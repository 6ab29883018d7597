"""Draws the comparison with the peers: pairs, scenes, and a small chart of both."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import PercentFormatter

from . import rocking
from ._peers_pairs import (
    DISTANCE,
    OURS,
    WRONG_DEPTH,
    WRONG_NORMAL,
    Case,
    PairMethod,
    PairScore,
    PairScores,
)
from ._peers_scenes import Engine, Seen, period_off, swing_off
from ._picture import OUTLINE

# Colour and marker, by the first word of a method's or an engine's family.
STYLES = {
    OURS: ("C3", "*"),
    "pymunk": ("C0", "s"),
    "Box2D": ("C9", "D"),
    "MuJoCo": ("C1", "^"),
    "coal": ("C2", "o"),
    "fcl": ("C4", "v"),
}
# What cannot be told from roundoff is drawn here.
ROUNDOFF = 1e-15

Accuracy = Callable[[PairScore], tuple[float, float]]


def style(family: str, hollow: bool = False) -> dict[str, Any]:
    color, marker = STYLES[family.partition(",")[0]]
    return {
        "color": color,
        "marker": marker,
        "markersize": 12 if family == OURS else 6,
        "markerfacecolor": "white" if hollow else color,
        "linestyle": "",
        "zorder": 3,
    }


def color_of(family: str) -> str:
    return STYLES[family.partition(",")[0]][0]


def tidy(axes: Axes) -> None:
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(color="0.93")
    axes.set_axisbelow(True)


def families(names: Iterable[str]) -> list[Line2D]:
    """Entries of a legend, each family once."""
    return [
        Line2D([], [], label=family, **style(family)) for family in dict.fromkeys(names)
    ]


def calls_and_none() -> list[Line2D]:
    """Entries of a legend for filled and hollow marks."""
    labels = {"0.4": "without the cost of a call", "white": "as called from Python"}
    return [
        Line2D(
            *([], []),
            color="0.4",
            marker="o",
            markerfacecolor=face,
            linestyle="",
            label=label,
        )
        for face, label in labels.items()
    ]


def draw_pairs(table: dict[Case, PairScores]) -> Figure:
    """A column for each case; rows for the depth, the normal and the contacts that are no good."""
    figure = Figure(figsize=(12.0, 9.6), layout="constrained")
    rows = figure.subplots(
        3, len(table), sharex=True, sharey="row", height_ratios=[1.0, 1.0, 0.5]
    )
    accuracies: tuple[Accuracy, Accuracy] = (
        lambda found: found.depth,
        lambda found: found.normal,
    )
    labels = "depth off by (in b)", "normal off by (radians)"
    for row, accuracy, label in zip(rows[:2], accuracies, labels, strict=True):
        for axes, scores in zip(row, table.values(), strict=True):
            for method, found in scores.items():
                typical, worst = (max(off, ROUNDOFF) for off in accuracy(found))
                draw_worst(axes, method, found, typical, worst)
                draw_times(axes, method, found, typical)
            number(axes, {m: (1e6 * f.bare, accuracy(f)[0]) for m, f in scores.items()})
            axes.set_yscale("log")
        row[0].set_ylabel(label)
    for axes, scores in zip(rows[2], table.values(), strict=True):
        for method, found in scores.items():
            part = (found.missed + found.wrong) / found.count
            draw_times(axes, method, found, part)
        axes.set_xlabel("microseconds per pair")
        axes.set_xscale("log")
        axes.yaxis.set_major_formatter(PercentFormatter(1.0))
    rows[2][0].set_ylabel("missed or wrong")
    for axes, case in zip(rows[0], table, strict=True):
        axes.set_title(str(case), fontsize="medium")
    for axes in rows.flat:
        tidy(axes)
    scores = next(iter(table.values()))
    figure.legend(
        handles=families(method.family for method in scores) + calls_and_none(),
        loc="outside lower center",
        ncols=4,
    )
    count = next(iter(scores.values())).count
    figure.suptitle(
        f"The contact of two ellipses: {count} pairs in each column. Marks: median; the line ends at the worst pair. "
        "Left and low is better.\nNumbers: vertices of a polygon, or iterations of a search. Wrong: depth off by more than "
        f"{WRONG_DEPTH:g} b, or normal by more than {WRONG_NORMAL:g} rad.",
        fontsize="medium",
    )
    return figure


def draw_times(axes: Axes, method: PairMethod, found: PairScore, y: float) -> None:
    """A pair's time with the call and without."""
    bare, called = 1e6 * found.bare, 1e6 * found.called
    color = color_of(method.family)
    axes.plot([bare, called], [y, y], color=color, linewidth=0.6, linestyle=":")
    axes.plot(called, y, **style(method.family, hollow=True))
    axes.plot(bare, y, **style(method.family))


def draw_worst(
    axes: Axes, method: PairMethod, found: PairScore, typical: float, worst: float
) -> None:
    bare = 1e6 * found.bare
    color = color_of(method.family)
    axes.plot([bare, bare], [typical, worst], color=color, linewidth=1.0, alpha=0.7)
    axes.plot(bare, worst, color=color, marker="_", markersize=6)


def number(axes: Axes, places: dict[PairMethod, tuple[float, float]]) -> None:
    """Write the methods' numbers below their marks, in a family to the left and the right in turn."""
    before = Counter[str]()
    for method, place in places.items():
        if method.number:
            left = before[method.family] % 2 == 0
            write(axes, place, str(method.number), method.family, left)
            before[method.family] += 1


def write(
    axes: Axes, place: tuple[float, float], text: str, family: str, left: bool
) -> None:
    axes.annotate(
        text,
        place,
        (2 if left else -2, -12),
        textcoords="offset points",
        ha="right" if left else "left",
        fontsize="x-small",
        color=color_of(family),
    )


def draw_scenes(seen: dict[Engine, Seen]) -> Figure:
    """A row for each engine, a column for each thing seen."""
    figure = Figure(figsize=(14.0, 5.4), layout="constrained")
    panels = dict(
        zip(TITLES, figure.subplots(1, len(TITLES), sharey=True), strict=True)
    )
    rates = list(next(iter(seen.values())).gas)
    for row, (engine, found) in enumerate(seen.items()):
        color = color_of(engine.family)
        panels["time"].plot(found.milliseconds, row, "o", color=color)
        note(panels["time"], found.milliseconds, row, f"{found.milliseconds:.2g}")
        panels["energy"].plot(found.restless, row, "o", color=color)
        if found.outside:
            text = f"{found.outside} left the box"
            note(panels["energy"], found.restless, row, text)
        mean, worst = found.overlap
        if worst > 0.0:
            panels["overlap"].plot([mean, worst], [row, row], color=color)
            panels["overlap"].plot(mean, row, "o", color=color)
        else:
            say(panels["overlap"], row, "none")
        for tilt, marker in zip(rocking.TILTS, MARKERS, strict=True):
            if tilt in found.rocking:
                kept = found.rocking[tilt].amplitude_kept
                panels["swing"].plot(kept, row, marker, color=color)
            if (error := period_off(found, tilt)) is not None:
                panels["period"].plot(abs(error), row, marker, color=color)
        if not found.rocking:
            for name in "period", "swing":
                say(panels[name], row, "rolls away")
        elif all(swing.period is None for swing in found.rocking.values()):
            say(panels["period"], row, "does not rock")
        for rate, marker in zip(rates, MARKERS, strict=False):
            panels["gas"].plot(found.gas[rate], row, marker, color=color)
    for name, axes in panels.items():
        axes.set_title(TITLES[name], fontsize="medium")
        axes.set_xscale("linear" if name == "swing" else "log")
        tidy(axes)
        axes.margins(x=0.25 if name == "time" else 0.1)
    panels["swing"].xaxis.set_major_formatter(PercentFormatter(1.0))
    panels["gas"].axvline(1.0, color=OUTLINE, linewidth=0.8)
    panels["time"].set_yticks(range(len(seen)), map(str, seen))
    panels["time"].invert_yaxis()
    labels = {
        "rocking, let go at": [f"{tilt:g} rad" for tilt in rocking.TILTS],
        "gas, steps of": [f"1/{rate} s" for rate in rates],
    }
    handles = []
    for title, names in labels.items():
        handles.append(Line2D([], [], linestyle="", label=title))
        handles += [
            Line2D([], [], color="0.4", linestyle="", marker=marker, label=name)
            for marker, name in zip(MARKERS, names, strict=False)
        ]
    figure.legend(
        handles=handles, loc="outside lower center", ncols=len(handles), frameon=False
    )
    return figure


MARKERS = "o", "s", "^"
TITLES = {
    "time": "pile at rest:\nms per step",
    "energy": "pile: kinetic energy left\n(as a height, in b)",
    "overlap": "pile: overlap (in b),\nmean to worst",
    "period": "rocking:\nperiod off by",
    "swing": "rocking:\nswing kept after 10 s",
    "gas": "elastic gas after 10 s:\nenergy / that at the start",
}


def note(axes: Axes, x: float, row: int, text: str) -> None:
    """Write beside a mark."""
    axes.annotate(
        text,
        (x, row),
        (6, 0),
        textcoords="offset points",
        va="center",
        fontsize="small",
    )


def say(axes: Axes, row: int, text: str) -> None:
    """Write in place of a mark."""
    axes.annotate(
        text,
        (0.5, row),
        xycoords=("axes fraction", "data"),
        ha="center",
        va="center",
        fontsize="small",
        color="0.5",
    )


def draw_small(case: Case, scores: PairScores, seen: dict[Engine, Seen]) -> Figure:
    """What the README shows: one case of the pairs, and the pile's cost against how well an ellipse rocks."""
    figure = Figure(figsize=(8.6, 4.2), layout="constrained")
    pairs, scenes = figure.subplots(1, 2)
    shown = {m: found for m, found in scores.items() if m.family != DISTANCE}
    for method, found in shown.items():
        draw_times(pairs, method, found, found.normal[1])
    number(pairs, {m: (1e6 * f.bare, f.normal[1]) for m, f in shown.items()})
    pairs.set_title(f"contact of two ellipses, aspect ratio {case.aspect_ratio:g}")
    pairs.set_xlabel("microseconds per pair")
    pairs.set_ylabel("normal off by at most (radians)")
    rocks = {
        engine: off
        for engine, found in seen.items()
        if (off := swing_off(found)) is not None
    }
    many = Counter(engine.family for engine in rocks)
    before = Counter[str]()
    for engine, off in rocks.items():
        place = seen[engine].milliseconds, off
        scenes.plot(*place, **style(engine.family))
        if many[engine.family] > 1:
            short = engine.shape.removesuffix("-gons").removeprefix("ellipsoids, ")
            left = before[engine.family] % 2 == 0
            write(scenes, place, short, engine.family, left)
            before[engine.family] += 1
    scenes.set_title("many in a pile, one rocking on the floor")
    scenes.set_xlabel("ms per step of the pile")
    scenes.set_ylabel("swing lost or gained in 10 s")
    scenes.margins(x=0.2)
    for axes in pairs, scenes:
        axes.title.set_fontsize("medium")
        axes.set_xscale("log")
        axes.set_yscale("log")
        tidy(axes)
    figure.legend(
        handles=families(method.family for method in shown) + calls_and_none(),
        loc="outside lower center",
        ncols=4,
        fontsize="small",
    )
    return figure
