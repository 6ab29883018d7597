"""FCL: its signed distance of two ellipsoids."""

from __future__ import annotations

from typing import Any

import fcl
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

NAME = "fcl"


def pair_methods() -> list[PairMethod]:
    return [PairMethod(NAME, 0, signed_distance)]


def signed_distance(pairs: Pairs) -> Prepared:
    """By fcl.distance, less that of two spheres; fcl.collide does not find the deepest point of ellipsoids."""
    request = fcl.DistanceRequest(
        enable_nearest_points=True, enable_signed_distance=True
    )
    ellipsoids, spheres = [], []
    for one, two in each(pairs):
        ellipsoids.append(
            tuple(put(fcl.Ellipsoid(*semi_axes(at.a, at.b)), at) for at in (one, two))
        )
        # Apart: overlapping ones are looked into as deeply as any shape.
        radius = 0.4 * between_centres(one, two)
        spheres.append(tuple(put(fcl.Sphere(radius), at) for at in (one, two)))
    found = np.full((len(pairs), 4), np.nan)
    for row, pair in zip(found, ellipsoids, strict=True):
        result = fcl.DistanceResult()
        distance = fcl.distance(*pair, request, result)
        if distance < 0.0:
            on_first, on_second = map(np.array, result.nearest_points)
            row[:] = -distance, *((on_second - on_first) / distance)

    def measure(pairs: list[tuple[Any, ...]]) -> None:
        result = fcl.DistanceResult()
        for one, two in pairs:
            fcl.distance(one, two, request, result)

    def calls() -> None:
        measure(ellipsoids)

    return Prepared(found, calls, calls, lambda: measure(spheres))


def put(shape: Any, at: Placed) -> Any:
    place = fcl.Transform(rotation(at), np.array([at.x, at.y, 0.0]))
    return fcl.CollisionObject(shape, place)
