"""How many vertices an ellipse's hull should have: the time per step of piles, by vertices and aspect ratio."""

from __future__ import annotations

from functools import partial
from math import hypot, sqrt
from pathlib import Path

import numpy as np
import pymunk
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse as EllipsePatch
from matplotlib.patches import Polygon

from pymunk_ellipse import Ellipse, backend
from pymunk_ellipse.hull import DEFAULT_VERTICES, hull

from ._box import STEP
from ._picture import OUTLINE, save
from ._race import Course, Runner, Times, race

VERTICES = 6, 8, 10, 12, 16, 24
ASPECT_RATIOS = 1.0, 2.0, 4.0
# The same area for all: a b.
MEAN_RADIUS = 10.0
SETTLING = 2.0

FULL = Course(500, 24, round(SETTLING / STEP), rounds=40, steps_per_round=6)
QUICK = Course(60, 8, round(SETTLING / STEP), rounds=5, steps_per_round=4)


def ellipse_with_hull(body: pymunk.Body, a: float, b: float, vertices: int) -> Ellipse:
    """An ellipse whose hull has another number of vertices."""
    ellipse = Ellipse(body, a, b)
    corners, radius = hull(a, b, 0.0, 0.0, 0.0, vertices)
    pymunk.Poly.unsafe_set_vertices(ellipse, corners)
    pymunk.Poly.unsafe_set_radius(ellipse, radius)
    return ellipse


def semi_axes(aspect_ratio: float) -> tuple[float, float]:
    return MEAN_RADIUS * sqrt(aspect_ratio), MEAN_RADIUS / sqrt(aspect_ratio)


def run(out: Path, quick: bool) -> None:
    """Time the piles of each aspect ratio in turn; a quick run has smaller and fewer."""
    course = QUICK if quick else FULL
    default = str(DEFAULT_VERTICES)
    print(f"{course.bodies} ellipses, {backend()} backend")
    raced: dict[float, Times] = {}
    for aspect_ratio in ASPECT_RATIOS[1:2] if quick else ASPECT_RATIOS:
        a, b = semi_axes(aspect_ratio)
        runners = {
            str(n): Runner(
                partial(ellipse_with_hull, a=a, b=b, vertices=n), a, backend()
            )
            for n in VERTICES
        }
        raced[aspect_ratio] = times = race(runners, course)
        print(f"aspect ratio {aspect_ratio:g}")
        for name in times.seconds:
            print(
                f"{name:>4} vertices: {times.milliseconds(name):.3f} ms per step, "
                f"{times.ratio(name, default):.3f} of {default} vertices"
            )
    save(draw(raced), out / "hulls.png")


def draw(raced: dict[float, Times]) -> Figure:
    """The times by number of vertices, and some of the hulls."""
    figure = Figure(figsize=(9.0, 4.0), layout="constrained")
    times_axes, hulls_axes = figure.subplots(1, 2)
    default = str(DEFAULT_VERTICES)
    for aspect_ratio, times in raced.items():
        times_axes.plot(
            VERTICES,
            [times.ratio(str(n), default) for n in VERTICES],
            marker="o",
            label=f"aspect ratio {aspect_ratio:g}",
        )
    times_axes.set_xlabel("vertices of the hull")
    times_axes.set_xticks(VERTICES)
    times_axes.set_title(f"time per step / that with {default} vertices")
    times_axes.set_ylim(bottom=0.0)
    times_axes.spines[["top", "right"]].set_visible(False)
    times_axes.legend()

    a, b = semi_axes(2.0)
    shown = *VERTICES[:2], VERTICES[-1]
    for row, vertices in enumerate(shown):
        y = -2.6 * b * row
        corners, radius = hull(a, b, 0.0, 0.0, y, vertices)
        hulls_axes.add_patch(Polygon(rounded(corners, radius), color="C0", alpha=0.3))
        hulls_axes.add_patch(
            EllipsePatch((0.0, y), 2.0 * a, 2.0 * b, fill=False, edgecolor=OUTLINE)
        )
        hulls_axes.annotate(f"{vertices} vertices", (0.0, y), ha="center", va="center")
    hulls_axes.set_title("hulls")
    hulls_axes.axis("off")
    hulls_axes.autoscale_view()
    hulls_axes.set_aspect("equal")
    return figure


def rounded(
    corners: list[tuple[float, float]], radius: float
) -> list[tuple[float, float]]:
    """The outline of a convex polygon, counterclockwise, with a radius."""
    outline = []
    for i, (x, y) in enumerate(corners):
        before = corners[i - 1]
        after = corners[(i + 1) % len(corners)]
        first = _outward(before, (x, y))
        last = _outward((x, y), after)
        turn = (last - first) % (2.0 * np.pi)
        for angle in first + turn * np.linspace(0.0, 1.0, 16):
            outline.append((x + radius * np.cos(angle), y + radius * np.sin(angle)))
    return outline


def _outward(start: tuple[float, float], end: tuple[float, float]) -> float:
    """Angle of the outward normal of an edge."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    assert hypot(dx, dy) > 0.0
    return float(np.arctan2(-dx, dy))
