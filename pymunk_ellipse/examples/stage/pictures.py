"""Runs a scene without a window: leaves a picture, an animation and its numbers."""

from __future__ import annotations

import inspect
from pathlib import Path

import pygame
from PIL import Image
from tqdm import tqdm

from .debug_draw import SpaceCanvas
from .plane import size_for
from .scene import STEP, Scene, steps_to_picture

FRAMES_PER_SECOND = 25
QUICK_FRAMES_PER_SECOND = 5
# More would show nothing new of a few flat colours.
COLORS = 64


def leave_pictures(make: type[Scene], out: Path, quick: bool) -> None:
    """Run a scene and leave NAME.png and NAME.gif in a folder, by the name of the scene's file.

    The animation of a quick run has fewer frames; everything else is the same.
    """
    name = Path(inspect.getfile(make)).stem
    out.mkdir(parents=True, exist_ok=True)
    scene = make()
    rate = QUICK_FRAMES_PER_SECOND if quick else FRAMES_PER_SECOND
    small, large = (
        SpaceCanvas(make.view, size_for(make.view, longer))
        for longer in (make.pixels, 2 * make.pixels)
    )
    frames = []
    picture = out / f"{name}.png"
    steps_per_frame = round(1.0 / rate / STEP)
    steps = range(1, round(make.seconds / STEP) + 1)
    # No bar where nobody sees it move.
    for step in tqdm(steps, desc=name, unit="step", disable=None):
        scene.play()
        scene.step()
        if step % steps_per_frame == 0:
            frames.append(drawn(scene, small))
        if step == steps_to_picture(make):
            still = drawn(scene, large)
            quantized(still, still).save(picture, optimize=True)
    for label, number in scene.numbers().items():
        print(f"{label}: {number:.5g}")
    animation = out / f"{name}.gif"
    save_animation(frames, animation, 1000 // rate)
    print(f"picture: {picture}")
    print(f"animation: {animation}")


def drawn(scene: Scene, canvas: SpaceCanvas) -> Image.Image:
    """The scene as it is now."""
    scene.draw(canvas)
    return image(canvas.finish())


def image(surface: pygame.Surface) -> Image.Image:
    """What is on a surface of pygame."""
    pixels = pygame.image.tobytes(surface, "RGB")
    return Image.frombytes("RGB", surface.get_size(), pixels)


def save_animation(frames: list[Image.Image], path: Path, milliseconds: int) -> None:
    """Save frames as a GIF, all with the colours that a few of them have."""
    samples = frames[:: max(1, len(frames) // 4)]
    width, height = samples[0].size
    strip = Image.new("RGB", (width, height * len(samples)))
    for i, sample in enumerate(samples):
        strip.paste(sample, (0, i * height))
    first, *rest = (quantized(frame, strip) for frame in frames)
    first.save(path, save_all=True, append_images=rest, duration=milliseconds, loop=0)


def quantized(image: Image.Image, sample: Image.Image) -> Image.Image:
    """An image in the colours of a sample."""
    # Also colours that are rare, of thin lines: the usual way goes by how many pixels there are.
    palette = sample.quantize(COLORS, method=Image.Quantize.MAXCOVERAGE)
    return image.quantize(palette=palette, dither=Image.Dither.NONE)
