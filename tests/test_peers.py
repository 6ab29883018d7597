"""The comparison with other libraries: what it takes for the truth, what it finds in each, and what it does without them."""

import csv
import json
import os
import subprocess
import sys
import warnings
from functools import partial
from pathlib import Path

import numpy as np
import pymunk
import pytest

pytest.importorskip("matplotlib", reason="needs the extra demos")

from demos import peers, pile, rocking
from demos._box import STEP, filled_box
from demos._builders import add_gas, kinetic_energy
from demos._methods import Pairs, exact_contacts
from demos._peers_pairs import (
    CASES,
    Case,
    errors,
    methods_of_pymunk,
    placed,
    polygons,
)
from demos._peers_scenes import (
    METRE,
    engines_of_pymunk,
    overlaps,
)

ROOT = Path(__file__).parent.parent
pytestmark = pytest.mark.demo

with warnings.catch_warnings():
    # Raised as errors, those of its import would make Box2D crash.
    warnings.simplefilter("ignore")
    INSTALLED = {module.__name__: module for module in peers.installed()}


def reference_pairs():
    """The overlapping ellipses of contacts.json, whose contacts are from arithmetic with 40 digits."""
    cases = json.loads((ROOT / "tests" / "contacts.json").read_text("utf-8"))["cases"]
    numbers, exact = [], []
    for case in cases:
        if case["kind"] != "ellipse" or case["depth"] <= 0.0:
            continue
        one, two = case["ellipse"], case["other"]
        turn = np.exp(-1j * one["angle"])
        offset = turn * complex(two["x"] - one["x"], two["y"] - one["y"])
        along = turn * np.exp(1j * two["angle"])
        normal = turn * complex(*case["normal"])
        axes = one["a"], one["b"], two["a"], two["b"]
        numbers.append((*axes, along.real, along.imag, offset.real, offset.imag))
        exact.append((case["depth"], normal.real, normal.imag))
    assert len(numbers) > 30
    return Pairs(np.array(numbers), np.array(exact), np.array(exact)[:, 1:])


def test_truth_agrees_with_the_reference():
    pairs = reference_pairs()
    off = exact_contacts(pairs.numbers) - pairs.exact
    assert np.max(np.abs(off[:, 0])) < 1e-13
    assert np.max(np.abs(off[:, 1:])) < 1e-7


def test_cases_are_as_deep_as_they_say():
    for case in CASES:
        pairs = case.pairs(50)
        depths = pairs.exact[:, 0]
        assert depths.min() > 0.0
        assert depths.max() < case.largest * (1.0 + 1e-9)
        assert np.all(pairs.numbers[:, :4] == [case.aspect_ratio, 1.0] * 2)


def test_missed_and_wrong_contacts_are_counted():
    exact = np.array([[0.1, 1.0, 0.0]] * 5)
    pairs = Pairs(np.ones((5, 8)), exact, exact[:, 1:])
    found = np.array([[0.1, 1.0, 0.0, 0.0]] * 5)
    found[1] = np.nan
    found[2, 0] = 0.15
    # Out of the plane.
    found[3, 1:] = np.sqrt(0.5), 0.0, np.sqrt(0.5)
    depth_off, normal_off, missed, wrong = errors(found, pairs)
    assert (missed, wrong) == (1, 2)
    assert depth_off == pytest.approx([0.0, 0.1, 0.05, 0.0, 0.0])
    assert normal_off == pytest.approx([0.0, np.pi / 2, 0.0, np.pi / 4, 0.0])


def adapter(library):
    """The module for a peer, if that is installed."""
    name = f"demos.{peers.PEERS[library]}"
    if name not in INSTALLED:
        pytest.skip(f"{library} is not installed")
    return INSTALLED[name]


def worst(method, pairs):
    depth_off, normal_off, missed, _wrong = errors(method.prepare(pairs).found, pairs)
    assert missed == 0
    return depth_off.max(), normal_off.max()


def test_the_package_agrees_with_the_reference():
    ours, *_ = methods_of_pymunk()
    depth, normal = worst(ours, reference_pairs())
    assert depth < 1e-9
    assert normal < 2e-6


# Depths as good as the tolerance that the peer promises, 1e-6, and normals of which the error's square is.
# The iterations that a peer has by default are not always enough for it.
@pytest.mark.parametrize(
    ("library", "number", "depth", "normal"),
    [
        ("mujoco", 100, 2e-6, 1e-2),
        ("mujoco", 200, 1e-7, 1e-3),
        ("coal", 1000, 5e-6, 1e-2),
        ("fcl", 0, 2e-6, 1e-2),
    ],
)
def test_peer_agrees_with_the_reference(library, number, depth, normal):
    methods = adapter(library).pair_methods()
    (method,) = [method for method in methods if method.number == number]
    for pairs in reference_pairs(), deep_and_slender_pairs():
        depth_off, normal_off = worst(method, pairs)
        assert depth_off < depth
        assert normal_off < normal


def deep_and_slender_pairs():
    """Pairs of which ellipsoids whose third semi-axis were b would touch elsewhere."""
    pairs = Case(20.0, 0.3, 1.5).pairs(60)
    deep = pairs.exact[:, 0] > 0.3
    assert np.sum(deep) > 30
    return Pairs(pairs.numbers[deep], pairs.exact[deep], pairs.warm[deep])


def test_polygons_of_box2d_and_pymunk_are_the_same():
    (method,) = adapter("Box2D").pair_methods()
    pairs = CASES[0].pairs(200)
    theirs = method.prepare(pairs).found
    ours = polygons(method.number)(pairs).found
    assert np.mean(np.isfinite(ours)) > 0.2
    assert np.all(np.isfinite(theirs) == np.isfinite(ours))
    # Box2D calculates with single precision, and stays with a face where another one is a little better.
    same = np.isclose(theirs, ours, atol=1e-4, equal_nan=True).all(axis=1)
    assert np.mean(same) > 0.95


ENGINES = engines_of_pymunk()
for module in INSTALLED.values():
    if hasattr(module, "engines"):
        ENGINES += module.engines()


@pytest.mark.parametrize("engine", ENGINES, ids=str)
def test_engine_takes_a_scene_over(engine):
    space = pymunk.Space()
    add_gas(space, engine.make)
    # Other lengths than the scene's.
    world = engine.translate(space, 1.0 / 240.0, 2.0)
    before = [(*body.position, body.angle, *body.velocity) for body in space.bodies]
    start = kinetic_energy(space)
    world.step(1)
    world.write_back()
    assert kinetic_energy(space) == pytest.approx(start, rel=1e-5)
    for body, (x, y, angle, vx, vy) in zip(space.bodies, before, strict=True):
        assert tuple(body.velocity) == pytest.approx((vx, vy), rel=1e-5)
        assert body.angle == pytest.approx(angle, abs=1e-5)
        moved = x + vx / 240.0, y + vy / 240.0
        assert tuple(body.position) == pytest.approx(moved, rel=1e-5)


@pytest.mark.parametrize("engine", ENGINES, ids=str)
def test_engine_keeps_a_pile_in_its_box(engine):
    box = filled_box(partial(engine.make, a=pile.A, b=pile.B), pile.A, 20, 4)
    world = engine.translate(box.space, STEP, METRE)
    highest = max(body.position.y for body in box.bodies)
    world.step(150)
    world.write_back()
    assert box.outside == 0
    assert max(body.position.y for body in box.bodies) < 0.8 * highest


@pytest.mark.parametrize("engine", ENGINES, ids=str)
def test_engine_lets_a_flat_one_fall_to_the_floor(engine):
    if engine.shape == "circles":
        pytest.skip("circles have no flat side")
    make = partial(engine.make, a=rocking.A, b=rocking.B)
    space, body = rocking.scene(make, 0.0, friction=1.0)
    body.position += (0.0, rocking.B)
    world = engine.translate(space, rocking.STEP, METRE)
    world.step(24)
    world.write_back()
    seconds = 24 * rocking.STEP
    fallen = rocking.GRAVITY * seconds**2 / 2.0
    # By how an engine starts, half a step's velocity more or less.
    start = rocking.GRAVITY * rocking.STEP * seconds / 2.0
    assert body.position.y == pytest.approx(2.0 * rocking.B - fallen, abs=1.01 * start)
    world.step(240)
    world.write_back()
    # Box2D's polygons have a skin of a length that is fixed.
    assert body.position.y == pytest.approx(rocking.B, abs=0.15 * rocking.B)
    assert np.all(overlaps(space) < 0.05 * rocking.B)


def test_overlaps_are_those_of_ellipses_not_of_hulls():
    ellipses, circles, *_ = engines_of_pymunk()
    for engine in ellipses, circles:
        space = pymunk.Space()
        add_gas(space, engine.make)
        assert len(overlaps(space)) == 0
        first, second, *_ = space.bodies
        first.angle = second.angle = 0.0
        reach = 20.0 if engine is ellipses else 2.0 * np.sqrt(50.0)
        second.position = first.position.x + reach - 0.25, first.position.y
        assert overlaps(space) == pytest.approx([0.25], abs=1e-9)


def without(*libraries):
    """Python code after which these cannot be imported."""
    return f"import sys; sys.modules.update(dict.fromkeys({libraries!r})); "


def test_missing_peers_are_left_out_by_name(tmp_path):
    code = without(*peers.PEERS) + (
        "from pathlib import Path; from demos.peers import run; "
        f"run(Path({str(tmp_path)!r}), quick=True)"
    )
    finished = subprocess.run(
        [sys.executable, "-c", code],
        cwd=ROOT,
        env=os.environ,
        capture_output=True,
        encoding="utf-8",
    )
    assert finished.returncode == 0, finished.stderr
    for library in peers.PEERS:
        assert f"left out: {library} (not installed)" in finished.stdout
    with open(tmp_path / "peers_pairs.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    found = {row["method"].partition(",")[0] for row in rows}
    assert found == {"pymunk_ellipse", "pymunk"}
    with open(tmp_path / "peers_scenes.csv", newline="", encoding="utf-8") as file:
        scenes = list(csv.DictReader(file))
    assert {row["engine"] for row in scenes} == {"pymunk_ellipse", "pymunk"}
    for name in "peers", "peers_scenes", "peers_small":
        assert (tmp_path / f"{name}.png").stat().st_size < 200_000


def test_a_peer_that_lacks_what_it_needs_is_not_hidden(monkeypatch):
    def fail(name):
        raise ModuleNotFoundError("No module named 'other'", name="other")

    monkeypatch.setattr(peers, "import_module", fail)
    with pytest.raises(ModuleNotFoundError, match="other"):
        peers.installed()


def test_placed_pairs_are_where_the_numbers_say():
    first, second = placed(CASES[1].pairs(3))
    assert np.all(first[:, 2:] == 0.0)
    assert second[:, :2] == pytest.approx(first[:, :2])
