"""The backends that contacts are tested with."""

import pytest

from pymunk_ellipse.contacts import backend as backends
from pymunk_ellipse.contacts.library import load


@pytest.fixture(params=["python", "compiled"])
def backend(request):
    """Resolves contacts in one way, then in the other."""
    chosen = backends.Python() if request.param == "python" else load()
    if chosen is None:
        pytest.skip("there is no library for this machine")
    with backends.using(chosen):
        yield request.param
