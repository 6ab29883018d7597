"""A game in one file: roll an egg over hills, a tipping bridge and a mushroom to the flag, faster than the ghost of your best run.

It shows what a game needs around a space: a fixed time step with interpolation, callbacks that
take things away after the step, rays that look for ground, a camera, drawing by hand with
smooth edges, and games that are saved to disk. It needs pygame-ce.
"""

from __future__ import annotations

import json
import os
import pickle
import sys
from collections.abc import Callable
from dataclasses import dataclass
from math import hypot, nan, sin
from pathlib import Path
from typing import Any

import pymunk
from pymunk import Arbiter, Transform, Vec2d

from pymunk_ellipse import Ellipse, Space

# Before pygame is imported: no greeting in the terminal.
os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
try:
    import pygame
except ModuleNotFoundError:
    if __name__ == "__main__":
        sys.exit('The game needs pygame: pip install "pymunk-ellipse[examples]"')
    raise

STEP = 1.0 / 120.0
# A frame that took longer slows the game down instead of having ever more steps to catch up with.
LONGEST_FRAME = 0.1
WIDTH, HEIGHT = 960, 480
# Drawn larger and then reduced: smooth edges.
SMOOTHING = 2
LEVEL = 2860
PLAYER, COIN, FLAG, MUSHROOM = 1, 2, 3, 4
SPIN, TORQUE, JUMP, BOUNCE = 16.0, 3.2e4, 350.0, 600.0
# Each coin that is left behind costs so many seconds.
PENALTY = 3.0
# Where an egg that fell goes on: at the last of these that it had passed.
CHECKPOINTS = (70, 150), (720, 150), (1460, 180), (2020, 340), (2290, 180)
COINS = (
    *((215, 165), (400, 175), (620, 175), (900, 205), (1100, 150), (1230, 160)),
    *((1380, 160), (1560, 205), (1940, 360), (2060, 300), (2200, 300), (2480, 205)),
)
# A place of the ghost for every so many steps.
STRIDE = 6

SKY, OUTLINE, DARK = "#cfe8ef", "#30343b", "#5b6b46"
GROUND, HILL, STONE, WOOD = "#9caf78", "#86a063", "#a8a29a", "#b98a5a"
CAP, GOLD, SHELL, SPOT, CLOTH, GHOST = (
    *("#d1495b", "#f0b429", "#fff4dc", "#e8894a", "#d1495b", "#9db9c4"),
)


@dataclass(frozen=True)
class Controls:
    """What the player wants in this step: where to roll, -1 to 1, and whether to jump."""

    roll: float = 0.0
    jump: bool = False


class Game:
    """The level, what is in it, and its rules; it knows nothing of screens and keys."""

    def __init__(self) -> None:
        self.space = Space()
        self.space.gravity = 0, -600
        self.coins = self.steps = self.falls = 0
        self.checkpoint = 0
        self.won = self.bounced = False
        self.taken: list[pymunk.Shape] = []
        # Where the egg was, for the ghost of the next game.
        self.track: list[tuple[float, float, float]] = []
        # Time that has passed but is not stepped yet, and where everything was a step ago.
        self.rest = 0.0
        self.before: dict[pymunk.Body, tuple[Vec2d, float]] = {}
        self.build()

        self.egg, self.player = self.add_body(*CHECKPOINTS[0], 20, 14.5, SHELL)
        self.player.collision_type = PLAYER
        # The rays of queries start within the egg and must not hit it.
        self.player.filter = pymunk.ShapeFilter(group=PLAYER)
        self.space.on_collision(PLAYER, COIN, begin=self.take_coin)
        self.space.on_collision(PLAYER, FLAG, begin=self.reach_flag)
        self.space.on_collision(PLAYER, MUSHROOM, begin=self.bounce)

    def build(self) -> None:
        """The level: ground, hills, loose stones, a bridge, a mushroom, coins and the flag."""
        ground = self.space.static_body
        for x, y, a, b, angle in (
            (215, 100, 95, 40, 0.0),
            (900, 95, 130, 85, 0.0),
            (1100, 100, 60, 22, 0.0),
            (2480, 120, 110, 60, 0.0),
        ):
            self.add(Ellipse(ground, a, b, (x, y), angle), HILL)
        for left, right, top in (
            (0, 540, 100),
            (700, 1180, 100),
            (1430, 1920, 130),
            (1980, 2240, 280),
            (2240, LEVEL, 120),
        ):
            corners = (left, -80), (right, -80), (right, top), (left, top)
            self.add(pymunk.Poly(ground, corners), GROUND)
        for x in (-5, LEVEL + 5):
            self.add(pymunk.Segment(ground, (x, -80), (x, 2000), 5), GROUND)
        self.add(Ellipse(ground, 34, 9, (620, 112), 0.15), STONE)
        for x, a, b in ((1000, 14, 10), (1640, 40, 32), (1720, 15, 11), (2350, 17, 12)):
            self.add_body(x, 165, a, b, STONE)
        # A bridge that tips: an ellipse on a pivot.
        body, _ = self.add_body(1305, 122, 112, 9, WOOD)
        body.mass = 4
        pivot = pymunk.PivotJoint(ground, body, body.position)
        level = pymunk.DampedRotarySpring(ground, body, 0.0, 2.2e6, 1.5e5)
        self.space.add(pivot, level)
        self.add(pymunk.Segment(ground, (1880, 130), (1880, 150), 9), SHELL)
        mushroom = Ellipse(ground, 38, 18, (1880, 158))
        mushroom.collision_type = MUSHROOM
        self.add(mushroom, CAP)
        for x, y in COINS:
            self.add_sensor(x, y, 8, 11, COIN)
        self.add_sensor(2760, 165, 12, 45, FLAG)

    def add(self, shape: pymunk.Shape, color: str) -> None:
        shape.friction = 1
        shape.color = color
        self.space.add(shape)

    def add_sensor(self, x: float, y: float, a: float, b: float, kind: int) -> None:
        sensor = Ellipse(self.space.static_body, a, b, (x, y))
        sensor.sensor = True
        sensor.collision_type = kind
        self.add(sensor, GOLD)

    def add_body(
        self, x: float, y: float, a: float, b: float, color: str
    ) -> tuple[pymunk.Body, Ellipse]:
        body = pymunk.Body()
        body.position = x, y
        shape = Ellipse(body, a, b)
        shape.density = 0.002
        self.space.add(body)
        self.add(shape, color)
        return body, shape

    def take_coin(self, arbiter: Arbiter, space: pymunk.Space, data: Any) -> None:
        # Nothing can be removed during a step: it is noted, and done after it.
        self.taken.append(arbiter.shapes[1])

    def reach_flag(self, arbiter: Arbiter, space: pymunk.Space, data: Any) -> None:
        self.won = True

    def bounce(self, arbiter: Arbiter, space: pymunk.Space, data: Any) -> None:
        # The normal leads from the egg to the mushroom: down, where it lands on it.
        self.bounced = self.bounced or arbiter.normal.y < -0.5

    @property
    def seconds(self) -> float:
        """How long it has taken, with what the missing coins cost; it starts with the first move and stops at the flag."""
        missing = len(COINS) - self.coins if self.won else 0
        return self.steps * STEP + PENALTY * missing

    def sees(self, start: Vec2d, way: tuple[float, float]) -> bool:
        """Whether anything solid is in the way from a point on."""
        seen = self.space.segment_query(start, start + way, 0, self.player.filter)
        return any(hit.shape is not None and not hit.shape.sensor for hit in seen)

    def stands(self) -> bool:
        """Whether there is ground right below the egg."""
        cosine, sine = self.egg.rotation_vector
        height = hypot(self.player.a * sine, self.player.b * cosine)
        return self.sees(self.egg.position, (0, -height - 4))

    def step(self, controls: Controls) -> None:
        self.before = {body: (body.position, body.angle) for body in self.space.bodies}
        if self.won:
            controls = Controls()
        egg = self.egg
        faster = controls.roll * egg.angular_velocity < 0
        if abs(egg.angular_velocity) < SPIN or not faster:
            egg.torque = -controls.roll * TORQUE
        if controls.jump and self.stands():
            egg.velocity = egg.velocity.x, JUMP
        self.space.step(STEP)
        if self.bounced:
            egg.velocity = egg.velocity.x, BOUNCE
            self.bounced = False
        self.coins += len(self.taken)
        self.space.remove(*self.taken)
        self.taken.clear()
        if not self.won and (self.steps or controls != Controls()):
            if self.steps % STRIDE == 0:
                self.track.append((*egg.position, egg.angle))
            self.steps += 1
        passed = sum(egg.position.x >= x for x, _ in CHECKPOINTS) - 1
        self.checkpoint = max(self.checkpoint, passed)
        if egg.position.y < -40:
            self.falls += 1
            egg.position = CHECKPOINTS[self.checkpoint]
            egg.velocity, egg.angular_velocity = (0, 0), 0
            self.space.reindex_shapes_for_body(egg)
            self.before.pop(egg)

    def advance(self, elapsed: float, control: Callable[[Game], Controls]) -> None:
        """Let this much time pass (seconds), in steps that are all of one length."""
        self.rest += min(elapsed, LONGEST_FRAME)
        while self.rest >= STEP:
            self.rest -= STEP
            self.step(control(self))

    def pose(self, body: pymunk.Body) -> Transform:
        """From a body's coordinates to the world, between two steps, as far as time is."""
        position, angle = self.before.get(body, (body.position, body.angle))
        part = self.rest / STEP
        position = position.interpolate_to(body.position, part)
        return posed(position, angle + part * (body.angle - angle))


@dataclass(frozen=True)
class Best:
    """The best run so far, and where its egg was."""

    seconds: float
    track: list[tuple[float, float, float]]


class Shelf:
    """What is kept on disk: the best run, and the game that was saved last."""

    def __init__(self, folder: Path) -> None:
        self.best_file = folder / "best.json"
        self.game_file = folder / "game.pickle"

    def best(self) -> Best | None:
        try:
            return Best(**json.loads(self.best_file.read_text("utf-8")))
        except (OSError, ValueError, TypeError):
            # There is none, or it is not one that this game wrote.
            return None

    def keep_best(self, game: Game) -> None:
        """Keep a game that has been won, if none was better."""
        best = self.best()
        if best is None or game.seconds < best.seconds:
            kept = {"seconds": game.seconds, "track": game.track}
            self.best_file.write_text(json.dumps(kept), "utf-8")

    def save(self, game: Game) -> None:
        self.game_file.write_bytes(pickle.dumps(game))

    def load(self) -> Game | None:
        try:
            game = pickle.loads(self.game_file.read_bytes())
        except Exception:
            # There is none, or it was saved by a game whose classes are elsewhere.
            return None
        return game if isinstance(game, Game) else None


def posed(position: tuple[float, float], angle: float) -> Transform:
    return Transform.translation(*position) @ Transform.rotation(angle)


class Painter:
    """Draws a game: everything where it is between two steps, ellipses with their true outlines."""

    def __init__(self) -> None:
        pygame.font.init()
        self.large = pygame.Surface((SMOOTHING * WIDTH, SMOOTHING * HEIGHT))
        self.font = pygame.font.Font(None, 30)
        self.small = pygame.font.Font(None, 22)
        self.camera = Transform.identity()

    def paint(self, game: Game, best: Best | None, note: str = "") -> pygame.Surface:
        """The picture of a game, WIDTH by HEIGHT."""
        x, _ = game.pose(game.egg) @ Vec2d.zero()
        left = max(0.0, min(LEVEL - WIDTH, x - 0.4 * WIDTH))
        # From the world, whose y points up, to pixels, whose y points down.
        scale = SMOOTHING
        self.camera = Transform(scale, 0, 0, -scale, -scale * left, scale * HEIGHT)
        self.large.fill(SKY)
        if best is not None:
            self.ghost(game, best)
        for shape in game.space.shapes:
            self.shape(game, shape)
        picture = pygame.transform.smoothscale(self.large, (WIDTH, HEIGHT))
        self.texts(picture, game, best, note)
        return picture

    def polygon(self, points: list[Vec2d], color: str, edge: str = OUTLINE) -> None:
        pygame.draw.polygon(self.large, color, points)
        pygame.draw.lines(self.large, edge, True, points, 2 * SMOOTHING)

    def shape(self, game: Game, shape: pymunk.Shape) -> None:
        body = shape.body
        if body is None:
            return
        to_screen = self.camera @ game.pose(body)
        if shape.collision_type == FLAG:
            self.flag(game)
        elif isinstance(shape, Ellipse):
            # Fine enough for where the transform leads: pixels.
            self.polygon(shape.outline(to_screen), shape.color)
            if body is game.egg:
                spot = to_screen @ Transform.translation(7, 3) @ Transform.scaling(0.45)
                self.polygon(shape.outline(spot), SPOT, SPOT)
            elif body.body_type == pymunk.Body.DYNAMIC:
                # A mark, so that one sees it roll.
                ends = (
                    to_screen @ Vec2d(0.5 * shape.a, 0),
                    to_screen @ Vec2d(shape.a, 0),
                )
                pygame.draw.line(self.large, OUTLINE, *ends, 2 * SMOOTHING)
        elif isinstance(shape, pymunk.Poly):
            corners = [to_screen @ corner for corner in shape.get_vertices()]
            self.polygon(corners, shape.color)
        elif isinstance(shape, pymunk.Segment):
            ends = to_screen @ shape.a, to_screen @ shape.b
            width = round(2 * SMOOTHING * shape.radius)
            pygame.draw.line(self.large, shape.color, *ends, width)

    def flag(self, game: Game) -> None:
        foot, top = self.camera @ Vec2d(2760, 120), self.camera @ Vec2d(2760, 245)
        pygame.draw.line(self.large, OUTLINE, foot, top, 4 * SMOOTHING)
        # It waves with the clock, and stands still with it.
        waves = [5 * sin(0.12 * x - 8 * game.steps * STEP) * x / 70 for x in range(71)]
        upper = [self.camera @ Vec2d(2760 + x, 243 + w) for x, w in enumerate(waves)]
        lower = [self.camera @ Vec2d(2760 + x, 200 + w) for x, w in enumerate(waves)]
        self.polygon([*upper, *reversed(lower)], CLOTH)

    def ghost(self, game: Game, best: Best) -> None:
        """Where the egg of the best run was at this time, as an outline."""
        x, y, angle = best.track[min(game.steps // STRIDE, len(best.track) - 1)]
        outline = game.player.outline(self.camera @ posed((x, y), angle))
        self.polygon(outline, SKY, GHOST)

    def texts(
        self, picture: pygame.Surface, game: Game, best: Best | None, note: str
    ) -> None:
        known = f"   best {best.seconds:.1f} s" if best else ""
        state = f"coins {game.coins}/{len(COINS)}   {game.seconds:.1f} s{known}"
        picture.blit(self.font.render(state, True, OUTLINE), (16, 14))
        keys = "arrows: roll   space: jump   S: save   L: load   R: again   P: pause   Esc: leave"
        line = self.small.render(keys, True, OUTLINE)
        picture.blit(line, line.get_rect(topright=(WIDTH - 16, 16)))
        if game.won:
            record = best is None or game.seconds < best.seconds
            missing = len(COINS) - game.coins
            cost = (
                f", {PENALTY * missing:.0f} s of them for {missing} coins left behind"
            )
            note = (
                f"{'The best so far: ' if record else ''}{game.seconds:.1f} s"
                f"{cost if missing else ''}. R: again"
            )
        if note:
            line = self.font.render(note, True, OUTLINE, SKY)
            picture.blit(line, line.get_rect(center=(WIDTH / 2, 0.2 * HEIGHT)))


def keys(game: Game) -> Controls:
    pressed = pygame.key.get_pressed()
    right = pressed[pygame.K_RIGHT] or pressed[pygame.K_d]
    left = pressed[pygame.K_LEFT] or pressed[pygame.K_a]
    jump = pressed[pygame.K_SPACE] or pressed[pygame.K_UP] or pressed[pygame.K_w]
    return Controls(right - left, jump)


def autopilot(game: Game) -> Controls:
    """Rolls to the right, and jumps for coins and where rays see a gap in the ground, a wall, or a step that stops it."""
    position = game.egg.position
    gap = not game.sees(position + Vec2d(34, 0), (0, -110))
    step = game.sees(position, (30, 0))
    wall = step and game.sees(position + Vec2d(0, 14), (34, 0))
    stopped = step and game.egg.velocity.x < 20
    above = any(
        shape.collision_type == COIN and coin_is_above(shape.bb.center() - position)
        for shape in game.space.shapes
    )
    return Controls(roll=1.0, jump=gap or wall or stopped or above)


def coin_is_above(way: Vec2d) -> bool:
    """Whether a jump now reaches a coin that is this way from the egg."""
    return 0 < way.x < 34 and 24 < way.y < 100


def play(folder: Path | None = None) -> None:
    """Play until the window is closed. The best run and the saved game are kept in a folder, the user's own one if none is given."""
    try:
        pygame.display.init()
        screen = pygame.display.set_mode((WIDTH, HEIGHT), pygame.RESIZABLE)
    except pygame.error as error:
        sys.exit(f"A window cannot be opened: {error}")
    pygame.display.set_caption("Egg to flag")
    shelf = Shelf(folder or Path(pygame.system.get_pref_path("pymunk_ellipse", "egg")))
    painter = Painter()
    clock = pygame.time.Clock()
    game, best = Game(), shelf.best()
    welcome = f"Roll to the flag. A coin left behind costs {PENALTY:.0f} s."
    note = welcome
    paused = False
    while True:
        for event in pygame.event.get():
            key = event.key if event.type == pygame.KEYDOWN else None
            if event.type == pygame.QUIT or key == pygame.K_ESCAPE:
                pygame.display.quit()
                return
            if key == pygame.K_s:
                shelf.save(game)
                note = "Saved. L goes on from here, tomorrow as well."
            elif key == pygame.K_l:
                loaded = shelf.load()
                note = "" if loaded else "There is no saved game."
                game, paused = loaded or game, loaded is not None
            elif key == pygame.K_r:
                game, best, note = Game(), shelf.best(), ""
            elif key == pygame.K_p:
                paused = not paused
        elapsed = clock.tick(60) / 1000
        if not paused:
            running = not game.won
            game.advance(elapsed, keys)
            if game.won and running:
                shelf.keep_best(game)
            if note == welcome and game.seconds > 4:
                note = ""
        picture = painter.paint(game, best, "P: go on" if paused else note)
        show(picture, screen)


def show(picture: pygame.Surface, screen: pygame.Surface) -> None:
    """Show a picture as large as it fits into the window."""
    width, height = screen.get_size()
    scale = min(width / WIDTH, height / HEIGHT)
    size = max(1, round(scale * WIDTH)), max(1, round(scale * HEIGHT))
    screen.fill(OUTLINE)
    scaled = pygame.transform.smoothscale(picture, size)
    screen.blit(scaled, scaled.get_rect(center=(width / 2, height / 2)))
    pygame.display.flip()


def run(out: Path, quick: bool, window: bool = False) -> None:
    """Play in a window, or let the autopilot play without one and leave a picture and an animation."""
    if window:
        play()
        return
    from pymunk_ellipse.examples.stage.pictures import image, save_animation

    out.mkdir(parents=True, exist_ok=True)
    painter = Painter()
    game = Game()
    frames = []
    rate = 5 if quick else 15
    saved: bytes | None = None
    later = 0
    apart = nan
    while not game.won and game.seconds < 90:
        game.advance(1 / 60, autopilot)
        if game.steps % round(1 / STEP / rate) == 0:
            picture = painter.paint(game, None)
            frames.append(image(pygame.transform.smoothscale_by(picture, 0.5)))
        if saved is None and game.coins == 3 and not game.stands():
            pygame.image.save(painter.paint(game, None), out / "game.png")
            saved = pickle.dumps(game)
            later = game.steps + round(1 / STEP)
        elif saved is not None and game.steps == later:
            # Saved in mid-air, the game goes on as it would have, at any frame rate.
            loaded = pickle.loads(saved)
            while loaded.steps < later:
                loaded.advance(1 / 144, autopilot)
            apart = loaded.egg.position.get_distance(game.egg.position)
    save_animation(frames, out / "game.gif", 1000 // rate)
    print(f"flag reached: {int(game.won)}")
    print(f"coins, of {len(COINS)}: {game.coins}")
    print(f"falls: {game.falls}")
    print(f"seconds: {game.seconds:.2f}")
    print(f"distance to the egg of the loaded game, a second later: {apart:.3g}")
    print(f"picture: {out / 'game.png'}")
    print(f"animation: {out / 'game.gif'}")


if __name__ == "__main__":
    play()
