"""The command line of the examples: it lists them, runs them, and names what is missing."""

from __future__ import annotations

import argparse
import ast
import inspect
import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from math import ceil
from pathlib import Path
from types import ModuleType

from .scene import Scene

EXAMPLES = Path(__file__).parent.parent
PACKAGE = "pymunk_ellipse.examples"
# The extra that brings each module that some of them need.
EXTRAS = {
    "PIL": "examples",
    "dask": "cluster",
    "distributed": "cluster",
    "joblib": "demos",
    "matplotlib": "demos",
    "pygame": "examples",
    "tqdm": "examples",
}
# How long each of a folder takes, in seconds.
SECONDS = "seconds.json"


def purposes(directory: Path) -> dict[str, str]:
    """The first line of the docstring of each module in a directory, by the module's name."""
    found = {}
    for path in sorted(directory.glob("[!_]*.py")):
        # Parsed, not imported, so that the list needs none of what the modules need.
        docstring = ast.get_docstring(ast.parse(path.read_text("utf-8"))) or ""
        found[path.stem] = docstring.partition("\n")[0]
    return found


def listing(titles: dict[str, Path]) -> str:
    """What is in each directory, under its title: name, how long it takes, and purpose."""
    modules = {title: purposes(path) for title, path in titles.items()}
    width = max(len(name) for found in modules.values() for name in found)
    lines = []
    for title, found in modules.items():
        lines.append(f"{title}:")
        seconds = json.loads((titles[title] / SECONDS).read_text("utf-8"))
        for name, purpose in found.items():
            time = duration(seconds[name]) if name in seconds else ""
            lines.append(f"  {name:{width}}  {time:>6}  {purpose}")
    return "\n".join(lines)


def duration(seconds: float) -> str:
    """A time to wait, in words.

    >>> duration(0.2), duration(12.7), duration(150.0)
    ('1 s', '13 s', '3 min')
    """
    if seconds < 100:
        return f"{max(1, round(seconds))} s"
    return f"{ceil(seconds / 60)} min"


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options that all examples take."""
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
        help="open the example in a window instead",
    )


@contextmanager
def missing_is_named(name: str) -> Iterator[None]:
    """End with a clear word where a module is missing that an extra brings."""
    try:
        yield
    except ModuleNotFoundError as error:
        missing = (error.name or "").partition(".")[0]
        if missing not in EXTRAS:
            raise
        raise SystemExit(
            f"{name} needs {missing}, which is not installed. This installs it:\n"
            f'    pip install "pymunk-ellipse[{EXTRAS[missing]}]"'
        ) from None


def scene_in(module: ModuleType) -> type[Scene]:
    """The scene that a module defines."""
    (scene,) = (
        value
        for value in vars(module).values()
        if inspect.isclass(value)
        and issubclass(value, Scene)
        and value.__module__ == module.__name__
    )
    return scene


def scenes() -> dict[str, type[Scene]]:
    """All scenes by the names of their files."""
    modules = {name: import_module(f"{PACKAGE}.{name}") for name in purposes(EXAMPLES)}
    return {
        name: scene_in(module)
        for name, module in modules.items()
        if not hasattr(module, "run")
    }


def runner(name: str) -> Callable[[Path, bool, bool], None]:
    """What runs an example, given where to leave pictures, and whether quickly and in a window."""
    module = import_module(f"{PACKAGE}.{name}")
    if hasattr(module, "run"):
        run: Callable[[Path, bool, bool], None] = module.run
        return run
    scene = scene_in(module)
    return lambda out, quick, window: run_scene(scene, out, quick, window)


def run_scene(make: type[Scene], out: Path, quick: bool, window: bool) -> None:
    """Run a scene and leave pictures, or open it in a window."""
    # Imported here, so that a scene's file needs no more than pymunk until it is run.
    if window:
        from .window import open_window

        open_window(make)
    else:
        from .pictures import leave_pictures

        leave_pictures(make, out, quick)


def main(make: type[Scene]) -> None:
    """The command line of a scene's file that runs by itself."""
    parser = argparse.ArgumentParser(
        description=inspect.getdoc(inspect.getmodule(make)),
        epilog="Without --window it leaves a picture and an animation.",
    )
    add_options(parser)
    arguments = parser.parse_args()
    with missing_is_named(Path(inspect.getfile(make)).stem):
        run_scene(make, arguments.out, arguments.quick, arguments.window)
