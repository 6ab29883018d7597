"""Refuses a release that is not fit to be published, and writes the recipe for conda-forge of one that is: `python -m kernel.release dist`."""

from __future__ import annotations

import hashlib
import re
import sys
import tarfile
import zipfile
from collections.abc import Iterator
from email.message import Message
from email.parser import Parser
from pathlib import Path

from kernel.build import ROOT, TARGETS

LARGEST_LIBRARY = 150_000
LARGEST_WHEEL = 1_000_000


def wrong_sources(version: str) -> Iterator[str]:
    """What is wrong with the files that name a version."""
    changes = (ROOT / "CHANGELOG.md").read_text("utf-8")
    newest = re.search(r"^## (.*)$", changes, re.MULTILINE)
    heading = newest[1] if newest else "nothing"
    if not re.fullmatch(rf"{re.escape(version)}, \d{{4}}-\d\d-\d\d", heading):
        yield f"CHANGELOG.md begins with {heading!r}, not with {version} and its day"
    citation = (ROOT / "CITATION.cff").read_text("utf-8")
    if f"\nversion: {version}\n" not in citation:
        yield f"CITATION.cff is not of {version}"


def wrong_wheel(wheel: Path, metadata: Message) -> Iterator[str]:
    """What is wrong with a wheel."""
    if not metadata.get_all("Project-URL"):
        yield "the address of the repository is not filled in (pyproject.toml)"
    links = re.findall(r"\]\((?!https?:|#)([^)]*)\)", str(metadata.get_payload()))
    if links:
        yield f"links of the README lead nowhere on a package index: {', '.join(links)}"
    if not wheel.name.endswith("-py3-none-any.whl"):
        yield f"{wheel.name} is not for all platforms"
    if wheel.stat().st_size > LARGEST_WHEEL:
        yield f"{wheel.name} has {wheel.stat().st_size} bytes"
    with zipfile.ZipFile(wheel) as archive:
        sizes = {Path(info.filename).name: info.file_size for info in archive.filelist}
    for target in TARGETS:
        size = sizes.get(target.file)
        if size is None:
            yield f"{target.file} is missing"
        elif size > LARGEST_LIBRARY:
            yield f"{target.file} has {size} bytes"


def wrong_sdist(sdist: Path) -> Iterator[str]:
    """What is wrong with an sdist."""
    with tarfile.open(sdist) as archive:
        for name in archive.getnames():
            if "_kernel-" in name:
                yield f"{name} is compiled, and in the sdist"


def metadata_of(wheel: Path) -> Message:
    """What a wheel says of itself."""
    with zipfile.ZipFile(wheel) as archive:
        (name,) = (n for n in archive.namelist() if n.endswith(".dist-info/METADATA"))
        return Parser().parsestr(archive.read(name).decode("utf-8"))


def recipe(sdist: Path, metadata: Message) -> str:
    """The recipe for conda-forge, filled in."""
    addresses = dict(url.split(", ", 1) for url in metadata.get_all("Project-URL", []))
    text = (ROOT / "recipe" / "recipe.yaml").read_text("utf-8")
    for name, value in (
        ("VERSION", str(metadata["Version"])),
        ("REPOSITORY", addresses["Source"]),
        ("SHA256", hashlib.sha256(sdist.read_bytes()).hexdigest()),
    ):
        text = text.replace(f"@{name}@", value)
    return text


def main() -> None:
    """Check the folder that the command line names."""
    dist = Path(sys.argv[1])
    (wheel,) = dist.glob("*.whl")
    (sdist,) = dist.glob("*.tar.gz")
    metadata = metadata_of(wheel)
    wrong = [
        *wrong_sources(str(metadata["Version"])),
        *wrong_wheel(wheel, metadata),
        *wrong_sdist(sdist),
    ]
    if wrong:
        sys.exit("\n".join(["not fit to be released:", *wrong]))
    (dist / "recipe.yaml").write_text(recipe(sdist, metadata), "utf-8")
    print(f"fit to be released: {wheel.name}, {sdist.name}, recipe.yaml")


if __name__ == "__main__":
    main()
