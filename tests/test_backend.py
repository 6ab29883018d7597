"""The choice between the compiled library and Python."""

import pytest

import pymunk_ellipse
from pymunk_ellipse import Ellipse
from pymunk_ellipse.contacts import backend as backends
from pymunk_ellipse.contacts import library

VARIABLE = "PYMUNK_ELLIPSE_BACKEND"


@pytest.fixture(autouse=True)
def choose_again(monkeypatch):
    """The choice is made once in a process; each of these tests makes its own."""
    before = backends.kernel()
    monkeypatch.setattr(backends, "_kernel", None)
    yield
    backends.use(before)


def test_python(monkeypatch):
    monkeypatch.setenv(VARIABLE, "python")
    assert pymunk_ellipse.backend() == "python"


@pytest.mark.parametrize("value", ["auto", "compiled", ""])
def test_compiled(monkeypatch, built, value):
    monkeypatch.setenv(VARIABLE, value)
    assert pymunk_ellipse.backend() == "compiled"


def test_default_is_auto(monkeypatch, built):
    monkeypatch.delenv(VARIABLE, raising=False)
    assert pymunk_ellipse.backend() == "compiled"


def test_auto_without_a_library(monkeypatch):
    monkeypatch.setenv(VARIABLE, "auto")
    monkeypatch.setattr(library, "load", lambda: None)
    assert pymunk_ellipse.backend() == "python"


def test_compiled_without_a_library(monkeypatch):
    monkeypatch.setenv(VARIABLE, "compiled")
    monkeypatch.setattr(library, "load", lambda: None)
    with pytest.raises(ImportError, match=f"{VARIABLE} is compiled, but the package"):
        pymunk_ellipse.backend()


@pytest.mark.parametrize("value", ["numba", "Python", "auto ", "0"])
def test_anything_else_is_an_error(monkeypatch, value):
    monkeypatch.setenv(VARIABLE, value)
    message = f"{VARIABLE} must be auto, python or compiled, got {value!r}"
    with pytest.raises(ValueError, match=message):
        pymunk_ellipse.backend()
    with pytest.raises(ValueError, match=message):
        Ellipse(None, 2, 1)
