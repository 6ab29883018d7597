"""The narrow phase against high-precision references, brute force, closed forms and its own mirror images."""

import json
from math import atan2, cos, hypot, inf, isfinite, pi, sin, sqrt
from pathlib import Path

import brute_force
import numpy as np
import pytest
from exactness import outline_errors, size_errors
from pairs import (
    Found,
    Placed,
    Round,
    contact,
    counted_evaluations,
    counterclockwise,
    frame,
    from_reference,
)

from pymunk_ellipse.narrowphase.ellipse_polygon import ellipse_segment

REFERENCES = json.loads((Path(__file__).parent / "contacts.json").read_text())["cases"]

KINDS = ("ellipse", "circle", "segment", "polygon")


def log_uniform(random, low, high, size=None):
    values = np.exp(random.uniform(np.log(low), np.log(high), size))
    return float(values) if size is None else values


def support_point(ellipse, nx, ny):
    """The point of an ellipse that is farthest along n."""
    a, b, x, y, angle = ellipse
    c, s = cos(angle), sin(angle)
    u, v = c * nx + s * ny, c * ny - s * nx
    h = hypot(a * u, b * v)
    return x + (c * a * a * u - s * b * b * v) / h, y + (
        s * a * a * u + c * b * b * v
    ) / h


def random_pair(random, kind, aspect, deepest=0.6, farthest=1.0):
    """An ellipse and a shape near it: deepest and farthest bound how far, in semi-minor axes, they overlap or gape along some normal."""
    ellipse = Placed(
        log_uniform(random, 1, aspect), 1.0, 0.0, 0.0, random.uniform(-pi, pi)
    )
    phi = random.uniform(-pi, pi)
    nx, ny = cos(phi), sin(phi)
    gap = random.uniform(-deepest, farthest)
    px, py = support_point(ellipse, nx, ny)
    if kind == "ellipse":
        b = log_uniform(random, 1, 3)
        other = Placed(
            b * log_uniform(random, 1, aspect), b, 0.0, 0.0, random.uniform(-pi, pi)
        )
        qx, qy = support_point(other, -nx, -ny)
        x, y = px + gap * nx - qx, py + gap * ny - qy
        return ellipse, other._replace(x=x, y=y)
    radius = (
        log_uniform(random, 0.1, 10)
        if kind == "circle"
        else float(random.choice([0, 0.3]))
    )
    gap += radius
    count = {"circle": 1, "segment": 2, "polygon": int(random.integers(3, 8))}[kind]
    size = log_uniform(random, 0.3, 30)
    corners = sorted(random.uniform(0, 2 * pi, count).tolist())
    vertices = [(size * cos(t), size * sin(t)) for t in corners]
    qx, qy = min(vertices, key=lambda v: v[0] * nx + v[1] * ny)
    moved = [(x - qx + px + gap * nx, y - qy + py + gap * ny) for x, y in vertices]
    return ellipse, Round(tuple(moved), radius)


def true_peaks(ellipse, other, count=1024):
    """Values and angles of all peaks of the separation, by brute force."""
    if isinstance(other, Placed):
        dx, dy = other.x - ellipse.x, other.y - ellipse.y
        shapes = (*ellipse[:2], ellipse.angle, *other[:2], other.angle, dx, dy)
        _rows, values, angles = brute_force.ellipse_peaks(np.array([shapes]), count)
    else:
        _rows, values, angles = brute_force.polygon_peaks(
            ellipse, other.vertices, other.radius, count
        )
    return values, angles


def transformed(shape, turn=0.0, dx=0.0, dy=0.0, scale=1.0, mirror=False):
    """A shape after a mirror image at the x axis, a scaling, a rotation and a translation."""
    c, s = cos(turn), sin(turn)

    def moved(x, y):
        y = -y if mirror else y
        x, y = scale * x, scale * y
        return c * x - s * y + dx, s * x + c * y + dy

    if isinstance(shape, Placed):
        a, b, x, y, angle = shape
        angle = turn - angle if mirror else turn + angle
        return Placed(scale * a, scale * b, *moved(x, y), angle)
    vertices = tuple(moved(*vertex) for vertex in shape.vertices)
    return Round(counterclockwise(vertices), scale * shape.radius)


def test_there_are_references_of_every_kind():
    assert [sum(c["kind"] == kind for c in REFERENCES) for kind in KINDS] == [100] * 4


@pytest.mark.parametrize("kind", KINDS)
def test_references(kind):
    for case in REFERENCES:
        if case["kind"] != kind:
            continue
        ellipse, other = from_reference(case)
        found = contact(ellipse, other)
        assert found.distance == pytest.approx(-case["depth"], abs=1e-13 * ellipse.a)
        nx, ny = case["normal"]
        assert hypot(found.nx - nx, found.ny - ny) < 1e-12


@pytest.mark.parametrize("kind", KINDS)
def test_brute_force(kind):
    """Aspect ratios to 50, apart and overlapping."""
    random = np.random.default_rng(KINDS.index(kind))
    for _ in range(300):
        ellipse, other = random_pair(random, kind, 50)
        found = contact(ellipse, other)
        values, angles = true_peaks(ellipse, other)
        best = values.max()
        assert found.distance == pytest.approx(best, abs=1e-8 * ellipse.b)
        assert hypot(found.nx, found.ny) == pytest.approx(1, abs=1e-14)
        # Two normals may be as good as each other.
        turned = np.angle(np.exp(1j * (angles - atan2(found.ny, found.nx))))
        assert np.abs(turned[values > best - 1e-8]).min() < 1e-5


@pytest.mark.parametrize("kind", KINDS)
def test_contact_points_lie_on_both_surfaces(kind):
    random = np.random.default_rng(10 + KINDS.index(kind))
    for _ in range(100):
        ellipse, other = random_pair(random, kind, 50)
        found = contact(ellipse, other)
        nx, ny = found.nx, found.ny
        assert support_point(ellipse, nx, ny) == pytest.approx(
            (found.x, found.y), abs=1e-11 * ellipse.a
        )
        x, y = found.x + found.distance * nx, found.y + found.distance * ny
        if isinstance(other, Placed):
            # A point is right to the normal's error times the radius of curvature.
            expected = support_point(other, -nx, -ny)
            radii = ellipse.a * ellipse.a + other.a * other.a / other.b
            assert expected == pytest.approx((x, y), abs=1e-12 * radii)
        else:
            center = (x + other.radius * nx, y + other.radius * ny)
            error = distance_to_outline(center, other.vertices)
            assert error < 1e-12 * ellipse.a * ellipse.a


def distance_to_outline(point, vertices):
    x, y = point
    nearest = inf
    for (x0, y0), (x1, y1) in zip(vertices, vertices[1:] + vertices[:1], strict=True):
        ex, ey = x1 - x0, y1 - y0
        squared = ex * ex + ey * ey or 1.0
        along = min(1.0, max(0.0, ((x - x0) * ex + (y - y0) * ey) / squared))
        nearest = min(nearest, hypot(x0 + along * ex - x, y0 + along * ey - y))
    return nearest


def overlapping_pairs(random, count, aspect):
    """Rows (a1, b1, angle1, a2, b2, angle2, dx, dy) of ellipses that overlap by up to the smaller semi-axis of the two along one normal."""
    a1 = log_uniform(random, 1, aspect, count)
    b2 = log_uniform(random, 1, 3, count)
    a2 = b2 * log_uniform(random, 1, aspect, count)
    angle1, angle2, phi = random.uniform(-pi, pi, (3, count))
    nx, ny = np.cos(phi), np.sin(phi)
    dx = -random.uniform(0, 1, count) * nx
    dy = dx * ny / nx
    for a, b, angle in ((a1, 1.0, angle1), (a2, b2, angle2)):
        c, s = np.cos(angle), np.sin(angle)
        u, v = c * nx + s * ny, c * ny - s * nx
        h = np.hypot(a * u, b * v)
        dx += (c * a * a * u - s * b * b * v) / h
        dy += (s * a * a * u + c * b * b * v) / h
    return np.column_stack([a1, np.ones(count), angle1, a2, b2, angle2, dx, dy])


def contacts_of_pairs(pairs):
    """The narrow phase's distance, normal and contact point of each pair, and the number of evaluations."""
    found = []
    with counted_evaluations() as count:
        for a1, b1, angle1, a2, b2, angle2, dx, dy in pairs.tolist():
            count[0] = 0
            first = Placed(a1, b1, 0, 0, angle1)
            found.append((*contact(first, Placed(a2, b2, dx, dy, angle2)), count[0]))
    return np.array(found)


def separation_along(pairs, nx, ny):
    a1, b1, angle1, a2, b2, angle2, dx, dy = pairs.T
    first = brute_force.support(a1, b1, angle1, nx, ny)
    second = brute_force.support(a2, b2, angle2, nx, ny)
    return dx * nx + dy * ny - first - second


def test_many_pairs_have_the_least_depth():
    """Aspect ratios to 10: never more than 1e-6 b deeper than the true minimum, which is a global maximum."""
    pairs = overlapping_pairs(np.random.default_rng(20), 50_000, 10)
    found = contacts_of_pairs(pairs)
    truth = brute_force.ellipse_separations(pairs)
    overlap = truth < 0
    assert overlap.mean() > 0.95
    assert truth[overlap].min() > -1
    assert np.all(truth - found[:, 0] <= 1e-6)
    assert np.all(found[:, 0] - truth <= 1e-8)
    assert found[:, 5].max() <= 100


def test_many_pairs_converge():
    """Aspect ratios to 1000: finite, stationary and the better of all peaks, in at most 100 evaluations."""
    pairs = overlapping_pairs(np.random.default_rng(21), 50_000, 1000)
    found = contacts_of_pairs(pairs)
    assert np.isfinite(found).all()
    assert found[:, 5].max() <= 100
    distance, nx, ny = found[:, :3].T
    assert np.allclose(np.hypot(nx, ny), 1, rtol=0, atol=1e-14)
    size = pairs[:, 0] + pairs[:, 3]
    assert np.all(np.abs(separation_along(pairs, nx, ny) - distance) <= 1e-14 * size)
    for turn in (-1e-5, -1e-7, 1e-7, 1e-5):
        turned = separation_along(pairs, nx - turn * ny, ny + turn * nx)
        assert np.all(turned <= distance + 1e-14 * size)


def test_thin_pairs_have_the_least_depth():
    pairs = overlapping_pairs(np.random.default_rng(22), 800, 1000)
    found = contacts_of_pairs(pairs)
    truth = brute_force.ellipse_separations(pairs, 3000, 200)
    assert np.all(np.abs(truth - found[:, 0]) <= 1e-6)


@pytest.mark.parametrize("aspect", [1.0, 1.001, 2.0, 10.0, 1e3, 1e6])
def test_coincident(aspect):
    found = contact(Placed(aspect, 1, 3, 4, 0.7), Placed(aspect, 1, 3, 4, 0.7))
    assert found.distance == pytest.approx(-2, abs=1e-6)
    if aspect > 1.5:
        assert abs(cos(0.7) * found.nx + sin(0.7) * found.ny) < 1e-3


@pytest.mark.parametrize("a2", [0.1, 1.0, 2.0, 50.0])
@pytest.mark.parametrize("a1", [1.0, 1.5, 10.0, 1e3])
def test_concentric_and_parallel(a1, a2):
    """The support functions are both least along the short axes."""
    found = contact(Placed(a1, 1, 0, 0, 1.2), Placed(a2, 0.1, 0, 0, 1.2))
    assert found.distance == pytest.approx(-1.1, abs=1e-6)


@pytest.mark.parametrize("a", [1.0, 1.1, 2.0, 10.0, 1e3, 1e6])
def test_concentric_and_crossed(a):
    """The depth is a + b: the published method sees no contact at a = 2."""
    found = contact(Placed(a, 1, 0, 0, 0.3), Placed(a, 1, 0, 0, 0.3 + pi / 2))
    assert found.distance == pytest.approx(-(a + 1), rel=1e-6)
    assert isfinite(found.nx)


def test_concentric_circles():
    found = contact(Placed(2, 2), Round(((0.0, 0.0),), 1.0))
    assert found.distance == pytest.approx(-3)
    assert hypot(found.nx, found.ny) == pytest.approx(1)


def test_point_in_the_centre():
    found = contact(Placed(5, 2, 0, 0, 0.4), Round(((0.0, 0.0),), 0.0))
    assert found.distance == pytest.approx(-2, abs=2e-6)


@pytest.mark.parametrize("aspect", [1.0, 2.0, 50.0, 1000.0])
def test_tangent(aspect):
    random = np.random.default_rng(5)
    for _ in range(50):
        first = Placed(aspect, 1, 0, 0, random.uniform(-pi, pi))
        second = Placed(aspect * 2, 2, 0, 0, random.uniform(-pi, pi))
        phi = random.uniform(-pi, pi)
        nx, ny = cos(phi), sin(phi)
        px, py = support_point(first, nx, ny)
        qx, qy = support_point(second, -nx, -ny)
        found = contact(first, second._replace(x=px - qx, y=py - qy))
        assert found.distance == pytest.approx(0, abs=1e-14 * aspect)
        assert hypot(found.nx - nx, found.ny - ny) < 1e-14 * aspect**2


@pytest.mark.parametrize("aspect", [10.0, 1e3, 1e5])
def test_needle_tips(aspect):
    """Tip to tip, less deep than the tips are round."""
    depth = 0.1 / aspect
    found = contact(Placed(aspect, 1), Placed(aspect, 1, 2 * aspect - depth, 0))
    assert found.distance == pytest.approx(-depth, abs=1e-14 * aspect)
    assert (found.nx, found.ny) == pytest.approx((1, 0), abs=1e-12)


@pytest.mark.parametrize("aspect", [10.0, 1e3, 1e5])
def test_needle_tip_in_a_flat_side(aspect):
    found = contact(Placed(aspect, 1), Placed(1, aspect, 0.0, aspect + 0.5))
    assert found.distance == pytest.approx(-0.5, abs=1e-13 * aspect)
    assert (found.nx, found.ny) == pytest.approx((0, 1), abs=1e-12)


@pytest.mark.parametrize("aspect", [10.0, 100.0, 1000.0])
def test_needle_on_a_corner(aspect):
    """A tip pressed on a corner of a square, point to point."""
    depth = 0.1 / aspect
    x = aspect - depth
    square = Round(((x, 0.0), (x + 1, -1.0), (x + 2, 0.0), (x + 1, 1.0)))
    found = contact(Placed(aspect, 1), square)
    assert found.distance == pytest.approx(-depth, abs=1e-14 * aspect)
    assert (found.nx, found.ny) == pytest.approx((1, 0), abs=1e-12)


def test_circle_inside_an_ellipse():
    found = contact(Placed(2, 1, 5, 5, pi / 2), Round(((4.5, 5.0),), 0.1))
    assert found.distance == pytest.approx(-0.6)
    assert (found.nx, found.ny) == pytest.approx((-1, 0), abs=1e-9)
    assert (found.x, found.y) == pytest.approx((-1, 0), abs=1e-9)


def test_ellipse_inside_a_box():
    box = Round(((-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0)))
    found = contact(Placed(2, 1, 0, -7.5), box)
    # Out through the floor.
    assert found.distance == pytest.approx(-2.5)
    assert (found.nx, found.ny) == pytest.approx((0, 1), abs=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_containment(kind):
    """One inside the other, either way, anywhere."""
    random = np.random.default_rng(30 + KINDS.index(kind))
    for _ in range(100):
        ellipse, other = random_pair(random, kind, 10, 0, 0)
        grown = transformed(other, scale=float(random.choice([0.05, 30])))
        values, _angles = true_peaks(ellipse, grown)
        found = contact(ellipse, grown)
        assert found.distance == pytest.approx(values.max(), abs=1e-6)


def test_segment_without_length_is_a_circle():
    random = np.random.default_rng(40)
    for _ in range(50):
        ellipse, other = random_pair(random, "circle", 20)
        twice = Round(other.vertices * 2, other.radius)
        assert contact(ellipse, twice) == pytest.approx(
            contact(ellipse, other), abs=1e-11
        )


def test_repeated_vertex_makes_no_difference():
    random = np.random.default_rng(41)
    for _ in range(50):
        ellipse, other = random_pair(random, "polygon", 20)
        repeated = Round((other.vertices[0], *other.vertices), other.radius)
        assert contact(ellipse, repeated)[:3] == pytest.approx(
            contact(ellipse, other)[:3], abs=1e-11
        )


def test_vertices_on_edges_make_no_difference():
    """See exactness.py for more of them."""
    errors, wrong = outline_errors(81, 1500)
    assert not wrong.any()
    assert errors.max() <= 1e-6


@pytest.mark.parametrize("far", [0.0, 1e4])
def test_any_number_of_vertices_on_an_edge(far):
    random = np.random.default_rng(82)
    for _ in range(60):
        angle = random.uniform(-pi, pi)
        along = np.array([cos(angle), sin(angle)])
        across = np.array([-along[1], along[0]])
        place = random.uniform(-1, 1, 2) * far
        count = int(random.integers(0, 60))
        parts = np.sort(np.concatenate([[0, 1, 1], random.uniform(0, 1, count)]))
        vertices = [place + 9 * part * along for part in parts]
        vertices += [place + 9 * along + 5 * across, place + 5 * across]
        # Below the first edge.
        ellipse = Placed(2, 1, 0, 0, random.uniform(-pi, pi))
        px, py = support_point(ellipse, *across)
        x, y = place + random.uniform(0.1, 8.9) * along - (px, py) + 0.2 * across
        square = Round(tuple(map(tuple, np.array(vertices).tolist())))
        found = contact(ellipse._replace(x=x, y=y), square)
        assert found.distance == pytest.approx(-0.2, abs=1e-11)
        assert (found.nx, found.ny) == pytest.approx(tuple(across), abs=1e-9)


def test_nearly_straight_corners():
    """A box with a slight peak in the middle of its top, which is pressed into it."""
    random = np.random.default_rng(83)
    for _ in range(400):
        width = log_uniform(random, 1, 1e4)
        peak = log_uniform(random, 1e-11, 1e-5) * width / 2
        height = random.uniform(0.5, 20)
        corners = ((-width, 0.0), (width, 0.0), (width, height))
        box = Round((*corners, (0.0, height + peak), (-width, height)))
        x, y = random.uniform(-0.2, 0.2) * width, height - random.uniform(-1.5, 2)
        ellipse = Placed(random.uniform(1, 3), 1, x, y, random.uniform(0, 6))
        found = contact(ellipse, box)
        normal = np.array([found.nx, found.ny])
        gap = brute_force.polygon_separation(ellipse, box.vertices, 0.0)(0, *normal)
        assert found.distance == pytest.approx(gap, abs=1e-15 * width + 1e-14)
        values, _angles = true_peaks(ellipse, box)
        assert found.distance == pytest.approx(values.max(), abs=5e-7)


def test_small_ellipse_on_a_large_one():
    """Size ratios of 100 to 1e6; see exactness.py for more of them."""
    assert size_errors(84, 2000).max() <= 1e-6


def test_tiny_radius():
    ellipse = Placed(3, 1)
    for radius in (0.0, 1e-300, 1e-20, 1e-9):
        found = contact(ellipse, Round(((0.0, 1.5),), radius))
        assert found.distance == pytest.approx(0.5 - radius, abs=1e-14)


def test_box_and_ellipse_of_equal_axes_are_a_circle():
    random = np.random.default_rng(42)
    for _ in range(100):
        ellipse, other = random_pair(random, "circle", 1)
        ((x, y),) = other.vertices
        distance = hypot(x, y)
        found = contact(ellipse, other)
        assert found.distance == pytest.approx(distance - 1 - other.radius, abs=1e-12)
        assert (found.nx, found.ny) == pytest.approx((x / distance, y / distance))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "change",
    [
        {"turn": 1.234},
        {"dx": 12.0, "dy": -34.0},
        {"mirror": True},
        {"scale": 1e-6},
        {"scale": 1e6},
        {"turn": -2.0, "dx": 5.0, "mirror": True, "scale": 1e3},
    ],
    ids=str,
)
def test_invariance(kind, change):
    random = np.random.default_rng(50 + KINDS.index(kind))
    scale = change.get("scale", 1.0)
    direction = {key: change.get(key, 0.0) for key in ("turn", "mirror")}
    for _ in range(60):
        ellipse, other = random_pair(random, kind, 20, deepest=0.3)
        found = contact(ellipse, other)
        moved = contact(transformed(ellipse, **change), transformed(other, **change))
        assert moved.distance / scale == pytest.approx(found.distance, abs=1e-12 * 50)
        ((nx, ny),) = transformed(Round(((found.nx, found.ny),)), **direction).vertices
        assert (moved.nx, moved.ny) == pytest.approx((nx, ny), abs=1e-10)
        ((px, py),) = transformed(
            Round(((found.x, found.y),)), **direction, scale=scale
        ).vertices
        # The point moves by the normal's error times the radius of curvature.
        assert (moved.x, moved.y) == pytest.approx((px, py), abs=1e-9 * scale)


def test_swapping_two_ellipses():
    random = np.random.default_rng(60)
    for _ in range(300):
        ellipse, other = random_pair(random, "ellipse", 20)
        found, swapped = contact(ellipse, other), contact(other, ellipse)
        assert swapped.distance == pytest.approx(found.distance, abs=1e-12 * 50)
        assert (swapped.nx, swapped.ny) == pytest.approx(
            (-found.nx, -found.ny), abs=1e-10
        )


def test_circle_is_an_ellipse_with_equal_axes():
    random = np.random.default_rng(61)
    for _ in range(100):
        ellipse, other = random_pair(random, "circle", 20)
        ((x, y),) = other.vertices
        same = Placed(other.radius, other.radius, x, y, 1.0)
        assert contact(ellipse, same) == pytest.approx(
            contact(ellipse, other), abs=1e-11
        )


def test_longer_axis_may_be_either():
    random = np.random.default_rng(62)
    for _ in range(50):
        (a, b, x, y, angle), other = random_pair(random, "ellipse", 20)
        turned = Placed(b, a, x, y, angle - pi / 2)
        assert contact(turned, other)[:3] == pytest.approx(
            contact(Placed(a, b, x, y, angle), other)[:3], abs=1e-11
        )


def test_any_start_finds_the_same_contact():
    """Where the climb starts decides how long it takes, not what it finds."""
    random = np.random.default_rng(63)
    for _ in range(300):
        ellipse, other = random_pair(random, "ellipse", 50, deepest=1.0)
        found = contact(ellipse, other)
        phi = random.uniform(-pi, pi)
        again = contact(ellipse, other, start=(cos(phi), sin(phi)))
        assert again.distance == pytest.approx(found.distance, abs=1e-6)


def test_right_start_is_quick():
    random = np.random.default_rng(64)
    for _ in range(100):
        ellipse, other = random_pair(random, "ellipse", 10, deepest=0.05, farthest=0.0)
        found = contact(ellipse, other)
        with counted_evaluations() as count:
            again = contact(ellipse, other, start=(found.nx, found.ny))
        if again.distance > -ellipse.b / ellipse.a * ellipse.b:
            assert count[0] <= 4


def test_longest_and_shortest_semi_axes():
    for a in (1e-44, 1e50):
        thin = Placed(a, a / 1e6)
        for other in (
            thin._replace(x=thin.a * 1.9),
            Round(((thin.a, 0.0),), thin.b),
            Round(((-thin.a, 0.0), (thin.a, 0.0)), thin.b),
            Round(((thin.a, 0.0), (thin.a * 2, 0.0), (0.0, thin.a)), 0.0),
        ):
            found = contact(thin, other)
            assert all(isfinite(number) for number in found)
            assert hypot(found.nx, found.ny) == pytest.approx(1)
            assert found.distance <= 0


@pytest.mark.parametrize("far", [1e9, 1e100, 1e200, 1e300])
@pytest.mark.parametrize("a", [1e-44, 1.0, 1e50])
def test_farthest_apart(a, far):
    if far < a:
        return
    ellipse, end = Placed(a, a / 3, 0, 0, 0.9), far * 1.5
    for other in (
        Placed(2 * a, a, far, far / 3, 0.6),
        Round(((far, far / 3),), a),
        Round(((far, far / 3), (end, far)), a),
        Round(((far, far / 3), (end, far), (far, end)), a),
    ):
        found = contact(ellipse, other)
        assert all(isfinite(number) for number in found)
        assert found.distance == pytest.approx(hypot(far, far / 3), rel=1e-8)


def chained(ellipse, before=(0.0, 0.0), after=(0.0, 0.0), radius=0.0):
    """The contact with a segment from (-1, 0) to (1, 0) that has neighbours."""
    ends = (-1.0, 0.0), (1.0, 0.0)
    return Found(*ellipse_segment(frame(ellipse), *ends, before, after, radius))


def test_segment_ends_without_neighbours_are_touched():
    found = chained(Placed(1, 0.5, 1.9, 0.0))
    assert found.distance == pytest.approx(-0.1)
    assert (found.nx, found.ny) == pytest.approx((-1, 0), abs=1e-9)


def test_segment_neighbour_takes_over_past_the_end():
    """Over the next segment of a straight floor the contact is that with the floor."""
    found = chained(Placed(2, 0.5, 1.5, 0.45), after=(2.0, 0.0))
    assert found.distance == pytest.approx(-0.05)
    assert (found.nx, found.ny) == pytest.approx((0, -1), abs=1e-9)
    assert found.x == pytest.approx(0, abs=1e-9)
    before = chained(Placed(2, 0.5, -1.5, 0.45), before=(-2.0, 0.0))
    assert before[:3] == pytest.approx(found[:3])


def test_dense_chain_is_one_floor():
    """Far over a neighbour the contact is that with the neighbour's line, whichever segment was chosen."""
    for x in (1.3, 1.9, 2.05, 2.4, 2.9):
        ellipse = Placed(1, 0.5, x, 0.45)
        for after in ((0.1, 0.0), (0.02, 0.0), (7.0, 0.0)):
            found = chained(ellipse, after=after)
            assert found.distance == pytest.approx(-0.05)
            assert (found.nx, found.ny) == pytest.approx((0, -1), abs=1e-9)
        mirrored = chained(ellipse._replace(x=-x), before=(-0.1, 0.0))
        assert mirrored.distance == pytest.approx(-0.05)


def test_neighbour_that_rises_leaves_the_segment_its_own_line():
    """Pressed into a valley, each of the two segments gives the contact with its own face."""
    ellipse = Placed(0.5, 0.5, 1.2, 0.3)
    found = chained(ellipse, after=(2.0, 2.0))
    assert found.distance == pytest.approx(-0.2)
    assert (found.nx, found.ny) == pytest.approx((0, -1), abs=1e-9)


def test_joint_of_a_straight_chain_is_not_lost():
    """Where the ellipse stands on a joint, up to roundoff, neither segment leaves it to the other."""
    random = np.random.default_rng(80)
    for _ in range(200):
        angle, length = random.uniform(-pi, pi), random.uniform(0.02, 2)
        ex, ey = length * cos(angle), length * sin(angle)
        x, y = random.uniform(-1e3, 1e3, 2)
        nx, ny = ey / length, -ex / length
        ellipse = Placed(2, 0.5, 0, 0, random.uniform(-pi, pi))
        px, py = support_point(ellipse, nx, ny)
        at = frame(ellipse._replace(x=x - px + 0.1 * nx, y=y - py + 0.1 * ny))
        for start, before, after in (
            ((x, y), (-ex, -ey), (ex, ey)),
            ((x - ex, y - ey), (0.0, 0.0), (ex, ey)),
        ):
            end = start[0] + ex, start[1] + ey
            found = Found(*ellipse_segment(at, start, end, before, after, 0.0))
            assert found.distance == pytest.approx(-0.1, abs=1e-9)
            assert (found.nx, found.ny) == pytest.approx((nx, ny), abs=1e-6)


def test_neighbour_that_leads_away_is_touched_by_its_face():
    # The neighbour's normal, away from the ellipse's centre.
    length = hypot(0.2, 3.0)
    found = chained(Placed(1, 0.5, 1.9, 0.0), after=(0.2, -3.0))
    assert (found.nx, found.ny) == pytest.approx((-3.0 / length, -0.2 / length))


def test_convex_corner_of_a_chain_is_touched():
    """A corner that sticks out is met by its own vertex."""
    ellipse = Placed(0.5, 0.5, 1.0 + 0.3 * sqrt(0.5), 0.3 * sqrt(0.5))
    found = chained(ellipse, after=(0.0, -2.0))
    assert found.distance == pytest.approx(-0.2)
    assert (found.nx, found.ny) == pytest.approx((-sqrt(0.5), -sqrt(0.5)), abs=1e-7)
