"""Numba's view of Chipmunk's structs: `struct.field.x` in compiled code is one load, as it is an attribute of cffi's in Python."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

from llvmlite import ir
from numba import types
from numba.core.imputils import lower_getattr_generic, lower_setattr_generic
from numba.core.typing.templates import AttributeTemplate, infer_getattr
from numba.extending import intrinsic, models, overload, register_model

from pymunk_ellipse.chipmunk import structs

_WORD = ir.IntType(64)

_NUMBERS = {
    "double": types.float64,
    "int": types.int32,
    "unsigned int": types.uint32,
    "unsigned char": types.uint8,
    "intptr_t": types.int64,
}

# Where the linker puts the class of ellipses.
CLASS_SYMBOL = "pe_ellipse_class"


class Struct(types.Type):
    """A struct in memory, known by its address."""

    def __init__(self, ctype: Any) -> None:
        super().__init__(name=f"struct {ctype.cname}")
        self.fields = dict(_fields(ctype, 0))


@register_model(Struct)
class _StructModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, _WORD)


def _fields(ctype: Any, start: int) -> Iterator[tuple[str, tuple[Any, int]]]:
    """The type and the offset of each field, those of unions without a name among them."""
    for name, field in ctype.fields:
        if name:
            yield name, (field.type, start + field.offset)
        else:
            yield from _fields(field.type, start + field.offset)


@cache
def numba_type(ctype: Any) -> Any:
    """Numba's type for one of C: a pointer to a struct reads as the struct, as in cffi; a function is no value."""
    if ctype.kind == "struct":
        return Struct(ctype)
    if ctype.kind in ("pointer", "array"):
        item = numba_type(ctype.item)
        return item if isinstance(item, Struct) else types.CPointer(item)
    return _NUMBERS[ctype.cname]


def struct(name: str) -> Any:
    """Numba's type for a struct of structs.h."""
    return numba_type(structs.ffi.typeof(name))


@infer_getattr
class _Attributes(AttributeTemplate):
    key = Struct

    def generic_resolve(self, value: Struct, name: str) -> Any:
        return numba_type(value.fields[name][0]) if name in value.fields else None


def _place(context: Any, builder: Any, kind: Struct, address: Any, name: str) -> Any:
    """Where a field is: its address, and a pointer to it."""
    ctype, offset = kind.fields[name]
    place = builder.add(address, ir.Constant(_WORD, offset))
    value = context.get_value_type(numba_type(ctype))
    return place, builder.inttoptr(place, value.as_pointer())


@lower_getattr_generic(Struct)
def _get(context: Any, builder: Any, kind: Struct, address: Any, name: str) -> Any:
    place, pointer = _place(context, builder, kind, address, name)
    c_kind = kind.fields[name][0].kind
    if c_kind == "struct":
        return place
    if c_kind == "array":
        return builder.inttoptr(place, pointer.type.pointee)
    return builder.load(pointer)


@lower_setattr_generic(Struct)
def _set(context: Any, builder: Any, signature: Any, args: Any, name: str) -> None:
    address, value = args
    _, pointer = _place(context, builder, signature.args[0], address, name)
    builder.store(value, pointer)


def _compile_cast(at: Callable[[Any], Any], name: str) -> None:
    """Have compiled code take an address, or another struct's, for a struct where Python casts."""
    target = struct(name)

    @intrinsic
    def same(typing_context: Any, address: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            return args[0]

        return target(address), generate

    @overload(at, strict=False)
    def cast(address: Any) -> Any:
        return lambda address: same(address)


@intrinsic
def _class_address(typing_context: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        symbol = builder.module.globals.get(CLASS_SYMBOL)
        if symbol is None:
            symbol = ir.GlobalVariable(builder.module, ir.IntType(8), CLASS_SYMBOL)
        return builder.ptrtoint(symbol, _WORD)

    return types.int64(), generate


@intrinsic
def _later(typing_context: Any, doubles: Any, count: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.gep(args[0], [args[1]])

    return doubles(doubles, types.int64), generate


def compile_structs() -> None:
    """Teach numba every function of structs.py that compiled code calls."""
    for name, at in (
        ("Arbiter", structs.arbiter_at),
        ("Contact", structs.contact_at),
        ("Space", structs.space_at),
        ("Body", structs.body_at),
        ("Shape", structs.shape_at),
        ("Circle", structs.circle_at),
        ("Segment", structs.segment_at),
        ("Poly", structs.polygon_at),
        ("Hull", structs.hull_at),
        ("WideRay", structs.ray_at),
    ):
        _compile_cast(at, name)

    @overload(structs.ellipse_class, strict=False)
    def ellipse_class() -> Any:
        return lambda: _class_address()

    @overload(structs.behind, strict=False)
    def behind(doubles: Any, count: Any) -> Any:
        return lambda doubles, count: _later(doubles, count)

    @overload(structs.frame_in, strict=False)
    def frame_in(doubles: Any) -> Any:
        return lambda doubles: (
            doubles[0],
            doubles[1],
            doubles[2],
            doubles[3],
            doubles[4],
            doubles[5],
        )
