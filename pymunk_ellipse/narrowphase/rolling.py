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


def same_contact(nx: float, ny: float, last_x: float, last_y: float) -> bool:
    """Whether a contact can have rolled from one normal, of any length, to the unit vector (nx, ny), or has jumped."""
    along = nx * last_x + ny * last_y
    across = nx * last_y - ny * last_x
    return along > 2.0 * abs(across)
