"""The proof of Chipmunk's structs: whatever a pymunk moved or renumbered is named before anything relies on it."""

from pathlib import Path

import cffi
import pymunk
import pytest

from pymunk_ellipse import Ellipse
from pymunk_ellipse.chipmunk import proof, structs
from pymunk_ellipse.contacts import backend as backends

CHIPMUNK = Path(structs.__file__).parent

# Each after those that it contains or points to.
ALL = (
    *("Vect", "Transform", "Box", "Contact", "Body", "ShapeClass", "Shape", "Circle"),
    *("Segment", "Poly", "Arbiter", "PointQueryInfo", "SegmentQueryInfo"),
    *("CollisionHandler", "Space"),
)

# What the proof says of each field that is read or written, by struct.
FIELDS = {
    "Contact": {
        "r1": "a cpContact's r1",
        "r2": "a cpContact's r2",
        "nMass": "a cpContact's nMass",
        "tMass": "a cpContact's tMass",
        "bounce": "a cpContact's bounce",
        "jnAcc": "a cpContact's jnAcc",
        "jtAcc": "a cpContact's jtAcc",
        "hash": "a cpContact's hash",
    },
    "Arbiter": {
        "e": "a cpArbiter's e",
        "u": "a cpArbiter's u",
        "surface_vr": "a cpArbiter's surface_vr",
        "data": "a cpArbiter's data",
        "a": "a cpArbiter's a",
        "b": "a cpArbiter's b",
        "body_a": "a cpArbiter's body_a",
        "body_b": "a cpArbiter's body_b",
        "count": "a cpArbiter's count",
        "contacts": "a cpArbiter's contacts",
        "n": "a cpArbiter's n",
        "state": "a cpArbiter's state",
        "processCollision": "a cpArbiter's processCollision",
    },
    "PointQueryInfo": {
        "shape": "a cpPointQueryInfo's shape",
        "point": "a cpPointQueryInfo's point",
        "distance": "a cpPointQueryInfo's distance",
        "gradient": "a cpPointQueryInfo's gradient",
    },
    "SegmentQueryInfo": {
        "shape": "a cpSegmentQueryInfo's shape",
        "point": "a cpSegmentQueryInfo's point",
        "normal": "a cpSegmentQueryInfo's normal",
        "alpha": "a cpSegmentQueryInfo's alpha",
    },
    "Body": {
        "velocity_func": "a body's velocity and position functions",
        "position_func": "a body's velocity and position functions",
        "m_inv": "a body's inverse mass",
        "i_inv": "a body's inverse moment",
        "cog": "a body's center of gravity",
        "p": "a body's position",
        "v": "a body's velocity",
        "f": "a body's force",
        "w": "a body's angular velocity",
        "t": "a body's torque",
        "transform": "a body's transform",
        "space": "a body's space",
        "constraints": "a body's joints",
        "v_bias": "a body's bias velocities",
        "w_bias": "a body's bias velocities",
    },
    "Shape": {
        "klass": "a shape's class",
        "on_body": "a shape's body",
        "i": "a shape's moment",
        "cog": "a shape's center of gravity",
        "area": "a shape's area",
        "bb": "a shape's box",
        "surfaceV": "a shape's surface velocity",
        "sensor": "whether a shape is a sensor",
    },
    "ShapeClass": {
        "type": "a shape's kind",
        "cache_data": "a class's cache_data",
        "point_query": "a class's point_query",
        "segment_query": "a class's segment_query",
    },
    "Circle": {
        "c": "a circle's offset",
        "tc": "a circle's center",
        "r": "a circle's radius",
    },
    "Segment": {
        "a": "a segment's a",
        "b": "a segment's b",
        "n": "a segment's local normal",
        "ta": "a segment's start",
        "tb": "a segment's end",
        "tn": "a segment's normal",
        "r": "a segment's radius",
        "a_tangent": "a segment's neighbor at a",
        "b_tangent": "a segment's neighbor at b",
    },
    "Poly": {
        "r": "a polygon's radius",
        "count": "a polygon's vertex count",
        "planes": "a polygon's planes",
        "inline_planes": "a polygon's planes",
    },
    "Space": {
        "iterations": "a space's iterations",
        "gravity": "a space's gravity",
        "damping": "a space's damping",
        "collisionSlop": "a space's collision slop",
        "collisionBias": "a space's collision bias",
        "collisionPersistence": "a space's collision persistence",
        "stamp": "a space's stamp",
        "curr_dt": "a space's time step",
        "global_handler": "a space's global handler",
        "static_body": "a space's static body",
        "static_body_at": "a space's static body",
    },
}
# What is in several structs.
PARTS = {
    "Vect": ("x", "y"),
    "Transform": ("a", "b", "c", "d", "tx", "ty"),
    "Box": ("left", "bottom", "right", "top"),
}


CONSTANTS = {
    "CIRCLE": "a shape's kind",
    "SEGMENT": "a shape's kind",
    "POLYGON": "a shape's kind",
    "INLINE_VERTICES": "how many planes are inline in a polygon",
    "FIRST_COLLISION": "an arbiter's states",
    "IGNORE": "an arbiter's states",
    "CACHED": "an arbiter's states",
}


def members(ctype):
    """Name, type and offset of each field of a struct, those of unions without a name among them."""
    for name, field in ctype.fields:
        if name:
            yield name, field.type, field.offset
        else:
            for inner, kind, offset in members(field.type):
                yield inner, kind, field.offset + offset


def declaration(kind, moved=None):
    """A struct with all fields where they are known to be, but for one that is eight bytes behind."""
    # A union of every field with as many bytes before it can have any offsets.
    lines = []
    for name, ctype, offset in members(structs.ffi.typeof(kind)):
        before = offset + 8 * (name == moved)
        bytes_before = f"char before_{name}[{before}]; " if before else ""
        text = structs.ffi.getctype(ctype, name)
        if ctype.kind == "pointer" and ctype.item.kind == "function":
            text = f"intptr_t {name}"
        lines.append(f"struct {{ {bytes_before}{text}; }};")
    return f"typedef union {{ {' '.join(lines)} }} {kind};"


def with_moved(struct, field):
    """cffi's view of Chipmunk's structs with one field elsewhere."""
    ffi = cffi.FFI()
    for kind in ALL:
        moved = field if kind == struct else None
        ffi.cdef(declaration(kind, moved), packed=True)
    return ffi


def first_difference_with(ffi, monkeypatch):
    """The first field that is not where another declaration says."""
    monkeypatch.setattr(proof, "ffi", ffi)
    for name, kind in (
        ("body_at", "Body"),
        ("shape_at", "Shape"),
        ("circle_at", "Circle"),
        ("segment_at", "Segment"),
        ("polygon_at", "Poly"),
        ("space_at", "Space"),
    ):
        monkeypatch.setattr(
            proof, name, lambda place, kind=kind: ffi.cast(f"{kind} *", place)
        )
    return proof.first_difference(proof.findings())


def test_this_pymunk_is_known():
    assert proof.first_difference(proof.findings()) is None


def test_a_declaration_with_nothing_moved_is_right(monkeypatch):
    """It is the tests' own way to declare the structs, so what follows says something."""
    ffi = with_moved(None, None)
    for kind in ALL:
        ours = {name: offset for name, _, offset in members(ffi.typeof(kind))}
        for name, _, offset in members(structs.ffi.typeof(kind)):
            assert ours[name] == offset
    assert first_difference_with(ffi, monkeypatch) is None


@pytest.mark.parametrize(
    ("struct", "field", "name"),
    [
        (struct, field, name)
        for struct, fields in FIELDS.items()
        for field, name in fields.items()
    ],
)
def test_a_field_that_moved_is_named(struct, field, name, monkeypatch):
    assert first_difference_with(with_moved(struct, field), monkeypatch) == name


@pytest.mark.parametrize(
    ("struct", "field"),
    [(struct, field) for struct, fields in PARTS.items() for field in fields],
)
def test_a_part_that_moved_is_found(struct, field, monkeypatch):
    """Of a vector, a transform or a box, which are in several structs."""
    assert first_difference_with(with_moved(struct, field), monkeypatch) is not None


@pytest.mark.parametrize("by", [-1, 1])
@pytest.mark.parametrize("constant", CONSTANTS)
def test_a_number_that_changed_is_named(constant, by, monkeypatch):
    monkeypatch.setattr(proof, constant, getattr(proof, constant) + by)
    found = proof.first_difference(proof.findings())
    if constant == "INLINE_VERTICES" and by > 0:
        # The planes of as many vertices as would fit are elsewhere already.
        assert found == "a polygon's planes"
    else:
        assert found == CONSTANTS[constant]


def test_a_hull_has_room_for_what_an_ellipse_keeps_there():
    assert structs.ffi.sizeof("Hull") <= structs.ffi.sizeof("Poly")


def test_nothing_is_read_behind_a_difference():
    def found():
        yield "a shape's mass", (1.0,), (1.0,)
        yield "a shape's class", 3, 4
        raise AssertionError

    assert proof.first_difference(found()) == "a shape's class"


@pytest.fixture
def moved(monkeypatch):
    """A pymunk that keeps a field elsewhere, before the first ellipse."""
    monkeypatch.setattr(backends, "_kernel", None)
    proof.prove_structs.cache_clear()
    ffi = with_moved("Body", "p")
    monkeypatch.setattr(proof, "body_at", lambda place: ffi.cast("Body *", place))
    yield
    proof.prove_structs.cache_clear()


def test_the_first_ellipse_says_what_moved_and_what_works(moved):
    body = pymunk.Body(1, 1)
    message = (
        f"does not know pymunk {pymunk.version}: it keeps a body's position elsewhere than "
        r"pymunk 7\.0\.1 to 7\.3\.1 does; one of those works"
    )
    for _ in range(2):
        with pytest.raises(RuntimeError, match=message):
            Ellipse(body, 2, 1)
        with pytest.raises(RuntimeError, match=message):
            backends.backend()
    assert not body.shapes


def test_the_declarations_are_those_of_the_header():
    """_declared.py is what `python -m kernel.declare` makes of structs.h.

    It says the fields' types and no offset, so that cffi lays them out for the machine it is on,
    those of 32 bits among them; that this is right there is not tested.
    """
    declare = pytest.importorskip("kernel.declare")
    header = (CHIPMUNK / "structs.h").read_text("utf-8")
    assert declare.declared(header) == (CHIPMUNK / "_declared.py").read_text("utf-8")
