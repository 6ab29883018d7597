"""A picture of a part of the world, drawn with pygame, for windows and for files alike."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from typing import NamedTuple

import pygame
from pymunk import Transform, Vec2d

from .plane import Point, View

# Drawn this many times as large and then reduced, so that edges are smooth.
SMOOTHING = 2
BACKGROUND = "#f7f5f0"
OUTLINE = "#30343b"
# Parts of the picture's longer side.
LINE = 1 / 450
DOT = 1 / 140
TEXT = 1 / 26
# More vertices than this are a curve, whose outline needs no corners.
CORNERS = 12


@cache
def font(height: int) -> pygame.font.Font:
    """pygame's own font, so many pixels high."""
    pygame.font.init()
    return pygame.font.Font(None, height)


class Text(NamedTuple):
    """A line of text, the point of the picture where it goes, and which of its own points goes there."""

    line: str
    place: Vec2d
    anchor: str
    color: str
    height: int


class Canvas:
    """A picture that shows a part of the world, as large as that fits into the size.

    Points, lengths and radii are those of the world; the width of lines and the size of dots
    and letters go with the picture.
    """

    def __init__(self, view: View, size: tuple[int, int]) -> None:
        left, bottom, right, top = view
        width, height = (SMOOTHING * length for length in size)
        self.scale = min(width / (right - left), height / (top - bottom))
        # From the world, whose y points up, to pixels, whose y points down.
        self.transform = Transform(
            a=self.scale,
            d=-self.scale,
            tx=(width - self.scale * (left + right)) / 2.0,
            ty=(height + self.scale * (bottom + top)) / 2.0,
        )
        self._longer = self.scale * max(right - left, top - bottom)
        self._line = max(1, round(LINE * self._longer))
        self._image = pygame.Surface((width, height))
        self._image.fill(BACKGROUND)
        self._texts: list[Text] = []

    def at(self, point: Point) -> Vec2d:
        """Where a point of the world is on the picture, before it is reduced."""
        return self.transform @ Vec2d(*point)

    def world(self, pixel: Point) -> Vec2d:
        """The point of the world that a pixel of the finished picture shows."""
        x, y = pixel
        t = self.transform
        return Vec2d((SMOOTHING * x - t.tx) / t.a, (SMOOTHING * y - t.ty) / t.d)

    def clip(self, view: View | None) -> None:
        """Draw inside of this part of the world only, from now on; None for everywhere."""
        if view is None:
            self._image.set_clip(None)
            return
        left, bottom, right, top = view
        x, y = self.at((left, top))
        size = self.scale * (right - left), self.scale * (top - bottom)
        self._image.set_clip(pygame.Rect(x, y, *size))

    def polygon(self, points: Iterable[Point], fill: str) -> None:
        """Fill a polygon."""
        pygame.draw.polygon(self._image, fill, [self.at(point) for point in points])

    def line(self, points: Iterable[Point], color: str = OUTLINE) -> None:
        """Draw a thin line from point to point."""
        pixels = [self.at(point) for point in points]
        pygame.draw.lines(self._image, color, False, pixels, self._line)
        if len(pixels) <= CORNERS:
            for pixel in pixels:
                pygame.draw.circle(self._image, color, pixel, self._line / 2)

    def thick_line(self, start: Point, end: Point, width: float, color: str) -> None:
        """Draw a line with round ends."""
        pixels = max(self._line, round(self.scale * width))
        ends = self.at(start), self.at(end)
        pygame.draw.line(self._image, color, *ends, pixels)
        for pixel in ends:
            pygame.draw.circle(self._image, color, pixel, pixels / 2)

    def disk(self, center: Point, radius: float, fill: str) -> None:
        """Fill a circle."""
        pygame.draw.circle(self._image, fill, self.at(center), self.scale * radius)

    def ring(self, center: Point, radius: float, color: str = OUTLINE) -> None:
        """Draw a circle."""
        pixels = self.scale * radius
        pygame.draw.circle(self._image, color, self.at(center), pixels, self._line)

    def dot(self, point: Point, color: str = OUTLINE) -> None:
        """Mark a point."""
        radius = DOT * self._longer
        pygame.draw.circle(self._image, color, self.at(point), radius)

    def write(
        self,
        line: str,
        point: Point,
        anchor: str = "center",
        color: str = OUTLINE,
        size: float = 1.0,
    ) -> None:
        """Write a line of text at a point of the world; anchor is pygame's name of the text's own point that goes there."""
        height = round(size * TEXT * self._longer / SMOOTHING)
        place = self.at(point) / SMOOTHING
        self._texts.append(Text(line, place, anchor, color, height))

    def finish(self) -> pygame.Surface:
        """The picture of what has been drawn, with smooth edges; the canvas is empty again."""
        width, height = self._image.get_size()
        small = width // SMOOTHING, height // SMOOTHING
        picture = pygame.transform.smoothscale(self._image, small)
        for text in self._texts:
            drawn = font(text.height).render(text.line, True, text.color)
            picture.blit(drawn, drawn.get_rect(**{text.anchor: text.place}))
        self._texts.clear()
        self._image.fill(BACKGROUND)
        return picture
