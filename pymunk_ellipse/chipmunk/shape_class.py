"""An ellipse as a class of shapes: what Chipmunk asks of a shape when it updates it and in queries, in Python and compiled.

A cpShape points to its class: its kind, and functions for its bounding box, for its point nearest to
another and for where a moving circle touches it first. The class of ellipses is that of polygons,
whose hull still stands for the ellipse in collisions, with these functions replaced.
"""

from __future__ import annotations

from typing import Any

from ..narrowphase.cast import Hit, crosses_box, segment_hit
from ..narrowphase.frame import Frame, half_extents, placed
from ..narrowphase.nearest import Nearest, nearest_point
from .structs import (
    address,
    ellipse_class,
    ffi,
    frame_in,
    hull_at,
    ray_at,
    shape_at,
)


def cache_data(
    hull: Any, cos: float, sin: float, x: float, y: float
) -> tuple[float, float, float, float]:
    """Keep where an ellipse is in the world, and return its bounding box: left, bottom, right, top."""
    frame = placed(frame_in(hull.local), x, y, cos, sin)
    world = hull.world
    for i in range(6):
        world[i] = frame[i]
    width, height = half_extents(frame)
    cx = frame[4]
    cy = frame[5]
    return cx - width, cy - height, cx + width, cy + height


def nearest_updated(hull: Any, x: float, y: float) -> Nearest:
    """The point of an ellipse that is nearest to (x, y), where it was updated last."""
    return nearest_point(frame_in(hull.world), x, y)


def cast_updated(
    hull: Any, start_x: float, start_y: float, end_x: float, end_y: float, radius: float
) -> Hit:
    """Where a moving circle touches an ellipse first, where that was updated last."""
    return segment_hit(frame_in(hull.world), start_x, start_y, end_x, end_y, radius)


def frame_now(hull: Any) -> Frame:
    """The frame of an ellipse in the world where its body is now; without a body where it was updated last."""
    if hull.shape.on_body == 0:
        return frame_in(hull.world)
    at = hull.shape.body.transform
    return placed(frame_in(hull.local), at.tx, at.ty, at.a, at.b)


def nearest_now(hull: Any, x: float, y: float) -> Nearest:
    """The point of an ellipse that is nearest to (x, y), where its body is now."""
    return nearest_point(frame_now(hull), x, y)


def cast_now(
    hull: Any, start_x: float, start_y: float, end_x: float, end_y: float, radius: float
) -> Hit:
    """Where a moving circle touches an ellipse first, where its body is now."""
    return segment_hit(frame_now(hull), start_x, start_y, end_x, end_y, radius)


def collect_touched(shape_address: int, ray_address: int) -> None:
    """Add an ellipse to those that a circle touches on its way and Chipmunk overlooks, if it is one of them.

    Those are the ones whose boxes the line of the circle's centre does not cross. Chipmunk calls
    this for each shape in a box; there is room for all ellipses of the space.
    """
    shape = shape_at(shape_address)
    if shape.klass != ellipse_class():
        return
    ray = ray_at(ray_address)
    start = ray.start
    end = ray.end
    bb = shape.bb
    if crosses_box(
        bb.left, bb.bottom, bb.right, bb.top, start.x, start.y, end.x, end.y
    ):
        return
    hull = hull_at(shape_address)
    hit = cast_updated(hull, start.x, start.y, end.x, end.y, ray.radius)
    if hit[0] <= 1.0:
        count = ray.count
        ray.touched[count] = shape_address
        for i in range(5):
            ray.hits[5 * count + i] = hit[i]
        ray.count = count + 1


def python_class(polygons: Any) -> int:
    """Make the class of ellipses with its functions in Python, from that of polygons; returns its address."""
    place_hull = polygons.cache_data

    def update(shape: Any, at: Any) -> tuple[float, float, float, float]:
        place_hull(shape, at)
        return cache_data(hull_at(shape), at.a, at.b, at.tx, at.ty)

    def point_query(shape: Any, point: Any, result: Any) -> None:
        info = ffi.cast("PointQueryInfo *", result)
        distance, nx, ny, px, py = nearest_updated(hull_at(shape), point.x, point.y)
        info.shape = address(shape)
        info.distance = distance
        info.point.x = px
        info.point.y = py
        info.gradient.x = nx
        info.gradient.y = ny

    def segment_query(
        shape: Any, start: Any, end: Any, radius: float, result: Any
    ) -> None:
        alpha, nx, ny, px, py = cast_updated(
            hull_at(shape), start.x, start.y, end.x, end.y, radius
        )
        if alpha <= 1.0:
            info = ffi.cast("SegmentQueryInfo *", result)
            info.shape = address(shape)
            info.alpha = alpha
            info.point.x = px
            info.point.y = py
            info.normal.x = nx
            info.normal.y = ny

    functions = (
        ffi.callback("Box(void *, Transform)", update),
        ffi.callback("void(void *, Vect, void *)", point_query),
        ffi.callback("void(void *, Vect, Vect, double, void *)", segment_query),
    )
    made = ffi.new("ShapeClass *", polygons[0])
    made.cache_data, made.point_query, made.segment_query = functions
    keep_for_ever((made, functions))
    return address(made)


def keep_for_ever(thing: Any) -> None:
    """Keep an object through the interpreter's exit, when shapes may still be freed that point to it.

    PyPy frees nothing at its exit, and has no reference counts.
    """
    # Here, because it takes half as long as the import of the whole package.
    import ctypes

    _kept.append(thing)
    python = getattr(ctypes, "pythonapi", None)
    if python is not None and hasattr(python, "Py_IncRef"):
        python.Py_IncRef(ctypes.py_object(_kept[-1]))


_kept: list[Any] = []
