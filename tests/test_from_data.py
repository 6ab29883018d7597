"""Ellipses built from points, outlines, masks and boxes: those of an ellipse give that ellipse back."""

from __future__ import annotations

import random
from math import cos, hypot, inf, nan, pi, sin

import numpy as np
import pymunk
import pytest

from pymunk_ellipse import Ellipse
from pymunk_ellipse.from_data import (
    ellipse_from_bb,
    ellipse_from_mask,
    ellipse_from_outline,
    ellipse_from_points,
)

ELLIPSES = [
    (2.0, 1.0, (0.0, 0.0), 0.0),
    (2.0, 1.0, (3.0, -4.0), 0.7),
    (20.0, 1.0, (-300.0, 40.0), -1.2),
    (1e-6, 5e-7, (2e-6, 0.0), 1.5),
    (7.0, 5.0, (1e3, 1e3), pi / 2.0),
]


def rim(a, b, offset, angle, count, scale=1.0):
    """Points evenly spaced in parameter on an ellipse."""
    c, s = cos(angle), sin(angle)
    t = 2.0 * pi * (np.arange(count) + 0.5) / count
    u, v = scale * a * np.cos(t), scale * b * np.sin(t)
    return np.column_stack((offset[0] + c * u - s * v, offset[1] + s * u + c * v))


def check(found, a, b, offset, angle, rel):
    assert found.a == pytest.approx(a, rel=rel)
    assert found.b == pytest.approx(b, rel=rel)
    assert hypot(*(found.offset - pymunk.Vec2d(*offset))) <= rel * hypot(a, *offset)
    # An axis has no sense: angles half a turn apart are the same.
    assert abs(sin(found.angle - angle)) <= 10.0 * rel
    assert abs(found.angle) <= pi / 2.0


@pytest.mark.parametrize(("a", "b", "offset", "angle"), ELLIPSES)
def test_points_spread_over_an_ellipse_give_it_back(a, b, offset, angle):
    # Rings whose squared radii are evenly spaced fill a disc evenly; their mean is 1/2 exactly.
    rings = 50
    points = np.vstack(
        [rim(a, b, offset, angle, 64, ((i + 0.5) / rings) ** 0.5) for i in range(rings)]
    )
    check(ellipse_from_points(points), a, b, offset, angle, 1e-9)


@pytest.mark.parametrize(("a", "b", "offset", "angle"), ELLIPSES)
@pytest.mark.parametrize("direction", [1, -1])
def test_fine_outline_of_an_ellipse_gives_it_back(a, b, offset, angle, direction):
    # A regular n-gon's moments about an axis differ from the circle's by the order of 1/n^2.
    count = 4000
    outline = rim(a, b, offset, angle, count)[::direction]
    check(ellipse_from_outline(outline), a, b, offset, angle, 1e-5)


def test_outline_of_a_polygon_has_its_moments():
    rng = random.Random(1)
    for _ in range(50):
        corners = sorted(rng.uniform(-pi, pi) for _ in range(7))
        polygon = [(9.0 * cos(t) + 3.0, 4.0 * sin(t) - 1.0) for t in corners]
        found = ellipse_from_outline(polygon)
        body = pymunk.Body()
        shape = pymunk.Poly(body, polygon)
        shape.mass = 1.0
        assert tuple(found.offset) == pytest.approx(
            tuple(shape.center_of_gravity), rel=1e-9
        )
        # pymunk's is about the centre of gravity.
        assert (found.a**2 + found.b**2) / 4.0 == pytest.approx(shape.moment, rel=1e-9)


def test_vertices_of_an_ellipses_hull_lie_along_it():
    ellipse = Ellipse(None, 20, 10, (3, 4), 0.5)
    found = ellipse_from_outline(ellipse.get_vertices())
    assert tuple(found.offset) == pytest.approx((3.0, 4.0))
    assert found.angle == pytest.approx(0.5)


@pytest.mark.parametrize("angle", [0.0, 0.3, -1.0, pi / 2.0])
def test_mask_of_an_ellipse_gives_it_back(angle):
    a, b, x, y = 60.0, 25.0, 80.3, 71.8
    columns, rows = np.meshgrid(np.arange(160) + 0.5, np.arange(140) + 0.5)
    u = cos(angle) * (columns - x) + sin(angle) * (rows - y)
    v = -sin(angle) * (columns - x) + cos(angle) * (rows - y)
    mask = (u / a) ** 2 + (v / b) ** 2 <= 1.0
    # As right as the edge of a picture of that size is.
    check(ellipse_from_mask(mask), a, b, (x, y), angle, 2e-3)


def test_mask_of_one_pixel_has_the_moments_of_a_square():
    a, b, offset, angle = ellipse_from_mask([[0, 0], [0, 255]])
    assert a == b == pytest.approx(2.0 / 12.0**0.5)
    assert offset == (1.5, 1.5)
    assert angle == 0.0


def test_mask_is_weighted():
    light = ellipse_from_mask([[1.0, 1.0, 2.0]])
    assert light.offset.x == pytest.approx(0.25 * 0.5 + 0.25 * 1.5 + 0.5 * 2.5)


def test_mask_may_be_turned_upside_down():
    mask = np.tri(5)
    down, up = ellipse_from_mask(mask), ellipse_from_mask(mask[::-1])
    assert up.angle == pytest.approx(-down.angle)
    assert up.offset.y == pytest.approx(5.0 - down.offset.y)


def test_bounding_box_of_an_ellipse_gives_it_back():
    ellipse = Ellipse(None, *ellipse_from_bb(pymunk.BB(-3, 1, 5, 4)))
    assert (ellipse.a, ellipse.b, ellipse.offset) == (4.0, 1.5, (1.0, 2.5))


def test_parameters_are_the_arguments_of_an_ellipse():
    parameters = ellipse_from_outline([(0, 0), (6, 0), (6, 2), (0, 2)])
    ellipse = Ellipse(pymunk.Body(), *parameters)
    assert ellipse.offset == (3.0, 1.0)
    assert ellipse.a == pytest.approx(3.0 * ellipse.b)
    ellipse.mass = 1.0
    # A rectangle's moment about its centre.
    about_center = (ellipse.a**2 + ellipse.b**2) / 4.0
    assert about_center == pytest.approx((36.0 + 4.0) / 12.0)


@pytest.mark.parametrize("make", [ellipse_from_points, ellipse_from_outline])
@pytest.mark.parametrize(
    ("value", "error", "message"),
    [
        ([(0, 0), (1, 1)], ValueError, "three or more, got 2"),
        ([(0, 0), (1, 1), (2, 2)], ValueError, "must (not lie on a line|enclose)"),
        ([(0, 0), (0, 0), (0, 0)], ValueError, "must (not lie on a line|enclose)"),
        ([(0, 0), (1, nan), (2, 2)], ValueError, "finite, got nan"),
        ([(0, 0), (1, inf), (2, 2)], ValueError, "finite, got inf"),
        ([0, 1, 2], ValueError, r"rows of x and y, got shape \(3,\)"),
        ([(0, 0, 0)] * 4, ValueError, r"rows of x and y, got shape \(4, 3\)"),
        ("egg", TypeError, "array of numbers, got 'egg'"),
        ([(0, 0), (1, "x"), (1, 2)], TypeError, "array of numbers"),
        (None, (TypeError, ValueError), "points|vertices"),
    ],
)
def test_refuses_what_is_no_points(make, value, error, message):
    with pytest.raises(error, match=message) as raised:
        make(value)
    assert str(raised.value).startswith(("points", "vertices"))


@pytest.mark.parametrize(
    ("value", "error", "message"),
    [
        ([0, 1], ValueError, "two dimensions, got 1"),
        ([[0, 0], [0, 0]], ValueError, "not zero"),
        ([[]], ValueError, "not zero"),
        ([[1, -2]], ValueError, "negative, got -2.0"),
        ([[1, nan]], ValueError, "finite, got nan"),
        ([["x"]], TypeError, "array of numbers"),
    ],
)
def test_refuses_what_is_no_mask(value, error, message):
    with pytest.raises(error, match=f"^mask .*{message}"):
        ellipse_from_mask(value)


@pytest.mark.parametrize(
    ("value", "error"),
    [
        (pymunk.BB(0, 0, 0, 1), ValueError),
        (pymunk.BB(0, 2, 1, 1), ValueError),
        (pymunk.BB(0, 0, inf, 1), ValueError),
        (None, TypeError),
    ],
)
def test_refuses_what_is_no_box(value, error):
    with pytest.raises(error, match=r"^bb"):
        ellipse_from_bb(value)
