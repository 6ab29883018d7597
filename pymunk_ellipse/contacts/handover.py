"""The last contacts of an ellipse, to roll on from when it comes from one shape of a body to the next.

pymunk has an arbiter for each pair of shapes, and a contact with another shape begins anew: on a chain
of segments at every joint. But the contact wanders on along the same body. So an ellipse keeps its
contacts with other shapes in the spare room of its hull: for each the address of the cpContact, its
name, the address of the touched body, and the step, doubled, plus one if the ellipse is the first of
the two shapes; and the normal, in the touched body's coordinates.
"""

from __future__ import annotations

from typing import Any

from ..chipmunk.structs import contact_at

# As many contacts of one ellipse with other shapes are kept.
MOST = 4

# Two shapes are one floor where the normal is the same but for roundoff of their corners. Where it turns,
# the next shape is hit: at the corner of a tile, say, within the slop.
SAME_NORMAL = 1e-6

# Whether there is one; the last contact point from the ellipse's centre of gravity (x, y), and from the other body's.
LastContact = tuple[bool, float, float, float, float]


def keep_contact(
    hull: Any,
    contact: int,
    name: int,
    body: int,
    step: int,
    is_first: bool,
    nx: float,
    ny: float,
) -> None:
    """Keep where the contact of this step is, in the place of the oldest one; (nx, ny) is its normal on the body."""
    touches = hull.touches
    oldest = 0
    for i in range(1, MOST):
        if touches[4 * i + 3] < touches[4 * oldest + 3]:
            oldest = i
    touches[4 * oldest] = contact
    touches[4 * oldest + 1] = name
    touches[4 * oldest + 2] = body
    touches[4 * oldest + 3] = 2 * step + (1 if is_first else 0)
    hull.normals[2 * oldest] = nx
    hull.normals[2 * oldest + 1] = ny


def last_on_body(hull: Any, body: int, step: int, nx: float, ny: float) -> LastContact:
    """The contact that an ellipse had in the last step with any shape of a body, where that had the normal (nx, ny) on the body.

    Of several the one with the nearest normal counts.
    """
    touches = hull.touches
    nearest = SAME_NORMAL
    found = (False, 0.0, 0.0, 0.0, 0.0)
    for i in range(MOST):
        encoded = touches[4 * i + 3]
        if touches[4 * i + 2] != body or encoded // 2 != step - 1:
            continue
        contact = contact_at(touches[4 * i])
        if contact.hash != touches[4 * i + 1]:
            # Chipmunk has used the memory again.
            continue
        mx = hull.normals[2 * i]
        my = hull.normals[2 * i + 1]
        turned = abs(mx * ny - my * nx)
        if turned <= nearest and mx * nx + my * ny > 0.0:
            nearest = turned
            on_ellipse = contact.r1 if encoded % 2 == 1 else contact.r2
            on_body = contact.r2 if encoded % 2 == 1 else contact.r1
            found = (True, on_ellipse.x, on_ellipse.y, on_body.x, on_body.y)
    return found
