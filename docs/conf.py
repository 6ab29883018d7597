"""Configuration of the documentation: `sphinx-build docs docs/_build`."""

from importlib import metadata

project = "pymunk_ellipse"
author = "The pymunk_ellipse developers"
release = metadata.version("pymunk-ellipse")

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.mathjax",
    "sphinx.ext.viewcode",
]
exclude_patterns = ["_build"]
autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_default_options = {"members": True, "show-inheritance": True}
html_theme = "alabaster"
html_theme_options = {"description": "Exact ellipses for pymunk"}
