"""The name of the compiled library for a machine; it needs nothing but Python, so that the build can ask it first."""

from __future__ import annotations

import os
import platform
import sys


def library_name(system: str, processor: str, musl: bool = False) -> str:
    """The library's file name for a system (as sys.platform says) and a processor (as platform.machine() says).

    musl tells a Linux with that C library from one with glibc.

    >>> library_name("linux", "x86_64"), library_name("darwin", "arm64")
    ('_kernel-linux-x86_64.so', '_kernel-macos-aarch64.dylib')
    """
    name = processor.lower()
    name = {"amd64": "x86_64", "arm64": "aarch64"}.get(name, name)
    if system == "win32":
        return f"_kernel-windows-{name}.dll"
    if system == "darwin":
        return f"_kernel-macos-{name}.dylib"
    return f"_kernel-{'musl' if musl else system}-{name}.so"


def own_library_name() -> str:
    """The library's file name for this machine."""
    return library_name(sys.platform, platform.machine(), has_musl())


def has_musl() -> bool:
    """Whether this is a Linux with another C library than glibc."""
    if sys.platform != "linux":
        return False
    try:
        return not os.confstr("CS_GNU_LIBC_VERSION")
    except (OSError, ValueError):
        return True
