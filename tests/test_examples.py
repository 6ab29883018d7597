"""The examples: run from an empty folder as their reader would, in windows, and in parts."""

from __future__ import annotations

import json
import random
import subprocess
import sys
from importlib.metadata import packages_distributions, requires
from math import hypot, pi
from pathlib import Path

import pymunk
import pytest
from pymunk import Vec2d
from running import (
    GIF_SIGNATURE,
    PNG_SIGNATURE,
    number_after,
    output_of,
    quick_output,
)

import pymunk_ellipse.examples
from pymunk_ellipse import Ellipse
from pymunk_ellipse.examples.stage.command import EXTRAS, SECONDS, scenes

pytest.importorskip("pygame")
pytest.importorskip("PIL")
pytest.importorskip("tqdm")
pytestmark = pytest.mark.demo

PLACE = Path(pymunk_ellipse.examples.__file__).parent
MODULE = "pymunk_ellipse.examples"
EXAMPLES = sorted(path.stem for path in PLACE.glob("[!_]*.py"))
SCENES = [name for name in EXAMPLES if name != "game"]


@pytest.fixture(autouse=True)
def no_screen(monkeypatch):
    """pygame without a screen or a sound card, here and in other processes."""
    for variable in ("SDL_VIDEODRIVER", "SDL_AUDIODRIVER"):
        monkeypatch.setenv(variable, "dummy")


@pytest.fixture(scope="module")
def quick_run(tmp_path_factory):
    """Runs an example once, and returns what it printed and where its files are.

    A scene's file is pasted into an empty folder and run there by itself, with out for the
    pictures.
    """
    finished = {}

    def run(name):
        if name not in finished:
            folder = tmp_path_factory.mktemp(name)
            if name == "game":
                command = "-m", MODULE, name
            else:
                pasted = folder / f"{name}.py"
                pasted.write_text((PLACE / pasted.name).read_text("utf-8"), "utf-8")
                command = (pasted.name,)
            finished[name] = (
                quick_output(*command, "--quick", cwd=folder),
                folder / "out",
            )
        return finished[name]

    return run


@pytest.mark.parametrize("name", EXAMPLES)
def test_leaves_a_picture_and_an_animation(quick_run, name):
    output, out = quick_run(name)
    for kind, file, signature in (
        ("picture", f"{name}.png", PNG_SIGNATURE),
        ("animation", f"{name}.gif", GIF_SIGNATURE),
    ):
        assert f"{kind}: {Path('out') / file}" in output
        assert (out / file).read_bytes().startswith(signature)


def test_funnel_lets_every_egg_through(quick_run):
    output, _ = quick_run("funnel")
    eggs = number_after("eggs", output)
    assert number_after("eggs in the basket", output) == eggs
    assert 0.0 < number_after("mechanical energy left", output) < 1.0


def test_galton_board_spreads_like_independent_steps(quick_run):
    output, _ = quick_run("galton")
    independent = number_after("standard deviation of independent steps", output)
    spread = number_after("standard deviation, in pitches", output)
    assert 0.7 * independent < spread < 1.4 * independent
    # Four times the standard error of the mean.
    mean = number_after("mean place, in pitches of the pegs", output)
    ellipses = number_after("ellipses", output)
    assert abs(mean) < 4.0 * spread / ellipses**0.5


def test_rocker_has_the_period_of_theory(quick_run):
    output, _ = quick_run("rocker")
    period = number_after("period by theory (s)", output)
    assert number_after("period of the ellipse (s)", output) == pytest.approx(
        period, rel=2e-3
    )
    assert number_after("swing left of the ellipse", output) > 0.98
    assert number_after("swing left of the 24-gon", output) < 0.7


def test_an_ellipse_rolls_on_where_polygons_stop(quick_run):
    output, _ = quick_run("roll")
    turns = [
        number_after(f"turns of the {name}", output)
        for name in ("16-gon", "64-gon", "ellipse")
    ]
    assert turns[0] < 1.0
    assert turns[1] < 0.7 * turns[2]
    # It swings as it rolls, but is as fast on average as it was pushed: a turn of the
    # circumference, 110.5, takes at that speed 1.23 seconds.
    assert turns[2] == pytest.approx(7.0 / 1.23, rel=0.1)


def test_hopper_discharges_evenly(quick_run):
    output, _ = quick_run("hopper")
    assert number_after("grains out", output) == number_after("grains", output)
    first = number_after("grains per second, the first third", output)
    second = number_after("grains per second, the second third", output)
    assert second == pytest.approx(first, rel=0.25)


def test_cart_rolls_without_much_slip(quick_run):
    output, _ = quick_run("cart")
    assert number_after("turns of the rear wheel", output) > 3.0
    rolled = number_after("of its circumference times the turns", output)
    assert 0.93 < rolled < 1.02


def test_cradle_hands_the_speed_on(quick_run):
    output, _ = quick_run("cradle")
    first = number_after("speed of the first when it hits", output)
    assert number_after("speed of the last after it", output) == pytest.approx(
        first, rel=0.01
    )
    swing = number_after("swing of those between them", output)
    assert swing < 0.05
    assert 0.95 < number_after("energy left after all hits", output) < 1.001


def test_pinball_is_played_with_exact_normals(quick_run):
    output, _ = quick_run("pinball")
    assert number_after("hits of bumpers", output) >= 8
    for label in ("balls launched", "passes through lanes"):
        assert number_after(label, output) > 0
    assert number_after("largest error of a hit's normal (rad)", output) < 1e-12


def test_ragdolls_hold_together(quick_run):
    output, _ = quick_run("ragdolls")
    assert number_after("widest gap of a joint ever", output) < 3.0
    assert number_after("limbs below the floor", output) == 0
    assert number_after("kinetic energy per mass in the end", output) < 100.0


def test_platforms_are_one_way(quick_run):
    output, _ = quick_run("one_way")
    assert number_after("passes from below", output) > 0
    assert number_after("landings from above", output) > 0
    assert number_after("steps in which one that had landed was below", output) == 0


def test_mouse_picks_ellipses_not_hulls(quick_run):
    output, _ = quick_run("drag")
    assert number_after("stones picked", output) == 5
    assert number_after("stones in the tray", output) == 5
    assert number_after("clicks just beside stones", output) == 40
    assert number_after("of these, picked", output) == 0


def test_game_is_won_by_the_autopilot_and_survives_saving(quick_run):
    output, _ = quick_run("game")
    assert number_after("flag reached", output) == 1
    assert number_after("coins", output) >= 8
    assert number_after("distance to the egg of the loaded game", output) < 1e-9


# The command line


def test_list_tells_what_each_is_and_how_long_it_takes(tmp_path):
    listed = output_of("-m", MODULE, "--list", cwd=tmp_path)
    assert output_of("-m", MODULE, cwd=tmp_path) == listed
    _title, *lines, place = listed.splitlines()
    rows = [line.split(maxsplit=3) for line in lines]
    assert [name for name, *_ in rows] == EXAMPLES
    assert all(float(time) <= 180 and unit == "s" for _, time, unit, _ in rows)
    assert all(purpose.endswith(".") for *_, purpose in rows)
    assert place.endswith(str(PLACE))


def test_every_time_has_been_measured():
    assert sorted(json.loads((PLACE / SECONDS).read_text("utf-8"))) == EXAMPLES


def test_an_example_runs_by_its_name(tmp_path):
    out = tmp_path / "elsewhere"
    output_of("-m", MODULE, "roll", "--quick", "--out", out, cwd=tmp_path)
    assert sorted(path.name for path in out.iterdir()) == ["roll.gif", "roll.png"]


@pytest.mark.parametrize("arguments", [("nonsense",), ("roll", "--nonsense")])
def test_what_there_is_not_is_refused(tmp_path, arguments):
    finished = subprocess.run(
        [sys.executable, "-m", MODULE, *arguments],
        cwd=tmp_path,
        capture_output=True,
        encoding="utf-8",
    )
    assert finished.returncode == 2
    assert "nonsense" in finished.stderr


def test_nothing_but_the_package_is_installed(tmp_path):
    if PLACE.parents[1] == Path(__file__).parents[1]:
        pytest.skip("installed in place, where the demos are as well")
    missing = subprocess.run([sys.executable, "-c", "import demos"], cwd=tmp_path)
    assert missing.returncode == 1


def without(missing, script, *arguments):
    """Python, in which a module is missing, that runs a script or a module."""
    kind = "path" if script.endswith(".py") else "module"
    code = (
        f"import runpy, sys; sys.modules[{missing!r}] = None; "
        f"sys.argv[1:] = {list(arguments)}; "
        f"runpy.run_{kind}({script!r}, run_name='__main__')"
    )
    return [sys.executable, "-c", code]


@pytest.mark.parametrize("missing", ["pygame", "PIL", "tqdm"])
@pytest.mark.parametrize(
    "command",
    [
        (str(PLACE / "roll.py"), "--quick"),
        (MODULE, "roll"),
        (MODULE, "game"),
        (str(PLACE / "game.py"),),
    ],
    ids=["scene", "scene by name", "game by name", "game"],
)
def test_what_is_missing_is_named_with_its_extra(tmp_path, missing, command):
    if command[0].endswith("game.py") and missing != "pygame":
        pytest.skip("the game is played with pygame alone")
    finished = subprocess.run(
        without(missing, *command), cwd=tmp_path, capture_output=True, encoding="utf-8"
    )
    assert finished.returncode == 1
    assert missing in finished.stderr
    assert "pymunk-ellipse[examples]" in finished.stderr
    assert "Traceback" not in finished.stderr


@pytest.mark.parametrize("module", EXTRAS)
def test_extras_bring_what_they_are_named_for(module):
    distributions = packages_distributions().get(module)
    if not distributions:
        pytest.skip(f"{module} is not installed")
    brought = [
        requirement
        for requirement in requires("pymunk-ellipse") or []
        if f"extra == '{EXTRAS[module]}'" in requirement.replace('"', "'")
    ]
    assert any(
        requirement.lower().startswith(distribution.lower())
        for requirement in brought
        for distribution in distributions
    )


@pytest.mark.parametrize("command", [("roll.py",), ("game.py",)])
def test_a_window_without_a_screen_is_refused(tmp_path, monkeypatch, command):
    monkeypatch.setenv("SDL_VIDEODRIVER", "nonsense")
    options = ["--window"] if command[0] != "game.py" else []
    finished = subprocess.run(
        [sys.executable, str(PLACE / command[0]), *options],
        cwd=tmp_path,
        capture_output=True,
        encoding="utf-8",
    )
    assert finished.returncode == 1
    assert "cannot be opened" in finished.stderr
    assert "Traceback" not in finished.stderr


# Windows


def post(kind, **attributes):
    """An event for the window that opens next."""
    import pygame

    if not pygame.display.get_init():
        pygame.display.init()
        pygame.display.set_mode((1, 1))
    pygame.event.post(pygame.event.Event(kind, **attributes))


@pytest.mark.parametrize("name", SCENES)
def test_scene_runs_in_a_window(name):
    from pymunk_ellipse.examples.stage.window import open_window

    shown = open_window(scenes()[name], frames=3)
    assert shown.steps == 12


def test_the_clock_stops_and_goes_on_by_steps():
    import pygame

    from pymunk_ellipse.examples.stage.window import STEPS_PER_FRAME, open_window

    roll = scenes()["roll"]
    post(pygame.KEYDOWN, key=pygame.K_SPACE)
    assert open_window(roll, frames=5).steps == 0
    for key in (pygame.K_SPACE, pygame.K_n):
        post(pygame.KEYDOWN, key=key)
    assert open_window(roll, frames=5).steps == 1
    for key in (pygame.K_SPACE, pygame.K_SPACE):
        post(pygame.KEYDOWN, key=key)
    assert open_window(roll, frames=5).steps == 5 * STEPS_PER_FRAME


def test_a_scene_starts_again_and_a_window_closes():
    import pygame

    from pymunk_ellipse.examples.stage.window import STEPS_PER_FRAME, open_window

    made = []

    class Noting(scenes()["roll"]):
        def __init__(self):
            made.append(self)
            super().__init__()

    post(pygame.KEYDOWN, key=pygame.K_r)
    shown = open_window(Noting, frames=2)
    assert made == [made[0], shown]
    assert shown.steps == 2 * STEPS_PER_FRAME
    post(pygame.KEYDOWN, key=pygame.K_ESCAPE)
    assert open_window(Noting).steps == STEPS_PER_FRAME


def test_mouse_drags_in_a_window():
    import pygame

    from pymunk_ellipse.examples.stage.canvas import SMOOTHING, Canvas
    from pymunk_ellipse.examples.stage.window import open_window, size_on_screen

    drag = scenes()["drag"]
    pygame.display.init()
    canvas = Canvas(drag.view, size_on_screen(drag.view))
    stone = canvas.at((-130, 12)) / SMOOTHING
    post(pygame.MOUSEBUTTONDOWN, pos=tuple(stone), button=1)
    post(pygame.MOUSEMOTION, pos=(stone.x, stone.y - 50))
    shown = open_window(drag, frames=20)
    assert shown.picked == 1
    assert max(body.position.y for body in shown.stones) > 15


def test_the_mouse_is_where_it_is_seen_in_a_window_of_another_size():
    import pygame

    from pymunk_ellipse.examples.stage.window import LINE_HEIGHT, open_window

    pressed = []

    class Resized(scenes()["roll"]):
        hint = ""

        def press(self, point):
            pressed.append(point)

        def before_step(self):
            if self.steps == 0:
                # What the user does with the frame of the window.
                pygame.display.set_mode((500, 300 + LINE_HEIGHT), pygame.RESIZABLE)
            if self.steps == 4:
                post(pygame.MOUSEBUTTONDOWN, pos=(250, 150), button=1)

    left, bottom, right, top = Resized.view
    open_window(Resized, frames=4)
    (point,) = pressed
    # The middle of the window's scene is the middle of what is shown.
    assert point == pytest.approx(((left + right) / 2, (bottom + top) / 2))


def test_keys_reach_a_scene():
    import pygame

    from pymunk_ellipse.examples.stage.window import open_window

    post(pygame.KEYDOWN, key=pygame.K_LEFT)
    flippers = open_window(scenes()["pinball"], frames=60).motors
    angles = {side: motor.b.angle for side, motor in flippers.items()}
    assert angles[-1] > 0.45
    assert angles[1] > 0.0


def test_flippers_stay_up_while_they_are_held():
    pinball = scenes()["pinball"]()
    pinball.press(Vec2d(0, 0))
    angles = []
    for step in range(3 * 240):
        pinball.step()
        if step > 60:
            angles += [abs(motor.b.angle) for motor in pinball.motors.values()]
    assert min(angles) > 0.45


# Pictures


def drawn_color(space, point, view=(-50, -50, 50, 50)):
    """The colour of a point of the world when a space is drawn."""
    from pymunk_ellipse.examples.stage.canvas import SMOOTHING
    from pymunk_ellipse.examples.stage.debug_draw import SpaceCanvas

    canvas = SpaceCanvas(view, (200, 200))
    canvas.draw_space(space)
    x, y = canvas.at(point) / SMOOTHING
    return "#" + bytes(canvas.finish().get_at((round(x), round(y)))[:3]).hex()


def test_shapes_are_drawn_in_the_order_in_which_they_were_added():
    """Also where there are many, whose addresses are in any order."""
    space = pymunk_ellipse.Space()
    colors = [f"#{20 * i:02x}80{10 * i:02x}" for i in range(10)]
    for i, color in enumerate(colors):
        shape = Ellipse(space.static_body, 48 - 4 * i, 46 - 4 * i)
        shape.color = color
        space.add(shape)
    for i, color in enumerate(colors):
        assert drawn_color(space, (0, -44 + 4 * i)) == color


def test_a_body_keeps_its_colour_when_another_is_removed():
    from pymunk_ellipse.examples.stage.debug_draw import SpaceCanvas

    space = pymunk_ellipse.Space()
    shapes = []
    for x in (-30, 0, 30):
        body = pymunk.Body(1, 1)
        body.position = x, 0
        shapes.append(Ellipse(body, 9, 6))
        space.add(body, shapes[-1])
    canvas = SpaceCanvas((-50, -50, 50, 50), (100, 100))
    canvas.draw_space(space)
    before = [canvas.color_of(shape) for shape in shapes]
    space.remove(shapes[0], shapes[0].body)
    canvas.draw_space(space)
    assert len(set(before)) == 3
    assert [canvas.color_of(shape) for shape in shapes[1:]] == before[1:]


# The inspector


def reach(shape, n):
    """The support function of a shape in the world along a unit vector."""
    body = shape.body
    if isinstance(shape, Ellipse):
        local = n.rotated(-body.angle)
        return body.position.dot(n) + hypot(shape.a * local.x, shape.b * local.y)
    if isinstance(shape, pymunk.Circle):
        return body.position.dot(n) + shape.radius
    if isinstance(shape, pymunk.Segment):
        corners = shape.a, shape.b
    else:
        corners = shape.get_vertices()
    reaches = [body.local_to_world(corner).dot(n) for corner in corners]
    return max(reaches) + shape.radius


@pytest.fixture
def inspector():
    return scenes()["inspector"]()


@pytest.mark.parametrize("kind", range(4))
def test_the_steps_of_the_fit_end_at_the_contact(inspector, kind):
    """The largest gap along any normal is what they end at, however the two lie, and deep in each other too."""
    rng = random.Random(kind)
    inspector.key(str(kind + 1), True)
    first, second = inspector.bodies
    normals = [Vec2d.from_polar(1, 2 * pi * i / 2000) for i in range(2000)]
    for _ in range(60):
        way = Vec2d.from_polar(rng.uniform(0, 130), rng.uniform(-pi, pi))
        second.position = first.position + way
        second.angle = rng.uniform(-pi, pi)
        steps, _published, depth = inspector.fits()
        assert steps[-1].depth == pytest.approx(depth, abs=1e-6)
        gaps = [
            -reach(inspector.second, -n) - reach(inspector.first, n) for n in normals
        ]
        # The scan's normals are up to half of their distance off.
        assert -depth == pytest.approx(max(gaps), abs=130 * pi / 2000)
        assert -depth >= max(gaps) - 1e-6


def test_fitted_circles_touch_and_bend_as_the_ellipse(inspector):
    """Each passes through the point of the ellipse whose normal it is fitted at, with the ellipse's curvature."""
    steps, _, _ = inspector.fits()
    assert len(steps) > 2
    ellipse, body = inspector.first, inspector.bodies[0]
    for step in steps:
        local = step.normal.rotated(-body.angle)
        h = hypot(ellipse.a * local.x, ellipse.b * local.y)
        support = Vec2d(ellipse.a**2 * local.x, ellipse.b**2 * local.y) / h
        touched = step.first.center + step.first.radius * step.normal
        assert touched.get_distance(body.local_to_world(support)) < 1e-9
        assert step.first.radius == pytest.approx((ellipse.a * ellipse.b) ** 2 / h**3)
        both = step.first.center.get_distance(step.second.center)
        along = (step.second.center - step.first.center).dot(step.normal)
        depth = step.first.radius + step.second.radius - along
        assert depth == pytest.approx(step.depth)
    # In the end the normal is the line through the centres.
    assert along == pytest.approx(both)


def test_shapes_are_dragged_and_turned_in_both_panels(inspector):
    from pymunk_ellipse.examples.inspector import WIDTH

    first, second = inspector.bodies
    for panel in (0.0, WIDTH):
        place = first.position
        inspector.press(place + Vec2d(panel, 0))
        inspector.drag(place + Vec2d(panel + 7, -3))
        inspector.release()
        assert first.position == pytest.approx(place + Vec2d(7, -3))
        inspector.drag(place + Vec2d(panel + 50, 0))
        assert first.position == pytest.approx(place + Vec2d(7, -3))
        knob = inspector.knob(second)
        inspector.press(knob + Vec2d(panel, 0))
        inspector.drag(second.position + Vec2d(panel, 99))
        inspector.release()
        assert second.angle == pytest.approx(pi / 2)
        second.angle = 0.4


def test_keys_choose_the_kind_and_the_shape(inspector):
    for key, kind in ("2", pymunk.Circle), ("3", pymunk.Segment), ("1", Ellipse):
        inspector.key(key, True)
        assert isinstance(inspector.second, kind)
    b = inspector.first.b
    inspector.key("down", True)
    assert inspector.first.b < b
    for _ in range(50):
        inspector.key("up", True)
    assert inspector.first.b == inspector.first.a


def test_the_published_fit_is_shown_where_it_goes_wrong(quick_run):
    output, _ = quick_run("inspector")
    assert number_after("largest error of its depth", output) < 1e-6
    assert number_after("largest error of the published fit's depth", output) > 1.0


# The game


@pytest.fixture
def game():
    from pymunk_ellipse.examples import game

    return game


def held(game, **controls):
    return lambda _: game.Controls(**controls)


def test_game_is_played_with_keys(game, tmp_path):
    import pygame

    for key in (pygame.K_s, pygame.K_l, pygame.K_p, pygame.K_r, pygame.K_ESCAPE):
        post(pygame.KEYDOWN, key=key)
    game.play(tmp_path)
    rolled, still = game.Game(), game.Game()
    for _ in range(120):
        rolled.step(game.Controls(roll=1.0))
        still.step(game.Controls())
    assert rolled.egg.position.x > still.egg.position.x + 50.0


def test_game_draws_between_steps(game):
    played = game.Game()
    played.advance(1.5 * game.STEP, held(game, roll=1.0))
    assert played.steps == 1
    body = played.egg
    before, _ = played.before[body]
    middle = played.pose(body) @ Vec2d.zero()
    assert middle.get_distance((before + body.position) / 2.0) < 1e-9


def test_the_clock_starts_with_the_first_move_and_stops_at_the_flag(game):
    played = game.Game()
    for _ in range(10):
        played.step(game.Controls())
    assert played.seconds == 0.0
    played.step(game.Controls(roll=1.0))
    played.step(game.Controls())
    assert played.seconds == pytest.approx(2 * game.STEP)
    played.egg.position = 2760, 165
    played.space.reindex_shapes_for_body(played.egg)
    played.step(game.Controls(roll=1.0))
    assert played.won
    stopped = played.seconds
    # All coins were left behind.
    missing = len(game.COINS) * game.PENALTY
    assert stopped == pytest.approx(2 * game.STEP + missing)
    for _ in range(10):
        played.step(game.Controls(roll=1.0))
    assert played.seconds == stopped


def test_an_egg_that_falls_goes_on_at_the_last_checkpoint(game):
    played = game.Game()
    played.step(game.Controls(roll=1.0))
    for x, y in ((1500, 200), (1300, -100)):
        played.egg.position = x, y
        played.space.reindex_shapes_for_body(played.egg)
        played.step(game.Controls())
    assert played.falls == 1
    assert played.egg.position == game.CHECKPOINTS[2]


def test_a_saved_game_survives_a_restart(game, tmp_path):
    """It is loaded in another process, and goes on."""
    played = game.Game()
    for _ in range(300):
        played.step(game.autopilot(played))
    game.Shelf(tmp_path).save(played)
    code = (
        "import pathlib, pymunk_ellipse.examples.game as game; "
        f"loaded = game.Shelf(pathlib.Path({str(tmp_path)!r})).load(); "
        "loaded.step(game.Controls()); "
        "print(loaded.steps, loaded.coins, *loaded.egg.position)"
    )
    steps, coins, *place = output_of("-c", code).split()
    played.step(game.Controls())
    assert (int(steps), int(coins)) == (played.steps, played.coins)
    assert [float(x) for x in place] == pytest.approx(played.egg.position, abs=0.1)


def test_the_best_run_is_kept_and_no_worse_one(game, tmp_path):
    shelf = game.Shelf(tmp_path)
    assert shelf.best() is None
    for steps, best in (600, 600), (900, 600), (500, 500):
        played = game.Game()
        played.won, played.steps, played.coins = True, steps, len(game.COINS)
        played.track.append((1.0, 2.0, 3.0))
        shelf.keep_best(played)
        kept = game.Shelf(tmp_path).best()
        assert kept.seconds == pytest.approx(best * game.STEP)
        assert [tuple(place) for place in kept.track] == [(1.0, 2.0, 3.0)]


@pytest.mark.parametrize("text", ["", "nonsense", "[1]", '{"seconds": 3}'])
def test_files_that_are_not_the_games_are_no_games(game, tmp_path, text):
    shelf = game.Shelf(tmp_path)
    assert shelf.load() is None
    shelf.best_file.write_text(text)
    shelf.game_file.write_text(text)
    assert shelf.best() is None
    assert shelf.load() is None


def test_the_ghost_is_seen(game):
    played = game.Game()
    x, y, _angle = ghost = 300.0, 200.0, 0.5
    painter = game.Painter()
    plain = painter.paint(played, None)
    haunted = painter.paint(played, game.Best(9.0, [ghost]))
    edge = round(x), round(game.HEIGHT - y - 15)
    seen = [
        tuple(picture.get_at((edge[0], edge[1] + dy)))
        for picture in (plain, haunted)
        for dy in range(-5, 6)
    ]
    assert len(set(seen[:11])) == 1
    assert len(set(seen[11:])) > 1
