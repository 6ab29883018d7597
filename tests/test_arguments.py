"""What is no number, no point or no image is refused by name; what is one, of whatever type or size, is taken rightly."""

import datetime
from decimal import Decimal
from fractions import Fraction
from math import inf, nan, sqrt

import numpy as np
import pymunk
import pytest
from pymunk import BB, ShapeFilter, Transform

from pymunk_ellipse import Ellipse, Space, circle_fit, moment_for_ellipse
from pymunk_ellipse.from_data import (
    ellipse_from_bb,
    ellipse_from_mask,
    ellipse_from_outline,
    ellipse_from_points,
)

NOT_NUMBERS = [
    None,
    "2",
    b"2",
    2 + 0j,
    np.complex128(2),
    np.complex64(2),
    np.datetime64("2020-01-01"),
    np.timedelta64(3, "D"),
    datetime.timedelta(3),
    np.ma.masked,
    np.ma.array(2.0),
    [2],
    {2},
]


@pytest.mark.parametrize("value", NOT_NUMBERS, ids=repr)
def test_what_is_no_number(value):
    with pytest.raises(TypeError, match=r"^a must be a number, got"):
        Ellipse(None, value, 1)
    with pytest.raises(TypeError, match=r"^angle must be a number, got"):
        Ellipse(None, 2, 1, angle=value)
    with pytest.raises(TypeError, match=r"^offset\[1\] must be a number, got"):
        Ellipse(None, 2, 1, (0, value))


@pytest.mark.parametrize(
    "value",
    [
        2,
        True * 2,
        Fraction(2),
        Decimal(2),
        np.float32(2),
        np.int8(2),
        np.array(2.0),
        np.array(2),
    ],
    ids=repr,
)
def test_what_is_a_number(value):
    assert Ellipse(None, value, 1).a == 2.0


@pytest.mark.parametrize(
    "value",
    [None, "12", b"12", {2, 1}, {2: 1, 1: 2}, np.ma.array([1.0, 2.0])],
    ids=repr,
)
def test_what_is_no_point(value):
    with pytest.raises(TypeError, match=r"^offset must be two numbers, got"):
        Ellipse(None, 2, 1, value)
    with pytest.raises(TypeError, match=r"^p must be two numbers, got"):
        Ellipse(None, 2, 1).point_query(value)


THREE = [(0, 0), (2, 0), (0, 2)]


@pytest.mark.parametrize(
    "value",
    [
        None,
        "points",
        {1, 2},
        [("1", "2"), ("3", "4"), ("5", "9")],
        np.array(THREE, dtype=complex),
        np.array([["2020-01-01"] * 2] * 3, dtype="datetime64[D]"),
        np.ma.array(THREE, mask=[[0, 0], [1, 1], [0, 0]]),
        np.array([(None, 1), (2, 3), (4, 9)]),
    ],
    ids=lambda value: type(value).__name__,
)
@pytest.mark.parametrize(
    ("function", "name"),
    [
        (ellipse_from_points, "points"),
        (ellipse_from_outline, "vertices"),
        (ellipse_from_mask, "mask"),
    ],
)
def test_what_is_no_array(function, name, value):
    with pytest.raises(TypeError, match=f"^{name} must be an array of numbers, got"):
        function(value)


def test_arrays_of_any_numbers():
    expected = ellipse_from_points(THREE)
    for numbers in (
        np.array(THREE, dtype=np.float32),
        np.array(THREE, dtype=np.uint8),
        np.array(THREE, dtype=object),
        [(Fraction(x), Decimal(y)) for x, y in THREE],
    ):
        assert ellipse_from_points(numbers) == expected


def assert_same(found, expected):
    assert (*found[:2], *found.offset, found.angle) == pytest.approx(
        (*expected[:2], *expected.offset, expected.angle)
    )


# An Ellipse has semi-axes of 1e-50 to 1e50.


@pytest.mark.parametrize("scale", [1e-49, 1e-20, 1e49])
def test_any_scale(scale):
    for function in (ellipse_from_points, ellipse_from_outline):
        a, b, offset, angle = function(THREE)
        large = function([(scale * x, scale * y) for x, y in THREE])
        assert large.a == pytest.approx(scale * a, rel=1e-12)
        assert large.b == pytest.approx(scale * b, rel=1e-12)
        assert tuple(large.offset) == pytest.approx(tuple(scale * offset), rel=1e-12)
        assert large.angle == pytest.approx(angle)


@pytest.mark.parametrize("scale", [1e-170, 1e160])
def test_what_gives_no_ellipse(scale):
    points = [(scale * x, scale * y) for x, y in THREE]
    for name, function in (
        ("points", ellipse_from_points),
        ("vertices", ellipse_from_outline),
    ):
        with pytest.raises(
            ValueError, match=f"^{name} must give .* a must lie between"
        ):
            function(points)


@pytest.mark.parametrize(
    ("bb", "problem"),
    [
        (BB(-1e308, 0, 1e308, 1), r"a must lie between 1e-50 and 1e\+50, got 1e\+308"),
        (BB(0, 0, 1e8, 1), "a and b must not differ"),
        (BB(1e20, 0, 1e20 + 1e5, 1e5), "offset must not be farther"),
    ],
)
def test_boxes_that_give_no_ellipse(bb, problem):
    with pytest.raises(ValueError, match=f"^bb must give an ellipse.* {problem}"):
        ellipse_from_bb(bb)


def test_weights_of_any_size():
    expected = ellipse_from_mask([[1, 1, 0], [1, 1, 1]])
    for weight in (1e308, 1e-300, 255):
        mask = weight * np.array([[1, 1, 0], [1, 1, 1]])
        assert_same(ellipse_from_mask(mask), expected)
    with pytest.raises(ValueError, match=r"^mask must not be negative, got -2"):
        ellipse_from_mask([[1, 1], [1, -2]])


def test_an_infinite_maximal_distance_of_any_type():
    space = Space()
    egg = Ellipse(space.static_body, 2, 1)
    space.add(egg)
    for limit in (inf, np.float32("inf"), np.float64("inf"), np.array(inf)):
        assert space.point_query_nearest((9, 0), limit, ShapeFilter()).shape is egg
    with pytest.raises(ValueError, match=r"^max_distance must be finite or infinite"):
        space.point_query_nearest((9, 0), nan, ShapeFilter())


@pytest.mark.parametrize(
    ("transform", "error", "problem"),
    [
        (None, TypeError, "transform must be a pymunk.Transform, got None"),
        ((1, 0, 0, 1, 0, 0), TypeError, "transform must be a pymunk.Transform"),
        (Transform(tx=nan), ValueError, "transform.tx must be finite, got nan"),
        (Transform(ty=inf), ValueError, "transform.ty must be finite, got inf"),
        (Transform(a=nan), ValueError, "transform must be a rotation"),
        (Transform.scaling(2), ValueError, "transform must be a rotation"),
    ],
)
def test_transforms_of_update(transform, error, problem):
    with pytest.raises(error, match=f"^{problem}"):
        Ellipse(None, 2, 1).update(transform)


def test_a_fit_of_ellipses_infinitely_far_apart():
    with pytest.raises(ValueError, match=r"^second must not be infinitely far"):
        circle_fit((1, 1, 1e308, 0), (1, 1, -1e308, 0))


def test_a_moment_that_is_not_finite():
    with pytest.raises(ValueError, match=r"^offset and mass must give a finite moment"):
        moment_for_ellipse(1, 1, 1, (1e200, 0))


# pygame


@pytest.fixture
def sprite():
    """An image with an ellipse of semi-axes 40 and 15, at an angle of 0.5 as seen on the screen, clockwise."""
    pygame = pytest.importorskip("pygame")
    surface = pygame.Surface((100, 80), pygame.SRCALPHA)
    for y in range(80):
        for x in range(100):
            u, v = x + 0.5 - 55, y + 0.5 - 38
            along = np.cos(0.5) * u + np.sin(0.5) * v
            across = np.cos(0.5) * v - np.sin(0.5) * u
            if (along / 40) ** 2 + (across / 15) ** 2 <= 1:
                surface.set_at((x, y), (200, 120, 40, 255))
    return surface


def test_a_pygame_mask(sprite):
    import pygame

    a, b, offset, angle = ellipse_from_mask(pygame.mask.from_surface(sprite))
    assert (a, b) == pytest.approx((40, 15), rel=5e-3)
    assert tuple(offset) == pytest.approx((55, 38), abs=0.1)
    assert angle == pytest.approx(0.5, abs=5e-3)


def test_the_alpha_of_a_pygame_surface(sprite):
    """surfarray counts columns first."""
    import pygame

    expected = ellipse_from_mask(pygame.mask.from_surface(sprite))
    found = ellipse_from_mask(pygame.surfarray.array_alpha(sprite).T)
    assert_same(found, expected)
    # y up, from the lower edge.
    up = ellipse_from_mask(pygame.surfarray.array_alpha(sprite).T[::-1])
    assert tuple(up.offset) == pytest.approx((55, 42), abs=0.1)
    assert up.angle == pytest.approx(-expected.angle)


def test_a_sprite_on_its_body(sprite):
    """The example of the documentation: the shape lies on the picture, whose middle is the body's position."""
    import pygame

    a, b, offset, angle = ellipse_from_mask(pygame.mask.from_surface(sprite))
    middle = pymunk.Vec2d(*sprite.get_size()) / 2
    egg = Ellipse(pymunk.Body(1, 1), a, b, offset - middle, angle)
    tip = pymunk.Vec2d(55, 38) + pymunk.Vec2d(40, 0).rotated(0.5) - middle
    assert egg.point_query(tip).distance == pytest.approx(0, abs=0.3)
    assert egg.area == pytest.approx(pygame.mask.from_surface(sprite).count(), rel=1e-2)
    assert sqrt(egg.a * egg.b) > 20
