"""Configuration of the documentation: `sphinx-build -W docs docs/_build`."""

import sys
from importlib import metadata
from pathlib import Path

from sphinx.application import Sphinx

sys.path.insert(0, str(Path(__file__).parent / "extensions"))

project = "pymunk_ellipse"
author = "The pymunk_ellipse developers"
release = metadata.version("pymunk-ellipse")

extensions = [
    "mathml",
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.intersphinx",
    "sphinx.ext.viewcode",
    "sphinx_copybutton",
]
exclude_patterns = ["_build"]
html_math_renderer = "mathml"

autoclass_content = "both"
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
python_maximum_signature_line_length = 88
autodoc_default_options = {"members": True, "show-inheritance": True}
autodoc_type_aliases = {"ArrayLike": "numpy.typing.ArrayLike"}
# A name that leads nowhere is an error; those of Python and numpy are not looked up.
nitpicky = True
nitpick_ignore_regex = [("py:.*", r"(collections|numpy)\..*")]
# Fields of named tuples are not looked up where they come from.
nitpick_ignore = [("py:class", "Vec2d")]

# Read from the file, so that the build needs no network: what pymunk 7.3's own documentation lists.
intersphinx_mapping = {"pymunk": ("https://www.pymunk.org/en/latest/", "pymunk.inv")}

html_theme = "furo"
html_show_copyright = False
html_title = f"pymunk_ellipse {release}"
html_static_path = ["static"]
html_css_files = ["pages.css"]
copybutton_prompt_text = "$ "


def public_bases(
    app: Sphinx, name: str, documented: type, options: object, bases: list[type]
) -> None:
    """Name the bases that users know in place of those that only the package knows."""
    private = [base for base in bases if base.__module__.startswith("pymunk_ellipse")]
    for base in private:
        bases[bases.index(base) : bases.index(base) + 1] = base.__bases__


def no_named_tuple_text(
    app: Sphinx,
    what: str,
    name: str,
    documented: type,
    options: object,
    lines: list[str],
) -> None:
    """Leave out what Python says of the constructor of every named tuple: the signature says it."""
    lines[:] = [line for line in lines if not line.startswith("Create new instance of")]


def setup(app: Sphinx) -> None:
    app.connect("autodoc-process-bases", public_bases)
    app.connect("autodoc-process-docstring", no_named_tuple_text)
