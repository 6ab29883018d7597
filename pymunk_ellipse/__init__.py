"""Exact ellipses for pymunk."""

from .backend import backend
from .circle_fit import circle_fit
from .ellipse import Ellipse
from .mass import area_for_ellipse, moment_for_ellipse
from .space import Space

__all__ = [
    "Ellipse",
    "Space",
    "area_for_ellipse",
    "backend",
    "circle_fit",
    "moment_for_ellipse",
]
