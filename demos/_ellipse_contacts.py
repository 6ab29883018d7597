"""Contacts of arrays of ellipses, by the narrow phase in a loop."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._methods import compile_loops, looping, safeguarded


class Contacts(NamedTuple):
    """Distances, negative where two overlap, and unit normals from the first to the second."""

    distance: NDArray[np.float64]
    normal: NDArray[np.float64]


_loops = compile_loops([safeguarded])
_loop: Any = _loops[safeguarded] if _loops else looping(safeguarded)


def ellipse_contacts(
    first: NDArray[np.float64], second: NDArray[np.float64]
) -> Contacts:
    """The contacts of ellipses (rows a, b, x, y, angle of a, with a >= b) with others."""
    count = len(first)
    pairs = np.empty((count, 8))
    pairs[:, :2], pairs[:, 2:4] = first[:, :2], second[:, :2]
    turned = second[:, 4] - first[:, 4]
    pairs[:, 4], pairs[:, 5] = np.cos(turned), np.sin(turned)
    between = second[:, 2:4] - first[:, 2:4]
    cosine, sine = np.cos(first[:, 4]), np.sin(first[:, 4])
    pairs[:, 6] = cosine * between[:, 0] + sine * between[:, 1]
    pairs[:, 7] = cosine * between[:, 1] - sine * between[:, 0]
    found = np.empty((count, 3))
    _loop(pairs, np.zeros((count, 2)), 0, found)
    nx, ny = found[:, 1], found[:, 2]
    normal = np.stack((cosine * nx - sine * ny, sine * nx + cosine * ny), axis=1)
    return Contacts(-found[:, 0], normal)
