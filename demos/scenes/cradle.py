"""Newton's cradle of ellipses: the first swings in, the last swings out."""

from __future__ import annotations

from functools import partial
from math import sqrt

import pymunk
from pymunk import Vec2d

from pymunk_ellipse import Ellipse

from ._scene import Scene, energy, show

A, B = 14.0, 22.0
STRING = 140.0
GRAVITY = 500.0
LIFT = 0.8
COUNT = 5
# The impulses travel from one to the next in one contact per step; in contact from the start
# they would be solved as one, and all would move.
GAP = 0.05


class Cradle(Scene):
    view = -180.0, -40.0, 180.0, 160.0
    seconds = 6.0
    picture_at = 0.02

    def __init__(self) -> None:
        super().__init__()
        self.space.gravity = 0, -GRAVITY
        self.space.iterations = 30
        self.add_walls((-80, STRING), (80, STRING))
        self.bobs = [self.hang(i) for i in range(COUNT)]
        # Lift the first.
        first = self.bobs[0]
        pivot = Vec2d(first.position.x, STRING)
        first.position = pivot + Vec2d(0, -STRING).rotated(-LIFT)
        self.energy_at_start = energy(self.bobs, GRAVITY)
        self.fastest = [0.0] * COUNT

    def hang(self, i: int) -> pymunk.Body:
        """An ellipse on a string, which holds it at its centre and lets it spin."""
        body = pymunk.Body()
        body.position = (i - (COUNT - 1) / 2) * (2 * A + GAP), 0
        bob = Ellipse(body, A, B)
        bob.mass = 1
        bob.elasticity = 1
        anchor = body.position.x, STRING
        string = pymunk.PinJoint(self.space.static_body, body, anchor, (0, 0))
        self.space.add(body, bob, string)
        return body

    def before_step(self) -> None:
        # A swing to one side and back: long enough for the first hit, too short for the second.
        if self.time < 2.5 * sqrt(STRING / GRAVITY):
            speeds = [body.velocity.length for body in self.bobs]
            self.fastest = list(map(max, self.fastest, speeds))

    def numbers(self) -> dict[str, float]:
        first, *middle, last = self.fastest
        return {
            "speed of the first when it hits": first,
            "speed of the last after it": last,
            "speed of the fastest between them": max(middle),
            "energy left after all hits": energy(self.bobs, GRAVITY)
            / self.energy_at_start,
        }


run = partial(show, Cradle)
