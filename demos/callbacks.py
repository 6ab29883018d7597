"""What callbacks on every pair of a pile cost: exact ones on ellipses against pymunk's own on 16-gons."""

from __future__ import annotations

import csv
from functools import partial
from pathlib import Path
from statistics import median
from time import process_time
from typing import Any

import pymunk
from matplotlib.figure import Figure
from tqdm import tqdm

from pymunk_ellipse import Ellipse, Space, backend

from ._box import STEP, Box, MakeShape, filled_box
from ._picture import save
from ._shapes import inscribed_polygon

A = 14.0
B = 7.0
SETTLING = 2.0
# Bodies, columns, rounds, and steps of each pile in a round.
FULL = 500, 16, 20, 20
QUICK = 60, 8, 6, 10


def count(arbiter: pymunk.Arbiter, space: pymunk.Space, calls: list[int]) -> None:
    """A callback that does next to nothing."""
    calls[0] += 1


def run(out: Path, quick: bool) -> None:
    """Step both piles in turn, without callbacks and with all four on every pair."""
    bodies, columns, rounds, steps = QUICK if quick else FULL
    polygon = partial(inscribed_polygon, a=A, b=B, count=16)
    ellipse = partial(Ellipse, a=A, b=B)
    piles = {
        "16-gons in pymunk.Space": (pymunk.Space, polygon, False),
        "ellipses in Space": (Space, ellipse, False),
        "16-gons in pymunk.Space, callbacks": (pymunk.Space, polygon, True),
        "ellipses in Space, callbacks": (Space, ellipse, True),
    }
    calls: dict[str, list[int]] = {name: [0] for name in piles}
    boxes = {
        name: settled(make, shape, bodies, columns, calls[name] if listens else None)
        for name, (make, shape, listens) in piles.items()
    }
    for called in calls.values():
        called[0] = 0
    seconds: dict[str, list[float]] = {name: [] for name in piles}
    for _ in tqdm(range(rounds), unit="round"):
        for name, box in boxes.items():
            start = process_time()
            for _ in range(steps):
                box.space.step(STEP)
            seconds[name].append((process_time() - start) / steps)

    print(f"{bodies} bodies, dt=1/{1 / STEP:.0f}, ellipses {backend()}")
    width = max(map(len, piles))
    print(f"{'pile':{width}}  ms/step  calls/step")
    with open(out / "callbacks.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["pile", "ms per step", "calls per step"])
        for name in piles:
            row = 1e3 * median(seconds[name]), calls[name][0] / (rounds * steps)
            table.writerow([name, f"{row[0]:.4f}", f"{row[1]:.1f}"])
            print(f"{name:{width}}  {row[0]:7.3f}  {row[1]:10.1f}")
    _, _, theirs, ours = piles
    ratio = median(a / b for a, b in zip(seconds[ours], seconds[theirs], strict=True))
    print(f"ellipses with callbacks, of 16-gons with callbacks: {ratio:.2f}")
    save(draw(seconds), out / "callbacks.png")


def settled(
    make_space: type[pymunk.Space],
    make_shape: MakeShape,
    bodies: int,
    columns: int,
    calls: list[int] | None,
) -> Box:
    """A pile that has formed, with callbacks that count into calls."""
    box = filled_box(make_shape, A, bodies, columns, space=make_space())
    if calls is not None:
        callbacks: dict[str, Any] = dict.fromkeys(
            ("begin", "pre_solve", "post_solve", "separate"), count
        )
        box.space.on_collision(0, 0, **callbacks, data=calls)
    for _ in range(round(SETTLING / STEP)):
        box.space.step(STEP)
    return box


def draw(seconds: dict[str, list[float]]) -> Figure:
    """A bar for each pile."""
    figure = Figure(figsize=(8.0, 2.6), layout="constrained")
    axes = figure.subplots()
    milliseconds = [1e3 * median(times) for times in seconds.values()]
    colors = ["C1" if name.startswith("ellipses") else "C0" for name in seconds]
    bars = axes.barh(list(seconds), milliseconds, color=colors)
    axes.bar_label(bars, fmt="%.2f ms", padding=4)
    axes.margins(x=0.15)
    axes.invert_yaxis()
    axes.set_xlabel("ms per step")
    axes.set_title("a pile without callbacks, and with all four on every pair")
    return figure
