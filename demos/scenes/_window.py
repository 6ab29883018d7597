"""A scene in a pygame window, with the mouse."""

from __future__ import annotations

import pygame
from pymunk import Vec2d
from pymunk.pygame_util import DrawOptions

from ._canvas import BACKGROUND, OUTLINE, Colors, camera, color
from ._scene import STEP, Scene

FRAMES_PER_SECOND = 60
STEPS_PER_FRAME = round(1.0 / FRAMES_PER_SECOND / STEP)
# Pixels of the longer side.
SIZE = 900


class _Colored(Colors, DrawOptions):
    """pymunk's own drawing on pygame, in the gallery's colours."""


def open_window(make: type[Scene], frames: int | None = None) -> Scene:
    """Run a scene until its window is closed, or for so many frames; R starts it again, Escape closes it."""
    left, bottom, right, top = make.view
    scale = SIZE / max(right - left, top - bottom)
    pygame.init()
    screen = pygame.display.set_mode(
        (round(scale * (right - left)), round(scale * (top - bottom)))
    )
    pygame.display.set_caption(f"{make.__name__}: R to restart, Escape to leave")
    options = _Colored(screen)
    options.transform = camera(make.view, scale)
    options.flags = options.DRAW_SHAPES | options.DRAW_CONSTRAINTS
    options.shape_outline_color = options.constraint_color = color(OUTLINE)
    clock = pygame.time.Clock()
    scene = make()
    while frames is None or frames > 0:
        frames = None if frames is None else frames - 1
        for event in pygame.event.get():
            key = event.key if event.type == pygame.KEYDOWN else None
            if event.type == pygame.QUIT or key == pygame.K_ESCAPE:
                frames = 0
            elif key == pygame.K_r:
                scene = make()
            elif event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
                scene.press(_in_world(event.pos, left, top, scale))
            elif event.type == pygame.MOUSEMOTION:
                scene.drag(_in_world(event.pos, left, top, scale))
            elif event.type == pygame.MOUSEBUTTONUP and event.button == 1:
                scene.release()
        for _ in range(STEPS_PER_FRAME):
            scene.step()
        screen.fill(BACKGROUND)
        scene.space.debug_draw(options)
        pygame.display.flip()
        clock.tick(FRAMES_PER_SECOND)
    pygame.quit()
    return scene


def _in_world(pixel: tuple[int, int], left: float, top: float, scale: float) -> Vec2d:
    """The point of the world that a pixel shows."""
    return Vec2d(left + pixel[0] / scale, top - pixel[1] / scale)
