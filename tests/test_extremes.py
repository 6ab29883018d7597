"""What no scene should do: whatever pymunk's own polygons survive in a step, ellipses survive as well, and what is near them stays finite."""

import gc
import random
from math import cos, inf, isfinite, nan, pi, sin

import pymunk
import pytest
from crowds import ALL
from processes import run_code
from pymunk import BB, Vec2d
from scenes import PHASES, add_body, add_floor, make_space

from pymunk_ellipse import Ellipse, Space

pytestmark = pytest.mark.usefixtures("backend", "mistakes")


def as_polygon(body, a, b, offset=(0, 0)):
    corners = [
        (offset[0] + a * cos(i * pi / 6), offset[1] + b * sin(i * pi / 6))
        for i in range(12)
    ]
    return pymunk.Poly(body, corners)


def pile(space, make, a=10.0, b=5.0, offset=(0, 0)):
    """Shapes that lie on and beside each other, among some of other kinds."""
    space.gravity = 0, -500
    add_floor(space, half_width=10 * a)
    shapes = []
    for i in range(8):
        place = (i % 4 - 1.5) * 1.8 * a, (1 + 2 * (i // 4)) * 1.1 * b
        shapes.append(
            make(add_body(space, place, 0.3 * i, mass=1, moment=100), a, b, offset)
        )
    shapes.append(pymunk.Circle(add_body(space, (0, 6 * b), mass=1, moment=100), b))
    box = add_body(space, (2 * a, 6 * b), mass=1, moment=100)
    shapes.append(pymunk.Poly.create_box(box, (a, b)))
    for i, shape in enumerate(shapes):
        shape.friction = 0.7
        shape.collision_type = i % 3
    space.add(*shapes)
    return [shape.body for shape in shapes]


def is_finite(body):
    numbers = *body.position, *body.velocity, body.angle, body.angular_velocity
    return all(map(isfinite, numbers))


def ask_everything(space):
    space.point_query((0, 0), 100, ALL)
    space.point_query_nearest((0, 0), 100, ALL)
    space.segment_query((0, 50), (0, -50), 3, ALL)
    space.segment_query_first((0, 50), (0, -50), 0, ALL)
    space.bb_query(BB(-100, -100, 100, 100), ALL)
    for shape in space.shapes:
        space.shape_query(shape)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("position", (nan, nan)),
        ("position", (inf, 0)),
        ("position", (1e300, -1e300)),
        ("position", (1e20, 0)),
        ("velocity", (nan, 0)),
        ("velocity", (1e300, 1e300)),
        ("angle", nan),
        ("angle", 1e300),
        ("angular_velocity", inf),
        ("angular_velocity", 1e20),
        ("force", (nan, 0)),
        ("torque", nan),
    ],
)
def test_a_body_of_nonsense_spoils_no_more_than_a_polygons(name, value):
    finite = []
    for make in (as_polygon, Ellipse):
        space = make_space()
        bodies = pile(space, make)
        for _ in range(20):
            space.step(1 / 120)
        setattr(bodies[2], name, value)
        for _ in range(20):
            space.step(1 / 120)
        ask_everything(space)
        finite.append({i for i, body in enumerate(bodies) if is_finite(body)})
    assert finite[1] >= finite[0]


@pytest.mark.parametrize("dt", [0.0, -0.01, 1e-300, 1e3, 1e300, inf, nan])
@pytest.mark.parametrize("kind", [pymunk.Space, Space])
def test_steps_of_nonsense(dt, kind):
    space = kind()
    pile(space, Ellipse)
    for _ in range(20):
        space.step(1 / 120)
    for _ in range(3):
        space.step(dt)
    for _ in range(20):
        space.step(1 / 120)


@pytest.mark.parametrize(
    ("a", "b"),
    [
        (1e-50, 1e-50),
        (1e-50, 1e-44),
        (1e-9, 1e-12),
        (1e-3, 1.0),
        (1e6, 1.0),
        (1e20, 1e14),
        (1e50, 1e50),
        (1e44, 1e50),
    ],
)
def test_sizes_from_tiny_to_huge(a, b):
    space = make_space()
    bodies = pile(space, Ellipse, a, b)
    for _ in range(40):
        space.step(1 / 120)
    ask_everything(space)
    assert all(map(is_finite, bodies))


@pytest.mark.parametrize("far", [1e3, 1e6, 1e9, 1e12])
def test_offsets_far_from_the_body(far):
    space = make_space()
    bodies = pile(space, Ellipse, offset=(far, -far))
    for _ in range(40):
        space.step(1 / 120)
    ask_everything(space)
    assert all(map(is_finite, bodies))


# In callbacks


@pytest.mark.parametrize("phase", PHASES[:3])
@pytest.mark.parametrize("key", [(None, None), (1, None), (1, 2)])
@pytest.mark.parametrize("change", ["axes", "offset", "angle"])
def test_an_ellipse_changed_in_a_callback_is_where_it_was(phase, key, change):
    """High on a block that reaches down to the origin, where a new shape would be that nobody has placed yet."""
    space = make_space((0, -500))
    corners = [(-300, -50), (300, -50), (300, 200), (-300, 200)]
    block = pymunk.Poly(space.static_body, corners)
    block.collision_type = 2
    body = add_body(space, (0, 205.1), mass=1, moment=inf)
    egg = Ellipse(body, 10, 5)
    egg.collision_type = 1
    space.add(block, egg)
    count = 0

    def alter(arbiter, space, data):
        nonlocal count
        count += 1
        if phase == "begin" or count == 3:
            if change == "axes":
                egg.unsafe_set_semi_axes(10, 5.2)
            elif change == "offset":
                egg.unsafe_set_offset((0, -0.2))
            else:
                egg.unsafe_set_angle(0.1)

    space.on_collision(*key, **{phase: alter})
    for _ in range(60):
        space.step(1 / 120)
        assert 204.8 < body.position.y < 206
    assert count > 0


def drop_everything(arbiter, space, shapes):
    """Remove a pair and all that refers to it."""
    for shape in arbiter.shapes:
        if shape.body is not space.static_body and shape.space is not None:
            space.remove(shape, shape.body)
            shape.body._shapes.pop(shape, None)
    gc.collect(1)


def bring_another(arbiter, space, shapes):
    if len(shapes) < 30:
        body = pymunk.Body(1, 100)
        body.position = shapes[0].body.position + Vec2d(len(shapes), 3)
        shapes.append(Ellipse(body, 6, 3))
        space.add(body, shapes[-1])


def go_and_come_again(arbiter, space, shapes):
    for shape in shapes:
        if shape.space is None:
            space.add(shape)
    for shape in arbiter.shapes:
        if isinstance(shape, Ellipse) and shape.space is not None:
            space.remove(shape)


def change_shape(arbiter, space, shapes):
    for i, shape in enumerate(arbiter.shapes):
        if isinstance(shape, Ellipse):
            shape.unsafe_set_semi_axes(4 + 3 * i, 5)
            shape.unsafe_set_offset((i, 0.5))
            shape.unsafe_set_angle(0.3)


def move_body(arbiter, space, shapes):
    for shape in arbiter.shapes:
        if shape.body is not space.static_body:
            shape.body.position += 0.1, 0.3
            shape.body.angle += 0.5
            shape.body.mass = 2


def write_nonsense(arbiter, space, shapes):
    arbiter.friction = nan
    arbiter.restitution = inf
    arbiter.surface_velocity = nan, 1e300


def copy_the_space(arbiter, space, shapes):
    # pymunk does not copy a space that has lost a body.
    if len(shapes) < 14 and all(shape.body for shape in space.shapes):
        shapes.append(shapes[0])
        space.copy().step(0.01)


def ask(arbiter, space, shapes):
    ask_everything(space)


@pytest.mark.parametrize("kind", [pymunk.Space, Space])
@pytest.mark.parametrize("phase", PHASES)
@pytest.mark.parametrize(
    "act",
    [
        drop_everything,
        bring_another,
        go_and_come_again,
        change_shape,
        move_body,
        write_nonsense,
        copy_the_space,
        ask,
    ],
)
def test_callbacks_may_do_all_that_they_may_with_polygons(act, phase, kind):
    rng = random.Random(7)
    space = kind()
    bodies = pile(space, Ellipse)
    shapes = list(space.shapes)
    calls = []

    def callback(arbiter, space, data):
        calls.append(phase)
        if len(calls) % 3 == 0:
            act(arbiter, space, shapes)

    space.on_collision(**{phase: callback})
    for i in range(40):
        for body in bodies:
            if i % 10 == 5 and rng.random() < 0.5:
                body.velocity = rng.uniform(-200, 200), 300
        space.step(1 / 120)
    assert len(calls) >= 3
    space.on_collision(**{phase: pymunk.empty_callback})
    space.step(1 / 120)


def test_a_step_in_a_callback_is_refused(mistakes):
    space = Space()
    pile(space, Ellipse)
    space.on_collision(separate=lambda arbiter, space, data: space.step(0.01))
    for i in range(40):
        for body in space.bodies:
            body.velocity = (0, 200 * (-1) ** (i // 5))
        space.step(1 / 120)
    space.on_collision(separate=pymunk.empty_callback)
    assert {str(mistake) for mistake in mistakes} == {
        "step must not be called in a callback of the same space"
    }
    mistakes.clear()


def test_a_shape_that_outlives_its_body_is_asked_while_its_space_is_collected(backend):
    """pymunk calls separate then; in a process of its own, for Chipmunk ends one that has lost a body."""
    code = """
        import gc
        import pymunk
        from scenes import add_ellipse, make_space
        from pymunk_ellipse import Space
        asked = []

        def ask(arbiter, space, data):
            one, two = arbiter.shapes
            asked.append((one.body, one.bb, one.point_query((0, 0)).distance))
            asked.append((two.body, two.bb, one.distance(two), one.shapes_collide(two)))
            space.shape_query(one)

        for kind in (pymunk.Space, Space):
            for order in (1, -1):
                space = kind()
                eggs = [add_ellipse(space, 4, 2, (0, 3 * i)) for i in range(6)]
                space.on_collision(separate=ask)
                space.step(1e-3)
                # One after the other, in a cycle.
                eggs = eggs[::order]
                eggs[0].cycle = eggs, [egg.body for egg in eggs]
                del eggs, space
                gc.collect()
        assert any(body is None for body, *_ in asked)
        print(len(asked))
    """
    printed, reported = run_code(code, PYMUNK_ELLIPSE_BACKEND=backend)
    assert int(printed) > 10
    assert reported == ""
