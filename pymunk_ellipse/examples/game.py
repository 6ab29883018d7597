"""A playable prototype: roll an egg over hills and stones to the flag, collect coins, save and load."""

from __future__ import annotations

import os
import pickle
from collections.abc import Callable
from dataclasses import dataclass
from math import cos, hypot, pi, sin
from pathlib import Path
from typing import Any

import pymunk
from pymunk import Arbiter, Vec2d

from pymunk_ellipse import Ellipse, Space

# Before pygame is imported: no greeting among the numbers.
os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
import pygame

STEP = 1.0 / 120.0
# A frame that took longer slows the game down instead of having ever more steps to catch up with.
LONGEST_FRAME = 0.1
WIDTH, HEIGHT = 960, 320
START = Vec2d(60, 80)
PLAYER, COIN, FLAG = 1, 2, 3
SPIN, TORQUE, JUMP = 14.0, 9e5, 330.0
OUTLINE = "#30343b"
COLORS = {PLAYER: "#f2c14e", COIN: "#edae49", FLAG: "#66a182"}


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
        self.won = False
        self.taken: list[pymunk.Shape] = []
        # Time that has passed but is not stepped yet, and where everything was a step ago.
        self.rest = 0.0
        self.before: dict[pymunk.Body, tuple[Vec2d, float]] = {}

        ground = self.space.static_body
        for left, right, top in ((0, 330, 40), (400, 680, 40), (800, 960, 90)):
            corners = (left, -60), (right, -60), (right, top), (left, top)
            self.add(pymunk.Poly(ground, corners))
        for x in (0, WIDTH):
            self.add(pymunk.Segment(ground, (x, 0), (x, HEIGHT), 2))
        for x, y, a, b, angle in (
            (200, 35, 60, 22, 0.0),
            (540, 35, 90, 40, 0.0),
            (365, 70, 24, 7, 0.2),
        ):
            self.add(Ellipse(ground, a, b, (x, y), angle))
        for x in (640, 655):
            self.add_body(x, 52, 9, 7)
        # A bridge that tips: an ellipse on a pivot.
        bridge = self.add_body(740, 72, 58, 7)
        bridge.mass = 3
        pivot = pymunk.PivotJoint(ground, bridge.body, (740, 72))
        level = pymunk.DampedRotarySpring(ground, bridge.body, -0.1, 4e5, 2e4)
        self.space.add(pivot, level)
        for x, y in ((200, 75), (365, 110), (540, 95), (740, 150), (850, 120)):
            self.add_sensor(x, y, 7, 10, COIN)
        self.add_sensor(925, 115, 8, 24, FLAG)

        self.player = self.add_body(START.x, START.y, 18, 13)
        self.player.collision_type = PLAYER
        # The rays of queries start within the egg and must not hit it.
        self.player.filter = pymunk.ShapeFilter(group=PLAYER)
        self.space.on_collision(PLAYER, COIN, begin=self.take_coin)
        self.space.on_collision(PLAYER, FLAG, begin=self.reach_flag)

    def add(self, shape: pymunk.Shape) -> None:
        shape.friction = 1
        self.space.add(shape)

    def add_sensor(self, x: float, y: float, a: float, b: float, kind: int) -> None:
        sensor = Ellipse(self.space.static_body, a, b, (x, y))
        sensor.sensor = True
        sensor.collision_type = kind
        self.add(sensor)

    def add_body(self, x: float, y: float, a: float, b: float) -> Ellipse:
        body = pymunk.Body()
        body.position = x, y
        shape = Ellipse(body, a, b)
        shape.density = 0.002
        self.space.add(body)
        self.add(shape)
        return shape

    def take_coin(self, arbiter: Arbiter, space: pymunk.Space, data: Any) -> None:
        # Nothing can be removed during a step: it is noted, and done after it.
        self.taken.append(arbiter.shapes[1])

    def reach_flag(self, arbiter: Arbiter, space: pymunk.Space, data: Any) -> None:
        self.won = True

    def sees(self, start: Vec2d, way: tuple[float, float]) -> bool:
        """Whether anything solid is in the way from a point on."""
        seen = self.space.segment_query(start, start + way, 0, self.player.filter)
        return any(not hit.shape.sensor for hit in seen)

    def stands(self) -> bool:
        """Whether there is ground right below the egg."""
        body = self.player.body
        height = hypot(self.player.a * sin(body.angle), self.player.b * cos(body.angle))
        return self.sees(body.position, (0, -height - 3))

    def step(self, controls: Controls) -> None:
        self.before = {body: (body.position, body.angle) for body in self.space.bodies}
        body = self.player.body
        if (
            abs(body.angular_velocity) < SPIN
            or controls.roll * body.angular_velocity > 0
        ):
            body.torque = -controls.roll * TORQUE * body.mass / 1e2
        if controls.jump and self.stands():
            body.velocity = body.velocity.x, JUMP
        self.space.step(STEP)
        self.steps += 1
        self.coins += len(self.taken)
        self.space.remove(*self.taken)
        self.taken.clear()
        if body.position.y < -50:
            self.falls += 1
            body.position, body.velocity, body.angular_velocity = START, (0, 0), 0
            self.space.reindex_shapes_for_body(body)
            self.before.pop(body)

    def advance(self, elapsed: float, control: Callable[[Game], Controls]) -> None:
        """Let this much time pass (seconds), in steps that are all of one length."""
        self.rest += min(elapsed, LONGEST_FRAME)
        while self.rest >= STEP:
            self.rest -= STEP
            self.step(control(self))

    def pose(self, body: pymunk.Body) -> tuple[Vec2d, float]:
        """Position and angle to draw a body with: between two steps, as far as time is."""
        position, angle = self.before.get(body, (body.position, body.angle))
        part = self.rest / STEP
        return (
            position.interpolate_to(body.position, part),
            angle + part * (body.angle - angle),
        )


def draw(game: Game, screen: pygame.Surface) -> None:
    """Everything where it is between two steps, ellipses with their true outlines."""
    screen.fill("#dcecef")
    for shape in game.space.shapes:
        position, angle = game.pose(shape.body)
        fixed = shape.body.body_type == pymunk.Body.STATIC
        color = COLORS.get(shape.collision_type, "#7d8f69" if fixed else "#b08968")
        if isinstance(shape, pymunk.Segment):
            pygame.draw.line(screen, color, pixel(shape.a), pixel(shape.b), 4)
            continue
        if isinstance(shape, Ellipse):
            angles = [2 * pi * i / 64 for i in range(64)]
            around = [Vec2d(shape.a * cos(t), shape.b * sin(t)) for t in angles]
            local = [shape.offset + point.rotated(shape.angle) for point in around]
        else:
            local = shape.get_vertices()
        outline = [pixel(position + point.rotated(angle)) for point in local]
        pygame.draw.polygon(screen, color, outline)
        pygame.draw.aalines(screen, OUTLINE, True, outline)
        if not fixed:
            pygame.draw.aaline(screen, OUTLINE, pixel(position), outline[0])
    state = "You made it! " if game.won else ""
    text = f"{state}coins {game.coins}   falls {game.falls}   {game.steps * STEP:.1f} s"
    screen.blit(pygame.font.Font(None, 28).render(text, True, OUTLINE), (14, 10))


def pixel(point: tuple[float, float]) -> tuple[float, float]:
    return point[0], HEIGHT - point[1]


def keys(game: Game) -> Controls:
    pressed = pygame.key.get_pressed()
    return Controls(
        pressed[pygame.K_RIGHT] - pressed[pygame.K_LEFT], pressed[pygame.K_SPACE]
    )


def autopilot(game: Game) -> Controls:
    """Rolls to the right, and jumps where rays see a gap in the ground or a step ahead."""
    position = game.player.body.position
    gap = not game.sees(position + Vec2d(30, 0), (0, -90))
    wall = game.sees(position, (30, 0))
    return Controls(roll=1.0, jump=gap or wall)


def play() -> None:
    """Play with the arrow keys and the space bar; S saves, L loads, R starts again, Escape leaves."""
    pygame.init()
    screen = pygame.display.set_mode((WIDTH, HEIGHT))
    pygame.display.set_caption(
        "arrows: roll, space: jump, S: save, L: load, R: restart"
    )
    clock = pygame.time.Clock()
    game = Game()
    saved = pickle.dumps(game)
    while True:
        for event in pygame.event.get():
            key = event.key if event.type == pygame.KEYDOWN else None
            if event.type == pygame.QUIT or key == pygame.K_ESCAPE:
                pygame.quit()
                return
            if key == pygame.K_s:
                saved = pickle.dumps(game)
            elif key == pygame.K_l:
                game = pickle.loads(saved)
            elif key == pygame.K_r:
                game = Game()
        game.advance(clock.tick(60) / 1000, keys)
        draw(game, screen)
        pygame.display.flip()


def run(out: Path, quick: bool, window: bool = False) -> None:
    """Play in a window, or let the autopilot play without one; a quick run is the same, it takes seconds."""
    if window:
        play()
        return
    pygame.font.init()
    screen = pygame.Surface((WIDTH, HEIGHT))
    game = Game()
    until(game, lambda: game.coins == 2, 120)
    draw(game, screen)
    pygame.image.save(screen, out / "game.png")

    # Saved in mid-air, the game goes on as it would have, at any frame rate.
    loaded = pickle.loads(pickle.dumps(game))
    later = game.steps + round(1.0 / STEP)
    until(game, lambda: game.steps == later, 120)
    until(loaded, lambda: loaded.steps == later, 144)
    eggs = [one.player.body.position for one in (game, loaded)]
    until(game, lambda: game.won, 120)
    print(f"flag reached: {int(game.won)}")
    print(f"coins: {game.coins}")
    print(f"falls: {game.falls}")
    print(f"seconds: {game.steps * STEP:.2f}")
    apart = eggs[0].get_distance(eggs[1])
    print(f"distance to the egg of the loaded game, a second later: {apart:.3g}")
    print(f"picture: {out / 'game.png'}")


def until(game: Game, done: Callable[[], bool], frames_per_second: int) -> None:
    """Let the autopilot play until something is so, or for half a minute."""
    while not done() and game.steps < 30.0 / STEP:
        # No more than one step in a frame, so that none is missed.
        game.advance(1 / frames_per_second, autopilot)
