"""Draws the comparison with the peers: pairs, scenes, and a small chart of both."""

from __future__ import annotations

from collections.abc import Callable

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import PercentFormatter

from . import rocking
from ._peers_pairs import (
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

# By the first word of a method's or an engine's family.
COLORS = {
    OURS: "C3",
    "pymunk": "C0",
    "Box2D": "C9",
    "MuJoCo": "C1",
    "coal": "C2",
    "fcl": "C4",
}
MARKERS = {
    OURS: "*",
    "pymunk": "s",
    "Box2D": "D",
    "MuJoCo": "^",
    "coal": "o",
    "fcl": "v",
}
# What cannot be told from roundoff is drawn here.
ROUNDOFF = 1e-15

Accuracy = Callable[[PairScore], tuple[float, float]]


def kind(family: str) -> str:
    return family.partition(",")[0]


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
                draw_errors(axes, method, found, accuracy(found))
            axes.set_yscale("log")
        row[0].set_ylabel(label)
    for axes, scores in zip(rows[2], table.values(), strict=True):
        for method, found in scores.items():
            part = (found.missed + found.wrong) / found.count
            draw_mark(axes, method, 1e6 * found.bare, part)
            draw_mark(axes, method, 1e6 * found.called, part, hollow=True)
        axes.set_xlabel("microseconds per pair")
        axes.yaxis.set_major_formatter(PercentFormatter(1.0))
        axes.set_xscale("log")
    rows[2][0].set_ylabel("missed or wrong")
    for axes, case in zip(rows[0], table, strict=True):
        axes.set_title(str(case), fontsize="medium")
    for axes in rows.flat:
        axes.spines[["top", "right"]].set_visible(False)
        axes.grid(color="0.93")
        axes.set_axisbelow(True)
    families = dict.fromkeys(m.family for scores in table.values() for m in scores)
    handles = [
        Line2D([], [], linestyle="", label=family, **style(family))
        for family in families
    ]
    handles += [
        Line2D([], [], color="0.4", marker="o", linestyle="", label="without the call"),
        Line2D(
            [],
            [],
            color="0.4",
            marker="o",
            markerfacecolor="white",
            linestyle="",
            label="as called from Python",
        ),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=4)
    count = next(iter(next(iter(table.values())).values())).count
    figure.suptitle(
        f"The contact of two ellipses: {count} pairs in each column. Marks: median; the line ends at the worst pair. "
        "Left and low is better.\nNumbers: vertices of a polygon, or iterations of a search. Wrong: depth off by more than "
        f"{WRONG_DEPTH:g} b, or normal by more than {WRONG_NORMAL:g} rad.",
        fontsize="medium",
    )
    return figure


def style(family: str, hollow: bool = False) -> dict[str, object]:
    color = COLORS[kind(family)]
    return {
        "color": color,
        "marker": MARKERS[kind(family)],
        "markersize": 12 if family == OURS else 6,
        "markerfacecolor": "white" if hollow else color,
    }


def draw_mark(
    axes: Axes, method: PairMethod, x: float, y: float, hollow: bool = False
) -> None:
    axes.plot(x, y, linestyle="", zorder=3, **style(method.family, hollow))


def draw_errors(
    axes: Axes, method: PairMethod, found: PairScore, off: tuple[float, float]
) -> None:
    typical, worst = (max(error, ROUNDOFF) for error in off)
    bare, called = 1e6 * found.bare, 1e6 * found.called
    color = COLORS[kind(method.family)]
    axes.plot([bare, called], [typical] * 2, color=color, linewidth=0.6, linestyle=":")
    axes.plot([bare] * 2, [typical, worst], color=color, linewidth=1.0, alpha=0.7)
    axes.plot(bare, worst, color=color, marker="_", markersize=6)
    draw_mark(axes, method, called, typical, hollow=True)
    draw_mark(axes, method, bare, typical)
    if method.number:
        axes.annotate(
            str(method.number),
            (bare, typical),
            (0, -11),
            textcoords="offset points",
            ha="center",
            fontsize="xx-small",
            color=color,
        )


def draw_scenes(seen: dict[Engine, Seen]) -> Figure:
    """A row for each engine, a column for each thing seen."""
    figure = Figure(figsize=(14.0, 5.2), layout="constrained")
    panels = figure.subplots(1, 6, sharey=True)
    names = [str(engine) for engine in seen]
    tilts = rocking.TILTS
    rates = list(next(iter(seen.values())).gas)
    many = "o", "s", "^"
    for row, (engine, found) in enumerate(seen.items()):
        color = COLORS[engine.family]
        panels[0].plot(found.milliseconds, row, "o", color=color)
        panels[0].annotate(
            f"{found.milliseconds:.2g}",
            (found.milliseconds, row),
            (6, 0),
            textcoords="offset points",
            va="center",
            fontsize="small",
        )
        panels[1].plot(max(found.restless, 1e-12), row, "o", color=color)
        if found.outside:
            panels[1].annotate(
                f"{found.outside} left the box",
                (max(found.restless, 1e-12), row),
                (0, 6),
                textcoords="offset points",
                ha="center",
                fontsize="x-small",
            )
        typical, worst = found.overlap
        if worst > 0.0:
            panels[2].plot([typical, worst], [row, row], color=color)
            panels[2].plot(typical, row, "o", color=color)
        else:
            note(panels[2], row, "none")
        for tilt, marker in zip(tilts, many, strict=True):
            swing = found.rocking.get(tilt)
            if swing is not None:
                panels[4].plot(swing.amplitude_kept, row, marker, color=color)
                error = period_off(found, tilt)
                if error is not None:
                    panels[3].plot(abs(error), row, marker, color=color)
        if not found.rocking:
            note(panels[3], row, "rolls")
            note(panels[4], row, "rolls")
        elif all(swing.period is None for swing in found.rocking.values()):
            note(panels[3], row, "does not rock")
        for rate, marker in zip(rates, many, strict=False):
            panels[5].plot(
                min(max(found.gas[rate], 1e-3), 1e3), row, marker, color=color
            )
    titles = (
        "pile at rest:\nms per step",
        "pile: kinetic energy left\n(as a height, in b)",
        "pile: overlap (in b),\nmean to worst",
        "rocking:\nperiod off by",
        "rocking:\nswing kept after 10 s",
        "elastic gas:\nenergy left after 10 s",
    )
    for axes, title in zip(panels, titles, strict=True):
        axes.set_title(title, fontsize="medium")
        axes.spines[["top", "right"]].set_visible(False)
        axes.grid(axis="both", color="0.93")
        axes.set_axisbelow(True)
        axes.set_xscale("log")
    panels[0].set_xlim(right=4.0 * max(found.milliseconds for found in seen.values()))
    panels[4].set_xscale("linear")
    panels[4].xaxis.set_major_formatter(PercentFormatter(1.0))
    panels[5].axvline(1.0, color=OUTLINE, linewidth=0.8)
    panels[0].set_yticks(range(len(names)), names)
    panels[0].invert_yaxis()
    return figure


def note(axes: Axes, row: int, text: str) -> None:
    axes.annotate(
        text,
        (0.5, row),
        xycoords=("axes fraction", "data"),
        ha="center",
        va="center",
        fontsize="small",
        color="0.5",
    )


def draw_small(scores: PairScores, seen: dict[Engine, Seen]) -> Figure:
    """What the README shows: one case of the pairs, and the pile's cost against how well an ellipse rocks."""
    figure = Figure(figsize=(8.4, 3.8), layout="constrained")
    pairs, scenes = figure.subplots(1, 2)
    for method, found in scores.items():
        place = 1e6 * found.bare, max(found.normal)
        draw_mark(pairs, method, *place)
        label(pairs, place, method.label)
    pairs.set_xlabel("microseconds per pair")
    pairs.set_ylabel("normal off by at most (radians)")
    for engine, found in seen.items():
        if (lost := swing_off(found)) is not None:
            place = found.milliseconds, lost
            scenes.plot(*place, linestyle="", **style(engine.family))
            label(scenes, place, str(engine))
    scenes.set_xlabel("ms per step of a pile")
    scenes.set_ylabel("swing lost or gained by a rocking one in 10 s")
    for axes in pairs, scenes:
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.spines[["top", "right"]].set_visible(False)
    return figure


def label(axes: Axes, place: tuple[float, float], text: str) -> None:
    axes.annotate(text, place, (6, 3), textcoords="offset points", fontsize="x-small")
