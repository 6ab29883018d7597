"""The demos and the README, run as their reader would run them."""

from __future__ import annotations

import csv
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import pymunk_ellipse.examples
from pymunk_ellipse.examples.stage.command import scenes
from pymunk_ellipse.hull import ROUNDING, VERTICES

ROOT = Path(__file__).parent.parent
EXAMPLES_PATH = Path(pymunk_ellipse.examples.__file__).parent
STUDIES = sorted(path.stem for path in (ROOT / "demos").glob("[!_]*.py"))
EXAMPLES = sorted(path.stem for path in EXAMPLES_PATH.glob("[!_]*.py"))
SCENES = [name for name in EXAMPLES if name != "game"]
README = (ROOT / "README.md").read_text("utf-8")

PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
GIF_SIGNATURE = b"GIF89a"


def python(*arguments: str | Path) -> str:
    """What Python prints when run in the project's directory with these arguments."""
    finished = subprocess.run(
        [sys.executable, *map(str, arguments)],
        cwd=ROOT,
        capture_output=True,
        encoding="utf-8",
    )
    assert finished.returncode == 0, finished.stderr
    return finished.stdout


def processor_seconds() -> float:
    """What finished processes have taken: unlike the wall clock's, not longer where others run too."""
    times = os.times()
    return times.children_user + times.children_system


@pytest.fixture(scope="module")
def quick_run(tmp_path_factory: pytest.TempPathFactory):
    """Runs a demo once, and returns what it printed and where its files are."""
    finished: dict[str, tuple[str, Path]] = {}

    def run(name: str) -> tuple[str, Path]:
        if name not in finished:
            out = tmp_path_factory.mktemp(name)
            before = processor_seconds()
            printed = python("-m", "demos", name, "--quick", "--out", out)
            assert processor_seconds() - before < 30.0
            finished[name] = printed, out
        return finished[name]

    return run


def number_after(label: str, printed: str) -> float:
    """The number that a line of output gives for this label."""
    found = re.search(re.escape(label) + r"[^:\n]*: ([-+.\de]+)$", printed, re.M)
    assert found is not None, f"no {label!r} in:\n{printed}"
    return float(found.group(1))


@pytest.mark.demo
@pytest.mark.parametrize("name", [*STUDIES, *EXAMPLES])
def test_leaves_a_picture(quick_run, name):
    printed, out = quick_run(name)
    picture = out / f"{name}.png"
    assert f"picture: {picture}" in printed
    assert picture.read_bytes().startswith(PNG_SIGNATURE)


@pytest.mark.demo
def test_pile_rests_with_its_weight_on_the_box(quick_run):
    printed, _ = quick_run("pile")
    assert number_after("kinetic energy per mass", printed) < 1.0
    assert number_after("bodies outside the box", printed) == 0
    assert number_after("contact forces", printed) == pytest.approx(1.0, rel=0.01)


@pytest.mark.demo
def test_rocking_has_the_analytic_period(quick_run):
    printed, _ = quick_run("rocking")
    rows = [line.split() for line in printed.splitlines() if " ellipse " in line]
    analytic = {tilt: float(period) for tilt, _, _, period, _, _ in rows}
    # Forty-digit quadrature of the same integral would round to these.
    assert analytic == {"0.05": 0.773639, "0.2": 0.831387, "0.5": 1.082325}
    for tilt, _, period, _, _, kept in rows:
        assert float(period) == pytest.approx(analytic[tilt], rel=1e-3)
        assert 95.0 < float(kept.rstrip("%")) < 100.5


@pytest.mark.demo
def test_rocking_polygons_come_to_rest(quick_run):
    printed, _ = quick_run("rocking")
    rows = [line.split() for line in printed.splitlines() if "-gon " in line]
    assert len(rows) == 12
    assert all(float(row[-1].rstrip("%")) < 50.0 for row in rows)


def table(path: Path) -> list[dict[str, str]]:
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


@pytest.mark.demo
def test_speed_times_every_kind_of_shape(quick_run):
    _, out = quick_run("speed")
    rows = table(out / "speed.csv")
    for semi_axes in (("14", "7"), ("20", "5")):
        kinds = [row["shapes"] for row in rows if (row["a"], row["b"]) == semi_axes]
        assert kinds[:6] == ["circles", *(f"{n}-gons" for n in (8, 12, 16, 32, 64))]
        assert "ellipses (python)" in kinds
    assert all(float(row["ms per step"]) > 0.0 for row in rows)
    assert all(
        float(row[f"ratio to {row['shapes']}"]) == 1.0
        for row in rows
        if row["shapes"] in ("circles", "8-gons", "12-gons", "32-gons")
    )


@pytest.mark.demo
def test_callbacks_are_called_as_often_on_ellipses(quick_run):
    printed, _ = quick_run("callbacks")
    calls = [float(n) for n in re.findall(r"callbacks +[0-9.]+ +([0-9.]+)", printed)]
    assert len(calls) == 2
    assert min(calls) > 0
    assert max(calls) < 2 * min(calls)


@pytest.mark.demo
def test_scaling_compares_the_cost_per_contact(quick_run):
    printed, out = quick_run("scaling")
    rows = table(out / "scaling.csv")
    for name in ("circles", "16-gons", "ellipses"):
        assert number_after(f"1000 to 500 bodies, {name}", printed) > 0.0
        sizes = [int(row["bodies"]) for row in rows if row["shapes"] == name]
        assert sizes == [100, 200, 500, 1000]
    for row in rows:
        assert int(row["bodies"]) < int(row["contacts"]) < 4 * int(row["bodies"])


@pytest.mark.demo
def test_hulls_are_compared_with_the_one_in_use(quick_run):
    _, out = quick_run("hulls")
    ratios = {row["hull"]: float(row["ratio"]) for row in table(out / "hulls.csv")}
    assert ratios[f"{VERTICES} vertices, {ROUNDING:g}"] == 1.0
    assert len(ratios) == 7


@pytest.mark.demo
@pytest.mark.parametrize("name", SCENES)
def test_scene_leaves_an_animation(quick_run, name):
    printed, out = quick_run(name)
    animation = out / f"{name}.gif"
    assert f"animation: {animation}" in printed
    assert animation.read_bytes().startswith(GIF_SIGNATURE)


@pytest.mark.demo
def test_gallery_shows_every_scene(quick_run):
    printed, _ = quick_run("gallery")
    assert number_after("scenes", printed) == len(SCENES)


@pytest.mark.demo
def test_funnel_lets_every_egg_through(quick_run):
    printed, _ = quick_run("funnel")
    eggs = number_after("eggs", printed)
    assert number_after("eggs in the basket", printed) == eggs
    assert 0.0 < number_after("mechanical energy left", printed) < 1.0


@pytest.mark.demo
def test_galton_board_spreads_like_independent_steps(quick_run):
    printed, _ = quick_run("galton")
    independent = number_after("standard deviation of independent steps", printed)
    spread = number_after("standard deviation, in pitches", printed)
    assert 0.7 * independent < spread < 1.4 * independent
    # Four times the standard error of the mean.
    mean = number_after("mean place, in pitches of the pegs", printed)
    ellipses = number_after("ellipses", printed)
    assert abs(mean) < 4.0 * spread / ellipses**0.5


@pytest.mark.demo
def test_rocker_has_the_period_of_theory(quick_run):
    printed, _ = quick_run("rocker")
    period = number_after("period by theory (s)", printed)
    assert number_after("period of the ellipse (s)", printed) == pytest.approx(
        period, rel=2e-3
    )
    assert number_after("swing left of the ellipse", printed) > 0.98
    assert number_after("swing left of the 24-gon", printed) < 0.7


@pytest.mark.demo
def test_hopper_discharges_evenly(quick_run):
    printed, _ = quick_run("hopper")
    assert number_after("grains out", printed) == number_after("grains", printed)
    first = number_after("grains per second, the first third", printed)
    second = number_after("grains per second, the second third", printed)
    assert second == pytest.approx(first, rel=0.25)


@pytest.mark.demo
def test_cart_rolls_without_much_slip(quick_run):
    printed, _ = quick_run("cart")
    assert number_after("turns of the rear wheel", printed) > 3.0
    rolled = number_after("of its circumference times the turns", printed)
    assert 0.93 < rolled < 1.02


@pytest.mark.demo
def test_cradle_hands_the_speed_on(quick_run):
    printed, _ = quick_run("cradle")
    first = number_after("speed of the first when it hits", printed)
    assert number_after("speed of the last after it", printed) == pytest.approx(
        first, rel=0.01
    )
    assert 0.95 < number_after("energy left after all hits", printed) < 1.001


@pytest.mark.demo
def test_pinball_is_played_with_exact_normals(quick_run):
    printed, _ = quick_run("pinball")
    for label in ("balls launched", "hits of bumpers", "passes through lanes"):
        assert number_after(label, printed) > 0
    assert number_after("largest error of a hit's normal (rad)", printed) < 1e-12


@pytest.mark.demo
def test_ragdolls_hold_together(quick_run):
    printed, _ = quick_run("ragdolls")
    assert number_after("widest gap of a joint ever", printed) < 3.0
    assert number_after("limbs below the floor", printed) == 0
    assert number_after("kinetic energy per mass in the end", printed) < 100.0


@pytest.mark.demo
def test_platforms_are_one_way(quick_run):
    printed, _ = quick_run("one_way")
    assert number_after("passes from below", printed) > 0
    assert number_after("landings from above", printed) > 0
    assert number_after("steps in which one that had landed was below", printed) == 0


@pytest.mark.demo
def test_mouse_picks_ellipses_not_hulls(quick_run):
    printed, _ = quick_run("drag")
    assert number_after("stones picked", printed) == 5
    assert number_after("stones in the tray", printed) == 5
    assert number_after("clicks just beside stones", printed) == 40
    assert number_after("of these, picked", printed) == 0


@pytest.mark.demo
def test_game_is_won_by_the_autopilot_and_survives_saving(quick_run):
    printed, _ = quick_run("game")
    assert number_after("flag reached", printed) == 1
    assert number_after("coins", printed) == 5
    assert number_after("distance to the egg of the loaded game", printed) < 1e-9


@pytest.fixture
def no_screen(monkeypatch):
    """pygame without a screen, a sound card or a greeting."""
    for variable in ("SDL_VIDEODRIVER", "SDL_AUDIODRIVER"):
        monkeypatch.setenv(variable, "dummy")
    monkeypatch.setenv("PYGAME_HIDE_SUPPORT_PROMPT", "1")
    return pytest.importorskip("pygame")


@pytest.mark.demo
@pytest.mark.parametrize("name", SCENES)
def test_scene_runs_in_a_window(no_screen, name):
    from pymunk_ellipse.examples.stage.window import open_window

    shown = open_window(scenes()[name], frames=3)
    assert shown.steps == 12
    assert len(shown.space.shapes) > 0


@pytest.mark.demo
def test_mouse_drags_in_a_window(no_screen):
    pygame = no_screen
    from pymunk_ellipse.examples.stage.window import SIZE, open_window

    make = scenes()["drag"]
    left, _, right, top = make.view
    pixels = SIZE / (right - left)
    stone = pixels * (-130 - left), pixels * (top - 12)
    pygame.init()
    pygame.display.set_mode((1, 1))
    for kind, place in (
        (pygame.MOUSEBUTTONDOWN, stone),
        (pygame.MOUSEMOTION, (stone[0], stone[1] - 50)),
    ):
        pygame.event.post(pygame.event.Event(kind, pos=place, button=1))

    shown = open_window(make, frames=20)
    assert shown.picked == 1
    assert max(body.position.y for body in shown.stones) > 15


@pytest.mark.demo
def test_game_is_played_with_keys(no_screen):
    pygame = no_screen
    from pymunk_ellipse.examples import game

    pygame.init()
    pygame.display.set_mode((1, 1))
    for key in (pygame.K_s, pygame.K_l, pygame.K_r, pygame.K_ESCAPE):
        pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=key))
    game.play()
    held = game.Game()
    still = game.Game()
    for _ in range(120):
        held.step(game.Controls(roll=1.0))
        still.step(game.Controls())
    assert held.player.body.position.x > still.player.body.position.x + 50.0


@pytest.mark.demo
def test_game_draws_between_steps(no_screen):
    from pymunk_ellipse.examples import game

    played = game.Game()
    played.advance(1.5 * game.STEP, lambda _: game.Controls(roll=1.0))
    assert played.steps == 1
    body = played.player.body
    position, _ = played.pose(body)
    before, _ = played.before[body]
    assert position.get_distance((before + body.position) / 2.0) < 1e-9


@pytest.mark.demo
def test_stability_keeps_all_bounds(quick_run):
    _, out = quick_run("stability")
    rows = table(out / "stability.csv")
    assert len(rows) > 10
    assert all(float(row["ellipse"]) <= float(row["bound"]) for row in rows)


@pytest.mark.demo
def test_failure_map_finds_no_wrong_contact_of_the_package(quick_run):
    printed, _ = quick_run("failure_map")
    wrong = number_after("part of the pairs for which the shipped method is", printed)
    assert wrong == 0


@pytest.mark.demo
def test_circle_fits_arrive_at_the_same_depth(quick_run):
    _, out = quick_run("circle_fit")
    rows = [row for row in table(out / "circle_fit.csv") if row["sweep"] == "4"]
    assert len(rows) == 4
    assert all(abs(float(row["depth off"])) < 1e-12 for row in rows)


@pytest.mark.demo
def test_ellipses_adsorb_and_pack_more_densely_than_circles(quick_run):
    for name, circles, aspect_ratio in ("rsa", 0.547, "1.85"), ("packing", 0.84, "1.4"):
        printed, out = quick_run(name)
        assert number_after("circles, of", printed) == pytest.approx(circles, rel=0.05)
        rows = {row["aspect ratio"]: row for row in table(out / f"{name}.csv")}
        key = "coverage" if name == "rsa" else "density"
        assert float(rows[aspect_ratio][key]) > float(rows["1.0"][key]) + 0.01


def test_list_names_every_demo_with_its_purpose():
    listed = python("-m", "demos", "--list")
    lines = [
        line.split(maxsplit=1) for line in listed.splitlines() if line.startswith("  ")
    ]
    assert [name for name, _ in lines] == STUDIES + EXAMPLES
    assert all(purpose.endswith(".") for _, purpose in lines)


def test_window_is_for_scenes():
    finished = subprocess.run(
        [sys.executable, "-m", "demos", "pile", "--window"],
        cwd=ROOT,
        capture_output=True,
        encoding="utf-8",
    )
    assert finished.returncode == 2
    assert "--window" in finished.stderr


def test_unknown_demo_is_refused():
    finished = subprocess.run(
        [sys.executable, "-m", "demos", "nonsense"],
        cwd=ROOT,
        capture_output=True,
        encoding="utf-8",
    )
    assert finished.returncode == 2
    assert "nonsense" in finished.stderr
    assert all(name in finished.stderr for name in STUDIES)


def test_readme_example_rocks():
    (example,) = re.findall(r"^```python\n(.*?)^```", README, re.M | re.S)
    angles = [float(line) for line in python("-c", example).split()]
    assert len(angles) == 10
    assert max(map(abs, angles)) < 0.205
    # Ten looks in 2.5 seconds, three periods: on both sides, and as far out late as early.
    assert min(angles[5:]) < -0.15
    assert max(angles[5:]) > 0.15


def test_readme_and_ci_run_the_same_tests():
    (command,) = re.findall(r"^    (pip install .*pytest.*)$", README, re.M)
    assert command in (ROOT / ".ci" / "run").read_text("utf-8").splitlines()


def test_readme_pictures_are_there_and_small():
    pictures = re.findall(r"!\[.*?\]\((.*?)\)", README)
    assert pictures
    for picture in pictures:
        assert (ROOT / picture).read_bytes().startswith(PNG_SIGNATURE)
        assert (ROOT / picture).stat().st_size < 200_000
