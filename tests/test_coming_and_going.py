"""Ellipses that are added and removed, in callbacks too, and spaces that are forgotten."""

import gc
import weakref

import pymunk
import pytest
from scenes import (
    PHASES,
    add_body,
    add_ellipse,
    add_floor,
    contacts,
    fill,
    height,
    make_space,
    settle,
)

from pymunk_ellipse import Ellipse
from pymunk_ellipse.contacts.handler import contact_handler

pytestmark = pytest.mark.usefixtures("backend")


@pytest.mark.parametrize("phase", PHASES)
def test_removed_in_a_callback(phase):
    space = make_space((0, -500))
    add_floor(space, elasticity=1)
    fill(space, 3, 3)
    for shape in space.shapes:
        shape.elasticity = 0.9
    count = len(space.bodies)

    def remove(arbiter, space, data):
        for shape in arbiter.shapes:
            if isinstance(shape, Ellipse) and shape.space is not None:
                space.remove(shape, shape.body)
                break

    space.on_collision(**{phase: remove})
    settle(space, 2)
    assert len(space.bodies) < count


def test_added_in_a_callback():
    """The first ellipse of a space, added while it steps."""
    space = make_space((0, -500))
    add_floor(space)
    ball = add_body(space, (0, 5), mass=1, moment=10)
    space.add(pymunk.Circle(ball, 5))
    bodies = []

    def drop(arbiter, space, data):
        if not bodies:
            body = pymunk.Body()
            body.position = 50, 40
            egg = Ellipse(body, 20, 10)
            egg.density = 1
            egg.friction = 1
            bodies.append(body)
            space.add(body, egg)

    space.on_collision(pre_solve=drop)
    settle(space, 3)
    (body,) = bodies
    assert body.position.y == pytest.approx(10, abs=0.2)


def test_removed_and_added_elsewhere():
    first, second = make_space((0, -500)), make_space((0, -500))
    egg = add_ellipse(first, 20, 10, (0, 12), 0.3)
    body = egg.body
    add_floor(first)
    add_floor(second)
    settle(first, 0.2)
    first.remove(egg, body)
    assert egg.space is None
    second.add(body, egg)
    assert egg.space is second
    seen = contacts(second)
    settle(second, 3)
    assert seen
    assert body.position.y == pytest.approx(height(20, 10, body.angle), abs=0.2)
    second.remove(egg, body)
    first.add(body, egg)
    settle(first, 0.2)
    assert body.position.y == pytest.approx(height(20, 10, body.angle), abs=0.2)


def test_spaces_are_collected():
    references = []
    for _ in range(20):
        space = make_space((0, -500))
        add_floor(space)
        fill(space, 2, 2)
        settle(space, 0.2)
        references.append(weakref.ref(space))
    del space
    gc.collect()
    assert [reference() for reference in references] == [None] * 20


def test_space_forgets_what_left():
    space = make_space()
    eggs = [add_ellipse(space, 20, 10, (50 * i, 0)) for i in range(4)]
    handler = contact_handler(space)
    assert handler.ellipses == 4
    for egg in eggs[:3]:
        space.remove(egg, egg.body)
    assert handler.ellipses == 1


def test_polygon_in_the_place_of_a_removed_ellipse():
    """Nothing is remembered by an address that Chipmunk may use again."""
    space = make_space((0, -500))
    add_floor(space)
    for _ in range(8):
        egg = add_ellipse(space, 20, 10, (0, 12))
        settle(space, 0.05)
        space.remove(egg, egg.body)
        del egg
        gc.collect()
    box = add_body(space, (0, 5), mass=1, moment=100)
    space.add(pymunk.Poly.create_box(box, (10, 10)))
    counts = []
    space.on_collision(
        post_solve=lambda arbiter, *_: counts.append(
            len(arbiter.contact_point_set.points)
        )
    )
    settle(space, 0.5)
    assert set(counts) == {2}
