"""An ellipse rocks on a floor beside polygons cut from it, against the analytic period."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from math import cos, pi, sin
from pathlib import Path

import numpy as np
import pymunk
from matplotlib.figure import Figure
from numpy.typing import NDArray
from tqdm import tqdm

from pymunk_ellipse import Ellipse

from ._box import MakeShape
from ._picture import save
from ._shapes import inscribed_polygon

A = 20.0
B = 10.0
GRAVITY = 500.0
STEP = 1.0 / 240.0
DURATION = 10.0
TILTS = 0.05, 0.2, 0.5
POLYGONS = 8, 16, 32, 64
# The periods shown from the start.
PERIODS_SHOWN = 3


def analytic_period(tilt: float, nodes: int = 64) -> float:
    """Period of an ellipse that rocks on a flat floor without slip, released at rest at a tilt (radians).

    Energy gives the angular velocity w at each angle t: w^2 = 2 g (h(tilt) - h(t)) / (k^2 + h^2 + h'^2),
    with h the height of the centre and k the radius of gyration. A quarter of the period is the
    integral of 1/w from 0 to the tilt, where 1/w is infinite. With t = tilt sin(s) the
    integrand is smooth and periodic in s, for which the midpoint rule is exact but for roundoff.
    """
    s = (np.arange(nodes) + 0.5) * (pi / 2.0 / nodes)
    t = tilt * np.sin(s)
    height = np.sqrt((A * np.sin(t)) ** 2 + (B * np.cos(t)) ** 2)
    slope = (A * A - B * B) * np.sin(t) * np.cos(t) / height
    highest = np.sqrt((A * sin(tilt)) ** 2 + (B * cos(tilt)) ** 2)
    # highest - height as a quotient: the difference itself would cancel near the turning point.
    fall = (A * A - B * B) * np.sin(tilt - t) * np.sin(tilt + t) / (highest + height)
    inertia = (A * A + B * B) / 4.0 + height**2 + slope**2
    spin = np.sqrt(2.0 * GRAVITY * fall / inertia)
    return float(4.0 * np.sum(tilt * np.cos(s) / spin) * (pi / 2.0 / nodes))


def rock(make_shape: MakeShape, tilt: float) -> NDArray[np.float64]:
    """The angle of a shape after each step from its release at rest on a floor."""
    space, body = scene(make_shape, tilt)
    angles = [tilt]
    for _ in range(round(DURATION / STEP)):
        space.step(STEP)
        angles.append(body.angle)
    return np.array(angles)


def scene(
    make_shape: MakeShape, tilt: float, friction: float = 1e3
) -> tuple[pymunk.Space, pymunk.Body]:
    """A shape at rest on a floor, about to rock, with enough friction that nothing slips."""
    space = pymunk.Space()
    space.gravity = 0.0, -GRAVITY
    floor = pymunk.Segment(space.static_body, (-10.0 * A, 0.0), (10.0 * A, 0.0), 0.0)
    body = pymunk.Body()
    shape = make_shape(body)
    floor.friction = shape.friction = friction
    shape.mass = 1.0
    body.angle = tilt
    body.position = 0.0, lowest_height(shape)
    space.add(floor, body, shape)
    return space, body


def lowest_height(shape: pymunk.Shape) -> float:
    """How high the body's origin is when the shape, at the body's angle, rests on the ground."""
    assert shape.body is not None
    if isinstance(shape, Ellipse):
        angle = shape.body.angle
        return float(np.hypot(shape.a * sin(angle), shape.b * cos(angle)))
    assert isinstance(shape, pymunk.Poly)
    return -min(v.rotated(shape.body.angle).y for v in shape.get_vertices())


@dataclass
class Rocking:
    """What is read from an angle over time."""

    period: float | None
    amplitude_kept: float


def measure(angles: NDArray[np.float64], tilt: float) -> Rocking:
    """The period of the first swing and what is left of the amplitude in the end."""
    before = np.flatnonzero(angles[:-1] * angles[1:] < 0.0)
    crossings = STEP * (before + angles[before] / (angles[before] - angles[before + 1]))
    # From the first passage through the middle to the third, one whole swing.
    period = float(crossings[2] - crossings[0]) if len(crossings) > 2 else None
    last_swing = angles[-round(analytic_period(tilt) / STEP) - 1 :]
    return Rocking(period, float(np.ptp(last_swing)) / 2.0 / tilt)


def run(out: Path, quick: bool) -> None:
    """Rock every shape from every tilt; a quick run is the same, it takes seconds."""
    shapes: dict[str, MakeShape] = {"ellipse": partial(Ellipse, a=A, b=B)}
    for n in POLYGONS:
        shapes[f"{n}-gon"] = partial(inscribed_polygon, a=A, b=B, count=n)
    rocked = {
        (tilt, name): rock(shapes[name], tilt)
        for tilt, name in tqdm([(t, s) for t in TILTS for s in shapes], "rocking")
    }

    print(f"a={A:g}, b={B:g}, g={GRAVITY:g}, dt=1/{1 / STEP:.0f}, {DURATION:g} s")
    print("tilt  shape    period (s)  analytic (s)  error      amplitude kept")
    for (tilt, name), angles in rocked.items():
        analytic = analytic_period(tilt)
        found = measure(angles, tilt)
        if found.period is None:
            period, error = "none", "-"
        else:
            period = f"{found.period:.6f}"
            error = f"{found.period / analytic - 1.0:+.4%}"
        print(
            f"{tilt:4g}  {name:7}  {period:10}  {analytic:<12.6f}  {error:9}  "
            f"{found.amplitude_kept:.2%}"
        )
    save(draw(rocked, list(shapes)), out / "rocking.png")


def draw(
    rocked: dict[tuple[float, str], NDArray[np.float64]], names: list[str]
) -> Figure:
    """The first swings and the last one, a row for each tilt, with the analytic period marked."""
    figure = Figure(figsize=(10.0, 8.0), layout="constrained")
    panels = figure.subplots(
        len(TILTS), 2, sharey="row", squeeze=False, width_ratios=[PERIODS_SHOWN, 1]
    )
    for row, tilt in zip(panels, TILTS, strict=True):
        period = analytic_period(tilt)
        spans = (0.0, PERIODS_SHOWN * period), (DURATION - period, DURATION)
        for axes, (start, end) in zip(row, spans, strict=True):
            for index, name in reversed(list(enumerate(names))):
                angles = rocked[tilt, name]
                axes.plot(
                    STEP * np.arange(len(angles)),
                    angles,
                    color="black" if index == 0 else f"C{index - 1}",
                    linewidth=2.0 if index == 0 else 1.0,
                    label=name,
                )
            axes.set_xlim(start, end)
            axes.spines[["top", "right"]].set_visible(False)
        for swing in range(1, PERIODS_SHOWN + 1):
            row[0].axvline(swing * period, color="gray", linestyle=":")
        row[0].set_ylabel("angle (rad)")
        row[0].set_title(
            f"released at {tilt:g} rad; dotted: the analytic period, {period:.4f} s"
        )
        row[1].set_title("the last period")
    for axes in panels[-1]:
        axes.set_xlabel("time (s)")
    handles, labels = panels[0, 0].get_legend_handles_labels()
    figure.legend(
        handles[::-1], labels[::-1], loc="outside upper center", ncols=len(names)
    )
    return figure
