"""Shape queries: which shapes overlap, and their contacts."""

from math import hypot, pi

import numpy as np
import pymunk
import pymunk.batch
import pytest
from brute_force import ellipse_separations
from crowds import crowd, ellipses_in
from pairs import from_reference
from pymunk import ShapeFilter, Transform, Vec2d
from scenes import REFERENCES, add_body, add_ellipse, as_shape

from pymunk_ellipse import Ellipse, Space


def row_of(ellipse):
    angle = ellipse.body.angle + ellipse.angle
    center = ellipse.body.local_to_world(ellipse.offset)
    return ellipse.a, ellipse.b, angle, center.x, center.y


def test_ellipses_that_overlap_are_found():
    rng = np.random.default_rng(10)
    space = crowd(rng, 40)
    touching = hulls_only = 0
    for shape in ellipses_in(space):
        plain = pymunk.Space.shape_query(space, shape)
        hits = {hit.shape: hit for hit in space.shape_query(shape)}
        others = [other for other in ellipses_in(space) if other is not shape]
        a, b, angle, x, y = row_of(shape)
        rows = np.array(
            [
                (a, b, angle, p, q, turn, u - x, v - y)
                for p, q, turn, u, v in map(row_of, others)
            ]
        )
        for other, separation in zip(others, ellipse_separations(rows), strict=True):
            assert (other in hits) == (separation <= 0)
            if other in hits:
                touching += 1
                contact = hits[other].contact_point_set
                [point] = contact.points
                assert point.distance == pytest.approx(separation, abs=1e-9)
                assert shape.point_query(point.point_a).distance == pytest.approx(
                    0, abs=1e-9
                )
                assert other.point_query(point.point_b).distance == pytest.approx(
                    0, abs=1e-9
                )
                assert contact.normal.dot(point.point_a - point.point_b) > 0
            else:
                hulls_only += any(hit.shape is other for hit in plain)
    assert touching > 20
    assert hulls_only > 2


def kinds(body):
    return [
        Ellipse(body, 5, 2, (1, 1), 0.3),
        pymunk.Circle(body, 4, (1, 1)),
        pymunk.Segment(body, (-4, 0), (5, 2), 0.5),
        pymunk.Poly(body, [(-3, -2), (4, -1), (3, 3)], radius=0.5),
    ]


@pytest.mark.parametrize("kind", range(4))
@pytest.mark.parametrize("place", ["in the space", "on its own body", "updated"])
def test_any_shape_finds_ellipses(kind, place):
    """Its contacts lead from it to what it finds: moved back by the depth it only just touches."""
    rng = np.random.default_rng(11)
    found = 0
    for _ in range(150):
        space = Space()
        egg = add_ellipse(space, 6, 3, tuple(rng.uniform(-9, 9, 2)), rng.uniform(0, pi))
        egg.filter = ShapeFilter(group=1)
        circle = pymunk.Circle(space.static_body, 2, (3, 3))
        space.add(circle)
        body = pymunk.Body(1, 1)
        body.position = tuple(rng.uniform(-5, 5, 2))
        body.angle = rng.uniform(-pi, pi)
        if place == "updated":
            shape = kinds(None)[kind]
            turn = Transform.rotation(body.angle)
            shape.update(Transform.translation(*body.position) @ turn)
            twin = kinds(body)[kind]
        else:
            shape = twin = kinds(body)[kind]
        if place == "in the space":
            space.add(body, shape)
        hits = {hit.shape: hit.contact_point_set for hit in space.shape_query(shape)}
        assert shape not in hits

        exact = egg.shapes_collide(twin)
        assert (egg in hits) == bool(exact.points)
        if egg in hits:
            found += 1
            [point] = hits[egg].points
            assert point.distance == pytest.approx(exact.points[0].distance)
            assert abs(hits[egg].normal + exact.normal) < 1e-9
            assert abs(point.point_a - exact.points[0].point_b) < 1e-9
            assert abs(point.point_b - exact.points[0].point_a) < 1e-9
            depth = -point.distance
            egg.body.position += hits[egg].normal * (depth - 1e-6)
            assert egg.shapes_collide(twin).points
            egg.body.position += hits[egg].normal * 2e-6
            assert not egg.shapes_collide(twin).points
        if kind:
            plain = pymunk.Space.shape_query(space, shape)
            [theirs] = [h for h in plain if h.shape is circle] or [None]
            ours = hits.get(circle)
            assert repr(ours) == repr(theirs and theirs.contact_point_set)
    assert found > 50


@pytest.mark.parametrize("case", [c for c in REFERENCES if c["depth"] >= 0])
def test_contacts_found_in_a_space_are_right_to_nine_digits(case):
    space = Space()
    (a, b, x, y, angle), other = from_reference(case)
    space.add(Ellipse(space.static_body, a, b, (x, y), angle))
    shape = as_shape(None, other)
    shape.update(Transform.identity())
    [hit] = space.shape_query(shape)
    contact = hit.contact_point_set
    [point] = contact.points
    normal = -Vec2d(*case["normal"])
    assert point.distance == pytest.approx(-case["depth"], abs=1e-9 * max(a, b))
    assert abs(contact.normal - normal) < 1e-9
    assert abs(point.point_b - point.point_a - point.distance * normal) < 1e-9 * a
    assert hit.shape.point_query(point.point_b).distance == pytest.approx(0, abs=1e-9)
    # Where the ellipse has that normal.
    u = -normal.rotated(-angle)
    support = Vec2d(a * a * u.x, b * b * u.y) / hypot(a * u.x, b * u.y)
    touched = Vec2d(x, y) + support.rotated(angle)
    assert abs(point.point_b - touched) < 1e-9 * max(a, b)


def test_groups_and_masks_count_in_shape_queries():
    space = Space()
    egg = add_ellipse(space, 6, 3)
    shape = Ellipse(space.static_body, 2, 1)
    assert [hit.shape for hit in space.shape_query(shape)] == [egg]
    egg.filter = shape.filter = ShapeFilter(group=1)
    assert not space.shape_query(shape)
    egg.filter = ShapeFilter(categories=2)
    shape.filter = ShapeFilter(mask=1)
    assert not space.shape_query(shape)
    shape.filter = ShapeFilter(mask=2)
    assert space.shape_query(shape)
    egg.sensor = True
    assert space.shape_query(shape)


def test_shapes_collide_takes_other_shapes_where_update_put_them():
    egg = Ellipse(None, 4, 2)
    for other in kinds(None)[1:]:
        assert egg.shapes_collide(other).points
        other.update(Transform.translation(30, 0))
        assert not egg.shapes_collide(other).points
        egg.update(Transform.translation(30, 0))
        assert egg.shapes_collide(other).points
        egg.update(Transform.identity())


def test_shapes_that_nothing_has_placed_are_at_the_origin():
    for other, touches in (
        (pymunk.Circle(None, 1, (4.5, 0)), True),
        (pymunk.Circle(None, 1, (30, 0)), False),
        (pymunk.Segment(None, (3, 0), (30, 0), 1), True),
        (pymunk.Segment(None, (20, 0), (30, 0), 1), False),
        (pymunk.Poly(None, [(3, 0), (30, 0), (30, 9)]), True),
        (pymunk.Poly(None, [(20, 0), (30, 0), (30, 9)]), False),
    ):
        assert bool(Ellipse(None, 4, 2).shapes_collide(other).points) == touches


def test_a_face_touched_next_to_its_corner_is_a_face():
    egg = Ellipse(None, 4, 2)
    corners = [(-1e-6, -1.9), (9, -1.9), (9, -9), (-1e-6, -9)]
    contact = egg.shapes_collide(pymunk.Poly(None, corners))
    assert contact.normal == pytest.approx((0, -1), abs=1e-12)
    assert contact.points[0].point_a == pytest.approx((0, -2), abs=1e-12)


def test_a_face_with_a_corner_close_behind_it_is_a_face():
    contact = Ellipse(None, 4, 2, (0, 1.999)).shapes_collide(
        pymunk.Poly(None, [(-10, 0), (10, 0), (0, -0.01)])
    )
    assert contact.points[0].distance == pytest.approx(-0.001, abs=1e-12)


@pytest.mark.parametrize("size", [1e-6, 1e-3, 1.0, 1e3, 1e6])
def test_shape_queries_at_any_scale(size):
    rng = np.random.default_rng(12)
    space = Space()
    eggs = []
    for _ in range(60):
        body = add_body(space, tuple(size * rng.uniform(-5, 5, 2)), rng.uniform(0, pi))
        eggs.append(Ellipse(body, size, size / 3))
        space.add(eggs[-1])
    for kind in (
        pymunk.Circle(space.static_body, size / 2, (size, size)),
        pymunk.Segment(space.static_body, (-size, 0), (2 * size, size), size / 9),
        pymunk.Poly.create_box(space.static_body, (3 * size, size), size / 9),
        eggs[0],
    ):
        expected = {
            egg for egg in eggs if egg is not kind and egg.shapes_collide(kind).points
        }
        assert {hit.shape for hit in space.shape_query(kind)} == expected
        assert expected
