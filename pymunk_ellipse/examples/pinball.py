"""A pinball table: elliptic bumpers that kick, flippers, a belt that returns the ball, lanes that count."""

from __future__ import annotations

from typing import Any

import pymunk
from pymunk import Arbiter, Vec2d

from pymunk_ellipse import Ellipse
from pymunk_ellipse.examples.stage import Point, Scene, main

BALL, BUMPER, LANE, LAUNCHER = 1, 2, 3, 4
KICK = 330.0
LEFT, RIGHT = -1, 1
# The guides end where the flippers turn: the two pass through each other.
GUIDES = pymunk.ShapeFilter(group=1)


class Pinball(Scene):
    view = -115.0, -35.0, 115.0, 320.0
    seconds = 15.0
    picture_at = 2.0
    hint = "Arrow keys: left and right flipper. Mouse button: both"

    def __init__(self) -> None:
        super().__init__()
        self.space.gravity = 0, -300
        self.hits = self.lanes = self.launches = 0
        self.worst_normal = 0.0
        self.up = {LEFT: False, RIGHT: False}
        self.add_walls(
            (-100, -20), (-100, 240), (-50, 310), (60, 310), (105, 255), elasticity=0.7
        )
        self.add_walls((105, 255), (105, -20))
        self.add_walls((85, 40), (85, 220))
        for start, end in (((-100, 100), (-50, 62)), ((85, 88), (50, 62))):
            guide = pymunk.Segment(self.space.static_body, start, end, 2)
            guide.filter = GUIDES
            self.space.add(guide)
        # A belt: a segment whose surface moves to the right.
        belt = pymunk.Segment(self.space.static_body, (-100, -20), (105, -20), 3)
        belt.friction = 1
        belt.surface_velocity = 300, 0
        self.space.add(belt)

        for x, y, a, b, angle in (
            (-80, 185, 20, 12, 0.6),
            (64, 190, 20, 12, -0.6),
            (-6, 222, 14, 10, 0.0),
            (-8, 150, 24, 11, 0.2),
        ):
            bumper = self.static_ellipse(x, y, a, b, angle, BUMPER)
            bumper.color = "#d1495b"
            bumper.elasticity = 1
        for x in (-40, 0, 40):
            # A sensor notices the ball and lets it pass.
            self.static_ellipse(x, 275, 12, 6, 0.0, LANE).sensor = True
        self.static_ellipse(101, -11, 2, 4, 0.0, LAUNCHER).sensor = True
        self.motors = {side: self.add_flipper(side) for side in (LEFT, RIGHT)}

        self.ball = pymunk.Body()
        self.ball.position = 95, 0
        shape = pymunk.Circle(self.ball, 6)
        shape.mass = 1
        shape.elasticity = 0.5
        shape.friction = 0.5
        shape.collision_type = BALL
        self.space.add(self.ball, shape)

        # On pymunk_ellipse.Space, begin is called when the ball meets the ellipse, not its hull.
        self.space.on_collision(BALL, BUMPER, begin=self.on_bumper)
        self.space.on_collision(BALL, LANE, begin=self.on_lane)
        self.space.on_collision(BALL, LAUNCHER, begin=self.on_launcher)

    def static_ellipse(
        self, x: float, y: float, a: float, b: float, angle: float, kind: int
    ) -> Ellipse:
        ellipse = Ellipse(self.space.static_body, a, b, (x, y), angle)
        ellipse.collision_type = kind
        self.space.add(ellipse)
        return ellipse

    def add_flipper(self, side: int) -> pymunk.SimpleMotor:
        """An ellipse on a pivot near its end, turned by a motor between two stops."""
        body = pymunk.Body()
        body.position = 50 * side, 60
        flipper = Ellipse(body, 21, 5, offset=(-17 * side, 0))
        flipper.density = 0.05
        flipper.elasticity = 0.2
        flipper.friction = 0.5
        flipper.filter = GUIDES
        ground = self.space.static_body
        motor = pymunk.SimpleMotor(ground, body, 0)
        motor.max_force = 1e7
        self.space.add(
            body,
            flipper,
            pymunk.PivotJoint(ground, body, body.position),
            pymunk.RotaryLimitJoint(ground, body, *sorted((0.5 * side, -0.5 * side))),
            motor,
        )
        return motor

    def play(self) -> None:
        """Flip each flipper when the ball is on its outer half."""
        x, y = self.ball.position
        for side in (LEFT, RIGHT):
            above = y - 60 + 0.5 * (50 - x * side)
            self.up[side] = 6 < x * side < 30 and 0 < above < 16

    def press(self, point: Vec2d) -> None:
        self.up = {LEFT: True, RIGHT: True}

    def release(self) -> None:
        self.up = {LEFT: False, RIGHT: False}

    def key(self, name: str, down: bool) -> None:
        sides = {"left": LEFT, "right": RIGHT}
        if name in sides:
            self.up[sides[name]] = down

    def before_step(self) -> None:
        for side, motor in self.motors.items():
            motor.rate = side * (22 if self.up[side] else -6)

    def on_bumper(self, arbiter: Arbiter, space: pymunk.Space, data: Any) -> None:
        self.hits += 1
        bumper = arbiter.shapes[1]
        # From the ball to the bumper; the ellipse's own normal, to every digit.
        normal = arbiter.normal
        point = arbiter.contact_point_set.points[0].point_b
        x, y = (point - bumper.offset).rotated(-bumper.angle)
        gradient = Vec2d(x / bumper.a**2, y / bumper.b**2).rotated(bumper.angle)
        error = abs(gradient.normalized().cross(normal))
        self.worst_normal = max(self.worst_normal, error)
        self.ball.velocity -= normal * KICK

    def on_lane(self, arbiter: Arbiter, space: pymunk.Space, data: Any) -> None:
        self.lanes += 1

    def on_launcher(self, arbiter: Arbiter, space: pymunk.Space, data: Any) -> None:
        self.launches += 1
        self.ball.velocity = 0, 620 + 15 * (self.launches % 3)

    def captions(self) -> list[tuple[str, Point]]:
        return [(f"{100 * self.hits + 50 * self.lanes} points", (-92, 10))]

    def numbers(self) -> dict[str, float]:
        return {
            "balls launched": self.launches,
            "hits of bumpers": self.hits,
            "passes through lanes": self.lanes,
            "largest error of a hit's normal (rad)": self.worst_normal,
        }


if __name__ == "__main__":
    main(Pinball)
