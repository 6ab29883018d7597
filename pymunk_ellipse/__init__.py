"""Exact ellipses for pymunk."""

from .contacts.backend import backend
from .ellipse import Ellipse, ShapeDistance
from .mass import area_for_ellipse, moment_for_ellipse
from .published_fit import circle_fit
from .space import Space

__all__ = [
    "Ellipse",
    "ShapeDistance",
    "Space",
    "area_for_ellipse",
    "backend",
    "circle_fit",
    "moment_for_ellipse",
]
