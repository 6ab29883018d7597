"""The demos and the README, run as their reader would run them."""

from __future__ import annotations

import csv
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
from running import (
    GIF_SIGNATURE,
    PNG_SIGNATURE,
    ROOT,
    number_after,
    output_of,
    quick_output,
)

from pymunk_ellipse.examples.stage.command import EXAMPLES, SECONDS, purposes
from pymunk_ellipse.hull import ROUNDING, VERTICES

STUDIES = sorted(path.stem for path in (ROOT / "demos").glob("[!_]*.py"))
README = (ROOT / "README.md").read_text("utf-8")


@pytest.fixture(scope="module")
def quick_run(tmp_path_factory):
    """Runs a study once, and returns what it output and where its files are."""
    finished = {}

    def run(name):
        if name not in finished:
            out = tmp_path_factory.mktemp(name)
            command = "-m", "demos", name, "--quick", "--out", out
            finished[name] = quick_output(*command), out
        return finished[name]

    return run


@pytest.mark.demo
@pytest.mark.parametrize("name", STUDIES)
def test_leaves_a_picture(quick_run, name):
    output, out = quick_run(name)
    picture = out / f"{name}.png"
    assert f"picture: {picture}" in output
    assert picture.read_bytes().startswith(PNG_SIGNATURE)


@pytest.mark.demo
def test_pile_rests_with_its_weight_on_the_box(quick_run):
    output, _ = quick_run("pile")
    assert number_after("kinetic energy per mass", output) < 1.0
    assert number_after("bodies outside the box", output) == 0
    assert number_after("contact forces", output) == pytest.approx(1.0, rel=0.01)


@pytest.mark.demo
def test_rocking_has_the_analytic_period(quick_run):
    output, _ = quick_run("rocking")
    rows = [line.split() for line in output.splitlines() if " ellipse " in line]
    analytic = {tilt: float(period) for tilt, _, _, period, _, _ in rows}
    # Forty-digit quadrature of the same integral would round to these.
    assert analytic == {"0.05": 0.773639, "0.2": 0.831387, "0.5": 1.082325}
    for tilt, _, period, _, _, kept in rows:
        assert float(period) == pytest.approx(analytic[tilt], rel=1e-3)
        assert 95.0 < float(kept.rstrip("%")) < 100.5


@pytest.mark.demo
def test_rocking_polygons_come_to_rest(quick_run):
    output, _ = quick_run("rocking")
    rows = [line.split() for line in output.splitlines() if "-gon " in line]
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
    output, _ = quick_run("callbacks")
    calls = [float(n) for n in re.findall(r"callbacks +[0-9.]+ +([0-9.]+)", output)]
    assert len(calls) == 2
    assert min(calls) > 0
    assert max(calls) < 2 * min(calls)


@pytest.mark.demo
def test_scaling_compares_the_cost_per_contact(quick_run):
    output, out = quick_run("scaling")
    rows = table(out / "scaling.csv")
    for name in ("circles", "16-gons", "ellipses"):
        assert number_after(f"1000 to 500 bodies, {name}", output) > 0.0
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
def test_the_ellipse_costs_least_and_errs_least(quick_run):
    _, out = quick_run("cost_and_error")
    rows = table(out / "cost_and_error.csv")
    off = [float(row["normal off (degrees), median"]) for row in rows]
    assert [row["shape"] for row in rows] == [
        "8-gon",
        "16-gon",
        "32-gon",
        "64-gon",
        "ellipse",
    ]
    assert off == sorted(off, reverse=True)
    assert off[-1] < 1e-9
    assert off[-2] > 0.5


@pytest.mark.demo
def test_gallery_shows_every_scene(quick_run):
    output, _ = quick_run("gallery")
    assert number_after("scenes", output) == len(purposes(EXAMPLES)) - 2


@pytest.mark.demo
def test_stability_keeps_all_bounds(quick_run):
    _, out = quick_run("stability")
    rows = table(out / "stability.csv")
    assert len(rows) > 10
    assert all(float(row["ellipse"]) <= float(row["bound"]) for row in rows)


@pytest.mark.demo
def test_exact_impacts_are_charted_as_what_they_are(quick_run):
    _, out = quick_run("speed_accuracy")
    rows = {row["shape"]: row for row in table(out / "speed_accuracy_scenes.csv")}
    plain, exact = rows["ellipse"], rows["ellipse, exact impacts"]
    assert float(exact["outcome of an elastic hit, off by"]) < 1e-9
    bounces = "pose after 2 to 4 bounces, off by (in a)"
    assert float(exact[bounces]) < 0.1 * float(plain[bounces])
    gas = "energy of an elastic gas, off in a minute by"
    assert float(exact[gas]) < 0.01
    assert float(rows["32-gon"][gas]) > 1.0


@pytest.mark.demo
def test_failure_map_finds_no_wrong_contact_of_the_package(quick_run):
    output, _ = quick_run("failure_map")
    wrong = number_after("part of the pairs for which the shipped method is", output)
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
        output, out = quick_run(name)
        assert number_after("circles, of", output) == pytest.approx(circles, rel=0.05)
        rows = {row["aspect ratio"]: row for row in table(out / f"{name}.csv")}
        key = "coverage" if name == "rsa" else "density"
        assert float(rows[aspect_ratio][key]) > float(rows["1.0"][key]) + 0.01


def test_list_tells_what_each_is_and_how_long_it_takes():
    listed = output_of("-m", "demos", "--list")
    assert output_of("-m", "demos") == listed
    rows = [
        line.split(maxsplit=3) for line in listed.splitlines() if line.startswith("  ")
    ]
    assert [name for name, *_ in rows] == STUDIES + sorted(purposes(EXAMPLES))
    assert all(float(time) > 0 and unit in ("s", "min") for _, time, unit, _ in rows)
    assert all(purpose.endswith(".") for *_, purpose in rows)


def test_none_takes_longer_than_three_minutes():
    seconds = json.loads((ROOT / "demos" / SECONDS).read_text("utf-8"))
    assert sorted(seconds) == STUDIES
    assert max(seconds.values()) < 180


@pytest.mark.demo
def test_demos_run_the_examples_as_well(tmp_path):
    output_of("-m", "demos", "roll", "--quick", "--out", tmp_path)
    assert (tmp_path / "roll.gif").read_bytes().startswith(GIF_SIGNATURE)


@pytest.mark.parametrize(
    "arguments",
    [
        ("pile", "--window"),
        ("pile", "--full"),
        ("roll", "--full"),
        ("roll", "--jobs=2"),
    ],
)
def test_options_are_for_those_that_have_them(arguments):
    finished = subprocess.run(
        [sys.executable, "-m", "demos", *arguments],
        cwd=ROOT,
        capture_output=True,
        encoding="utf-8",
    )
    assert finished.returncode == 2
    assert arguments[0] in finished.stderr


def test_what_is_missing_is_named_with_its_extra():
    code = (
        "import runpy, sys; sys.modules['matplotlib'] = None; "
        "sys.argv[1:] = ['pile']; runpy.run_module('demos', run_name='__main__')"
    )
    finished = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, encoding="utf-8"
    )
    assert finished.returncode == 1
    assert "pile needs matplotlib" in finished.stderr
    assert "pymunk-ellipse[demos]" in finished.stderr
    assert "Traceback" not in finished.stderr


@pytest.mark.demo
def test_the_opening_is_an_animation_for_a_readme(quick_run):
    """Whole runs have five times as many frames."""
    _, out = quick_run("opening")
    animation = out / "opening.gif"
    assert animation.read_bytes().startswith(GIF_SIGNATURE)
    assert 5 * animation.stat().st_size < 2_000_000


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


def test_readme_and_ci_run_the_same_tests():
    (command,) = re.findall(r"^    (pip install .*pytest.*)$", README, re.M)
    assert command in (ROOT / ".ci" / "run").read_text("utf-8").splitlines()
