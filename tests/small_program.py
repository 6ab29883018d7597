"""The smallest game, to be frozen or run on the wheel alone: an egg falls on a floor. It fails if it is not compiled and quick."""

import sys
from time import perf_counter

import pymunk

import pymunk_ellipse


def main():
    space = pymunk_ellipse.Space()
    space.gravity = 0, -900
    start = perf_counter()
    body = pymunk.Body(1, pymunk_ellipse.moment_for_ellipse(1, 20, 10))
    space.add(body, pymunk_ellipse.Ellipse(body, 20, 10))
    first = perf_counter() - start
    space.add(pymunk.Segment(space.static_body, (-100, -30), (100, -30), 1))
    for _ in range(120):
        space.step(1 / 60)

    print(f"{pymunk_ellipse.backend()}, the first ellipse in {1000 * first:.1f} ms")
    assert abs(body.position.y + 19) < 0.2, body.position
    assert pymunk_ellipse.backend() == "compiled"
    assert first < 0.05
    assert not {"numba", "llvmlite"} & set(sys.modules)


if __name__ == "__main__":
    main()
