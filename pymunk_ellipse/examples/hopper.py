"""A hopper discharges, at the same rate whether full or half empty: grains are no liquid."""

from __future__ import annotations

import random
from math import pi

import pymunk

from pymunk_ellipse import Ellipse
from pymunk_ellipse.examples.stage import Scene, main

COUNT = 240
FILLED_AT = 1.5


class Hopper(Scene):
    view = -110.0, -70.0, 110.0, 370.0
    seconds = 8.5
    picture_at = 3.5

    def __init__(self) -> None:
        super().__init__()
        self.add_walls((-85, 370), (-85, 90), (-24, 0))
        self.add_walls((85, 370), (85, 90), (24, 0))
        self.gate = pymunk.Segment(self.space.static_body, (-26, 0), (26, 0), 2)
        self.space.add(self.gate)
        self.times_out: list[float] = []

        rng = random.Random(3)
        for i in range(COUNT):
            row, column = divmod(i, 8)
            body = pymunk.Body()
            body.position = -70 + 20 * column, 110 + 18 * row
            body.angle = rng.uniform(-pi, pi)
            grain = Ellipse(body, a=8, b=5)
            grain.density = 0.01
            grain.friction = 0.4
            self.space.add(body, grain)

    def before_step(self) -> None:
        if self.gate in self.space.shapes and self.time > FILLED_AT:
            self.space.remove(self.gate)
        # What has fallen out is taken away, body and shape.
        for body in list(self.space.bodies):
            if body.position.y < -80:
                self.times_out.append(self.time)
                self.space.remove(body, *body.shapes)

    def numbers(self) -> dict[str, float]:
        return {
            "grains": COUNT,
            "grains out": len(self.times_out),
            "grains per second, the first third": self.rate(0, COUNT // 3),
            "grains per second, the second third": self.rate(
                COUNT // 3, 2 * COUNT // 3
            ),
        }

    def rate(self, first: int, last: int) -> float:
        """Grains per second from one grain out to another."""
        if len(self.times_out) <= last:
            return float("nan")
        return (last - first) / (self.times_out[last] - self.times_out[first])


if __name__ == "__main__":
    main(Hopper)
