"""Times the steps of piles that take turns, in a process for each backend."""

from __future__ import annotations

import os
from collections.abc import Hashable, Iterable
from dataclasses import dataclass, field
from multiprocessing import get_context
from multiprocessing.connection import Connection
from statistics import median
from time import get_clock_info, perf_counter, thread_time
from typing import Generic, TypeVar

from tqdm import tqdm

from pymunk_ellipse import backend
from pymunk_ellipse.contacts.backend import VARIABLE

from ._box import STEP, MakeShape, filled_box

# How long a pile falls before it is timed (seconds of the simulation).
SETTLING = 2.0

# Where it is fine enough, the processor's time, which others that wait for a core do not share.
CLOCK = thread_time if get_clock_info("thread_time").resolution < 1e-6 else perf_counter

Name = TypeVar("Name", bound=Hashable)


@dataclass(frozen=True)
class Course:
    """How many bodies a pile has, how they hang before they fall, and how many of its steps a round has."""

    bodies: int
    columns: int
    steps_per_round: int
    seed: int = 1


@dataclass(frozen=True)
class Runner:
    """A pile to time: its shapes, how far they reach, and the backend that resolves ellipses in it.

    A pile without ellipses runs in the process of the best backend, beside the ellipses of that:
    two processes may run on cores that are not equally fast.
    """

    make_shape: MakeShape
    reach: float
    course: Course
    backend: str = field(default_factory=backend)


class Times(Generic[Name]):
    """Seconds per step of each pile in each round, and how many pairs touched in its last step."""

    def __init__(
        self, seconds: dict[Name, list[float]], contacts: dict[Name, int]
    ) -> None:
        self.seconds = seconds
        self.contacts = contacts

    def milliseconds(self, *names: Name) -> float:
        """The median of the piles' milliseconds per step."""
        return 1e3 * median(s for name in names for s in self.seconds[name])

    def ratio(self, pairs: Iterable[tuple[Name, Name]]) -> float:
        """The median over the rounds of the first pile's time by the second's, of all pairs.

        What slows the machine down for a while slows both in a round, and drops out.
        """
        return median(
            mine / theirs
            for first, second in pairs
            for mine, theirs in zip(
                self.seconds[first], self.seconds[second], strict=True
            )
        )


def race(runners: dict[Name, Runner], rounds: int) -> Times[Name]:
    """Step all piles in turn, round after round.

    Piles whose backend is not there are left out, and that is printed.
    """
    # A new interpreter for each: a backend is chosen once per process.
    context = get_context("spawn")
    processes = []
    owners: dict[Name, Connection] = {}
    for wanted in dict.fromkeys(runner.backend for runner in runners.values()):
        piles = {n: r for n, r in runners.items() if r.backend == wanted}
        ours, theirs = context.Pipe()
        process = context.Process(
            target=_run, args=(wanted, piles, theirs), daemon=True
        )
        process.start()
        theirs.close()
        processes.append((ours, process, wanted))
        owners.update(dict.fromkeys(piles, ours))
    for connection, _, wanted in processes:
        missing = connection.recv()
        if missing is not None:
            print(f"left out: the {wanted} backend ({missing})")
            owners = {n: c for n, c in owners.items() if c is not connection}

    names = [name for name in runners if name in owners]
    seconds: dict[Name, list[float]] = {name: [] for name in names}
    settling = round(SETTLING / STEP)
    turns = [(settling, name) for name in names]
    turns += [(runners[name].course.steps_per_round, name) for name in names] * rounds
    work = sum(steps * runners[name].course.bodies for steps, name in turns)
    bar = tqdm(total=work, desc="bodies x steps", unit="", unit_scale=True)
    for turn, (steps, name) in enumerate(turns):
        owners[name].send((name, steps))
        taken = owners[name].recv()
        if turn >= len(names):
            seconds[name].append(taken / steps)
        bar.update(steps * runners[name].course.bodies)
    bar.close()
    contacts: dict[Name, int] = {}
    for connection in dict.fromkeys(owners.values()):
        connection.send(None)
        contacts.update(connection.recv())
    for _, process, _ in processes:
        process.join()
    return Times(seconds, contacts)


def _run(wanted: str, runners: dict[Name, Runner], connection: Connection) -> None:
    """Build piles, say what is missing for it or None, then step them as asked for, and send the seconds taken.

    When asked for no more, send how many pairs touch in each.
    """
    os.environ[VARIABLE] = wanted
    try:
        found = backend()
    except ImportError as error:
        connection.send(str(error))
        return
    if found != wanted:
        connection.send(f"pymunk_ellipse chose {found}")
        return
    boxes = {}
    for name, runner in runners.items():
        course = runner.course
        boxes[name] = filled_box(
            runner.make_shape, runner.reach, course.bodies, course.columns, course.seed
        )
    connection.send(None)
    while (turn := connection.recv()) is not None:
        name, steps = turn
        box = boxes[name]
        start = CLOCK()
        for _ in range(steps):
            box.step()
        connection.send(CLOCK() - start)
    connection.send({name: box.count_contacts() for name, box in boxes.items()})
