"""Coal (once hpp-fcl): its collision of two ellipsoids."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import coal
import numpy as np

from ._methods import Pairs
from ._peers_pairs import (
    PairMethod,
    Placed,
    Prepared,
    between_centres,
    each,
    rotation,
    semi_axes,
)

NAME = "coal"
# Of its search of a depth; the first is the default. A finer tolerance makes it fail.
ITERATIONS = 64, 1000


def pair_methods() -> list[PairMethod]:
    return [PairMethod(NAME, count, searching(count)) for count in ITERATIONS]


def searching(iterations: int) -> Callable[[Pairs], Prepared]:
    """By coal.collide, less that of two spheres."""
    request = coal.CollisionRequest()
    request.epa_max_iterations = iterations

    def prepare(pairs: Pairs) -> Prepared:
        ellipsoids, spheres = [], []
        for one, two in each(pairs):
            radius = 0.55 * between_centres(one, two)
            sphere = coal.Sphere(radius)
            spheres.append((sphere, transform(one), sphere, transform(two)))
            ellipsoids.append((*ellipsoid(one), *ellipsoid(two)))
        result = coal.CollisionResult()
        found = np.full((len(pairs), 4), np.nan)
        for row, pair in zip(found, ellipsoids, strict=True):
            result.clear()
            if coal.collide(*pair, request, result):
                contact = result.getContact(0)
                row[:] = -contact.penetration_depth, *contact.normal

        def collide(pairs: list[tuple[Any, ...]]) -> None:
            for one, at_one, two, at_two in pairs:
                result.clear()
                coal.collide(one, at_one, two, at_two, request, result)

        def calls() -> None:
            collide(ellipsoids)

        return Prepared(found, calls, calls, lambda: collide(spheres))

    return prepare


def ellipsoid(at: Placed) -> tuple[Any, Any]:
    return coal.Ellipsoid(*semi_axes(at.a, at.b)), transform(at)


def transform(at: Placed) -> Any:
    return coal.Transform3s(rotation(at), np.array([at.x, at.y, 0.0]))
