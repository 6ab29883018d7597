"""Ways to resolve contacts with one part of the shipped method switched off or replaced, to see what it is for."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from math import atan2
from types import ModuleType
from typing import Any

import pymunk_ellipse.contacts as contacts
import pymunk_ellipse.narrowphase.ellipse_ellipse as ellipse_ellipse
import pymunk_ellipse.narrowphase.ellipse_polygon as ellipse_polygon
import pymunk_ellipse.resolver as resolver
from pymunk_ellipse.circle_fit import circle_fit
from pymunk_ellipse.narrowphase.ellipse_ellipse import Contact
from pymunk_ellipse.narrowphase.placement import Frame

SHIPPED = "shipped"


@contextmanager
def replaced(*replacements: tuple[ModuleType, str, Any]) -> Iterator[None]:
    """Resolve contacts of spaces made from here on in Python, with other things under some names of some modules."""
    with ExitStack() as undo:
        in_python = (contacts, "compiled_pre_solve", lambda: None)
        for module, name, replacement in (in_python, *replacements):
            undo.callback(setattr, module, name, getattr(module, name))
            setattr(module, name, replacement)
        yield


@contextmanager
def without_warm_start() -> Iterator[None]:
    """No contact takes over the impulses of the last step."""
    whole = contacts.pre_solve

    def pre_solve(ellipses: dict[Any, Frame], arbiter: Any) -> None:
        whole(ellipses, arbiter)
        if arbiter.data:
            arbiter.contacts[0].jnAcc = 0.0
            arbiter.contacts[0].jtAcc = 0.0

    with replaced((contacts, "pre_solve", pre_solve)):
        yield


@contextmanager
def without_rolling() -> Iterator[None]:
    """Contacts roll about the point where they touch as the step begins."""

    def rolling_velocity(*numbers: float) -> tuple[float, float]:
        return 0.0, 0.0

    with replaced((resolver, "rolling_velocity", rolling_velocity)):
        yield


@contextmanager
def without_sweep() -> Iterator[None]:
    """The first maximum that the climb finds counts, however deep the overlap."""

    def sweep(*arguments: Any) -> tuple[float, float, float, int]:
        best, best_x, best_y = arguments[-4:-1]
        return best, best_x, best_y, 0

    with replaced((ellipse_ellipse, "sweep", sweep), (ellipse_polygon, "sweep", sweep)):
        yield


@contextmanager
def with_published_fit() -> Iterator[None]:
    """Contacts of two ellipses come from the published alternating fit, ten sweeps of it."""

    def contact_with_ellipse(
        first: Frame, second: Frame, nx: float, ny: float, margin: float
    ) -> Contact:
        del nx, ny, margin
        fit = circle_fit(by_angle(first), by_angle(second))
        nx, ny = fit.normal
        circle = fit.first
        px = circle.x + circle.radius * nx - first[4]
        py = circle.y + circle.radius * ny - first[5]
        return -fit.depth, nx, ny, px, py, fit.sweeps

    with replaced((resolver, "contact_with_ellipse", contact_with_ellipse)):
        yield


def by_angle(frame: Frame) -> tuple[float, float, float, float, float]:
    """Semi-axes, centre and angle of a: an ellipse as circle_fit takes it."""
    a, b, c, s, x, y = frame
    return a, b, x, y, atan2(s, c)


@contextmanager
def shipped() -> Iterator[None]:
    """Nothing is changed."""
    yield


VARIANTS: dict[str, Callable[[], Any]] = {
    SHIPPED: shipped,
    "published fit": with_published_fit,
    "no warm start": without_warm_start,
    "no rolling correction": without_rolling,
    "no sweep": without_sweep,
}
