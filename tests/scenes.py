"""Small scenes that several tests run, and what to measure in them."""

import copy
import itertools
import json
import pickle
import sys
from collections import Counter
from functools import cache
from math import cos, pi, sin, sqrt
from pathlib import Path

import pymunk
import pytest
from pairs import Placed

from pymunk_ellipse import Ellipse

FLOOR = 1000

PHASES = ("begin", "pre_solve", "post_solve", "separate")

# Ways to copy a space.
WAYS = [
    pytest.param(lambda space: space.copy(), id="copy"),
    pytest.param(copy.deepcopy, id="deepcopy"),
    pytest.param(lambda space: pickle.loads(pickle.dumps(space)), id="pickle"),
]

# Exact contacts of some pairs, see pairs.from_reference.
REFERENCES = json.loads((Path(__file__).parent / "contacts.json").read_text())["cases"]

# A shape does not keep its body alive; these live until the test ends.
BODIES = []


def make_space(gravity=(0, 0), iterations=10, **options):
    space = pymunk.Space(**options)
    space.gravity = gravity
    space.iterations = iterations
    return space


def add_body(
    space, position=(0, 0), angle=0.0, velocity=(0, 0), spin=0.0, mass=0.0, moment=0.0
):
    body = pymunk.Body(mass, moment)
    body.position = position
    body.angle = angle
    body.velocity = velocity
    body.angular_velocity = spin
    space.add(body)
    return body


def lone_body(x=0.0, y=0.0, angle=0.0):
    """A body in no space."""
    body = pymunk.Body(1, 1)
    BODIES.append(body)
    body.position = x, y
    body.angle = angle
    return body


def as_shape(body, shape):
    """A shape of the references, on a body."""
    if isinstance(shape, Placed):
        return Ellipse(body, shape.a, shape.b, (shape.x, shape.y), shape.angle)
    if len(shape.vertices) == 1:
        return pymunk.Circle(body, shape.radius, shape.vertices[0])
    if len(shape.vertices) == 2:
        return pymunk.Segment(body, *shape.vertices, shape.radius)
    return pymunk.Poly(body, shape.vertices, radius=shape.radius)


def add_ellipse(
    space,
    a,
    b,
    position=(0, 0),
    angle=0.0,
    velocity=(0, 0),
    spin=0.0,
    friction=0.5,
    elasticity=0.0,
    mass=None,
):
    """An ellipse in the middle of a body of its own, with a density of one unless it has a mass."""
    body = add_body(space, position, angle, velocity, spin)
    shape = Ellipse(body, a, b)
    shape.friction = friction
    shape.elasticity = elasticity
    if mass is None:
        shape.density = 1
    else:
        shape.mass = mass
    space.add(shape)
    return shape


def add_floor(space, y=0.0, half_width=1000.0, friction=1.0, elasticity=0.0):
    floor = pymunk.Segment(space.static_body, (-half_width, y), (half_width, y), 0)
    floor.friction = friction
    floor.elasticity = elasticity
    floor.collision_type = FLOOR
    space.add(floor)
    return floor


def add_box(space, half_width, height, friction=0.5):
    """A floor at y = 0 and two walls."""
    corners = [
        (-half_width, height),
        (-half_width, 0),
        (half_width, 0),
        (half_width, height),
    ]
    for start, end in itertools.pairwise(corners):
        wall = pymunk.Segment(space.static_body, start, end, 0)
        wall.friction = friction
        wall.collision_type = FLOOR
        space.add(wall)


def fill(space, columns, rows, a=8, b=4, spacing=18):
    """Ellipses in rows, each turned another way."""
    for i in range(columns):
        for j in range(rows):
            x = (i - (columns - 1) / 2) * spacing + (j % 2) * 2 - 1
            add_ellipse(space, a, b, (x, 10 + j * 14), 0.7 * i + 1.3 * j)


def settle(space, seconds=6.0, dt=1 / 120):
    for _ in range(round(seconds / dt)):
        space.step(dt)


def crowded_pile(space):
    """Ellipses in a box that fall, with shapes of every other kind upon them, and may fall asleep."""
    space.gravity = 0, -500
    add_box(space, 60, 300)
    for i in range(60):
        place = 18 * (i % 6) - 45 + i % 5, 10 + 14 * (i // 6)
        add_ellipse(space, 9, 3 + i % 3, place, 0.7 * i)
    for i in range(6):
        body = add_body(space, (18 * i - 45, 160), 0.3 * i, mass=100, moment=3000)
        shape = (
            pymunk.Circle(body, 6),
            pymunk.Segment(body, (-7, 0), (7, 0), 2),
            pymunk.Poly.create_box(body, (12, 8), 0.5),
        )[i % 3]
        shape.friction = 0.5
        space.add(shape)
    space.sleep_time_threshold = 0.5
    return space


def functions_called(function):
    """How often each Python function is called while a function runs."""
    called = Counter()

    def note(frame, event, argument):
        if event == "call":
            called[frame.f_code.co_name] += 1

    sys.setprofile(note)
    try:
        function()
    finally:
        sys.setprofile(None)
    return called


def contacts(space):
    """A list that every step's touching pairs are appended to: (first shape, second shape, contact point set, impulse on the second)."""
    seen = []

    def note(arbiter, space, data):
        seen.append((*arbiter.shapes, arbiter.contact_point_set, arbiter.total_impulse))

    space.on_collision(post_solve=note)
    return seen


@cache
def data_in_a_copy():
    """The data {"from": "the user"} of a handler, as a callback gets it in a copy of a space with two circles.

    Before 7.3.1 pymunk copied handlers without their data, and with it goes the one contact
    that comes to a copy that way.
    """
    space = make_space()
    space.add(*(pymunk.Circle(add_body(space, mass=1, moment=1), 1) for _ in range(2)))
    space.on_collision(pre_solve=_note_data, data={"from": "the user"})
    space.copy().step(1 / 120)
    return _noted.pop()


@cache
def calls_of_wildcard():
    """How often pymunk calls back for (1, None) when two shapes of the type 1 touch: once before 7.1.0, then for each."""
    space = make_space()
    for _ in range(2):
        circle = pymunk.Circle(add_body(space, mass=1, moment=1), 1)
        circle.collision_type = 1
        space.add(circle)
    calls = []
    space.on_collision(1, None, pre_solve=lambda *arguments: calls.append(arguments))
    space.step(1 / 120)
    return len(calls)


_noted = []


def _note_data(arbiter, space, data):
    _noted.append(data)


def kinetic_energy_per_mass(space):
    bodies = [body for body in space.bodies if body.body_type == pymunk.Body.DYNAMIC]
    energy = sum(body.kinetic_energy for body in bodies)
    return energy / sum(body.mass for body in bodies)


def height(a, b, angle):
    """Height of the centre of an ellipse that lies on a floor: its support function straight down."""
    return sqrt((a * sin(angle)) ** 2 + (b * cos(angle)) ** 2)


def rocking_period(a, b, gravity, tilt, count=2000):
    """Period of an ellipse that rocks on a flat floor without slip, from its energy.

    T = 4 int_0^tilt dt / w with w^2 = 2 g (h(tilt) - h(t)) / (k^2 + h^2 + h'^2). With
    t = tilt sin u the integrand is smooth, and the midpoint rule converges fast.
    """
    total = 0.0
    for i in range(count):
        u = (i + 0.5) * pi / 2 / count
        t = tilt * sin(u)
        h = height(a, b, t)
        slope = (a * a - b * b) * sin(t) * cos(t) / h
        inertia = (a * a + b * b) / 4 + h * h + slope * slope
        # h(tilt) - h(t) without cancellation.
        fall = (a * a - b * b) * sin(tilt - t) * sin(tilt + t)
        fall /= height(a, b, tilt) + h
        total += sqrt(inertia / (2 * gravity * fall)) * tilt * cos(u)
    return 4 * total * pi / 2 / count


def rock(space, a, b, tilt, seconds, dt, origin=(0.0, 0.0)):
    """Angles, step by step, of an ellipse let go on a floor at a tilt."""
    x, y = origin
    floor = pymunk.Segment(space.static_body, (x - 50 * a, y), (x + 50 * a, y), 0)
    floor.friction = 100
    space.add(floor)
    # A little into the floor, so that the first step sees a contact at any scale.
    start = x, y + height(a, b, tilt) - 1e-6 * b
    shape = add_ellipse(space, a, b, start, tilt, friction=100)
    angles = [tilt]
    for _ in range(round(seconds / dt)):
        space.step(dt)
        angles.append(shape.body.angle)
    return angles


def crossings(angles, dt):
    """The times when an angle passes through zero on its way down."""
    return [
        (i + before / (before - after)) * dt
        for i, (before, after) in enumerate(itertools.pairwise(angles))
        if before > 0 >= after
    ]
