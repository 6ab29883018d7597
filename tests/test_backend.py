"""The choice between compiled contacts and Python's."""

import subprocess
import sys

import pymunk
import pytest

import pymunk_ellipse
from pymunk_ellipse.backend import compiled_pre_solve

VARIABLE = "PYMUNK_ELLIPSE_BACKEND"


@pytest.fixture(autouse=True)
def choose_again():
    """The choice is made once in a process; each of these tests makes its own."""
    compiled_pre_solve.cache_clear()
    yield
    compiled_pre_solve.cache_clear()


def has_numba():
    try:
        import numba  # noqa: F401
    except ImportError:
        return False
    return True


def test_python(monkeypatch):
    monkeypatch.setenv(VARIABLE, "python")
    assert pymunk_ellipse.backend() == "python"


@pytest.mark.parametrize("value", ["auto", "compiled"])
def test_compiled(monkeypatch, value):
    pytest.importorskip("numba")
    monkeypatch.setenv(VARIABLE, value)
    assert pymunk_ellipse.backend() == "compiled"


def test_default_is_auto(monkeypatch):
    monkeypatch.delenv(VARIABLE, raising=False)
    assert pymunk_ellipse.backend() == ("compiled" if has_numba() else "python")


def test_auto_without_numba(monkeypatch):
    monkeypatch.setenv(VARIABLE, "auto")
    monkeypatch.setitem(sys.modules, "numba", None)
    assert pymunk_ellipse.backend() == "python"


def test_compiled_without_numba(monkeypatch):
    monkeypatch.setenv(VARIABLE, "compiled")
    monkeypatch.setitem(sys.modules, "numba", None)
    with pytest.raises(ImportError, match=f"{VARIABLE} is compiled, which needs numba"):
        pymunk_ellipse.backend()


@pytest.mark.parametrize("value", ["", "numba", "Python", "auto "])
def test_anything_else_is_an_error(monkeypatch, value):
    monkeypatch.setenv(VARIABLE, value)
    message = f"{VARIABLE} must be auto, python or compiled, got {value!r}"
    with pytest.raises(ValueError, match=message):
        pymunk_ellipse.backend()
    space = pymunk.Space()
    body = pymunk.Body(1, 1)
    with pytest.raises(ValueError, match=message):
        space.add(body, pymunk_ellipse.Ellipse(body, 2, 1))


def test_python_backend_imports_no_numba():
    """A user without it, or who does not want it, does not wait for it."""
    code = (
        "import sys, pymunk, pymunk_ellipse\n"
        "space = pymunk.Space()\n"
        "body = pymunk.Body(1, 1)\n"
        "space.add(body, pymunk_ellipse.Ellipse(body, 2, 1))\n"
        "space.step(0.01)\n"
        "assert 'numba' not in sys.modules\n"
        "assert pymunk_ellipse.backend() == 'python'\n"
    )
    subprocess.run(
        [sys.executable, "-c", code], check=True, env={VARIABLE: "python"}, timeout=60
    )
