"""Points and parts of the plane."""

from __future__ import annotations

Point = tuple[float, float]
# Left, bottom, right and top of what is shown.
View = tuple[float, float, float, float]


def size_for(view: View, longer: int) -> tuple[int, int]:
    """The size of a picture that shows this part of the world, its longer side so many pixels long.

    >>> size_for((0.0, -10.0, 100.0, 15.0), 400)
    (400, 100)
    """
    left, bottom, right, top = view
    scale = longer / max(right - left, top - bottom)
    return round(scale * (right - left)), round(scale * (top - bottom))
