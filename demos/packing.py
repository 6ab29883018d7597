"""The densest random packings of ellipses: walls close on frictionless ellipses until they jam, for each aspect ratio."""

from __future__ import annotations

import random
from math import pi, sqrt
from pathlib import Path
from statistics import mean
from typing import Any

import numpy as np
import pymunk
from matplotlib.figure import Figure

from pymunk_ellipse import Ellipse

from ._densities import tell_densities
from ._picture import draw_ellipses, save
from ._sweep import ONE_JOB, Engine, sweep

ASPECT_RATIOS = 1.0, 1.1, 1.2, 1.3, 1.4, 1.6, 1.8, 2.2, 3.0, 5.0
QUICK_ASPECT_RATIOS = 1.0, 1.4, 3.0
# Half of the ellipses are larger by this, in both semi-axes: equal circles would form a crystal.
LARGER = 1.4
# Random close packing of such circles (C. O'Hern and others, 2003), and where packings of
# ellipses are densest (G. Delaney and others, 2005; S. Rocks and R. S. Hoy, 2023).
CIRCLES = 0.84
DENSEST = 1.4
# A mean radius of the small ones (the square root of a b), in the walls' units.
RADIUS = 10.0
STEP = 1.0 / 120.0
# Of the walls, in radii per second.
SPEED = 1.0
# Jammed when ellipses overlap by more than this on average, in radii.
JAMMED = 5e-3
# How long they may rearrange (seconds), and after how many steps that is looked at.
PATIENCE = 4.0
CHECKED = 5
THICKNESS = 200.0
SEED = 3


class Press:
    """Ellipses without friction between four walls that close."""

    def __init__(self, aspect_ratio: float, count: int, seed: int) -> None:
        rng = random.Random(seed)
        self.space = pymunk.Space()
        self.space.iterations = 30
        self.space.damping = 0.1
        # So little that the overlaps measured are those of the pressure.
        self.space.collision_slop = 1e-3 * RADIUS
        a, b = RADIUS * sqrt(aspect_ratio), RADIUS / sqrt(aspect_ratio)
        reach = LARGER * a + 0.5
        columns = round(sqrt(count))
        self.half = columns * reach
        self.ellipses: list[Ellipse] = []
        sizes = [1.0, LARGER] * (columns * columns // 2) + [1.0] * (columns % 2)
        rng.shuffle(sizes)
        for i, size in enumerate(sizes):
            row, column = divmod(i, columns)
            body = pymunk.Body()
            body.position = (
                (2.0 * column + 1.0) * reach - self.half,
                (2.0 * row + 1.0) * reach - self.half,
            )
            body.angle = rng.uniform(0.0, pi)
            ellipse = Ellipse(body, size * a, size * b)
            ellipse.density = 1.0
            # Mixes them, until the walls have come closer.
            body.velocity = rng.gauss(0.0, 60.0), rng.gauss(0.0, 60.0)
            body.angular_velocity = rng.gauss(0.0, 60.0 / a)
            self.space.add(body, ellipse)
            self.ellipses.append(ellipse)
        self.walls = []
        for nx, ny in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)):
            wall = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
            distance = self.half + THICKNESS
            wall.position = nx * distance, ny * distance
            side = pymunk.Vec2d(-ny, nx) * 2.0 * distance
            shape = pymunk.Segment(wall, side, -side, THICKNESS)
            self.space.add(wall, shape)
            self.walls.append((wall, pymunk.Vec2d(nx, ny)))

    def close(self, speed: float) -> None:
        """Step with walls that move in at this speed."""
        for wall, normal in self.walls:
            wall.velocity = -speed * normal
        self.space.step(STEP)
        self.half -= speed * STEP

    @property
    def area(self) -> float:
        return sum(ellipse.area for ellipse in self.ellipses)

    @property
    def density(self) -> float:
        """The part of the box that the ellipses would fill."""
        return self.area / (4.0 * self.half * self.half)

    def overlap(self) -> float:
        """The mean depth of the contacts of two ellipses, by the radius."""
        depths: list[float] = []

        def note(body: pymunk.Body) -> None:
            body.each_arbiter(
                lambda arbiter: depths.extend(
                    -point.distance for point in arbiter.contact_point_set.points
                )
            )

        for ellipse in self.ellipses:
            assert ellipse.body is not None
            note(ellipse.body)
        return sum(depths) / len(depths) / RADIUS if depths else 0.0


def inner_density(press: Press, points: int = 400) -> float:
    """The part of the middle of the box that is covered, which overlaps count in only once.

    The middle is away from the walls by two diameters of the largest ellipses, at most half of
    the box.
    """
    widest = max(max(ellipse.a, ellipse.b) for ellipse in press.ellipses)
    half = max(press.half - 4.0 * widest, press.half / 2.0)
    line = (np.arange(points) + 0.5) / points * 2.0 * half - half
    x, y = np.meshgrid(line, line)
    covered = np.zeros_like(x, dtype=bool)
    for ellipse in press.ellipses:
        body = ellipse.body
        assert body is not None
        dx, dy = x - body.position.x, y - body.position.y
        c, s = body.rotation_vector
        u, v = (c * dx + s * dy) / ellipse.a, (c * dy - s * dx) / ellipse.b
        covered |= u * u + v * v < 1.0
    return float(np.mean(covered))


def jam(
    aspect_ratio: float, count: int, seed: int, hurry: float
) -> tuple[Press, float]:
    """Close the walls until the ellipses jam; returns the density in the middle.

    The walls stop while ellipses overlap too much. Where that does not go away while they
    rearrange for some time, they are jammed.
    """
    press = Press(aspect_ratio, count, seed)
    while press.density < 0.6:
        press.close(10.0 * RADIUS)
    patience = round(PATIENCE / hurry / STEP)
    waited = 0
    while waited < patience:
        if press.overlap() < JAMMED:
            waited = 0
            speed = hurry * SPEED * RADIUS
        else:
            speed = 0.0
        for _ in range(CHECKED):
            press.close(speed)
        waited += CHECKED
    return press, inner_density(press)


def packed(aspect_ratio: float, count: int, hurry: float, seed: int) -> dict[str, Any]:
    """A run of the sweep: the density, half the width of the box, and the ellipses in it."""
    press, density = jam(aspect_ratio, count, seed, hurry)
    ellipses = []
    for ellipse in press.ellipses:
        body = ellipse.body
        assert body is not None
        ellipses.append((ellipse.a, ellipse.b, *body.position, body.angle))
    return {"density": density, "half": press.half, "ellipses": ellipses}


def run(out: Path, quick: bool, engine: Engine = ONE_JOB) -> None:
    """Jam ellipses of each aspect ratio; a quick run has fewer, and closes the walls faster.

    Boxes that are in packing.jsonl, from a run that was stopped, are not packed again.
    """
    ratios = QUICK_ASPECT_RATIOS if quick else ASPECT_RATIOS
    runs, count, hurry = (1, 64, 4.0) if quick else (3, 400, 1.0)
    found: dict[float, list[float]] = {ratio: [] for ratio in ratios}
    first: dict[float, dict[str, Any]] = {}
    boxes = sweep(
        packed,
        [{"aspect_ratio": r, "count": count, "hurry": hurry} for r in ratios],
        range(1000 * SEED, 1000 * SEED + runs),
        out / "packing.jsonl",
        engine,
    )
    if len(boxes) < len(ratios) * runs:
        raise SystemExit("not all boxes were packed: the next run tries the others")
    for box in boxes:
        ratio = box.parameters["aspect_ratio"]
        found[ratio].append(box.value["density"])
        first.setdefault(ratio, box.value)
    print(f"{runs} boxes of {count} ellipses of two sizes, 1 : {LARGER:g}")
    errors = tell_densities(found, out / "packing.csv", "density", "boxes")
    densest = max(found, key=lambda ratio: mean(found[ratio]))
    print(f"circles, of about {CIRCLES:g} known: {mean(found[1.0]):.4f}")
    print(f"densest aspect ratio tried, about {DENSEST:g} known: {densest:g}")
    print(
        f"bias: overlaps of {JAMMED:g} radii when jammed make it denser by about {2 * JAMMED:g}; "
        "walls order what is next to them, and closing them at a finite speed stops early"
    )
    print(f"table: {out / 'packing.csv'}")
    save(draw(found, errors, first[densest]), out / "packing.png", dpi=110)


def draw(
    found: dict[float, list[float]], errors: dict[float, float], box: dict[str, Any]
) -> Figure:
    """Density over aspect ratio, and the densest packing."""
    figure = Figure(figsize=(10.0, 4.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    left.errorbar(
        list(found),
        [mean(values) for values in found.values()],
        list(errors.values()),
        marker="o",
        capsize=3,
        label="jammed, with standard error",
    )
    left.axhline(CIRCLES, color="gray", linestyle=":", label=f"circles, {CIRCLES:g}")
    left.axvline(DENSEST, color="gray", linestyle="--", label="known place of the peak")
    left.set_xlabel("aspect ratio")
    left.set_ylabel("part of the middle that is covered")
    left.legend()
    left.spines[["top", "right"]].set_visible(False)
    ellipses = []
    # Holds the bodies, which an ellipse alone does not.
    space = pymunk.Space()
    for a, b, x, y, angle in box["ellipses"]:
        body = pymunk.Body()
        body.position = x, y
        body.angle = angle
        ellipses.append(Ellipse(body, a, b))
        space.add(body, ellipses[-1])
    draw_ellipses(right, ellipses)
    right.set_xlim(-box["half"], box["half"])
    right.set_ylim(-box["half"], box["half"])
    right.set_aspect("equal")
    right.set_xticks([])
    right.set_yticks([])
    ratio = ellipses[0].a / ellipses[0].b
    right.set_title(f"jammed, aspect ratio {ratio:.3g}")
    return figure
