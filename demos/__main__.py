"""The command line of the demos: studies and charts, and the examples of the package."""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from importlib import import_module
from inspect import signature
from pathlib import Path
from tempfile import TemporaryDirectory

from pymunk_ellipse.examples.stage.command import (
    EXAMPLES,
    SECONDS,
    add_options,
    listing,
    missing_is_named,
    purposes,
    runner,
)

HERE = Path(__file__).parent
# The options of those that sweep.
SWEEPS = "jobs", "backend", "scheduler"


def main() -> None:
    studies = purposes(HERE)
    examples = purposes(EXAMPLES)
    parser = argparse.ArgumentParser(
        prog="python -m demos",
        description="Run a demo: it prints its key numbers and leaves a picture.",
        epilog="Without a name the demos are listed.",
    )
    parser.add_argument(
        "name",
        nargs="?",
        choices=[*studies, *examples],
        metavar="NAME",
        help="the demo to run",
    )
    parser.add_argument("--list", action="store_true", help="list the demos, and stop")
    add_options(parser)
    parser.add_argument(
        "--full",
        action="store_true",
        help="the full size of what would take longer than some minutes",
    )
    parser.add_argument(
        "--jobs",
        type=int,
        metavar="N",
        help="for a sweep: how many runs at once (default: 1)",
    )
    parser.add_argument(
        "--backend",
        choices=["loky", "dask"],
        help="for a sweep: processes of this machine, or workers of Dask (default: loky)",
    )
    parser.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="for a sweep: that of a Dask cluster (default: one is started here)",
    )
    parser.add_argument(
        "--measure",
        action="store_true",
        help="run the demo, or all, and keep for --list how long each takes",
    )
    arguments = parser.parse_args()
    name = arguments.name
    if arguments.list or (name is None and not arguments.measure):
        print(listing({"Studies and charts": HERE, "Examples to copy": EXAMPLES}))
        print("The times are those of whole runs on one core; --quick takes seconds.")
        return
    if arguments.measure:
        measure([name] if name else [*studies, *examples])
        return
    sweep = {
        option: value
        for option in SWEEPS
        if (value := getattr(arguments, option)) is not None
    }
    with missing_is_named(name):
        if name in examples:
            if arguments.full or sweep:
                parser.error(f"--full and options of sweeps are not for {name}")
            run_example = runner(name)
            run_example(arguments.out, arguments.quick, arguments.window)
            return
        if arguments.window:
            parser.error(f"--window is for the examples, not for {name}")
        run = import_module(f"demos.{name}").run
        takes = signature(run).parameters
        chosen = {}
        if arguments.full:
            if "full" not in takes:
                parser.error(f"--full is not for {name}, which is of one size")
            if arguments.quick:
                parser.error("--quick and --full exclude each other")
            chosen["full"] = True
        if sweep:
            if "engine" not in takes:
                parser.error(f"--{next(iter(sweep))} is for sweeps, not for {name}")
            # Joblib is for the demos that sweep alone.
            from ._sweep import Engine

            try:
                chosen["engine"] = Engine(**sweep)
            except ValueError as error:
                parser.error(str(error))
        arguments.out.mkdir(parents=True, exist_ok=True)
        run(arguments.out, arguments.quick, **chosen)


def measure(names: list[str]) -> None:
    """Run demos, each in a process of its own, and keep its processor time, which others that wait for a core do not share."""
    for name in names:
        before = os.times()
        with TemporaryDirectory() as out:
            command = [sys.executable, "-m", "demos", name, "--out", out]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        after = os.times()
        seconds = after.children_user - before.children_user
        seconds += after.children_system - before.children_system
        folder = EXAMPLES if name in purposes(EXAMPLES) else HERE
        kept = json.loads((folder / SECONDS).read_text("utf-8"))
        kept[name] = round(seconds, 1)
        text = json.dumps(kept, indent=2, sort_keys=True) + "\n"
        (folder / SECONDS).write_text(text, "utf-8")
        print(f"{name}: {seconds:.1f} s")


if __name__ == "__main__":
    main()
