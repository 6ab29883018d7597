"""Random sequential adsorption of ellipses: the coverage at which no other fits, by the exact overlap test alone."""

from __future__ import annotations

import random
from math import cos, floor, pi, sin, sqrt
from pathlib import Path
from statistics import mean

import numpy as np
from matplotlib.collections import EllipseCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray
from tqdm import tqdm

from pymunk_ellipse.narrowphase.ellipse_ellipse import ellipse_ellipse

from ._densities import tell_densities
from ._picture import save

ASPECT_RATIOS = 1.0, 1.3, 1.85, 2.6, 4.0
QUICK_ASPECT_RATIOS = 1.0, 1.85, 4.0
# Saturated coverage of circles (J. Feder, 1980, and many since), and the aspect ratio of the
# highest one (P. Viot and others, 1992; P. Abritta and R. S. Hoy, "Structure of saturated RSA
# ellipse packings", 2022).
CIRCLES = 0.547
DENSEST = 1.85
# The area of the square, by that of an ellipse.
AREA = 400.0
SEED = 7
# Squares for each aspect ratio.
RUNS, FULL_RUNS = 4, 16


class Surface:
    """A periodic square with ellipses of b = 1 on it, none of which overlap."""

    def __init__(self, aspect_ratio: float, rng: random.Random) -> None:
        self.a = aspect_ratio
        self.rng = rng
        self.side = sqrt(AREA * pi * self.a)
        self.placed: list[tuple[float, float, float, float]] = []
        # Cells no smaller than two ellipses can be apart and touch.
        self.columns = max(3, floor(self.side / (2.0 * self.a)))
        self.cells: dict[tuple[int, int], list[int]] = {}
        # Squares in which a centre may still lie: not all within 2 b of another.
        count = floor(self.side * 4.0)
        self.width = self.side / count
        corners = np.arange(count) * self.width
        self.squares: NDArray[np.float64] = np.stack(
            np.meshgrid(corners, corners), axis=-1
        ).reshape(-1, 2)
        self.all_squares = len(self.squares)
        # Attempts, by the number of ellipses that would fill the square.
        self.time = 0.0

    @property
    def coverage(self) -> float:
        return len(self.placed) / AREA

    def attempt(self) -> None:
        """Try to place an ellipse, and count the attempts at places that are known to be taken."""
        self.time += self.all_squares / len(self.squares) / AREA
        x, y = self.squares[self.rng.randrange(len(self.squares))]
        x = float(x) + self.rng.random() * self.width
        y = float(y) + self.rng.random() * self.width
        angle = self.rng.uniform(0.0, pi)
        c, s = cos(angle), sin(angle)
        column = int(x / self.side * self.columns)
        row = int(y / self.side * self.columns)
        for i in (-1, 0, 1):
            for j in (-1, 0, 1):
                cell = (column + i) % self.columns, (row + j) % self.columns
                for index in self.cells.get(cell, ()):
                    if self.overlaps(x, y, c, s, index):
                        return
        self.cells.setdefault((column, row), []).append(len(self.placed))
        self.placed.append((x, y, c, s))
        self.block(x, y)

    def overlaps(self, x: float, y: float, c: float, s: float, index: int) -> bool:
        other_x, other_y, other_c, other_s = self.placed[index]
        side = self.side
        dx = other_x - x
        dy = other_y - y
        dx -= side * round(dx / side)
        dy -= side * round(dy / side)
        square = dx * dx + dy * dy
        a = self.a
        if square <= 4.0:
            return True
        if square >= 4.0 * a * a:
            return False
        first = a, 1.0, c, s, 0.0, 0.0
        second = a, 1.0, other_c, other_s, dx, dy
        return ellipse_ellipse(first, second, 0.0, 0.0)[0] < 0.0

    def block(self, x: float, y: float) -> None:
        """Leave out squares whose every point is within 2 b of a new centre."""
        half = self.width / 2.0
        away = np.abs(self.squares + half - (x, y))
        away = np.minimum(away, self.side - away) + half
        self.squares = self.squares[np.sum(away * away, axis=1) > 4.0]


def saturated(
    surface: Surface, attempts: int
) -> tuple[float, list[float], list[float]]:
    """The coverage after endless time, and coverages over time.

    Late gaps are filled as t^(-1/2) for circles, and as t^(-1/3) where the angle counts
    too; a line through the last two decades of a run is followed to where that is zero.
    """
    power = -1.0 / 2.0 if surface.a == 1.0 else -1.0 / 3.0
    times: list[float] = []
    coverages: list[float] = []
    for _ in range(attempts):
        if not len(surface.squares):
            break
        surface.attempt()
        if not times or surface.time > 1.1 * times[-1]:
            times.append(surface.time)
            coverages.append(surface.coverage)
    if not len(surface.squares):
        return surface.coverage, times, coverages
    late = np.array(times) > max(1.0, times[-1] / 100.0)
    x = np.array(times)[late] ** power
    _slope, end = np.polyfit(x, np.array(coverages)[late], 1)
    return float(end), times, coverages


def run(out: Path, quick: bool, full: bool = False) -> None:
    """Fill squares for each aspect ratio, more in a full run; a quick run fills fewer, and gives up sooner."""
    ratios = QUICK_ASPECT_RATIOS if quick else ASPECT_RATIOS
    runs = 1 if quick else FULL_RUNS if full else RUNS
    attempts = 20_000 if quick else 150_000
    found: dict[float, list[float]] = {ratio: [] for ratio in ratios}
    first: dict[float, Surface] = {}
    jobs = [(ratio, i) for ratio in ratios for i in range(runs)]
    for ratio, i in tqdm(jobs, "rsa", unit="square"):
        surface = Surface(ratio, random.Random(1000 * SEED + i))
        found[ratio].append(saturated(surface, attempts)[0])
        first.setdefault(ratio, surface)
    print(f"{runs} squares of {AREA:g} ellipses' area for each aspect ratio")
    errors = tell_densities(found, out / "rsa.csv", "coverage", "runs")
    densest = max(found, key=lambda ratio: mean(found[ratio]))
    print(f"circles, of {CIRCLES:g} known: {mean(found[1.0]):.4f}")
    print(f"densest aspect ratio tried, {DENSEST:g} known: {densest:g}")
    print(
        "bias: squares are finite and never quite full; the line through the last two"
    )
    print("decades of time assumes the law that holds at the very end")
    print(f"table: {out / 'rsa.csv'}")
    save(draw(found, errors, first[densest]), out / "rsa.png", dpi=110)


def draw(
    found: dict[float, list[float]], errors: dict[float, float], surface: Surface
) -> Figure:
    """Coverage over aspect ratio, and one square that is nearly full."""
    figure = Figure(figsize=(10.0, 4.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    left.errorbar(
        list(found),
        [mean(values) for values in found.values()],
        list(errors.values()),
        marker="o",
        capsize=3,
        label="extrapolated, with standard error",
    )
    left.axhline(CIRCLES, color="gray", linestyle=":", label=f"circles, {CIRCLES:g}")
    left.axvline(
        DENSEST, color="gray", linestyle="--", label="known place of the maximum"
    )
    left.set_xlabel("aspect ratio")
    left.set_ylabel("saturated coverage")
    left.legend()
    left.spines[["top", "right"]].set_visible(False)
    x, y, c, s = np.array(surface.placed).T
    right.add_collection(
        EllipseCollection(
            np.full(len(x), 2.0 * surface.a),
            np.full(len(x), 2.0),
            np.degrees(np.arctan2(s, c)),
            units="xy",
            offsets=np.column_stack((x, y)),
            offset_transform=right.transData,
            facecolors="C0",
        )
    )
    right.set_xlim(0.0, surface.side)
    right.set_ylim(0.0, surface.side)
    right.set_aspect("equal")
    right.set_xticks([])
    right.set_yticks([])
    right.set_title(
        f"aspect ratio {surface.a:g}, periodic: {surface.coverage:.3f} covered so far"
    )
    return figure
