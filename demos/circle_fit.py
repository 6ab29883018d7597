"""The circles that the published fit and the common-normal fit put to two ellipses, sweep by sweep."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from math import atan2, cos, degrees, sin
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from matplotlib.patches import Ellipse as EllipsePatch

from pymunk_ellipse.examples.stage.fit import first_normal, step_at
from pymunk_ellipse.narrowphase.ellipse_ellipse import ellipse_ellipse
from pymunk_ellipse.published_fit import FittedCircle, PlacedEllipse, circle_fit

from ._picture import OUTLINE, save

SWEEPS = 4
PAIRS = {
    "published example, overlapping": (
        PlacedEllipse(2.0, 1.5, 0.5, 0.5, 0.2),
        PlacedEllipse(1.5, 1.0, 2.0, 2.5, 2.0),
    ),
    "apart": (
        PlacedEllipse(2.0, 1.0, 0.0, 0.0, 0.3),
        PlacedEllipse(1.4, 0.9, 3.0, 2.2, 2.4),
    ),
}
COLORS = "C0", "C3"


@dataclass(frozen=True)
class Sweep:
    """The circles after a sweep, the depth they give, and the unit normal along their centres."""

    circles: tuple[FittedCircle, FittedCircle]
    depth: float
    normal: tuple[float, float]


def alternating(one: PlacedEllipse, two: PlacedEllipse) -> list[Sweep]:
    """The published fit: each circle where its ellipse faces the other's last circle."""
    result = []
    for sweeps in range(1, SWEEPS + 1):
        fit = circle_fit(one, two, sweeps)
        result.append(Sweep((fit.first, fit.second), fit.depth, fit.normal))
    return result


def at_a_common_normal(one: PlacedEllipse, two: PlacedEllipse) -> list[Sweep]:
    """Both circles at the same normal, which then turns to the line of their centres."""
    normal = first_normal(one, two)
    result = []
    for _ in range(SWEEPS):
        step = step_at(one, two, normal)
        assert step.second is not None
        circles = step.first, step.second
        way = step.second.center - step.first.center
        depth = sum(circle.radius for circle in circles) - way.length
        fitted = [FittedCircle(*circle.center, circle.radius) for circle in circles]
        result.append(Sweep((fitted[0], fitted[1]), depth, way.normalized()))
        normal = way
    return result


METHODS = {"alternating fit": alternating, "common normal": at_a_common_normal}


def exact_depth(one: PlacedEllipse, two: PlacedEllipse) -> float:
    first, second = (
        (e.a, e.b, cos(e.angle), sin(e.angle), e.x, e.y) for e in (one, two)
    )
    return -ellipse_ellipse(first, second, 0.0, 0.0)[0]


def run(out: Path, quick: bool) -> None:
    """Draw both fits of both pairs; a quick run is the same."""
    fits = {
        (pair, method): METHODS[method](*PAIRS[pair])
        for pair in PAIRS
        for method in METHODS
    }
    with open(out / "circle_fit.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["pair", "method", "sweep", "depth", "depth off", "normal"])
        for (pair, method), sweeps in fits.items():
            exact = exact_depth(*PAIRS[pair])
            for i, sweep in enumerate(sweeps, 1):
                angle = atan2(sweep.normal[1], sweep.normal[0])
                row = f"{sweep.depth:.9f}", f"{sweep.depth - exact:.2e}", f"{angle:.9f}"
                table.writerow([pair, method, i, *row])
    for pair, ellipses in PAIRS.items():
        print(
            f"{pair}: exact depth {exact_depth(*ellipses):.6f}; off after each sweep:"
        )
        for method in METHODS:
            offs = [
                f"{sweep.depth - exact_depth(*ellipses):+.1e}"
                for sweep in fits[pair, method]
            ]
            print(f"  {method:16} {', '.join(offs)}")
    print(f"table: {out / 'circle_fit.csv'}")
    save(draw(fits), out / "circle_fit.png", dpi=110)


def draw(fits: dict[tuple[str, str], list[Sweep]]) -> Figure:
    """A row for each pair and method, a column for each sweep."""
    figure = Figure(figsize=(3.0 * SWEEPS, 2.9 * len(fits)), layout="constrained")
    rows = figure.subplots(len(fits), SWEEPS, squeeze=False)
    for row, ((pair, method), sweeps) in zip(rows, fits.items(), strict=True):
        exact = exact_depth(*PAIRS[pair])
        for i, (axes, sweep) in enumerate(zip(row, sweeps, strict=True), 1):
            draw_sweep(axes, PAIRS[pair], sweep)
            axes.set_title(
                f"sweep {i}: depth {sweep.depth:+.5f}, off by {abs(sweep.depth - exact):.0e}",
                fontsize="small",
            )
        row[0].text(
            -0.08,
            0.5,
            f"{method}\n{pair}",
            transform=row[0].transAxes,
            rotation=90,
            ha="center",
            va="center",
        )
    figure.suptitle(
        "Shaded: the ellipses. Circles: fitted, with their centres. Black: the line through the centres, the normal;"
        " dots: where it leaves the circles.",
        fontsize="medium",
    )
    return figure


def draw_sweep(
    axes: Axes, ellipses: tuple[PlacedEllipse, PlacedEllipse], sweep: Sweep
) -> None:
    for ellipse, circle, color in zip(ellipses, sweep.circles, COLORS, strict=True):
        axes.add_patch(
            EllipsePatch(
                (ellipse.x, ellipse.y),
                2.0 * ellipse.a,
                2.0 * ellipse.b,
                angle=degrees(ellipse.angle),
                facecolor=color,
                alpha=0.25,
            )
        )
        axes.add_patch(
            Circle((circle.x, circle.y), circle.radius, fill=False, edgecolor=color)
        )
        axes.plot(circle.x, circle.y, "+", color=color)
    (x1, y1, r1), (x2, y2, r2) = sweep.circles
    nx, ny = sweep.normal
    axes.plot([x1, x2], [y1, y2], color=OUTLINE, linewidth=0.8)
    axes.plot(x1 + r1 * nx, y1 + r1 * ny, ".", color=COLORS[0])
    axes.plot(x2 - r2 * nx, y2 - r2 * ny, ".", color=COLORS[1])
    shapes = [(e.x, e.y, e.a) for e in ellipses] + list(sweep.circles)
    axes.set_xlim(min(x - r for x, _y, r in shapes), max(x + r for x, _y, r in shapes))
    axes.set_ylim(min(y - r for _x, y, r in shapes), max(y + r for _x, y, r in shapes))
    axes.set_aspect("equal")
    axes.axis("off")
