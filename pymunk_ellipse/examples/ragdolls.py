"""Ragdolls of ellipses, held together by joints with limits, tumble down a flight of stairs."""

from __future__ import annotations

import pymunk

from pymunk_ellipse import Ellipse
from pymunk_ellipse.examples.stage import Scene, main

DENSITY = 0.01
# Semi-axes and centre of each limb, then the limb it hangs on, where, and how far it may turn.
LIMBS = {
    "chest": ((11, 16), (0, 0), None, (0, 0), (0, 0)),
    "head": ((8, 10), (0, 27), "chest", (0, 17), (-0.5, 0.5)),
    "left arm": ((4, 11), (-12, 2), "chest", (-12, 11), (-1.5, 2.5)),
    "right arm": ((4, 11), (12, 2), "chest", (12, 11), (-2.5, 1.5)),
    "left forearm": ((3.5, 10), (-12, -16), "left arm", (-12, -8), (-2.0, 0.1)),
    "right forearm": ((3.5, 10), (12, -16), "right arm", (12, -8), (-0.1, 2.0)),
    "left thigh": ((5.5, 13), (-6, -26), "chest", (-6, -15), (-1.2, 0.6)),
    "right thigh": ((5.5, 13), (6, -26), "chest", (6, -15), (-0.6, 1.2)),
    "left shin": ((4, 13), (-6, -48), "left thigh", (-6, -37), (-0.1, 2.0)),
    "right shin": ((4, 13), (6, -48), "right thigh", (6, -37), (-2.0, 0.1)),
}
COLORS = {"head": "#f2c9a1", "chest": "#2e9cca", "thigh": "#30506b", "shin": "#f2c9a1"}


class Ragdolls(Scene):
    view = -40.0, -10.0, 380.0, 330.0
    seconds = 4.5
    picture_at = 1.1

    def __init__(self) -> None:
        super().__init__()
        self.space.iterations = 30
        self.joints: list[pymunk.PivotJoint] = []
        self.worst_joint = 0.0
        steps = [(-40, 160)]
        for i in range(5):
            steps += [(30 + 45 * i, 160 - 32 * i), (30 + 45 * i, 128 - 32 * i)]
        self.add_walls((-40, 360), *steps, (460, 0), (460, 360), friction=0.6)
        for i, x in enumerate((5, 65, 125)):
            self.add_ragdoll(x, 270 - 20 * i, group=i + 1)

    def add_ragdoll(self, x: float, y: float, group: int) -> None:
        bodies: dict[str, pymunk.Body] = {}
        for name, ((a, b), (dx, dy), parent, joint, (low, high)) in LIMBS.items():
            bodies[name] = body = pymunk.Body()
            body.position = x + dx, y + dy
            body.velocity = 120, 0
            limb = Ellipse(body, a, b)
            limb.density = DENSITY
            limb.friction = 0.6
            limb.color = COLORS.get(name.split()[-1], "#66a182")
            # Limbs of one doll pass through each other, those of two do not.
            limb.filter = pymunk.ShapeFilter(group=group)
            self.space.add(body, limb)
            if parent is not None:
                other = bodies[parent]
                pivot = pymunk.PivotJoint(other, body, (x + joint[0], y + joint[1]))
                limit = pymunk.RotaryLimitJoint(other, body, low, high)
                self.space.add(pivot, limit)
                self.joints.append(pivot)

    def before_step(self) -> None:
        for joint in self.joints:
            one = joint.a.local_to_world(joint.anchor_a)
            other = joint.b.local_to_world(joint.anchor_b)
            self.worst_joint = max(self.worst_joint, one.get_distance(other))

    def numbers(self) -> dict[str, float]:
        bodies = self.space.bodies
        return {
            "limbs": len(bodies),
            "widest gap of a joint ever (a chest is 22 wide)": self.worst_joint,
            "limbs below the floor": sum(body.position.y < 0 for body in bodies),
            "kinetic energy per mass in the end": sum(
                b.kinetic_energy / 2 for b in bodies
            )
            / sum(body.mass for body in bodies),
        }


if __name__ == "__main__":
    main(Ragdolls)
