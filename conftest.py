"""Runs the code blocks of the README and of the documentation as tests.

The blocks of a page run in order, in an empty folder, and share their names. A block of the kind
``output`` is what the block before it prints.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, redirect_stdout
from importlib.util import find_spec
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from unittest.mock import patch

from sybil import Example, Sybil
from sybil.evaluators.python import PythonEvaluator
from sybil.parsers import markdown, rest


class Run(PythonEvaluator):
    """Runs a block, and keeps what it prints."""

    def __call__(self, example: Example) -> None:
        with redirect_stdout(StringIO()) as printed:
            super().__call__(example)
        example.document.printed = printed.getvalue()


def compare(example: Example) -> str | None:
    """What is wrong where the block before has printed something else."""
    printed = example.document.printed
    if printed.strip() == example.parsed.strip():
        return None
    return f"The page says\n{example.parsed}\nand the code prints\n{printed}"


def missing(*modules: str) -> bool:
    """Whether one of these modules is not installed, for `skip: next if(missing("pyglet"))`."""
    return any(find_spec(module) is None for module in modules)


def no_screen() -> bool:
    """Whether windows with OpenGL cannot be opened here."""
    return sys.platform.startswith("linux") and not os.environ.get("DISPLAY")


@contextmanager
def chdir(folder: str) -> Iterator[None]:
    """As contextlib.chdir, which Python 3.10 does not have."""
    before = os.getcwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)


def enter(namespace: dict[str, Any]) -> None:
    page = ExitStack()
    # Pages open windows and show figures, and nobody looks.
    variables = {
        "SDL_VIDEODRIVER": "dummy",
        "SDL_AUDIODRIVER": "dummy",
        "MPLBACKEND": "agg",
        # No greeting among what pages print.
        "PYGAME_HIDE_SUPPORT_PROMPT": "1",
    }
    page.enter_context(patch.dict(os.environ, variables))
    folder = page.enter_context(TemporaryDirectory(ignore_cleanup_errors=True))
    page.enter_context(chdir(folder))
    namespace.update(
        __name__="__main__",
        docs=Path(__file__).parent / "docs",
        missing=missing,
        no_screen=no_screen,
        _page=page,
    )


def leave(namespace: dict[str, Any]) -> None:
    namespace["_page"].close()


def collector(page: Any, patterns: list[str]) -> Sybil:
    """Finds the blocks of the pages that are written in one markup language."""
    return Sybil(
        parsers=[
            page.CodeBlockParser("python", Run()),
            page.CodeBlockParser("output", compare),
            page.SkipParser(),
        ],
        patterns=patterns,
        setup=enter,
        teardown=leave,
    )


pytest_collect_file = (
    collector(markdown, ["README.md"]) + collector(rest, ["docs/*.rst", "docs/*/*.rst"])
).pytest()

# They are programs, and have no doctests.
collect_ignore_glob = ["docs/*.py", "docs/*/*.py"]
