"""Draws what a space holds, with true ellipses, and saves figures as small PNG files."""

from __future__ import annotations

from collections.abc import Iterable
from io import BytesIO
from math import degrees, pi
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure
from PIL import Image

from pymunk_ellipse import Ellipse

OUTLINE = "#30343b"
# A colour for each direction of an axis, so the last is the first: upright, then by quarters of the half turn.
DIRECTIONS = LinearSegmentedColormap.from_list(
    "directions", ["#d1495b", "#7a6ff0", "#2e9cca", "#edae49", "#d1495b"]
)


def draw_ellipses(axes: Axes, ellipses: Iterable[Ellipse]) -> EllipseCollection:
    """Draw ellipses where their bodies are, coloured by the angle of a, a colour for each direction of that axis."""
    placed = []
    for ellipse in ellipses:
        body = ellipse.body
        assert body is not None
        center = body.local_to_world(ellipse.offset)
        placed.append((ellipse.a, ellipse.b, body.angle + ellipse.angle, *center))
    a, b, angles, x, y = np.array(placed).T
    drawn = EllipseCollection(
        2.0 * a,
        2.0 * b,
        np.degrees(angles),
        units="xy",
        offsets=np.column_stack((x, y)),
        offset_transform=axes.transData,
        array=np.degrees((angles + pi / 2.0) % pi - pi / 2.0),
        norm=Normalize(-degrees(pi / 2.0), degrees(pi / 2.0)),
        cmap=DIRECTIONS,
        edgecolors=OUTLINE,
        # Half of an outline lies outside of the ellipse: a thin one hides no gap.
        linewidths=0.25,
    )
    axes.add_collection(drawn)
    return drawn


def draw_box(axes: Axes, width: float, height: float) -> None:
    """Draw a floor and two walls, and show that much of the plane at true proportions."""
    axes.plot([0.0, 0.0, width, width], [height, 0.0, 0.0, height], color=OUTLINE)
    axes.set_aspect("equal")
    margin = 0.01 * width
    axes.set_xlim(-margin, width + margin)
    axes.set_ylim(-margin, height)
    axes.axis("off")


def save(figure: Figure, path: Path, **options: Any) -> None:
    """Save a figure as a PNG of at most 256 colours, and print where."""
    drawn = BytesIO()
    figure.savefig(drawn, **{"dpi": 150, "facecolor": "white", **options})
    with Image.open(drawn) as picture:
        small = picture.convert("RGB").quantize(256, dither=Image.Dither.NONE)
        small.save(path, optimize=True)
    print(f"picture: {path}")
