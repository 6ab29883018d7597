"""The velocity that two shapes in rolling contact should have where they touch, to stay in contact over a whole step."""

from __future__ import annotations


def rolling_velocity(
    spin_a: float,
    spin_b: float,
    dax: float,
    day: float,
    dbx: float,
    dby: float,
) -> tuple[float, float]:
    """Velocity of body a relative to b where they touch, for rolling about the middle of the step to come.

    A solver that leaves no relative velocity at the contact point makes the shapes roll about
    where they touched as the step began. The point wanders, and each step corrects the
    velocity for it by a plastic impact: a rocking ellipse loses height and its period with it,
    in proportion to the step. If instead no velocity is left at the point where they will touch
    in the middle of the step, position and energy are right to second order. That point lies
    half a step on: (da, db) / 2 away, where da and db are the changes of the contact point,
    seen from the two centres of gravity, over the last step. Spins are in radians per second.

    Two that do not spin, or touch where they did, get zero.

    >>> rolling_velocity(0.0, 2.0, 0.0, 0.0, 0.5, 0.0)
    (0.0, 0.5)
    """
    return 0.5 * (spin_a * day - spin_b * dby), 0.5 * (spin_b * dbx - spin_a * dax)


def with_restitution(
    x: float, y: float, nx: float, ny: float, elasticity: float
) -> tuple[float, float]:
    """The velocity (x, y) of rolling, for a contact that is elastic, along the unit normal (nx, ny).

    Restitution is for what comes closer beyond rolling. Two that roll have a normal velocity s_n
    where they touch as the step begins, and should have -s_n where they will touch by its
    middle, so with a normal velocity u_n they should have -s_n - e (u_n - s_n), which is
    -e u_n - (1 - e) s_n. A solver that gives -e u_n less the velocity handed to it is
    to get s - e s_n n. The speed afterwards is at most the larger of u_n and s_n: restitution
    makes no energy of rolling.

    >>> with_restitution(2.0, 3.0, 0.0, 1.0, 0.5)
    (2.0, 1.5)
    """
    along = elasticity * (x * nx + y * ny)
    return x - along * nx, y - along * ny


def same_contact(nx: float, ny: float, last_x: float, last_y: float) -> bool:
    """Whether a contact can have rolled from one normal, of any length, to the unit vector (nx, ny), or has jumped."""
    along = nx * last_x + ny * last_y
    across = nx * last_y - ny * last_x
    return along > 2.0 * abs(across)
