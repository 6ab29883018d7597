"""One-way platforms: eggs jump up through them and land on top."""

from __future__ import annotations

import random
from functools import partial
from typing import Any

import pymunk
from pymunk import Arbiter

from pymunk_ellipse import Ellipse

from ._scene import Scene, show

EGG, PLATFORM = 1, 2


class OneWay(Scene):
    view = -150.0, -10.0, 150.0, 330.0
    seconds = 8.0
    picture_at = 5.0

    def __init__(self) -> None:
        super().__init__()
        self.rng = random.Random(4)
        self.passed_from_below = self.landings = self.fell_through = 0
        self.add_walls((-140, 330), (-140, 0), (140, 0), (140, 330))
        self.platforms = [
            self.add_platform(x, y, a)
            for x, y, a in ((-70, 75, 45), (60, 95, 55), (-40, 165, 60), (75, 215, 40))
        ]
        self.eggs = [self.lay_egg(-120 + 22 * i) for i in range(12)]
        self.space.on_collision(
            EGG, PLATFORM, begin=self.on_meet, post_solve=self.on_rest
        )

    def add_platform(self, x: float, y: float, a: float) -> Ellipse:
        # A shape that neither turns nor falls: on the static body.
        platform = Ellipse(self.space.static_body, a, 9, offset=(x, y))
        platform.friction = 0.8
        platform.collision_type = PLATFORM
        platform.color = "#66a182"
        self.space.add(platform)
        return platform

    def lay_egg(self, x: float) -> Ellipse:
        body = pymunk.Body()
        body.position = x, 15
        egg = Ellipse(body, 10, 7.5)
        egg.density = 0.01
        egg.friction = 0.8
        egg.collision_type = EGG
        self.space.add(body, egg)
        return egg

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

    def on_rest(self, arbiter: Arbiter, space: pymunk.Space, data: Any) -> None:
        """An egg that was let in from above must stay above."""
        if arbiter.process_collision and arbiter.normal.y > 0.5:
            self.fell_through += 1

    def before_step(self) -> None:
        if self.steps % 30 == 29:
            egg = self.rng.choice(self.eggs)
            # Only one that stands on something can jump.
            if egg.body.velocity.length < 30:
                egg.body.velocity = self.rng.uniform(-60, 60), 330

    def numbers(self) -> dict[str, float]:
        return {
            "passes from below": self.passed_from_below,
            "landings from above": self.landings,
            "steps in which one that had landed was below": self.fell_through,
            "eggs above the ground in the end": sum(
                egg.body.position.y > 30 for egg in self.eggs
            ),
        }


run = partial(show, OneWay)
