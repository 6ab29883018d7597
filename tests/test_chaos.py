"""Random operations on spaces with ellipses: no crash, no leak, no contact of hulls, no event without its counterpart."""

import json
import os
import re
from pathlib import Path

import pytest
from processes import run

# Operations for each backend and kind of space. CHAOS=10 does ten times as many, CHAOS_SEED
# says which.
OPERATIONS = round(5000 * float(os.environ.get("CHAOS", "1")))
SEED = int(os.environ.get("CHAOS_SEED", "0"))

# The last line of a traceback.
ERROR = re.compile(r"[\w.]*(Error|Exception|Warning)\b(?!.*ignored)")

PROGRAM = Path(__file__).with_name("chaos.py")


@pytest.mark.parametrize("space", ["plain", "exact"])
@pytest.mark.parametrize("backend", ["python", "compiled"])
def test_chaos(backend, space, request):
    if backend == "compiled":
        request.getfixturevalue("built")
    # In a process of its own, so that it may crash.
    done = run(
        *(PROGRAM, space, "ellipse", OPERATIONS, SEED),
        PYMUNK_ELLIPSE_BACKEND=backend,
        timeout=120 + OPERATIONS / 10,
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
