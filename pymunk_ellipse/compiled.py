"""pre_solve as a C callback: resolver.py once more, on Chipmunk's structs, compiled by numba with the narrow phase."""

from __future__ import annotations

import hashlib
import logging
from pathlib import Path
from typing import Any

import numba
from numba import carray  # type: ignore[attr-defined]
from numba.core.event import Event, Listener, install_listener
from numba.extending import register_jitable

from . import _layout, _memory
from ._layout import (
    BODY_POSITION,
    BODY_SPIN,
    BODY_TRANSFORM,
    CIRCLE,
    CIRCLE_CENTER,
    CIRCLE_RADIUS,
    ELLIPSE_FRAME,
    ELLIPSE_MARK,
    MARK,
    POLYGON,
    POLYGON_COUNT,
    POLYGON_PLANES,
    POLYGON_RADIUS,
    SEGMENT,
    SEGMENT_END,
    SEGMENT_RADIUS,
    SEGMENT_START,
    SEGMENT_TANGENTS,
    SHAPE_CLASS,
    SHAPE_SURFACE_VELOCITY,
)
from ._memory import (
    doubles_at,
    load_double,
    load_int,
    load_word,
    store_double,
    store_int,
    store_word,
)
from ._pymunk import FIRST_COLLISION, IGNORE, ffi
from .narrowphase import (
    common_normal,
    ellipse_ellipse,
    ellipse_polygon,
    placement,
    rolling,
)
from .narrowphase.ellipse_ellipse import ellipse_ellipse as collide_ellipses
from .narrowphase.ellipse_polygon import ellipse_polygon as collide_polygon
from .narrowphase.ellipse_polygon import ellipse_segment as collide_segment
from .narrowphase.placement import normal_at, placed
from .narrowphase.rolling import rolling_velocity, same_contact

_logger = logging.getLogger(__name__)

_NARROWPHASE = (common_normal, ellipse_ellipse, ellipse_polygon, placement, rolling)

for _module in _NARROWPHASE:
    for _function in list(vars(_module).values()):
        if getattr(_function, "__module__", None) == _module.__name__ and callable(
            _function
        ):
            register_jitable(_function)


def _offset(struct: str, field: str) -> int:
    offset: int = ffi.offsetof(f"struct {struct}", field)
    return offset


# pymunk declares these two structs, so their fields need no proof.
ARBITER_A = _offset("cpArbiter", "a")
ARBITER_B = _offset("cpArbiter", "b")
ARBITER_BODY_A = _offset("cpArbiter", "body_a")
ARBITER_BODY_B = _offset("cpArbiter", "body_b")
ARBITER_COUNT = _offset("cpArbiter", "count")
ARBITER_CONTACTS = _offset("cpArbiter", "contacts")
ARBITER_NORMAL = _offset("cpArbiter", "n")
ARBITER_STATE = _offset("cpArbiter", "state")
ARBITER_DATA = _offset("cpArbiter", "data")
ARBITER_SURFACE_VELOCITY = _offset("cpArbiter", "surface_vr")
CONTACT_R1 = _offset("cpContact", "r1")
CONTACT_R2 = _offset("cpContact", "r2")
CONTACT_NORMAL_IMPULSE = _offset("cpContact", "jnAcc")
CONTACT_TANGENT_IMPULSE = _offset("cpContact", "jtAcc")
CONTACT_HASH = _offset("cpContact", "hash")


@register_jitable
def kind_of(shape: int) -> int:
    kind: int = load_int(load_word(shape, SHAPE_CLASS), 0)
    return kind


@register_jitable
def is_ellipse(shape: int) -> bool:
    return kind_of(shape) == POLYGON and load_word(shape, ELLIPSE_MARK) == MARK ^ shape


@register_jitable
def place_ellipse(shape: int, body: int) -> placement.Frame:
    frame = (
        load_double(shape, ELLIPSE_FRAME),
        load_double(shape, ELLIPSE_FRAME + 8),
        load_double(shape, ELLIPSE_FRAME + 16),
        load_double(shape, ELLIPSE_FRAME + 24),
        load_double(shape, ELLIPSE_FRAME + 32),
        load_double(shape, ELLIPSE_FRAME + 40),
    )
    return placed(
        frame,
        load_double(body, BODY_TRANSFORM + 32),
        load_double(body, BODY_TRANSFORM + 40),
        load_double(body, BODY_TRANSFORM),
        load_double(body, BODY_TRANSFORM + 8),
    )


@register_jitable
def contact_with_ellipse(
    first: placement.Frame,
    second: placement.Frame,
    nx: float,
    ny: float,
) -> ellipse_ellipse.Contact:
    a1, b1, c1, s1, x1, y1 = first
    a2, b2, c2, s2, x2, y2 = second
    return collide_ellipses(
        a1, b1, c1, s1, a2, b2, c2, s2, x2 - x1, y2 - y1, nx, ny, 0.0
    )


@register_jitable
def contact_with_circle(
    ellipse: placement.Frame, shape: int, nx: float, ny: float
) -> ellipse_ellipse.Contact:
    radius = load_double(shape, CIRCLE_RADIUS)
    x = load_double(shape, CIRCLE_CENTER)
    y = load_double(shape, CIRCLE_CENTER + 8)
    return contact_with_ellipse(ellipse, (radius, radius, 1.0, 0.0, x, y), nx, ny)


@register_jitable
def contact_with_segment(
    ellipse: placement.Frame, shape: int, body: int
) -> ellipse_ellipse.Contact:
    a, b, c, s, x, y = ellipse
    cos = load_double(body, BODY_TRANSFORM)
    sin = load_double(body, BODY_TRANSFORM + 8)
    before_x = load_double(shape, SEGMENT_TANGENTS)
    before_y = load_double(shape, SEGMENT_TANGENTS + 8)
    after_x = load_double(shape, SEGMENT_TANGENTS + 16)
    after_y = load_double(shape, SEGMENT_TANGENTS + 24)
    return collide_segment(
        a,
        b,
        c,
        s,
        x,
        y,
        load_double(shape, SEGMENT_START),
        load_double(shape, SEGMENT_START + 8),
        load_double(shape, SEGMENT_END),
        load_double(shape, SEGMENT_END + 8),
        cos * before_x - sin * before_y,
        sin * before_x + cos * before_y,
        cos * after_x - sin * after_y,
        sin * after_x + cos * after_y,
        load_double(shape, SEGMENT_RADIUS),
        0.0,
    )


@register_jitable
def contact_with_polygon(
    ellipse: placement.Frame, shape: int
) -> ellipse_ellipse.Contact:
    a, b, c, s, x, y = ellipse
    count = load_int(shape, POLYGON_COUNT)
    planes: Any = carray(doubles_at(load_word(shape, POLYGON_PLANES)), 4 * count)
    radius = load_double(shape, POLYGON_RADIUS)
    return collide_polygon(a, b, c, s, x, y, planes, count, radius, 0.0)[:6]


@register_jitable
def contact_with_shape(
    ellipse: placement.Frame, shape: int, body: int, nx: float, ny: float
) -> ellipse_ellipse.Contact:
    kind = kind_of(shape)
    if kind == CIRCLE:
        return contact_with_circle(ellipse, shape, nx, ny)
    if kind == SEGMENT:
        return contact_with_segment(ellipse, shape, body)
    return contact_with_polygon(ellipse, shape)


@register_jitable
def turn_surface_velocity(
    arbiter: int, shape_a: int, shape_b: int, nx: float, ny: float
) -> None:
    vx = load_double(shape_b, SHAPE_SURFACE_VELOCITY) - load_double(
        shape_a, SHAPE_SURFACE_VELOCITY
    )
    vy = load_double(shape_b, SHAPE_SURFACE_VELOCITY + 8) - load_double(
        shape_a, SHAPE_SURFACE_VELOCITY + 8
    )
    if vx == 0.0 and vy == 0.0:
        return
    hull_x = load_double(arbiter, ARBITER_NORMAL)
    hull_y = load_double(arbiter, ARBITER_NORMAL + 8)
    along = vx * hull_x + vy * hull_y
    if (
        load_double(arbiter, ARBITER_SURFACE_VELOCITY) == vx - hull_x * along
        and load_double(arbiter, ARBITER_SURFACE_VELOCITY + 8) == vy - hull_y * along
    ):
        along = vx * nx + vy * ny
        store_double(arbiter, ARBITER_SURFACE_VELOCITY, vx - nx * along)
        store_double(arbiter, ARBITER_SURFACE_VELOCITY + 8, vy - ny * along)


@register_jitable
def add_surface_velocity(arbiter: int, vx: float, vy: float) -> None:
    store_double(
        arbiter,
        ARBITER_SURFACE_VELOCITY,
        load_double(arbiter, ARBITER_SURFACE_VELOCITY) + vx,
    )
    store_double(
        arbiter,
        ARBITER_SURFACE_VELOCITY + 8,
        load_double(arbiter, ARBITER_SURFACE_VELOCITY + 8) + vy,
    )


def _define(version: int) -> Any:
    def pre_solve(arbiter: int, space: int, user_data: int) -> None:
        # Never true; ties code cached on disk to the version it was compiled from.
        if version == 0:
            return

        shape_a = load_word(arbiter, ARBITER_A)
        shape_b = load_word(arbiter, ARBITER_B)
        a_is_ellipse = is_ellipse(shape_a)
        b_is_ellipse = is_ellipse(shape_b)
        if not a_is_ellipse and not b_is_ellipse:
            return

        body_a = load_word(arbiter, ARBITER_BODY_A)
        body_b = load_word(arbiter, ARBITER_BODY_B)
        ax = load_double(body_a, BODY_POSITION)
        ay = load_double(body_a, BODY_POSITION + 8)
        bx = load_double(body_b, BODY_POSITION)
        by = load_double(body_b, BODY_POSITION + 8)

        name = arbiter + 1 if shape_a < shape_b else arbiter
        last = load_word(arbiter, ARBITER_DATA)
        state = load_int(arbiter, ARBITER_STATE)
        touched = last != 0
        last_ax = 0.0
        last_ay = 0.0
        last_bx = 0.0
        last_by = 0.0
        if state == FIRST_COLLISION:
            last = 0
        if last != 0:
            difference = load_word(last, CONTACT_HASH) ^ name
            if difference == 0:
                last_ax = load_double(last, CONTACT_R1)
                last_ay = load_double(last, CONTACT_R1 + 8)
                last_bx = load_double(last, CONTACT_R2)
                last_by = load_double(last, CONTACT_R2 + 8)
            elif difference == 1:
                last_ax = load_double(last, CONTACT_R2)
                last_ay = load_double(last, CONTACT_R2 + 8)
                last_bx = load_double(last, CONTACT_R1)
                last_by = load_double(last, CONTACT_R1 + 8)
            else:
                last = 0

        start_x = 0.0
        start_y = 0.0
        if a_is_ellipse:
            ellipse = place_ellipse(shape_a, body_a)
            round_shapes = ellipse[0] == ellipse[1]
            if last != 0:
                start_x, start_y = normal_at(ellipse, ax + last_ax, ay + last_ay)
            if b_is_ellipse:
                other = place_ellipse(shape_b, body_b)
                round_shapes = round_shapes and other[0] == other[1]
                contact = contact_with_ellipse(ellipse, other, start_x, start_y)
            else:
                contact = contact_with_shape(ellipse, shape_b, body_b, start_x, start_y)
        else:
            ellipse = place_ellipse(shape_b, body_b)
            round_shapes = ellipse[0] == ellipse[1]
            if last != 0:
                start_x, start_y = normal_at(ellipse, bx + last_bx, by + last_by)
            contact = contact_with_shape(ellipse, shape_a, body_a, start_x, start_y)
        distance, nx, ny, px, py, _evaluations = contact

        if distance > 0.0:
            store_int(arbiter, ARBITER_STATE, IGNORE)
            store_word(arbiter, ARBITER_DATA, 0)
            return

        rolls = (
            last != 0 and not round_shapes and same_contact(nx, ny, start_x, start_y)
        )
        x = ellipse[4] + px
        y = ellipse[5] + py
        other_x = x + distance * nx
        other_y = y + distance * ny
        if not a_is_ellipse:
            x, y, other_x, other_y = other_x, other_y, x, y
            nx = -nx
            ny = -ny
        x -= ax
        y -= ay
        other_x -= bx
        other_y -= by

        turn_surface_velocity(arbiter, shape_a, shape_b, nx, ny)
        if rolls:
            vx, vy = rolling_velocity(
                load_double(body_a, BODY_SPIN),
                load_double(body_b, BODY_SPIN),
                x - last_ax,
                y - last_ay,
                other_x - last_bx,
                other_y - last_by,
            )
            add_surface_velocity(arbiter, vx, vy)

        if state == IGNORE or not touched:
            store_int(arbiter, ARBITER_STATE, FIRST_COLLISION)
        store_int(arbiter, ARBITER_COUNT, 1)
        store_double(arbiter, ARBITER_NORMAL, nx)
        store_double(arbiter, ARBITER_NORMAL + 8, ny)
        point = load_word(arbiter, ARBITER_CONTACTS)
        store_double(point, CONTACT_R1, x)
        store_double(point, CONTACT_R1 + 8, y)
        store_double(point, CONTACT_R2, other_x)
        store_double(point, CONTACT_R2 + 8, other_y)
        store_word(point, CONTACT_HASH, name)
        normal_impulse = 0.0
        tangent_impulse = 0.0
        if last != 0:
            normal_impulse = load_double(last, CONTACT_NORMAL_IMPULSE)
            tangent_impulse = load_double(last, CONTACT_TANGENT_IMPULSE)
        store_double(point, CONTACT_NORMAL_IMPULSE, normal_impulse)
        store_double(point, CONTACT_TANGENT_IMPULSE, tangent_impulse)
        store_word(arbiter, ARBITER_DATA, point)

    return pre_solve


def _version() -> int:
    """A number that changes with everything the compiled code is made from and numba does not watch."""
    digest = hashlib.sha256()
    for module in (*_NARROWPHASE, _layout, _memory):
        assert module.__file__ is not None
        digest.update(Path(module.__file__).read_bytes())
    for name in sorted(globals()):
        if name.startswith(("ARBITER_", "CONTACT_")):
            digest.update(f"{name}={globals()[name]}".encode())
    return int.from_bytes(digest.digest()[:7], "big") + 1


class _Announcement(Listener):
    """Logs that a compilation begins, once."""

    def __init__(self) -> None:
        self.made = False

    def on_start(self, event: Event) -> None:
        if not self.made:
            self.made = True
            _logger.info("compiling the contact callback, this once, for some seconds")

    def on_end(self, event: Event) -> None:
        pass


# Taken from the sources when they are imported, as they are what is compiled.
_VERSION = _version()


def compile_pre_solve() -> Any:
    """The callback as a C function pointer for cpCollisionHandler.preSolveFunc; compiled, or taken from numba's cache."""
    pointers = numba.types.void(*[numba.types.int64] * 3)
    function = _define(_VERSION)
    with install_listener("numba:run_pass", _Announcement()):
        try:
            callback = numba.cfunc(pointers, cache=True, error_model="numpy")(function)
        except RuntimeError:
            # Nowhere to write a cache.
            callback = numba.cfunc(pointers, error_model="numpy")(function)
    # The pointer is good as long as the callback object lives.
    return callback
