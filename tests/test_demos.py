"""The demos and the README, run as their reader would run them."""

from __future__ import annotations

import csv
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
DEMOS = sorted(path.stem for path in (ROOT / "demos").glob("[!_]*.py"))
README = (ROOT / "README.md").read_text("utf-8")

PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"


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


@pytest.fixture(scope="module")
def quick_run(tmp_path_factory: pytest.TempPathFactory):
    """Runs a demo once, and returns what it printed and where its files are."""
    finished: dict[str, tuple[str, Path]] = {}

    def run(name: str) -> tuple[str, Path]:
        if name not in finished:
            out = tmp_path_factory.mktemp(name)
            printed = python("-m", "demos", name, "--quick", "--out", out)
            finished[name] = printed, out
        return finished[name]

    return run


def number_after(label: str, printed: str) -> float:
    """The number that a line of output gives for this label."""
    found = re.search(re.escape(label) + r"[^:\n]*: ([-+.\de]+)$", printed, re.M)
    assert found is not None, f"no {label!r} in:\n{printed}"
    return float(found.group(1))


@pytest.mark.demo
@pytest.mark.timeout(30)
@pytest.mark.parametrize("name", DEMOS)
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


@pytest.mark.demo
def test_speed_times_every_kind_of_shape(quick_run):
    _, out = quick_run("speed")
    with open(out / "speed.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    kinds = [row["shapes"] for row in rows]
    assert kinds[:6] == ["circles", *(f"{n}-gons" for n in (8, 12, 16, 32, 64))]
    assert "ellipses (python)" in kinds
    assert all(float(row["ms per step"]) > 0.0 for row in rows)
    assert all(
        float(row[f"ratio to {row['shapes']}"]) == 1.0
        for row in rows
        if row["shapes"] in ("circles", "8-gons", "32-gons")
    )


def test_list_names_every_demo_with_its_purpose():
    lines = [
        line.split(maxsplit=1) for line in python("-m", "demos", "--list").splitlines()
    ]
    assert [name for name, _ in lines] == DEMOS
    assert all(purpose.endswith(".") for _, purpose in lines)


def test_unknown_demo_is_refused():
    finished = subprocess.run(
        [sys.executable, "-m", "demos", "nonsense"],
        cwd=ROOT,
        capture_output=True,
        encoding="utf-8",
    )
    assert finished.returncode == 2
    assert "nonsense" in finished.stderr
    assert all(name in finished.stderr for name in DEMOS)


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


def test_readme_picture_is_there_and_small():
    (picture,) = re.findall(r"!\[.*?\]\((.*?)\)", README)
    assert (ROOT / picture).read_bytes().startswith(PNG_SIGNATURE)
    assert (ROOT / picture).stat().st_size < 150_000
