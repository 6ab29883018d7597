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
from ..narrowphase.frame import normal_at
from ..narrowphase.rolling import rolling_velocity, same_contact, with_restitution
from .handover import keep_contact, last_on_body
from .impacts import NO_IMPACT, SWITCHED_OFF, carry_on, impact_of, mark_touched
from .pair import contact_of

# How far a round ellipse's centre may be off the centre of gravity, in its radius.
CENTERED = 1e-9


def resolve(address: int, space_address: int, exact_impacts: bool) -> None:
    """Replace the contact of two hulls by that of the shapes they stand for.

    The addresses are those of a cpArbiter that Chipmunk is about to solve, and of its cpSpace.
    The arbiter's data points to the contact of the last step, or is zero if the two did not
    touch in it. With exact_impacts an impact is resolved at its own time.

    What depends on numbers that callbacks may set is left to complete. What that needs is kept
    in fields of the contact that Chipmunk fills only after all callbacks: the velocity of
    rolling in nMass and tMass, and how long ago an impact was in bounce.
    """
    arbiter = arbiter_at(address)
    shape_a = arbiter.shape_a
    shape_b = arbiter.shape_b
    a_is_ellipse = shape_a.klass == ellipse_class()
    b_is_ellipse = shape_b.klass == ellipse_class()
    if not a_is_ellipse and not b_is_ellipse:
        return

    name = name_of(arbiter, address)
    if is_resolved(arbiter, name):
        # For a callback, which may have changed it since.
        return

    # The contact is found from an ellipse, a if both are.
    mine = shape_a if a_is_ellipse else shape_b
    other = shape_b if a_is_ellipse else shape_a
    body = arbiter.body_a if a_is_ellipse else arbiter.body_b
    other_body = arbiter.body_b if a_is_ellipse else arbiter.body_a
    # Chipmunk measures contact points from the centres of gravity.
    center = body.p
    other_center = other_body.p

    # Last step's contact gives its impulses and a normal to start from. With another name it is
    # another contact: the pair was not solved or slept, and Chipmunk has used the memory again.
    state = arbiter.state
    data = arbiter.data
    lasts = False
    normal_impulse = tangent_impulse = 0.0
    last_x = last_y = last_ox = last_oy = 0.0
    if data != 0 and state != FIRST_COLLISION:
        last = arbiter.last
        difference = last.hash ^ name
        if difference == 0 or difference == 1:
            lasts = True
            in_order = (difference == 0) == a_is_ellipse
            last_mine = last.r1 if in_order else last.r2
            last_other = last.r2 if in_order else last.r1
            last_x = last_mine.x
            last_y = last_mine.y
            last_ox = last_other.x
            last_oy = last_other.y
            normal_impulse = last.jnAcc
            tangent_impulse = last.jtAcc

    ellipse = frame_in(hull_at(mine).world)
    start_x = start_y = 0.0
    if lasts:
        start_x, start_y = normal_at(ellipse, center.x + last_x, center.y + last_y)
    contact = contact_of(ellipse, other, start_x, start_y)
    distance, nx, ny, px, py = contact

    if distance > 0.0:
        arbiter.state = IGNORE
        arbiter.data = 0
        return

    # The contact points from the centres of gravity.
    x = ellipse[4] + px
    y = ellipse[5] + py
    ox = x + distance * nx - other_center.x
    oy = y + distance * ny - other_center.y
    x -= center.x
    y -= center.y

    space = space_at(space_address)
    other_is_ellipse = other.klass == ellipse_class()
    # A pair of circles stays as pymunk has it.
    circles = rolls_as_circle(mine, body) and (
        not other_is_ellipse or rolls_as_circle(other, other_body)
    )
    rolls = lasts and not circles and same_contact(nx, ny, start_x, start_y)
    if not lasts and not circles and not other_is_ellipse:
        mx, my = normal_on(other_body, nx, ny)
        rolls, last_x, last_y, last_ox, last_oy = last_on_body(
            hull_at(mine), other.on_body, space.stamp, mx, my
        )
    roll_x = roll_y = 0.0
    time = NO_IMPACT if exact_impacts else SWITCHED_OFF
    if rolls:
        roll_x, roll_y = rolling_velocity(
            body.w, other_body.w, x - last_x, y - last_y, ox - last_ox, oy - last_oy
        )
    elif exact_impacts and not lasts and not circles:
        time, met = impact_of(ellipse, mine, body, other, other_body, contact, space)
        if time != NO_IMPACT:
            _distance, nx, ny, x, y, ox, oy = met
    if not other_is_ellipse:
        mx, my = normal_on(other_body, nx, ny)
        keep_contact(
            hull_at(mine),
            arbiter.contacts,
            name,
            other.on_body,
            space.stamp,
            a_is_ellipse,
            mx,
            my,
        )

    if not a_is_ellipse:
        x, y, ox, oy = ox, oy, x, y
        nx = -nx
        ny = -ny
        roll_x = -roll_x
        roll_y = -roll_y
    turn_surface_velocity(arbiter, nx, ny)
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
    on_b.x = ox
    on_b.y = oy
    point.hash = name
    point.jnAcc = normal_impulse
    point.jtAcc = tangent_impulse
    point.nMass = roll_x
    point.tMass = roll_y
    point.bounce = time
    arbiter.data = arbiter.contacts


def complete(address: int, space_address: int) -> None:
    """Give a resolved contact what depends on numbers that callbacks may have set: after the last of them, before Chipmunk solves it."""
    arbiter = arbiter_at(address)
    if not is_resolved(arbiter, name_of(arbiter, address)):
        return
    point = arbiter.contact
    normal = arbiter.n
    roll_x, roll_y = with_restitution(
        point.nMass, point.tMass, normal.x, normal.y, arbiter.e
    )
    surface = arbiter.surface_vr
    surface.x += roll_x
    surface.y += roll_y
    if point.bounce == SWITCHED_OFF or arbiter.processCollision == 0:
        return
    space = space_at(space_address)
    if point.bounce != NO_IMPACT:
        carry_on(arbiter, space, point.bounce)
    shape_a = arbiter.shape_a
    shape_b = arbiter.shape_b
    if shape_a.sensor == 0 and shape_b.sensor == 0:
        mark_touched(shape_a, space)
        mark_touched(shape_b, space)


def name_of(arbiter: Any, address: int) -> int:
    """What a resolved contact's hash is: it names the arbiter and the order of its shapes, which Chipmunk may swap."""
    return address + 1 if arbiter.a < arbiter.b else address


def is_resolved(arbiter: Any, name: int) -> bool:
    """Whether an arbiter's contact is that of the ellipses already in this step."""
    resolved: bool = arbiter.data == arbiter.contacts and arbiter.contact.hash == name
    return resolved


def normal_on(body: Any, nx: float, ny: float) -> tuple[float, float]:
    """The normal (nx, ny) in a body's coordinates."""
    at = body.transform
    return at.a * nx + at.b * ny, at.a * ny - at.b * nx


def rolls_as_circle(shape: Any, body: Any) -> bool:
    """Whether an ellipse is round, and about its body's centre of gravity or on a body that does not turn.

    Its contact stays where it is. With the velocity of rolling it would differ from
    pymunk.Circle's in what little it moves at a corner.
    """
    local = hull_at(shape).local
    a: float = local[0]
    if a != local[1]:
        return False
    if body.i_inv == 0.0 and body.w == 0.0:
        return True
    center = body.cog
    off = abs(local[4] - center.x) + abs(local[5] - center.y)
    centered: bool = off <= CENTERED * a
    return centered


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
