"""Pick ellipses with the mouse and drag them: a query that is exact, and a joint to the mouse."""

from __future__ import annotations

from math import pi

import pymunk
from pymunk import Vec2d

from pymunk_ellipse import Ellipse
from pymunk_ellipse.examples.stage import Scene, main

EVERYTHING = pymunk.ShapeFilter()


class Drag(Scene):
    view = -160.0, -10.0, 160.0, 150.0
    seconds = 9.0
    picture_at = 5.4
    hint = "Drag the stones with the mouse, over the wall into the tray"

    def __init__(self) -> None:
        super().__init__()
        self.add_walls((-150, 150), (-150, 0), (150, 0), (150, 150))
        # The tray to put them in.
        self.add_walls((60, 60), (60, 0))
        self.stones = dict(self.add_stone(-130 + 34 * i, 14 + 2 * i) for i in range(5))
        # The mouse is a body that nothing moves but the user.
        self.mouse = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        self.joint: pymunk.PivotJoint | None = None
        self.picked = self.corners_picked = self.corners = 0

    def add_stone(self, x: float, a: float) -> tuple[pymunk.Body, Ellipse]:
        body = pymunk.Body()
        body.position = x, 12
        stone = Ellipse(body, a, 9)
        stone.density = 0.01
        stone.friction = 0.6
        self.space.add(body, stone)
        return body, stone

    def press(self, point: Vec2d) -> None:
        """Take the stone under the mouse, if the mouse is in its ellipse."""
        hit = self.space.point_query_nearest(point, 0, EVERYTHING)
        body = hit.shape.body if hit and hit.shape else None
        if body not in self.stones:
            return
        self.picked += 1
        self.mouse.position = point
        self.joint = pymunk.PivotJoint(
            self.mouse, body, (0, 0), body.world_to_local(point)
        )
        # Strong enough to lift a stone, too weak to push it through a wall.
        self.joint.max_force = 2e4
        self.joint.error_bias = 0.9**240
        self.space.add(self.joint)

    def drag(self, point: Vec2d) -> None:
        self.mouse.position = point

    def release(self) -> None:
        if self.joint is not None:
            self.space.remove(self.joint)
            self.joint = None

    def play(self) -> None:
        """A hand: it takes one stone after the other, lifts it over the wall and lets go."""
        if self.steps % 360 == 120 and self.steps // 360 < len(self.stones):
            body = list(self.stones)[-1 - self.steps // 360]
            self.try_corners(body)
            self.grip = body.position
            self.press(self.grip)
        elif self.joint is not None:
            way = (self.steps % 360 - 120) / 200
            if way > 1:
                self.release()
            else:
                target = Vec2d(105, 0)
                lift = Vec2d(0, 90 * min(1, 4 * way, 4 * (1 - way) + 0.4))
                self.drag(self.grip.interpolate_to(target, way) + lift)

    def try_corners(self, body: pymunk.Body) -> None:
        """Corners of a polygon around the ellipse are outside of it: a click there takes nothing."""
        stone = self.stones[body]
        for i in range(8):
            corner = Vec2d(1.05 * stone.a, 0).rotated(2 * pi * (i + 0.5) / 8)
            corner = Vec2d(corner.x, corner.y * stone.b / stone.a)
            point = body.local_to_world(corner)
            hit = self.space.point_query_nearest(point, 0, EVERYTHING)
            self.corners += 1
            self.corners_picked += hit is not None and hit.shape is stone

    def numbers(self) -> dict[str, float]:
        return {
            "stones picked": self.picked,
            "stones in the tray": sum(body.position.x > 60 for body in self.stones),
            "clicks just beside stones": self.corners,
            "of these, picked": self.corners_picked,
        }


if __name__ == "__main__":
    main(Drag)
