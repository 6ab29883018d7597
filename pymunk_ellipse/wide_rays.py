"""The ellipses that a moving circle may touch, where Chipmunk looks for shapes along the line of its centre only."""

from __future__ import annotations

from collections.abc import Iterator

import pymunk
from pymunk import BB, ShapeFilter, Vec2d

from .ellipse import Ellipse

# A way is covered by a box for each so many radii, but not by more than this. More of them hold
# fewer shapes that are not near it, and each costs a query.
PIECE = 10.0
MOST_PIECES = 8

# Boxes are larger by this part of the coordinates, so that roundoff cannot lose a shape.
MARGIN = 1e-12


def ellipses_along(
    space: pymunk.Space,
    start: Vec2d,
    end: Vec2d,
    radius: float,
    shape_filter: ShapeFilter,
) -> Iterator[Ellipse]:
    """Every ellipse in a space that a circle of the given radius may touch on its way from start to end, and a few more."""
    seen = set()
    size = max(abs(start.x), abs(start.y), abs(end.x), abs(end.y))
    reach = radius + MARGIN * size
    pieces = int(min(1.0 + abs(end - start) / (PIECE * radius), MOST_PIECES))
    for i in range(pieces):
        near = start.interpolate_to(end, i / pieces)
        far = start.interpolate_to(end, (i + 1) / pieces)
        piece = BB(
            min(near.x, far.x) - reach,
            min(near.y, far.y) - reach,
            max(near.x, far.x) + reach,
            max(near.y, far.y) + reach,
        )
        for shape in space.bb_query(piece, shape_filter):
            if isinstance(shape, Ellipse) and shape not in seen:
                seen.add(shape)
                yield shape
