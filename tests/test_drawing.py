"""Drawing: true outlines on pymunk's backends and a user's own, and options left as they were."""

import copy
import itertools
import os
import sys
import warnings
from math import cos, hypot, pi, sin

import pymunk
import pytest
from pymunk import SpaceDebugDrawOptions, Transform, Vec2d
from pymunk.space_debug_draw_options import SpaceDebugColor
from scenes import add_ellipse, add_floor

from pymunk_ellipse import Ellipse, Space

RED = SpaceDebugColor(255, 0, 0, 255)
BLUE = SpaceDebugColor(0, 0, 255, 255)


class Recorder(SpaceDebugDrawOptions):
    """Options that write down what they are asked to draw."""

    def __init__(self):
        super().__init__()
        self.calls = []
        self.entered = 0

    def __enter__(self):
        self.entered += 1

    def __exit__(self, kind, error, traceback):
        self.entered -= 1

    def draw_circle(self, *arguments):
        self.calls.append(("circle", *arguments))

    def draw_segment(self, *arguments):
        assert self.entered == 1
        self.calls.append(("segment", *arguments))

    def draw_fat_segment(self, *arguments):
        self.calls.append(("fat segment", *arguments))

    def draw_polygon(self, *arguments):
        assert self.entered == 1
        self.calls.append(("polygon", *arguments))

    def draw_dot(self, *arguments):
        self.calls.append(("dot", *arguments))

    def draw_shape(self, shape):
        self.calls.append(("shape", shape))


def recorded(space, **settings):
    options = Recorder()
    for name, value in settings.items():
        setattr(options, name, value)
    space.debug_draw(options)
    return options.calls


def one_ellipse(a=40, b=20, position=(100, 50), angle=0.3):
    space = Space()
    add_ellipse(space, a, b, position, angle)
    return space


# Outlines


@pytest.mark.parametrize("a, b", [(40, 20), (20, 40), (3, 3), (1000, 1)])
@pytest.mark.parametrize("scale", [0.05, 1.0, 30.0])
def test_outlines_are_as_fine_as_the_screen(a, b, scale):
    """All vertices are on the ellipse, and the ellipse nowhere farther from an edge than promised."""
    space = Space()
    shape = Ellipse(space.static_body, a, b, (7, 8), 0.4)
    space.add(shape)
    transform = Transform.translation(5, 6) @ Transform.scaling(scale)
    [polygon, mark] = recorded(space, transform=transform)
    kind, vertices, radius, _outline_color, _fill_color = polygon
    assert (kind, radius) == ("polygon", 0)
    center = Vec2d(5 + 7 * scale, 6 + 8 * scale)

    worst = 0.0
    for vertex, following in zip(vertices, vertices[1:] + vertices[:1], strict=True):
        u, v = (vertex - center).rotated(-0.4) / scale
        assert hypot(u / a, v / b) == pytest.approx(1, abs=1e-9)
        u, v = ((vertex + following) / 2 - center).rotated(-0.4) / scale
        distance = Ellipse(None, a, b).point_query((u, v)).distance
        worst = max(worst, -distance * scale)
    size = max(a, b) * scale
    allowed = min(0.1, 1e-3 * size)
    assert worst < 1.001 * allowed
    # No finer than it needs to be, at an end that is not sharp.
    assert worst > 0.9 * allowed or max(a, b) > 2 * min(a, b)
    assert mark == ("segment", center, vertices[0], polygon[3])


def test_the_number_of_vertices_is_bounded():
    shape = Ellipse(None, 1e50, 1e44)
    assert len(shape.outline()) == 1000
    assert len(Ellipse(None, 1e-50, 1e-50).outline()) == 71


@pytest.mark.parametrize("a, b", [(40, 20), (20, 40)])
def test_the_mark_points_to_the_end_of_a(a, b):
    space = Space()
    egg = add_ellipse(space, a, b, (100, 50), 0.3)
    [_, mark] = recorded(space)
    assert mark[1] == (100, 50)
    assert mark[2] == pytest.approx((100 + a * cos(0.3), 50 + a * sin(0.3)))
    egg.body.angle += pi / 2
    [_, mark] = recorded(space)
    assert mark[2] == pytest.approx((100 - a * sin(0.3), 50 + a * cos(0.3)))


def test_vertices_turn_counterclockwise():
    for a, b in ((40, 20), (20, 40)):
        vertices = Ellipse(None, a, b).outline()
        area = sum(
            one.cross(two)
            for one, two in zip(vertices, vertices[1:] + vertices[:1], strict=True)
        )
        assert area / 2 == pytest.approx(pi * a * b, rel=2e-3)


def test_any_transform_is_followed():
    transform = Transform(1.5, 0.5, -0.3, 2.0, 7.0, 8.0)
    vertices = Ellipse(None, 40, 20).outline(transform)
    t = 2 * pi / len(vertices)
    for i, vertex in enumerate(vertices):
        expected = transform @ Vec2d(40 * cos(i * t), 20 * sin(i * t))
        assert (vertex - expected).length < 1e-9


def test_outlines_drawn_by_hand_are_those_that_are_drawn():
    """In the world, from body local points, and by a transform that a game has between two steps."""
    space = Space()
    body = pymunk.Body()
    body.position, body.angle = (100, 50), 0.7
    shape = Ellipse(body, 20, 40, (5, -3), 0.4)
    shape.density = 1
    space.add(body, shape)
    [(_, vertices, *_), _] = recorded(space)
    assert shape.outline() == vertices
    local = shape.outline(Transform.identity())
    placed = [body.local_to_world(point) for point in local]
    c, s = body.rotation_vector
    posed = shape.outline(Transform(c, s, -s, c, *body.position))
    for point, one, other in zip(vertices, placed, posed, strict=True):
        assert (point - one).length < 1e-9
        assert (point - other).length < 1e-9


def test_an_outline_is_as_fine_as_its_transform_asks_for():
    shape = Ellipse(None, 40, 20)
    near, far = (shape.outline(Transform.scaling(scale)) for scale in (50, 1))
    assert len(near) > 2 * len(far)


def test_a_shape_without_a_body_is_outlined_where_it_was_updated_to():
    shape = Ellipse(None, 40, 20, (1, 0))
    shape.update(Transform(0, 1, -1, 0, 7, 8))
    assert shape.outline()[0] == pytest.approx((7, 49))


# Options


def test_other_shapes_are_drawn_by_pymunk():
    """Everything that is not an ellipse's is as in a plain space, in the same order."""

    def scene(space):
        add_floor(space)
        box = pymunk.Poly.create_box(space.static_body, (30, 20), 2)
        circle = pymunk.Circle(space.static_body, 7, (50, 0))
        egg = Ellipse(space.static_body, 9, 4, (80, 0))
        last = pymunk.Poly.create_box(space.static_body, (3, 2))
        space.add(box, circle, egg, last)
        space.add(pymunk.PinJoint(space.static_body, pymunk.Body(1, 1), (3, 4)))
        return space

    ours, theirs = recorded(scene(Space())), recorded(scene(pymunk.Space()))
    i = next(
        i for i, call in enumerate(theirs) if call[0] == "polygon" and len(call[1]) > 4
    )
    assert ours[:i] == theirs[:i]
    assert ours[i + 2 :] == theirs[i + 1 :]
    assert len(theirs) > i + 3
    assert ours[i][3:] == theirs[i][3:]


@pytest.mark.parametrize("ellipses", [0, 2])
def test_flags_are_respected(ellipses):
    space = Space()
    space.gravity = 0, -100
    add_floor(space)
    for i in range(ellipses):
        add_ellipse(space, 9, 4, (40 * i, 3.9))
    space.add(pymunk.PivotJoint(space.static_body, pymunk.Body(1, 1), (0, 0)))
    space.step(0.01)
    flags = Recorder.DRAW_CONSTRAINTS
    assert {call[0] for call in recorded(space, flags=flags)} == {"dot"}
    flags = Recorder.DRAW_COLLISION_POINTS
    assert len(recorded(space, flags=flags)) == ellipses
    flags = Recorder.DRAW_SHAPES
    assert len(recorded(space, flags=flags)) == 1 + 2 * ellipses


def test_colors_are_respected():
    space = Space()
    static = Ellipse(space.static_body, 9, 4)
    space.add(static)
    moving = add_ellipse(space, 9, 4, (50, 0))
    own = add_ellipse(space, 9, 4, (90, 0))
    own.color = (1, 2, 3, 4)
    calls = recorded(
        space,
        shape_outline_color=RED,
        shape_static_color=BLUE,
        shape_dynamic_color=(9, 8, 7, 6),
    )
    polygons = {call[1][0].x: call for call in calls if call[0] == "polygon"}
    assert all(call[3] == RED for call in polygons.values())
    assert all(call[3] == RED for call in calls if call[0] == "segment")
    assert polygons[9][4] == BLUE
    assert polygons[59][4] == (9, 8, 7, 6)
    assert polygons[99][4] == (1, 2, 3, 4)
    assert moving.body.position == (50, 0)


def test_a_color_that_fails_is_no_other_shapes_outline(monkeypatch):
    """Errors in callbacks are reported and lost; the next shape is drawn as itself."""
    lost = []
    monkeypatch.setattr(
        sys, "unraisablehook", lambda it: lost.append(str(it.exc_value))
    )

    class Failing(Recorder):
        def color_for_shape(self, shape):
            if isinstance(shape, Ellipse):
                raise ValueError("no color")
            return super().color_for_shape(shape)

    space = Space()
    space.add(Ellipse(space.static_body, 9, 4))
    space.add(pymunk.Poly.create_box(space.static_body, (3, 2)))
    options = Failing()
    space.debug_draw(options)
    polygons = [call for call in options.calls if call[0] == "polygon"]
    assert sorted(len(call[1]) for call in polygons) == [4, 71]
    assert lost == ["no color"]


def test_options_are_left_as_they_were():
    space = one_ellipse()
    options = Recorder()
    options.calls = None
    before = dict(vars(options))
    kind = type(options)
    methods = dict(vars(kind))
    options.calls = []
    space.debug_draw(options)
    options.calls = None
    assert type(options) is kind
    assert vars(options) == before
    assert dict(vars(kind)) == methods
    # A plain space still draws hulls with them.
    options.calls = []
    plain = pymunk.Space()
    plain.add(Ellipse(plain.static_body, 40, 20))
    plain.debug_draw(options)
    [call] = options.calls
    assert len(call[1]) == 8
    assert options.entered == 0


def test_an_error_in_the_options_leaves_them():
    class Failing(Recorder):
        def __enter__(self):
            super().__enter__()
            raise ValueError("not now")

    options = Failing()
    with pytest.raises(ValueError, match="not now"):
        one_ellipse().debug_draw(options)
    assert options.calls == []


def test_options_that_draw_shapes_themselves_get_the_ellipse():
    space = one_ellipse()
    calls = recorded(space, _use_chipmunk_debug_draw=False)
    assert calls == [("shape", *space.shapes)]


def test_options_may_use_their_own_methods_and_attributes():
    class Own(Recorder):
        width = 3

        def draw_polygon(self, verts, radius, outline_color, fill_color):
            self.last = len(verts)
            for one, two in itertools.pairwise(verts):
                self.draw_fat_segment(one, two, self.width, outline_color, fill_color)

    options = Own()
    one_ellipse().debug_draw(options)
    assert options.last == 71
    assert sum(call[0] == "fat segment" for call in options.calls) == 70


def test_copies_are_drawn_too():
    space = copy.deepcopy(one_ellipse())
    assert [call[0] for call in recorded(space)] == ["polygon", "segment"]


def test_a_space_without_ellipses_hands_the_options_to_pymunk(monkeypatch):
    space = one_ellipse()
    space.remove(*space.shapes)
    seen = []
    monkeypatch.setattr(pymunk.Space, "debug_draw", lambda space, o: seen.append(o))
    options = Recorder()
    space.debug_draw(options)
    assert seen == [options]


# pymunk's backends


def inside(a, b, x, y, px, py, angle, grow):
    u, v = Vec2d(px - x, py - y).rotated(-angle)
    return hypot(u / (a + grow), v / (b + grow)) <= 1


def check_picture(pixel, width, height, drawn, a, b, x, y, angle):
    """Every pixel well inside of the ellipse is drawn, and none outside."""
    counted = 0
    for px in range(width):
        for py in range(height):
            is_drawn = drawn(pixel(px, py))
            if inside(a, b, x, y, px, py, angle, -1.5):
                assert is_drawn, (px, py)
                counted += 1
            elif not inside(a, b, x, y, px, py, angle, 1.5):
                assert not is_drawn, (px, py)
    assert counted > 0.8 * pi * a * b


def test_pygame_draws_the_outline(monkeypatch):
    monkeypatch.setitem(os.environ, "SDL_VIDEODRIVER", "dummy")
    pygame = pytest.importorskip("pygame")
    from pymunk import pygame_util

    surface = pygame.Surface((200, 120))
    surface.fill((255, 255, 255))
    options = pygame_util.DrawOptions(surface)
    one_ellipse(80, 30, (100, 60)).debug_draw(options)
    white = (255, 255, 255)
    check_picture(
        lambda x, y: surface.get_at((x, y))[:3],
        200,
        120,
        lambda color: color != white,
        80,
        30,
        100,
        60,
        0.3,
    )
    # The mark, in the colour of outlines.
    tip = Vec2d(100, 60) + Vec2d(60, 0).rotated(0.3)
    assert max(surface.get_at((round(tip.x), round(tip.y)))[:3]) < 160


def test_matplotlib_draws_the_outline():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from matplotlib import pyplot
    from pymunk import matplotlib_util

    figure, axes = pyplot.subplots()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)
            options = matplotlib_util.DrawOptions(axes)
        one_ellipse(8, 3, (10, 6)).debug_draw(options)
        [patch] = axes.patches
        [line] = axes.lines
        for x, y in patch.get_xy():
            u, v = Vec2d(x - 10, y - 6).rotated(-0.3)
            assert hypot(u / 8, v / 3) == pytest.approx(1)
        assert len(patch.get_xy()) == 72
        assert line.get_xydata()[0] == pytest.approx([10, 6])
        tip = [10 + 8 * cos(0.3), 6 + 8 * sin(0.3)]
        assert line.get_xydata()[1] == pytest.approx(tip)
    finally:
        pyplot.close(figure)


def test_pyglet_draws_the_outline():
    pyglet = pytest.importorskip("pyglet")
    pyglet.options["headless"] = True
    try:
        from pymunk import pyglet_util

        window = pyglet.window.Window(200, 120)
    except Exception as error:
        pytest.skip(f"pyglet has nothing to draw on: {error}")
    try:
        pyglet.gl.glClearColor(1, 1, 1, 1)
        window.clear()
        one_ellipse(80, 30, (100, 60)).debug_draw(pyglet_util.DrawOptions())
        image = pyglet.image.get_buffer_manager().get_color_buffer().get_image_data()
        data = image.get_data("RGB", 600)
        check_picture(
            lambda x, y: tuple(data[600 * y + 3 * x : 600 * y + 3 * x + 3]),
            200,
            120,
            lambda color: color != (255, 255, 255),
            80,
            30,
            100,
            60,
            0.3,
        )
    finally:
        window.close()
