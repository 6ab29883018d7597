"""Contact of an ellipse with an ellipse; with a circle or a point as an ellipse of equal semi-axes or none."""

from __future__ import annotations

from .common_normal import climb, first_guess, inscribed_radius, pair_of, sweep
from .frame import Frame

# Distance, normal from the first shape (x, y), contact point on it from the ellipse's centre (x, y).
Contact = tuple[float, float, float, float, float]


def ellipse_ellipse(first: Frame, second: Frame, nx: float, ny: float) -> Contact:
    """Distance, contact normal and contact point of two ellipses.

    (nx, ny) is a normal to start from, last step's say, of any length; zero if there is none.

    Returns the distance (negative: minus the penetration depth, the least translation that
    parts the two), the unit normal from the first to the second, and the contact point on the
    first, from its centre. The contact point on the second lies from there at the distance
    along the normal.

    >>> ellipse_ellipse((2, 1, 1, 0, 0, 0), (1, 1, 1, 0, 3.5, 0), 0, 0)
    (0.5, 1.0, 0.0, 2.0, 0.0)
    """
    pair = pair_of(first, second)
    a, b, c, s, _x, _y = first
    mx = c * nx + s * ny
    my = c * ny - s * nx
    if mx == 0.0 and my == 0.0:
        mx, my = first_guess(pair)

    contact = climb(pair, mx, my)
    distance, mx, my, _px, _py = contact
    # Only deeper than a disc that fits in there can another normal be better, and most are not
    # even as deep as the first one's sharp ends are round.
    if distance * a < -b * b and distance < -inscribed_radius(pair, mx, my):
        contact = sweep(pair, contact)
    return turned(contact, c, s)


def turned(contact: Contact, c: float, s: float) -> Contact:
    """A contact in the frame of an ellipse, turned into the world."""
    distance, nx, ny, px, py = contact
    return (
        distance,
        c * nx - s * ny,
        s * nx + c * ny,
        c * px - s * py,
        s * px + c * py,
    )
