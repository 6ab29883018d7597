"""Python in processes of its own, for what a crash, an environment or a first import is about."""

import os
import subprocess
import sys
import textwrap
from pathlib import Path

TESTS = Path(__file__).parent


def run(*arguments, cwd=TESTS.parent, timeout=300, without=(), **variables):
    """Run Python with these arguments, and variables of the environment besides; those named in without are unset."""
    environment = {"PYTHONPATH": str(TESTS), **os.environ, **variables}
    for name in without:
        environment.pop(name, None)
    return subprocess.run(
        [sys.executable, *map(str, arguments)],
        cwd=cwd,
        env=environment,
        capture_output=True,
        encoding="utf-8",
        timeout=timeout,
        check=False,
    )


def run_code(code, *flags, **options):
    """Run some code, which must succeed; returns what it printed and what it reported."""
    done = run(*flags, "-c", textwrap.dedent(code), **options)
    assert done.returncode == 0, f"returned {done.returncode}\n{done.stderr}"
    return done.stdout, done.stderr
