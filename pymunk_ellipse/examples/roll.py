"""Given the same push on a level floor, an ellipse rolls on and on; a 16-gon stops in its first turn, a 64-gon after three."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import cos, pi, sin

import pymunk

from pymunk_ellipse import Ellipse
from pymunk_ellipse.examples.stage import Point, Scene, main

A, B = 20.0, 15.0
SPEED = 90.0
FLOORS = 140.0, 70.0, 0.0
START = -180.0


def polygon(body: pymunk.Body, count: int) -> pymunk.Poly:
    """What people use where they have no ellipse: a polygon with its vertices on one."""
    angles = [2 * pi * i / count for i in range(count)]
    return pymunk.Poly(body, [(A * cos(t), B * sin(t)) for t in angles])


class Roll(Scene):
    view = -230.0, -12.0, 400.0, 206.0
    seconds = 7.0
    picture_at = 4.0

    def __init__(self) -> None:
        super().__init__()
        self.bodies = {
            "16-gon": self.push(partial(polygon, count=16), FLOORS[0], "#d1495b"),
            "64-gon": self.push(partial(polygon, count=64), FLOORS[1], "#edae49"),
            "ellipse": self.push(partial(Ellipse, a=A, b=B), FLOORS[2], "#2e9cca"),
        }

    def push(
        self,
        make_shape: Callable[[pymunk.Body], pymunk.Shape],
        floor: float,
        color: str,
    ) -> pymunk.Body:
        """Let a shape roll to the right on a floor of its own."""
        # Beyond the picture on the right, where the ellipse rolls out of it.
        self.add_walls((-230, floor - 2), (1000, floor - 2), friction=10)
        body = pymunk.Body()
        body.position = START, floor + B
        body.velocity = SPEED, 0
        body.angular_velocity = -SPEED / B
        shape = make_shape(body)
        shape.density = 0.01
        # Enough that nothing slips.
        shape.friction = 10
        shape.color = color
        # A spot, so that one sees it turn: a sensor touches nothing.
        spot = Ellipse(body, 3, 3, offset=(0.7 * A, 0))
        spot.sensor = True
        spot.color = "#30343b"
        self.space.add(body, shape, spot)
        return body

    def captions(self) -> list[tuple[str, Point]]:
        return [
            (f"{name}: {-body.angle / (2 * pi):.1f} turns", (-222, floor + 48))
            for (name, body), floor in zip(self.bodies.items(), FLOORS, strict=True)
        ]

    def numbers(self) -> dict[str, float]:
        found = {}
        for name, body in self.bodies.items():
            found[f"turns of the {name}"] = -body.angle / (2 * pi)
            found[f"speed of the {name} in the end"] = body.velocity.length
        return found


if __name__ == "__main__":
    main(Roll)
