"""What PyInstaller needs to know of the package; it finds this by an entry point."""

from __future__ import annotations


def hook_dirs() -> list[str]:
    """Where the hooks are."""
    return list(__path__)
