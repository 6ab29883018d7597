"""Hatchling's build hook: puts the compiled library into the wheel, or beside the sources of an editable install.

Where it cannot be built the package is installed all the same, in pure Python, and says so (to see
it, pip needs -v). Environment variables: PYMUNK_ELLIPSE_NO_LIBRARY asks for pure Python;
PYMUNK_ELLIPSE_REQUIRE_LIBRARY makes a failure fatal, for tests and releases;
PYMUNK_ELLIPSE_ALL_PLATFORMS makes one wheel with the libraries for all.
"""

from __future__ import annotations

import os
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from packaging.tags import sys_tags

sys.path.insert(0, str(Path(__file__).parent.parent))

from kernel.build import PACKAGE, TARGETS, build, system_compiler, target_here

# Numba's private side is used: one version of it, and of what it is there for. pip ends the whole
# installation where it cannot find a requirement, so it is asked for this only where it has it.
NUMBA = "numba==0.68.*"
NUMBA_PYTHONS = ("cp310", "cp311", "cp312", "cp313", "cp314", "cp315")
NUMBA_PLATFORMS = (
    "manylinux_2_27_x86_64",
    "manylinux_2_27_aarch64",
    "win_amd64",
    "macosx_12_0_arm64",
)
# Older ones are no longer to be had for every Python; 0.0.0 is a placeholder without a compiler.
ZIG = "ziglang>=0.16"


def _asked(what: str) -> bool:
    return bool(os.environ.get(f"PYMUNK_ELLIPSE_{what}"))


def _unwanted() -> str | None:
    """Why no library shall be built, None if one shall."""
    if _asked("NO_LIBRARY"):
        return "none is wanted"
    if target_here() is None and not _asked("ALL_PLATFORMS"):
        return "none can be built for this machine"
    return None


def _numba_is_for_this_python() -> bool:
    return any(
        tag.interpreter == tag.abi
        and tag.interpreter in NUMBA_PYTHONS
        and tag.platform in NUMBA_PLATFORMS
        for tag in sys_tags()
    )


def _tools() -> list[str]:
    """What numba's code is compiled and linked with."""
    needs_linker = _asked("ALL_PLATFORMS") or system_compiler() is None
    return [NUMBA, ZIG] if needs_linker else [NUMBA]


def _pip_has(requirements: list[str]) -> bool:
    """Whether pip finds all of these where it looks for packages; true where there is no pip to ask."""
    # The build's own environment is on this path, and hides pip.
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    pip = [sys.executable, "-m", "pip"]
    look = ["install", "--dry-run", "--no-deps", "--ignore-installed"]
    look += ["--only-binary", ":all:", *requirements]
    return (
        subprocess.run([*pip, "--version"], env=environment, capture_output=True)
    ).returncode != 0 or (
        subprocess.run([*pip, *look], env=environment, capture_output=True)
    ).returncode == 0


class KernelHook(BuildHookInterface[Any]):
    """Builds the library for a wheel, installed or editable."""

    def dependencies(self) -> list[str]:
        """What the build needs besides hatchling, for a wheel of a machine that can have a library."""
        if self.target_name != "wheel" or _unwanted() is not None:
            return []
        tools = _tools()
        required = _asked("REQUIRE_LIBRARY")
        if required or (_numba_is_for_this_python() and _pip_has(tools)):
            return [*tools, "pymunk>=7,<8", "numpy"]
        return []

    def clean(self, versions: list[str]) -> None:
        """Remove the libraries."""
        for path in PACKAGE.glob("_kernel-*"):
            path.unlink()

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build the library, or tell why there is none."""
        if self.target_name != "wheel":
            return
        # One that is older than the sources, or for another machine, must not be shipped.
        self.clean([version])
        try:
            unwanted = _unwanted()
            if unwanted is not None:
                raise RuntimeError(unwanted)
            here = target_here()
            made = build(
                TARGETS if _asked("ALL_PLATFORMS") or here is None else (here,)
            )
        except Exception as error:
            if _asked("REQUIRE_LIBRARY"):
                raise
            self.app.display_warning(
                f"pymunk-ellipse works in pure Python, many times slower: no compiled library ({error})"
            )
            return
        self.app.display_info(f"compiled: {', '.join(path.name for path in made)}")
        if version != "editable" and not _asked("ALL_PLATFORMS"):
            platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
            build_data["pure_python"] = False
            build_data["tag"] = f"py3-none-{platform}"
