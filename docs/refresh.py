"""Makes pictures and tables of the documentation anew: `python docs/refresh.py NAME ...`.

NAME is a demo or an example: it is run, and those of the files it leaves that are shown here, in
pictures/ or tables/, take the place of the old ones. README.md and start.rst are names as well: their
code that saves a picture is run. So is ten_minutes. To show a new file, put an empty one of its name there.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import chdir
from pathlib import Path
from tempfile import TemporaryDirectory
from textwrap import dedent

from PIL import Image, ImageSequence

DOCS = Path(__file__).parent
ROOT = DOCS.parent
FOLDERS = DOCS / "pictures", DOCS / "tables"
# Of the frames of an animation every second one is enough here.
EVERY = 2


def make(name: str, out: Path) -> None:
    """Leave the files of a demo, an example or a page in a folder."""
    if name == "ten_minutes":
        play_ten_minutes(out)
    elif name in ("README.md", "start.rst"):
        with chdir(out):
            for block in blocks_with_pictures(name):
                exec(block, {})
    else:
        command = [sys.executable, "-m", "demos", name, "--out", str(out)]
        subprocess.run(command, cwd=ROOT, check=True)


def blocks_with_pictures(page: str) -> Iterator[str]:
    """The code blocks of a page that save a figure."""
    if page.endswith(".md"):
        blocks = re.findall(
            r"^```python\n(.*?)^```", (ROOT / page).read_text("utf-8"), re.M | re.S
        )
    else:
        text = (DOCS / page).read_text("utf-8")
        blocks = re.findall(
            r"^\.\. code-block:: python\n\n((?:   .*\n|\n)+)", text, re.M
        )
    return (dedent(block) for block in blocks if "savefig" in block)


def play_ten_minutes(out: Path) -> None:
    """A picture of the small game, a little after its start."""
    import pygame
    from ten_minutes import HEIGHT, WIDTH, Game

    screen = pygame.Surface((WIDTH, HEIGHT))
    game = Game()
    for _ in range(105):
        game.advance(1 / 60, roll=1, jump=False)
    game.draw(screen)
    pygame.image.save(screen, out / "ten_minutes.png")


def compressed(animation: Path, target: Path) -> None:
    """Save a GIF as a WebP, without loss."""
    with Image.open(animation) as picture:
        pause = EVERY * picture.info["duration"]
        frames = [frame.convert("RGB") for frame in ImageSequence.Iterator(picture)]
    first, *rest = frames[::EVERY]
    first.save(
        target,
        save_all=True,
        append_images=rest,
        duration=pause,
        loop=0,
        lossless=True,
        method=6,
        minimize_size=True,
    )


def replace(left: Path) -> None:
    """Put a file that a demo has left where it is shown, if it is."""
    for folder in FOLDERS:
        for target in folder / left.name, folder / f"{left.stem}.webp":
            if not target.exists():
                continue
            if target.suffix == left.suffix:
                shutil.copy(left, target)
            elif left.suffix == ".gif":
                compressed(left, target)
            else:
                continue
            print(f"{target.relative_to(ROOT)}: {target.stat().st_size / 1000:.0f} kB")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("name", nargs="+")
    # Nobody looks at the windows.
    os.environ["SDL_VIDEODRIVER"] = os.environ["SDL_AUDIODRIVER"] = "dummy"
    os.environ["MPLBACKEND"] = "agg"
    for name in parser.parse_args().name:
        with TemporaryDirectory() as out:
            make(name, Path(out))
            for left in sorted(Path(out).iterdir()):
                replace(left)


if __name__ == "__main__":
    main()
