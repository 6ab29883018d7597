"""Tells how dense packings are for each aspect ratio: a table in a file, and lines on the screen."""

from __future__ import annotations

import csv
from pathlib import Path
from statistics import mean, stdev


def tell_densities(
    found: dict[float, list[float]], path: Path, quantity: str, runs: str
) -> dict[float, float]:
    """Write and print the mean of the runs for each aspect ratio; returns the standard errors of the means."""
    errors = {
        ratio: stdev(values) / len(values) ** 0.5 if len(values) > 1 else 0.0
        for ratio, values in found.items()
    }
    with open(path, "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["aspect ratio", quantity, "standard error", runs])
        for ratio, values in found.items():
            row = f"{mean(values):.4f}", f"{errors[ratio]:.4f}"
            table.writerow([ratio, *row, len(values)])
            print(f"  aspect ratio {ratio:<4g}: {row[0]} +- {row[1]}")
    return errors
