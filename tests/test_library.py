"""The compiled library: that it is built from the sources at hand, where it loads, and what becomes of one that is unfit."""

import compileall
import hashlib
import os
import shutil
import statistics
import tempfile
import textwrap
import zipfile
from pathlib import Path

import pytest
from processes import run, run_code

import pymunk_ellipse
from pymunk_ellipse.contacts.library import SUMS, load
from pymunk_ellipse.contacts.machine import own_library_name

PACKAGE = Path(pymunk_ellipse.__file__).parent
LIBRARY = own_library_name()

# A scene that says how it was resolved, and whether rightly.
SCENE = """
import json, sys
import pymunk, pymunk_ellipse
space = pymunk.Space()
body = pymunk.Body(1, 1)
egg = pymunk_ellipse.Ellipse(body, 2, 1)
floor = pymunk.Segment(space.static_body, (-9, -0.9), (9, -0.9), 0)
depths = []
def note(arbiter, space, data):
    depths.append(round(arbiter.contact_point_set.points[0].distance, 9))
space.on_collision(post_solve=note)
space.add(body, egg, floor)
space.step(1e-6)
assert depths == [-0.1], depths
print(pymunk_ellipse.backend(), pymunk_ellipse.__file__)
"""


@pytest.fixture(scope="module")
def built():
    """There is a library for this machine, in the package that is tested."""
    if not (PACKAGE / LIBRARY).exists():
        pytest.skip("there is no library for this machine")


@pytest.fixture
def package(built, tmp_path):
    """A copy of the package, to be spoilt."""
    place = tmp_path / "pymunk_ellipse"
    shutil.copytree(PACKAGE, place, ignore=shutil.ignore_patterns("__pycache__"))
    return place


def run_scene(path, code=SCENE, **options):
    """The backend that the package on a path chose, and what it reported."""
    printed, reported = run_code(code, cwd=path.parent, PYTHONPATH=str(path), **options)
    backend, file = printed.split(maxsplit=1)
    assert file.startswith(str(path))
    return backend, reported


def test_the_library_is_built_from_the_sources_at_hand(built):
    """If this fails: python -m kernel.build."""
    assert load() is not None


# Unfit libraries


def stale(package):
    with (package / "narrowphase" / "frame.py").open("a") as file:
        file.write("# Changed since.\n")
    return "was built from other sources than those at hand"


def stale_with_other_functions(package):
    """Built when those that it exports, but for the digest, had other names."""
    names = (package / LIBRARY).read_bytes().replace(b"\0pe_", b"\0qe_")
    replaced(lambda library: names.replace(b"\0qe_digest", b"\0pe_digest"))(package)
    stale(package)
    # Which of the two is noticed first depends on the linker.
    return ""


def truncated(part):
    def spoil(package):
        whole = (package / LIBRARY).read_bytes()
        (package / LIBRARY).write_bytes(whole[: round(part * len(whole))])
        return f"is damaged: {SUMS} has another sum for it"

    return spoil


def damaged(package):
    content = bytearray((package / LIBRARY).read_bytes())
    content[len(content) // 2] ^= 0x10
    (package / LIBRARY).write_bytes(content)
    return f"is damaged: {SUMS} has another sum for it"


def replaced(content):
    """By another file of this name, as a whole."""

    def spoil(package):
        found = content((package / LIBRARY).read_bytes())
        (package / LIBRARY).write_bytes(found)
        line = f"{hashlib.sha256(found).hexdigest()}  {LIBRARY}"
        (package / SUMS).write_text(line)
        return "does not load: "

    return spoil


def of_another_machine(library):
    """What says that it is for x86-64 in a file of Linux, Windows or macOS says something else."""
    for start, place, machine in (
        (b"\x7fELF", 18, b"\x08\0"),
        (b"MZ", int.from_bytes(library[60:64], "little") + 4, b"\x66\x01"),
        (b"\xcf\xfa\xed\xfe", 4, b"\x08\0\0\0"),
    ):
        if library.startswith(start):
            return library[:place] + machine + library[place + len(machine) :]
    raise AssertionError(library[:4])


def with_other_sums(package):
    (package / SUMS).write_bytes(b"\xff\0\n\n")
    return f"is damaged: {SUMS} has another sum for it"


UNFIT = {
    "stale": stale,
    "stale, with other functions": stale_with_other_functions,
    "empty": truncated(0),
    "truncated early": truncated(0.1),
    "truncated in the middle": truncated(0.5),
    "truncated late": truncated(0.99),
    "damaged": damaged,
    "something else": replaced(lambda library: b"not a library\n" * 100),
    "of another machine": replaced(of_another_machine),
    "with other sums": with_other_sums,
}


def test_a_library_without_sums_is_used(package):
    """A frozen program has none: what freezes it may sign the library."""
    (package / SUMS).unlink()
    backend, reported = run_scene(package.parent)
    assert (backend, reported) == ("compiled", "")


@pytest.mark.parametrize("how", UNFIT)
def test_an_unfit_library_is_told_of_and_not_used(how, package):
    problem = f"{LIBRARY} {UNFIT[how](package)}"
    backend, reported = run_scene(package.parent)
    assert backend == "python"
    [warning] = [line for line in reported.splitlines() if "Warning" in line]
    assert (
        "RuntimeWarning: pymunk_ellipse works in Python, many times slower: "
        f"{problem}" in warning
    )


@pytest.mark.parametrize("how", ["stale", "damaged", "of another machine"])
def test_an_unfit_library_is_an_error_if_it_must_be_compiled(how, package):
    problem = f"{LIBRARY} {UNFIT[how](package)}"
    done = run(
        *("-c", SCENE),
        cwd=package.parent,
        PYTHONPATH=str(package.parent),
        PYMUNK_ELLIPSE_BACKEND="compiled",
    )
    assert done.returncode == 1
    assert (
        f"ImportError: PYMUNK_ELLIPSE_BACKEND is compiled, but {problem}" in done.stderr
    )


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="needs users")
def test_a_library_that_may_not_be_read(package):
    code = """
        import importlib.resources, os, pymunk_ellipse
        # What is imported besides may be for root only.
        import pymunk_ellipse.contacts.library, pymunk_ellipse.chipmunk.proof
        importlib.resources.files("pymunk")
        root = os.getuid() == 0
        # Who may read everything, so somebody else.
        if root: os.seteuid(65534)
        pymunk_ellipse.backend()
        if root: os.seteuid(0)
    """
    (package / LIBRARY).chmod(0)
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder, "anybody")
        package.parent.rename(place)
        place.chmod(0o755)
        place.parent.chmod(0o755)
        backend, reported = run_scene(place, textwrap.dedent(code) + SCENE)
    assert backend == "python"
    assert f"{LIBRARY} does not load: [Errno 13] Permission denied" in reported


def test_no_library(package):
    """There is nothing to tell: a package for this machine may have none."""
    (package / LIBRARY).unlink()
    assert run_scene(package.parent) == ("python", "")


# Where it works


def test_an_unfit_library_is_not_asked_if_python_is_wanted(package):
    damaged(package)
    backend, reported = run_scene(package.parent, PYMUNK_ELLIPSE_BACKEND="python")
    assert (backend, reported) == ("python", "")


def test_without_sources(package):
    """As in a frozen program, which has modules compiled by Python only."""
    compileall.compile_dir(package, quiet=2, legacy=True)
    for source in [*package.rglob("*.py"), *package.rglob("*.h")]:
        source.unlink()
    assert run_scene(package.parent) == ("compiled", "")


def test_with_line_ends_of_windows(package):
    for source in [*package.rglob("*.py"), *package.rglob("*.h")]:
        source.write_bytes(source.read_bytes().replace(b"\n", b"\r\n"))
    assert run_scene(package.parent) == ("compiled", "")


def test_from_a_zip(package, tmp_path):
    archive = tmp_path / "programs" / "game.zip"
    archive.parent.mkdir()
    with zipfile.ZipFile(archive, "w") as file:
        for path in package.rglob("*"):
            file.write(path, path.relative_to(package.parent))
    assert run_scene(archive) == ("compiled", "")


@pytest.mark.parametrize("home", [None, "/proc/nobody"])
def test_without_a_home(package, home):
    """Nothing is written anywhere, so nothing has to be writable."""
    before = sorted(package.rglob("*"))
    variables = {} if home is None else {"HOME": home}
    found = run_scene(
        package.parent,
        without=("HOME", "USERPROFILE", "XDG_CACHE_HOME"),
        PYTHONDONTWRITEBYTECODE="1",
        **variables,
    )
    assert found == ("compiled", "")
    assert sorted(package.rglob("*")) == before


# What it does without


def test_nothing_is_imported_that_compiles_or_parses(built):
    check = "assert not {'numba', 'llvmlite', 'pycparser'} & set(sys.modules)"
    run_code(f"{SCENE}\n{check}")


def test_a_broken_numba_is_not_noticed(built, tmp_path):
    for name in ("numba", "llvmlite", "pycparser"):
        (tmp_path / f"{name}.py").write_text("raise SystemError('broken')")
    printed, reported = run_code(SCENE, "-W", "error", PYTHONPATH=str(tmp_path))
    assert printed.startswith("compiled")
    assert reported == ""


def test_the_first_ellipse_is_there_at_once(built, tmp_path):
    """Added to a space after the import; processor's time, of several processes with bytecode cached."""
    code = """
        import time
        import pymunk, pymunk_ellipse
        space = pymunk.Space()
        body = pymunk.Body(1, 1)
        start = time.process_time()
        space.add(body, pymunk_ellipse.Ellipse(body, 2, 1))
        print(time.process_time() - start)
        assert pymunk_ellipse.backend() == "compiled"
    """
    cached = {"PYTHONDONTWRITEBYTECODE": "", "PYTHONPYCACHEPREFIX": str(tmp_path)}
    run_code(code, **cached)
    seconds = [float(run_code(code, **cached)[0]) for _ in range(5)]
    print(f"first ellipse: {1e3 * statistics.median(seconds):.1f} ms")
    # A compiler would take seconds; a busy machine takes twice as long as an idle one.
    assert min(seconds) < 0.1
