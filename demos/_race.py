"""Times the steps of piles that take turns, each in a process of its own."""

from __future__ import annotations

import os
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection
from statistics import median
from time import perf_counter

from tqdm import tqdm

from pymunk_ellipse import backend
from pymunk_ellipse.backend import VARIABLE

from ._box import MakeShape, filled_box


@dataclass(frozen=True)
class Runner:
    """A pile to time: its shapes, how far they reach, and the backend that resolves ellipses in it."""

    make_shape: MakeShape
    reach: float
    backend: str = "python"


@dataclass(frozen=True)
class Course:
    """How many bodies each pile has, and how it is timed."""

    bodies: int
    columns: int
    # Steps before the first is timed, so that the pile has formed.
    settling: int
    rounds: int
    steps_per_round: int


class Times:
    """Seconds per step of each pile in each round."""

    def __init__(self, seconds: dict[str, list[float]]) -> None:
        self.seconds = seconds

    def milliseconds(self, name: str) -> float:
        """The median of a pile's milliseconds per step."""
        return 1e3 * median(self.seconds[name])

    def ratio(self, name: str, other: str) -> float:
        """The median over the rounds of one pile's time by another's.

        What slows the machine down for a while slows both in a round, and drops out.
        """
        pairs = zip(self.seconds[name], self.seconds[other], strict=True)
        return median(mine / theirs for mine, theirs in pairs)


def race(runners: dict[str, Runner], course: Course) -> Times:
    """Step all piles in turn, round after round.

    A pile whose backend is not there is left out, and that is printed.
    """
    # A new interpreter for each: a backend is chosen once per process.
    context = get_context("spawn")
    piles = {}
    for name, runner in runners.items():
        ours, theirs = context.Pipe()
        process = context.Process(
            target=_run, args=(runner, course, theirs), name=name, daemon=True
        )
        process.start()
        theirs.close()
        piles[name] = ours, process
    for name in list(piles):
        missing = piles[name][0].recv()
        if missing is not None:
            print(f"left out: {name} ({missing})")
            del piles[name]

    seconds: dict[str, list[float]] = {name: [] for name in piles}
    turns = [(course.settling, name) for name in piles]
    turns += [(course.steps_per_round, name) for name in piles] * course.rounds
    bar = tqdm(total=sum(steps for steps, _ in turns), desc="steps", unit="step")
    for turn, (steps, name) in enumerate(turns):
        connection = piles[name][0]
        connection.send(steps)
        taken = connection.recv()
        if turn >= len(piles):
            seconds[name].append(taken / steps)
        bar.update(steps)
    bar.close()
    for connection, process in piles.values():
        connection.send(None)
        process.join()
    return Times(seconds)


def _run(runner: Runner, course: Course, connection: Connection) -> None:
    """Build a pile, say what is missing for it or None, then step it as asked for, and send the seconds taken."""
    os.environ[VARIABLE] = runner.backend
    try:
        found = backend()
    except ImportError as error:
        connection.send(str(error))
        return
    if found != runner.backend:
        connection.send(f"pymunk_ellipse chose {found}")
        return
    box = filled_box(runner.make_shape, runner.reach, course.bodies, course.columns)
    connection.send(None)
    while (steps := connection.recv()) is not None:
        start = perf_counter()
        for _ in range(steps):
            box.step()
        connection.send(perf_counter() - start)
