"""Runs the compiled libraries on the same random numbers, those for other machines in emulators, and compares the results' bits: `python -m kernel.selfcheck`."""

from __future__ import annotations

import argparse
import os
import platform
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from kernel.build import (
    PACKAGE,
    ROOT,
    TARGETS,
    Target,
    system_compiler,
    target_here,
    zig_compiler,
)
from pymunk_ellipse.contacts.library import digest

# What loads the programs of each Linux, here or among the libraries of Debian's cross compilers.
_LOADERS = {
    "_kernel-linux-x86_64.so": "lib64/ld-linux-x86-64.so.2",
    "_kernel-linux-aarch64.so": "lib/ld-linux-aarch64.so.1",
    "_kernel-musl-x86_64.so": "lib/ld-musl-x86_64.so.1",
    "_kernel-musl-aarch64.so": "lib/ld-musl-aarch64.so.1",
}
_EMULATED = {"aarch64": "/usr/aarch64-linux-gnu", "x86_64": "/usr/x86_64-linux-gnu"}


class CannotRun(Exception):
    """What is missing to run a target's programs on this machine."""


def runner(target: Target) -> list[str]:
    """The start of a command that runs a program of a target on this machine.

    Raises CannotRun that says what is missing.
    """
    if target == target_here():
        return []
    if target.system == "windows":
        return [_tool("wine")]
    if target.system == "macos":
        raise CannotRun("it needs a Mac")
    if sys.platform != "linux":
        raise CannotRun("it needs a Linux")
    loader = _LOADERS[target.file]
    same = platform.machine() == target.processor
    for root in ("/", _EMULATED[target.processor]):
        if Path(root, loader).exists():
            return [] if same else [_tool(f"qemu-{target.processor}"), "-L", root]
    raise CannotRun(f"there is no /{loader}")


def _tool(name: str) -> str:
    found = shutil.which(name)
    if found is None:
        raise CannotRun(f"{name} is not installed")
    return found


def run(target: Target, library: Path) -> str:
    """What selfcheck.c prints of a library.

    Raises CannotRun where this machine has no way to run it, and CalledProcessError if it fails.
    """
    start = runner(target)
    compiler = system_compiler() if target == target_here() else None
    with tempfile.TemporaryDirectory() as temporary:
        program = Path(temporary, "selfcheck.exe")
        subprocess.run(
            [
                *(compiler or zig_compiler(target)),
                *("-std=gnu11", "-O2", "-s", "-ffp-contract=off"),
                *(("-dynamic",) if "musl" in target.zig and not compiler else ()),
                f"-I{PACKAGE / 'chipmunk'}",
                *("-o", str(program)),
                str(ROOT / "kernel" / "selfcheck.c"),
                *(("-ldl",) if target.system == "linux" else ()),
            ],
            check=True,
        )
        shutil.copy(library, temporary)
        # Wine makes its folder anew, and tells much that is of no matter here.
        apart = {"WINEPREFIX": str(Path(temporary, "wine")), "WINEDEBUG": "-all"}
        done = subprocess.run(
            [*start, str(program), f"./{library.name}"],
            cwd=temporary,
            env={**os.environ, **apart},
            stdout=subprocess.PIPE,
            text=True,
            check=True,
        )
    return done.stdout.replace("\r\n", "\n")


@contextmanager
def unpacked(where: Path) -> Iterator[Path]:
    """The folder that has the libraries; where is it, or a wheel."""
    if where.is_dir():
        yield where
        return
    with tempfile.TemporaryDirectory() as temporary, zipfile.ZipFile(where) as wheel:
        wheel.extractall(temporary)
        yield Path(temporary, PACKAGE.name)


def check(where: Path, expected: str | None = None) -> tuple[str | None, list[str]]:
    """Run all libraries in a folder or a wheel that can be run here.

    Returns the results and what is wrong. Prints which were run. expected is what another run
    gave; without it the first library's results are taken.
    """
    wrong = []
    sources = f"sources {digest(PACKAGE)}\n"
    with unpacked(where) as folder:
        for target in TARGETS:
            library = folder / target.file
            if not library.exists():
                continue
            try:
                results = run(target, library)
            except CannotRun as missing:
                print(f"{target.file}: not run, {missing}")
                continue
            except subprocess.CalledProcessError as error:
                wrong.append(f"{target.file} fails: {error}")
                continue
            if expected is None:
                expected = results
                print(results, end="")
            if not results.startswith(sources):
                wrong.append(f"{target.file} was built from other sources")
            elif results != expected:
                wrong.append(f"{target.file} gives other results:\n{results}")
            else:
                print(f"{target.file}: the same to the last bit")
    return expected, wrong


def main() -> None:
    """Check what the command line names."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "where",
        nargs="?",
        type=Path,
        default=PACKAGE,
        help="a wheel, or a folder of libraries",
    )
    parser.add_argument("--results", type=Path, help="a file to compare with, or make")
    options = parser.parse_args()
    before = None
    if options.results and options.results.exists():
        before = options.results.read_text()
    results, wrong = check(options.where, before)
    if results is None:
        wrong.append(f"no library in {options.where} could be run")
    elif options.results:
        options.results.write_text(results)
    if wrong:
        sys.exit("\n".join(wrong))


if __name__ == "__main__":
    main()
