"""Touches that last: through sleep, and in copies of a space."""

import pymunk
import pytest
from scenes import PHASES, WAYS, add_body, add_floor
from touching import (
    LOST,
    TOUCH,
    as_circle,
    as_ellipse,
    listen,
    pair_between_touches,
    phases_of,
    put,
)

from pymunk_ellipse import Ellipse, Space

pytestmark = pytest.mark.usefixtures("backend", "mistakes")


# Sleep


@pytest.mark.parametrize("leave", ["removed", "lifted"])
def test_a_touch_lasts_while_the_two_sleep(leave):
    logs = []
    for shape_of in (as_circle, as_ellipse, lambda body, r: Ellipse(body, 2 * r, r)):
        space = Space() if shape_of is not as_circle else pymunk.Space()
        space.gravity = 0, -100
        space.sleep_time_threshold = 0.2
        floor = add_floor(space)
        log = []
        listen(space, log, phases=("begin", "separate"))
        body = add_body(space, (0, 4.9), mass=1, moment=20)
        shape = shape_of(body, 5)
        shape.friction = 1
        sensor = pymunk.Circle(space.static_body, 3)
        sensor.sensor = True
        space.add(shape, sensor)
        for _ in range(200):
            space.step(0.01)
        assert body.is_sleeping
        assert phases_of(log) == ["begin", "begin"]
        body.activate()
        for _ in range(3):
            space.step(0.01)
        assert log == []
        for _ in range(200):
            space.step(0.01)
        assert body.is_sleeping
        if leave == "removed":
            space.remove(shape)
        else:
            body.position = 0, 30
            space.step(0.01)
        logs.append(phases_of(log))
        del floor
    assert logs == [["separate", "separate"]] * 3


# Copies


seen = []


def note_begin(arbiter, space, data):
    seen.append(("begin", data, arbiter.is_first_contact))


def note_pre_solve(arbiter, space, data):
    seen.append(("pre_solve", data, arbiter.is_first_contact))


def note_post_solve(arbiter, space, data):
    seen.append(("post_solve", data, arbiter.is_first_contact))


def note_separate(arbiter, space, data):
    seen.append(("separate", data, arbiter.is_first_contact))


NOTES = {
    "begin": note_begin,
    "pre_solve": note_pre_solve,
    "post_solve": note_post_solve,
    "separate": note_separate,
}


@LOST
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("key", [(None, None), (1, None), (1, 2), (2, 1)])
def test_copies_go_on_with_their_own_events(way, key):
    """The copy of two that touch has no second begin, but pre_solve, post_solve, one separate and what follows."""
    space, _one, _other, touch, part = pair_between_touches()
    for phase in PHASES:
        space.on_collision(*key, **{phase: NOTES[phase]}, data=phase)
    touch()
    touch()
    seen.clear()
    twin = way(space)
    assert type(twin) is Space
    assert seen == []
    one, other = twin.shapes
    place = other.body.position
    for moved, expected in (
        ((0, 0), ["pre_solve", "post_solve"]),
        ((0, 0), ["pre_solve", "post_solve"]),
        ((100, 0), ["separate"]),
        ((100, 0), []),
        ((0, 0), TOUCH),
    ):
        put(one.body, (0, 0))
        put(other.body, place + moved)
        twin.step(0.01)
        assert [phase for phase, *_ in seen] == expected
        assert all(data == phase for phase, data, _ in seen)
        assert [first for *_, first in seen] == ["begin" in expected] * len(expected)
        seen.clear()
    # The original has not noticed.
    touch()
    assert phases_of(seen) == TOUCH[1:]
    part()
    assert phases_of(seen) == ["separate"]


@LOST
@pytest.mark.parametrize("way", WAYS)
def test_copy_of_two_that_touch_ends_the_touch(way):
    """Also if they part, or one goes, before the copy has made a step with them touching."""
    for leave in ("part", "remove"):
        space, _one, _other, touch, part = pair_between_touches()
        space.on_collision(begin=note_begin, separate=note_separate)
        part()
        apart = [body.position for body in space.bodies]
        touch()
        twin = way(space)
        seen.clear()
        if leave == "remove":
            twin.remove(list(twin.shapes)[-1])
        else:
            for body, place in zip(twin.bodies, apart, strict=True):
                put(body, place)
            twin.step(0.01)
        assert phases_of(seen) == ["separate"]
