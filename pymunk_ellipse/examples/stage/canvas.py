"""Draws a space with pygame, for windows and for pictures alike: what pymunk's debug drawing needs of any backend, and colours."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache, partial
from typing import NamedTuple
from weakref import WeakKeyDictionary

import pygame
import pymunk
from pymunk import SpaceDebugDrawOptions, Transform, Vec2d
from pymunk.space_debug_draw_options import SpaceDebugColor

# Drawn this many times as large and then reduced, so that edges are smooth.
SMOOTHING = 2
BACKGROUND = "#f7f5f0"
PALETTE = "#2e9cca", "#d1495b", "#edae49", "#7a6ff0", "#66a182", "#8d6a9f"
STATIC = "#8a8f98"
OUTLINE = "#30343b"
SENSOR = "#e4e0d6"
# Parts of the picture's longer side.
LINE = 1 / 450
DOT = 1 / 140
TEXT = 1 / 26
# More vertices than this are a curve, whose outline needs no corners.
CORNERS = 12

View = tuple[float, float, float, float]


def color(text: str) -> SpaceDebugColor:
    """A colour from its hexadecimal digits."""
    red, green, blue = bytes.fromhex(text.removeprefix("#"))
    return SpaceDebugColor(red, green, blue, 255)


def size_for(view: View, longer: int) -> tuple[int, int]:
    """The size of a picture that shows this part of the world, its longer side so many pixels long."""
    left, bottom, right, top = view
    scale = longer / max(right - left, top - bottom)
    return round(scale * (right - left)), round(scale * (top - bottom))


@cache
def font(height: int) -> pygame.font.Font:
    """pygame's own font, so many pixels high."""
    pygame.font.init()
    return pygame.font.Font(None, height)


class Text(NamedTuple):
    """A line of text, where it goes on the picture, and which point of it goes there, by pygame's name."""

    line: str
    place: Vec2d
    anchor: str
    color: str
    size: float


class Canvas(SpaceDebugDrawOptions):
    """A picture of a part of the world, as large as it fits into the size.

    A shape is drawn in the colour that it has as an attribute, or else in one for each body in
    turn. Methods take pixels of the picture before it is reduced, as pymunk calls them;
    at(point) gives those of a point of the world.
    """

    def __init__(self, view: View, size: tuple[int, int]) -> None:
        super().__init__()
        left, bottom, right, top = view
        width, height = (SMOOTHING * length for length in size)
        scale = min(width / (right - left), height / (top - bottom))
        # From the world, whose y points up, to pixels, whose y points down.
        self.transform = Transform(
            a=scale,
            d=-scale,
            tx=width / 2.0 - scale * (left + right) / 2.0,
            ty=height / 2.0 + scale * (bottom + top) / 2.0,
        )
        self.scale = scale
        self.shape_outline_color = self.constraint_color = color(OUTLINE)
        self._longer = scale * max(right - left, top - bottom)
        self._line = max(1, round(LINE * self._longer))
        self._image = pygame.Surface((width, height))
        self._image.fill(BACKGROUND)
        self._texts: list[Text] = []
        # Each body has a colour in turn, and keeps it when others are removed.
        self._numbers: WeakKeyDictionary[pymunk.Body, int] = WeakKeyDictionary()
        # What draws each shape, and where what is drawn next belongs. Chipmunk draws shapes in the
        # order of their addresses: they are kept, and drawn in the order of the space.
        self._layers: dict[pymunk.Shape, list[Callable[[], object]]] = {}
        self._layer: list[Callable[[], object]] | None = None

    def at(self, point: tuple[float, float]) -> Vec2d:
        """Where a point of the world is on the picture."""
        return self.transform @ Vec2d(*point)

    def world(self, pixel: tuple[float, float]) -> Vec2d:
        """The point of the world that a pixel of the finished picture shows."""
        x, y = pixel
        t = self.transform
        return Vec2d((SMOOTHING * x - t.tx) / t.a, (SMOOTHING * y - t.ty) / t.d)

    def draw_space(self, space: pymunk.Space) -> None:
        """Draw all shapes, those added later over those before, and then the joints."""
        for body in space.bodies:
            self._numbers.setdefault(body, len(self._numbers))
        self._layers = {shape: [] for shape in space.shapes}
        self.flags = self.DRAW_SHAPES
        space.debug_draw(self)
        for layer in self._layers.values():
            for draw in layer:
                draw()
        self._layer = None
        self.flags = self.DRAW_CONSTRAINTS
        space.debug_draw(self)

    def write(
        self,
        line: str,
        point: tuple[float, float],
        anchor: str = "center",
        color: str = OUTLINE,
        size: float = 1.0,
    ) -> None:
        """Write a line of text at a point of the world; anchor is pygame's name of the text's point that goes there."""
        self._texts.append(Text(line, self.at(point), anchor, color, size))

    def finish(self) -> pygame.Surface:
        """The picture of what has been drawn, with smooth edges; the canvas is empty again."""
        width, height = self._image.get_size()
        small = width // SMOOTHING, height // SMOOTHING
        picture = pygame.transform.smoothscale(self._image, small)
        for text in self._texts:
            letters = font(round(text.size * TEXT * self._longer / SMOOTHING))
            drawn = letters.render(text.line, True, text.color)
            place = drawn.get_rect(**{text.anchor: text.place / SMOOTHING})
            picture.blit(drawn, place)
        self._texts.clear()
        self._image.fill(BACKGROUND)
        return picture

    def _draw(self, how: Callable[..., object], *arguments: object) -> None:
        """Draw on the image, or keep it for later."""
        if self._layer is None:
            how(self._image, *arguments)
        else:
            self._layer.append(partial(how, self._image, *arguments))

    def color_for_shape(self, shape: pymunk.Shape) -> SpaceDebugColor:
        """The colour of the shape that is drawn next."""
        self._layer = self._layers[shape]
        own = getattr(shape, "color", None)
        if own is not None:
            return color(own)
        if shape.sensor:
            return color(SENSOR)
        body = shape.body
        if body is None or body.body_type == pymunk.Body.STATIC:
            return color(STATIC)
        return color(PALETTE[self._numbers[body] % len(PALETTE)])

    def draw_circle(
        self,
        pos: Vec2d,
        angle: float,
        radius: float,
        outline_color: SpaceDebugColor,
        fill_color: SpaceDebugColor,
    ) -> None:
        self._draw(pygame.draw.circle, fill_color.as_int(), pos, radius)
        self.draw_ring(pos, radius, outline_color)
        # The angle is that of the world, where y points up.
        self.draw_segment(pos, pos + Vec2d(radius, 0).rotated(-angle), outline_color)

    def draw_ring(self, pos: Vec2d, radius: float, color: SpaceDebugColor) -> None:
        """Draw a circle that is not filled."""
        self._draw(pygame.draw.circle, color.as_int(), pos, radius, self._line)

    def draw_segment(self, a: Vec2d, b: Vec2d, color: SpaceDebugColor) -> None:
        self._draw(pygame.draw.line, color.as_int(), a, b, self._line)

    def draw_fat_segment(
        self,
        a: Vec2d,
        b: Vec2d,
        radius: float,
        outline_color: SpaceDebugColor,
        fill_color: SpaceDebugColor,
    ) -> None:
        width = max(self._line, round(2 * radius))
        self._draw(pygame.draw.line, fill_color.as_int(), a, b, width)
        for end in (a, b):
            self._draw(pygame.draw.circle, fill_color.as_int(), end, width / 2)

    def draw_polygon(
        self,
        verts: Sequence[Vec2d],
        radius: float,
        outline_color: SpaceDebugColor,
        fill_color: SpaceDebugColor,
    ) -> None:
        self._draw(pygame.draw.polygon, fill_color.as_int(), verts)
        self.draw_lines([*verts, verts[0]], outline_color)

    def draw_lines(self, points: Sequence[Vec2d], color: SpaceDebugColor) -> None:
        """Draw a line from point to point."""
        self._draw(pygame.draw.lines, color.as_int(), False, points, self._line)
        if len(points) <= CORNERS:
            for point in points:
                self._draw(pygame.draw.circle, color.as_int(), point, self._line / 2)

    def draw_dot(self, size: float, pos: Vec2d, color: SpaceDebugColor) -> None:
        radius = DOT * self._longer
        self._draw(pygame.draw.circle, color.as_int(), pos, radius)
