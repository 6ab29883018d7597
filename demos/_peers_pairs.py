"""Contacts of pairs of ellipses by one library or another: what each finds, and what a pair costs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from math import ceil, cos, hypot, sin
from statistics import median
from typing import NamedTuple

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk._chipmunk_cffi import lib
from tqdm import tqdm

from pymunk_ellipse import Ellipse, ellipse_contacts

from ._methods import Pairs, random_pairs
from ._race import CLOCK
from ._shapes import inscribed_polygon

Floats = NDArray[np.float64]
Work = Callable[[], object]

OURS = "pymunk_ellipse"
DISTANCE = f"{OURS}, distance"
POLYGONS = "pymunk, polygons"
POLYGON_COUNTS = 8, 16, 32, 64

# A contact is a wrong one from here on: another place to touch, or no place at all. The depth by b, the normal in radians.
WRONG_DEPTH = 0.01
WRONG_NORMAL = 0.1

# How long a piece of work is repeated for one timing (seconds).
TIMED = 0.004


class Placed(NamedTuple):
    """An ellipse: semi-axes, centre and the angle of a."""

    a: float
    b: float
    x: float
    y: float
    angle: float


@dataclass(frozen=True)
class Case:
    """Pairs of ellipses of an aspect ratio, overlapping by depths (by b) between two numbers."""

    aspect_ratio: float
    least: float
    largest: float

    def __str__(self) -> str:
        return f"aspect ratio {self.aspect_ratio:g}, {self.least:g} b to {self.largest:g} b deep"

    def pairs(self, count: int) -> Pairs:
        return random_pairs(self.aspect_ratio, self.least, self.largest, count, seed=1)


# Shallow: from less than the collision slop of a shape ten units wide to a hard hit.
CASES = Case(2.0, 0.003, 0.1), Case(20.0, 0.003, 0.1), Case(5.0, 0.3, 1.5)


class Prepared(NamedTuple):
    """What a method found for some pairs, and work to be timed."""

    # Depth and normal (x, y, z) in rows, nan where no contact was found.
    found: Floats
    # All pairs once, each by a call from Python.
    calls: Work
    # All pairs once without that: in a compiled loop; or by calls, less those that cost nothing but the calling.
    bare: Work
    calling: Work | None = None


@dataclass(eq=False)
class PairMethod:
    """A way to find the contact of two ellipses, by the name and the number under which it is shown."""

    family: str
    number: int
    prepare: Callable[[Pairs], Prepared]

    @property
    def label(self) -> str:
        return f"{self.family}, {self.number}" if self.number else self.family


@dataclass
class PairScore:
    """What a method costs per pair (seconds) and how far off it is, and how many contacts it missed or found elsewhere."""

    bare: float
    called: float
    # By b, and in radians; median and worst. A missed contact counts as one without depth, whose normal is a quarter turn off.
    depth: tuple[float, float]
    normal: tuple[float, float]
    missed: int
    wrong: int
    # Of how many.
    count: int


PairScores = dict[PairMethod, PairScore]


def placed(pairs: Pairs) -> tuple[Floats, Floats]:
    """The first and the second ellipses (a, b, x, y, angle) in rows."""
    a1, b1, a2, b2, c, s, dx, dy = pairs.numbers.T
    zero = np.zeros(len(pairs))
    first = np.stack((a1, b1, zero, zero, zero), axis=1)
    second = np.stack((a2, b2, dx, dy, np.arctan2(s, c)), axis=1)
    return first, second


def each(pairs: Pairs) -> Iterator[tuple[Placed, Placed]]:
    """The two ellipses of each pair."""
    first, second = placed(pairs)
    for one, two in zip(first.tolist(), second.tolist(), strict=True):
        yield Placed(*one), Placed(*two)


def semi_axes(a: float, b: float) -> tuple[float, float, float]:
    """Of the ellipsoid that stands for an ellipse in 3D.

    The third one is a: the deepest contact is that of the ellipses then. With b, deep pairs part the shorter way, out of the plane.
    """
    return a, b, a


def rotation(at: Placed) -> Floats:
    """The matrix that turns an ellipse in 3D."""
    c, s = cos(at.angle), sin(at.angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def between_centres(one: Placed, two: Placed) -> float:
    return hypot(two.x - one.x, two.y - one.y)


def compare(
    methods: list[PairMethod], pairs: Pairs, rounds: int, label: str
) -> PairScores:
    """Run all methods in turn, round after round, on the same pairs."""
    timings = {method: _Timing(method.prepare(pairs)) for method in methods}
    for _ in tqdm(range(rounds), label, unit="round"):
        for timing in timings.values():
            timing.round()
    return {method: score(timing, pairs) for method, timing in timings.items()}


class _Timing:
    """The rounds in which a method's work was timed (seconds for all pairs)."""

    def __init__(self, prepared: Prepared) -> None:
        self.prepared = prepared
        works = prepared.calls, prepared.bare, prepared.calling
        self.repeats = {id(work): repeats(work) for work in works if work is not None}
        self.called: list[float] = []
        self.bare: list[float] = []

    def round(self) -> None:
        called = self.seconds(self.prepared.calls)
        bare = called
        if self.prepared.bare is not self.prepared.calls:
            bare = self.seconds(self.prepared.bare)
        if self.prepared.calling is not None:
            bare -= self.seconds(self.prepared.calling)
        self.called.append(called)
        self.bare.append(bare)

    def seconds(self, work: Work) -> float:
        count = self.repeats[id(work)]
        start = CLOCK()
        for _ in range(count):
            work()
        return (CLOCK() - start) / count


def repeats(work: Work) -> int:
    """How often to repeat work so that its time can be told; the first time compiles what is to be compiled."""
    work()
    start = CLOCK()
    work()
    return ceil(TIMED / max(CLOCK() - start, 1e-6))


def score(timing: _Timing, pairs: Pairs) -> PairScore:
    depth_off, normal_off, missed, wrong = errors(timing.prepared.found, pairs)
    return PairScore(
        median(timing.bare) / len(pairs),
        median(timing.called) / len(pairs),
        (float(np.median(depth_off)), float(np.max(depth_off))),
        (float(np.median(normal_off)), float(np.max(normal_off))),
        missed,
        wrong,
        len(pairs),
    )


def errors(found: Floats, pairs: Pairs) -> tuple[Floats, Floats, int, int]:
    """How far off depths (by b) and normals (radians) are, how many are missing and how many wrong."""
    missed = ~np.isfinite(found).all(axis=1)
    depth, normal = found[:, 0], found[:, 1:]
    exact = np.pad(pairs.exact[:, 1:], ((0, 0), (0, 1)))
    sine = np.linalg.norm(np.cross(normal, exact), axis=1)
    normal_off = np.arctan2(sine, np.sum(normal * exact, axis=1))
    normal_off[missed] = np.pi / 2.0
    depth_off = np.abs(np.where(missed, 0.0, depth) - pairs.exact[:, 0])
    wrong = ~missed & ((depth_off > WRONG_DEPTH) | (normal_off > WRONG_NORMAL))
    return depth_off, normal_off, int(missed.sum()), int(wrong.sum())


def methods_of_pymunk() -> list[PairMethod]:
    """The package's own contact, and pymunk's of polygons inside the ellipses."""
    return [
        PairMethod(OURS, 0, by(Ellipse.shapes_collide)),
        PairMethod(DISTANCE, 0, by(Ellipse.distance)),
        *(PairMethod(POLYGONS, count, polygons(count)) for count in POLYGON_COUNTS),
    ]


def by(call: Callable[..., object]) -> Callable[[Pairs], Prepared]:
    """In a compiled loop: ellipse_contacts, less that of a single pair. As called from Python: a method of an ellipse."""

    def prepare(pairs: Pairs) -> Prepared:
        first, second = placed(pairs)
        contacts = ellipse_contacts(first, second)
        found = np.pad(contacts.normal, ((0, 0), (1, 1)))
        found[:, 0] = -contacts.distance
        ellipses = InPymunk(pairs, Ellipse)

        def calls() -> None:
            for one, two in ellipses.shapes:
                call(one, two)

        return Prepared(
            found,
            calls,
            lambda: ellipse_contacts(first, second),
            lambda: ellipse_contacts(first[:1], second[:1]),
        )

    return prepare


class InPymunk:
    """Pairs of shapes on bodies of pymunk."""

    def __init__(
        self, pairs: Pairs, make: Callable[[pymunk.Body, float, float], pymunk.Shape]
    ) -> None:
        self.shapes: list[tuple[pymunk.Shape, pymunk.Shape]] = []
        # A shape holds its body weakly.
        self.bodies: list[pymunk.Body] = []
        for one, two in each(pairs):
            self.shapes.append((self.shape(one, make), self.shape(two, make)))

    def shape(
        self, at: Placed, make: Callable[[pymunk.Body, float, float], pymunk.Shape]
    ) -> pymunk.Shape:
        body = pymunk.Body(1.0, 1.0)
        body.position = at.x, at.y
        body.angle = at.angle
        self.bodies.append(body)
        shape = make(body, at.a, at.b)
        shape.cache_bb()
        return shape

    def collide(self) -> None:
        """As a user would."""
        for one, two in self.shapes:
            touching(one, two)

    def collide_in_chipmunk(self) -> None:
        """By Chipmunk's function alone."""
        for one, two in self.shapes:
            lib.cpShapesCollide(one._shape, two._shape)


def touching(one: pymunk.Shape, two: pymunk.Shape) -> pymunk.ContactPointSet | None:
    """The contact of two shapes, an ellipse first; none where they are apart."""
    try:
        contacts = one.shapes_collide(two)
    except AssertionError:
        # Of pymunk's own shapes, those that do not touch fail one.
        return None
    return contacts if contacts.points else None


def polygons(count: int) -> Callable[[Pairs], Prepared]:
    """Pymunk's own collision of polygons inside the ellipses, less that of two circles."""

    def prepare(pairs: Pairs) -> Prepared:
        shapes = InPymunk(pairs, partial(inscribed_polygon, count=count))
        circles = InPymunk(pairs, lambda body, a, b: pymunk.Circle(body, b))
        found = np.full((len(pairs), 4), np.nan)
        for row, (one, two) in zip(found, shapes.shapes, strict=True):
            if (contacts := touching(one, two)) is not None:
                depth = -min(point.distance for point in contacts.points)
                row[:] = depth, *contacts.normal, 0.0
        return Prepared(
            found,
            shapes.collide,
            shapes.collide_in_chipmunk,
            circles.collide_in_chipmunk,
        )

    return prepare
