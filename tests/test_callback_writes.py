"""What a callback writes lasts: a round ellipse moves as pymunk's own circle does, whatever the callback, its key and its phase."""

import pymunk
import pytest
from pymunk import Vec2d

from pymunk_ellipse import Ellipse, Space

BALL, FLOOR = 1, 2

KEYS = [
    (BALL, FLOOR),
    (FLOOR, BALL),
    (BALL, None),
    (FLOOR, None),
    (None, None),
]


def tilt_normal(arbiter):
    contact = arbiter.contact_point_set
    contact.normal = contact.normal.rotated(-0.4)
    arbiter.contact_point_set = contact


def move_points(arbiter):
    """Deeper, and aside."""
    contact = arbiter.contact_point_set
    for point in contact.points:
        point.point_a += Vec2d(0.5, 0.25 * contact.normal.y)
        point.point_b += Vec2d(0.5, -0.25 * contact.normal.y)
    arbiter.contact_point_set = contact


def set_friction(arbiter):
    arbiter.friction = 0.05


def set_restitution(arbiter):
    arbiter.restitution = 0.5


def set_surface_velocity(arbiter):
    """That of the second shape less that of the first; which one that is depends on the kind of shape for (None, None)."""
    sign = 1 if arbiter.shapes[0].collision_type == BALL else -1
    arbiter.surface_velocity = 30 * sign, 0


def let_through(arbiter):
    arbiter.process_collision = False


def let_through_sometimes(arbiter):
    """The ball falls through the floor where it is left of the middle."""
    arbiter.process_collision = (
        arbiter.bodies[0].position.x + arbiter.bodies[1].position.x > -10
    )


def look(arbiter):
    """Reading changes nothing."""
    assert arbiter.contact_point_set.points


WRITES = [
    tilt_normal,
    move_points,
    set_friction,
    set_restitution,
    set_surface_velocity,
    let_through,
    let_through_sometimes,
    look,
]


def path(make_space, make_ball, key, phase, write):
    space = make_space()
    space.gravity = 0, -500
    floor = pymunk.Segment(space.static_body, (-500, 0), (500, 0), 8)
    floor.friction = 0.8
    floor.elasticity = 0.9
    floor.surface_velocity = 5, 0
    floor.collision_type = FLOOR
    body = pymunk.Body(1, 20)
    body.position = 0, 30
    body.velocity = -20, -100
    body.angular_velocity = 3
    ball = make_ball(body)
    ball.friction = 0.7
    ball.elasticity = 0.8
    ball.collision_type = BALL
    calls = []

    def callback(arbiter, space, data):
        calls.append(phase)
        write(arbiter)

    space.on_collision(*key, **{phase: callback})
    space.add(floor, body, ball)
    places = []
    for _ in range(180):
        space.step(1 / 120)
        places.append((*body.position, body.angle))
    assert calls
    return places


@pytest.mark.parametrize("phase", ["begin", "pre_solve"])
@pytest.mark.parametrize("key", KEYS, ids=str)
@pytest.mark.parametrize("write", WRITES, ids=lambda write: write.__name__)
def test_a_round_ellipse_moves_as_a_circle_does(backend, write, key, phase):
    expected = path(
        pymunk.Space, lambda body: pymunk.Circle(body, 7), key, phase, write
    )
    found = path(Space, lambda body: Ellipse(body, 7, 7), key, phase, write)
    for right, place in zip(expected, found, strict=True):
        assert place == pytest.approx(right, abs=1e-9)


# In a plain space the exact contact comes after the callbacks for particular types.
LASTING = [
    set_friction,
    set_restitution,
    set_surface_velocity,
    let_through,
    let_through_sometimes,
]


@pytest.mark.parametrize(
    ("key", "write"),
    [(key, write) for key in KEYS for write in LASTING]
    + [((None, None), write) for write in (tilt_normal, move_points)],
    ids=lambda value: getattr(value, "__name__", str(value)),
)
def test_what_lasts_in_a_plain_space(backend, key, write):
    expected, found = (
        path(pymunk.Space, make_ball, key, "pre_solve", write)
        for make_ball in (
            lambda body: pymunk.Circle(body, 7),
            lambda body: Ellipse(body, 7, 7),
        )
    )
    for right, place in zip(expected, found, strict=True):
        assert place == pytest.approx(right, abs=1e-9)
