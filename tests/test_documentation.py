"""README and documentation: what they name is there. Their code blocks are run from the root's conftest.py."""

import re

import pytest
from running import GIF_SIGNATURE, ROOT

from pymunk_ellipse.examples.stage.command import EXAMPLES, purposes

DOCS = ROOT / "docs"
README = (ROOT / "README.md").read_text("utf-8")
PAGES = {
    path.relative_to(ROOT).as_posix(): path.read_text("utf-8")
    for path in [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *DOCS.rglob("*.rst")]
    if "_build" not in path.parts
}
LINKS = [link for link in re.findall(r"\]\((.*?)\)", README) if "://" not in link]


@pytest.mark.parametrize("page", PAGES)
def test_every_demo_and_example_that_a_page_names_is_there(page):
    names = {
        "demos": {*purposes(ROOT / "demos"), *purposes(EXAMPLES)},
        "pymunk_ellipse.examples": set(purposes(EXAMPLES)),
    }
    for package, name in re.findall(
        r"python -m (demos|pymunk_ellipse\.examples) ([a-z]\w*)", PAGES[page]
    ):
        assert name in names[package]


def test_every_example_has_a_page():
    pages = {path.stem for path in (DOCS / "gallery").glob("*.rst")}
    assert pages == {*purposes(EXAMPLES), "index"}


@pytest.mark.parametrize("link", LINKS)
def test_what_the_readme_links_to_is_there(link):
    assert (ROOT / link).is_file()


def test_pictures_of_the_readme_are_small():
    pictures = re.findall(r"!\[.*?\]\((.*?)\)", README)
    # The first one moves.
    assert (ROOT / pictures[0]).read_bytes().startswith(GIF_SIGNATURE)
    sizes = [(ROOT / picture).stat().st_size for picture in pictures]
    assert sizes[0] < 2_000_000
    assert max(sizes[1:]) < 200_000


def test_every_picture_and_table_is_shown():
    text = "\n".join(PAGES.values())
    for path in (*(DOCS / "pictures").iterdir(), *(DOCS / "tables").iterdir()):
        assert path.name in text
        assert 0 < path.stat().st_size < 1_000_000
