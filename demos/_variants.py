"""Ways to resolve contacts with one part of the shipped method switched off or replaced, to see what it is for."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from math import atan2
from types import ModuleType
from typing import Any

import pymunk_ellipse.contacts.interpreted as interpreted
import pymunk_ellipse.contacts.pair as pair
import pymunk_ellipse.contacts.resolver as resolver
import pymunk_ellipse.narrowphase.ellipse_ellipse as ellipse_ellipse
import pymunk_ellipse.narrowphase.ellipse_polygon as ellipse_polygon
from pymunk_ellipse.chipmunk.structs import arbiter_at, hull_at
from pymunk_ellipse.contacts.backend import using
from pymunk_ellipse.contacts.handover import LastContact
from pymunk_ellipse.narrowphase.ellipse_ellipse import Contact
from pymunk_ellipse.narrowphase.frame import Frame
from pymunk_ellipse.published_fit import circle_fit

SHIPPED = "shipped"


@contextmanager
def replaced(*replacements: tuple[ModuleType, str, Any]) -> Iterator[None]:
    """Resolve contacts in Python, with other things under some names of some modules."""
    with ExitStack() as undo:
        undo.enter_context(using(interpreted.Python()))
        for module, name, replacement in replacements:
            undo.callback(setattr, module, name, getattr(module, name))
            setattr(module, name, replacement)
        yield


@contextmanager
def without_warm_start() -> Iterator[None]:
    """No contact takes over the impulses of the last step."""
    whole = interpreted.resolve

    def resolve(address: int, *arguments: Any) -> None:
        whole(address, *arguments)
        arbiter = arbiter_at(address)
        if arbiter.data:
            arbiter.contact.jnAcc = 0.0
            arbiter.contact.jtAcc = 0.0

    with replaced((interpreted, "resolve", resolve)):
        yield


@contextmanager
def without_rolling() -> Iterator[None]:
    """Contacts roll about the point where they touch as the step begins."""

    def rolling_velocity(*numbers: float) -> tuple[float, float]:
        return 0.0, 0.0

    with replaced((resolver, "rolling_velocity", rolling_velocity)):
        yield


@contextmanager
def with_elastic_rolling() -> Iterator[None]:
    """Restitution reverses the velocity of rolling as well."""

    def with_restitution(x: float, y: float, *_: float) -> tuple[float, float]:
        return x, y

    with replaced((resolver, "with_restitution", with_restitution)):
        yield


@contextmanager
def without_rolling_of_wheels() -> Iterator[None]:
    """Contacts of round ellipses roll about where they touch as the step begins, wherever the centre of gravity is."""

    def rolls_as_circle(shape: Any, body: Any) -> bool:
        local = hull_at(shape).local
        return bool(local[0] == local[1])

    with replaced((resolver, "rolls_as_circle", rolls_as_circle)):
        yield


@contextmanager
def without_handover() -> Iterator[None]:
    """Each contact with another shape of a floor begins without a last one."""

    def last_on_body(*arguments: Any) -> LastContact:
        return False, 0.0, 0.0, 0.0, 0.0

    with replaced((resolver, "last_on_body", last_on_body)):
        yield


@contextmanager
def without_sweep() -> Iterator[None]:
    """The first maximum that the climb finds counts, however deep the overlap."""

    def sweep(*arguments: Any) -> Any:
        return arguments[-1]

    def sweep_polygon(*arguments: Any) -> Any:
        return arguments[-2:]

    with replaced(
        (ellipse_ellipse, "sweep", sweep),
        (ellipse_polygon, "sweep_polygon", sweep_polygon),
    ):
        yield


@contextmanager
def with_published_fit() -> Iterator[None]:
    """Contacts of two ellipses come from the published alternating fit, ten sweeps of it."""

    def contact(first: Frame, second: Frame, nx: float, ny: float) -> Contact:
        fit = circle_fit(by_angle(first), by_angle(second))
        nx, ny = fit.normal
        circle = fit.first
        px = circle.x + circle.radius * nx - first[4]
        py = circle.y + circle.radius * ny - first[5]
        return -fit.depth, nx, ny, px, py

    with replaced((pair, "ellipse_ellipse", contact)):
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
    "elastic rolling": with_elastic_rolling,
    "no rolling of wheels": without_rolling_of_wheels,
    "no handover": without_handover,
    "no sweep": without_sweep,
}
