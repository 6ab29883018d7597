"""What exact_impacts is for: chains of bounces and an elastic gas with and without it, beside a circle and a polygon."""

from __future__ import annotations

import csv
from math import log
from pathlib import Path

from matplotlib.figure import Figure

from ._builders import CIRCLE, ELLIPSE, EXACT_IMPACTS, Kind, gas_energy, polygon
from ._picture import save
from ._scene_errors import bounces_error

RATES = 60, 120, 240, 480
# Part of the mean step by which steps vary at random, where they do.
VARIES = 0.2

COLORS = {
    "circle": "#30343b",
    "64-gon": "#2e9cca",
    "ellipse": "#edae49",
    "ellipse, exact impacts": "#d1495b",
    "ellipse, exact impacts, steps vary by 20%": "#7a6ff0",
}

# By the name in the chart: the kind, and by what part of itself a step varies.
BOUNCES: dict[str, tuple[Kind, float]] = {
    "circle": (CIRCLE, 0.0),
    "64-gon": (polygon(64), 0.0),
    "ellipse": (ELLIPSE, 0.0),
    "ellipse, exact impacts": (EXACT_IMPACTS, 0.0),
    "ellipse, exact impacts, steps vary by 20%": (EXACT_IMPACTS, VARIES),
}
GASES = {name: kind for name, (kind, varies) in BOUNCES.items() if not varies}


def run(out: Path, quick: bool) -> None:
    """Chart both; a quick run has fewer throws and a shorter gas."""
    rates = RATES[:2] if quick else RATES
    throws = 5 if quick else 60
    bounces = {
        name: [bounces_error(kind, 1.0 / rate, varies, throws) for rate in rates]
        for name, (kind, varies) in BOUNCES.items()
    }
    seconds = 2.0 if quick else 60.0
    gases = {
        name: [gas_energy(kind, 1.0 / rate, seconds) for rate in rates]
        for name, kind in GASES.items()
    }
    write(out / "impacts.csv", rates, bounces, gases)
    for name, errors in bounces.items():
        order = log(errors[0] / errors[-1], rates[-1] / rates[0])
        print(f"chain of bounces, {name}: {errors[0]:.3g} at 1/60 s, order {order:.2f}")
    for name, found in gases.items():
        text = ", ".join(f"{energy:.4f}" for energy in found)
        print(f"gas, {name}: energy {text}")
    save(draw(rates, bounces, gases), out / "impacts.png")


def write(
    path: Path,
    rates: tuple[int, ...],
    bounces: dict[str, list[float]],
    gases: dict[str, list[float]],
) -> None:
    """A row for each scene, method and step."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        rows.writerow(("scene", "method", "steps per second", "found"))
        for name, errors in bounces.items():
            for rate, error in zip(rates, errors, strict=True):
                rows.writerow(("chain of bounces", name, rate, f"{error:.4g}"))
        for name, found in gases.items():
            for rate, energy in zip(rates, found, strict=True):
                rows.writerow(("gas", name, rate, f"{energy:.6f}"))
    print(f"table: {path}")


def draw(
    rates: tuple[int, ...],
    bounces: dict[str, list[float]],
    gases: dict[str, list[float]],
) -> Figure:
    """Errors of the bounces, and what the gas has gained or lost, against the step."""
    figure = Figure(figsize=(10.0, 4.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    for name, errors in bounces.items():
        left.plot(rates, errors, "o-", label=name, color=COLORS[name])
    left.set_title("two to four bounces of an ellipse 40 by 20")
    left.set_ylabel("pose off by (in a)")
    for name, found in gases.items():
        changes = [max(abs(energy - 1.0), 1e-6) for energy in found]
        right.plot(rates, changes, "o-", label=name, color=COLORS[name])
    right.set_title("elastic gas of 20, a minute")
    right.set_ylabel("energy off by, as a part")
    for axes in (left, right):
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xticks(rates, [f"1/{rate}" for rate in rates])
        axes.set_xticks([], minor=True)
        axes.set_xlabel("step (s)")
        axes.grid(alpha=0.3)
        axes.spines[["top", "right"]].set_visible(False)
    handles, labels = left.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return figure
