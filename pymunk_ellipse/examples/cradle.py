"""Newton's cradle of ellipses: the first swings in, the last swings out."""

from __future__ import annotations

from math import sin

import pymunk
from pymunk import Vec2d

from pymunk_ellipse import Ellipse
from pymunk_ellipse.examples.stage import Scene, energy, main

A, B = 14.0, 22.0
STRING = 140.0
GRAVITY = 500.0
LIFT = 0.8
COUNT = 5
# The impulses travel from one to the next in one contact per step; in contact from the start
# they would be solved as one, and all would move.
GAP = 0.05


class Cradle(Scene):
    view = -180.0, -30.0, 180.0, 150.0
    seconds = 8.0
    picture_at = 0.02

    def __init__(self) -> None:
        super().__init__()
        self.space.gravity = 0, -GRAVITY
        self.add_walls((-80, STRING), (80, STRING))
        self.bobs = [self.hang(i) for i in range(COUNT)]
        self.places = [bob.position.x for bob in self.bobs]
        # Lift the first.
        first = self.bobs[0]
        first.position += Vec2d(0, STRING) - Vec2d(0, STRING).rotated(-LIFT)
        self.energy_at_start = energy(self.bobs, GRAVITY)
        self.speeds = [0.0] * COUNT
        self.last_swung = False
        self.middle_swing = 0.0

    def hang(self, i: int) -> pymunk.Body:
        """An ellipse on two strings: one would let it turn, and then it would not hit in the middle."""
        body = pymunk.Body()
        body.position = (i - (COUNT - 1) / 2) * (2 * A + GAP), 0
        bob = Ellipse(body, A, B)
        bob.mass = 1
        bob.elasticity = 1
        self.space.add(body, bob)
        for x in (-A / 2, A / 2):
            anchor = body.position.x + x, STRING
            string = pymunk.PinJoint(self.space.static_body, body, anchor, (x, 0))
            self.space.add(string)
        return body

    def before_step(self) -> None:
        offsets = [
            bob.position.x - x for bob, x in zip(self.bobs, self.places, strict=True)
        ]
        self.middle_swing = max(self.middle_swing, *map(abs, offsets[1:-1]))
        # Until the last comes back from its first swing.
        self.last_swung = self.last_swung or self.bobs[-1].velocity.x < -1
        if not self.last_swung:
            speeds = [bob.velocity.length for bob in self.bobs]
            self.speeds = list(map(max, self.speeds, speeds))

    def numbers(self) -> dict[str, float]:
        return {
            "speed of the first when it hits": self.speeds[0],
            "speed of the last after it": self.speeds[-1],
            "swing of those between them, of that of the first": self.middle_swing
            / (STRING * sin(LIFT)),
            "energy left after all hits": energy(self.bobs, GRAVITY)
            / self.energy_at_start,
        }


if __name__ == "__main__":
    main(Cradle)
