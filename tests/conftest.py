"""The backends that contacts are tested with."""

import pytest

import pymunk_ellipse.contacts
from pymunk_ellipse.backend import compiled_pre_solve


@pytest.fixture(params=["python", "compiled"])
def backend(request, monkeypatch):
    """Resolves the contacts of spaces in one way, then in the other."""
    if request.param == "compiled":
        pytest.importorskip("numba")
        callback = compiled_pre_solve()
        if callback is None:
            pytest.skip("PYMUNK_ELLIPSE_BACKEND is python")
    else:
        callback = None
    monkeypatch.setattr(pymunk_ellipse.contacts, "compiled_pre_solve", lambda: callback)
    return request.param
