"""Impacts at their own time, on Chipmunk's structs: when two shapes met inside of the step, and what that does to their bodies."""

from __future__ import annotations

from math import sqrt
from typing import Any

from ..chipmunk.structs import ellipse_class, frame_in, hull_at
from ..narrowphase.ellipse_ellipse import Contact
from ..narrowphase.frame import Frame, curvature_radius
from ..narrowphase.impact import (
    Meeting,
    Motion,
    carried_on,
    contact_mass,
    lasting_speed,
    meeting_earlier,
    predicted_impulse,
    relative_velocity,
    seen_earlier,
)
from .pair import contact_of, half_thickness

# In place of the time of an impact: where there is none, and where none is asked for.
NO_IMPACT = -1.0
SWITCHED_OFF = -2.0

# How far a body may move in the step after it was hit by another one, in half of what its shape
# is thick. If it is carried on farther, it may pass a thin wall behind it.
CARRIED_MOST = 0.75

# How often the time of an impact is corrected. Each time doubles its right digits; what is left
# changes the angular momentum when there is friction.
CORRECTIONS = 2


def motion_of(body: Any) -> Motion:
    """Where a body is, and how it moves."""
    at = body.p
    velocity = body.v
    return at.x, at.y, velocity.x, velocity.y, body.w


def impact_of(
    ellipse: Frame,
    shape: Any,
    body: Any,
    other: Any,
    other_body: Any,
    contact: Contact,
    space: Any,
) -> tuple[float, Meeting]:
    """How long ago an ellipse and another shape, which have a new contact, have hit each other, and how; NO_IMPACT if they did not in this step.

    There is none either where the impulse cannot be told ahead, because something else pushes
    one of them as well. shape is that of the ellipse, on its body.
    """
    one = motion_of(body)
    another = motion_of(other_body)
    now = meeting_earlier(contact, ellipse, one, another, 0.0)
    if not (
        shape.sensor == 0
        and other.sensor == 0
        # No impulse moves one of two kinematic bodies.
        and body.m_inv + other_body.m_inv > 0.0
        and is_free(body, space)
        and is_free(other_body, space)
        and touched_nothing(shape, space)
        and touched_nothing(other, space)
    ):
        return NO_IMPACT, now
    return when_met(ellipse, other, contact, one, another, space)


def is_free(body: Any, space: Any) -> bool:
    """Whether an impulse moves a body as its mass says: it has no joints, and pymunk alone integrates it; or it does not move at all."""
    if body.m_inv == 0.0:
        return True
    usual = space.static_body
    integrated: bool = (
        body.velocity_func == usual.velocity_func
        and body.position_func == usual.position_func
    )
    return integrated and body.constraints == 0


def mark_touched(shape: Any, space: Any) -> None:
    """Note that an ellipse has a contact in this step."""
    if shape.klass == ellipse_class():
        hull_at(shape).touched_in = space.stamp


def touched_nothing(shape: Any, space: Any) -> bool:
    """Whether an ellipse has had no contact in the last step and none in this one so far; of other shapes it is not known."""
    if shape.klass != ellipse_class():
        return True
    ago: int = space.stamp - hull_at(shape).touched_in
    return ago > 1


def when_met(
    ellipse: Frame,
    shape: Any,
    contact: Contact,
    one: Motion,
    other: Motion,
    space: Any,
) -> tuple[float, Meeting]:
    """How long ago an ellipse that moves as one and a shape that moves as the other have met, and how; NO_IMPACT if they did not in this step.

    contact is the one that they have now, overlapped.
    """
    distance, nx, ny, _px, _py = contact
    now = meeting_earlier(contact, ellipse, one, other, 0.0)
    approach, _sliding = relative_velocity(one, other, now)
    radius = curvature_radius(ellipse, nx, ny)
    other_radius = 0.0
    if shape.klass == ellipse_class():
        other_radius = curvature_radius(frame_in(hull_at(shape).world), nx, ny)
    gravity = space.gravity
    down = sqrt(gravity.x * gravity.x + gravity.y * gravity.y)
    dt = space.curr_dt
    lasting = lasting_speed(one, other, now, radius, other_radius, down, dt)
    if -approach <= lasting:
        return NO_IMPACT, now

    time = min(distance / approach, dt)
    for correction in range(CORRECTIONS + 1):
        seen = seen_earlier(ellipse, one, other, time)
        # Seen from the other the normal hardly turns: a good one to start from.
        then = contact_of(seen, shape, nx, ny)
        met = meeting_earlier(then, seen, one, other, time)
        approach, _sliding = relative_velocity(one, other, met)
        # An end of a segment that counts now may not have counted then, and be as far as it gets.
        if approach >= 0.0 or abs(met[0]) > -approach * dt:
            break
        if correction == CORRECTIONS:
            return time, met
        time += met[0] / approach
        if time > dt:
            # They have overlapped before.
            break
        time = max(time, 0.0)
    return NO_IMPACT, now


def acceleration_of(body: Any, space: Any) -> Motion:
    """What gravity and a body's forces do to it, as a motion has velocities."""
    mass = body.m_inv
    if mass == 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0
    gravity = space.gravity
    force = body.f
    return (
        0.0,
        0.0,
        gravity.x + force.x * mass,
        gravity.y + force.y * mass,
        body.t * body.i_inv,
    )


def carry_on(arbiter: Any, space: Any, time: float) -> None:
    """Put the bodies of an impact where it has carried them since, and have the solver give them the velocities that they have got by then.

    The arbiter's contact is that of the impact. Bias velocities move the bodies in the next
    step, and are no part of their velocities.
    """
    body_a = arbiter.body_a
    body_b = arbiter.body_b
    a = motion_of(body_a)
    b = motion_of(body_b)
    normal = arbiter.n
    nx = normal.x
    ny = normal.y
    point = arbiter.contact
    on_a = point.r1
    on_b = point.r2
    ax = on_a.x
    ay = on_a.y
    bx = on_b.x
    by = on_b.y
    met = (0.0, nx, ny, ax, ay, bx, by)
    approach, sliding = relative_velocity(a, b, met)
    accelerations = relative_velocity(
        acceleration_of(body_a, space), acceleration_of(body_b, space), met
    )
    dt = space.curr_dt
    rise, along, moved, elasticity = carried_on(
        approach, accelerations, arbiter.e, time, dt, space.collisionSlop
    )
    surface = arbiter.surface_vr
    inertia_a = (body_a.m_inv, body_a.i_inv)
    inertia_b = (body_b.m_inv, body_b.i_inv)
    jn, jt = predicted_impulse(
        contact_mass(inertia_a, inertia_b, met),
        approach,
        sliding + surface.y * nx - surface.x * ny,
        elasticity,
        arbiter.u,
        space.iterations,
    )
    surface.x -= rise * nx - along * ny
    surface.y -= rise * ny + along * nx
    part = moved / dt
    jx = jn * nx - jt * ny
    jy = jn * ny + jt * nx
    push(body_a, -part * jx, -part * jy, ax, ay)
    push(body_b, part * jx, part * jy, bx, by)
    if body_a.m_inv > 0.0 and body_b.m_inv > 0.0:
        hold(body_a, -jx, -jy, CARRIED_MOST * half_thickness(arbiter.shape_a), dt)
        hold(body_b, jx, jy, CARRIED_MOST * half_thickness(arbiter.shape_b), dt)


def push(body: Any, jx: float, jy: float, x: float, y: float) -> None:
    """Change a body's bias velocities as an impulse at the point (x, y) from its centre of gravity would."""
    bias = body.v_bias
    bias.x += jx * body.m_inv
    bias.y += jy * body.m_inv
    body.w_bias += (x * jy - y * jx) * body.i_inv


def hold(body: Any, jx: float, jy: float, most: float, dt: float) -> None:
    """Shorten a body's bias velocities, if with them and the velocity that an impulse gives it would go farther than most in the next step."""
    velocity = body.v
    bias = body.v_bias
    x = velocity.x + jx * body.m_inv
    y = velocity.y + jy * body.m_inv
    alone = dt * sqrt(x * x + y * y)
    carried = dt * sqrt(bias.x * bias.x + bias.y * bias.y)
    if alone + carried > most and carried > 0.0:
        part = max(0.0, (most - alone) / carried)
        bias.x *= part
        bias.y *= part
        body.w_bias *= part
