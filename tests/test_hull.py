"""The hull contains its ellipse, weighs what the ellipse weighs, and touches whatever the ellipse touches."""

from math import cos, pi, sin

import numpy as np
import pymunk
import pytest
from test_narrowphase import KINDS, random_pair

from pymunk_ellipse import Ellipse
from pymunk_ellipse.chipmunk.private import c_points
from pymunk_ellipse.hull import ROUNDING, VERTICES, stretch, unit_polygon

DIRECTIONS = np.linspace(0, 2 * pi, 5000, endpoint=False)


def rounded_hull(a, b, angle, x, y, count=VERTICES, rounding=ROUNDING):
    """Vertices and radius of the hull of an ellipse with a at this angle and its centre at (x, y)."""
    shape = Ellipse(None, a, b, (x, y), angle)
    (m, n, p, q, tx, ty), radius = stretch(shape._frame, rounding)
    vertices = [
        (m * u + p * v + tx, n * u + q * v + ty) for u, v in unit_polygon(count)
    ]
    return vertices, radius


def test_is_the_polygon_that_pymunk_has():
    shape = Ellipse(None, 3, 1, (4, 5), 0.7)
    vertices, radius = rounded_hull(3, 1, 0.7, 4, 5)
    assert shape.radius == radius
    found = sorted(map(tuple, shape.get_vertices()))
    for vertex, expected in zip(found, sorted(vertices), strict=True):
        assert vertex == pytest.approx(expected)


@pytest.mark.parametrize("rounding", [0.0, 0.05, 0.5, 0.99])
@pytest.mark.parametrize("aspect", [1.0, 3.0, 100.0])
def test_any_rounding_contains_the_ellipse(aspect, rounding):
    vertices, radius = rounded_hull(aspect, 1.0, 0.0, 0.0, 0.0, 8, rounding)
    assert radius == pytest.approx(rounding, abs=1e-6)
    u, v = np.cos(DIRECTIONS), aspect * np.sin(DIRECTIONS)
    cosine, sine = u / np.hypot(u, v), v / np.hypot(u, v)
    ellipse = np.hypot(aspect * cosine, sine)
    assert np.all(supports(vertices, radius, cosine, sine) >= ellipse)


def supports(vertices, radius, cosine, sine):
    corners = np.asarray(vertices)
    return np.max(corners @ np.array([cosine, sine]), axis=0) + radius


@pytest.mark.parametrize("count", [4, 5, 6, 7, 8, 9, 12, 16, 32])
@pytest.mark.parametrize("aspect", [1.0, 1.5, 3.0, 10.0, 100.0, 1e4])
def test_contains_the_ellipse(aspect, count):
    for a, b in ((aspect, 1.0), (1.0, aspect), (1e-3 * aspect, 1e-3)):
        vertices, radius = rounded_hull(a, b, 0.0, 0.0, 0.0, count)
        assert len(vertices) == count
        assert radius > 0
        # Directions evenly spaced, and the normals at points evenly spaced on the ellipse.
        for u, v in (
            (np.cos(DIRECTIONS), np.sin(DIRECTIONS)),
            (b * np.cos(DIRECTIONS), a * np.sin(DIRECTIONS)),
        ):
            length = np.hypot(u, v)
            cosine, sine = u / length, v / length
            ellipse = np.hypot(a * cosine, b * sine)
            assert np.all(supports(vertices, radius, cosine, sine) >= ellipse)


@pytest.mark.parametrize("count", [8, 12, 16])
@pytest.mark.parametrize("aspect", [1.0, 2.0, 5.0])
def test_is_not_much_larger(aspect, count):
    vertices, radius = rounded_hull(aspect, 1.0, 0.0, 0.0, 0.0, count)
    cosine, sine = np.cos(DIRECTIONS), np.sin(DIRECTIONS)
    ellipse = np.hypot(aspect * cosine, sine)
    excess = supports(vertices, radius, cosine, sine) - ellipse
    assert excess.max() < 0.3 * aspect * (8 / count) ** 2


def test_position_and_angle():
    angle, x, y = 0.7, 3.0, -4.0
    vertices, radius = rounded_hull(3.0, 1.0, 0.0, 0.0, 0.0)
    placed, same = rounded_hull(3.0, 1.0, angle, x, y)
    assert same == pytest.approx(radius)
    for (u, v), found in zip(vertices, placed, strict=True):
        turned = (
            cos(angle) * u - sin(angle) * v + x,
            sin(angle) * u + cos(angle) * v + y,
        )
        assert found == pytest.approx(turned)


@pytest.mark.parametrize("aspect", [1.0, 2.0, 50.0])
def test_mass_properties_are_those_of_the_ellipse(aspect):
    """Before and after it takes another shape, in a body that weighs what its shapes do."""
    body = pymunk.Body()
    space = pymunk.Space()
    shape = Ellipse(body, 1, 1, (3, 4))
    shape.mass = 2
    space.add(body, shape)
    shape.unsafe_set_semi_axes(aspect, 1)
    assert body.moment == pytest.approx(2 * (aspect**2 + 1) / 4, rel=1e-12)
    assert tuple(body.center_of_gravity) == (3, 4)
    assert shape.area == pytest.approx(pi * aspect, rel=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_hull_touches_whatever_the_ellipse_touches(kind):
    """pymunk's own narrow phase on the hull must report every pair that overlaps, or its contact would be missed."""
    random = np.random.default_rng(80 + KINDS.index(kind))
    body = pymunk.Body()
    overlaps = 0
    for _ in range(1500):
        ellipse, other = random_pair(random, kind, 50, deepest=0.5, farthest=0.0)
        shape = shape_of(body, ellipse)
        if kind == "ellipse":
            second = shape_of(body, other)
        elif kind == "circle":
            second = pymunk.Circle(body, other.radius, other.vertices[0])
        elif kind == "segment":
            second = pymunk.Segment(body, *other.vertices, other.radius)
        else:
            second = pymunk.Poly(body, other.vertices, radius=other.radius)
        if not shape.shapes_collide(second).points:
            continue
        overlaps += 1
        assert hulls_touch(shape, second)
    assert overlaps > 1000


def shape_of(body, placed):
    a, b, x, y, angle = placed
    return Ellipse(body, a, b, (x, y), angle)


def hulls_touch(first, second):
    """Whether Chipmunk finds a contact: an arbiter, in a space where pre_solve reports the pair."""
    space = pymunk.Space()
    seen = []
    space.on_collision(
        pre_solve=lambda arbiter, space, data: seen.append(arbiter.shapes)
    )
    bodies = []
    for shape in (first, second):
        body = pymunk.Body(1, 1)
        bodies.append(body)
        shape.body = body
    space.add(*bodies, first, second)
    space.step(1e-9)
    space.remove(*space.bodies, *space.shapes)
    return bool(seen)


def test_touch_test_notices_a_small_hull(monkeypatch):
    """The test above would fail if the hull did not contain the ellipse."""

    small = c_points([(0.8 * x, 0.8 * y) for x, y in unit_polygon(VERTICES)])
    monkeypatch.setattr(Ellipse, "_unit_polygon", small)
    monkeypatch.setattr(Ellipse, "_rounding", 0.0)
    first = Ellipse(None, 2, 1)
    second = Ellipse(None, 2, 1, offset=(3.9, 0))
    first.body = second.body = pymunk.Body(1, 1)
    assert first.shapes_collide(second).points
    assert not hulls_touch(first, second)
