"""Draws a space on a canvas: what pymunk's debug drawing needs of any backend, and the colours."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from weakref import WeakKeyDictionary

import pymunk
from pymunk import SpaceDebugDrawOptions, Vec2d
from pymunk.space_debug_draw_options import SpaceDebugColor

from .canvas import OUTLINE, Canvas
from .plane import View

PALETTE = "#2e9cca", "#d1495b", "#edae49", "#7a6ff0", "#66a182", "#8d6a9f"
STATIC = "#8a8f98"
SENSOR = "#e4e0d6"


class SpaceCanvas(Canvas):
    """A canvas that draws spaces: each body in a colour of its own, which it keeps when others are removed."""

    def __init__(self, view: View, size: tuple[int, int]) -> None:
        super().__init__(view, size)
        self._numbers: WeakKeyDictionary[pymunk.Body, int] = WeakKeyDictionary()

    def draw_space(self, space: pymunk.Space) -> None:
        """Draw all shapes, those added later over those before, and then the joints."""
        for body in space.bodies:
            self._numbers.setdefault(body, len(self._numbers))
        options = DrawOptions(self, space)
        for flags in options.DRAW_CONSTRAINTS, options.DRAW_SHAPES:
            options.flags = flags
            space.debug_draw(options)
        options.finish()

    def color_of(self, shape: pymunk.Shape) -> str:
        """The colour that a shape has as an attribute, or else that of its body."""
        own: str | None = getattr(shape, "color", None)
        if own is not None:
            return own
        if shape.sensor:
            return SENSOR
        body = shape.body
        if body is None or body.body_type == pymunk.Body.STATIC:
            return STATIC
        return PALETTE[self._numbers[body] % len(PALETTE)]


class DrawOptions(SpaceDebugDrawOptions):
    """Draws one space on a canvas.

    Chipmunk goes through the shapes in the order of their addresses: what draws them is kept
    until all are known.
    """

    def __init__(self, canvas: SpaceCanvas, space: pymunk.Space) -> None:
        super().__init__()
        self.shape_outline_color = color(OUTLINE)
        self.constraint_color = color(OUTLINE)
        self._canvas = canvas
        self._joints: list[Callable[[], None]] = []
        self._shapes: dict[pymunk.Shape, list[Callable[[], None]]] = {
            shape: [] for shape in space.shapes
        }
        self._layer = self._joints

    def finish(self) -> None:
        """Draw what was kept."""
        for layer in (*self._shapes.values(), self._joints):
            for draw in layer:
                draw()

    def color_for_shape(self, shape: pymunk.Shape) -> SpaceDebugColor:
        """The colour of a shape, which is drawn next."""
        self._layer = self._shapes[shape]
        return color(self._canvas.color_of(shape))

    def draw_circle(
        self,
        pos: Vec2d,
        angle: float,
        radius: float,
        outline_color: SpaceDebugColor,
        fill_color: SpaceDebugColor,
    ) -> None:
        outline = digits(outline_color)
        mark = pos, pos + Vec2d.from_polar(radius, angle)
        self._later(self._canvas.disk, pos, radius, digits(fill_color))
        self._later(self._canvas.ring, pos, radius, outline)
        self._later(self._canvas.line, mark, outline)

    def draw_segment(self, a: Vec2d, b: Vec2d, color: SpaceDebugColor) -> None:
        self._later(self._canvas.line, (a, b), digits(color))

    def draw_fat_segment(
        self,
        a: Vec2d,
        b: Vec2d,
        radius: float,
        outline_color: SpaceDebugColor,
        fill_color: SpaceDebugColor,
    ) -> None:
        self._later(self._canvas.thick_line, a, b, 2 * radius, digits(fill_color))

    def draw_polygon(
        self,
        verts: Sequence[Vec2d],
        radius: float,
        outline_color: SpaceDebugColor,
        fill_color: SpaceDebugColor,
    ) -> None:
        around = *verts, verts[0]
        self._later(self._canvas.polygon, verts, digits(fill_color))
        self._later(self._canvas.line, around, digits(outline_color))

    def draw_dot(self, size: float, pos: Vec2d, color: SpaceDebugColor) -> None:
        self._later(self._canvas.dot, pos, digits(color))

    def _later(self, draw: Callable[..., None], *arguments: object) -> None:
        self._layer.append(partial(draw, *arguments))


def color(digits: str) -> SpaceDebugColor:
    """A colour from its hexadecimal digits."""
    red, green, blue = bytes.fromhex(digits.removeprefix("#"))
    return SpaceDebugColor(red, green, blue, 255)


def digits(color: SpaceDebugColor) -> str:
    """The hexadecimal digits of a colour."""
    return "#" + bytes(color.as_int()[:3]).hex()
