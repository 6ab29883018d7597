"""Compiles the package's functions with numba to one module of LLVM's, and that to an object file for a machine.

Numba's private side is used here, at build time only; pyproject.toml pins its version.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from ctypes import addressof, create_string_buffer
from typing import Any

# Before numba is imported, or the code would depend on the machine that builds it.
os.environ["NUMBA_CPU_NAME"] = "generic"
os.environ["NUMBA_CPU_FEATURES"] = ""

import llvmlite.binding as llvm
import numba
from numba import types
from numba.extending import register_jitable

from kernel.numba_structs import CLASS_SYMBOL, compile_structs, struct
from pymunk_ellipse.chipmunk import shape_class
from pymunk_ellipse.contacts import handover, impacts, pair, resolver
from pymunk_ellipse.narrowphase import (
    cast,
    common_normal,
    ellipse_ellipse,
    ellipse_polygon,
    frame,
    impact,
    nearest,
    rolling,
    rows,
)

_COMPILED = (
    cast,
    common_normal,
    ellipse_ellipse,
    ellipse_polygon,
    frame,
    impact,
    nearest,
    rolling,
    rows,
    shape_class,
    pair,
    handover,
    impacts,
    resolver,
)

# Names of the compiled functions start with this in the module.
PREFIX = "pe_native_"

# LLVM's names of a machine and its oldest processor, by those of Python's platform module.
MACHINES = {
    ("linux", "x86_64"): ("x86_64-unknown-linux-gnu", "x86-64"),
    ("linux", "aarch64"): ("aarch64-unknown-linux-gnu", "generic"),
    ("windows", "x86_64"): ("x86_64-pc-windows-gnu", "x86-64"),
    ("macos", "x86_64"): ("x86_64-apple-macosx11.0.0", "x86-64"),
    ("macos", "aarch64"): ("arm64-apple-macosx11.0.0", "apple-m1"),
}


def teach_numba(class_at: int) -> None:
    """Have numba compile the package's functions, and code that calls them find the class of ellipses at an address."""
    compile_structs()
    for python_module in _COMPILED:
        for function in list(vars(python_module).values()):
            own = getattr(function, "__module__", None) == python_module.__name__
            if own and callable(function) and not isinstance(function, type):
                register_jitable(function)
    llvm.add_symbol(CLASS_SYMBOL, class_at)


def compiled_entries() -> Iterator[Any]:
    """Numba's dispatchers of the functions that C calls, each compiled for its arguments."""
    number = types.float64
    word = types.int64
    numbers = types.CPointer(number)
    hull = struct("Hull")
    entries: tuple[tuple[Any, tuple[Any, ...]], ...] = (
        (resolver.resolve, (types.int64, types.int64, types.boolean)),
        (resolver.complete, (types.int64, types.int64)),
        (shape_class.cache_data, (hull, number, number, number, number)),
        (shape_class.nearest_updated, (hull, number, number)),
        (shape_class.cast_updated, (hull, *[number] * 5)),
        (shape_class.nearest_now, (hull, number, number)),
        (shape_class.cast_now, (hull, *[number] * 5)),
        (shape_class.collect_touched, (word, word)),
        (pair.shape_contact, (hull, struct("Shape"))),
        (rows.contacts_of_rows, (word, numbers, word, numbers, word, numbers)),
        (rows.nearest_of_rows, (word, numbers, word, numbers, word, numbers)),
    )
    for function, arguments in entries:
        yield numba.njit([arguments], error_model="numpy", _nrt=False)(function)


# Roots, as products and quotients, are the same everywhere to the last bit, and what LLVM has of its
# own mostly is. The C libraries' functions differ; only the sines and cosines of angles that the
# caller gives come from them.
_SAME_EVERYWHERE = re.compile(r"sqrt$|llvm\.(?!pow|exp|log|a?tan|asin|acos|sinh|cosh)")


def module() -> Any:
    """All entries of the library, and what they call, in one module of LLVM's.

    Raises ValueError if they call what differs from platform to platform.
    """
    # Numba links what it compiles into this process, where the class must be somewhere.
    somewhere = create_string_buffer(8)
    teach_numba(addressof(somewhere))
    whole = llvm.parse_assembly("")
    for compiled in compiled_entries():
        (result,) = compiled.overloads.values()
        part = llvm.parse_assembly(str(result.library._final_module))
        native = result.fndesc.llvm_func_name
        part.get_function(native).name = PREFIX + compiled.py_func.__name__
        whole.link_in(llvm.parse_assembly(_without_wrappers(str(part))))
    for called in whole.functions:
        if called.is_declaration and not _SAME_EVERYWHERE.match(called.name):
            raise ValueError(f"{called.name} differs from platform to platform")
    return whole


def _without_wrappers(text: str) -> str:
    """A module without numba's functions for calls from Python and C, and without what it says of the machine."""
    kept = []
    skips = False
    for line in text.splitlines():
        if line.startswith("define") and re.search(
            r'@"?(_ZN7cpython|cfunc\.|NRT_)', line
        ):
            skips = True
        if not skips:
            kept.append(line)
        elif line == "}":
            skips = False
    text = "\n".join(kept)
    text = re.sub(r"^target (triple|datalayout) = .*\n", "", text, flags=re.MULTILINE)
    return re.sub(r'"target-(cpu|features)"="[^"]*"', "", text)


def object_file(whole: Any, system: str, processor: str) -> bytes:
    """The module as an object file for an operating system and a processor, both named as in MACHINES."""
    triple, oldest = MACHINES[system, processor]
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    machine = llvm.Target.from_triple(triple).create_target_machine(
        cpu=oldest, opt=3, reloc="pic", codemodel="default"
    )
    code = llvm.parse_assembly(str(whole))
    code.triple = triple
    code.data_layout = str(machine.target_data)
    for function in code.functions:
        if function.name.startswith(PREFIX):
            function.visibility = "hidden"
        elif not function.is_declaration:
            function.linkage = "internal"
    for variable in code.global_variables:
        if not variable.is_declaration:
            variable.linkage = "internal"
    options = llvm.create_pipeline_tuning_options(speed_level=3)
    builder = llvm.create_pass_builder(machine, options)
    builder.getModulePassManager().run(code, builder)
    result: bytes = machine.emit_object(code)
    return result
