"""Box2D 2.3: its collision of two polygons that stand for ellipses, and scenes of such polygons and circles."""

from __future__ import annotations

from math import pi
from typing import Any

import Box2D
import numpy as np
import pymunk

from ._builders import CIRCLE, polygon
from ._methods import Pairs
from ._peers_pairs import PairMethod, Placed, Prepared, each
from ._peers_scenes import Engine

NAME = "Box2D"
VERTICES = Box2D.b2_maxPolygonVertices
# Its manual's, per step.
VELOCITY_ITERATIONS = 8
POSITION_ITERATIONS = 3


def pair_methods() -> list[PairMethod]:
    return [PairMethod(f"{NAME}, polygons", VERTICES, polygons)]


def polygons(pairs: Pairs) -> Prepared:
    """By b2CollidePolygons, less b2CollideCircles."""
    manifold = Box2D.b2Manifold()
    shapes, circles = [], []
    for one, two in each(pairs):
        shapes.append((*inscribed(one), *inscribed(two)))
        circles.append(
            tuple(
                part
                for at in (one, two)
                for part in (Box2D.b2CircleShape(radius=at.b), transform(at))
            )
        )
    found = np.full((len(pairs), 4), np.nan)
    for row, (one, at_one, two, at_two) in zip(found, shapes, strict=True):
        Box2D.b2CollidePolygons(manifold, one, at_one, two, at_two)
        if manifold.pointCount:
            row[:] = deepest(manifold, at_one, at_two)
    found[found[:, 0] <= 0.0] = np.nan

    def calls() -> None:
        for one, at_one, two, at_two in shapes:
            Box2D.b2CollidePolygons(manifold, one, at_one, two, at_two)

    def calling() -> None:
        for one, at_one, two, at_two in circles:
            Box2D.b2CollideCircles(manifold, one, at_one, two, at_two)

    return Prepared(found, calls, calls, calling)


def inscribed(at: Placed) -> tuple[Any, Any]:
    """A polygon with its vertices on the ellipse, and where it is."""
    t = 2.0 * pi / VERTICES * np.arange(VERTICES)
    vertices = np.stack((at.a * np.cos(t), at.b * np.sin(t)), axis=1)
    return Box2D.b2PolygonShape(vertices=vertices.tolist()), transform(at)


def transform(at: Placed) -> Any:
    place = Box2D.b2Transform()
    place.Set((at.x, at.y), at.angle)
    return place


def deepest(
    manifold: Any, at_one: Any, at_two: Any
) -> tuple[float, float, float, float]:
    """Depth and normal (x, y, z), without the skin that Box2D gives its polygons."""
    on_first = manifold.type_ == manifold.e_faceA
    face, other = (at_one, at_two) if on_first else (at_two, at_one)
    normal = face.R * manifold.localNormal
    point = face * manifold.localPoint
    depth = max(
        -normal.dot(other * manifold.points[i].localPoint - point)
        for i in range(manifold.pointCount)
    )
    if not on_first:
        normal = -normal
    return depth, normal.x, normal.y, 0.0


def engines() -> list[Engine]:
    return [
        Engine(NAME, "circles", CIRCLE.make, Box2DWorld),
        Engine(NAME, f"{VERTICES}-gons", polygon(VERTICES).make, Box2DWorld),
    ]


class Box2DWorld:
    """A pymunk space of circles, polygons and static segments, stepped by Box2D.

    metre is how long one is in the space's units.
    """

    def __init__(self, space: pymunk.Space, step: float, metre: float) -> None:
        self.seconds = step
        self.metre = metre
        self.world = Box2D.b2World(gravity=tuple(space.gravity / metre))
        self.bodies: list[tuple[pymunk.Body, Any]] = []
        ground = self.world.CreateStaticBody()
        for shape in space.shapes:
            assert shape.body is not None
            if isinstance(shape, pymunk.Segment):
                self.put(shape, ground)
            else:
                self.bodies.append((shape.body, self.moving(shape)))

    def moving(self, shape: pymunk.Shape) -> Any:
        body = shape.body
        assert body is not None
        moved = self.world.CreateDynamicBody(
            position=tuple(body.position / self.metre),
            angle=body.angle,
            linearVelocity=tuple(body.velocity / self.metre),
            angularVelocity=body.angular_velocity,
            # Said of the world alone, it does not keep bodies from sleeping.
            allowSleep=False,
        )
        self.put(shape, moved)
        moved.massData = Box2D.b2MassData(
            mass=body.mass, center=(0.0, 0.0), I=body.moment / self.metre**2
        )
        return moved

    def put(self, shape: pymunk.Shape, body: Any) -> None:
        body.CreateFixture(
            shape=self.converted(shape),
            # Of two coefficients Box2D takes the geometric mean and the larger one, pymunk the products.
            friction=shape.friction**2,
            restitution=shape.elasticity**2,
        )

    def converted(self, shape: pymunk.Shape) -> Any:
        if isinstance(shape, pymunk.Circle):
            return Box2D.b2CircleShape(radius=shape.radius / self.metre)
        if isinstance(shape, pymunk.Poly):
            vertices = [tuple(v / self.metre) for v in shape.get_vertices()]
            return Box2D.b2PolygonShape(vertices=vertices)
        assert isinstance(shape, pymunk.Segment)
        ends = shape.a / self.metre, shape.b / self.metre
        return Box2D.b2EdgeShape(vertices=[tuple(end) for end in ends])

    def step(self, count: int) -> None:
        for _ in range(count):
            self.world.Step(self.seconds, VELOCITY_ITERATIONS, POSITION_ITERATIONS)

    def write_back(self) -> None:
        for body, moved in self.bodies:
            x, y = moved.position
            vx, vy = moved.linearVelocity
            body.position = x * self.metre, y * self.metre
            body.angle = moved.angle
            body.velocity = vx * self.metre, vy * self.metre
            body.angular_velocity = moved.angularVelocity
