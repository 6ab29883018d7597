"""Builds the package as it is released, and tests that on every supported pymunk and Python; each in a new environment.

`nox` runs all of it and ends with a table; `nox -l` lists the sessions. Nothing but dist/ changes in
the checkout: what is tested is the wheel, with the tests of the sdist.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import nox

nox.options.default_venv_backend = "venv"
nox.options.reuse_venv = "no"

PYMUNKS = ("7.0.1", "7.1.0", "7.2.0", "7.3.1")
PYTHONS = ("3.10", "3.11", "3.12", "3.13", "3.14")
ROOT = Path(__file__).parent
DIST = ROOT / "dist"


@nox.session
def build(session: nox.Session) -> None:
    """Build the sdist, and from it one wheel for all platforms, into dist/, unless those there are newer than all sources."""
    listed = session.run(
        *("git", "ls-files", "--cached", "--others", "--exclude-standard"),
        silent=True,
        external=True,
    )
    changed = max(
        file.stat().st_mtime
        for file in (ROOT / name for name in str(listed).splitlines())
        if file.exists()
    )
    made = [*DIST.glob("*.whl"), *DIST.glob("*.tar.gz")]
    if len(made) == 2 and all(file.stat().st_mtime > changed for file in made):
        session.skip("dist/ is newer than the sources")
    session.install("build")
    shutil.rmtree(DIST, ignore_errors=True)
    session.run(
        *("python", "-m", "build", "--outdir", str(DIST), str(ROOT)),
        env={
            "PYMUNK_ELLIPSE_ALL_PLATFORMS": "1",
            "PYMUNK_ELLIPSE_REQUIRE_LIBRARY": "1",
        },
    )


def built(session: nox.Session, kind: str) -> Path:
    """The one file of a kind in dist/."""
    found = list(DIST.glob(f"*{kind}"))
    if len(found) != 1:
        session.error(
            f"nox -s build makes what is tested: {len(found)} {kind} in dist/"
        )
    return found[0]


def install(session: nox.Session, extras: str, *others: str) -> None:
    """Install the wheel with extras, and what else is named."""
    session.install(f"{built(session, '.whl')}[{extras}]", *others)


def run_tests(session: nox.Session, *arguments: str) -> None:
    """Run the sdist's tests, and the doctests, on what is installed."""
    sdist = built(session, ".tar.gz")
    place = Path(session.create_tmp())
    shutil.unpack_archive(sdist, place)
    unpacked = place / sdist.name.removesuffix(".tar.gz")
    # So that it is the wheel that is tested.
    shutil.rmtree(unpacked / "pymunk_ellipse")
    session.chdir(unpacked)
    session.run(
        *("python", "-m", "pytest", "-q", "tests", "--pyargs", "pymunk_ellipse"),
        *(*arguments, *session.posargs),
    )


# The demos need matplotlib, and show nothing that depends on pymunk's version.
WITHOUT_DEMOS = "--ignore=tests/test_demos.py"


@nox.session(requires=["build"])
@nox.parametrize("backend", ["python", "compiled"], ids=["python", "compiled"])
@nox.parametrize("pymunk", PYMUNKS, ids=PYMUNKS)
def tests(session: nox.Session, pymunk: str, backend: str) -> None:
    """Run the tests on one pymunk, with the library and where it is not there."""
    install(session, "test", f"pymunk=={pymunk}")
    if backend == "python":
        # Isolated from the checkout: the library goes from this session's environment.
        session.run("python", "-I", "-c", REMOVE_LIBRARY)
    run_tests(session, WITHOUT_DEMOS)


REMOVE_LIBRARY = """
import sys
from pathlib import Path
import pymunk_ellipse
package = Path(pymunk_ellipse.__file__).parent
assert package.is_relative_to(sys.prefix)
for library in package.glob("_kernel-*"):
    library.unlink()
assert pymunk_ellipse.backend() == "python"
"""


@nox.session(python=PYTHONS, requires=["build"])
def pythons(session: nox.Session) -> None:
    """Run the tests on one Python."""
    install(session, "test")
    run_tests(session, WITHOUT_DEMOS)


@nox.session(requires=["build"])
def everything(session: nox.Session) -> None:
    """Run all tests: also those of the demos, of sweeps on a cluster and of the code in the documentation."""
    install(session, "test,demos,cluster")
    run_tests(session, "docs", "README.md")


@nox.session(requires=["build"])
def alone(session: nox.Session) -> None:
    """Use the wheel with nothing beside it but what it requires, and say how large it is."""
    session.install(str(built(session, ".whl")))
    session.run("python", "-I", str(ROOT / "tests" / "small_program.py"))
    session.run("python", "-c", SIZE)


SIZE = """
from importlib.metadata import files
sizes = {file: file.locate().stat().st_size for file in files("pymunk-ellipse")}
bytecode = sum(size for file, size in sizes.items() if file.suffix == ".pyc")
own = sum(sizes.values()) - bytecode
print(f"{own} bytes are installed, and {bytecode} of bytecode")
assert own < 1_000_000
"""


@nox.session(requires=["build"])
def selfcheck(session: nox.Session) -> None:
    """Run the library of every platform on the same numbers, in emulators where they are, and compare the bits."""
    session.install("ziglang>=0.16", "pymunk>=7,<8")
    session.run(
        *("python", "-m", "kernel.selfcheck", str(built(session, ".whl"))),
        *session.posargs,
    )


@nox.session(requires=["build"])
@nox.parametrize("kind", ["onedir", "onefile"], ids=["folder", "file"])
def frozen(session: nox.Session, kind: str) -> None:
    """Freeze a small program with PyInstaller as one folder or one file, and run it."""
    session.install(str(built(session, ".whl")), "pyinstaller")
    place = Path(session.create_tmp()).resolve()
    session.chdir(place)
    program = ROOT / "tests" / "small_program.py"
    session.run(
        *("pyinstaller", "--noconfirm", "--log-level=WARN", f"--{kind}", str(program))
    )
    made = place / "dist" / "small_program"
    if kind == "onedir":
        made /= "small_program"
    session.run(str(made) + (".exe" if sys.platform == "win32" else ""), external=True)
