"""A small game: roll an egg over hills and take the coins."""

from math import hypot

import pygame
import pymunk
from pymunk import Transform, Vec2d

from pymunk_ellipse import Ellipse, Space

STEP = 1 / 120
LONGEST_FRAME = 0.1
WIDTH, HEIGHT = 900, 400
EGG, COIN = 1, 2
TORQUE, FASTEST, JUMP = 1e6, 14, 420


class Game:
    def __init__(self):
        self.space = Space()
        self.space.gravity = 0, 900  # y points down, as on pygame's screen
        self.add_level()
        self.egg = pymunk.Body()
        self.egg.position = 100, 250
        self.player = Ellipse(self.egg, a=24, b=18)
        self.player.density = 0.1
        self.player.friction = 1
        self.player.collision_type = EGG
        # One group: what looks for ground does not find the egg itself.
        self.player.filter = pymunk.ShapeFilter(group=EGG)
        self.space.add(self.egg, self.player)
        self.space.on_collision(EGG, COIN, begin=self.on_coin)
        self.taken = []
        self.score = 0
        self.rest = 0.0
        self.before = self.egg.position, self.egg.angle

    def add_level(self):
        ground = self.space.static_body
        floor = pymunk.Segment(ground, (0, 390), (WIDTH, 390), radius=10)
        walls = [
            pymunk.Segment(ground, (x, 0), (x, HEIGHT), radius=10) for x in (0, WIDTH)
        ]
        hills = [
            Ellipse(ground, a=130, b=60, offset=(330, 390)),
            Ellipse(ground, a=110, b=120, offset=(640, 410)),
        ]
        for shape in (floor, *walls, *hills):
            shape.friction = 1
            self.space.add(shape)
        for place in ((200, 330), (330, 300), (490, 345), (640, 260), (810, 345)):
            coin = Ellipse(ground, a=8, b=12, offset=place)
            coin.sensor = True
            coin.collision_type = COIN
            self.space.add(coin)

    def on_coin(self, arbiter, space, data):
        # Nothing can be removed during a step: note it, and do it afterwards.
        self.taken.append(arbiter.shapes[1])

    def stands(self):
        """Whether there is ground right below the egg."""
        cosine, sine = self.egg.rotation_vector
        height = hypot(self.player.a * sine, self.player.b * cosine)
        below = self.egg.position + Vec2d(0, height + 4)
        ground = self.space.segment_query_first(
            self.egg.position, below, 0, self.player.filter
        )
        return ground is not None and not ground.shape.sensor

    def step(self, roll, jump):
        self.before = self.egg.position, self.egg.angle
        if roll * self.egg.angular_velocity < FASTEST:
            self.egg.torque = TORQUE * roll
        if jump and self.stands():
            self.egg.velocity = self.egg.velocity.x, -JUMP
        self.space.step(STEP)
        self.space.remove(*self.taken)
        self.score += len(self.taken)
        self.taken.clear()

    def advance(self, elapsed, roll, jump):
        """Let time pass, in steps that are all of one length."""
        self.rest += min(elapsed, LONGEST_FRAME)
        while self.rest >= STEP:
            self.rest -= STEP
            self.step(roll, jump)

    def draw(self, screen):
        screen.fill("#cfe8ef")
        for shape in self.space.shapes:
            if shape is self.player:
                continue
            elif isinstance(shape, Ellipse):
                color = "#f0b429" if shape.sensor else "#86a063"
                pygame.draw.polygon(screen, color, shape.outline())
            else:
                pygame.draw.line(screen, "#5b6b46", shape.a, shape.b, 20)
        # The egg between its last two places, as far as time is between two steps.
        place, angle = self.before
        part = self.rest / STEP
        place = place.interpolate_to(self.egg.position, part)
        angle += part * (self.egg.angle - angle)
        pose = Transform.translation(*place) @ Transform.rotation(angle)
        pygame.draw.polygon(screen, "#fff4dc", self.player.outline(pose))
        pygame.draw.circle(screen, "#e8894a", pose @ (12, 0), 5)


def main():
    pygame.init()
    screen = pygame.display.set_mode((WIDTH, HEIGHT))
    font = pygame.font.Font(None, 32)
    clock = pygame.time.Clock()
    game = Game()
    while not any(event.type == pygame.QUIT for event in pygame.event.get()):
        keys = pygame.key.get_pressed()
        roll = keys[pygame.K_RIGHT] - keys[pygame.K_LEFT]
        elapsed = clock.tick(60) / 1000
        game.advance(elapsed, roll, keys[pygame.K_SPACE])
        game.draw(screen)
        screen.blit(font.render(f"coins: {game.score}", True, "black"), (24, 16))
        pygame.display.flip()
    pygame.quit()


if __name__ == "__main__":
    main()
