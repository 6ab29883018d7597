"""What tests share: the backends that contacts are tested with, and what must not be left over."""

import sys

import pytest
import scenes

from pymunk_ellipse.contacts import backend as backends
from pymunk_ellipse.contacts.interpreted import Python
from pymunk_ellipse.contacts.library import load


@pytest.fixture(scope="session")
def built():
    """The compiled library; without one for this machine the test is skipped."""
    library = load()
    if library is None:
        pytest.skip("there is no library for this machine")
    return library


@pytest.fixture(params=["python", "compiled"])
def backend(request):
    """Resolves contacts in one way, then in the other."""
    python = request.param == "python"
    chosen = Python() if python else request.getfixturevalue("built")
    with backends.using(chosen):
        yield request.param


@pytest.fixture
def mistakes(monkeypatch):
    """What callbacks raise, which pymunk reports but does not pass on; none but what a test expects and clears."""
    reports = []
    monkeypatch.setattr(
        sys, "unraisablehook", lambda report: reports.append(report.exc_value)
    )
    yield reports
    for mistake in reports:
        raise mistake


@pytest.fixture(autouse=True)
def no_bodies_left():
    yield
    scenes.BODIES.clear()
