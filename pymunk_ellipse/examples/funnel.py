"""Eggs roll down a funnel and through its neck, the sizes and shapes of eggs all different."""

from __future__ import annotations

import random
from math import pi

import pymunk

from pymunk_ellipse import Ellipse
from pymunk_ellipse.examples.stage import Scene, energy, main

GRAVITY = 500.0


class Funnel(Scene):
    view = -160.0, -10.0, 160.0, 330.0
    seconds = 8.0
    picture_at = 2.6

    def __init__(self) -> None:
        super().__init__()
        self.space.gravity = 0, -GRAVITY
        # The funnel: two slopes that leave room for two eggs, and a basket below.
        self.add_walls((-150, 330), (-150, 230), (-22, 120))
        self.add_walls((150, 330), (150, 230), (22, 120))
        self.add_walls((-110, 110), (-110, 0), (110, 0), (110, 110))

        rng = random.Random(7)
        self.eggs = [self.lay_egg(rng, i) for i in range(60)]
        self.energy_at_start = self.energy()

    def lay_egg(self, rng: random.Random, i: int) -> pymunk.Body:
        """An egg above the funnel, no two of them alike."""
        row, column = divmod(i, 10)
        body = pymunk.Body()
        body.position = -120 + 26.5 * column, 245 + 22 * row
        body.angle = rng.uniform(-pi, pi)
        b = rng.uniform(6, 9)
        egg = Ellipse(body, a=b * rng.uniform(1.0, 1.4), b=b)
        # Mass and moment of inertia follow from the density: those of the exact ellipse.
        egg.density = 0.01
        egg.friction = 0.4
        egg.elasticity = 0.2
        self.space.add(body, egg)
        return body

    def energy(self) -> float:
        return energy(self.eggs, GRAVITY)

    def numbers(self) -> dict[str, float]:
        centers = [egg.position for egg in self.eggs]
        return {
            "eggs": len(self.eggs),
            "eggs in the basket": sum(abs(x) < 110 and 0 < y < 110 for x, y in centers),
            # What friction and collisions have turned into heat; it can only shrink.
            "mechanical energy left, of that at the start": self.energy()
            / self.energy_at_start,
        }


if __name__ == "__main__":
    main(Funnel)
