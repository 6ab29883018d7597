"""What the scenes are played on: walls, a clock, the mouse, pictures and windows. A scene's file needs nothing else."""

import os

from .command import main
from .plane import Point
from .scene import STEP, Scene, center_of_gravity, energy

# Before pygame is imported: no greeting among the numbers.
os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")

__all__ = ["STEP", "Point", "Scene", "center_of_gravity", "energy", "main"]
