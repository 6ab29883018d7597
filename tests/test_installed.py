"""The package where it is not a folder of sources: in a zip, in a frozen program, without a home."""

import os
import runpy
import subprocess
import sys
import zipfile
from importlib.metadata import entry_points
from pathlib import Path

import pytest

import pymunk_ellipse
from pymunk_ellipse.contacts import library
from pymunk_ellipse.contacts.machine import own_library_name

PACKAGE = Path(pymunk_ellipse.__file__).parent

USES_IT = """
import pymunk, pymunk_ellipse
space = pymunk_ellipse.Space()
space.gravity = 0, -9
body = pymunk.Body(1, pymunk_ellipse.moment_for_ellipse(1, 2, 1))
space.add(body, pymunk_ellipse.Ellipse(body, 2, 1))
space.add(pymunk.Segment(space.static_body, (-9, -1.5), (9, -1.5), 0))
for _ in range(120):
    space.step(0.01)
assert abs(body.position.y + 0.5) < 0.1
print(pymunk_ellipse.__file__)
print(pymunk_ellipse.backend())
"""


def run(code, *, check=True, **variables):
    """Run code in another Python; returns what it prints, by lines, and its warnings."""
    environment = os.environ | variables
    environment.pop("PYMUNK_ELLIPSE_BACKEND", None)
    done = subprocess.run(
        [sys.executable, "-c", code],
        env=environment,
        check=check,
        capture_output=True,
        text=True,
        timeout=120,
    )
    return done.stdout.split(), done.stderr


@pytest.fixture
def built():
    if library.load() is None:
        pytest.skip("there is no library for this machine")


def zipped(place, **instead):
    """The package in a zip; some of its files may be replaced, by their name in the package."""
    with zipfile.ZipFile(place, "w") as archive:
        for path in PACKAGE.rglob("*"):
            if path.is_file() and "__pycache__" not in path.parts:
                name = path.relative_to(PACKAGE.parent).as_posix()
                archive.writestr(name, instead.get(path.name, path.read_bytes()))
    return str(place)


def from_zip(place):
    return f"import sys; sys.path.insert(0, {place!r})\n{USES_IT}"


def test_from_a_zip(built, tmp_path):
    place = zipped(tmp_path / "package.zip")
    (file, backend), warnings = run(from_zip(place))
    assert file.startswith(place)
    assert backend == "compiled"
    assert not warnings


def test_what_is_unpacked_is_removed(built, tmp_path):
    place = zipped(tmp_path / "package.zip")
    folder = tmp_path / "temporary"
    folder.mkdir()
    run(from_zip(place), TMPDIR=str(folder))
    assert not list(folder.iterdir())


@pytest.mark.parametrize("text", [b"", b"no library", b"\x7fELF and no more"])
def test_damaged_in_a_zip(built, tmp_path, text):
    place = zipped(tmp_path / "package.zip", **{own_library_name(): text})
    (_file, backend), warnings = run(from_zip(place))
    assert backend == "python"
    assert "RuntimeWarning: pymunk_ellipse works in Python, many times slower" in (
        warnings
    )
    assert "does not load" in warnings


def test_other_sources_in_a_zip(built, tmp_path):
    changed = (PACKAGE / "contacts" / "resolver.py").read_bytes() + b"\n# changed\n"
    place = zipped(tmp_path / "package.zip", **{"resolver.py": changed})
    (_file, backend), warnings = run(from_zip(place))
    assert backend == "python"
    assert "was built from other sources than those at hand" in warnings


def test_without_a_home(built):
    (_file, backend), warnings = run(
        USES_IT, HOME=os.devnull, USERPROFILE=os.devnull, XDG_CACHE_HOME=os.devnull
    )
    assert backend == "compiled"
    assert not warnings


def test_frozen_programs_take_the_library_along(built):
    (found,) = (
        entry.load()()
        for entry in entry_points(group="pyinstaller40")
        if entry.module.startswith("pymunk_ellipse")
    )
    (folder,) = found
    hook = runpy.run_path(str(Path(folder, "hook-pymunk_ellipse.py")))
    ((source, target),) = hook["binaries"]
    assert Path(source) == PACKAGE / own_library_name()
    assert target == "pymunk_ellipse"
