"""The ellipses that a moving circle touches, where Chipmunk looks for shapes along the line of its centre only."""

from __future__ import annotations

import pymunk
from pymunk import BB, ShapeFilter, Vec2d

from .chipmunk.private import query_box
from .chipmunk.structs import address, ffi
from .contacts.backend import kernel
from .narrowphase.cast import Hit

# The box is larger by this part of the coordinates, so that roundoff cannot lose a shape.
MARGIN = 1e-12


def overlooked_ellipses(
    space: pymunk.Space,
    start: Vec2d,
    end: Vec2d,
    radius: float,
    shape_filter: ShapeFilter,
    room: int,
) -> list[tuple[int, Hit]]:
    """The addresses of the ellipses in a space that a circle touches beside the line from start to end, and where it does.

    They are all those that Chipmunk overlooks, and up to roundoff no others.

    room is how many ellipses there are in the space.
    """
    touched = ffi.new("intptr_t[]", room)
    ray = ffi.new("WideRay *", {"start": start, "end": end, "radius": radius})
    hits = ffi.new("double[]", 5 * room)
    ray.touched = touched
    ray.hits = hits
    size = max(abs(start.x), abs(start.y), abs(end.x), abs(end.y))
    reach = radius + MARGIN * size
    box = BB(
        min(start.x, end.x) - reach,
        min(start.y, end.y) - reach,
        max(start.x, end.x) + reach,
        max(start.y, end.y) + reach,
    )
    query_box(space, box, shape_filter, kernel().collect_touched, address(ray))
    return [(touched[i], tuple(hits[5 * i : 5 * i + 5])) for i in range(ray.count)]
