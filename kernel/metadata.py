"""Hatchling's metadata hook: the project's addresses, all from the one of its repository, also in the README's links."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

# A link or an image of Markdown's or of HTML's to a file of the repository.
_LINK = re.compile(r'(?P<before>(?P<image>!)?\[[^\]]*\]\(|(?P<attribute>src|href)=")')
_OUTSIDE = re.compile(r"[a-z]+:|#|/")


def addresses(repository: str) -> dict[str, str]:
    """The project's addresses on its code host."""
    return {
        "Source": repository,
        "Issues": f"{repository}/issues",
        "Changes": f"{repository}/blob/main/CHANGELOG.md",
    }


def readme(text: str, repository: str, version: str) -> str:
    """The README for a package index, which has none of the repository's files: its links lead to them.

    >>> readme("![a pile](docs/pile.png), see [how](docs/how.rst)", "https://host/us", "1.0")
    '![a pile](https://host/us/raw/v1.0/docs/pile.png), see [how](https://host/us/blob/v1.0/docs/how.rst)'
    """

    def lead(match: re.Match[str]) -> str:
        if _OUTSIDE.match(text, match.end()):
            return match.group()
        shown = match["image"] or match["attribute"] == "src"
        return f"{match.group()}{repository}/{'raw' if shown else 'blob'}/v{version}/"

    return _LINK.sub(lead, text)


class AddressHook(MetadataHookInterface):
    """Fills in the addresses; without one of the repository there are none, and links stay as they are."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Add urls and the README to the project's metadata."""
        repository = self.config["repository"]
        text = Path(self.root, "README.md").read_text("utf-8")
        if repository:
            metadata["urls"] = addresses(repository)
            text = readme(text, repository, metadata["version"])
        metadata["readme"] = {"content-type": "text/markdown", "text": text}
