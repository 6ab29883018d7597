"""Ways to find the contact of two ellipses, timed in turn on the same pairs and compared with the exact contact."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import atan2, hypot, pi, sqrt
from statistics import median
from time import thread_time
from typing import Any

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk._chipmunk_cffi import lib

from pymunk_ellipse import published_fit as published
from pymunk_ellipse.narrowphase import common_normal as common_normal_module
from pymunk_ellipse.narrowphase import ellipse_ellipse as ellipse_ellipse_module
from pymunk_ellipse.narrowphase.common_normal import first_guess, fitted_circles
from pymunk_ellipse.narrowphase.ellipse_ellipse import ellipse_ellipse
from pymunk_ellipse.published_fit import FittedCircle, PlacedEllipse

from ._shapes import inscribed_polygon

circle_towards = published._circle_towards

Floats = NDArray[np.float64]
# Finds depth and normal (x, y) of a pair of ellipses in the frame of the first, with a normal to start from (zero if
# there is none) and a number of steps.
Kernel = Callable[[Sequence[float], float, float, int], tuple[float, float, float]]
# Seconds of the processor for all pairs (not of the clock: what else the machine does drops out), with depths and normals in rows; depth 0 where no contact was found.
Run = Callable[["Pairs"], tuple[float, Floats]]


@dataclass
class Pairs:
    """Overlapping ellipses of equal size, b = 1, with their exact contacts."""

    # a1, b1, a2, b2, the direction of a2 (x, y) and the second centre (x, y), in rows.
    numbers: Floats
    # Depths and normals (x, y), in rows.
    exact: Floats
    # The normals from before a small motion of the second ellipse.
    warm: Floats

    def __len__(self) -> int:
        return len(self.numbers)

    @property
    def cold(self) -> Floats:
        return np.zeros((len(self), 2))


def supports(pairs: Floats, angles: Floats) -> Floats:
    """f (see common_normal) of each pair in its row of directions."""
    a1, b1, a2, b2, c, s, dx, dy = (column[:, None] for column in pairs.T)
    cosine, sine = np.cos(angles), np.sin(angles)
    first = np.hypot(a1 * cosine, b1 * sine)
    second = np.hypot(a2 * (c * cosine + s * sine), b2 * (c * sine - s * cosine))
    return dx * cosine + dy * sine - first - second


def slopes(pairs: Floats, angles: Floats) -> Floats:
    """The derivative of f by the direction."""
    a1, b1, a2, b2, c, s, dx, dy = (column[:, None] for column in pairs.T)
    x, y = np.cos(angles), np.sin(angles)
    along, across = c * x + s * y, c * y - s * x
    first = (b1 * b1 - a1 * a1) * x * y / np.hypot(a1 * x, b1 * y)
    second = (b2 * b2 - a2 * a2) * along * across / np.hypot(a2 * along, b2 * across)
    return dy * x - dx * y - first - second


def exact_contacts(pairs: Floats, count: int = 720) -> Floats:
    """Depths and normals, in rows, by looking in all directions and halving the interval of the best one.

    Directions are where the normals of either ellipse are, for evenly spaced parameters.
    """
    t = np.linspace(-pi, pi, count, endpoint=False)
    angles = []
    for a, b, turned in (
        (pairs[:, 0], pairs[:, 1], np.zeros(len(pairs))),
        (pairs[:, 2], pairs[:, 3], np.arctan2(pairs[:, 5], pairs[:, 4])),
    ):
        normals = np.arctan2(a[:, None] * np.sin(t), b[:, None] * np.cos(t))
        angles.append((normals + turned[:, None]) % (2.0 * pi))
    directions = np.sort(np.concatenate(angles, axis=1), axis=1)
    # Two on either side, because both ellipses may give the same direction.
    directions = np.concatenate(
        (directions[:, -2:] - 2.0 * pi, directions, directions[:, :2] + 2.0 * pi),
        axis=1,
    )
    best = 2 + np.argmax(supports(pairs, directions)[:, 2:-2], axis=1)
    rows = np.arange(len(pairs))
    low = directions[rows, best - 2][:, None]
    high = directions[rows, best + 2][:, None]
    for _ in range(60):
        middle = (low + high) / 2.0
        rising = slopes(pairs, middle) > 0.0
        low, high = np.where(rising, middle, low), np.where(rising, high, middle)
    middle = (low + high) / 2.0
    return np.concatenate(
        (-supports(pairs, middle), np.cos(middle), np.sin(middle)), axis=1
    )


def random_pairs(
    aspect_ratio: float, least: float, largest: float, count: int, seed: int
) -> Pairs:
    """Pairs at random angles with random normals, and depths (by b) between two numbers, evenly by their logarithm.

    The warm normals are exact for a second ellipse that stands 0.02 b and 0.02 rad elsewhere.
    """
    rng = np.random.default_rng(seed)
    turned = rng.uniform(0.0, pi, count)
    direction = rng.uniform(0.0, 2.0 * pi, count)
    depth = np.exp(rng.uniform(np.log(least), np.log(largest), count))
    numbers = np.ones((count, 8))
    numbers[:, [0, 2]] = aspect_ratio
    numbers[:, 4], numbers[:, 5] = np.cos(turned), np.sin(turned)
    numbers[:, 6:] = 0.0
    # So far apart along the normal, and aside, that they touch there, less the depth.
    x, y = np.cos(direction), np.sin(direction)
    a, b = numbers[:, 0], numbers[:, 1]
    for angle in (np.zeros(count), turned):
        c, s = np.cos(angle), np.sin(angle)
        u, v = a * (c * x + s * y), b * (c * y - s * x)
        size = np.hypot(u, v)
        numbers[:, 6] += (c * a * u - s * b * v) / size
        numbers[:, 7] += (s * a * u + c * b * v) / size
    numbers[:, 6] -= depth * x
    numbers[:, 7] -= depth * y
    moved = numbers.copy()
    turn = turned + 0.02 * rng.choice([-1.0, 1.0], count)
    moved[:, 4], moved[:, 5] = np.cos(turn), np.sin(turn)
    angle = rng.uniform(0.0, 2.0 * pi, count)
    moved[:, 6] += 0.02 * np.cos(angle)
    moved[:, 7] += 0.02 * np.sin(angle)
    return Pairs(numbers, exact_contacts(numbers), exact_contacts(moved)[:, 1:])


def common_normal(
    pair: Sequence[float], nx: float, ny: float, count: int
) -> tuple[float, float, float]:
    """So many Newton steps without a safeguard.

    The circles fitted at a normal give the depth, and the next normal is along their centres.
    """
    a1, b1, a2, b2, c, s, dx, dy = (
        pair[0],
        pair[1],
        pair[2],
        pair[3],
        pair[4],
        pair[5],
        pair[6],
        pair[7],
    )
    numbers = (a1, b1, a2, b2, c, s, dx, dy)
    if nx == 0.0 and ny == 0.0:
        nx, ny = first_guess(numbers)
    depth = 0.0
    for _ in range(count):
        f, slope, between, _change, nx, ny, _px, _py, _radius1, _change1 = (
            fitted_circles(numbers, nx, ny)
        )
        distance = sqrt(between * between + slope * slope)
        depth = between - f - distance
        nx, ny = (
            (between * nx - slope * ny) / distance,
            (between * ny + slope * nx) / distance,
        )
    return depth, nx, ny


def safeguarded(
    pair: Sequence[float], nx: float, ny: float, count: int
) -> tuple[float, float, float]:
    """The package's own contact, which takes the steps it needs."""
    first = (pair[0], pair[1], 1.0, 0.0, 0.0, 0.0)
    second = (pair[2], pair[3], pair[4], pair[5], pair[6], pair[7])
    f, nx, ny, _px, _py = ellipse_ellipse(first, second, nx, ny)
    return -f, nx, ny


def alternating(
    pair: Sequence[float], nx: float, ny: float, count: int
) -> tuple[float, float, float]:
    """So many sweeps of the published fit, without the checks of its arguments."""
    one = PlacedEllipse(pair[0], pair[1], 0.0, 0.0, 0.0)
    angle = atan2(pair[5], pair[4])
    two = PlacedEllipse(pair[2], pair[3], pair[6], pair[7], angle)
    circle1 = FittedCircle(one.x, one.y, 0.0)
    circle2 = FittedCircle(two.x, two.y, 0.0)
    for _ in range(count):
        next1, _settled = circle_towards(one, circle2.x, circle2.y)
        circle2, _settled = circle_towards(two, circle1.x, circle1.y)
        circle1 = next1
    dx = circle2.x - circle1.x
    dy = circle2.y - circle1.y
    distance = hypot(dx, dy)
    depth = circle1.radius + circle2.radius - distance
    if distance == 0.0:
        return depth, 0.0, 0.0
    return depth, dx / distance, dy / distance


def looping(kernel: Any) -> Any:
    """Runs a kernel on pair after pair."""

    def loop(pairs: Any, starts: Any, count: int, found: Any) -> None:
        for i in range(len(pairs)):
            found[i] = kernel(pairs[i], starts[i][0], starts[i][1], count)

    return loop


def compile_loops(kernels: Sequence[Kernel]) -> dict[Kernel, Any] | None:
    """The loops over kernels, compiled, or None without numba."""
    try:
        import numba
        from numba.extending import register_jitable
    except ImportError:
        return None
    for module in (common_normal_module, ellipse_ellipse_module, published):
        for function in list(vars(module).values()):
            if getattr(function, "__module__", None) == module.__name__ and hasattr(
                function, "__code__"
            ):
                register_jitable(function)
    return {
        kernel: numba.njit(looping(numba.njit(error_model="numpy")(kernel)))
        for kernel in kernels
    }


def in_python(kernel: Kernel, count: int, warm: bool) -> Run:
    loop = looping(kernel)

    def run(pairs: Pairs) -> tuple[float, Floats]:
        found = np.zeros((len(pairs), 3))
        numbers = [tuple(map(float, row)) for row in pairs.numbers]
        starts = (pairs.warm if warm else pairs.cold).tolist()
        start = thread_time()
        loop(numbers, starts, count, found)
        return thread_time() - start, found

    return run


def in_machine_code(loop: Any, count: int, warm: bool) -> Run:
    def run(pairs: Pairs) -> tuple[float, Floats]:
        found = np.zeros((len(pairs), 3))
        starts = pairs.warm if warm else pairs.cold
        # Once more often than timed: the first call compiles.
        loop(pairs.numbers, starts, count, found)
        repeats = 10
        start = thread_time()
        for _ in range(repeats):
            loop(pairs.numbers, starts, count, found)
        return (thread_time() - start) / repeats, found

    return run


def exact(pairs: Pairs) -> tuple[float, Floats]:
    start = thread_time()
    found = exact_contacts(pairs.numbers)
    return thread_time() - start, found


class Polygons:
    """Pymunk's own collision of polygons that stand for the ellipses."""

    def __init__(self, count: int, circumscribed: bool) -> None:
        self.count = count
        self.scale = 1.0 / np.cos(pi / count) if circumscribed else 1.0
        self.built: dict[int, list[tuple[Any, Any]]] = {}

    def __call__(self, pairs: Pairs) -> tuple[float, Floats]:
        if id(pairs) not in self.built:
            self.built[id(pairs)] = [self.build(row) for row in pairs.numbers]
        shapes = self.built[id(pairs)]
        cp_shapes = [(one._shape, two._shape) for one, two in shapes]
        start = thread_time()
        sets = [lib.cpShapesCollide(one, two) for one, two in cp_shapes]
        taken = thread_time() - start - cost_of_calls(len(pairs))
        found = np.zeros((len(pairs), 3))
        for row, contact in zip(found, sets, strict=True):
            if contact.count:
                depth = -min(contact.points[i].distance for i in range(contact.count))
                row[:] = depth, contact.normal.x, contact.normal.y
        return taken, found

    def build(self, row: Floats) -> tuple[pymunk.Shape, pymunk.Shape]:
        a1, b1, a2, b2, c, s, dx, dy = map(float, row)
        result = []
        for a, b, angle, position in (
            (a1, b1, 0.0, (0.0, 0.0)),
            (a2, b2, atan2(s, c), (dx, dy)),
        ):
            body = pymunk.Body(1.0, 1.0)
            body.position = position
            body.angle = angle
            shape = inscribed_polygon(body, self.scale * a, self.scale * b, self.count)
            shape.cache_bb()
            result.append(shape)
        return result[0], result[1]


def cost_of_calls(count: int) -> float:
    """Seconds that it takes to call so many collisions from Python: those of circles, which cost nothing themselves."""
    one, two = (pymunk.Circle(pymunk.Body(1.0, 1.0), 1.0) for _ in range(2))
    for shape in (one, two):
        shape.cache_bb()
    cp_one, cp_two = one._shape, two._shape
    start = thread_time()
    kept = [lib.cpShapesCollide(cp_one, cp_two) for _ in range(count)]
    taken = thread_time() - start
    del kept
    return taken


@dataclass(eq=False)
class Method:
    """A way to find contacts, with the family and the number by which it is drawn."""

    family: str
    count: int
    compiled: bool
    run: Run
    seconds: list[float] = field(default_factory=list)
    found: Floats | None = None

    @property
    def label(self) -> str:
        return f"{self.family}, {self.count}" if self.count else self.family


POLYGON_COUNTS = 8, 16, 32, 64, 128
SWEEPS = 1, 2, 3, 5, 10
STEPS = 1, 2, 3, 4, 5, 6


def methods(machine_code: bool) -> list[Method]:
    """All of them; those that numba compiles only if wanted, and where it is."""
    result = []
    for circumscribed in (False, True):
        family = f"polygons {'around' if circumscribed else 'inside'}"
        for count in POLYGON_COUNTS:
            result.append(Method(family, count, True, Polygons(count, circumscribed)))
    kernels = common_normal, safeguarded, alternating
    loops = compile_loops(kernels) if machine_code else None
    for compiled in (False, True):
        if compiled and loops is None:
            continue

        def add(family: str, kernel: Kernel, count: int, warm: bool) -> None:
            if compiled:  # noqa: B023
                assert loops is not None
                run = in_machine_code(loops[kernel], count, warm)
            else:
                run = in_python(kernel, count, warm)
            result.append(Method(family, count, compiled, run))  # noqa: B023

        for count in SWEEPS:
            add("alternating fit", alternating, count, False)
        for warm in (False, True):
            start = "warm" if warm else "cold"
            for count in STEPS:
                add(f"common normal, {start}", common_normal, count, warm)
            add(f"as shipped, {start}", safeguarded, 0, warm)
    result.append(Method("scan and bisection", 0, False, exact))
    return result


@dataclass(frozen=True)
class Score:
    """What a method takes per pair, and how far off it is."""

    seconds: float
    # By b; median and worst.
    depth: tuple[float, float]
    # Radians; median and worst.
    normal: tuple[float, float]
    missed: int


def score(method: Method, pairs: Pairs) -> Score:
    """A contact that is not found counts as one of no depth whose normal is a quarter turn off."""
    assert method.found is not None
    depth, nx, ny = method.found.T
    true_depth, true_x, true_y = pairs.exact.T
    missed = (nx == 0.0) & (ny == 0.0) | ~np.isfinite(depth)
    depth_off = np.abs(np.where(missed, 0.0, depth) - true_depth)
    angle = np.arctan2(nx * true_y - ny * true_x, nx * true_x + ny * true_y)
    normal_off = np.where(missed, pi / 2.0, np.abs(angle))
    return Score(
        median(method.seconds) / len(pairs),
        (float(np.median(depth_off)), float(np.max(depth_off))),
        (float(np.median(normal_off)), float(np.max(normal_off))),
        int(np.sum(missed)),
    )
