"""pre_solve in Python: reads an arbiter, asks the narrow phase and writes the exact contact back."""

from __future__ import annotations

from typing import Any

from pymunk import Circle, Segment, Shape

from ._pymunk import FIRST_COLLISION, IGNORE, NULL, contact_at, contact_name, shape_at
from .geometry import (
    Transform,
    circle_in_world,
    polygon_in_world,
    segment_in_world,
    state_of,
    surface_velocity,
)
from .narrowphase.ellipse_ellipse import Contact, ellipse_ellipse
from .narrowphase.ellipse_polygon import ellipse_polygon, ellipse_segment
from .narrowphase.placement import Frame, normal_at, placed
from .narrowphase.rolling import rolling_velocity, same_contact


def contact_with_ellipse(
    first: Frame, second: Frame, nx: float, ny: float, margin: float
) -> Contact:
    """The contact of two ellipses in the world, found from the normal (nx, ny) on."""
    a1, b1, c1, s1, x1, y1 = first
    a2, b2, c2, s2, x2, y2 = second
    return ellipse_ellipse(
        a1, b1, c1, s1, a2, b2, c2, s2, x2 - x1, y2 - y1, nx, ny, margin
    )


def contact_with_shape(
    ellipse: Frame,
    shape: Shape,
    transform: Transform,
    nx: float,
    ny: float,
    margin: float,
) -> Contact:
    """The contact of an ellipse in the world and one of pymunk's own shapes on a body with this transform."""
    a, b, c, s, x, y = ellipse
    if isinstance(shape, Circle):
        cx, cy, radius = circle_in_world(shape._shape, transform)
        return ellipse_ellipse(
            a, b, c, s, radius, radius, 1.0, 0.0, cx - x, cy - y, nx, ny, margin
        )
    if isinstance(shape, Segment):
        ends, tangents, radius = segment_in_world(shape._shape, transform)
        return ellipse_segment(a, b, c, s, x, y, *ends, *tangents, radius, margin)
    planes, count, radius = polygon_in_world(shape._shape, transform)
    return ellipse_polygon(a, b, c, s, x, y, planes, count, radius, margin)[:6]


def pre_solve(ellipses: dict[Any, Frame], arbiter: Any) -> None:
    """Replace the contact of two hulls by that of the shapes they stand for.

    ellipses holds the frame of each ellipse in the space, in body local coordinates, by its
    C shape. arbiter is a cpArbiter that Chipmunk is about to solve. Its data points to the
    contact of the last step, or is NULL if the two did not touch in it.
    """
    cp_a = arbiter.a
    cp_b = arbiter.b
    frame_a = ellipses.get(cp_a)
    frame_b = ellipses.get(cp_b)
    if frame_a is None and frame_b is None:
        return

    ox_a, oy_a, cos_a, sin_a, ax, ay, spin_a = state_of(arbiter.body_a)
    ox_b, oy_b, cos_b, sin_b, bx, by, spin_b = state_of(arbiter.body_b)

    # Last step's contact gives its impulses and a normal to start from. Its hash names the
    # arbiter and the order of its shapes; anything else there is another contact: the pair was
    # not solved or slept, and Chipmunk has used the memory again.
    name = contact_name(arbiter)
    state = arbiter.state
    data = arbiter.data
    last = None
    if data and state != FIRST_COLLISION:
        last = contact_at(data)
        difference = last.hash ^ name
        if difference == 0:
            last_a, last_b = last.r1, last.r2
        elif difference == 1:
            last_a, last_b = last.r2, last.r1
        else:
            last = None
    if last is not None:
        last_ax = last_a.x
        last_ay = last_a.y
        last_bx = last_b.x
        last_by = last_b.y

    start_x = start_y = 0.0
    if frame_a is not None:
        ellipse = placed(frame_a, ox_a, oy_a, cos_a, sin_a)
        round_shapes = ellipse[0] == ellipse[1]
        if last is not None:
            start_x, start_y = normal_at(ellipse, ax + last_ax, ay + last_ay)
        if frame_b is not None:
            other = placed(frame_b, ox_b, oy_b, cos_b, sin_b)
            round_shapes = round_shapes and other[0] == other[1]
            contact = contact_with_ellipse(ellipse, other, start_x, start_y, 0.0)
        else:
            contact = contact_with_shape(
                ellipse,
                shape_at(cp_b),
                (ox_b, oy_b, cos_b, sin_b),
                start_x,
                start_y,
                0.0,
            )
    else:
        assert frame_b is not None
        ellipse = placed(frame_b, ox_b, oy_b, cos_b, sin_b)
        round_shapes = ellipse[0] == ellipse[1]
        if last is not None:
            start_x, start_y = normal_at(ellipse, bx + last_bx, by + last_by)
        contact = contact_with_shape(
            ellipse, shape_at(cp_a), (ox_a, oy_a, cos_a, sin_a), start_x, start_y, 0.0
        )
    distance, nx, ny, px, py, _evaluations = contact

    if distance > 0.0:
        arbiter.state = IGNORE
        arbiter.data = NULL
        return

    # A circle's contact stays where it is; without this it would differ from pymunk.Circle's in
    # what little it moves at a corner.
    rolls = (
        last is not None and not round_shapes and same_contact(nx, ny, start_x, start_y)
    )
    x = ellipse[4] + px
    y = ellipse[5] + py
    other_x = x + distance * nx
    other_y = y + distance * ny
    if frame_a is None:
        x, y, other_x, other_y = other_x, other_y, x, y
        nx = -nx
        ny = -ny
    x -= ax
    y -= ay
    other_x -= bx
    other_y -= by

    vx, vy = surface_velocity(cp_a, cp_b)
    if vx != 0.0 or vy != 0.0:
        turn_surface_velocity(arbiter, vx, vy, nx, ny)
    if rolls:
        vx, vy = rolling_velocity(
            spin_a,
            spin_b,
            x - last_ax,
            y - last_ay,
            other_x - last_bx,
            other_y - last_by,
        )
        surface = arbiter.surface_vr
        surface.x += vx
        surface.y += vy

    if state == IGNORE or not data:
        arbiter.state = FIRST_COLLISION
    arbiter.count = 1
    normal = arbiter.n
    normal.x = nx
    normal.y = ny
    contacts = arbiter.contacts
    point = contacts[0]
    r1 = point.r1
    r1.x = x
    r1.y = y
    r2 = point.r2
    r2.x = other_x
    r2.y = other_y
    point.hash = name
    if last is not None:
        point.jnAcc = last.jnAcc
        point.jtAcc = last.jtAcc
    else:
        point.jnAcc = point.jtAcc = 0.0
    arbiter.data = contacts


def turn_surface_velocity(
    arbiter: Any, vx: float, vy: float, nx: float, ny: float
) -> None:
    """Project the shapes' surface velocity along the exact normal where Chipmunk did along the hull's.

    One that a callback has set since is left alone.
    """
    hull = arbiter.n
    along = vx * hull.x + vy * hull.y
    surface = arbiter.surface_vr
    if surface.x == vx - hull.x * along and surface.y == vy - hull.y * along:
        along = vx * nx + vy * ny
        surface.x = vx - nx * along
        surface.y = vy - ny * along
