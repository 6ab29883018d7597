"""An ellipse as a class of Chipmunk's shapes: queries of a plain pymunk.Space at work are exact, and nothing is freed too early."""

import copy
import gc
import itertools
import os
import pickle
from math import cos, inf, pi

import numpy as np
import pymunk
import pytest
from crowds import ALL, crowd, ellipses_in, random_points, separations
from processes import run_code
from pymunk import BB, Transform, Vec2d
from scenes import add_body, add_ellipse, lone_body, make_space

from pymunk_ellipse import Ellipse, nearest_points

pytestmark = pytest.mark.usefixtures("backend")

# QUERIES=5 asks five times as much: ten thousand points and as many rays in each scene.
MORE = float(os.environ.get("QUERIES", "1"))


# Queries


def at_rest():
    return crowd(np.random.default_rng(1), 8, pymunk.Space())


def moving(space):
    """The shapes of a crowd, thrown into each other."""
    crowd(np.random.default_rng(2), 8, space)
    space.gravity = 0, -50
    space.damping = 0.5
    space.add(pymunk.Segment(space.static_body, (-90, -45), (90, -45), 5))
    for i, body in enumerate(space.bodies):
        if body.body_type == pymunk.Body.DYNAMIC:
            body.mass, body.moment = 10, 500
            body.velocity = 40 * Vec2d(cos(i), cos(2 * i))
    return space


def threaded():
    space = pymunk.Space(threaded=True)
    space.threads = 2
    return moving(space)


def hashed():
    space = pymunk.Space()
    space.use_spatial_hash(12, 300)
    return moving(space)


def in_motion():
    space = moving(pymunk.Space())
    for _ in range(20):
        space.step(1 / 120)
    return space


SCENES = {
    "at rest": at_rest,
    "moving": lambda: moving(pymunk.Space()),
    "threaded": threaded,
    "spatial hash": hashed,
    "copy": lambda: in_motion().copy(),
    "deepcopy": lambda: copy.deepcopy(in_motion()),
    "pickle": lambda: pickle.loads(pickle.dumps(in_motion())),
}


def rows_of(ellipses):
    """a, b, x, y, angle of ellipses in the world."""
    return np.array(
        [
            (e.a, e.b, *e.body.local_to_world(e.offset), e.body.angle + e.angle)
            for e in ellipses
        ]
    )


def check_points(space, rng, count):
    """Points near ellipses, of which every one that is near enough must be found, at its distance."""
    ellipses = ellipses_in(space)
    rows = rows_of(ellipses)
    chosen = rng.integers(0, len(rows), count)
    points = random_points(rng, rows[chosen])
    # Chipmunk's spatial hash finds nothing within an infinite distance.
    limits = rng.choice([0.0, 2.0, 9.0, -0.5, 100.0], count)
    distances = nearest_points(rows[:, None], points).distance
    owner = np.full(count, -1)
    distance = np.zeros(count)
    for i, (point, limit) in enumerate(zip(points.tolist(), limits, strict=True)):
        hits = {
            hit.shape: hit
            for hit in space.point_query(point, limit, ALL)
            if isinstance(hit.shape, Ellipse)
        }
        near = {e for e, d in zip(ellipses, distances[:, i], strict=True) if d < limit}
        assert set(hits) == near
        nearest = space.point_query_nearest(point, limit, ALL)
        if nearest is not None and isinstance(nearest.shape, Ellipse):
            assert nearest == hits[nearest.shape]
            assert nearest.distance <= min(hit.distance for hit in hits.values())
            owner[i] = ellipses.index(nearest.shape)
            distance[i] = nearest.distance
        else:
            # Another shape, or nothing.
            least = nearest.distance if nearest else inf
            assert all(hit.distance >= least for hit in hits.values())
    # Some of the nearest against brute force, too.
    found = np.nonzero(owner >= 0)[0]
    some = found[::10]
    truth = separations(rows[owner[some]], points[some])
    assert np.abs(truth - distance[some]).max() < 1e-9 * rows[:, :2].max()
    return len(found)


def check_rays(space, rng, count):
    """Rays through the crowd, which must hit what the ellipses themselves say that they do, and where."""
    ellipses = ellipses_in(space)
    found = 0
    for start, end in rng.uniform(-50, 50, (count, 2, 2)).tolist():
        expected = {
            hit.shape: hit
            for hit in (e.segment_query(start, end) for e in ellipses)
            if hit is not None
        }
        hits = space.segment_query(start, end, 0, ALL)
        ours = {hit.shape: hit for hit in hits if isinstance(hit.shape, Ellipse)}
        assert ours.keys() == expected.keys()
        for shape, hit in expected.items():
            # Inside Chipmunk takes the normal from the nearest point itself.
            assert ours[shape][2:] == hit[2:] or hit.alpha == 0
            assert ours[shape].alpha == hit.alpha
        first = space.segment_query_first(start, end, 0, ALL)
        before = [hit.alpha for hit in hits if hit.alpha < 1]
        assert (first.alpha if first else None) == min(before, default=None)
        found += len(expected)
    return found


@pytest.mark.parametrize("scene", SCENES)
def test_no_query_of_a_plain_space_is_wrong(scene, backend):
    rng = np.random.default_rng(3)
    space = SCENES[scene]()
    assert type(space) is pymunk.Space
    rounds = 1 if scene == "at rest" else 10
    count = round((2000 if backend == "compiled" else 500) * MORE) // rounds
    points = rays = 0
    for _ in range(rounds):
        if rounds > 1:
            for _ in range(3):
                space.step(1 / 120)
        points += check_points(space, rng, count)
        rays += check_rays(space, rng, count)
    assert points > rounds * count / 4
    assert rays > rounds * count / 2


def test_queries_of_a_space_speak_of_the_last_update_and_those_of_a_shape_of_now():
    space = make_space()
    egg = add_ellipse(space, 4, 2)
    static = Ellipse(space.static_body, 4, 2, (100, 0))
    space.add(static)
    space.step(1e-9)
    egg.body.position = 50, 0
    egg.body.angle = pi / 2
    space.static_body.position = 0, 10

    def where(x, y):
        hit = space.point_query_nearest((x, y), 0, ALL)
        return hit and hit.shape

    assert (where(0, 0), where(50, 3), where(100, 0)) == (egg, None, static)
    assert space.bb_query(BB(-4, -2, 4, 2), ALL) == [egg]
    assert egg.point_query((50, 3)).distance == pytest.approx(-1)
    assert egg.bb == pytest.approx((48, -4, 52, 4))
    assert static.point_query((100, 10)).distance == -2
    space.reindex_shapes_for_body(egg.body)
    assert (where(0, 0), where(50, 3)) == (None, egg)
    space.reindex_static()
    assert (where(100, 0), where(100, 11)) == (None, static)


def test_an_ellipse_answers_what_chipmunk_asserts_of_a_polygon():
    """Chipmunk ends the process if it is asked these of a shape whose class is not its own for polygons."""
    space = make_space()
    egg = add_ellipse(space, 4, 2)
    space.step(0.01)
    vertices = egg.get_vertices()
    assert len(vertices) > 4
    hull = pymunk.Poly(None, vertices, radius=egg.radius)
    hull.update(Transform.identity())
    for i in range(64):
        outwards = Vec2d.from_polar(1, i * pi / 32)
        reach = Vec2d(4 * outwards.x, 2 * outwards.y).length
        support = max(vertex.dot(outwards) for vertex in vertices) + egg.radius
        assert reach < support < 1.1 * reach
    egg.unsafe_set_semi_axes(6, 3)
    egg.unsafe_set_offset((1, 1))
    egg.unsafe_set_angle(0.5)
    space.reindex_shape(egg)
    assert egg.get_vertices() != vertices
    assert space.point_query_nearest((1, 1), 0, ALL).distance == -3
    assert "Ellipse" in repr(egg)


# Bodies that are gone, or never were


def asked(egg):
    """All that an ellipse can be asked, as numbers."""
    point = egg.point_query((9, 1))
    segment = egg.segment_query((9, 1), (0, 0))
    contact = egg.shapes_collide(pymunk.Circle(None, 3, (5, 0)))
    apart = egg.distance(pymunk.Segment(None, (0, 30), (9, 40), 1))
    return [
        *(*egg.bb, egg.area, *egg.center_of_gravity),
        *(point.distance, *point.point, *point.gradient),
        *(segment.alpha, *segment.point, *segment.normal),
        *(*contact.normal, contact.points[0].distance),
        *(apart.distance, *apart.normal),
    ]


def test_without_a_body_an_ellipse_is_where_update_put_it():
    egg = Ellipse(None, 4, 2, (1, 0), 0.3)
    still = asked(egg)
    egg.update(Transform.translation(30, 0) @ Transform.rotation(2))
    assert egg.bb.left > 20
    egg.update(Transform.identity())
    assert asked(egg) == still
    assert egg.body is None


def test_a_body_that_dies_leaves_its_ellipse_where_it_was_updated_last():
    body = pymunk.Body(1, 1)
    body.position = 0.5, 0.25
    egg = Ellipse(body, 4, 2, (1, 0), 0.3)
    egg.cache_bb()
    expected = asked(egg)
    body.position = 70, 0
    del body
    gc.collect()
    assert egg.body is None
    assert asked(egg) == pytest.approx(expected, abs=1e-12)
    other = Ellipse(lone_body(0, 3), 2, 2)
    assert egg.shapes_collide(other).points
    assert other.shapes_collide(egg).points
    # On a new body it is asked of that.
    body = lone_body(100, 0)
    egg.body = body
    assert egg.bb.left > 90


def test_another_shape_whose_body_has_died():
    egg = Ellipse(None, 4, 2)
    for other in (
        pymunk.Circle(pymunk.Body(1, 1), 3, (5, 0)),
        pymunk.Segment(pymunk.Body(1, 1), (3, 0), (9, 0), 1),
        pymunk.Poly.create_box(pymunk.Body(1, 1), (7, 7)),
        Ellipse(pymunk.Body(1, 1), 3, 3, (5, 0)),
    ):
        gc.collect()
        assert egg.shapes_collide(other).points
        assert egg.distance(other).distance < 0


# Freed in any order


def scene_to_free(kind):
    """A space at work, and what else refers to its parts, by name."""
    space = kind()
    space.gravity = 0, -100
    body = add_body(space, (0, 3))
    egg = Ellipse(body, 4, 2)
    egg.mass = 1
    floor = Ellipse(space.static_body, 50, 1)
    space.add(egg, floor)
    for _ in range(30):
        space.step(0.01)
    twin = space.copy()
    twin.step(0.01)
    return {"space": space, "body": body, "egg": egg, "floor": floor, "twin": twin}


@pytest.mark.parametrize("kind", [pymunk.Space, lambda: pymunk.Space(threaded=True)])
def test_freed_in_any_order(kind):
    names = sorted(scene_to_free(kind))
    for order in itertools.permutations(names):
        things = scene_to_free(kind)
        for name in order:
            del things[name]
            if "twin" in things:
                things["twin"].step(0.01)
            gc.collect(0)
    gc.collect()


EXIT = """
    import atexit, faulthandler, gc, sys
    faulthandler.enable()
    import pymunk
    from test_shape_class import scene_to_free
    import pymunk_ellipse
    print(pymunk_ellipse.backend())
    things = scene_to_free(pymunk.Space)
    {keep}
    del things
"""
KEPT = {
    **{
        ", ".join(order): "\n    ".join(f"{n} = things[{n!r}]" for n in order)
        for order in (
            ("space", "body", "egg", "floor", "twin"),
            ("twin", "floor", "egg", "body", "space"),
            ("egg", "space"),
            ("egg",),
        )
    },
    "in sys": "sys.things = things",
    "longer than the class's module": (
        "sys.things = things; vars(pymunk_ellipse.chipmunk.shape_class).clear(); "
        "gc.collect()"
    ),
    "in a cycle": "things['cycle'] = things; gc.disable()",
    "in atexit": "atexit.register(lambda things: things['twin'].step(0.01), things)",
    "in the package": "pymunk_ellipse.things = things",
    "in pymunk": "pymunk.things = things['space'], things['egg']",
    "for ever": "import ctypes; ctypes.pythonapi.Py_IncRef(ctypes.py_object(things))",
}


@pytest.mark.parametrize("kept", KEPT)
def test_freed_at_the_interpreters_exit(kept, backend):
    code = EXIT.replace("{keep}", KEPT[kept])
    # What is freed is overwritten.
    overwritten = {"PYTHONMALLOC": "debug", "MALLOC_PERTURB_": "165"}
    printed, reported = run_code(code, PYMUNK_ELLIPSE_BACKEND=backend, **overwritten)
    assert printed.split() == [backend]
    assert reported == ""
