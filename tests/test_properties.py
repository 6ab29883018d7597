"""Properties that hold for every input: random ones at every scale, needles, far from the origin, and any finite numbers at all."""

import re
from math import atan2, cos, hypot, inf, isfinite, nan, pi, sin

import pymunk
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from pairs import Found, Placed, Round, contact, counterclockwise
from perram_wertheim import contact_function, polygon_function

import pymunk_ellipse
from pymunk_ellipse import (
    Ellipse,
    area_for_ellipse,
    circle_fit,
    moment_for_ellipse,
)

many = settings(
    max_examples=400,
    derandomize=True,
    deadline=None,
    database=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
)

# Roundoff of a distance, as a part of the lengths that enter it.
ROUNDOFF = 1e-13

# No normal is off by more (radians).
NORMAL_ERROR = 1e-10

ALL = pymunk.ShapeFilter()
POINT = Placed(1e-20, 1e-20)


def powers_of_ten(low, high):
    return st.floats(low, high).map(lambda exponent: 10.0**exponent)


scales = powers_of_ten(-6, 6)
aspects = st.one_of(st.just(1.0), powers_of_ten(0, 1), powers_of_ten(0, 6))
angles = st.one_of(
    st.floats(-2 * pi, 2 * pi),
    st.integers(-4, 4).map(lambda quarter: quarter * pi / 2),
)
finite = st.floats(allow_nan=False, allow_infinity=False)
anything = st.one_of(finite, st.floats(-10, 10), st.sampled_from([0.0, 1.0, -1.0]))
bad_values = st.sampled_from([nan, inf, -inf, None, "1", [], (1, 2, 3), {}, 1j])


@st.composite
def axes(draw, scale):
    """The semi-axes of an ellipse of about this size, any of them the longer."""
    longer = scale * 10.0 ** draw(st.floats(-2, 2))
    pair = longer, longer / draw(aspects)
    return pair if draw(st.booleans()) else pair[::-1]


@st.composite
def pairs_of_ellipses(draw, scales=scales):
    """Two ellipses near each other, the first at the origin; often they just touch along some direction."""
    scale = draw(scales)
    first = Placed(*draw(axes(scale)), 0.0, 0.0, draw(angles))
    second = Placed(*draw(axes(scale)), 0.0, 0.0, draw(angles))
    phi = draw(angles)
    nx, ny = cos(phi), sin(phi)
    if draw(st.booleans()):
        reach = max(first[:2]) + max(second[:2])
        x, y = draw(st.floats(0, 2)) * reach * nx, draw(st.floats(0, 2)) * reach * ny
    else:
        gap = draw(st.floats(-1, 1)) * min(*first[:2], *second[:2])
        px, py = support_point(first, nx, ny)
        qx, qy = support_point(second, nx, ny)
        x, y = px + qx + gap * nx, py + qy + gap * ny
    return first, second._replace(x=x, y=y)


@st.composite
def polygons(draw, scale):
    """Counterclockwise vertices of a convex polygon or of a segment near the origin."""
    size = scale * 10.0 ** draw(st.floats(-2, 2))
    flat = 10.0 ** -draw(st.floats(0, 3))
    x, y = draw(st.floats(-2, 2)) * scale, draw(st.floats(-2, 2)) * scale
    count = draw(st.integers(2, 7))
    start, turn = draw(angles), draw(angles)
    c, s = cos(turn), sin(turn)
    corners = []
    for i in range(count):
        u = size * cos(start + 2 * pi * i / count)
        v = size * flat * sin(start + 2 * pi * i / count)
        corners.append((x + c * u - s * v, y + s * u + c * v))
    return counterclockwise(tuple(corners))


def support_point(ellipse, nx, ny):
    """The farthest point of an ellipse along n, from its centre."""
    a, b, _x, _y, angle = ellipse
    c, s = cos(angle), sin(angle)
    u, v = a * (c * nx + s * ny), b * (c * ny - s * nx)
    h = hypot(u, v)
    u, v = a * u / h, b * v / h
    return c * u - s * v, s * u + c * v


def separation(first, second, nx, ny):
    """The gap between the two along n."""
    px, py = support_point(first, nx, ny)
    qx, qy = support_point(second, nx, ny)
    dx, dy = second.x - first.x, second.y - first.y
    return dx * nx + dy * ny - (px + qx) * nx - (py + qy) * ny


def off_surface(ellipse, x, y):
    """About how far a point near the surface of an ellipse is from it."""
    a, b, center_x, center_y, angle = ellipse
    c, s = cos(angle), sin(angle)
    dx, dy = x - center_x, y - center_y
    u, v = (c * dx + s * dy) / a, (c * dy - s * dx) / b
    excess = u * u + v * v - 1
    slope = 2 * hypot(u / a, v / b)
    near = abs(excess) / slope if slope else inf
    # The first order is far off inside thin ones, where no point is deeper than that.
    return min(near, a, b) if excess < 0 else near


def extent(*ellipses):
    """A length that every one which enters a contact is smaller than."""
    return sum(e.a + e.b + hypot(e.x, e.y) for e in ellipses)


def radius_of_curvature(ellipse, nx, ny):
    """The largest one where an ellipse's normal is within twice that error of n."""
    a, b, _x, _y, angle = ellipse
    phi = atan2(ny, nx) - angle
    turns = [phi + step * NORMAL_ERROR / 4 for step in range(-8, 9)]
    return max((a * b) ** 2 / hypot(a * cos(t), b * sin(t)) ** 3 for t in turns)


def fit_errors(first, second, found):
    """How far the distance may be from its maximum, and the second point from its surface, where the next turn is the last one."""
    radius = radius_of_curvature(second, -found.nx, -found.ny)
    between = radius_of_curvature(first, found.nx, found.ny) + radius
    aside = NORMAL_ERROR * (between + abs(found.distance))
    sharpest = min(second[:2]) ** 2 / max(second[:2])
    return aside * NORMAL_ERROR, min(aside, aside * aside / sharpest)


def check_sign(distance, square, tolerance):
    """A distance against the square of the growth that makes two shapes touch."""
    if abs(distance) > tolerance:
        assert (distance > 0) == (square > 1)


@many
@given(pairs_of_ellipses())
def test_ellipses(pair):
    first, second = pair
    found = contact(first, second)
    tolerance = ROUNDOFF * extent(first, second)
    depth_error, point_error = fit_errors(first, second, found)
    assert all(map(isfinite, found))
    assert hypot(found.nx, found.ny) == pytest.approx(1, abs=1e-14)
    square = contact_function(first, second)
    check_sign(found.distance, square, tolerance + depth_error)
    # No depth is smaller than that along the normal, and no distance larger.
    along = separation(first, second, found.nx, found.ny)
    assert found.distance == pytest.approx(along, abs=tolerance)
    assert off_surface(first, found.x, found.y) <= tolerance
    x = found.x + found.distance * found.nx
    y = found.y + found.distance * found.ny
    assert off_surface(second, x, y) <= tolerance + point_error


@many
@given(pairs_of_ellipses())
def test_ellipses_swapped(pair):
    first, second = pair
    found, swapped = contact(first, second), contact(second, first)
    tolerance = ROUNDOFF * extent(first, second)
    # Two different normals may be as good; the package promises the depth to 5e-7 of the smaller b.
    tolerance += 1e-6 * min(first[:2] + second[:2]) * (found.distance < 0)
    tolerance += fit_errors(first, second, found)[0]
    tolerance += fit_errors(second, first, swapped)[0]
    assert found.distance == pytest.approx(swapped.distance, abs=tolerance)
    along = separation(first, second, -swapped.nx, -swapped.ny)
    assert along == pytest.approx(found.distance, abs=tolerance)


@many
@given(pairs_of_ellipses(), angles, powers_of_ten(-60, 60))
def test_any_start(pair, phi, length):
    first, second = pair
    # See the next test for thinner ones.
    assume(all(max(e.a, e.b) <= 1000 * min(e.a, e.b) for e in pair))
    expected = contact(first, second)
    found = contact(first, second, start=(length * cos(phi), length * sin(phi)))
    tolerance = ROUNDOFF * extent(first, second)
    tolerance += 1e-6 * min(first[:2] + second[:2]) * (found.distance < 0)
    tolerance += fit_errors(first, second, expected)[0]
    tolerance += fit_errors(first, second, found)[0]
    assert found.distance == pytest.approx(expected.distance, abs=tolerance)


def test_start_of_a_needle_in_a_wrong_place():
    first = Placed(5.400349594288429e-05, 1.0)
    axes = 0.040679443210830474, 0.00040679443210830474
    second = Placed(*axes, 0.012886949411656383, 0.03858283624871176, 1.25)
    expected = contact(first, second).distance
    found = contact(first, second, start=(cos(2.25), sin(2.25))).distance
    assert found == pytest.approx(expected, abs=1e-6)


@st.composite
def ellipse_and_polygon(draw):
    scale = draw(scales)
    ellipse = Placed(*draw(axes(scale)), 0.0, 0.0, draw(angles))
    return ellipse, Round(draw(polygons(scale)))


@many
@given(ellipse_and_polygon(), st.one_of(st.just(0.0), powers_of_ten(-6, 0.5)))
def test_ellipse_and_polygon(pair, rounding):
    ellipse, polygon = pair
    found = contact(ellipse, polygon)
    far = max(hypot(*vertex) for vertex in polygon.vertices)
    tolerance = ROUNDOFF * (extent(ellipse) + far)
    assert all(map(isfinite, found))
    assert hypot(found.nx, found.ny) == pytest.approx(1, abs=1e-14)
    slack = tolerance + fit_errors(ellipse, POINT, found)[0]
    check_sign(found.distance, polygon_function(ellipse, polygon.vertices), slack)
    assert off_surface(ellipse, found.x, found.y) <= tolerance
    # The polygon is in front of the ellipse's point along the normal, and touches there.
    touched = min(x * found.nx + y * found.ny for x, y in polygon.vertices)
    reached = found.x * found.nx + found.y * found.ny + found.distance
    assert touched == pytest.approx(reached, abs=tolerance)
    # A radius takes its length off every separation.
    radius = rounding * min(ellipse[:2])
    rounded = contact(ellipse, polygon._replace(radius=radius))
    slack += fit_errors(ellipse, Placed(radius, radius), rounded)[0] if radius else 0.0
    slack += 1e-6 * min(ellipse[:2]) * (rounded.distance < 0)
    assert rounded.distance == pytest.approx(found.distance - radius, abs=slack)


@many
@given(pairs_of_ellipses(), st.tuples(*[st.floats(-1e7, 1e7)] * 4), st.booleans())
def test_shapes(pair, places, far):
    """The same of shapes on bodies, up to 1e7 from the origin."""
    x, y, offset_x, offset_y = places
    size = extent(*pair)
    offset = (offset_x, offset_y) if far else (offset_x * size, offset_y * size)
    offset = offset[0] / 1e7, offset[1] / 1e7
    # A shape does not keep its body alive.
    bodies, shapes, placed = [], [], []
    for ellipse in pair:
        body = pymunk.Body()
        bodies.append(body)
        body.angle = ellipse.angle / 2
        turned = pymunk.Vec2d(*offset).rotated(body.angle)
        body.position = ellipse.x - turned.x, ellipse.y - turned.y
        if far:
            body.position += (x, y)
        shape = Ellipse(body, ellipse.a, ellipse.b, offset, ellipse.angle / 2)
        shapes.append(shape)
        center = body.position + pymunk.Vec2d(*offset).cpvrotate(body.rotation_vector)
        placed.append(ellipse._replace(x=center.x, y=center.y))
    one, two = shapes
    tolerance = ROUNDOFF * (extent(*placed) + hypot(*offset))
    found = one.shapes_collide(two)
    if not found.points:
        assert found.normal == (0, 0)
        assert (
            contact_function(*placed) > 1 or abs(contact(*placed).distance) <= tolerance
        )
        return
    (point,) = found.points
    assert found.normal.length == pytest.approx(1, abs=1e-14)
    assert point.distance <= tolerance
    contact_found = Found(point.distance, *found.normal, 0.0, 0.0)
    depth_error, point_error = fit_errors(*placed, contact_found)
    check_sign(point.distance, contact_function(*placed), tolerance + depth_error)
    assert off_surface(placed[0], *point.point_a) <= tolerance
    assert off_surface(placed[1], *point.point_b) <= tolerance + point_error
    swapped = sum(p.distance for p in two.shapes_collide(one).points)
    slack = tolerance + 1e-6 * min(pair[0][:2] + pair[1][:2])
    slack += depth_error + fit_errors(*placed[::-1], contact_found)[0]
    assert swapped == pytest.approx(point.distance, abs=slack)


@many
@given(pairs_of_ellipses(), st.floats(0, 2), st.floats(-1, 1), st.floats(-1e7, 1e7))
def test_queries(pair, radius, turn, far):
    """A point's nearest point and where a circle arrives, each shown by what they mean."""
    first, second = pair
    ellipse = first._replace(x=far, y=-far)
    body = pymunk.Body()
    body.position, body.angle = (ellipse.x, ellipse.y), ellipse.angle
    shape = Ellipse(body, ellipse.a, ellipse.b)
    tolerance = ROUNDOFF * extent(ellipse, second)

    p = pymunk.Vec2d(second.x + far, second.y - far)
    hit = shape.point_query(p)
    assert hit.gradient.length == pytest.approx(1, abs=1e-14)
    assert off_surface(ellipse, *hit.point) <= tolerance
    assert abs(hit.distance) == pytest.approx((p - hit.point).length, abs=tolerance)
    away = hit.point + hit.distance * hit.gradient
    assert (away - p).length <= tolerance + 1e-13 * abs(hit.distance)
    point_square = ((p - hit.point).length / ellipse.b) ** 2
    assert isfinite(point_square)

    radius *= min(ellipse[:2])
    end = p + (pymunk.Vec2d(ellipse.x, ellipse.y) - p).rotated(turn) * 2
    hit = shape.segment_query(p, end, radius)
    if hit is None:
        return
    assert 0 <= hit.alpha <= 1
    assert hit.normal.length == pytest.approx(1, abs=1e-14)
    if hit.alpha > 0:
        assert off_surface(ellipse, *hit.point) <= tolerance
        center = p.interpolate_to(end, hit.alpha)
        assert shape.point_query(center).distance == pytest.approx(
            radius, abs=2 * tolerance
        )
        # Nothing of the way before is nearer.
        for part in (0.25, 0.5, 0.75):
            before = p.interpolate_to(end, part * hit.alpha)
            assert shape.point_query(before).distance >= radius - 2 * tolerance


@st.composite
def scenes(draw):
    """A few shapes of every kind in a space."""
    scale = draw(powers_of_ten(-3, 3))
    space = pymunk_ellipse.Space()
    for _ in range(draw(st.integers(1, 5))):
        body = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        body.position = (
            draw(st.floats(-4, 4)) * scale,
            draw(st.floats(-4, 4)) * scale,
        )
        body.angle = draw(angles)
        kind = draw(st.sampled_from(["ellipse", "ellipse", "circle", "box", "segment"]))
        a = scale * draw(st.floats(0.1, 2))
        if kind == "ellipse":
            shape = Ellipse(body, a, a / draw(powers_of_ten(0, 1.5)))
        elif kind == "circle":
            shape = pymunk.Circle(body, a)
        elif kind == "box":
            shape = pymunk.Poly.create_box(body, (a, scale))
        else:
            shape = pymunk.Segment(body, (-a, 0), (a, a), 0.1 * a)
        space.add(body, shape)
    return scale, space


def points(scale):
    return st.tuples(st.floats(-6, 6), st.floats(-6, 6)).map(
        lambda point: pymunk.Vec2d(*point) * scale
    )


@many
@given(scenes(), st.data())
def test_queries_of_a_space(scene, data):
    """What a space finds is what its shapes say one by one."""
    scale, space = scene
    tolerance = 1e-9 * scale
    p = data.draw(points(scale))
    limit = data.draw(st.floats(-1, 6)) * scale
    distances = {shape: shape.point_query(p).distance for shape in space.shapes}
    found = {hit.shape: hit.distance for hit in space.point_query(p, limit, ALL)}
    for shape, distance in distances.items():
        if shape in found:
            assert found[shape] == pytest.approx(distance, abs=tolerance)
        if abs(distance - limit) > tolerance:
            assert (shape in found) == (distance < limit)
    nearest = space.point_query_nearest(p, limit, ALL)
    if nearest is not None:
        assert nearest.distance == pytest.approx(min(distances.values()), abs=tolerance)
    else:
        assert min(distances.values()) >= limit - tolerance

    end = data.draw(points(scale))
    ellipses = [shape for shape in space.shapes if isinstance(shape, Ellipse)]
    hits = {hit.shape: hit.alpha for hit in space.segment_query(p, end, 0, ALL)}
    for shape in ellipses:
        hit = shape.segment_query(p, end, 0)
        assert (shape in hits) == (hit is not None)
        if hit is not None:
            assert hits[shape] == hit.alpha
    first = space.segment_query_first(p, end, 0, ALL)
    if first is None:
        assert all(alpha >= 1 for alpha in hits.values())
    else:
        assert first.alpha == pytest.approx(min(hits.values()), abs=1e-9)

    corner, other = data.draw(points(scale)), data.draw(points(scale))
    box = pymunk.BB(
        min(corner.x, other.x),
        min(corner.y, other.y),
        max(corner.x, other.x),
        max(corner.y, other.y),
    )
    in_box = space.bb_query(box, ALL)
    for shape in ellipses:
        assert (shape in in_box) == shape.bb.intersects(box)

    probe = ellipses[0] if ellipses else next(iter(space.shapes))
    found = {hit.shape: hit.contact_point_set for hit in space.shape_query(probe)}
    for shape in space.shapes:
        if shape is not probe and isinstance(probe, Ellipse):
            touches = bool(probe.shapes_collide(shape).points)
            assert (shape in found) == touches


@many
@given(pairs_of_ellipses(), st.integers(1, 12))
def test_circle_fit(pair, sweeps):
    first, second = pair
    fit = circle_fit(first, second, sweeps)
    assert all(map(isfinite, (*fit.first, *fit.second, fit.depth, *fit.normal)))
    assert fit.sweeps <= sweeps
    assert fit.normal == (0, 0) or hypot(*fit.normal) == pytest.approx(1, abs=1e-14)
    for ellipse, circle in zip(pair, fit[:2], strict=True):
        longer, shorter = max(ellipse[:2]), min(ellipse[:2])
        sharpest, flattest = shorter * shorter / longer, longer * longer / shorter
        assert sharpest * (1 - 1e-9) <= circle.radius <= flattest * (1 + 1e-9)


def result_or_error(function, *arguments, names):
    """What a function returns, None if it raises an error that names an argument."""
    try:
        return function(*arguments)
    except (TypeError, ValueError) as error:
        assert re.match(rf"({'|'.join(names)})\b.* must ", str(error)), error
        return None


def numbers_in(result):
    """All the numbers in a result made of tuples."""
    if isinstance(result, (int, float)):
        return [result]
    if isinstance(result, tuple):
        return [number for part in result for number in numbers_in(part)]
    return []


@many
@given(*[anything] * 9)
def test_any_finite_shape(a, b, x, y, angle, body_x, body_y, px, py):
    body = pymunk.Body()
    body.position, body.angle = (body_x, body_y), angle
    names = ("a", "b", "offset", "angle")
    # Farther away the distance itself is no longer finite.
    assume(max(map(abs, (body_x, body_y, px, py))) < 1e300)
    # Beyond that the hull has no room: see the next test.
    assume(max(abs(x), abs(y)) < 1e9 * min(abs(a), abs(b)))
    shape = result_or_error(Ellipse, body, a, b, (x, y), angle, names=names)
    if shape is None:
        fits = min(a, b) >= 1e-50 and max(a, b) <= 1e50
        assert not fits or max(a, b) > 1e6 * min(a, b)
        return
    for other in (Ellipse(None, 2, 1), pymunk.Circle(None, 3), shape):
        found = shape.shapes_collide(other)
        assert all(map(isfinite, numbers_in(found)))
    for hit in (shape.point_query((px, py)), shape.segment_query((px, py), (x, y), 1)):
        assert hit is None or all(map(isfinite, numbers_in(tuple(hit))))


def test_shapes_of_most_different_sizes():
    """Where the tolerance of the smaller is below the roundoff of the larger."""
    large = Ellipse(pymunk.Body(), 5247575981056985.0, 5397043457852179.0, (1, -1))
    for angle in range(100):
        large.unsafe_set_angle(0.0628 * angle)
        found = large.shapes_collide(Ellipse(None, 2, 1))
        assert all(map(isfinite, numbers_in(found.points[0].distance)))


def test_offset_that_swallows_the_ellipse_is_named():
    with pytest.raises(ValueError, match="offset"):
        Ellipse(None, 1, 1, (2.0**52, 0))


@many
@given(*[anything] * 10)
def test_any_finite_fit(a1, b1, x1, y1, angle1, a2, b2, x2, y2, angle2):
    names = ("first", "second")
    first, second = (a1, b1, x1, y1, angle1), (a2, b2, x2, y2, angle2)
    fit = result_or_error(circle_fit, first, second, names=names)
    if fit is not None:
        assert all(map(isfinite, numbers_in(fit)))


@many
@given(anything, anything, anything, anything, anything)
def test_any_finite_mass(mass, a, b, x, y):
    area = result_or_error(area_for_ellipse, a, b, names=("a", "b"))
    names = ("a", "b", "mass", "offset")
    moment = result_or_error(moment_for_ellipse, mass, a, b, (x, y), names=names)
    if area is not None:
        assert isfinite(area)
        assert area > 0
        # As pymunk's own, beyond the largest float.
        assert isfinite(moment) or max(map(abs, (mass, x, y))) > 1e50


@many
@given(
    st.lists(st.one_of(anything, bad_values), min_size=2, max_size=2),
    st.one_of(anything, bad_values, st.tuples(anything, bad_values)),
    st.one_of(anything, bad_values),
)
def test_any_object_at_all(semi_axes, offset, angle):
    names = ("a", "b", "offset", "angle")
    shape = result_or_error(Ellipse, None, *semi_axes, offset, angle, names=names)
    assert shape is None or all(map(isfinite, shape.bb))
    result_or_error(circle_fit, semi_axes, (2, 1, 0, 0), names=("first",))
    result_or_error(area_for_ellipse, *semi_axes, names=names)
    egg = Ellipse(None, 2, 1)
    result_or_error(egg.point_query, offset, names=("p",))
    result_or_error(egg.segment_query, offset, (1, 1), angle, names=("start", "radius"))
    for setter, arguments in (
        (egg.unsafe_set_semi_axes, semi_axes),
        (egg.unsafe_set_offset, [offset]),
        (egg.unsafe_set_angle, [angle]),
    ):
        result_or_error(setter, *arguments, names=names)
        assert all(map(isfinite, egg.bb))
