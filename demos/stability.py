"""Scenes in which polygons, the published fit or a missing safeguard fail, each against a bound from physics."""

from __future__ import annotations

import csv
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import partial
from math import isfinite
from pathlib import Path
from textwrap import fill

from matplotlib.figure import Figure
from tqdm import tqdm

from pymunk_ellipse import backend

from ._builders import ELLIPSE, EXACT_IMPACTS, Kind, polygon
from ._picture import save
from ._stability import (
    ROLLING,
    SCENES,
    Scene,
    highest_stack,
    joined_segments,
    off_path,
    rock,
    tiles,
)
from ._variants import VARIANTS, shipped

SEGMENT_LENGTHS = 0.5, 1.0, 2.0, 5.0
# By how much the step of a scene is made larger.
LARGE_STEP = 4.0
WITH_IMPACTS = "exact impacts"
QUICK_WAYS = "ellipse", WITH_IMPACTS, "16-gon"
# Long runs in Python that a quick run leaves out.
LONG = ("rocking for minutes",)


@dataclass(frozen=True)
class Way:
    """How a scene is run: with which shapes and spaces, contacts and step."""

    kind: Kind
    contacts: Callable[[], AbstractContextManager[None]] = shipped
    times_step: float = 1.0

    def measure(self, scene: Scene) -> float:
        with self.contacts():
            return scene.run(self.kind, self.times_step * scene.step)


def ways() -> dict[str, Way]:
    result = {"ellipse": Way(ELLIPSE), WITH_IMPACTS: Way(EXACT_IMPACTS)}
    for name, contacts in VARIANTS.items():
        if contacts is not shipped:
            result[name] = Way(ELLIPSE, contacts)
    result[f"{LARGE_STEP:g} times the step"] = Way(ELLIPSE, times_step=LARGE_STEP)
    for count in (16, 64):
        result[f"{count}-gon"] = Way(polygon(count))
    return result


def run(out: Path, quick: bool) -> None:
    """Run every scene in every way; a quick run leaves out the long ones and most ways."""
    chosen = {
        name: way for name, way in ways().items() if not quick or name in QUICK_WAYS
    }
    scenes = {
        name: scene for name, scene in SCENES.items() if not quick or name not in LONG
    }
    cells = [(scene, way) for scene in scenes for way in chosen]
    measured = {
        (scene, way): chosen[way].measure(scenes[scene])
        for scene, way in tqdm(cells, "stability", unit="run")
    }

    print(f"{backend()} backend; highest stacks of ellipses that lie flat, by theory:")
    ratios = 1.5, 2.0, 3.0, 5.0, 10.0
    print(", ".join(f"{highest_stack(r, 1.0)} at aspect ratio {r:g}" for r in ratios))
    with open(out / "stability.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["scene", "measured", "bound", *chosen])
        for name, scene in scenes.items():
            row = [f"{measured[name, way]:.4g}" for way in chosen]
            table.writerow([name, scene.measure, scene.bound, *row])
    for name, scene in scenes.items():
        failing = [way for way in chosen if not measured[name, way] <= scene.bound]
        print(
            f"{name}: {scene.measure} {measured[name, 'ellipse']:.3g}, bound {scene.bound:g}; "
            f"fails: {', '.join(failing) or 'none'}"
        )
    kept = sum(measured[name, "ellipse"] <= scenes[name].bound for name in scenes)
    print(f"scenes in which the ellipse keeps the bound: {kept} of {len(scenes)}")

    print("floors of pieces: off the path on one segment / way, in 4 s")
    print("length / a  segments  without neighbours  tiles")
    with open(out / "floors.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["length / a", "segments", "without neighbours", "tiles"])
        for times in SEGMENT_LENGTHS:
            length = times * ROLLING[0]
            grounds = (
                partial(joined_segments, length=length),
                partial(joined_segments, length=length, neighbors=False),
                partial(tiles, length=length),
            )
            dt = SCENES["tiles"].step
            off = [off_path(ELLIPSE, dt, ground) for ground in grounds]
            table.writerow([times, *(f"{part:.5f}" for part in off)])
            print(f"{times:10g}  {off[0]:8.5f}  {off[1]:18.5f}  {off[2]:5.5f}")
    print(f"part of the swing lost in a minute: {rock(ELLIPSE, 1 / 240, 60.0):.5f}")
    print(f"tables: {out / 'stability.csv'}, {out / 'floors.csv'}")
    save(draw(scenes, list(chosen), measured), out / "stability.png", dpi=100)


def draw(
    scenes: dict[str, Scene],
    ways: list[str],
    measured: dict[tuple[str, str], float],
) -> Figure:
    """A row for each scene and a column for each way, green where the bound is kept."""
    figure = Figure(
        figsize=(4.6 + 1.15 * len(ways), 1.3 + 0.42 * len(scenes)), layout="constrained"
    )
    axes = figure.subplots()
    for row, (name, scene) in enumerate(scenes.items()):
        for column, way in enumerate(ways):
            value = measured[name, way]
            axes.fill(
                [column, column + 1, column + 1, column],
                [row, row, row + 1, row + 1],
                color="#cfe8cf" if value <= scene.bound else "#f0b4ac",
                edgecolor="white",
                linewidth=2.0,
            )
            axes.annotate(
                f"{value:.2g}" if isfinite(value) else "lost",
                (column + 0.5, row + 0.5),
                ha="center",
                va="center",
                fontsize="small",
            )
    axes.set_xticks(
        [column + 0.5 for column in range(len(ways))],
        [fill(way, 10) for way in ways],
        fontsize="small",
    )
    axes.xaxis.tick_top()
    axes.set_yticks(
        [row + 0.5 for row in range(len(scenes))],
        [
            f"{name}\n{scene.measure} ≤ {scene.bound:g}"
            for name, scene in scenes.items()
        ],
        fontsize="small",
    )
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)
    axes.set_xlim(0, len(ways))
    axes.set_ylim(len(scenes), 0)
    axes.set_title("green: within the bound; red: beyond it; lost: not measurable")
    return figure
