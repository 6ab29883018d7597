"""Draws a space into a Pillow image: the ten lines that pymunk's debug drawing needs for any backend, and colours."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil
from typing import Any

import pymunk
from PIL import Image, ImageDraw
from pymunk import SpaceDebugDrawOptions, Transform, Vec2d
from pymunk.space_debug_draw_options import SpaceDebugColor

# Drawn this many times as large and then reduced, so that edges are smooth.
OVERSAMPLING = 3
BACKGROUND = "#f7f5f0"
PALETTE = "#2e9cca", "#d1495b", "#edae49", "#7a6ff0", "#66a182", "#8d6a9f"
STATIC = "#8a8f98"
OUTLINE = "#30343b"
SENSOR = "#e4e0d6"


def color(text: str) -> SpaceDebugColor:
    """A colour from its hexadecimal digits."""
    red, green, blue = bytes.fromhex(text.removeprefix("#"))
    return SpaceDebugColor(red, green, blue, 255)


class Colors(SpaceDebugDrawOptions):
    """Colours for any backend: a shape's own, or else one for each body in turn."""

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self._numbers: dict[int, int] = {}

    def color_for_shape(self, shape: pymunk.Shape) -> SpaceDebugColor:
        own = getattr(shape, "color", None)
        if own is not None:
            return color(own)
        if shape.sensor:
            return color(SENSOR)
        body = shape.body
        if body is None or body.body_type == pymunk.Body.STATIC:
            return color(STATIC)
        number = self._numbers.setdefault(body.id, len(self._numbers))
        return color(PALETTE[number % len(PALETTE)])


def camera(view: tuple[float, float, float, float], scale: float) -> Transform:
    """From the world, whose y points up, to pixels, whose y points down."""
    left, _bottom, _right, top = view
    return Transform(a=scale, d=-scale, tx=-scale * left, ty=scale * top)


class Canvas(Colors):
    """An image of a part of the world."""

    def __init__(self, view: tuple[float, float, float, float], size: int) -> None:
        super().__init__()
        left, bottom, right, top = view
        scale = OVERSAMPLING * size / max(right - left, top - bottom)
        # Whole pixels remain after the reduction.
        self._size = tuple(
            OVERSAMPLING * ceil(scale * length / OVERSAMPLING)
            for length in (right - left, top - bottom)
        )
        self._line = max(1, round(scale * 0.8))
        self._scale = scale
        self.transform = camera(view, scale)
        self.flags = self.DRAW_SHAPES | self.DRAW_CONSTRAINTS
        self.shape_outline_color = color(OUTLINE)
        self.constraint_color = color(OUTLINE)

    def draw(self, space: pymunk.Space) -> Image.Image:
        """The space as it is now."""
        image = Image.new("RGB", self._size, BACKGROUND)
        self._draw = ImageDraw.Draw(image)
        space.debug_draw(self)
        return image.reduce(OVERSAMPLING)

    def draw_circle(
        self,
        pos: Vec2d,
        angle: float,
        radius: float,
        outline_color: SpaceDebugColor,
        fill_color: SpaceDebugColor,
    ) -> None:
        self._draw.circle(
            pos, radius, fill_color.as_int(), outline_color.as_int(), self._line
        )
        # The angle is that of the world, where y points up.
        self.draw_segment(pos, pos + Vec2d(radius, 0).rotated(-angle), outline_color)

    def draw_segment(self, a: Vec2d, b: Vec2d, color: SpaceDebugColor) -> None:
        self._draw.line((a, b), color.as_int(), self._line)

    def draw_fat_segment(
        self,
        a: Vec2d,
        b: Vec2d,
        radius: float,
        outline_color: SpaceDebugColor,
        fill_color: SpaceDebugColor,
    ) -> None:
        self._draw.line((a, b), fill_color.as_int(), round(2 * radius) + 1)
        for end in (a, b):
            self._draw.circle(end, radius, fill_color.as_int())

    def draw_polygon(
        self,
        verts: Sequence[Vec2d],
        radius: float,
        outline_color: SpaceDebugColor,
        fill_color: SpaceDebugColor,
    ) -> None:
        self._draw.polygon(
            list(verts), fill_color.as_int(), outline_color.as_int(), self._line
        )

    def draw_dot(self, size: float, pos: Vec2d, color: SpaceDebugColor) -> None:
        self._draw.circle(pos, size * self._scale / 2.0, color.as_int())
