"""The README's opening animation: an ellipse rolls on where a 16-gon and a 64-gon stop, larger than the example roll leaves it."""

from __future__ import annotations

from pathlib import Path

from pymunk_ellipse.examples.roll import Roll
from pymunk_ellipse.examples.stage.pictures import leave_pictures


class Opening(Roll):
    """The example, as wide as a README is."""

    pixels = 800


def run(out: Path, quick: bool) -> None:
    """Film the example; a quick run has fewer frames."""
    leave_pictures(Opening, out, quick)
