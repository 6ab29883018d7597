"""An inspector of contacts: drag and turn two shapes, and see the circles that are fitted to them, beside the published fit."""

from __future__ import annotations

from itertools import pairwise
from math import cos, pi
from typing import TYPE_CHECKING, NamedTuple

import pymunk
from pymunk import Transform, Vec2d

from pymunk_ellipse import Ellipse
from pymunk_ellipse.examples.stage import Scene, main
from pymunk_ellipse.examples.stage.fit import (
    Placed,
    Step,
    exact_steps,
    exact_steps_to_polygon,
    published_steps,
)

if TYPE_CHECKING:
    from pymunk_ellipse.examples.stage.canvas import Canvas

A, B = 64.0, 34.0
WIDTH = 330.0
HANDLE = 18.0
GRAB = 9.0
# The shapes in pale colours, their circles in strong ones.
PALE = "#cfe6f2", "#f3d3d7"
STRONG = "#2e7fae", "#c43a4e"
PALE_CIRCLES = "#9cc6de", "#e3a0aa"
HULL, WEAK, DEPTH = "#a9adb4", "#c3c0b8", "#e08a00"
ARROW = 46.0
# Where the shapes end and the table begins, and how many steps it has room for.
TITLE, TABLE = 212.0, 0.0
ROWS = 6
EXACT = 1e-9
LEGEND = (
    "Strong circles: last step. Pale: earlier ones. Arrow: contact normal. "
    "Orange: overlap or gap. Grey: hull."
)
KINDS = "ellipse", "circle", "segment", "polygon"


class Stop(NamedTuple):
    """Where the second shape is at some time of the tour, seen from the first, and which kind it is from then on."""

    seconds: float
    kind: int
    place: tuple[float, float]
    angle: float


TOUR = (
    Stop(0.0, 0, (112, 20), 2.4),
    Stop(2.0, 0, (84, 12), 1.7),
    Stop(4.0, 0, (56, -34), -0.4),
    # Here the published circles do not settle.
    Stop(5.0, 0, (52, -38), -1.36),
    Stop(6.2, 0, (52, -38), -1.36),
    Stop(7.0, 1, (70, 46), -1.36),
    Stop(9.0, 2, (10, 56), 0.0),
    Stop(11.0, 2, (92, 30), 1.9),
    Stop(12.0, 3, (96, 8), 2.4),
    Stop(14.0, 3, (72, -30), 4.6),
)


class Inspector(Scene):
    view = 0.0, -140.0, 2 * WIDTH, 230.0
    seconds = TOUR[-1].seconds
    picture_at = 5.5
    pixels = 640
    hint = (
        "Drag the shapes, turn them by their knobs. 1 ellipse, 2 circle, 3 segment, "
        "4 polygon. Up, down: rounder, flatter. H: hulls"
    )

    def __init__(self) -> None:
        super().__init__()
        self.bodies = [self.place(150, 108, 0.35), self.place(220, 70, 2.1)]
        self.first = Ellipse(self.bodies[0], A, B)
        self.kind = 0
        self.second = self.make_second()
        self.hulls = True
        # What the mouse holds: a body, and its place in the mouse's hand, or nothing to turn it.
        self.held: pymunk.Body | None = None
        self.grip: Vec2d | None = None
        self.panel = 0.0
        self.most_steps = 0
        self.worst = {"exact": 0.0, "published": 0.0}

    def place(self, x: float, y: float, angle: float) -> pymunk.Body:
        body = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        body.position = x, y
        body.angle = angle
        return body

    def make_second(self) -> pymunk.Shape:
        body = self.bodies[1]
        kind = KINDS[self.kind]
        if kind == "ellipse":
            return Ellipse(body, 52, 17)
        if kind == "circle":
            return pymunk.Circle(body, 30)
        if kind == "segment":
            return pymunk.Segment(body, (-48, 0), (48, 0), 8)
        corners = [(-42, -24), (20, -34), (46, -4), (16, 32), (-34, 26)]
        return pymunk.Poly(body, corners)

    def step(self) -> None:
        """Nothing moves by itself."""
        self.steps += 1

    def press(self, point: Vec2d) -> None:
        """Take the knob or the shape under the mouse, in either panel."""
        self.panel = WIDTH if point.x > WIDTH else 0.0
        point -= (self.panel, 0)
        for body, shape in zip(self.bodies, (self.first, self.second), strict=True):
            shape.cache_bb()
            if self.knob(body).get_distance(point) < GRAB:
                self.held, self.grip = body, None
            elif shape.point_query(point).distance < GRAB / 3:
                self.held, self.grip = body, body.position - point

    def drag(self, point: Vec2d) -> None:
        point -= (self.panel, 0)
        if self.held is None:
            return
        if self.grip is None:
            self.held.angle = (point - self.held.position).angle
        else:
            self.held.position = point + self.grip

    def release(self) -> None:
        self.held = None

    def key(self, name: str, down: bool) -> None:
        if not down:
            return
        if name in ("1", "2", "3", "4"):
            self.kind = int(name) - 1
            self.second = self.make_second()
        elif name in ("up", "down"):
            b = self.first.b * (1.1 if name == "up" else 1 / 1.1)
            self.first = Ellipse(self.bodies[0], A, min(A, max(4.0, b)))
        elif name == "h":
            self.hulls = not self.hulls

    def play(self) -> None:
        """A hand: the second shape goes around the first, turning, and is of one kind after another."""
        before, after = next(
            pair for pair in pairwise(TOUR) if self.time <= pair[1].seconds
        )
        if before.kind != self.kind:
            self.key(str(before.kind + 1), True)
        part = (self.time - before.seconds) / (after.seconds - before.seconds)
        part = (1 - cos(pi * part)) / 2
        first, second = self.bodies
        place = Vec2d(*before.place).interpolate_to(after.place, part)
        second.position = first.local_to_world(place)
        second.angle = before.angle + part * (after.angle - before.angle) + first.angle
        if self.steps % 10 == 0:
            self.measure()

    def knob(self, body: pymunk.Body) -> Vec2d:
        """Where a body is turned by."""
        reach = A if body is self.bodies[0] else 52
        return body.local_to_world((reach + HANDLE, 0))

    def fits(self) -> tuple[list[Step], list[Step], float]:
        """The steps of the exact fit, those of the published one, which knows ellipses and circles only, and the true depth."""
        contact = self.first.distance(self.second)
        one, other = (placed(shape) for shape in (self.first, self.second))
        assert one is not None
        published = []
        if other is not None:
            exact = exact_steps(one, other, contact.normal)
            published = published_steps(one, other)
        else:
            corners, radius = corners_of(self.second)
            exact = exact_steps_to_polygon(one, corners, radius, contact.normal)
        return exact, published, -contact.distance

    def measure(self) -> None:
        """Keep how many steps were taken, and how far off the fits ended where the two overlap."""
        exact, published, depth = self.fits()
        self.most_steps = max(self.most_steps, len(exact))
        for name, steps in ("exact", exact), ("published", published):
            if steps and depth > 0.0:
                error = abs(steps[-1].depth - depth)
                self.worst[name] = max(self.worst[name], error)

    def numbers(self) -> dict[str, float]:
        return {
            "most steps of the exact fit": self.most_steps,
            "largest error of its depth": self.worst["exact"],
            "largest error of the published fit's depth": self.worst["published"],
        }

    def draw(self, canvas: Canvas) -> None:
        exact, published, depth = self.fits()
        whole = canvas.transform
        for left, title, steps in (
            (0.0, "this package: both circles at one normal", exact),
            (WIDTH, "as published: each faces the other's circle", published),
        ):
            canvas.transform = whole @ Transform.translation(left, 0)
            canvas.write(title, (12, TITLE + 8), "midleft", size=0.8)
            canvas.clip((0, TABLE, WIDTH, TITLE))
            self.draw_shapes(canvas)
            if steps:
                self.draw_fit(canvas, steps)
            canvas.clip(None)
            self.draw_table(canvas, steps, depth)
            canvas.transform = whole
        canvas.line([(WIDTH, TABLE - 124), (WIDTH, TITLE + 18)], WEAK)
        canvas.write(LEGEND, (WIDTH, TABLE - 132), size=0.65)

    def draw_shapes(self, canvas: Canvas) -> None:
        """Both shapes, their outlines over each other, the knobs, and the hulls of ellipses."""
        outlines = [outline_of(shape) for shape in (self.first, self.second)]
        for outline, pale in zip(outlines, PALE, strict=True):
            canvas.polygon(outline, pale)
        for outline, body in zip(outlines, self.bodies, strict=True):
            canvas.line([body.position, self.knob(body)], WEAK)
            canvas.dot(self.knob(body))
            canvas.line([*outline, outline[0]])
        for shape in (self.first, self.second):
            if self.hulls and isinstance(shape, Ellipse):
                canvas.line(hull_of(shape), HULL)

    def draw_fit(self, canvas: Canvas, steps: list[Step]) -> None:
        """The circles of all steps, those of the last one strong, and the normal through their centres."""
        for step in steps:
            colors = STRONG if step is steps[-1] else PALE_CIRCLES
            for circle, color in zip((step.first, step.second), colors, strict=True):
                if circle is not None:
                    canvas.ring(circle.center, circle.radius, color)
                    canvas.dot(circle.center, color)
        step = steps[-1]
        if step.second is not None:
            canvas.line([step.first.center, step.second.center])
        touch = step.first.center + step.first.radius * step.normal
        tip = touch + ARROW * step.normal
        canvas.line([touch, tip])
        for side in (-1, 1):
            barb = (-0.2 * ARROW * step.normal).rotated(0.4 * side)
            canvas.line([tip, tip + barb])
        # From one surface to the other.
        canvas.thick_line(touch, touch - step.depth * step.normal, 2, DEPTH)

    def draw_table(self, canvas: Canvas, steps: list[Step], depth: float) -> None:
        """The depth after each step, until it is the true one."""
        top = TABLE - 14
        if not steps:
            canvas.write("It knows ellipses and circles only.", (12, top), "midleft")
            return
        canvas.write(in_words(steps[-1].depth), (12, top), "midleft")
        for i, step in enumerate(steps[:ROWS], 1):
            y = top - 4 - 14 * i
            error = abs(step.depth - depth)
            off = f"off by {error:.0e}" if error > EXACT else "exact"
            for x, text in (
                (12, "sweep" if step.swept else f"step {i}"),
                (64, in_words(step.depth)),
                (200, off),
            ):
                canvas.write(text, (x, y), "midleft", size=0.7)
            if error <= EXACT:
                return
        if len(steps) > ROWS:
            more = f"and {len(steps) - ROWS} more steps"
            canvas.write(more, (12, y - 14), "midleft", size=0.7)


def in_words(depth: float) -> str:
    """A depth, in words."""
    return f"{'overlap' if depth > 0.0 else 'apart by'} {abs(depth):.5f}"


def placed(shape: pymunk.Shape) -> Placed | None:
    """An ellipse or a circle in numbers, None for others."""
    body = shape.body
    if body is None or not isinstance(shape, Ellipse | pymunk.Circle):
        return None
    x, y = body.position
    if isinstance(shape, Ellipse):
        return shape.a, shape.b, x, y, body.angle
    return shape.radius, shape.radius, x, y, body.angle


def corners_of(shape: pymunk.Shape) -> tuple[list[Vec2d], float]:
    """The vertices of a segment or a polygon in the world, counterclockwise, and its radius."""
    if isinstance(shape, pymunk.Segment):
        local = [shape.a, shape.b]
    else:
        assert isinstance(shape, pymunk.Poly)
        local = shape.get_vertices()
    body = shape.body
    assert body is not None
    return [body.local_to_world(point) for point in local], shape.radius


def outline_of(shape: pymunk.Shape) -> list[Vec2d]:
    """What a shape looks like: points around it in the world."""
    if isinstance(shape, Ellipse):
        return shape.outline()
    if isinstance(shape, pymunk.Circle):
        assert shape.body is not None
        return rounded_outline([shape.body.position], shape.radius)
    return rounded_outline(*corners_of(shape))


def hull_of(ellipse: Ellipse) -> list[Vec2d]:
    """The polygon with round corners that pymunk sees in its broad phase, closed."""
    outline = rounded_outline(*corners_of(ellipse))
    return [*outline, outline[0]]


def rounded_outline(
    vertices: list[Vec2d], radius: float, steps: int = 12
) -> list[Vec2d]:
    """Points around a polygon, its vertices counterclockwise, that is widened by a radius."""
    if len(vertices) == 1:
        return [
            vertices[0] + Vec2d.from_polar(radius, 2 * pi * i / 64) for i in range(64)
        ]
    points = []
    for i, vertex in enumerate(vertices):
        before = vertex - vertices[i - 1]
        after = vertices[(i + 1) % len(vertices)] - vertex
        start = (-before.perpendicular()).angle
        turn = (before.get_angle_between(after)) % (2 * pi)
        for k in range(steps + 1):
            points.append(vertex + Vec2d.from_polar(radius, start + turn * k / steps))
    return points


if __name__ == "__main__":
    main(Inspector)
