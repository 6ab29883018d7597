"""The true outlines of ellipses on any of pymunk's backends."""

from __future__ import annotations

from collections.abc import Sequence
from types import TracebackType
from typing import Any

from pymunk import Shape, SpaceDebugDrawOptions, Vec2d
from pymunk.space_debug_draw_options import SpaceDebugColor

from .ellipse import Ellipse
from .outline import outline_vertices


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
        ellipse = self._shape
        frame = ellipse._placed()
        center = options.transform @ Vec2d(*frame[4:])
        vertices = outline_vertices(frame, ellipse.a >= ellipse.b, options.transform)
        options.draw_polygon(vertices, 0.0, outline_color, fill_color)
        options.draw_segment(center, vertices[0], outline_color)
