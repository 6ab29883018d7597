"""Exact ellipses for pymunk."""

from .arrays import EllipseContacts, NearestPoints, ellipse_contacts, nearest_points
from .contacts.backend import backend
from .ellipse import Ellipse, ShapeDistance
from .mass import area_for_ellipse, moment_for_ellipse
from .published_fit import circle_fit
from .space import Space

__version__ = "0.2.0"

__all__ = [
    "Ellipse",
    "EllipseContacts",
    "NearestPoints",
    "ShapeDistance",
    "Space",
    "area_for_ellipse",
    "backend",
    "circle_fit",
    "ellipse_contacts",
    "moment_for_ellipse",
    "nearest_points",
]
