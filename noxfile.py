"""The tests on every supported pymunk, and of the package as it is released; each in a new environment.

`nox` runs all of it and ends with a table; `nox -l` lists the sessions.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import nox

nox.options.default_venv_backend = "venv"
nox.options.reuse_venv = "no"

PYMUNKS = ("7.0.1", "7.1.0", "7.2.0", "7.3.1")
ROOT = Path(__file__).parent


@nox.session
@nox.parametrize("backend", ["python", "compiled"], ids=["python", "compiled"])
@nox.parametrize("pymunk", PYMUNKS, ids=PYMUNKS)
def tests(session: nox.Session, pymunk: str, backend: str) -> None:
    """Run the tests on one pymunk, with the library and where it is not there."""
    session.install("-e", ".[test]", f"pymunk=={pymunk}")
    if backend == "python":
        for library in ROOT.glob("pymunk_ellipse/_kernel-*"):
            library.unlink()
    # The demos need matplotlib, and show nothing that depends on pymunk's version.
    session.run(
        *("python", "-m", "pytest", "-q", "--ignore=tests/test_demos.py"),
        *session.posargs,
    )


@nox.session
def release(session: nox.Session) -> None:
    """Build sdist and wheel, and test the wheel alone with the tests of the sdist."""
    session.install("build")
    place = Path(session.create_tmp())
    shutil.rmtree(place, ignore_errors=True)
    session.run("python", "-m", "build", "--outdir", str(place), str(ROOT))
    (wheel,) = place.glob("*.whl")
    (sdist,) = place.glob("*.tar.gz")
    session.run("python", "-m", "pip", "uninstall", "-yq", "build", silent=True)
    session.install(f"{wheel}[test,demos]")

    shutil.unpack_archive(sdist, place)
    unpacked = place / sdist.name.removesuffix(".tar.gz")
    # So that it is the wheel that is tested.
    shutil.rmtree(unpacked / "pymunk_ellipse")
    session.chdir(unpacked)
    session.run("python", "-m", "pytest", "-q", "tests", *session.posargs)
