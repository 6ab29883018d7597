"""The command line of the demos."""

from __future__ import annotations

import argparse
import ast
from importlib import import_module
from inspect import signature
from pathlib import Path

HERE = Path(__file__).parent


def purposes(directory: Path) -> dict[str, str]:
    """The first line of the docstring of each module in a directory, by the module's name."""
    found = {}
    for path in sorted(directory.glob("[!_]*.py")):
        # Parsed, not imported, so that the list needs none of what the demos need.
        docstring = ast.get_docstring(ast.parse(path.read_text("utf-8"))) or ""
        found[path.stem] = docstring.partition("\n")[0]
    return found


def main() -> None:
    demos = purposes(HERE)
    scenes = purposes(HERE / "scenes")
    parser = argparse.ArgumentParser(
        prog="python -m demos",
        description="Run a demo: it prints its key numbers and leaves a picture.",
    )
    parser.add_argument(
        "name",
        nargs="?",
        choices=[*demos, *scenes],
        metavar="NAME",
        help="the demo or scene to run, see --list",
    )
    parser.add_argument(
        "--list", action="store_true", help="list demos and scenes, and stop"
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("out"),
        metavar="DIR",
        help="where to leave the pictures (default: %(default)s)",
    )
    parser.add_argument(
        "--quick", action="store_true", help="a smaller run, in seconds"
    )
    parser.add_argument(
        "--window",
        action="store_true",
        help="open the game or a scene in a window instead",
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
    if arguments.list:
        width = max(map(len, [*demos, *scenes]))
        for title, modules in ("Demos", demos), ("Scenes of the gallery", scenes):
            print(f"{title}:")
            for module, purpose in modules.items():
                print(f"  {module:{width}}  {purpose}")
    elif name is None:
        parser.error("name a demo, or use --list to see them")
    else:
        package = "demos.scenes" if name in scenes else "demos"
        run = import_module(f"{package}.{name}").run
        takes = signature(run).parameters
        options = {
            option: value
            for option in ("jobs", "backend", "scheduler")
            if (value := getattr(arguments, option)) is not None
        }
        if arguments.window and "window" not in takes:
            parser.error(f"--window is for the game and the scenes, not for {name}")
        if options and "engine" not in takes:
            parser.error(f"--{next(iter(options))} is for sweeps, not for {name}")
        if arguments.window:
            run(arguments.out, arguments.quick, window=True)
            return
        chosen = {}
        if options:
            # Joblib is for the demos that sweep alone.
            from ._sweep import Engine

            try:
                chosen["engine"] = Engine(**options)
            except ValueError as error:
                parser.error(str(error))
        arguments.out.mkdir(parents=True, exist_ok=True)
        run(arguments.out, arguments.quick, **chosen)


if __name__ == "__main__":
    main()
