"""A weighted rocker rocks on and on with the period of theory; its twin cut as a 24-gon hops and stops."""

from __future__ import annotations

from math import cos, hypot, pi, sin

import numpy as np
import pymunk

from pymunk_ellipse import Ellipse
from pymunk_ellipse.examples.stage import STEP, Point, Scene, main

A, B = 60.0, 30.0
GRAVITY = 500.0
TILT = 0.15


class Rocker(Scene):
    view = -150.0, -15.0, 150.0, 165.0
    seconds = 10.0
    picture_at = 9.1

    def __init__(self) -> None:
        super().__init__()
        self.space.gravity = 0, -GRAVITY
        # Enough friction that nothing slips.
        self.add_walls((-145, 0), (145, 0), friction=100)
        self.add_walls((-145, 80), (145, 80), friction=100)
        self.ellipse = self.add_rocker(Ellipse(pymunk.Body(), A, B), floor=82)
        angles = [2 * pi * i / 24 for i in range(24)]
        corners = [(A * cos(t), B * sin(t)) for t in angles]
        twin = pymunk.Poly(pymunk.Body(), corners)
        self.polygon = self.add_rocker(twin, floor=2)
        self.swings: dict[pymunk.Body, list[float]] = {
            self.ellipse: [],
            self.polygon: [],
        }

    def add_rocker(self, hull: pymunk.Shape, floor: float) -> pymunk.Body:
        """A body of two shapes: the hull that rolls, and a weight low in it."""
        body = hull.body
        assert body is not None
        weight = Ellipse(body, a=20, b=8, offset=(0, -18))
        hull.mass = weight.mass = 1
        hull.friction = 100
        weight.color = "#30343b"
        body.angle = TILT
        body.position = 0, floor + hypot(A * sin(TILT), B * cos(TILT))
        self.space.add(body, hull, weight)
        return body

    def before_step(self) -> None:
        for body, angles in self.swings.items():
            angles.append(body.angle)

    def captions(self) -> list[tuple[str, Point]]:
        return [
            (f"ellipse: {self.swing_left(self.ellipse):.0%} of its swing", (-145, 152)),
            (f"24-gon: {self.swing_left(self.polygon):.0%} of its swing", (-145, 70)),
        ]

    def swing_left(self, body: pymunk.Body) -> float:
        """How far to both sides a rocker has swung in the last period, as a part of the first swing."""
        period = round(self.period() / STEP)
        if self.steps < period:
            return 1.0
        last = self.swings[body][-period:]
        return (max(last) - min(last)) / (2 * TILT)

    def numbers(self) -> dict[str, float]:
        ellipse = self.swings[self.ellipse]
        crossings = [
            i for i in range(1, len(ellipse)) if ellipse[i - 1] > 0 >= ellipse[i]
        ]
        periods = len(crossings) - 1
        return {
            "period by theory (s)": self.period(),
            "period of the ellipse (s)": STEP
            * (crossings[-1] - crossings[0])
            / periods,
            "swing left of the ellipse": self.swing_left(self.ellipse),
            "swing left of the 24-gon": self.swing_left(self.polygon),
        }

    def period(self) -> float:
        """Period by the conservation of energy, rolling without slip, as the demo rocking has it."""
        low = self.ellipse.center_of_gravity.y
        s = (np.arange(64) + 0.5) * pi / 128
        t = np.append(TILT * np.sin(s), TILT)
        to_floor = np.hypot(A * np.sin(t), B * np.cos(t))
        height = to_floor + low * np.cos(t)
        slope = (A * A - B * B) * np.sin(t) * np.cos(t) / to_floor - low * np.sin(t)
        inertia = self.ellipse.moment / self.ellipse.mass + height**2 + slope**2
        spin = np.sqrt(2 * GRAVITY * (height[-1] - height[:-1]) / inertia[:-1])
        return float(4 * np.sum(TILT * np.cos(s) / spin) * pi / 128)


if __name__ == "__main__":
    main(Rocker)
