"""The true outlines of ellipses for drawing, on any of pymunk's backends or by hand."""

from __future__ import annotations

from collections.abc import Sequence
from math import asin, ceil, cos, pi, sin, sqrt
from types import TracebackType
from typing import Any

from pymunk import Shape, SpaceDebugDrawOptions, Transform, Vec2d
from pymunk.space_debug_draw_options import SpaceDebugColor

from .ellipse import Ellipse

# How far an ellipse may bulge over an edge of its outline: in the units of the screen, and as a
# part of the longer semi-axis, because matplotlib scales the picture afterwards.
LARGEST_BULGE = 0.1
LARGEST_RELATIVE_BULGE = 1e-3

# Enough for a semi-axis of 20000 pixels.
MOST_VERTICES = 1000


def outline(ellipse: Ellipse, transform: Transform) -> tuple[Vec2d, list[Vec2d]]:
    """The centre of an ellipse and the vertices of a polygon that looks like it.

    transform leads from the world to the screen, whose unit is the pixel. The vertices lie on
    the ellipse, counterclockwise before the transform, the first one at the end of the
    semi-axis a. The ellipse is nowhere farther from an edge than a tenth of a pixel or a
    thousandth of its longer semi-axis, whichever is less, as long as 1000 vertices suffice.

    >>> from pymunk import Transform
    >>> center, vertices = outline(Ellipse(None, 20, 10), Transform.scaling(2))
    >>> center, vertices[0], len(vertices)
    (Vec2d(0.0, 0.0), Vec2d(40.0, 0.0), 71)
    """
    longer, shorter, c, s, x, y = ellipse._placed()
    center = transform @ Vec2d(x, y)
    long_axis = transform @ Vec2d(x + longer * c, y + longer * s) - center
    short_axis = transform @ Vec2d(x - shorter * s, y + shorter * c) - center
    if ellipse.a >= ellipse.b:
        a, b = long_axis, short_axis
    else:
        a, b = -short_axis, long_axis
    count = vertices_for(max(a.length, b.length))
    step = 2.0 * pi / count
    vertices = []
    for i in range(count):
        cosine = cos(i * step)
        sine = sin(i * step)
        vertices.append(
            Vec2d(
                center.x + cosine * a.x + sine * b.x,
                center.y + cosine * a.y + sine * b.y,
            )
        )
    return center, vertices


def vertices_for(size: float) -> int:
    """How many vertices the outline of an ellipse needs whose longer semi-axis is size on the screen.

    In the middle, an edge that spans the angle 2 phi of a circle lies 1 - cos(phi) of the
    radius inside.
    """
    bulge = LARGEST_RELATIVE_BULGE
    if bulge * size > LARGEST_BULGE:
        bulge = LARGEST_BULGE / size
    phi = 2.0 * asin(sqrt(bulge / 2.0))
    return min(ceil(pi / phi), MOST_VERTICES)


class TrueOutlines:
    """Drawing options that draw ellipses with their true outlines, and everything else as the options they stand for.

    Chipmunk asks for the colour of a shape right before it draws it: the next polygon is then
    known to be that shape's.
    """

    def __init__(self, options: SpaceDebugDrawOptions) -> None:
        self._true_options = options
        self._shape: Shape | None = None

    def __getattr__(self, name: str) -> Any:
        return getattr(self._true_options, name)

    def __enter__(self) -> None:
        self._true_options.__enter__()

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._true_options.__exit__(kind, error, traceback)

    def color_for_shape(self, shape: Shape) -> SpaceDebugColor:
        """The options' colour for a shape, which is drawn next."""
        self._shape = shape
        return self._true_options.color_for_shape(shape)

    def draw_polygon(
        self,
        verts: Sequence[Vec2d],
        radius: float,
        outline_color: SpaceDebugColor,
        fill_color: SpaceDebugColor,
    ) -> None:
        """Draw a polygon, or the ellipse whose hull it is with a line from its centre to the end of a."""
        options = self._true_options
        if not isinstance(self._shape, Ellipse):
            options.draw_polygon(verts, radius, outline_color, fill_color)
            return
        center, vertices = outline(self._shape, options.transform)
        options.draw_polygon(vertices, 0.0, outline_color, fill_color)
        options.draw_segment(center, vertices[0], outline_color)
