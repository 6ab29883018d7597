"""The command line of the demos: studies and charts, and the examples of the package."""

from __future__ import annotations

import argparse
from importlib import import_module
from inspect import signature
from pathlib import Path

from pymunk_ellipse.examples.stage.command import (
    EXAMPLES,
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
    arguments = parser.parse_args()
    name = arguments.name
    if arguments.list or name is None:
        print(listing({"Studies and charts": HERE, "Examples to copy": EXAMPLES}))
        print("The times are those of whole runs on one core; --quick takes seconds.")
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


if __name__ == "__main__":
    main()
