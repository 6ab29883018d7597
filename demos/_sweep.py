"""Sweeps: many independent runs of a function on joblib's processes or a Dask cluster, saved as they arrive.

    runs = sweep(density, [{"aspect_ratio": 1.0}, {"aspect_ratio": 1.4}], range(5), path)

calls `density(aspect_ratio=1.0, seed=0)` and so on. The function is one of a module that
workers can import; its parameters and what it returns are what JSON can hold.

Finished runs are in the file, one a line, and are not run again by the next sweep: it goes on
where the last one stopped. Nothing in a line tells of a change in the function's code: take
another file then, or delete it. A file is for one sweep at a time.
"""

from __future__ import annotations

import json
import os
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import joblib
from tqdm import tqdm


@dataclass(frozen=True)
class Run:
    """A finished run: what the function was called with, and what it returned, as JSON holds it."""

    parameters: dict[str, Any]
    seed: int
    value: Any


@dataclass(frozen=True)
class Engine:
    """Where runs happen, and how many of them there may be at once.

    On "loky" these are processes of this machine, or the one that calls for a single job. On
    "dask" they are the workers of the scheduler at this address, or else of a cluster started
    here. Workers must be able to import the function: start them in the directory of this
    program by `python -m dask worker ADDRESS --nthreads 1` (threads would share a core).
    """

    jobs: int = 1
    backend: str = "loky"
    scheduler: str | None = None

    def __post_init__(self) -> None:
        if self.jobs < 1:
            raise ValueError(f"the number of jobs must be positive, not {self.jobs}")
        if self.scheduler is not None and self.backend != "dask":
            raise ValueError(f"a scheduler is for dask, not for {self.backend}")

    @contextmanager
    def parallel(self) -> Iterator[joblib.Parallel]:
        """Joblib's way to make calls there, whose results come as they are ready."""
        how: dict[str, Any] = {
            "n_jobs": self.jobs,
            "return_as": "generator_unordered",
            # Results of a batch would not be saved before all of it has finished.
            "batch_size": 1,
            # Joblib goes by the size of a Dask cluster, not by n_jobs: this keeps to it.
            "pre_dispatch": self.jobs,
        }
        if self.backend != "dask":
            yield joblib.Parallel(backend=self.backend, **how)
            return
        from dask.distributed import Client, LocalCluster

        from ._dask import DaskBackend

        with ExitStack() as stack:
            where: Any = self.scheduler
            if where is None:
                where = stack.enter_context(
                    LocalCluster(
                        n_workers=self.jobs,
                        threads_per_worker=1,
                        # Any free port: that of Dask's choice may be another cluster's.
                        dashboard_address="localhost:0",
                    )
                )
            client = stack.enter_context(Client(where, set_as_default=False))
            yield joblib.Parallel(backend=DaskBackend(client=client), **how)


ONE_JOB = Engine()


def failures(path: Path) -> Path:
    """The file of the runs that failed in the last sweep that saved its results in this file."""
    return path.with_suffix(".failed.jsonl")


def sweep(
    function: Callable[..., Any],
    parameters: Sequence[Mapping[str, Any]],
    seeds: Iterable[int],
    path: Path,
    engine: Engine = ONE_JOB,
) -> list[Run]:
    """Call a function for all parameters and seeds, and return the finished runs in that order.

    Runs that raise are left out, counted in what is printed, and kept in `failures(path)`
    with their tracebacks; the next sweep tries them again. Where a run's process dies, Dask
    gives the run to another, a few times; then, or on "loky" at once, that ends the sweep with
    an error, and another goes on from what was saved.
    """
    name = f"{function.__module__}.{function.__qualname__}"
    seeds = list(seeds)
    wanted = {
        _key(name, chosen, seed): (dict(chosen), seed)
        for chosen in parameters
        for seed in seeds
    }
    values = {key: v for key, v in _finished(path).items() if key in wanted}
    if values:
        print(f"runs that were in {path}, not run again: {len(values)}")
    # Written anew: what failed before is tried again.
    failures(path).unlink(missing_ok=True)
    failed = 0
    bar = tqdm(total=len(wanted), initial=len(values), desc=function.__name__)
    calls = (
        joblib.delayed(_attempt)(function, name, *run)
        for key, run in wanted.items()
        if key not in values
    )
    with (
        bar,
        engine.parallel() as parallel,
        open(path, "a", encoding="utf-8") as file,
    ):
        for succeeded, line in parallel(calls):
            if succeeded:
                file.write(line + "\n")
                file.flush()
                values.update(_read(line))
            else:
                failed += 1
                with open(failures(path), "a", encoding="utf-8") as kept:
                    kept.write(line + "\n")
            bar.update()
    if failed:
        print(f"runs that failed, in {failures(path)}: {failed}")
    return [Run(*run, values[key]) for key, run in wanted.items() if key in values]


def _key(name: str, parameters: Mapping[str, Any], seed: int) -> str:
    """What tells a run from others."""
    return json.dumps([name, parameters, seed], sort_keys=True)


def _attempt(
    function: Callable[..., Any], name: str, parameters: dict[str, Any], seed: int
) -> tuple[bool, str]:
    """In a worker: whether a run has succeeded, and its line."""
    run = {"function": name, "parameters": parameters, "seed": seed}
    try:
        value = function(**parameters, seed=seed)
        return True, json.dumps({**run, "value": value})
    except Exception:
        return False, json.dumps({**run, "error": traceback.format_exc()})


def _read(line: str) -> dict[str, Any]:
    run = json.loads(line)
    return {_key(run["function"], run["parameters"], run["seed"]): run["value"]}


def _finished(path: Path) -> dict[str, Any]:
    """The values of the runs in a file, by their keys; cuts off a last line that was not finished."""
    values: dict[str, Any] = {}
    if not path.exists():
        return values
    with open(path, "rb") as file:
        end = 0
        for line in file:
            if line.endswith(b"\n"):
                end += len(line)
                values.update(_read(line.decode()))
    # What is written next must begin a line.
    os.truncate(path, end)
    return values
