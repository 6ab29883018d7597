"""One-way platforms: eggs jump up through them, pale while they pass, and land on top."""

from __future__ import annotations

import random
from typing import Any

import pymunk
from pymunk import Arbiter

from pymunk_ellipse import Ellipse
from pymunk_ellipse.examples.stage import Scene, main

EGG, PLATFORM = 1, 2
SOLID, PASSING = "#edae49", "#f6dfb4"
# So fast that an egg rises by 109: from one platform well over the next, 70 above.
JUMP = 330.0


class OneWay(Scene):
    view = -150.0, -10.0, 150.0, 290.0
    seconds = 8.0
    picture_at = 4.59

    def __init__(self) -> None:
        super().__init__()
        self.rng = random.Random(4)
        self.passed_from_below = self.landings = self.fell_through = 0
        self.add_walls((-140, 290), (-140, 0), (140, 0), (140, 290))
        for x, y in ((-74, 70), (50, 70), (-30, 140), (74, 140), (-74, 210), (30, 210)):
            self.add_platform(x, y)
        self.eggs = [self.lay_egg(-120 + 34 * i) for i in range(8)]
        self.space.on_collision(
            EGG,
            PLATFORM,
            begin=self.on_meet,
            post_solve=self.on_touch,
            separate=self.on_part,
        )

    def add_platform(self, x: float, y: float) -> None:
        # A shape that neither turns nor falls: on the static body.
        platform = Ellipse(self.space.static_body, 36, 5, offset=(x, y))
        platform.friction = 0.8
        platform.collision_type = PLATFORM
        platform.color = "#66a182"
        self.space.add(platform)

    def lay_egg(self, x: float) -> pymunk.Body:
        body = pymunk.Body()
        body.position = x, 15
        egg = Ellipse(body, 10, 7.5)
        egg.density = 0.01
        egg.friction = 0.8
        egg.collision_type = EGG
        egg.color = SOLID
        self.space.add(body, egg)
        return body

    def on_meet(self, arbiter: Arbiter, space: pymunk.Space, data: Any) -> None:
        """Let an egg pass that comes from below; what is set here lasts until the two part."""
        # The normal leads from the egg to the platform.
        above = arbiter.normal.y < 0
        falling = arbiter.bodies[0].velocity.y <= 0
        arbiter.process_collision = above and falling
        if arbiter.process_collision:
            self.landings += 1
        else:
            self.passed_from_below += 1
            arbiter.shapes[0].color = PASSING

    def on_touch(self, arbiter: Arbiter, space: pymunk.Space, data: Any) -> None:
        """An egg that was let in from above must stay above."""
        if arbiter.process_collision and arbiter.normal.y > 0.5:
            self.fell_through += 1

    def on_part(self, arbiter: Arbiter, space: pymunk.Space, data: Any) -> None:
        """What has passed is solid again."""
        arbiter.shapes[0].color = SOLID

    def before_step(self) -> None:
        if self.steps % 30 == 29:
            egg = self.rng.choice(self.eggs)
            # Only one that stands on something can jump.
            if egg.velocity.length < 30:
                egg.velocity = self.rng.uniform(-60, 60), JUMP

    def numbers(self) -> dict[str, float]:
        return {
            "passes from below": self.passed_from_below,
            "landings from above": self.landings,
            "steps in which one that had landed was below": self.fell_through,
            "eggs above the ground in the end": sum(
                egg.position.y > 30 for egg in self.eggs
            ),
        }


if __name__ == "__main__":
    main(OneWay)
