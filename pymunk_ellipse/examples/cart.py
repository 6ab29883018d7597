"""A cart with elliptic wheels, driven by motors, hobbles along a road of segments that know their neighbours."""

from __future__ import annotations

from itertools import pairwise
from math import dist, pi, sin, sqrt

import pymunk
from pymunk import Vec2d

from pymunk_ellipse import Ellipse
from pymunk_ellipse.examples.stage import Scene, main

A, B = 18.0, 13.0
TURNS_PER_SECOND = 1.0
# Circumference of the wheel, by Ramanujan's formula: right to 1e-9 for this one.
CIRCUMFERENCE = pi * (3 * (A + B) - sqrt((3 * A + B) * (A + 3 * B)))


def road(x: float) -> float:
    return 6 * sin(x / 45) + 4 * sin(x / 17)


class Cart(Scene):
    view = -10.0, -25.0, 440.0, 105.0
    seconds = 4.5
    picture_at = 2.0

    def __init__(self) -> None:
        super().__init__()
        points = [(x, road(x)) for x in range(-60, 520, 10)]
        before = [points[0], *points]
        after = [*points[2:], points[-1], points[-1]]
        for i, (start, end) in enumerate(pairwise(points)):
            segment = pymunk.Segment(self.space.static_body, start, end, 1)
            segment.friction = 2
            # Without this a wheel would bump against the seams.
            segment.set_neighbors(before[i], after[i])
            self.space.add(segment)

        self.chassis = pymunk.Body()
        self.chassis.position = 40, 45
        box = pymunk.Poly.create_box(self.chassis, (80, 16))
        box.density = 0.01
        box.filter = pymunk.ShapeFilter(group=1)
        self.space.add(self.chassis, box)
        self.wheels = [self.add_wheel(-28, 0.0), self.add_wheel(28, pi / 2)]
        self.start = self.wheels[0].position
        self.angle = self.wheels[0].angle

    def add_wheel(self, x: float, angle: float) -> pymunk.Body:
        body = pymunk.Body()
        body.position = self.chassis.local_to_world((x, -16))
        body.angle = angle
        wheel = Ellipse(body, A, B)
        wheel.density = 0.01
        wheel.friction = 2
        # One group: the wheels pass through the chassis.
        wheel.filter = pymunk.ShapeFilter(group=1)
        axle = pymunk.PivotJoint(self.chassis, body, body.position)
        motor = pymunk.SimpleMotor(self.chassis, body, 2 * pi * TURNS_PER_SECOND)
        motor.max_force = 4e5
        self.space.add(body, wheel, axle, motor)
        return body

    def numbers(self) -> dict[str, float]:
        rear = self.wheels[0]
        turns = (self.angle - rear.angle) / (2 * pi)
        steps = range(round(self.start.x), round(rear.position.x) + 1)
        surface = sum(
            dist(*pair) for pair in pairwise(Vec2d(x, road(x)) for x in steps)
        )
        return {
            "turns of the rear wheel": turns,
            "length of road it covered": surface,
            "of its circumference times the turns": surface / (CIRCUMFERENCE * turns),
        }


if __name__ == "__main__":
    main(Cart)
