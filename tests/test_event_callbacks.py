"""What callbacks of exact events get, set and may do."""

import itertools
import sys

import pymunk
import pytest
from scenes import FLOOR, PHASES, add_ellipse, add_floor, functions_called
from touching import (
    TOUCH,
    circles_between_touches,
    far_away,
    listen,
    pair_between_touches,
    phases_of,
    rank,
)

from pymunk_ellipse import Ellipse, Space

pytestmark = pytest.mark.usefixtures("backend", "mistakes")


def test_data():
    space, _one, _other, touch, part = pair_between_touches()
    data = {phase: object() for phase in PHASES}
    seen = []
    for phase in PHASES:
        space.on_collision(
            1,
            2,
            **{phase: lambda arbiter, where, datum: seen.append((where, datum))},
            data=data[phase],
        )
    touch()
    part()
    assert [where for where, _ in seen] == [space] * 4
    assert [datum for _, datum in seen] == [data[phase] for phase in PHASES]


def test_the_more_specific_is_called_first():
    space, _one, _other, touch, part = pair_between_touches()
    log = []
    listen(space, log, (None, None), (2, None), (1, None), (2, 1), (1, 2))
    touch()
    part()
    for phase in PHASES:
        keys = [key for called, key in log if called == phase]
        assert [rank(key) for key in keys] == [0, 0, 1, 1, 2]
        assert len(set(keys)) == 5


def test_replaced_and_removed_callbacks():
    space, _one, _other, touch, part = pair_between_touches()
    first, second = [], []
    listen(space, first)
    touch()
    assert phases_of(first) == TOUCH
    listen(space, second)
    touch()
    assert (phases_of(first), phases_of(second)) == ([], TOUCH[1:])
    space.on_collision(pre_solve=pymunk.empty_callback)
    touch()
    assert phases_of(second) == ["post_solve"]
    space.on_collision(separate=pymunk.empty_callback)
    part()
    touch()
    assert phases_of(second) == ["begin", "post_solve"]
    for phase in ("begin", "post_solve"):
        space.on_collision(**{phase: pymunk.empty_callback})
    part()
    touch()
    assert (first, second) == ([], [])


LEAVING = [
    pytest.param(lambda space, other, part: part(), id="by a little"),
    pytest.param(lambda space, other, part: far_away(space, other), id="far"),
    pytest.param(lambda space, other, part: space.remove(other), id="removed"),
]


@pytest.mark.parametrize("leave", LEAVING)
@pytest.mark.parametrize(
    ("heard", "again"),
    [(True, 0), (True, 1), (False, 1), (False, 0)],
)
@pytest.mark.parametrize("phases", [PHASES, ("separate",)], ids=str)
def test_callbacks_set_while_two_touch(phases, heard, again, leave):
    """They miss the begin, and hear of all that comes after."""
    logs = []
    for make in (circles_between_touches, pair_between_touches):
        space, _one, other, touch, part = make()
        log = []
        if heard:
            space.on_collision(1, 2, pre_solve=lambda *_: None)
        touch()
        touch()
        listen(space, log, phases=phases)
        for _ in range(again):
            touch()
        leave(space, other, part)
        logs.append(phases_of(log))
    expected, found = logs
    assert expected.count("separate") == 1
    assert found == expected


def test_callbacks_set_in_a_callback():
    logs = []
    for make in (circles_between_touches, pair_between_touches):
        space, _one, _other, touch, part = make()
        log = []

        def subscribe(arbiter, space, data, log=log):
            log.append(("subscribe", None))
            listen(space, log)

        space.on_collision(1, 2, begin=subscribe)
        touch()
        part()
        touch()
        logs.append(phases_of(log))
    # That of the same step may be too late for a begin, in both.
    assert [phase for phase in logs[0] if phase != "begin"] == [
        phase for phase in logs[1] if phase != "begin"
    ]
    assert logs[1].count("begin") in (1, 2)


@pytest.mark.parametrize("phase", PHASES)
def test_shapes_added_in_a_callback(phase):
    """A third ellipse enters where the first is, and its events begin in the next step."""
    space, one, _other, touch, part = pair_between_touches()
    added, log = [], []

    def add(arbiter, space, data):
        if not added:
            body = pymunk.Body(1, 1)
            body.position = one.body.position
            shape = Ellipse(body, 5, 3)
            shape.collision_type = 3
            added.append(shape)
            space.add(body, shape)

    space.on_collision(1, 2, **{phase: add})
    listen(space, log, (3, 1))
    touch()
    if phase == "separate":
        part()
    assert phases_of(log) == []
    touch()
    assert phases_of(log) == TOUCH
    space.remove(*added)
    assert phases_of(log) == ["separate"]


@pytest.mark.parametrize(
    ("phase", "key"),
    [
        *itertools.product(PHASES, [(1, 2), (2, None)]),
        *((phase, (None, None)) for phase in PHASES),
    ],
)
def test_errors_in_callbacks(phase, key, mistakes, monkeypatch, capfd):
    """Reported as pymunk does, and events go on as if nothing had happened."""
    # cffi's own report, which is what a user sees.
    monkeypatch.setattr(sys, "unraisablehook", sys.__unraisablehook__)
    heads, logs = [], []
    for make in (circles_between_touches, pair_between_touches):
        space, _one, other, touch, part = make()
        log = []

        def fail(arbiter, space, data, log=log):
            log.append((phase, key))
            raise RuntimeError("the user's mistake")

        listen(space, log, key)
        space.on_collision(*key, **{phase: fail})
        for move in (touch, touch, part, part, touch, part, touch):
            move()
        space.remove(other)
        for _ in range(5):
            space.step(0.01)
        space.add(other)
        touch()
        # Not when the space is collected.
        space.on_collision(*key, **{phase: pymunk.empty_callback})
        logs.append(log)
        lines = capfd.readouterr().err.splitlines()
        assert "RuntimeError: the user's mistake" in lines
        heads.append(
            [line.split(" at ")[0] for line in lines if "cffi callback" in line]
        )
    assert logs[0] == logs[1]
    assert heads[0] == heads[1]
    assert len(heads[0]) == sum(called == phase for called, _ in logs[0])


def test_process_collision_set_in_begin_lasts_until_the_two_part():
    space, one, other, touch, part = pair_between_touches()
    flags = []

    def begin(arbiter, space, data):
        arbiter.process_collision = False

    space.on_collision(
        begin=begin,
        pre_solve=lambda arbiter, *_: flags.append(arbiter.process_collision),
        post_solve=lambda *_: flags.append("solved"),
    )
    for _ in range(3):
        touch()
        touch()
        assert one.body.velocity == other.body.velocity == (0, 0)
    space.on_collision(begin=pymunk.empty_callback)
    touch()
    assert flags == [False] * 7
    part()
    touch()
    assert flags[7:] == [True, "solved"]


def test_process_collision_set_in_pre_solve():
    """It stays until it is set again."""
    space, _one, _other, touch, part = pair_between_touches()
    flags, wanted = [], []

    def pre_solve(arbiter, space, data):
        flags.append(arbiter.process_collision)
        if wanted:
            arbiter.process_collision = wanted.pop()

    space.on_collision(
        pre_solve=pre_solve, post_solve=lambda *_: flags.append("solved")
    )
    touch()
    wanted.append(False)
    touch()
    touch()
    assert flags == [True, "solved", True, False]
    wanted.append(True)
    touch()
    touch()
    assert flags[4:] == [False, "solved", True, "solved"]
    wanted.append(False)
    touch()
    part()
    touch()
    assert flags[8:] == [True, True, "solved"]


# What it costs


@pytest.mark.parametrize("was_heard", [False, True])
def test_without_callbacks_python_has_nothing_to_do(backend, was_heard):
    if backend == "python":
        pytest.skip("Python resolves contacts")
    space = Space()
    space.gravity = 0, -500
    add_floor(space)
    for i in range(5):
        add_ellipse(space, 6, 4, (i, 5 + 9 * i))
    if was_heard:
        log = []
        listen(space, log, (None, None), (0, None), (0, FLOOR))
        for _ in range(60):
            space.step(0.01)
        assert log
        for key in [(None, None), (0, None), (0, FLOOR)]:
            for phase in PHASES:
                space.on_collision(*key, **{phase: pymunk.empty_callback})
    for _ in range(60):
        space.step(0.01)

    def run():
        for _ in range(60):
            space.step(0.01)

    assert set(functions_called(run)) <= {"run", "step", "add", "remove"}
    space.on_collision(pre_solve=lambda *_: None)
    assert "ext_cpCollisionPreSolveFunc" in functions_called(run)
