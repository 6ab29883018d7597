"""Random operations on spaces with ellipses: no crash, no leak, no contact of hulls, no event without its counterpart."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

# Operations for each backend and kind of space. CHAOS=10 does ten times as many, CHAOS_SEED
# says which.
OPERATIONS = round(5000 * float(os.environ.get("CHAOS", "1")))
SEED = int(os.environ.get("CHAOS_SEED", "0"))

# The last line of a traceback.
ERROR = re.compile(r"[\w.]*(Error|Exception|Warning)\b(?!.*ignored)")

PROGRAM = Path(__file__).with_name("chaos.py")


@pytest.mark.parametrize("space", ["plain", "exact"])
@pytest.mark.parametrize("backend", ["python", "compiled"])
def test_chaos(backend, space):
    if backend == "compiled":
        pytest.importorskip("numba")
    # In a process of its own, so that it may crash.
    done = subprocess.run(
        [sys.executable, PROGRAM, space, "ellipse", str(OPERATIONS), str(SEED)],
        env={**os.environ, "PYMUNK_ELLIPSE_BACKEND": backend},
        capture_output=True,
        text=True,
        timeout=120 + OPERATIONS / 10,
        check=False,
    )
    assert done.returncode in (0, 1), done.stderr[-5000:]
    assert done.stdout, done.stderr[-5000:]
    report = json.loads(done.stdout)
    assert report["faults"] == {}
    assert report["backend"] == backend
    assert report["done"]["operations"] == OPERATIONS
    assert report["done"]["contacts"] > OPERATIONS
    # What callbacks raise is printed; nothing else may be raised there.
    raised = {
        line.removeprefix("__main__.")
        for line in done.stderr.splitlines()
        if line.startswith(("Mischief", "__main__.Mischief")) or ERROR.match(line)
    }
    assert raised == {"Mischief: "}
