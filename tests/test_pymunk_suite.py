"""pymunk's own tests, which it ships, with pymunk_ellipse.Space in the place of pymunk.Space."""

import json

import pytest
from processes import run

pytest.importorskip("pymunk.tests", reason="this pymunk ships without its tests")

# Prints what became of pymunk's tests, and how many spaces of the class in question they made.
RUN = """
import importlib, importlib.util, io, json, sys, unittest
import pymunk

if sys.argv[1] == "pymunk_ellipse":
    import pymunk_ellipse
    pymunk.Space = pymunk_ellipse.Space

spaces = 0
make = pymunk.Space.__init__

def counted(self, *args, **kwargs):
    global spaces
    spaces += 1
    make(self, *args, **kwargs)

pymunk.Space.__init__ = counted

suite = unittest.TestSuite()
for name in ("space", "shape", "body", "arbiter", "batch", "constraint"):
    name = f"pymunk.tests.test_{name}"
    if importlib.util.find_spec(name):
        suite.addTest(unittest.defaultTestLoader.loadTestsFromName(name))
output = sys.stdout
sys.stdout = io.StringIO()
result = unittest.TextTestRunner(stream=sys.stderr).run(suite)
sys.stdout = output
print(json.dumps({
    "tests": result.testsRun,
    "spaces": spaces,
    "skipped": sorted(str(test) for test, _ in result.skipped),
    "failed": sorted(str(test) for test, _ in result.failures + result.errors),
}))
"""


def results(package):
    done = run("-c", RUN, package)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout), done.stderr


def test_pymunks_own_tests_pass():
    expected, _ = results("pymunk")
    found, report = results("pymunk_ellipse")
    assert expected["tests"] > 100
    assert not expected["failed"]
    # Nearly all: a test may name pymunk.Space in a way of its own.
    assert found.pop("spaces") > 0.9 * expected.pop("spaces") > 50
    assert found == expected, report
