"""pre_solve: reads an arbiter, asks the narrow phase and writes the exact contact back; in Python and compiled."""

from __future__ import annotations

from typing import Any

from ..chipmunk.structs import (
    FIRST_COLLISION,
    IGNORE,
    arbiter_at,
    ellipse_class,
    frame_in,
    hull_at,
    space_at,
)
from ..narrowphase.ellipse_ellipse import ellipse_ellipse
from ..narrowphase.frame import normal_at
from ..narrowphase.rolling import rolling_velocity, same_contact
from .handover import keep_contact, last_on_body
from .pair import contact_with


def pre_solve(address: int, space_address: int) -> None:
    """Replace the contact of two hulls by that of the shapes they stand for.

    The addresses are those of a cpArbiter that Chipmunk is about to solve, and of its cpSpace.
    The arbiter's data points to the contact of the last step, or is zero if the two did not
    touch in it.
    """
    arbiter = arbiter_at(address)
    shape_a = arbiter.shape_a
    shape_b = arbiter.shape_b
    a_is_ellipse = shape_a.klass == ellipse_class()
    b_is_ellipse = shape_b.klass == ellipse_class()
    if not a_is_ellipse and not b_is_ellipse:
        return

    # The hash names the arbiter and the order of its shapes, which Chipmunk may swap.
    name = address + 1 if arbiter.a < arbiter.b else address
    data = arbiter.data
    if data == arbiter.contacts and arbiter.contact.hash == name:
        # Resolved in this step already, for a callback, which may have changed it since.
        return

    body_a = arbiter.body_a
    body_b = arbiter.body_b
    # Chipmunk measures contact points from the centres of gravity.
    center_a = body_a.p
    center_b = body_b.p
    ax = center_a.x
    ay = center_a.y
    bx = center_b.x
    by = center_b.y

    # Last step's contact gives its impulses and a normal to start from. With another name it is
    # another contact: the pair was not solved or slept, and Chipmunk has used the memory again.
    state = arbiter.state
    lasts = False
    normal_impulse = tangent_impulse = 0.0
    last_ax = last_ay = last_bx = last_by = 0.0
    if data != 0 and state != FIRST_COLLISION:
        last = arbiter.last
        difference = last.hash ^ name
        if difference == 0 or difference == 1:
            lasts = True
            last_a = last.r1 if difference == 0 else last.r2
            last_b = last.r2 if difference == 0 else last.r1
            last_ax = last_a.x
            last_ay = last_a.y
            last_bx = last_b.x
            last_by = last_b.y
            normal_impulse = last.jnAcc
            tangent_impulse = last.jtAcc

    start_x = start_y = 0.0
    if a_is_ellipse:
        ellipse = frame_in(hull_at(shape_a).world)
        round_shapes = ellipse[0] == ellipse[1]
        if lasts:
            start_x, start_y = normal_at(ellipse, ax + last_ax, ay + last_ay)
        if b_is_ellipse:
            other = frame_in(hull_at(shape_b).world)
            round_shapes = round_shapes and other[0] == other[1]
            contact = ellipse_ellipse(ellipse, other, start_x, start_y)
        else:
            contact = contact_with(ellipse, shape_b, False, start_x, start_y)
    else:
        ellipse = frame_in(hull_at(shape_b).world)
        round_shapes = ellipse[0] == ellipse[1]
        if lasts:
            start_x, start_y = normal_at(ellipse, bx + last_bx, by + last_by)
        contact = contact_with(ellipse, shape_a, False, start_x, start_y)
    distance, nx, ny, px, py = contact

    if distance > 0.0:
        arbiter.state = IGNORE
        arbiter.data = 0
        return

    # A circle's contact stays where it is; without this it would differ from pymunk.Circle's in
    # what little it moves at a corner.
    rolls = lasts and not round_shapes and same_contact(nx, ny, start_x, start_y)
    if not (a_is_ellipse and b_is_ellipse):
        step = space_at(space_address).stamp
        hull = hull_at(shape_a if a_is_ellipse else shape_b)
        body = body_b if a_is_ellipse else body_a
        on_body = shape_b.on_body if a_is_ellipse else shape_a.on_body
        at = body.transform
        mx = at.a * nx + at.b * ny
        my = at.a * ny - at.b * nx
        if not lasts and not round_shapes:
            rolls, ex, ey, ox, oy = last_on_body(hull, on_body, step, mx, my)
            last_ax, last_ay = (ex, ey) if a_is_ellipse else (ox, oy)
            last_bx, last_by = (ox, oy) if a_is_ellipse else (ex, ey)
        keep_contact(hull, arbiter.contacts, name, on_body, step, a_is_ellipse, mx, my)
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

    turn_surface_velocity(arbiter, nx, ny)
    if rolls:
        vx, vy = rolling_velocity(
            body_a.w,
            body_b.w,
            x - last_ax,
            y - last_ay,
            other_x - last_bx,
            other_y - last_by,
        )
        surface = arbiter.surface_vr
        surface.x += vx
        surface.y += vy

    if state == IGNORE or data == 0:
        arbiter.state = FIRST_COLLISION
    arbiter.count = 1
    normal = arbiter.n
    normal.x = nx
    normal.y = ny
    point = arbiter.contact
    on_a = point.r1
    on_a.x = x
    on_a.y = y
    on_b = point.r2
    on_b.x = other_x
    on_b.y = other_y
    point.hash = name
    point.jnAcc = normal_impulse
    point.jtAcc = tangent_impulse
    arbiter.data = arbiter.contacts


def turn_surface_velocity(arbiter: Any, nx: float, ny: float) -> None:
    """Project the shapes' surface velocity along the exact normal where Chipmunk did along the hull's.

    One that a callback has set since is left alone.
    """
    of_a = arbiter.shape_a.surfaceV
    of_b = arbiter.shape_b.surfaceV
    vx = of_b.x - of_a.x
    vy = of_b.y - of_a.y
    if vx == 0.0 and vy == 0.0:
        return
    hull = arbiter.n
    along = vx * hull.x + vy * hull.y
    surface = arbiter.surface_vr
    if surface.x == vx - hull.x * along and surface.y == vy - hull.y * along:
        along = vx * nx + vy * ny
        surface.x = vx - nx * along
        surface.y = vy - ny * along
