"""Imports: no modules in a circle, and no warnings."""

import ast
import graphlib
from pathlib import Path

from processes import run_code

import pymunk_ellipse

PACKAGE = Path(pymunk_ellipse.__file__).parent


def imports():
    """Each module's imports from this package, by their dotted names; those inside functions, too."""
    modules = {
        ".".join(path.relative_to(PACKAGE).with_suffix("").parts): path
        for path in PACKAGE.rglob("*.py")
    }
    # The package itself is called by nothing.
    inits = {name.removesuffix("__init__").strip("."): name for name in modules}
    graph = {name: set() for name in modules}
    for name, path in modules.items():
        package = name.split(".")[:-1]
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if not isinstance(node, ast.ImportFrom):
                continue
            named = node.module or ""
            if node.level:
                above = package[: len(package) - node.level + 1]
                source = ".".join([*above, *filter(None, [named])])
            elif named.partition(".")[0] == PACKAGE.name:
                source = named.removeprefix(PACKAGE.name).strip(".")
            else:
                continue
            # From a package comes a module of it, or what its __init__ has.
            for alias in node.names:
                submodule = f"{source}.{alias.name}".lstrip(".")
                graph[name].add(submodule if submodule in modules else inits[source])
    return graph


def test_no_circles():
    graph = imports()
    assert sum(map(len, graph.values())) > 40
    for sources in graph.values():
        assert sources <= set(graph)
    # Raises CycleError.
    tuple(graphlib.TopologicalSorter(graph).static_order())


def test_no_warnings():
    run_code("import pymunk_ellipse; pymunk_ellipse.backend()", "-W", "error")
