"""Runs programs as their reader would, and reads what they print."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent

PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
GIF_SIGNATURE = b"GIF89a"
# Of a quick run, on one core.
LONGEST = 30.0


def output_of(*arguments: str | Path, cwd: Path = ROOT) -> str:
    """What Python prints when run in a directory with these arguments."""
    finished = subprocess.run(
        [sys.executable, *map(str, arguments)],
        cwd=cwd,
        capture_output=True,
        encoding="utf-8",
    )
    assert finished.returncode == 0, finished.stderr
    return finished.stdout


def quick_output(*arguments: str | Path, cwd: Path = ROOT) -> str:
    """What Python prints, and no more slowly than a quick run should."""
    before = processor_seconds()
    output = output_of(*arguments, cwd=cwd)
    assert processor_seconds() - before < LONGEST
    return output


def processor_seconds() -> float:
    """What finished processes have taken: unlike the wall clock's, not longer where others run too."""
    times = os.times()
    return times.children_user + times.children_system


def number_after(label: str, output: str) -> float:
    """The number that a line of output gives for this label."""
    found = re.search(re.escape(label) + r"[^:\n]*: ([-+.\de]+)$", output, re.M)
    assert found is not None, f"no {label!r} in:\n{output}"
    return float(found.group(1))
