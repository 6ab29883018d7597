"""MuJoCo: its collision of two ellipsoids, and scenes in which they move in a plane."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, pi, sin

import mujoco
import numpy as np
import pymunk

from pymunk_ellipse import Ellipse

from ._methods import Pairs
from ._peers_pairs import (
    PairMethod,
    Placed,
    Prepared,
    between_centres,
    each,
    semi_axes,
)
from ._peers_scenes import Engine, World

NAME = "MuJoCo"
# Of its search in a pair. The first is the default; the last goes with a tolerance that is not.
ITERATIONS = 35, 100, 200
FINE = 1e-12

# Warnings would be written to a file in the working directory.
mujoco.set_mju_user_warning(lambda text: print(f"{NAME}: {text}"))


def pair_methods() -> list[PairMethod]:
    return [PairMethod(NAME, count, searching(count)) for count in ITERATIONS]


def searching(iterations: int) -> Callable[[Pairs], Prepared]:
    """In a compiled loop: mj_collision of all pairs at once. As called from Python: mj_geomDistance."""
    option = f'ccd_iterations="{iterations}"'
    if iterations == ITERATIONS[-1]:
        option += f' ccd_tolerance="{FINE}"'

    def prepare(pairs: Pairs) -> Prepared:
        model = mujoco.MjModel.from_xml_string(all_pairs(pairs, option))
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        mujoco.mj_collision(model, data)
        found = np.full((len(pairs), 4), np.nan)
        for contact in data.contact:
            found[contact.geom1 // 2] = -contact.dist, *contact.frame[:3]
        farthest = max(between_centres(*pair) for pair in each(pairs))
        from_to = np.zeros(6)

        def calls() -> None:
            for geom in range(0, model.ngeom, 2):
                mujoco.mj_geomDistance(model, data, geom, geom + 1, farthest, from_to)

        return Prepared(found, calls, lambda: mujoco.mj_collision(model, data))

    return prepare


def all_pairs(pairs: Pairs, option: str) -> str:
    """A model in which the two of each pair collide and nothing else does."""
    bodies, collide = [], []
    for i, pair in enumerate(each(pairs)):
        bodies += [free_body(at, f"{i} {k}") for k, at in enumerate(pair)]
        collide.append(f'<pair geom1="{i} 0" geom2="{i} 1"/>')
    return f"""
        <mujoco>
          <option {option}/>
          <size memory="100M"/>
          <default><geom type="ellipsoid" contype="0" conaffinity="0"/></default>
          <worldbody>{"".join(bodies)}</worldbody>
          <contact>{"".join(collide)}</contact>
        </mujoco>"""


def free_body(at: Placed, name: str) -> str:
    # Without a joint the bodies would be one with the world, and would not collide.
    half = at.angle / 2.0
    return f"""
        <body pos="{at.x} {at.y} 0" quat="{cos(half)} 0 0 {sin(half)}">
          <freejoint/><geom name="{name}" size="{size(at.a, at.b)}"/>
        </body>"""


def size(a: float, b: float) -> str:
    return " ".join(map(str, semi_axes(a, b)))


@dataclass(frozen=True)
class Settings:
    """What is set for all of a model, and whether its contacts are as stiff as the step allows."""

    option: str
    stiff: bool = False

    def contacts(self, elastic: bool, step: float) -> str:
        """Attributes of geoms."""
        if not self.stiff:
            return ""
        if elastic:
            # There is no coefficient of restitution; the nearest to one is an undamped spring, here one that lasts ten steps.
            return f'solref="{-((pi / (10.0 * step)) ** 2)} 0"'
        # A critically damped one that takes the two steps that MuJoCo asks for at least.
        return f'solref="{2.02 * step} 1"'


SETTINGS = {
    "default": Settings(""),
    "elliptic cone": Settings('cone="elliptic"'),
    "tuned": Settings('cone="elliptic" impratio="30" ccd_iterations="100"', True),
}


def engines() -> list[Engine]:
    return [
        Engine(NAME, f"ellipsoids, {name}", Ellipse, translation(settings))
        for name, settings in SETTINGS.items()
    ]


def translation(settings: Settings) -> Callable[[pymunk.Space, float, float], World]:
    def translate(space: pymunk.Space, step: float, metre: float) -> World:
        return MujocoWorld(space, step, metre, settings)

    return translate


class MujocoWorld:
    """A pymunk space of ellipses, stepped by MuJoCo.

    Each body has two slides and a hinge; a static segment is a plane. metre is how long one is in the space's units.
    """

    def __init__(
        self, space: pymunk.Space, step: float, metre: float, settings: Settings
    ) -> None:
        self.metre = metre
        self.bodies: list[pymunk.Body] = []
        geoms = []
        for shape in space.shapes:
            if isinstance(shape, Ellipse):
                assert shape.body is not None
                self.bodies.append(shape.body)
                geoms.append(self.moving(shape))
            else:
                assert isinstance(shape, pymunk.Segment)
                geoms.append(self.plane(shape, space))
        gravity = space.gravity / metre
        elastic = any(shape.elasticity > 0.0 for shape in space.shapes)
        frictionless = all(shape.friction == 0.0 for shape in space.shapes)
        self.model = mujoco.MjModel.from_xml_string(f"""
            <mujoco>
              <option timestep="{step}" gravity="{gravity.x} {gravity.y} 0" {settings.option}/>
              <size memory="400M"/>
              <default>
                <geom condim="{1 if frictionless else 3}" {settings.contacts(elastic, step)}/>
              </default>
              <worldbody>{"".join(geoms)}</worldbody>
            </mujoco>""")
        self.data = mujoco.MjData(self.model)
        self.positions = self.data.qpos.reshape(-1, 3)
        self.velocities = self.data.qvel.reshape(-1, 3)
        for i, body in enumerate(self.bodies):
            self.positions[i] = *(body.position / metre), body.angle
            self.velocities[i] = *(body.velocity / metre), body.angular_velocity

    def moving(self, shape: Ellipse) -> str:
        assert shape.body is not None
        a, b = shape.a / self.metre, shape.b / self.metre
        moment = shape.body.moment / self.metre**2
        return f"""
            <body>
              <inertial pos="0 0 0" mass="{shape.body.mass}" diaginertia="{moment} {moment} {moment}"/>
              <joint type="slide" axis="1 0 0"/>
              <joint type="slide" axis="0 1 0"/>
              <joint type="hinge" axis="0 0 1"/>
              <geom type="ellipsoid" size="{size(a, b)}" {friction(shape)}/>
            </body>"""

    def plane(self, wall: pymunk.Segment, space: pymunk.Space) -> str:
        """Facing the bodies."""
        normal = (wall.b - wall.a).perpendicular_normal()
        if normal.dot(next(iter(space.bodies)).position - wall.a) < 0.0:
            normal = -normal
        place = wall.a / self.metre
        return f"""
            <geom type="plane" size="0 0 1" pos="{place.x} {place.y} 0"
                  zaxis="{normal.x} {normal.y} 0" {friction(wall)}/>"""

    def step(self, count: int) -> None:
        mujoco.mj_step(self.model, self.data, count)

    def write_back(self) -> None:
        for body, (x, y, angle), (vx, vy, spin) in zip(
            self.bodies,
            self.positions.tolist(),
            self.velocities.tolist(),
            strict=True,
        ):
            body.position = x * self.metre, y * self.metre
            body.angle = angle
            body.velocity = vx * self.metre, vy * self.metre
            body.angular_velocity = spin


def friction(shape: pymunk.Shape) -> str:
    # Of two coefficients MuJoCo takes the larger one, pymunk the product.
    return f'friction="{shape.friction**2} 0 0"'
