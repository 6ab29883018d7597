"""A pinball table: elliptic bumpers that kick, flippers, a belt that returns the ball, lanes that count."""

from __future__ import annotations

from functools import partial
from typing import Any

import pymunk
from pymunk import Arbiter, Vec2d

from pymunk_ellipse import Ellipse

from ._scene import Scene, show

BALL, BUMPER, LANE, LAUNCHER = 1, 2, 3, 4
KICK = 350.0


class Pinball(Scene):
    view = -115.0, -35.0, 115.0, 320.0
    seconds = 12.0
    picture_at = 2.0

    def __init__(self) -> None:
        super().__init__()
        self.space.gravity = 0, -300
        self.hits = self.lanes = self.launches = 0
        self.worst_normal = 0.0
        self.flip = False
        self.add_walls(
            (-100, -20), (-100, 240), (-50, 310), (60, 310), (105, 255), elasticity=0.7
        )
        self.add_walls((105, 255), (105, -20))
        self.add_walls((85, 40), (85, 220))
        self.add_walls((-100, 95), (-48, 62), friction=0)
        self.add_walls((85, 95), (48, 62), friction=0)
        # A belt: a segment whose surface moves to the right.
        belt = pymunk.Segment(self.space.static_body, (-100, -20), (105, -20), 3)
        belt.friction = 1
        belt.surface_velocity = 300, 0
        self.space.add(belt)

        for x, y, a, b, angle in (
            (-52, 195, 20, 12, 0.5),
            (40, 205, 20, 12, -0.5),
            (-5, 225, 14, 10, 0.0),
            (-5, 150, 24, 11, 0.3),
        ):
            bumper = self.static_ellipse(x, y, a, b, angle, BUMPER)
            bumper.color = "#d1495b"
            bumper.elasticity = 1
        for x in (-40, 0, 40):
            # A sensor notices the ball and lets it pass.
            self.static_ellipse(x, 275, 12, 6, 0.0, LANE).sensor = True
        self.static_ellipse(101, -11, 2, 4, 0.0, LAUNCHER).sensor = True
        self.flippers = [self.add_flipper(-1), self.add_flipper(1)]

        body = pymunk.Body()
        body.position = 95, 0
        self.ball = pymunk.Circle(body, 6)
        self.ball.mass = 1
        self.ball.elasticity = 0.6
        self.ball.friction = 0.5
        self.ball.collision_type = BALL
        self.space.add(body, self.ball)

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
        body.position = 48 * side, 60
        flipper = Ellipse(body, 20, 5, offset=(-16 * side, 0))
        flipper.density = 0.05
        flipper.elasticity = 0.4
        flipper.friction = 0.5
        ground = self.space.static_body
        motor = pymunk.SimpleMotor(ground, body, 0)
        motor.max_force = 1e7
        self.space.add(
            body,
            flipper,
            pymunk.PivotJoint(ground, body, body.position),
            pymunk.RotaryLimitJoint(ground, body, *sorted((0.4 * side, -0.5 * side))),
            motor,
        )
        return motor

    def play(self) -> None:
        """Flip when the ball is near; in a window the mouse button does it."""
        x, y = self.ball.body.position
        self.flip = abs(x) < 36 and 50 < y < 80

    def press(self, point: Vec2d) -> None:
        self.flip = True

    def release(self) -> None:
        self.flip = False

    def before_step(self) -> None:
        for motor, side in zip(self.flippers, (-1, 1), strict=True):
            motor.rate = side * (26 if self.flip else -6)

    def on_bumper(self, arbiter: Arbiter, space: pymunk.Space, data: Any) -> None:
        self.hits += 1
        ball, bumper = arbiter.shapes
        # From the ball to the bumper; the ellipse's own normal, to every digit.
        normal = arbiter.normal
        point = arbiter.contact_point_set.points[0].point_b
        x, y = (point - bumper.offset).rotated(-bumper.angle)
        gradient = Vec2d(x / bumper.a**2, y / bumper.b**2).rotated(bumper.angle)
        error = abs(gradient.normalized().cross(normal))
        self.worst_normal = max(self.worst_normal, error)
        ball.body.velocity -= normal * KICK

    def on_lane(self, arbiter: Arbiter, space: pymunk.Space, data: Any) -> None:
        self.lanes += 1

    def on_launcher(self, arbiter: Arbiter, space: pymunk.Space, data: Any) -> None:
        self.launches += 1
        arbiter.bodies[0].velocity = 0, 620 + 15 * (self.launches % 3)

    def numbers(self) -> dict[str, float]:
        return {
            "balls launched": self.launches,
            "hits of bumpers": self.hits,
            "passes through lanes": self.lanes,
            "largest error of a hit's normal (rad)": self.worst_normal,
        }


run = partial(show, Pinball)
