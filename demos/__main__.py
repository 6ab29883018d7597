"""The command line of the demos."""

from __future__ import annotations

import argparse
import ast
from importlib import import_module
from pathlib import Path


def demos() -> dict[str, str]:
    """The first line of each demo's docstring, by the demo's name."""
    found = {}
    for path in sorted(Path(__file__).parent.glob("*.py")):
        if not path.stem.startswith("_"):
            # Parsed, not imported, so that the list needs none of what the demos need.
            docstring = ast.get_docstring(ast.parse(path.read_text("utf-8"))) or ""
            found[path.stem] = docstring.partition("\n")[0]
    return found


def main() -> None:
    found = demos()
    parser = argparse.ArgumentParser(
        prog="python -m demos",
        description="Run a demo: it prints its key numbers and leaves a picture.",
    )
    parser.add_argument("name", nargs="?", choices=found, help="the demo to run")
    parser.add_argument("--list", action="store_true", help="list the demos and stop")
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
    arguments = parser.parse_args()
    if arguments.list:
        width = max(map(len, found))
        for name, purpose in found.items():
            print(f"{name:{width}}  {purpose}")
    elif arguments.name is None:
        parser.error("name a demo, or use --list to see them")
    else:
        arguments.out.mkdir(parents=True, exist_ok=True)
        import_module(f"demos.{arguments.name}").run(arguments.out, arguments.quick)


if __name__ == "__main__":
    main()
