"""Loads and stores at addresses, for compiled code."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

_DOUBLE = ir.DoubleType()
_INT32 = ir.IntType(32)
_INT64 = ir.IntType(64)


def _loader(kind: Any, result: Any, name: str) -> Any:
    def load(typing_context: Any, address: Any, offset: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            place = builder.add(args[0], args[1])
            value = builder.load(builder.inttoptr(place, kind.as_pointer()))
            return value if kind is not _INT32 else builder.sext(value, _INT64)

        return result(types.int64, types.int64), generate

    load.__name__ = name
    return intrinsic(load)


def _storer(kind: Any, argument: Any, name: str) -> Any:
    def store(typing_context: Any, address: Any, offset: Any, value: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            place = builder.add(args[0], args[1])
            value = args[2] if kind is not _INT32 else builder.trunc(args[2], _INT32)
            builder.store(value, builder.inttoptr(place, kind.as_pointer()))
            return context.get_dummy_value()

        return types.void(types.int64, types.int64, argument), generate

    store.__name__ = name
    return intrinsic(store)


load_double = _loader(_DOUBLE, types.float64, "load_double")
load_int = _loader(_INT32, types.int64, "load_int")
load_word = _loader(_INT64, types.int64, "load_word")
store_double = _storer(_DOUBLE, types.float64, "store_double")
store_int = _storer(_INT32, types.int64, "store_int")
store_word = _storer(_INT64, types.int64, "store_word")


def _doubles_at(typing_context: Any, address: Any) -> Any:
    signature: Any = types.CPointer(types.float64)(types.int64)  # type: ignore[no-untyped-call]

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.inttoptr(args[0], _DOUBLE.as_pointer())

    return signature, generate


# A pointer to doubles, for numba.carray.
doubles_at: Any = intrinsic(_doubles_at)
