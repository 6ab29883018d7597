"""A collision at the time when the shapes met, inside of a step: the contact as it was then, and what it has done to the bodies since.

A step first moves the bodies, then finds the contacts, then changes the velocities. So two shapes
that met on the way, a time tau ago, are found overlapped by what they moved since, with the
normal and the points of that late place. Velocities and places are then wrong to first order
in the step. They are right to second order if

- the impulse acts at the normal and the points of the time of the impact,
- the bodies are where that impulse, had it acted then, would have carried them by now,
- the velocities, which Chipmunk keeps half a step ahead of the places (a leapfrog method), get
  the accelerations' parts of before the impact and of after it.

All three belong together: the first alone breaks the angular momentum, the second the energy.

"One" is the body with the ellipse that the contact was found from, "other" the one with the
other shape; relative is the other's less one's, and normals lead from one to the other.
"""

from __future__ import annotations

from math import cos, sin

from .ellipse_ellipse import Contact
from .frame import Frame

# A body's centre of gravity (x, y), velocity (x, y) and spin.
Motion = tuple[float, float, float, float, float]

# Distance, unit normal (x, y), and the contact points from the two centres of gravity (x, y each).
Meeting = tuple[float, float, float, float, float, float, float]

# Inverse mass and inverse moment of inertia.
Inertia = tuple[float, float]


def lasting_speed(
    one: Motion,
    other: Motion,
    meeting: Meeting,
    curvature_radius: float,
    other_curvature_radius: float,
    gravity: float,
    dt: float,
) -> float:
    """How fast two shapes can approach in a contact that is new, but no impact: one that is handed over, from a tile to the next.

    A contact that lasts gains the speed of gravity in a step, and two of rolling, for each body
    with a spin w, a radius of curvature rho (zero for corners) and its centre of gravity at the
    height h above the tangent: w^2 rho dt/2, because it rolls about where it will touch in the
    middle of the step, or w^2 (rho - h) 2 dt if for a step it touched nothing. h'' is rho - h,
    and the velocity is the one of the middle of that step, three halves of a step ago; half a
    step more is for what the curvature has changed since.
    """
    _distance, nx, ny, x, y, ox, oy = meeting
    spin = one[4]
    other_spin = other[4]
    height = x * nx + y * ny
    other_height = -(ox * nx + oy * ny)
    rolling = (
        spin * spin * max(0.5 * curvature_radius, 2.0 * (curvature_radius - height))
    )
    other_rolling = (
        other_spin
        * other_spin
        * max(
            0.5 * other_curvature_radius, 2.0 * (other_curvature_radius - other_height)
        )
    )
    return (gravity + rolling + other_rolling) * dt


def relative_velocity(
    one: Motion, other: Motion, meeting: Meeting
) -> tuple[float, float]:
    """Along the normal, negative on approach, and along the tangent, the normal turned by a quarter."""
    _x, _y, vx, vy, spin = one
    _ox, _oy, ovx, ovy, other_spin = other
    _distance, nx, ny, x, y, ox, oy = meeting
    ux = ovx - other_spin * oy - vx + spin * y
    uy = ovy + other_spin * ox - vy - spin * x
    return ux * nx + uy * ny, uy * nx - ux * ny


def seen_earlier(frame: Frame, one: Motion, other: Motion, time: float) -> Frame:
    """An ellipse on body one as it was a time ago, where it is seen from the other body as that is now.

    Bodies turn about their centres of gravity. Seen from the other body its own shape has not
    moved, so that none but the ellipse has to be put anywhere.

    >>> here, falling = (0.0, 0.0, 0.0, 0.0, 0.0), (0.0, 5.0, 0.0, -2.0, 0.0)
    >>> seen_earlier((2.0, 1.0, 1.0, 0.0, 0.0, 5.0), falling, here, 0.5)
    (2.0, 1.0, 1.0, 0.0, 0.0, 6.0)
    """
    a, b, c, s, x, y = frame
    gx, gy, vx, vy, spin = one
    ox, oy, ovx, ovy, other_spin = other
    x, y = turned_by(x - gx, y - gy, -spin * time)
    # From the other's centre of gravity, then and now.
    x += gx - ox + (ovx - vx) * time
    y += gy - oy + (ovy - vy) * time
    x, y = turned_by(x, y, other_spin * time)
    c, s = turned_by(c, s, (other_spin - spin) * time)
    return a, b, c, s, x + ox, y + oy


def meeting_earlier(
    contact: Contact, seen: Frame, one: Motion, other: Motion, time: float
) -> Meeting:
    """The contact of an ellipse that is seen so with the other body's shape, put back in the world as it was that time ago."""
    distance, nx, ny, px, py = contact
    _gx, _gy, vx, vy, _spin = one
    ox, oy, ovx, ovy, other_spin = other
    turn = -other_spin * time
    x, y = turned_by(seen[4] + px - ox, seen[5] + py - oy, turn)
    nx, ny = turned_by(nx, ny, turn)
    return (
        distance,
        nx,
        ny,
        x + ox - one[0] + (vx - ovx) * time,
        y + oy - one[1] + (vy - ovy) * time,
        x + distance * nx,
        y + distance * ny,
    )


def turned_by(x: float, y: float, angle: float) -> tuple[float, float]:
    """The vector (x, y) turned counterclockwise."""
    c = cos(angle)
    s = sin(angle)
    return c * x - s * y, s * x + c * y


def contact_mass(
    one: Inertia, other: Inertia, meeting: Meeting
) -> tuple[float, float, float]:
    """What a unit of impulse changes at the contact points.

    Returns the change of the relative velocity along the normal by a normal impulse, of either
    by the other, and along the tangent by a tangential impulse.
    """
    mass, moment = one
    other_mass, other_moment = other
    _distance, nx, ny, x, y, ox, oy = meeting
    across = x * ny - y * nx
    along = x * nx + y * ny
    other_across = ox * ny - oy * nx
    other_along = ox * nx + oy * ny
    return (
        mass
        + other_mass
        + across * across * moment
        + other_across * other_across * other_moment,
        across * along * moment + other_across * other_along * other_moment,
        mass
        + other_mass
        + along * along * moment
        + other_along * other_along * other_moment,
    )


def predicted_impulse(
    mass: tuple[float, float, float],
    normal_velocity: float,
    tangential_velocity: float,
    elasticity: float,
    friction: float,
    iterations: int,
) -> tuple[float, float]:
    """The normal and the tangential impulse that Chipmunk's solver finds for one contact alone.

    It goes as that does (cpArbiterApplyImpulse of Munk2D 2.0): both parts from the same
    velocities, the normal one not negative, the other within the cone of friction, again and
    again. Solving for what it tends to would part from it by what it has left to go, and the
    angular momentum would change by that much.

    >>> predicted_impulse((0.5, 0.0, 0.5), -3.0, 1.0, 0.5, 0.1, 10)
    (9.0, -0.9)
    """
    nn, nt, tt = mass
    bounce = elasticity * normal_velocity
    jn = 0.0
    jt = 0.0
    for _ in range(iterations):
        un = normal_velocity + nn * jn + nt * jt
        ut = tangential_velocity + nt * jn + tt * jt
        jn = max(jn - (bounce + un) / nn, 0.0)
        jt = min(max(jt - ut / tt, -friction * jn), friction * jn)
    return jn, jt


def carried_on(
    normal_velocity: float,
    acceleration: tuple[float, float],
    elasticity: float,
    time: float,
    dt: float,
    slop: float,
) -> tuple[float, float, float, float]:
    """How the motion goes on after an impact that was a time ago: bouncing, or in touch.

    The relative acceleration is that along the normal and along the tangent. Returns the
    relative velocity to aim for beyond that of a bounce (normal, tangential), how long the
    impulse is to have moved the bodies, and the elasticity of that impulse.

    The velocity of before the impact is one of half a step before now. With the acceleration w it
    was u + w (dt/2 - time) at the impact, and that of half a step from now is
    -e (u + w (dt/2 - time)) + w (dt/2 + time) along the normal, where Chipmunk gives -e u; what
    friction has stopped is w (dt/2 + time) along the tangent, where Chipmunk gives zero.

    Two that do not bounce stay in touch: they keep as much of their overlap as Chipmunk
    tolerates, so that the contact lasts, and the acceleration is taken up by it.
    """
    normal, tangential = acceleration
    rise = normal * ((1.0 + elasticity) * time + (1.0 - elasticity) * 0.5 * dt)
    if elasticity > 0.0 and rise - elasticity * normal_velocity > 0.0:
        return rise, tangential * (time + 0.5 * dt), time, elasticity
    return 0.0, 0.0, max(time + slop / normal_velocity, 0.0), 0.0
