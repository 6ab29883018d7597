"""The compiled contact callback in its Python form: the same functions, with loads and stores by cffi."""

from math import pi

import pymunk
import pytest
from scenes import add_body, add_box, add_ellipse, make_space

import pymunk_ellipse.contacts
from pymunk_ellipse import Ellipse
from pymunk_ellipse._pymunk import address, ffi

compiled = pytest.importorskip("pymunk_ellipse.compiled", exc_type=ImportError)


def load(kind):
    return lambda place, offset: ffi.cast(f"{kind} *", place + offset)[0]


def store(kind):
    def function(place, offset, value):
        ffi.cast(f"{kind} *", place + offset)[0] = value

    return function


@pytest.fixture
def python_form(monkeypatch):
    """Resolves the contacts of spaces by what numba compiles, uncompiled."""
    for name, kind in (("double", "double"), ("int", "int"), ("word", "int64_t")):
        monkeypatch.setattr(compiled, f"load_{name}", load(kind))
        monkeypatch.setattr(compiled, f"store_{name}", store(kind))
    monkeypatch.setattr(
        compiled, "doubles_at", lambda place: ffi.cast("double *", place)
    )
    monkeypatch.setattr(
        compiled, "carray", lambda pointer, count: ffi.unpack(pointer, count)
    )
    pre_solve = compiled._define(1)
    calls = []

    @ffi.callback("void(cpArbiter *, cpSpace *, cpDataPointer)")
    def callback(arbiter, space, data):
        calls.append(pre_solve(address(arbiter), 0, 0))

    monkeypatch.setattr(pymunk_ellipse.contacts, "compiled_pre_solve", lambda: callback)
    return calls


def crowd():
    """Every kind of shape among ellipses, chained segments, a moving belt, and a pair without ellipses."""
    space = make_space((0, -500), 20)
    add_box(space, 40, 200)
    chain = [pymunk.Segment(space.static_body, (x, 8), (x + 20, 8), 1) for x in (0, 20)]
    chain[0].set_neighbors((0, 8), (40, 8))
    chain[1].set_neighbors((0, 8), (40, 8))
    chain[0].surface_velocity = 30, 0
    space.add(*chain)
    for i in range(12):
        x, y = 20 * (i % 3) - 20, 20 + 16 * (i // 3)
        if i % 4 == 3:
            body = add_body(space, (x, y), 0.3 * i)
            shape = (
                pymunk.Circle(body, 5),
                pymunk.Poly.create_box(body, (9, 7), 0.5),
                pymunk.Segment(body, (-5, 0), (5, 1), 2),
            )[i // 4]
            shape.density = 1
            space.add(shape)
        else:
            egg = add_ellipse(space, 8, 8 if i == 1 else 4, (x, y), 0.7 * i)
            egg.surface_velocity = i % 2, 0
    low = add_body(space, (-30, 90), mass=1, moment=1)
    space.add(pymunk.Circle(low, 3))
    low = add_body(space, (-30, 95), mass=1, moment=1)
    space.add(pymunk.Circle(low, 3))
    off_center = add_body(space, (30, 90), pi / 3)
    shapes = [Ellipse(off_center, 6, 3, (4, 0)), Ellipse(off_center, 3, 6, (-4, 1))]
    for shape in shapes:
        shape.density = 1
    space.add(*shapes)
    return space


def places(space):
    return [(*body.position, body.angle) for body in space.bodies]


def run(space, count):
    for _ in range(count):
        space.step(1 / 120)
    return places(space)


def test_moves_as_the_python_backend_does(python_form, monkeypatch):
    found = run(crowd(), 60)
    assert len(python_form) > 300
    monkeypatch.setattr(pymunk_ellipse.contacts, "compiled_pre_solve", lambda: None)
    for expected, place in zip(run(crowd(), 60), found, strict=True):
        assert place == pytest.approx(expected, abs=1e-6)


def test_goes_on_in_a_copy(python_form):
    """A copy numbers shapes anew, which swaps pairs."""
    space = crowd()
    run(space, 60)
    twin = space.copy()
    del python_form[:]
    run(twin, 20)
    assert python_form
    for body in twin.bodies:
        assert body.position.y > 0
