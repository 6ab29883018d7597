"""The same egg drawn in a pymunk.Space and in a pymunk_ellipse.Space: as its hull, and as what it is."""

from __future__ import annotations

from pathlib import Path

import pygame
import pymunk
from pymunk.pygame_util import DrawOptions

import pymunk_ellipse
from pymunk_ellipse.examples.stage.canvas import OUTLINE, SMOOTHING, font

WIDTH, HEIGHT = 400, 260
SPACES = {
    "pymunk.Space": (pymunk.Space, "exact contacts; drawn as its hull"),
    "pymunk_ellipse.Space": (
        pymunk_ellipse.Space,
        "exact contacts, callbacks and drawing",
    ),
}


def run(out: Path, quick: bool) -> None:
    """Draw both spaces with pymunk's own drawing for pygame; a quick run is the same."""
    both = pygame.Surface((WIDTH * len(SPACES), HEIGHT))
    for i, (name, (make, meaning)) in enumerate(SPACES.items()):
        both.blit(drawn(make()), (WIDTH * i, 0))
        for line, height, y in (name, 28, 14), (meaning, 21, 42):
            text = font(height).render(line, True, OUTLINE)
            both.blit(text, text.get_rect(midtop=(WIDTH * (i + 0.46), y)))
    picture_path = out / "two_spaces.png"
    pygame.image.save(both, picture_path)
    print(f"picture: {picture_path}")


def drawn(space: pymunk.Space) -> pygame.Surface:
    """An egg that has come to rest against a wall, drawn as a user would draw it."""
    space.gravity = 0, 900
    floor = pymunk.Segment(space.static_body, (24, 232), (330, 232), 4)
    wall = pymunk.Segment(space.static_body, (330, 70), (330, 232), 4)
    body = pymunk.Body()
    body.position, body.angle = (190, 150), -0.5
    egg = pymunk_ellipse.Ellipse(body, 110, 55)
    egg.density = 0.01
    egg.friction = floor.friction = wall.friction = 1.0
    space.add(floor, wall, body, egg)
    for _ in range(480):
        space.step(1 / 240)

    large = pygame.Surface((SMOOTHING * WIDTH, SMOOTHING * HEIGHT))
    large.fill("white")
    options = DrawOptions(large)
    options.transform = pymunk.Transform.scaling(SMOOTHING)
    space.debug_draw(options)
    return pygame.transform.smoothscale(large, (WIDTH, HEIGHT))
