"""The command line: `python -m pymunk_ellipse.examples`."""

from __future__ import annotations

import argparse

from .stage.command import (
    EXAMPLES,
    add_options,
    listing,
    missing_is_named,
    purposes,
    runner,
)


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="python -m pymunk_ellipse.examples",
        description="Run an example: it leaves a picture and an animation, or opens a window.",
        epilog="Without a name the examples are listed.",
    )
    parser.add_argument(
        "name",
        nargs="?",
        choices=purposes(EXAMPLES),
        metavar="NAME",
        help="the example to run",
    )
    parser.add_argument(
        "--list", action="store_true", help="list the examples, and stop"
    )
    add_options(parser)
    arguments = parser.parse_args()
    if arguments.list or arguments.name is None:
        print(listing({"Examples, and how long each takes": EXAMPLES}))
        print(f"Their files, to copy: {EXAMPLES}")
        return
    with missing_is_named(arguments.name):
        run = runner(arguments.name)
        run(arguments.out, arguments.quick, arguments.window)


if __name__ == "__main__":
    main()
