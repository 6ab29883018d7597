"""The compiled library against numba's own code from the same source, to the last bit; and what both touch of Chipmunk's structs."""

import random
from math import cos, sin

import jitted
import pymunk
import pytest
from pymunk import Transform
from scenes import crowded_pile
from test_proof import FIELDS, PARTS

from pymunk_ellipse import Ellipse, Space
from pymunk_ellipse.chipmunk.structs import address
from pymunk_ellipse.contacts import backend as backends

# Second names of the same place.
ALIASES = {
    ("Arbiter", "shape_a"): "a",
    ("Arbiter", "shape_b"): "b",
    ("Arbiter", "last"): "data",
    ("Arbiter", "contact"): "contacts",
    ("Shape", "shape_class"): "klass",
    ("Shape", "body"): "on_body",
}


@pytest.fixture(scope="module")
def numba(built):
    """Numba's kernel, while ellipses are those of the library."""
    pytest.importorskip("numba")
    with backends.using(built):
        yield jitted.kernel()


@pytest.mark.parametrize(
    "make", [pymunk.Space, lambda: Space(exact_impacts=True)], ids=["plain", "impacts"]
)
def test_a_pile_moves_alike(make, numba, built):
    def path(kernel):
        with backends.using(kernel):
            space = crowded_pile(make())
            places = []
            for _ in range(240):
                space.step(1 / 120)
                places.append([(*body.position, body.angle) for body in space.bodies])
            return places

    library, reference = path(built), path(numba)
    assert max(abs(place[2]) for place in library[-1]) > 3
    assert library == reference


def test_the_class_functions_give_the_same_numbers(numba):
    rng = random.Random(3)
    functions = numba.functions
    hits = 0
    for _ in range(2000):
        a, b = (10 ** rng.uniform(-2, 2) for _ in range(2))
        offset = rng.uniform(-9, 9), rng.uniform(-9, 9)
        egg = Ellipse(None, a, b, offset, rng.uniform(-4, 4))
        place = address(egg._shape)
        turn = rng.uniform(-4, 4)
        x, y = rng.uniform(-9, 9), rng.uniform(-9, 9)
        box = functions["cache_data"](place, cos(turn), sin(turn), x, y)
        transform = Transform.translation(x, y) @ Transform.rotation(turn)
        assert tuple(egg.update(transform)) == box

        start, end = ((rng.gauss(0, 30), rng.gauss(0, 30)) for _ in range(2))
        point = egg.point_query(start)
        expected = functions["nearest_updated"](place, *start)
        assert (point.distance, *point.gradient, *point.point) == expected
        radius = rng.choice((0.0, a))
        expected = functions["cast_updated"](place, *start, *end, radius)
        hit = egg.segment_query(start, end, radius)
        if hit is None:
            assert expected[0] > 1
        else:
            assert (hit.alpha, *hit.normal, *hit.point) == expected
            hits += 1
    assert hits > 300


def test_no_field_is_touched_that_is_not_proved(numba):
    """Of all that the compiler looked up."""
    touched = set()
    for struct, field in numba.fields:
        # An ellipse's hull begins as a polygon, and has its own where that has inline planes; a
        # wide ray is not Chipmunk's.
        kind = "Poly" if struct == "Hull" and field in FIELDS["Poly"] else struct
        if kind not in ("Hull", "WideRay") and field != "shape":
            touched.add((kind, ALIASES.get((kind, field), field)))
    known = {(kind, field) for kind, fields in FIELDS.items() for field in fields}
    parts = {(kind, field) for kind, fields in PARTS.items() for field in fields}
    assert len(touched) > 40
    assert touched <= known | parts
