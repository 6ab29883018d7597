"""Configuration of the documentation: `sphinx-build -W docs docs/_build`."""

import sys
from importlib import metadata
from pathlib import Path

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
autodoc_typehints = "description"
autodoc_default_options = {"members": True, "show-inheritance": True}

# Read from the file, so that the build needs no network: what pymunk 7.3's own documentation lists.
intersphinx_mapping = {"pymunk": ("https://www.pymunk.org/en/latest/", "pymunk.inv")}

html_theme = "furo"
html_title = f"pymunk_ellipse {release}"
html_static_path = ["static"]
html_css_files = ["pages.css"]
# Names in a console, and what it answers, are not copied.
copybutton_prompt_text = "$ "
copybutton_only_copy_prompt_lines = False
