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
    """A platform that a library is built for: its file, the key of kernel.emit.MACHINES, and what the linker needs."""

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


def build(targets: Sequence[Target]) -> list[Path]:
    """Build the library for each target; returns their files.

    One for this machine is linked by its own C compiler, the others by the registry's (ziglang).
    """
    from kernel.emit import module
    from pymunk_ellipse.contacts.library import SUMS, digest, line_in_sums

    whole = module()
    sources = digest(PACKAGE)
    assert sources is not None
    zig = [sys.executable, "-m", "ziglang", "cc"]
    made = []
    for target in targets:
        command = [*zig, "-target", target.zig]
        if len(targets) == 1:
            command = system_compiler() or zig
        made.append(_link(whole, target, command, sources))
    sums = [line_in_sums(path.name, path.read_bytes()) for path in made]
    (PACKAGE / SUMS).write_bytes(b"\n".join(sums))
    return made


def target_here() -> Target | None:
    """The target that is this machine, None if no library can be built for it."""
    names = runpy.run_path(str(PACKAGE / "contacts" / "machine.py"))
    own = names["own_library_name"]()
    return next((target for target in TARGETS if target.file == own), None)


def _link(whole: object, target: Target, command: list[str], sources: str) -> Path:
    from kernel.emit import object_file

    place = PACKAGE / target.file
    with tempfile.TemporaryDirectory(dir=place.parent) as folder:
        code = Path(folder, "kernel.o")
        code.write_bytes(object_file(whole, target.system, target.processor))
        library = Path(folder, place.name)
        subprocess.run(
            [
                *command,
                *("-std=c11", "-O2", "-s", "-shared", "-ffp-contract=off"),
                *(() if target.system == "windows" else ("-fPIC",)),
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
