"""A contact sheet of the scenes in pymunk_ellipse/examples, each a small file to copy from."""

from __future__ import annotations

from pathlib import Path

from PIL import Image, ImageDraw, ImageFont
from tqdm import tqdm

from pymunk_ellipse.examples.stage.canvas import BACKGROUND, OUTLINE
from pymunk_ellipse.examples.stage.command import scenes
from pymunk_ellipse.examples.stage.debug_draw import SpaceCanvas
from pymunk_ellipse.examples.stage.pictures import drawn
from pymunk_ellipse.examples.stage.plane import size_for
from pymunk_ellipse.examples.stage.scene import steps_to_picture

COLUMNS = 6
TILE = 216
CAPTION = 22
GAP = 6
COLORS = 64


def run(out: Path, quick: bool) -> None:
    """Run each scene to the moment of its picture; a quick run is the same, it takes seconds."""
    tiles = {}
    shown = scenes()
    # A tool, whose writing could not be read.
    del shown["inspector"]
    for name, make in tqdm(shown.items(), "gallery", unit="scene", disable=None):
        scene = make()
        for _ in range(steps_to_picture(make)):
            scene.play()
            scene.step()
        tiles[name] = drawn(scene, SpaceCanvas(make.view, size_for(make.view, TILE)))
    sheet = contact_sheet(tiles).quantize(COLORS, dither=Image.Dither.NONE)
    picture = out / "gallery.png"
    sheet.save(picture, optimize=True)
    print(f"scenes: {len(tiles)}")
    print(f"picture: {picture}")


def contact_sheet(tiles: dict[str, Image.Image]) -> Image.Image:
    """Pictures in rows, each over its name."""
    rows = -(-len(tiles) // COLUMNS)
    pitch_x = TILE + GAP
    pitch_y = TILE + CAPTION + GAP
    size = COLUMNS * pitch_x + GAP, rows * pitch_y + GAP
    sheet = Image.new("RGB", size, "white")
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(14)
    for i, (name, tile) in enumerate(tiles.items()):
        x = GAP + i % COLUMNS * pitch_x
        y = GAP + i // COLUMNS * pitch_y
        draw.rectangle((x, y, x + TILE, y + TILE), fill=BACKGROUND)
        sheet.paste(tile, (x + (TILE - tile.width) // 2, y + (TILE - tile.height) // 2))
        center = x + TILE / 2, y + TILE + CAPTION / 2
        draw.text(center, name, fill=OUTLINE, font=font, anchor="mm")
    return sheet
