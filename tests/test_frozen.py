"""The package in programs that bring it along: what PyInstaller takes, and what is left of a zip."""

import runpy
import zipfile
from importlib.metadata import entry_points
from pathlib import Path

import pytest
from processes import run_code

import pymunk_ellipse
from pymunk_ellipse.contacts.machine import own_library_name

PACKAGE = Path(pymunk_ellipse.__file__).parent
LIBRARY = PACKAGE / own_library_name()


@pytest.fixture(autouse=True)
def built():
    if not LIBRARY.exists():
        pytest.skip("there is no library for this machine")


def test_frozen_programs_take_the_library_along():
    ((folder,),) = (
        entry.load()()
        for entry in entry_points(group="pyinstaller40")
        if entry.module.startswith("pymunk_ellipse")
    )
    hook = runpy.run_path(str(Path(folder, "hook-pymunk_ellipse.py")))
    assert hook["binaries"] == [(str(LIBRARY), "pymunk_ellipse")]


def test_what_a_zip_unpacks_is_removed(tmp_path):
    archive = tmp_path / "program.zip"
    with zipfile.ZipFile(archive, "w") as file:
        for path in PACKAGE.rglob("*"):
            file.write(path, path.relative_to(PACKAGE.parent))
    unpacked = tmp_path / "unpacked"
    unpacked.mkdir()
    code = f"""
        from pathlib import Path
        import pymunk_ellipse
        assert pymunk_ellipse.backend() == "compiled"
        print(pymunk_ellipse.__file__)
        print(len(list(Path({str(unpacked)!r}).iterdir())))
    """
    variables = dict.fromkeys(("TMPDIR", "TEMP", "TMP"), str(unpacked))
    printed, _ = run_code(code, cwd=tmp_path, PYTHONPATH=str(archive), **variables)
    file, count = printed.split()
    assert file.startswith(str(archive))
    assert count == "1"
    assert not list(unpacked.iterdir())
