"""Where methods find a wrong contact of two ellipses: over aspect ratio, depth and relative angle."""

from __future__ import annotations

import csv
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import atan2, cos, isfinite, pi, sin
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from tqdm import tqdm

from pymunk_ellipse.narrowphase.ellipse_ellipse import ellipse_ellipse
from pymunk_ellipse.published_fit import circle_fit

from ._methods import Floats, common_normal, exact_contacts
from ._picture import save
from ._variants import without_sweep

ASPECT_RATIOS = 1.5, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0
# By the shorter semi-axis of the smaller ellipse; each is the end of an interval.
DEPTHS = 0.01, 0.03, 0.1, 0.3, 0.6, 1.0, 1.6
ANGLES = tuple(degree * pi / 180.0 for degree in (0, 15, 30, 45, 60, 75, 90))
ANGLE_ASPECT_RATIO = 5.0
# The second ellipse's size, by the first's.
SIZES = 1.0, 0.3
# A depth that is off by more, by the smaller b, is wrong. The package promises 5e-7.
WRONG = 0.01
PROMISED = 1e-6
STEPS = 10
SEED = 2

# Says of one pair, with its exact contact and a random normal, whether a method fails.
Fails = Callable[[Sequence[float], Sequence[float], float], bool]


def fitted_depth(pair: Sequence[float], sweeps: int = 10) -> float:
    """The depth that the published fit gives."""
    a1, b1, a2, b2, c, s, dx, dy = pair
    return circle_fit((a1, b1, 0.0, 0.0), (a2, b2, dx, dy, atan2(s, c)), sweeps).depth


def wrong(depth: float, exact: Sequence[float], b: float, by: float = WRONG) -> bool:
    return not (isfinite(depth) and abs(depth - exact[0]) <= by * b)


def alternating_wrong(
    pair: Sequence[float], exact: Sequence[float], start: float
) -> bool:
    return wrong(fitted_depth(pair), exact, pair[3])


def alternating_unsettled(
    pair: Sequence[float], exact: Sequence[float], start: float
) -> bool:
    """Whether the last of ten sweeps still moves the depth.

    CircleFit.converged asks for much more than that.
    """
    return wrong(fitted_depth(pair, 9), (fitted_depth(pair),), pair[3])


def alternating_missed(
    pair: Sequence[float], exact: Sequence[float], start: float
) -> bool:
    return not fitted_depth(pair) > 0.0


def raw_wrong(pair: Sequence[float], exact: Sequence[float], start: float) -> bool:
    return wrong(common_normal(pair, 0.0, 0.0, STEPS)[0], exact, pair[3])


def package_wrong(
    pair: Sequence[float],
    exact: Sequence[float],
    start: float,
    given: bool,
    by: float,
) -> bool:
    a1, b1, a2, b2, c, s, dx, dy = pair
    nx, ny = (cos(start), sin(start)) if given else (0.0, 0.0)
    first, second = (a1, b1, 1.0, 0.0, 0.0, 0.0), (a2, b2, c, s, dx, dy)
    f = ellipse_ellipse(first, second, nx, ny)[0]
    return wrong(-f, exact, b2, by)


def climb_wrong(
    pair: Sequence[float], exact: Sequence[float], start: float, given: bool
) -> bool:
    with without_sweep():
        return package_wrong(pair, exact, start, given, WRONG)


METHODS: dict[str, Fails] = {
    "alternating fit:\nwrong depth": alternating_wrong,
    "alternating fit:\nstill moving": alternating_unsettled,
    "alternating fit:\ncontact missed": alternating_missed,
    "raw common normal:\nwrong depth": raw_wrong,
    "without sweep:\nwrong depth": partial(climb_wrong, given=False),
    "without sweep,\nrandom start: wrong": partial(climb_wrong, given=True),
    "as shipped:\noff by > 1e-6 b": partial(package_wrong, given=False, by=PROMISED),
    "as shipped,\nrandom start: > 1e-6 b": partial(
        package_wrong, given=True, by=PROMISED
    ),
}


@dataclass
class Map:
    """Parts of the pairs, a row for each depth and a column for each aspect ratio or angle, for which each method fails."""

    title: str
    columns: tuple[str, ...]
    along: str
    parts: dict[str, Floats]


def random_pairs(
    aspect_ratio: float,
    size: float,
    depths: tuple[float, float],
    angle: float | None,
    count: int,
    rng: np.random.Generator,
) -> tuple[Floats, Floats]:
    """Pairs whose exact depth lies between two numbers, by the smaller b, and their exact contacts.

    They touch at a random normal, then the second moves into the first along it; pairs that
    are less deep than that along another normal are kept if their depth is in the range.
    """
    kept: list[Floats] = []
    contacts: list[Floats] = []
    found = 0
    while found < count:
        tries = max(50, count)
        numbers = np.ones((tries, 8))
        numbers[:, 0] = aspect_ratio
        numbers[:, 2] = size * aspect_ratio
        numbers[:, 3] = size
        turned = rng.uniform(0.0, pi, tries) if angle is None else np.full(tries, angle)
        numbers[:, 4], numbers[:, 5] = np.cos(turned), np.sin(turned)
        direction = rng.uniform(0.0, 2.0 * pi, tries)
        x, y = np.cos(direction), np.sin(direction)
        depth = size * rng.uniform(depths[0], 2.0 * depths[1], tries)
        numbers[:, 6] = -depth * x
        numbers[:, 7] = -depth * y
        for a, b, by in (
            (numbers[:, 0], numbers[:, 1], np.zeros(tries)),
            (numbers[:, 2], numbers[:, 3], turned),
        ):
            c, s = np.cos(by), np.sin(by)
            u, v = a * (c * x + s * y), b * (c * y - s * x)
            reach = np.hypot(u, v)
            numbers[:, 6] += (c * a * u - s * b * v) / reach
            numbers[:, 7] += (s * a * u + c * b * v) / reach
        exact = exact_contacts(numbers)
        inside = (exact[:, 0] > depths[0] * size) & (exact[:, 0] <= depths[1] * size)
        kept.append(numbers[inside])
        contacts.append(exact[inside])
        found += int(np.sum(inside))
    return np.concatenate(kept)[:count], np.concatenate(contacts)[:count]


def make_map(
    title: str,
    along: str,
    cells: dict[str, tuple[float, float, float | None]],
    count: int,
    depths: Sequence[float],
) -> Map:
    """cells holds the aspect ratio, size and angle (None: random) of each column."""
    rng = np.random.default_rng(SEED)
    parts = {method: np.zeros((len(depths), len(cells))) for method in METHODS}
    lowest = (0.003, *depths[:-1])
    places = [(i, j) for i in range(len(depths)) for j in range(len(cells))]
    for i, j in tqdm(places, title, unit="cell"):
        ratio, size, angle = list(cells.values())[j]
        pairs, exact = random_pairs(
            ratio, size, (lowest[i], depths[i]), angle, count, rng
        )
        starts = rng.uniform(0.0, 2.0 * pi, count)
        rows = list(zip(pairs.tolist(), exact.tolist(), starts.tolist(), strict=True))
        for method, fails in METHODS.items():
            parts[method][i, j] = sum(fails(*row) for row in rows) / count
    return Map(title, tuple(cells), along, parts)


def run(out: Path, quick: bool) -> None:
    """Map failures; a quick run has fewer columns and pairs."""
    count = 10 if quick else 150
    ratios = (2.0, 5.0, 20.0) if quick else ASPECT_RATIOS
    depths = (0.1, 0.6, 1.6) if quick else DEPTHS
    maps = [
        make_map(
            "two equal ellipses" if size == 1.0 else f"one {size:g} times the other",
            "aspect ratio",
            {f"{ratio:g}": (ratio, size, None) for ratio in ratios},
            count,
            depths,
        )
        for size in SIZES
    ]
    angles = ANGLES[::3] if quick else ANGLES
    maps.append(
        make_map(
            f"two equal ellipses of aspect ratio {ANGLE_ASPECT_RATIO:g}",
            "relative angle (degrees)",
            {f"{a * 180 / pi:.0f}": (ANGLE_ASPECT_RATIO, 1.0, a) for a in angles},
            count,
            depths,
        )
    )
    with open(out / "failure_map.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["map", "along", "column", "depth up to / b", *METHODS])
        for each in maps:
            for j, column in enumerate(each.columns):
                for i, depth in enumerate(depths):
                    parts = (f"{part[i, j]:.4f}" for part in each.parts.values())
                    table.writerow([each.title, each.along, column, depth, *parts])
    print(f"{count} pairs a cell, depths up to {depths[-1]:g} b; failing, by method:")
    for method in METHODS:
        name = method.replace("\n", " ")
        where = []
        for each in maps:
            part = each.parts[method]
            i, j = np.unravel_index(int(np.argmax(part)), part.shape)
            worst = f"{part[i, j]:.1%}"
            if part[i, j] > 0.0:
                worst += (
                    f" ({each.along} {each.columns[j]}, depth up to {depths[i]:g} b)"
                )
            where.append(f"{each.title}: {part.mean():.1%}, at most {worst}")
        print(f"{name}\n  " + "\n  ".join(where))
    shipped = max(
        float(np.max(part))
        for each in maps
        for name, part in each.parts.items()
        if name.startswith("as shipped")
    )
    print(f"part of the pairs for which the shipped method is wrong: {shipped:g}")
    print(f"table: {out / 'failure_map.csv'}")
    save(draw(maps, depths), out / "failure_map.png", dpi=100)


def draw(maps: list[Map], depths: Sequence[float]) -> Figure:
    """A row for each map, a panel for each method."""
    figure = Figure(
        figsize=(2.35 * len(METHODS), 3.0 * len(maps)), layout="constrained"
    )
    rows = figure.subplots(len(maps), len(METHODS), sharey=True, squeeze=False)
    for row, each in zip(rows, maps, strict=True):
        for axes, (method, part) in zip(row, each.parts.items(), strict=True):
            draw_map(axes, part, each, depths)
            axes.set_title(method, fontsize="small")
        row[0].set_ylabel(f"{each.title}\n\ndepth up to (by the smaller b)")
    figure.suptitle("Percent of random pairs for which a method fails; white: none")
    return figure


def draw_map(axes: Axes, part: Floats, each: Map, depths: Sequence[float]) -> None:
    axes.imshow(part, cmap="Reds", vmin=0.0, vmax=0.6, origin="lower", aspect="auto")
    for (i, j), value in np.ndenumerate(part):
        if value > 0.0:
            axes.annotate(
                f"{100.0 * value:.0f}" if value >= 0.01 else "<1",
                (j, i),
                ha="center",
                va="center",
                fontsize="x-small",
                color="white" if value > 0.4 else "black",
            )
    axes.set_xticks(range(len(each.columns)), each.columns, fontsize="x-small")
    axes.set_yticks(range(len(depths)), [f"{d:g}" for d in depths], fontsize="x-small")
    axes.set_xlabel(each.along, fontsize="small")
