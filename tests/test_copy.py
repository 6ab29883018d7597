"""Spaces with ellipses, copied and pickled while they run."""

import pymunk
import pytest
from scenes import (
    WAYS,
    add_body,
    add_box,
    add_ellipse,
    add_floor,
    contacts,
    data_in_a_copy,
    kinetic_energy_per_mass,
    make_space,
)

from pymunk_ellipse import Ellipse

pytestmark = pytest.mark.usefixtures("backend")

calls = []


def note_begin(arbiter, space, data):
    calls.append(("begin", data))


def note_pre_solve(arbiter, space, data):
    calls.append(("pre_solve", data))


def note_post_solve(arbiter, space, data):
    calls.append(("post_solve", data))


@pytest.fixture(autouse=True)
def no_calls_left():
    calls.clear()


def pile():
    space = make_space((0, -500), 20)
    add_box(space, 30, 200)
    for i in range(12):
        add_ellipse(space, 8, 4, (18 * (i % 3) - 18, 10 + 14 * (i // 3)), 0.7 * i)
    ball = add_body(space, (0, 80), mass=100, moment=2000)
    space.add(pymunk.Circle(ball, 6))
    return space


def step(space, count):
    for _ in range(count):
        space.step(1 / 120)


def places(space):
    return [(*body.position, body.angle) for body in space.bodies]


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize(
    ("when", "difference"), [(0, 0.0), (70, 0.05), (200, 1e-3), (480, 1e-6)]
)
def test_copy_follows_the_original(way, when, difference):
    """Exactly from the start, else closely: the order in which contacts are solved is a new one."""
    if not data_in_a_copy():
        difference *= 10
    space = pile()
    step(space, when)
    twin = way(space)
    assert places(twin) == places(space)
    step(space, 12)
    step(twin, 12)
    for expected, found in zip(places(space), places(twin), strict=True):
        assert found == pytest.approx(expected, abs=difference)


@pytest.mark.parametrize("way", WAYS)
def test_contacts_of_a_copy_are_exact(way):
    space = pile()
    step(space, 30)
    twin = way(space)
    del space
    seen = contacts(twin)
    checked = 0
    for _ in range(120):
        seen.clear()
        twin.step(1 / 120)
        for first, second, found, _impulse in seen:
            if not isinstance(first, Ellipse):
                continue
            (point,) = found.points
            exact = first.shapes_collide(second)
            assert point.distance == pytest.approx(exact.points[0].distance, abs=1e-9)
            assert found.normal == pytest.approx(tuple(exact.normal), abs=1e-5)
            checked += 1
    assert checked > 500


@pytest.mark.parametrize("way", WAYS)
def test_copy_comes_to_rest(way):
    space = pile()
    step(space, 60)
    twin = way(way(space))
    step(twin, 420)
    assert kinetic_energy_per_mass(twin) < 1
    assert all(body.position.y > 0 for body in twin.bodies)


@pytest.mark.parametrize("way", WAYS)
def test_resting_pile_stays_at_rest_in_a_copy(way):
    """The impulses that hold it up are there from the first step, or the copy would jolt."""
    space = pile()
    step(space, 480)
    twin = way(space)
    before = places(twin)
    for _ in range(30):
        twin.step(1 / 120)
        assert kinetic_energy_per_mass(twin) < 1e-3
    for expected, found in zip(before, places(twin), strict=True):
        assert found == pytest.approx(expected, abs=1e-4)


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("key", [(None, None), (0, None), (0, 1000), (1000, 0)])
def test_users_handlers_are_kept(key, way):
    """With their data, if pymunk keeps it."""
    expected = data_in_a_copy()
    space = pile()
    space.on_collision(
        *key,
        begin=note_begin,
        pre_solve=note_pre_solve,
        post_solve=note_post_solve,
        data={"from": "the user"},
    )
    twin = way(space)
    assert calls == []
    step(twin, 120)
    assert {name for name, _data in calls} == {"begin", "pre_solve", "post_solve"}
    assert all(data == expected for _name, data in calls)


@pytest.mark.parametrize("way", WAYS)
def test_handlers_set_on_the_copy(way):
    space = pile()
    twin = way(space)
    twin.on_collision(post_solve=note_post_solve)
    step(space, 60)
    assert calls == []
    step(twin, 60)
    assert calls


@pytest.mark.parametrize("way", WAYS)
def test_original_is_not_disturbed(way):
    alone, copied = pile(), pile()
    step(alone, 30)
    step(copied, 30)
    twin = way(copied)
    step(twin, 10)
    del twin
    step(alone, 30)
    step(copied, 30)
    assert places(copied) == places(alone)


@pytest.mark.parametrize("way", WAYS)
def test_attributes_of_shapes_and_bodies(way):
    space = make_space()
    body = add_body(space, (5, 6), 0.5)
    egg = Ellipse(body, 3, 2, (1, 0), 0.25)
    egg.mass = 7
    egg.friction = 0.3
    egg.collision_type = 9
    space.add(egg)
    (twin,) = way(space).shapes
    assert (twin.a, twin.b, twin.offset, twin.angle) == (3, 2, (1, 0), 0.25)
    assert (twin.mass, twin.friction, twin.collision_type) == (7, 0.3, 9)
    assert twin.body.mass == pytest.approx(7)
    assert twin.body.moment == pytest.approx(body.moment)
    assert twin.body.center_of_gravity == pytest.approx((1, 0))
    assert twin.body.position == (5, 6)
    assert twin.space is not space


@pytest.mark.parametrize("way", WAYS)
def test_ellipses_added_to_and_removed_from_a_copy(way):
    twin = way(pile())
    for shape in list(twin.shapes)[:6]:
        if isinstance(shape, Ellipse):
            twin.remove(shape, shape.body)
    egg = add_ellipse(twin, 8, 4, (0, 150))
    step(twin, 360)
    assert 0 < egg.body.position.y < 100
    assert kinetic_energy_per_mass(twin) < 5


@pytest.mark.parametrize("way", WAYS)
def test_threaded_space(way):
    space = make_space((0, -500), 20, threaded=True)
    space.threads = 2
    add_floor(space)
    egg = add_ellipse(space, 20, 10, (0, 12), 0.1)
    step(space, 10)
    twin = way(space)
    assert twin.threaded
    step(twin, 480)
    (copied,) = (shape for shape in twin.shapes if isinstance(shape, Ellipse))
    assert copied is not egg
    assert copied.body.position.y == pytest.approx(10, abs=0.5)


@pytest.mark.parametrize("way", WAYS)
def test_empty_space(way):
    """A space that only had ellipses is copied as well."""
    space = make_space((0, -500))
    egg = add_ellipse(space, 20, 10)
    body = egg.body
    space.remove(egg, body)
    twin = way(space)
    step(twin, 2)
    add_floor(twin)
    new = add_ellipse(twin, 20, 10, (0, 12))
    step(twin, 240)
    assert new.body.position.y == pytest.approx(10, abs=0.3)
