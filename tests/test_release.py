"""What a release needs: one version everywhere, and links that work away from the repository."""

import re
from pathlib import Path

import pytest

import pymunk_ellipse

ROOT = Path(__file__).parent.parent


def test_one_version():
    version = pymunk_ellipse.__version__
    assert f"\nversion: {version}\n" in (ROOT / "CITATION.cff").read_text("utf-8")
    changes = (ROOT / "CHANGELOG.md").read_text("utf-8")
    assert re.findall(r"^## (\S+),", changes, re.MULTILINE)[0] == version


def test_nothing_is_listed_twice():
    changes = (ROOT / "CHANGELOG.md").read_text("utf-8")
    entries = re.findall(r"^- (.*?)(?=\n[-#\n]|\Z)", changes, re.MULTILINE | re.DOTALL)
    starts = [entry.split()[:2] for entry in entries]
    assert len(starts) > 10
    assert all(starts.count(start) == 1 for start in starts)


def test_links_of_the_readme_lead_to_the_repository():
    pytest.importorskip("hatchling")
    from kernel.metadata import readme

    text = (ROOT / "README.md").read_text("utf-8")
    there = readme(text, "https://host/owner/project", "1.2")
    links = re.findall(r'\]\(([^)]*)\)|(?:src|href)="([^"]*)"', there)
    assert len(links) > 5
    for link in map("".join, links):
        assert link.startswith(("https://", "#"))
    for image in re.findall(r"!\[[^\]]*\]\(([^)]*)\)", text):
        if not image.startswith("https:"):
            assert f"(https://host/owner/project/raw/v1.2/{image})" in there


def test_no_release_without_an_address():
    from email.message import Message

    from kernel.release import wrong_wheel

    wheel = ROOT / "README.md"
    problems = wrong_wheel(wheel, Message())
    assert next(problems) == (
        "the address of the repository is not filled in (pyproject.toml)"
    )
