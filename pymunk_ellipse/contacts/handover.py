"""The last contacts of an ellipse, to go on from when it comes from one shape of a body to the next.

pymunk has an arbiter for each pair of shapes, and a contact with another shape begins anew: on a chain
of segments at every joint. But the contact wanders on along the same body. So an ellipse keeps, in
the spare room of its hull, where its contacts with other shapes are: for each the address of the
cpContact, its name, the address of the touched body, and the step, doubled, plus one if the ellipse is
the first of the two shapes.
"""

from __future__ import annotations

from typing import Any

from ..chipmunk.structs import contact_at
from ..narrowphase.frame import Frame, normal_at
from ..narrowphase.rolling import same_contact

# As many contacts of one ellipse with other shapes are remembered.
MOST = 4

# Whether there is one; the last contact point from the ellipse's centre of gravity (x, y), and from the other body's.
Handover = tuple[bool, float, float, float, float]


def remember(
    hull: Any, contact: int, name: int, body: int, step: int, is_first: bool
) -> None:
    """Keep where the contact of this step is, in the place of the oldest one."""
    touches = hull.touches
    oldest = 0
    for i in range(1, MOST):
        if touches[4 * i + 3] < touches[4 * oldest + 3]:
            oldest = i
    touches[4 * oldest] = contact
    touches[4 * oldest + 1] = name
    touches[4 * oldest + 2] = body
    touches[4 * oldest + 3] = 2 * step + (1 if is_first else 0)


def last_on_body(
    hull: Any,
    ellipse: Frame,
    body: int,
    step: int,
    gx: float,
    gy: float,
    nx: float,
    ny: float,
) -> Handover:
    """The contact that an ellipse had in the last step with any shape of a body, and that can have rolled to the normal (nx, ny).

    (gx, gy) is the ellipse's centre of gravity. Of several the one with the nearest normal counts.
    """
    best = 0.0
    found = (False, 0.0, 0.0, 0.0, 0.0)
    touches = hull.touches
    for i in range(MOST):
        turns = touches[4 * i + 3]
        if touches[4 * i + 2] != body or turns // 2 != step - 1:
            continue
        contact = contact_at(touches[4 * i])
        if contact.hash != touches[4 * i + 1]:
            # Chipmunk has used the memory again.
            continue
        on_ellipse = contact.r1 if turns % 2 == 1 else contact.r2
        on_body = contact.r2 if turns % 2 == 1 else contact.r1
        mx, my = normal_at(ellipse, gx + on_ellipse.x, gy + on_ellipse.y)
        along = mx * nx + my * ny
        square = mx * mx + my * my
        if same_contact(nx, ny, mx, my) and along * along > best * square:
            best = along * along / square
            found = (True, on_ellipse.x, on_ellipse.y, on_body.x, on_body.y)
    return found
