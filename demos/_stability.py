"""Scenes in which something fails, and the bound that physics sets for each."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from itertools import combinations, pairwise
from math import cos, hypot, inf, pi, sin, sqrt, tan

import numpy as np
import pymunk
from numpy.typing import NDArray

from ._builders import (
    GRAVITY,
    NO_SLIP,
    Kind,
    add_body,
    add_floor,
    add_pile,
    add_wall,
    energy,
    gas_energy,
    mean_square_speed,
    separation,
    steps,
)
from ._oracles import Rolling, height

STEP = 1.0 / 240.0

# Runs a scene with what stands for ellipses and a step (seconds), and returns what its bound is for.
Run = Callable[[Kind, float], float]


@dataclass(frozen=True)
class Scene:
    """A scene, what is measured in it, and how large that may be."""

    run: Run
    measure: str
    bound: float
    # Seconds.
    step: float = STEP


SCENES: dict[str, Scene] = {}


def scene(
    name: str, measure: str, bound: float, step: float = STEP
) -> Callable[[Run], Run]:
    """Enter a function among the scenes."""

    def enter(run: Run) -> Run:
        SCENES[name] = Scene(run, measure, bound, step)
        return run

    return enter


def stack_matrices(
    count: int, a: float, b: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Stiffness, inertia and sideways shift of a stack of equal ellipses that lie flat, by their tilts.

    Ellipse i = 1..count has the tilt t_i and the mass 1, contacts roll without slip, and lengths
    are to the order that matters. At a flat end the radius of curvature is R = a^2/b. Two equal
    curves roll on each other by equal arcs, so the normal between i and i + 1 is tilted by the
    mean of their tilts, whatever R is; with the contact points that follow, and no relative
    velocity there, the centres go by

        x_1 = -b t_1,                       x_(i+1) - x_i = -b (t_i + t_(i+1))
        y_1 = b + (R - b) t_1^2/2,          y_(i+1) - y_i = 2b + R (t_(i+1) - t_i)^2/4
                                                             - b (t_i^2 + t_(i+1)^2)/2

    The potential energy is g times the sum of all y_i, the kinetic energy that of all x_i and
    t_i. The stack stands where the potential energy has a minimum: for one ellipse if a > b,
    for two if a^2 > 3 b^2, and further on for about 1.2 a/b ellipses.
    """
    flat = a * a / b
    stiffness = np.zeros((count, count))
    stiffness[0, 0] = count * (flat - b)
    for i in range(count - 1):
        above = count - 1 - i
        stiffness[i : i + 2, i : i + 2] += above * (
            flat / 2.0 * np.array([[1.0, -1.0], [-1.0, 1.0]]) - b * np.eye(2)
        )
    shift = np.zeros((count, count))
    for i in range(count):
        shift[i, :i] = -2.0 * b
        shift[i, i] = -b
    inertia = shift.T @ shift + (a * a + b * b) / 4.0 * np.eye(count)
    return GRAVITY * stiffness, inertia, shift


def softest_mode(
    count: int, a: float, b: float
) -> tuple[float, NDArray[np.float64], NDArray[np.float64]]:
    """The least squared angular frequency of a stack, negative if it falls, with the tilts and shifts of that mode.

    The largest tilt is 1.
    """
    stiffness, inertia, shift = stack_matrices(count, a, b)
    half = np.linalg.inv(np.linalg.cholesky(inertia))
    squares, modes = np.linalg.eigh(half @ stiffness @ half.T)
    tilts = half.T @ modes[:, 0]
    tilts /= tilts[np.argmax(np.abs(tilts))]
    return float(squares[0]), tilts, shift @ tilts


def highest_stack(a: float, b: float) -> int:
    """How many equal ellipses stand on each other lying flat."""
    count = 1
    while softest_mode(count + 1, a, b)[0] > 0.0:
        count += 1
    return count


def stack(
    kind: Kind, dt: float, count: int, a: float, b: float, tilt: float, seconds: float
) -> Iterator[tuple[float, float]]:
    """Time and largest tilt, by the first, of a stack let go in its softest mode."""
    _square, tilts, shifts = softest_mode(count, a, b)
    flat = a * a / b
    space = kind.new_space()
    add_floor(space)
    y = b + (flat - b) * (tilt * tilts[0]) ** 2 / 2.0
    bodies = []
    for i in range(count):
        t = tilt * tilts[i]
        if i > 0:
            last = tilt * tilts[i - 1]
            y += 2.0 * b + flat * (t - last) ** 2 / 4.0 - b * (t * t + last * last) / 2
        bodies.append(add_body(space, kind.make, a, b, tilt * shifts[i], y, t))
    for time in steps(space, seconds, dt):
        yield time, max(abs(body.angle) for body in bodies) / tilt


@scene("stack that stands", "largest tilt / that at the start", 2.0)
def stack_that_stands(kind: Kind, dt: float) -> float:
    """Where the potential energy has a minimum, no tilt of the softest mode grows.

    Eleven ellipses of aspect ratio 10, of at most twelve. Twice the tilt is allowed for,
    because contacts yield by the collision slop.
    """
    return max(tilt for _time, tilt in stack(kind, dt, 11, 100.0, 10.0, 0.005, 10.0))


@scene("stack that falls", "time to fall tenfold / predicted, off by", 0.1)
def stack_that_falls(kind: Kind, dt: float) -> float:
    """Three ellipses of aspect ratio 2 fall, as their softest mode grows."""
    count, a, b, growth = 3, 20.0, 10.0, 10.0
    rate = sqrt(-softest_mode(count, a, b)[0])
    predicted = float(np.arccosh(growth)) / rate
    for time, tilt in stack(kind, dt, count, a, b, 0.005, 3.0 * predicted):
        if tilt >= growth:
            return abs(time / predicted - 1.0)
    return inf


@scene("needle on its tip", "time to fall / that by its energy, off by", 0.01)
def needle_on_its_tip(kind: Kind, dt: float) -> float:
    """An ellipse of aspect ratio 50 upright, its tip sharper than the collision slop, falls to the side it leans to.

    It rolls over its tip (a circle of 0.02, a fifth of the slop) and does not slide.
    """
    a, b, lean, end = 50.0, 1.0, 0.05, 0.3
    space = kind.new_space()
    add_floor(space)
    upright = pi / 2.0
    body = add_body(
        space, kind.make, a, b, 0.0, height(a, b, upright - lean), upright - lean
    )
    rolling = Rolling(a, b, GRAVITY)
    expected = rolling.seconds_to_turn(upright - lean, end)
    for time in steps(space, 3.0 * expected, dt):
        if body.angle <= end:
            return abs(time / expected - 1.0)
    return inf


@scene("needle on its side", "period / that by its energy, off by", 0.02)
def needle_on_its_side(kind: Kind, dt: float) -> float:
    """An ellipse of aspect ratio 50 lies flat and rocks by 1e-3 rad."""
    a, b, tilt = 50.0, 1.0, 1e-3
    space = kind.new_space()
    add_floor(space)
    body = add_body(space, kind.make, a, b, 0.0, height(a, b, tilt), tilt)
    expected = Rolling(a, b, GRAVITY).period(tilt)
    crossings = []
    last = tilt
    for time in steps(space, 12.0 * expected, dt):
        if last > 0.0 >= body.angle:
            crossings.append(time - dt * body.angle / (body.angle - last))
        last = body.angle
    if len(crossings) < 10:
        return inf
    period = (crossings[9] - crossings[0]) / 9.0
    return abs(period / expected - 1.0)


@scene("two needles", "least friction to stand / that by statics, off by", 0.1)
def two_needles(kind: Kind, dt: float) -> float:
    """Two needles lean on each other with tips a fifth as sharp as the collision slop.

    On legs at an angle to the floor, by the balance of each, friction of 1/(2 tan(angle)) holds
    the feet. They have to stand with a tenth more, and fall with a tenth less.
    """
    a, b, angle = 50.0, 1.0, 1.2
    least = 0.5 / tan(angle)
    off = 0.0
    for part in (1.1, 0.9):
        space = kind.new_space()
        add_floor(space, 1.0)
        legs = []
        for side in (-1.0, 1.0):
            x, y = side * height(b, a, angle), height(a, b, angle)
            leg = add_body(space, kind.make, a, b, x, y, -side * angle, friction=1.0)
            legs.append(leg)
        for shape in space.shapes:
            if shape.body is not space.static_body:
                shape.friction = part * least
        for _ in steps(space, 2.0, dt):
            pass
        stands = all(abs(abs(leg.angle) - angle) < 0.05 for leg in legs)
        if stands != (part > 1.0):
            off = inf
    return off


@scene("spinning landing", "energy gained / energy at the start", 0.01)
def spinning_landing(kind: Kind, dt: float) -> float:
    """An ellipse that lands spinning, without elasticity, never has more energy than it had before."""
    a, b = 20.0, 10.0
    space = kind.new_space()
    add_floor(space, 0.7)
    body = add_body(space, kind.make, a, b, 0.0, 4.0 * a, 0.3, friction=0.7)
    body.angular_velocity = 30.0
    start = least = energy(body)
    gained = 0.0
    for _ in steps(space, 6.0, dt):
        now = energy(body)
        gained = max(gained, now - least)
        least = min(least, now)
    return gained / start


@scene("wedge", "depth in the walls / slop", 2.0)
def wedge(kind: Kind, dt: float) -> float:
    """An ellipse falls between two steep walls and comes to rest in them, no deeper than the slop."""
    a, b, half_angle = 20.0, 10.0, 0.15
    space = kind.new_space()
    slope_x, slope_y = sin(half_angle), cos(half_angle)
    for side in (-1.0, 1.0):
        add_wall(space, (0.0, 0.0), (side * 400 * slope_x, 400 * slope_y), 0.2)
    body = add_body(space, kind.make, a, b, 1.0, 250.0, 0.4, friction=0.2)
    for _ in steps(space, 6.0, dt):
        pass
    if not body.kinetic_energy / 2.0 / body.mass <= (GRAVITY * dt) ** 2:
        return inf
    depth = 0.0
    for side in (-1.0, 1.0):
        # Into the wall.
        nx, ny = side * slope_y, -slope_x
        c, s = cos(body.angle), sin(body.angle)
        reach = hypot(a * (c * nx + s * ny), b * (c * ny - s * nx))
        depth = max(depth, body.position.x * nx + body.position.y * ny + reach)
    return depth / space.collision_slop


@scene("closing walls", "deepest overlap / slop", 1.0)
def closing_walls(kind: Kind, dt: float) -> float:
    """Walls that close slowly on three lying ellipses turn them upright, side by side: what fits does not overlap, but for the slop."""
    a, b, speed, seconds = 30.0, 10.0, 12.0, 7.0
    end = 1.05 * 3.0 * b
    space = kind.new_space(0.0)
    walls = []
    for side in (-1.0, 1.0):
        wall = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        wall.position = side * (end + speed * seconds), 0.0
        wall.velocity = -side * speed, 0.0
        face = pymunk.Segment(wall, (0.0, -300.0), (0.0, 300.0), 0.0)
        face.friction = 0.2
        space.add(wall, face)
        walls.append(wall)
    bodies = [
        add_body(space, kind.make, a, b, 2.1 * a * i, 0.0, 0.1, friction=0.2)
        for i in (-1, 0, 1)
    ]
    for _ in steps(space, seconds, dt):
        pass
    depths = [-separation(one, a, b, two, a, b) for one, two in combinations(bodies, 2)]
    for body in bodies:
        reach = height(b, a, body.angle)
        depths.append(reach - walls[1].position.x + body.position.x)
        depths.append(reach + walls[0].position.x - body.position.x)
    return max(depths) / space.collision_slop


@scene("heavy on light", "deepest overlap / b of the light ones", 0.5)
def heavy_on_light(kind: Kind, dt: float) -> float:
    """An ellipse of mass 1000 falls on five of mass 1 in a box and does not pass through them."""
    a, b, half_width = 20.0, 10.0, 45.0
    space = kind.new_space()
    add_floor(space, 0.5)
    for side in (-1.0, 1.0):
        add_wall(space, (side * half_width, 0.0), (side * half_width, 500.0), 0.5)
    light = [
        add_body(
            space, kind.make, a, b, 22.0 * (-1) ** i, 12.0 + 21.0 * i, 0.1, friction=0.5
        )
        for i in range(5)
    ]
    heavy = add_body(
        space, kind.make, 2.0 * a, 2.0 * b, 0.0, 150.0, 0.2, mass=1000.0, friction=0.5
    )
    deepest = 0.0
    for time in steps(space, 8.0, dt):
        if time > 4.0:
            for body in light:
                deepest = max(
                    deepest,
                    -separation(heavy, 2.0 * a, 2.0 * b, body, a, b),
                    height(a, b, body.angle) - body.position.y,
                )
    return deepest / b


@scene("pile", "speed at rest (rms) / gravity * step", 0.05, 1.0 / 30.0)
def pile(kind: Kind, dt: float) -> float:
    """Sixty ellipses fall into a box in steps of 1/30 s and rest: they move by less than gravity makes in a step."""
    space = kind.new_space()
    bodies = add_pile(space, kind.make)
    squares = []
    for time in steps(space, 20.0, dt):
        if time > 18.0:
            squares.append(mean_square_speed(bodies))
    outside = any(
        not (abs(body.position.x) < 130.0 and body.position.y > 0.0) for body in bodies
    )
    return inf if outside else sqrt(sum(squares) / len(squares)) / (GRAVITY * dt)


@scene("born in one place", "kinetic energy per mass / (slop / step)^2", 1.0)
def born_in_one_place(kind: Kind, dt: float) -> float:
    """Ten ellipses with one centre part: positions are corrected, which gives no velocity to speak of."""
    a, b = 20.0, 10.0
    space = kind.new_space(0.0)
    rng = random.Random(3)
    bodies = [
        add_body(space, kind.make, a, b, 0.0, 0.0, rng.uniform(0.0, pi))
        for _ in range(10)
    ]
    for _ in steps(space, 4.0, dt):
        pass
    deepest = max(
        -separation(one, a, b, two, a, b) for one, two in combinations(bodies, 2)
    )
    if not deepest < 2.0 * space.collision_slop:
        return inf
    fastest = sum(body.kinetic_energy for body in bodies) / 2.0 / len(bodies)
    return fastest / (space.collision_slop / dt) ** 2


@scene("born overlapped", "way to part / least translation", 1.01)
def born_overlapped(kind: Kind, dt: float) -> float:
    """A small ellipse in a large one parts by the least translation that does it, the worst of 100 pairs of aspect ratio 10.

    They cannot turn: then that direction stays the best one on the way.
    """
    rng = random.Random(11)
    large, small = (100.0, 10.0), (30.0, 3.0)
    longest = 0.0
    for _ in range(100):
        space = kind.new_space(0.0)
        first = add_body(space, kind.make, *large, 0.0, 0.0)
        x, y = rng.uniform(-110.0, 110.0), rng.uniform(-8.0, 8.0)
        second = add_body(space, kind.make, *small, x, y, rng.uniform(0.0, pi))
        for body in (first, second):
            body.moment = inf
        least = -separation(first, *large, second, *small)
        if least < 10.0 * space.collision_slop:
            continue
        before = second.position - first.position
        for _ in steps(space, 1.0, dt):
            pass
        moved = second.position - first.position - before
        longest = max(longest, moved.length / least)
    return longest


def rock(kind: Kind, dt: float, seconds: float) -> float:
    """How much of its swing an ellipse of aspect ratio 2 on a floor has lost, or gained."""
    a, b, tilt = 20.0, 10.0, 0.2
    space = kind.new_space()
    add_floor(space)
    body = add_body(space, kind.make, a, b, 0.0, height(a, b, tilt), tilt)
    last_angles = []
    for time in steps(space, seconds, dt):
        if time > seconds - 2.0:
            last_angles.append(body.angle)
    swing = (max(last_angles) - min(last_angles)) / 2.0
    return abs(swing / tilt - 1.0)


@scene("rocking for minutes", "part of the swing lost in 10 minutes", 0.1)
def rocking_for_minutes(kind: Kind, dt: float) -> float:
    """An ellipse that rolls without slip loses nothing."""
    return rock(kind, dt, 600.0)


def roll(
    kind: Kind, dt: float, add_ground: Callable[[pymunk.Space], None], seconds: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Positions and energies of an ellipse of aspect ratio 1.5 that rolls over its ends without losing contact."""
    a, b, spin = ROLLING
    space = kind.new_space()
    add_ground(space)
    body = add_body(space, kind.make, a, b, 0.0, b)
    body.angular_velocity = spin
    body.velocity = -spin * b, 0.0
    rows = [
        (*body.position, energy(body) - GRAVITY * b) for _ in steps(space, seconds, dt)
    ]
    path = np.array(rows)
    return path[:, :2], path[:, 2]


ROLLING = 15.0, 10.0, -6.0
JOINED = 200


def one_segment(space: pymunk.Space) -> None:
    add_floor(space)


def joined_segments(space: pymunk.Space, length: float, neighbors: bool = True) -> None:
    """A floor of segments in a row, which know their neighbours."""
    for i in range(JOINED):
        x = (i - 3) * length
        segment = add_wall(space, (x, 0.0), (x + length, 0.0))
        if neighbors:
            segment.set_neighbors((x - length, 0.0), (x + 2.0 * length, 0.0))


def tiles(space: pymunk.Space, length: float) -> None:
    """A floor of boxes side by side, which do not."""
    for i in range(JOINED):
        x = (i - 3) * length
        corners = [
            (x, -10.0),
            (x + length, -10.0),
            (x + length, 0.0),
            (x, 0.0),
        ]
        tile = pymunk.Poly(space.static_body, corners)
        tile.friction = NO_SLIP
        space.add(tile)


def off_path(
    kind: Kind,
    dt: float,
    add_ground: Callable[[pymunk.Space], None],
    seconds: float = 4.0,
) -> float:
    """How far an ellipse rolls off from where it does on one segment, by the way it rolls there."""
    path, _ = roll(kind, dt, add_ground, seconds)
    expected, _ = roll(kind, dt, one_segment, seconds)
    way = float(abs(expected[-1, 0]))
    return float(np.max(np.abs(path - expected))) / way


@scene("joined segments", "off the path on one segment / way", 1e-6)
def over_joined_segments(kind: Kind, dt: float) -> float:
    """On 200 segments in a row, each half as long as the ellipse's semi-axis, it rolls as on one."""
    length = ROLLING[0] / 2.0
    return off_path(kind, dt, partial(joined_segments, length=length))


@scene("tiles", "off the path on one segment / way", 0.03)
def over_tiles(kind: Kind, dt: float) -> float:
    """On boxes side by side an ellipse meets their corners, within the slop: it should roll nearly as on one segment."""
    return off_path(kind, dt, partial(tiles, length=ROLLING[0] / 2.0))


@scene("elastic gas", "energy gained or lost in a minute", 0.01, 1.0 / 60.0)
def elastic_gas(kind: Kind, dt: float) -> float:
    """Twenty shapes that bounce off one another in a box, without friction and loss, keep their energy."""
    return abs(gas_energy(kind, dt, 60.0) - 1.0)


def add_roller(
    space: pymunk.Space,
    body: pymunk.Body,
    shape: pymunk.Shape,
    rolling: Rolling,
    spin: float,
    dt: float,
    elasticity: float = 0.0,
) -> None:
    """Add a floor and a body that rolls on it, at the angle zero, begun so that its velocity is that of half a step on."""
    floor = add_floor(space)
    floor.elasticity = elasticity
    shape.elasticity = 1.0
    shape.friction = NO_SLIP
    ahead, ahead_spin, _way = rolling.after(0.0, spin, dt / 2.0, 20)
    x, y = body.center_of_gravity
    body.position = -x, rolling.height(0.0) - y
    body.velocity = rolling.velocity(ahead, ahead_spin)
    body.angular_velocity = ahead_spin
    space.add(body, shape)


@scene("elastic roller", "off the way it rolls in 10 s / way", 0.002)
def elastic_roller(kind: Kind, dt: float) -> float:
    """An ellipse that rolls without slip does not bounce, and goes as far as one without elasticity."""
    a, b, spin = 20.0, 14.0, -5.0
    rolling = Rolling(a, b, GRAVITY)
    _angle, _spin, way = rolling.after(0.0, spin, 10.0)
    space = kind.new_space()
    body = pymunk.Body(1.0, (a * a + b * b) / 4.0)
    shape = kind.make(body, a, b)
    add_roller(space, body, shape, rolling, spin, dt, elasticity=0.8)
    for _ in steps(space, 10.0, dt):
        pass
    return abs(body.position.x / way - 1.0)


@scene("wheel off its centre", "energy gained or lost in 10 s", 0.001)
def wheel_off_its_centre(kind: Kind, dt: float) -> float:
    """A round wheel with its centre of gravity beside the centre rolls without slip, faster and slower, and loses nothing."""
    radius, square, spin = 10.0, 50.0, -8.0
    beside = -3.0, 0.0
    rolling = Rolling(radius, radius, GRAVITY, beside, square)
    space = kind.new_space()
    body = pymunk.Body(1.0, square)
    body.center_of_gravity = beside
    add_roller(space, body, kind.make(body, radius, radius), rolling, spin, dt)
    for _ in steps(space, 10.0, dt):
        pass
    center = body.local_to_world(body.center_of_gravity)
    # The velocity is that of half a step on.
    lifted = GRAVITY * (center.y + body.velocity.y * dt / 2.0)
    return abs((body.kinetic_energy / 2.0 + lifted) / rolling.energy(0.0, spin) - 1.0)


@scene("cam", "follower off the cam's height / b", 0.01)
def cam(kind: Kind, dt: float) -> float:
    """An ellipse that turns evenly lifts a box, which cannot turn, by its support function."""
    a, b, half = 20.0, 10.0, 5.0
    space = kind.new_space()
    turning = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    # The follower would need a faster fall than by gravity from 4 on.
    turning.angular_velocity = 2.0
    shape = kind.make(turning, a, b)
    follower = pymunk.Body(1.0, inf)
    follower.position = 0.0, b + half
    box = pymunk.Poly.create_box(follower, (200.0, 2.0 * half))
    space.add(turning, shape, follower, box)
    off = 0.0
    for time in steps(space, 10.0, dt):
        if time > 1.0:
            expected = height(a, b, turning.angle) + half
            off = max(off, abs(follower.position.y - expected))
    return off / b


@scene("chain", "widest gap in the joints / b", 0.1)
def chain(kind: Kind, dt: float) -> float:
    """Joints hold a chain of ellipses between two posts together where a heavier one falls on it."""
    a, b, count = 20.0, 10.0, 9
    space = kind.new_space()
    links = [
        add_body(space, kind.make, a, b, 2.0 * a * i, 0.0, friction=0.5)
        for i in range(count)
    ]
    ends = [space.static_body, *links, space.static_body]
    joints = []
    for i, (left, right) in enumerate(pairwise(ends)):
        joint = pymunk.PivotJoint(left, right, ((2 * i - 1) * a, 0.0))
        joint.collide_bodies = False
        joints.append(joint)
    space.add(*joints)
    heavy = add_body(
        space, kind.make, 2.0 * a, 2.0 * b, 8.0 * a, 150.0, 0.5, 10.0, friction=0.5
    )
    widest = 0.0
    for _ in steps(space, 8.0, dt):
        for joint in joints:
            one = joint.a.local_to_world(joint.anchor_a)
            other = joint.b.local_to_world(joint.anchor_b)
            widest = max(widest, one.get_distance(other))
    return widest / b if heavy.position.y < 150.0 else inf


@scene("mixed pile", "force on the box / weight, off by", 0.03)
def mixed_pile(kind: Kind, dt: float) -> float:
    """Ellipses, circles, boxes and bars fall into a box, come to rest and weigh what they weigh."""
    space = kind.new_space()
    bodies = add_pile(space, kind.make, 12)
    for i in range(12):
        body = pymunk.Body()
        body.position = (i % 6 - 2.5) * 42.0, 110.0 + 42.0 * (i // 6)
        shape = (
            pymunk.Circle(body, 12.0),
            pymunk.Poly.create_box(body, (30.0, 16.0), 1.0),
            pymunk.Segment(body, (-15.0, 0.0), (15.0, 0.0), 5.0),
        )[i % 3]
        shape.mass = 1.0
        shape.friction = 0.5
        space.add(body, shape)
        bodies.append(body)
    weight = GRAVITY * len(bodies)
    on_floor = 0.0
    count = 0
    for time in steps(space, 12.0, dt):
        if time > 10.0:
            count += 1
            arbiters = []
            space.static_body.each_arbiter(arbiters.append)
            on_floor += sum(arbiter.total_impulse.y for arbiter in arbiters) / dt
    return abs(abs(on_floor) / count / weight - 1.0)


@scene("pile that sleeps", "part of the bodies awake after 10 s", 0.0)
def pile_that_sleeps(kind: Kind, dt: float) -> float:
    """A pile at rest falls asleep."""
    space = kind.new_space()
    space.sleep_time_threshold = 0.5
    bodies = add_pile(space, kind.make, 24)
    for _ in steps(space, 10.0, dt):
        pass
    return sum(not body.is_sleeping for body in bodies) / len(bodies)
