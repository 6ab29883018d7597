"""Builds the library beside the package's sources, for this machine or for all: `python -m kernel.build [--all]`."""

from __future__ import annotations

import argparse
import os
import runpy
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parent.parent
PACKAGE = ROOT / "pymunk_ellipse"


class Target(NamedTuple):
    """A platform that a library is built for: its file, the key of kernel.emit.MACHINES, the target's name for zig, and the C libraries."""

    file: str
    system: str
    processor: str
    zig: str
    libraries: Sequence[str] = ()


# The oldest glibc is that of manylinux2014.
TARGETS = (
    Target(
        "_kernel-linux-x86_64.so", "linux", "x86_64", "x86_64-linux-gnu.2.17", ["-lm"]
    ),
    Target(
        *("_kernel-linux-aarch64.so", "linux", "aarch64", "aarch64-linux-gnu.2.17"),
        ["-lm"],
    ),
    Target("_kernel-musl-x86_64.so", "linux", "x86_64", "x86_64-linux-musl", ["-lc"]),
    Target(
        "_kernel-musl-aarch64.so", "linux", "aarch64", "aarch64-linux-musl", ["-lc"]
    ),
    Target("_kernel-windows-x86_64.dll", "windows", "x86_64", "x86_64-windows-gnu"),
    Target("_kernel-macos-x86_64.dylib", "macos", "x86_64", "x86_64-macos.11.0"),
    Target("_kernel-macos-aarch64.dylib", "macos", "aarch64", "aarch64-macos.11.0"),
)


def system_compiler() -> list[str] | None:
    """The command of this machine's C compiler, None where there is none; on Windows that of the registry serves."""
    if sys.platform == "win32":
        return None
    named = os.environ.get("CC") or shutil.which("cc")
    return named.split() if named else None


# What each system's linker is told besides: that nothing may be missing but what the C library has;
# not to name the file by the folder that it was made in; and not to warn of functions that the
# header, which cffi reads too, cannot mark for export.
_SYSTEM_FLAGS = {
    "linux": ("-fPIC", "-Wl,-z,defs"),
    "macos": ("-fPIC", "-Wl,-install_name,@rpath/{file}"),
    "windows": ("-Wno-dll-attribute-on-redeclaration",),
}


def build(targets: Sequence[Target], folder: Path = PACKAGE) -> list[Path]:
    """Build the library for each target, in the package or another folder; returns their files.

    One for this machine is linked by its own C compiler, the others by the registry's (ziglang).
    """
    from kernel.emit import module
    from pymunk_ellipse.contacts.library import SUMS, digest, line_in_sums

    whole = module()
    sources = digest(PACKAGE)
    assert sources is not None
    made = []
    for target in targets:
        command = zig_compiler(target)
        if len(targets) == 1:
            command = system_compiler() or command
        made.append(_link(whole, target, command, sources, folder))
    sums = [line_in_sums(path.name, path.read_bytes()) for path in made]
    (folder / SUMS).write_bytes(b"\n".join(sums))
    return made


def zig_compiler(target: Target) -> list[str]:
    """The command of the registry's C compiler for a target."""
    return [sys.executable, "-m", "ziglang", "cc", "-target", target.zig]


def target_here() -> Target | None:
    """The target that is this machine, None if no library can be built for it."""
    names = runpy.run_path(str(PACKAGE / "contacts" / "machine.py"))
    own = names["own_library_name"]()
    return next((target for target in TARGETS if target.file == own), None)


def _link(
    whole: object, target: Target, command: list[str], sources: str, folder: Path
) -> Path:
    from kernel.emit import object_file

    place = folder / target.file
    with tempfile.TemporaryDirectory(dir=folder) as temporary:
        code = Path(temporary, "kernel.o")
        code.write_bytes(object_file(whole, target.system, target.processor))
        library = Path(temporary, place.name)
        subprocess.run(
            [
                *command,
                *("-std=c11", "-O2", "-s", "-shared", "-ffp-contract=off"),
                *(
                    flag.format(file=target.file)
                    for flag in _SYSTEM_FLAGS[target.system]
                ),
                "-fvisibility=hidden",
                f"-I{PACKAGE / 'chipmunk'}",
                f'-DDIGEST="{sources}"',
                *("-o", str(library)),
                str(ROOT / "kernel" / "library.c"),
                str(code),
                *target.libraries,
            ],
            check=True,
        )
        # A process may have the old one loaded: a new file in its place leaves that whole.
        os.replace(library, place)
    return place


def main() -> None:
    """Build what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--all", action="store_true", help="for all platforms, linked by ziglang"
    )
    targets: Sequence[Target] = TARGETS
    if not parser.parse_args().all:
        here = target_here()
        if here is None:
            sys.exit("no library can be built for this machine")
        targets = (here,)
    for path in build(targets):
        print(f"{path.name}  {path.stat().st_size} bytes")


if __name__ == "__main__":
    main()
