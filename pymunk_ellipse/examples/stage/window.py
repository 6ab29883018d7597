"""A scene in a window, with the mouse and the keys."""

from __future__ import annotations

import pygame

from .canvas import OUTLINE, font
from .debug_draw import SpaceCanvas
from .plane import View, size_for
from .scene import STEP, Scene

FRAMES_PER_SECOND = 60
STEPS_PER_FRAME = round(1.0 / FRAMES_PER_SECOND / STEP)
# Pixels of the scene's longer side when the window opens, and how much of the screen it may take.
SIZE = 900
SHARE = 0.8
KEYS = "N: next step     R: restart     Esc: close"
BAR = "#e4e0d6"
LINE_HEIGHT = 24
LARGEST_FONT = 22


def open_window(make: type[Scene], frames: int | None = None) -> Scene:
    """Run a scene until its window is closed, or for so many frames."""
    window = Window(make)
    clock = pygame.time.Clock()
    while window.open and (frames is None or frames > 0):
        frames = None if frames is None else frames - 1
        window.show_frame()
        clock.tick(FRAMES_PER_SECOND)
    pygame.display.quit()
    return window.scene


class Window:
    """A scene, and a bar with hints below it.

    Space stops the clock and starts it again, N lets it go one step on, R starts the scene
    again, Escape closes the window. The window can be made larger and smaller.
    """

    def __init__(self, make: type[Scene]) -> None:
        self.make = make
        self.bar = LINE_HEIGHT * (2 if make.hint else 1)
        self.screen = open_screen(make.view, self.bar)
        pygame.display.set_caption(make.__name__)
        self.open = self.running = True
        self.start()

    def start(self) -> None:
        self.scene = self.make()
        self.canvas = self.make_canvas()

    def make_canvas(self) -> SpaceCanvas:
        self.size = width, height = self.screen.get_size()
        return SpaceCanvas(self.make.view, (width, max(1, height - self.bar)))

    def show_frame(self) -> None:
        """Answer what has happened, let the time of a frame pass, and draw."""
        self.screen = pygame.display.get_surface() or self.screen
        if self.screen.get_size() != self.size:
            self.canvas = self.make_canvas()
        single = False
        for event in pygame.event.get():
            key = event.key if event.type == pygame.KEYDOWN else None
            if event.type == pygame.QUIT or key == pygame.K_ESCAPE:
                self.open = False
            elif key == pygame.K_r:
                self.start()
            elif key == pygame.K_SPACE:
                self.running = not self.running
            elif key == pygame.K_n:
                self.running, single = False, True
            else:
                self.tell_scene(event)
        for _ in range(STEPS_PER_FRAME if self.running else single):
            self.scene.step()
        self.scene.draw(self.canvas)
        self.screen.blit(self.canvas.finish(), (0, 0))
        clock_key = "Space: pause" if self.running else "PAUSED     Space: go on"
        keys = f"{clock_key}     {KEYS}"
        hint = self.make.hint
        draw_hints(self.screen, [hint, keys] if hint else [keys])
        pygame.display.flip()

    def tell_scene(self, event: pygame.event.Event) -> None:
        """Hand the mouse and the keys on to the scene."""
        if event.type in (pygame.KEYDOWN, pygame.KEYUP):
            name = pygame.key.name(event.key)
            self.scene.key(name, event.type == pygame.KEYDOWN)
        elif event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            self.scene.press(self.canvas.world(event.pos))
        elif event.type == pygame.MOUSEMOTION:
            self.scene.drag(self.canvas.world(event.pos))
        elif event.type == pygame.MOUSEBUTTONUP and event.button == 1:
            self.scene.release()


def size_on_screen(view: View) -> tuple[int, int]:
    """How large a scene is when its window opens."""
    screen_width, screen_height = pygame.display.get_desktop_sizes()[0]
    width, height = size_for(view, SIZE)
    smaller = min(1, SHARE * screen_width / width, SHARE * screen_height / height)
    return size_for(view, round(smaller * SIZE))


def open_screen(view: View, bar: int) -> pygame.Surface:
    """A window for a scene and a bar below it, or an end with a clear word where there is no screen."""
    try:
        pygame.display.init()
        width, height = size_on_screen(view)
        height += bar
        return pygame.display.set_mode((width, height), pygame.RESIZABLE)
    except pygame.error as error:
        raise SystemExit(
            f"A window cannot be opened ({error}). Without --window a picture and an animation are left."
        ) from None


def draw_hints(screen: pygame.Surface, hints: list[str]) -> None:
    """Write the hints below the scene, as large as they fit."""
    width, height = screen.get_size()
    top = height - LINE_HEIGHT * len(hints)
    screen.fill(BAR, (0, top, width, height - top))
    for i, hint in enumerate(hints):
        size = LARGEST_FONT
        while font(size).size(hint)[0] > width - 8 and size > 8:
            size -= 1
        drawn = font(size).render(hint, True, OUTLINE)
        middle = width / 2, top + (i + 0.5) * LINE_HEIGHT
        screen.blit(drawn, drawn.get_rect(center=middle))
