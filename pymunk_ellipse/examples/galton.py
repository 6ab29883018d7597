"""A Galton board: ellipses fall through rows of pegs and fill bins, most of them in the middle."""

from __future__ import annotations

import random
from math import pi, sqrt
from statistics import pstdev

import pymunk

from pymunk_ellipse import Ellipse
from pymunk_ellipse.examples.stage import Scene, main

ROWS = 9
PITCH = 28.0
COUNT = 90
PER_SECOND = 8


class GaltonBoard(Scene):
    view = -175.0, -5.0, 175.0, 365.0
    seconds = COUNT / PER_SECOND + 5.0

    def __init__(self) -> None:
        super().__init__()
        # A board that leans back, in the air that it stirs: slow enough that at each peg the
        # next step is a new one.
        self.space.gravity = 0, -300
        self.space.damping = 0.1
        self.rng = random.Random(2)
        self.fallen: list[pymunk.Body] = []
        ground = self.space.static_body
        for row in range(ROWS):
            # Every other row is shifted by half a pitch.
            for column in range(-6, 6 + row % 2):
                x = (column + 0.5 - 0.5 * (row % 2)) * PITCH
                peg = pymunk.Circle(ground, 4, (x, 140 + 20 * row))
                peg.friction = 0.3
                self.space.add(peg)
        self.add_walls((-168, 365), (-168, 0), (168, 0), (168, 365))
        # Between two bins a divider.
        for column in range(-5, 6):
            self.add_walls((column * PITCH, 0), (column * PITCH, 115))

    def before_step(self) -> None:
        """Let one ellipse after the other fall onto the middle of the board."""
        if len(self.fallen) < min(COUNT, self.time * PER_SECOND):
            body = pymunk.Body()
            body.position = self.rng.uniform(-1, 1), 350
            body.angle = self.rng.uniform(-pi, pi)
            ellipse = Ellipse(body, a=6, b=4)
            ellipse.density = 0.01
            ellipse.friction = 0.3
            self.space.add(body, ellipse)
            self.fallen.append(body)

    def numbers(self) -> dict[str, float]:
        places = [body.position.x for body in self.fallen]
        return {
            "ellipses": len(places),
            "mean place, in pitches of the pegs": sum(places) / len(places) / PITCH,
            "standard deviation, in pitches": pstdev(places) / PITCH,
            # Half a pitch to the left or to the right at each row, whatever the row before did.
            "standard deviation of independent steps": sqrt(ROWS) / 2.0,
        }


if __name__ == "__main__":
    main(GaltonBoard)
