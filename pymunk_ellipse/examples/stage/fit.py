"""The steps of both fits: the circles that the package and the published method put to two shapes, one step after the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from pymunk import Vec2d

from pymunk_ellipse import circle_fit
from pymunk_ellipse.narrowphase.common_normal import (
    TURN_TOLERANCE,
    first_guess,
    fitted_circles,
    next_turn,
    pair_of,
)
from pymunk_ellipse.narrowphase.frame import Frame, frame_of

# More than two shapes need that can be seen.
MOST_STEPS = 30

# Semi-axes a and b, centre (x, y), and the angle of a (radians).
Placed = tuple[float, float, float, float, float]


@dataclass(frozen=True)
class Circle:
    """A fitted circle; that of a corner has no radius."""

    center: Vec2d
    radius: float


@dataclass(frozen=True)
class Step:
    """The circles of both shapes, the unit normal from the first to the second, and how deep the two overlap by them.

    Where the second shape is touched on a straight face, it has no circle.
    """

    first: Circle
    second: Circle | None
    normal: Vec2d
    depth: float
    # Whether the normal is not the last step's turned, but one that the sweep through all of them found.
    swept: bool = False


def exact_steps(first: Placed, second: Placed, contact: Vec2d) -> list[Step]:
    """The package's fit to two ellipses or circles: both circles at one normal, which then turns to the line of their centres.

    contact is the contact's normal: in deep overlaps another one may be better than where the
    steps end.
    """
    return swept_on(climb(first, second), first, second, contact)


def exact_steps_to_polygon(
    first: Placed, vertices: Sequence[Vec2d], radius: float, contact: Vec2d
) -> list[Step]:
    """The package's fit to an ellipse and a convex polygon with a radius, its vertices counterclockwise.

    A polygon of two vertices is a segment. Either a face is touched, or a corner, which is a
    circle of that radius: the one with the smallest depth is. For contact see exact_steps.
    """
    corners: list[Placed] = [(radius, radius, *vertex, 0.0) for vertex in vertices]
    found: list[list[Step]] = []
    for i, (vertex, corner) in enumerate(zip(vertices, corners, strict=True)):
        # From the ellipse into the face that ends at this vertex, and into the one that begins.
        ending = (vertex - vertices[i - 1]).perpendicular_normal()
        following = vertices[(i + 1) % len(vertices)]
        beginning = (following - vertex).perpendicular_normal()
        face = step_at(first, corner, ending)
        found.append([replace(face, second=None)])
        steps = climb(first, corner)
        normal = steps[-1].normal
        if ending.cross(normal) >= 0.0 and normal.cross(beginning) >= 0.0:
            found.append(steps)
    best = min(found, key=lambda steps: steps[-1].depth)
    deepest = min(corners, key=lambda corner: contact.dot(corner[2:4]))
    return swept_on(best, first, deepest, contact)


def swept_on(
    steps: list[Step], first: Placed, second: Placed, contact: Vec2d
) -> list[Step]:
    """The steps, and one more to the contact's normal if they end at a worse one."""
    swept = step_at(first, second, contact)
    if steps[-1].depth - swept.depth > 1e-6 * min(first[:2]):
        return [*steps, replace(swept, swept=True)]
    return steps


def published_steps(first: Placed, second: Placed, most: int = 10) -> list[Step]:
    """The published fit to two ellipses or circles: each circle where its ellipse faces the other's last circle."""
    steps = []
    for sweeps in range(1, most + 1):
        fit = circle_fit(first, second, sweeps)
        one, other = (Circle(Vec2d(x, y), r) for x, y, r in (fit.first, fit.second))
        steps.append(Step(one, other, Vec2d(*fit.normal), fit.depth))
        if fit.converged:
            break
    return steps


def first_normal(first: Placed, second: Placed) -> Vec2d:
    """The normal that the fit starts from where none is known from the last step."""
    frame = frame_of(*first)
    guess = first_guess(pair_of(frame, frame_of(*second)))
    return Vec2d(*guess).cpvrotate(axis(frame))


def climb(first: Placed, second: Placed) -> list[Step]:
    """The circles at the normals that the fit goes through, uphill."""
    frame = frame_of(*first)
    pair = pair_of(frame, frame_of(*second))
    f, slope, between, change, nx, ny, *_ = fitted_circles(pair, *first_guess(pair))
    normals = []
    for _ in range(MOST_STEPS):
        normals.append((nx, ny))
        turn = next_turn(slope, between, change)
        last = f
        while abs(turn) > TURN_TOLERANCE:
            turned = nx - turn * ny, ny + turn * nx
            f, slope, between, change, *m = fitted_circles(pair, *turned)
            if f >= last:
                break
            turn /= 2.0
        else:
            # The last turn is made without a look at what it leads to.
            normals.append((nx - turn * ny, ny + turn * nx))
            break
        nx, ny = m[0], m[1]
    return [
        step_at(first, second, Vec2d(*normal).cpvrotate(axis(frame)))
        for normal in normals
    ]


def step_at(first: Placed, second: Placed, normal: Vec2d) -> Step:
    """The circles of two ellipses at a normal."""
    frame = frame_of(*first)
    along = axis(frame)
    pair = pair_of(frame, frame_of(*second))
    local = normal.cpvunrotate(along)
    f, slope, between, _, nx, ny, px, py, radius, _ = fitted_circles(pair, *local)
    n = Vec2d(nx, ny)
    center = Vec2d(px, py) - radius * n
    other = center + between * n + slope * n.perpendicular()
    origin = Vec2d(*frame[4:])
    return Step(
        Circle(origin + center.cpvrotate(along), radius),
        Circle(origin + other.cpvrotate(along), between - f - radius),
        n.cpvrotate(along),
        -f,
    )


def axis(frame: Frame) -> Vec2d:
    """The unit vector along the longer semi-axis."""
    return Vec2d(frame[2], frame[3])
