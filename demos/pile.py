"""Ellipses fall into a box, pile up and come to rest."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import cast

from matplotlib.figure import Figure
from tqdm import trange

from pymunk_ellipse import Ellipse

from ._box import GRAVITY, STEP, filled_box, height_of_grid
from ._picture import draw_box, draw_ellipses, save

A = 14.0
B = 7.0
DURATION = 4.0
# How long before the end the load on the box is averaged.
WEIGHING = 0.5


def run(out: Path, quick: bool) -> None:
    """Let 500 ellipses fall, or 100 for a quick run, and measure whether they rest."""
    count, columns = (100, 12) if quick else (500, 30)
    box = filled_box(partial(Ellipse, a=A, b=B), A, count, columns)
    box.weigh()

    figure = Figure(figsize=(9.0, 5.4), layout="constrained")
    panels = figure.subplot_mosaic(
        [["rest"] * 3, ["start", "energy", "load"]], height_ratios=[1.7, 1.0]
    )
    top = height_of_grid(A, count, columns)
    ellipses = cast(list[Ellipse], box.shapes)
    draw_box(panels["start"], box.width, top)
    draw_ellipses(panels["start"], ellipses)
    panels["start"].set_title("start")

    energy = []
    load = []
    for _ in trange(round(DURATION / STEP), desc="pile", unit="step"):
        box.step()
        energy.append(box.energy_per_mass)
        load.append(box.load)

    steps_weighed = round(WEIGHING / STEP)
    weighed = sum(load[-steps_weighed:]) / steps_weighed
    print(f"{count} ellipses, a={A:g}, b={B:g}, g={GRAVITY:g}, dt=1/{1 / STEP:.0f}")
    print(f"kinetic energy per mass after {DURATION:g} s: {energy[-1]:.3g}")
    print(f"bodies outside the box: {box.outside}")
    print(f"contact forces on floor and walls, of the weight: {weighed:.5f}")

    highest = max(body.position.y for body in box.bodies)
    draw_box(panels["rest"], box.width, highest + 2.0 * A)
    draw_ellipses(panels["rest"], ellipses)
    panels["rest"].set_title(f"{count} ellipses after {DURATION:g} s")
    times = [STEP * (i + 1) for i in range(len(energy))]
    panels["energy"].semilogy(times, energy)
    panels["energy"].set_title("kinetic energy / mass")
    panels["load"].plot(times, load)
    panels["load"].set_ylim(0.0, 3.0)
    panels["load"].axhline(1.0, linestyle=":", color="black", linewidth=1.0)
    panels["load"].set_title("force on the box / weight")
    for name in ("energy", "load"):
        panels[name].set_xlim(0.0, DURATION)
        panels[name].set_xlabel("time (s)")
        panels[name].spines[["top", "right"]].set_visible(False)
    save(figure, out / "pile.png")
