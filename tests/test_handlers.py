"""The user's collision callbacks in a plain pymunk.Space, and the contacts that they see."""

import sys
from math import cos, sin

import pymunk
import pytest
from scenes import (
    PHASES,
    add_body,
    add_box,
    add_ellipse,
    add_floor,
    fill,
    height,
    kinetic_energy_per_mass,
    make_space,
    settle,
)
from touching import check_exact

from pymunk_ellipse import Ellipse

pytestmark = pytest.mark.usefixtures("backend")


KEYS = [(None, None), (1, None), (2, None), (1, 2), (2, 1)]


def falling(space):
    """An ellipse of collision type 1 that will bounce off a floor of type 2 for good."""
    floor = add_floor(space, elasticity=1)
    floor.collision_type = 2
    egg = add_ellipse(space, 20, 10, (0, 22), 0.5, (0, -100), elasticity=1)
    egg.collision_type = 1
    return egg, floor


@pytest.mark.parametrize("when", ["before", "after"])
@pytest.mark.parametrize("key", KEYS)
def test_callbacks_are_called_and_contacts_exact(key, when):
    space = make_space()
    calls = {phase: [] for phase in PHASES}

    def callback(phase):
        def note(arbiter, space, data):
            assert data == {"from": "the user"}
            calls[phase].append(arbiter.shapes)
            if phase == "post_solve":
                check_exact(arbiter)

        return note

    def subscribe():
        for phase in PHASES:
            space.on_collision(
                *key, **{phase: callback(phase)}, data={"from": "the user"}
            )

    if when == "before":
        subscribe()
    egg, floor = falling(space)
    if when == "after":
        subscribe()
    settle(space, 0.5, 1 / 240)
    assert all(calls[phase] for phase in PHASES)
    assert len(calls["begin"]) == len(calls["separate"])
    order = (egg, floor) if key in ((1, None), (1, 2)) else (floor, egg)
    for pairs in calls.values():
        for pair in pairs:
            assert set(pair) == {egg, floor}
            assert key == (None, None) or pair == order
    assert egg.body.velocity.y > 0


@pytest.mark.parametrize("key", KEYS)
def test_every_contact_of_a_pile_is_exact(key):
    """With a pre_solve of the user's at any key; all kinds of shapes."""
    space = make_space((0, -500))
    add_box(space, 60, 300)
    fill(space, 4, 3)
    for i in range(4):
        body = add_body(space, (30 * i - 45, 70), 0.3 * i, mass=100, moment=3000)
        shapes = [
            pymunk.Circle(body, 8),
            pymunk.Poly.create_box(body, (14, 9), 1),
            pymunk.Segment(body, (-9, 0), (9, 0), 3),
            pymunk.Poly(body, [(9 * cos(0.7 * k), 9 * sin(0.7 * k)) for k in range(9)]),
        ]
        space.add(shapes[i])
    for i, shape in enumerate(space.shapes):
        shape.collision_type = 1 + i % 2
    checked = []

    def check(arbiter, space, data):
        if any(isinstance(shape, Ellipse) for shape in arbiter.shapes):
            check_exact(arbiter)
            checked.append(arbiter)

    space.on_collision(*key, pre_solve=lambda *_: None, post_solve=check)
    settle(space, 1)
    assert len(checked) > 500


def test_global_pre_solve_sees_the_exact_contact():
    space = make_space()
    seen = []

    def look(arbiter, space, data):
        egg, floor = arbiter.shapes[::-1]
        if not isinstance(egg, Ellipse):
            egg, floor = floor, egg
        if egg.shapes_collide(floor).points:
            check_exact(arbiter)
            seen.append(1)

    space.on_collision(pre_solve=look)
    falling(space)
    settle(space, 0.5, 1 / 240)
    assert seen


@pytest.mark.parametrize("key", KEYS)
def test_replaced_and_removed_callbacks(key):
    space = make_space((0, -500))
    egg = falling(space)[0]
    egg.elasticity = 0
    calls = []

    def subscribe(name):
        for phase in ("pre_solve", "post_solve"):
            space.on_collision(*key, **{phase: lambda *_: calls.append(name)})

    subscribe("first")
    settle(space, 0.5)
    assert set(calls) == {"first"}
    calls.clear()
    subscribe("second")
    settle(space, 0.5)
    assert set(calls) == {"second"}
    calls.clear()
    for phase in PHASES:
        space.on_collision(*key, **{phase: pymunk.empty_callback})
    settle(space, 0.5)
    assert calls == []
    # Still the ellipse, not the hull.
    body = egg.body
    assert body.position.y == pytest.approx(height(20, 10, body.angle), abs=0.2)
    points = []
    body.each_arbiter(lambda arbiter: points.append(arbiter.contact_point_set.points))
    assert [len(found) for found in points] == [1]


def test_all_keys_at_once():
    """Each callback is called once a step, the more specific first."""
    space = make_space((0, -500))
    egg, _floor = falling(space)
    egg.elasticity = 0
    calls = []
    for key in KEYS:
        space.on_collision(*key, pre_solve=lambda *_, key=key: calls.append(key))
    settle(space, 1)
    calls.clear()
    space.step(1 / 120)
    assert sorted(calls, key=str) == sorted(KEYS, key=str)
    assert calls[-1] == (None, None)


def test_users_changes_in_pre_solve_count():
    """A friction set for one contact, as pymunk documents."""
    results = []
    for friction in (None, 0.0):
        space = make_space((0, -100))
        add_floor(space)
        egg = add_ellipse(space, 20, 10, (0, 10), 0, (50, 0))

        def slide(arbiter, space, data, friction=friction):
            if friction is not None:
                arbiter.friction = friction

        space.on_collision(pre_solve=slide)
        settle(space, 0.5)
        results.append(egg.body.velocity.x)
    assert results[0] < 40
    assert results[1] == pytest.approx(50, abs=0.1)


def test_error_in_a_callback_does_not_stop_contacts(monkeypatch):
    """pymunk reports what a callback raises and goes on."""
    reported = []
    monkeypatch.setattr(sys, "unraisablehook", reported.append)
    space = make_space((0, -500))
    egg = falling(space)[0]
    egg.elasticity = 0

    def fail(arbiter, space, data):
        raise RuntimeError("the user's mistake")

    space.on_collision(pre_solve=fail)
    settle(space, 1)
    assert egg.body.position.y == pytest.approx(height(20, 10, egg.body.angle), abs=0.2)
    assert {str(report.exc_value) for report in reported} == {"the user's mistake"}


def test_other_shapes_are_left_alone():
    """Circles and boxes in the same space have pymunk's own contacts."""

    def run(with_ellipse):
        space = make_space((0, -100))
        add_floor(space)
        if with_ellipse:
            add_ellipse(space, 2, 1, (500, 1))
        ball = add_body(space, (0, 30), 0.1, (5, 0), 1, 2, 30)
        box = add_body(space, (4, 12), 0.4, (0, 0), 0, 2, 60)
        space.add(pymunk.Circle(ball, 5), pymunk.Poly.create_box(box, (10, 10)))
        settle(space, 2)
        return ball.position, ball.angle, box.position, box.angle

    assert run(True) == run(False)


# Kinds of spaces


def test_threaded_space():
    space = make_space((0, -500), 20, threaded=True)
    space.threads = 2
    add_box(space, 40, 300)
    fill(space, 3, 6)
    checked = []

    def check(arbiter, space, data):
        check_exact(arbiter)
        checked.append(1)

    space.on_collision(post_solve=check)
    settle(space, 4)
    assert kinetic_energy_per_mass(space) < 1
    assert len(checked) > 1000
    assert space.threads == 2 or space.threads == 1


def test_spatial_hash():
    space = make_space((0, -500), 20)
    space.use_spatial_hash(20, 1000)
    add_box(space, 40, 300)
    fill(space, 3, 6)
    space.on_collision(post_solve=lambda arbiter, *_: check_exact(arbiter))
    settle(space, 4)
    assert kinetic_energy_per_mass(space) < 1


def test_sensor():
    space = make_space((0, -100))
    add_floor(space)
    egg = add_ellipse(space, 20, 10, (0, 40), 0.6)
    egg.sensor = True
    calls = []
    for phase in PHASES:
        space.on_collision(**{phase: lambda *_, phase=phase: calls.append(phase)})
    settle(space, 2)
    assert egg.body.position.y < -20
    assert set(calls) == {"begin", "pre_solve", "separate"}
