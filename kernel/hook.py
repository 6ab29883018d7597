"""Hatchling's build hook: puts the compiled library into the wheel, or beside the sources of an editable install.

Where it cannot be built the package is installed all the same, in pure Python, and says so.
Environment variables: PYMUNK_ELLIPSE_REQUIRE_LIBRARY makes a failure fatal, for tests and releases;
PYMUNK_ELLIPSE_ALL_PLATFORMS makes one wheel with the libraries for all.
"""

from __future__ import annotations

import os
import sys
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

sys.path.insert(0, str(Path(__file__).parent.parent))

from kernel.build import PACKAGE, TARGETS, build, system_compiler, target_here

# Numba's private side is used, and a later Python has no numba of this version: pip would end the
# installation where it cannot find a requirement.
NUMBA = "numba==0.68.*"
PYTHONS = ((3, 10), (3, 14))


def _every_platform() -> bool:
    return bool(os.environ.get("PYMUNK_ELLIPSE_ALL_PLATFORMS"))


def _can_build() -> bool:
    return (
        sys.implementation.name == "cpython"
        and PYTHONS[0] <= sys.version_info[:2] <= PYTHONS[1]
        and (_every_platform() or target_here() is not None)
    )


class KernelHook(BuildHookInterface[Any]):
    """Builds the library for a wheel, installed or editable."""

    def dependencies(self) -> list[str]:
        """What the build needs besides hatchling, for a wheel of a machine that can have a library."""
        if self.target_name != "wheel" or not _can_build():
            return []
        needed = [NUMBA, "pymunk>=7,<8", "numpy"]
        if _every_platform() or system_compiler() is None:
            needed.append("ziglang")
        return needed

    def clean(self, versions: list[str]) -> None:
        """Remove the libraries."""
        for path in PACKAGE.glob("_kernel-*"):
            path.unlink()

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build the library, or tell why there is none."""
        if self.target_name != "wheel":
            return
        for path in PACKAGE.glob("_kernel-*"):
            # One that is older than the sources, or for another machine, must not be shipped.
            path.unlink()
        try:
            if not _can_build():
                raise RuntimeError("none can be built by this Python on this machine")
            here = target_here()
            made = build(TARGETS if _every_platform() or here is None else (here,))
        except Exception as error:
            if os.environ.get("PYMUNK_ELLIPSE_REQUIRE_LIBRARY"):
                raise
            self.app.display_warning(
                f"pymunk-ellipse works in pure Python, many times slower: no compiled library ({error})"
            )
            return
        self.app.display_info(f"compiled: {', '.join(path.name for path in made)}")
        if version != "editable" and not _every_platform():
            platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
            build_data["pure_python"] = False
            build_data["tag"] = f"py3-none-{platform}"
