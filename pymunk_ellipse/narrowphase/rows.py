"""Contacts and nearest points of many ellipses, whose numbers lie in rows one after the other."""

from __future__ import annotations

from typing import Any

from .ellipse_ellipse import ellipse_ellipse
from .frame import Frame, frame_of
from .nearest import nearest_point

# Numbers of an ellipse in a row: a, b, x, y, angle.
ELLIPSE = 5
# Of a contact: distance, normal (x, y), first point (x, y), second point (x, y).
CONTACT = 7
# Of a point: x, y.
POINT = 2
# Of a nearest point: distance, normal (x, y), point (x, y).
NEAREST = 5


def frame_in_row(rows: Any, i: int) -> Frame:
    """The frame of the ellipse whose numbers begin at i."""
    return frame_of(rows[i], rows[i + 1], rows[i + 2], rows[i + 3], rows[i + 4])


def contacts_of_rows(
    count: int, first: Any, first_step: int, second: Any, second_step: int, result: Any
) -> None:
    """Write the contacts of so many pairs of ellipses into rows.

    The steps lead from row to row: zero takes the same ellipse for all pairs.
    """
    for i in range(count):
        one = frame_in_row(first, first_step * i)
        two = frame_in_row(second, second_step * i)
        distance, nx, ny, px, py = ellipse_ellipse(one, two, 0.0, 0.0)
        x = one[4] + px
        y = one[5] + py
        at = CONTACT * i
        result[at] = distance
        result[at + 1] = nx
        result[at + 2] = ny
        result[at + 3] = x
        result[at + 4] = y
        result[at + 5] = x + distance * nx
        result[at + 6] = y + distance * ny


def nearest_of_rows(
    count: int,
    ellipses: Any,
    ellipse_step: int,
    points: Any,
    point_step: int,
    result: Any,
) -> None:
    """Write the nearest points of so many ellipses to as many points into rows; steps as for contacts_of_rows."""
    for i in range(count):
        frame = frame_in_row(ellipses, ellipse_step * i)
        j = point_step * i
        distance, nx, ny, px, py = nearest_point(frame, points[j], points[j + 1])
        at = NEAREST * i
        result[at] = distance
        result[at + 1] = nx
        result[at + 2] = ny
        result[at + 3] = px
        result[at + 4] = py
