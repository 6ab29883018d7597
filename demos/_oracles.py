"""What mechanics says of ellipses that roll, rock, bounce and collide: by the energy, or from one event to the next."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from math import cos, hypot, inf, pi, sin, sqrt

import numpy as np

Vector = tuple[float, float]

# A rate of change of a state of several numbers.
Rate = Callable[[tuple[float, ...]], tuple[float, ...]]


def height(a: float, b: float, angle: float) -> float:
    """How high the centre of an ellipse is that lies on a floor: its support function straight down."""
    return hypot(a * sin(angle), b * cos(angle))


@cache
def gauss_legendre(nodes: int) -> tuple[list[float], list[float]]:
    """Places in (-1, 1) and weights that integrate polynomials exactly."""
    places, weights = np.polynomial.legendre.leggauss(nodes)
    return places.tolist(), weights.tolist()


def runge_kutta(
    state: tuple[float, ...], rate: Rate, seconds: float, count: int
) -> tuple[float, ...]:
    """The state some time later, by Runge and Kutta's method of fourth order in equal steps."""
    step = seconds / count

    def moved(by: tuple[float, ...], time: float) -> tuple[float, ...]:
        return tuple(x + time * dx for x, dx in zip(state, by, strict=True))

    for _ in range(count):
        k1 = rate(state)
        k2 = rate(moved(k1, step / 2.0))
        k3 = rate(moved(k2, step / 2.0))
        k4 = rate(moved(k3, step))
        mean = tuple(
            (one + 2.0 * two + 2.0 * three + four) / 6.0
            for one, two, three, four in zip(k1, k2, k3, k4, strict=True)
        )
        state = moved(mean, step)
    return state


@dataclass(frozen=True)
class Rolling:
    """An ellipse that rolls on a flat floor without slip and without leaving it.

    Its centre of gravity is at offset from its centre, along a and along b. Without a square of
    the radius of gyration it is a homogeneous ellipse about its centre.

    With h the height of the centre of gravity at an angle, the contact point is h' to the left
    of it and h below it, so that the energy of a unit of mass is (k^2 + h^2 + h'^2) w^2/2 + g h.
    """

    a: float
    b: float
    gravity: float
    offset: Vector = (0.0, 0.0)
    square: float | None = None

    def height(self, angle: float) -> float:
        """How high the centre of gravity is."""
        x, y = self.offset
        return height(self.a, self.b, angle) + x * sin(angle) + y * cos(angle)

    def slope(self, angle: float) -> float:
        """The change of the height by the angle: how far to the left of the centre of gravity the floor is touched."""
        x, y = self.offset
        across = (self.a**2 - self.b**2) * sin(angle) * cos(angle)
        lever = across / height(self.a, self.b, angle)
        return lever + x * cos(angle) - y * sin(angle)

    def inertia(self, angle: float) -> float:
        """The moment of inertia about the contact point, by the mass."""
        square = self.square
        if square is None:
            square = (self.a**2 + self.b**2) / 4.0
        return square + self.height(angle) ** 2 + self.slope(angle) ** 2

    def energy(self, angle: float, spin: float) -> float:
        """By the mass."""
        moving = self.inertia(angle) * spin * spin / 2.0
        return moving + self.gravity * self.height(angle)

    def drop(self, start: float, angle: float) -> float:
        """How much lower the centre of gravity is at the angle than at the start, without cancellation."""
        a, b = self.a, self.b
        x, y = self.offset
        half, middle = (start - angle) / 2.0, (start + angle) / 2.0
        of_center = (a * a - b * b) * sin(2.0 * half) * sin(2.0 * middle)
        of_center /= height(a, b, start) + height(a, b, angle)
        return of_center + 2.0 * sin(half) * (x * cos(middle) - y * sin(middle))

    def seconds_to_turn(self, start: float, end: float, nodes: int = 400) -> float:
        """How long it takes from one tilt, at rest, to the other.

        The energy gives w^2 = 2 g (h(start) - h(t))/(k^2 + h^2 + h'^2); with t = start + u^2
        the integrand 1/w is smooth, and Gauss and Legendre's rule converges fast.
        """
        places, weights = gauss_legendre(nodes)
        widest = sqrt(abs(end - start))
        total = 0.0
        for place, weight in zip(places, weights, strict=True):
            u = widest * (place + 1.0) / 2.0
            angle = start + u * u * (1.0 if end > start else -1.0)
            fallen = 2.0 * self.gravity * self.drop(start, angle)
            total += weight * 2.0 * u * sqrt(self.inertia(angle) / fallen)
        return total * widest / 2.0

    def period(self, tilt: float) -> float:
        """Of rocking from a tilt and back, where both sides are alike."""
        return 4.0 * self.seconds_to_turn(tilt, 0.0)

    def _rate(self, state: tuple[float, ...]) -> tuple[float, ...]:
        # Lagrange's equation I w' + I' w^2/2 + g h' = 0, with I' = 2 h' (h + h'').
        angle, spin, _way = state
        a, b = self.a, self.b
        h, slope = self.height(angle), self.slope(angle)
        # h + h'' of the ellipse is its radius of curvature; the offset has none.
        curvature_radius = (a * b) ** 2 / height(a, b, angle) ** 3
        bend = slope * curvature_radius * spin * spin
        return spin, -(bend + self.gravity * slope) / self.inertia(angle), -spin * h

    def after(
        self, angle: float, spin: float, seconds: float, count: int = 4000
    ) -> tuple[float, float, float]:
        """Angle, spin, and how far to the right the centre of gravity is, some time after it had this angle and spin."""
        end = runge_kutta((angle, spin, 0.0), self._rate, seconds, count)
        return end[0], end[1], end[2]

    def velocity(self, angle: float, spin: float) -> Vector:
        """Of the centre of gravity (x, y)."""
        return -spin * self.height(angle), spin * self.slope(angle)


@dataclass(frozen=True)
class Flyer:
    """A homogeneous ellipse in flight: its centre, the angle of a, its velocity and spin."""

    a: float
    b: float
    x: float
    y: float
    angle: float = 0.0
    vx: float = 0.0
    vy: float = 0.0
    spin: float = 0.0
    mass: float = 1.0

    @property
    def square(self) -> float:
        """Of the radius of gyration."""
        return (self.a**2 + self.b**2) / 4.0

    def after(self, seconds: float, gravity: Vector = (0.0, 0.0)) -> Flyer:
        """Some time later, if it hits nothing."""
        vx = self.vx + gravity[0] * seconds
        vy = self.vy + gravity[1] * seconds
        return replace(
            self,
            x=self.x + (self.vx + vx) / 2.0 * seconds,
            y=self.y + (self.vy + vy) / 2.0 * seconds,
            angle=self.angle + self.spin * seconds,
            vx=vx,
            vy=vy,
        )

    def energy(self, gravity: Vector = (0.0, 0.0)) -> float:
        moving = (self.vx**2 + self.vy**2 + self.square * self.spin**2) / 2.0
        return self.mass * (moving - gravity[0] * self.x - gravity[1] * self.y)

    def angular_momentum(self) -> float:
        """About the origin."""
        orbit = self.x * self.vy - self.y * self.vx
        return self.mass * (orbit + self.square * self.spin)

    def support(self, nx: float, ny: float) -> Vector:
        """From the centre to the farthest point in the direction (nx, ny)."""
        c, s = cos(self.angle), sin(self.angle)
        u, v = self.a * (c * nx + s * ny), self.b * (c * ny - s * nx)
        size = hypot(u, v)
        u *= self.a / size
        v *= self.b / size
        return c * u - s * v, s * u + c * v

    def velocity_at(self, px: float, py: float) -> Vector:
        """Of the point (px, py) from the centre."""
        return self.vx - self.spin * py, self.vy + self.spin * px

    def pushed(self, jx: float, jy: float, px: float, py: float) -> Flyer:
        """After an impulse at the point (px, py) from the centre."""
        return replace(
            self,
            vx=self.vx + jx / self.mass,
            vy=self.vy + jy / self.mass,
            spin=self.spin + (px * jy - py * jx) / (self.mass * self.square),
        )


def half_a_step_on(body: Flyer, dt: float, gravity: Vector) -> Flyer:
    """A body as Chipmunk has it: its velocity is that of half a step on.

    A step of Chipmunk moves the positions by the velocities, then changes the velocities: a
    leapfrog method. One that starts with both at one time is off by half a step ever after.
    """
    later = body.after(dt / 2.0, gravity)
    return replace(body, vx=later.vx, vy=later.vy)


def hit(
    bodies: tuple[Flyer, ...],
    normal: Vector,
    elasticity: float,
    friction: float,
) -> tuple[Flyer, ...]:
    """Two bodies, or one and what does not move, after their impact; the unit normal leads to the last from the other.

    Newton's law, as Chipmunk has it: the normal velocity is reversed, times the elasticity.
    Friction stops the tangential velocity, or brakes it by as much as the coefficient times the
    normal impulse. With both, an impact off the centre may gain energy (T. R. Kane and D. A.
    Levinson, "Dynamics: Theory and Applications", 1985).
    """
    nx, ny = normal
    tx, ty = -ny, nx
    signs = (1.0,) if len(bodies) == 1 else (-1.0, 1.0)
    struck = [
        (body, body.support(-sign * nx, -sign * ny), sign)
        for body, sign in zip(bodies, signs, strict=True)
    ]
    # By a unit of normal and of tangential impulse: the change of both relative velocities.
    nn = nt = tt = un = ut = 0.0
    for body, (px, py), sign in struck:
        across, along = px * ny - py * nx, px * ty - py * tx
        moment = body.mass * body.square
        nn += 1.0 / body.mass + across * across / moment
        nt += across * along / moment
        tt += 1.0 / body.mass + along * along / moment
        vx, vy = body.velocity_at(px, py)
        un += sign * (vx * nx + vy * ny)
        ut += sign * (vx * tx + vy * ty)
    wanted = -(1.0 + elasticity) * un
    determinant = nn * tt - nt * nt
    jn = (wanted * tt + ut * nt) / determinant
    jt = -(ut * nn + wanted * nt) / determinant
    if not abs(jt) <= friction * jn:
        # It slips, in the one direction that friction then points against.
        for coefficient in (friction, -friction):
            jn = wanted / (nn + coefficient * nt)
            jt = coefficient * jn
            if (ut + nt * jn + tt * jt) * coefficient <= 0.0:
                break
    jx, jy = jn * nx + jt * tx, jn * ny + jt * ty
    return tuple(body.pushed(sign * jx, sign * jy, *arm) for body, arm, sign in struck)


def first_root(
    function: Callable[[float], float],
    end: float,
    fastest: float = inf,
    step: float = 1e-3,
) -> float:
    """Where a function that is zero or positive at first becomes negative: infinity if it does not before the end.

    It falls by no more than fastest in a unit of its argument. A visit below zero that is
    shorter than the step may be missed.
    """
    # Not where two that part just touch: there the sign is one of roundoff.
    start = 1e-6 * step
    while start < end:
        stop = min(start + max(step, function(start) / fastest), end)
        if function(stop) < 0.0:
            # Down to neighbouring numbers.
            while start < (middle := (start + stop) / 2.0) < stop:
                if function(middle) < 0.0:
                    stop = middle
                else:
                    start = middle
            return start
        start = stop
    return inf


def time_to_floor(body: Flyer, gravity: Vector, end: float) -> float:
    """When a body that is above the floor y = 0, or leaves it, comes to it."""

    def gap(time: float) -> float:
        later = body.after(time, gravity)
        return later.y - height(body.a, body.b, later.angle)

    return first_root(gap, end)


def bouncing(
    body: Flyer, seconds: float, gravity: Vector, elasticity: float, friction: float
) -> tuple[Flyer, int]:
    """A body some time later, and how often it has hit the floor."""
    hits = 0
    while (time := time_to_floor(body, gravity, seconds)) < seconds:
        struck = (body.after(time, gravity),)
        (body,) = hit(struck, (0.0, 1.0), elasticity, friction)
        seconds -= time
        hits += 1
    return body.after(seconds, gravity), hits


def landing(body: Flyer, seconds: float, gravity: float) -> tuple[float, float, float]:
    """Angle, spin and place of a body that has landed without bounce and slip, and rolled on, some time later."""
    down = 0.0, -gravity
    time = time_to_floor(body, down, seconds)
    (landed,) = hit((body.after(time, down),), (0.0, 1.0), 0.0, inf)
    rolling = Rolling(body.a, body.b, gravity)
    angle, spin, way = rolling.after(landed.angle, landed.spin, seconds - time)
    return angle, spin, landed.x + way


def distance(first: Flyer, second: Flyer) -> tuple[float, float, float]:
    """Distance of two ellipses, or minus their penetration depth, and the unit normal from the first to the second.

    The direction in which they are farthest apart, from a look in 400 and Newton's method from
    the best of them: independent of how the package finds contacts.
    """
    turns = np.linspace(0.0, 2.0 * pi, 400, endpoint=False)
    dx, dy = second.x - first.x, second.y - first.y
    gap = dx * np.cos(turns) + dy * np.sin(turns)
    for body in (first, second):
        t = turns - body.angle
        gap -= np.hypot(body.a * np.cos(t), body.b * np.sin(t))
    turn = float(turns[np.argmax(gap)])
    for _ in range(20):
        nx, ny = cos(turn), sin(turn)
        apart = dx * nx + dy * ny
        along = dy * nx - dx * ny
        bend = 0.0
        for body, sign in ((first, 1.0), (second, -1.0)):
            px, py = body.support(sign * nx, sign * ny)
            reach = sign * (px * nx + py * ny)
            apart -= reach
            along -= sign * (py * nx - px * ny)
            bend += (body.a * body.b) ** 2 / reach**3
        turn += along / max(bend + apart, bend / 2.0)
    return apart, cos(turn), sin(turn)


def colliding(
    pair: tuple[Flyer, ...], seconds: float, elasticity: float, friction: float
) -> tuple[tuple[Flyer, ...], int]:
    """Two bodies in free flight some time later, and how often they have hit each other."""

    def later(time: float) -> tuple[Flyer, ...]:
        return tuple(body.after(time) for body in pair)

    def gap(time: float) -> float:
        first, second = later(time)
        return distance(first, second)[0]

    def fastest() -> float:
        first, second = pair
        along = hypot(second.vx - first.vx, second.vy - first.vy)
        return along + sum(body.a * abs(body.spin) for body in pair)

    hits = 0
    while (time := first_root(gap, seconds, fastest())) < seconds:
        first, second = later(time)
        _, nx, ny = distance(first, second)
        pair = hit((first, second), (nx, ny), elasticity, friction)
        seconds -= time
        hits += 1
    return later(seconds), hits
