"""Sweeps: complete, in order, saved as they arrive, resumed, and on workers that die."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytest.importorskip("joblib", reason="sweeps run on joblib")
pytest.importorskip("tqdm", reason="sweeps show their progress by tqdm")

from demos._sweep import Engine, Run, failures, sweep

ENGINES = Engine(), Engine(jobs=2)


def logged(log: str, x: float, seed: int) -> list[float]:
    """Leaves a file for each call, and returns both numbers."""
    Path(log, f"{x}-{seed}-{time.time_ns()}").touch()
    return [x, seed]


def calls(log: Path) -> list[str]:
    """What was called with, each as often as it was."""
    return sorted(path.name.rpartition("-")[0] for path in log.iterdir())


def broken(x: float, seed: int) -> float:
    if seed == 1:
        raise ArithmeticError(f"no result for {x}")
    return 1.0 / x


def deadly(log: str, seed: int) -> int:
    """Kills the first process that runs seed 5, in the middle of it."""
    Path(log, f"{seed}-{time.time_ns()}").touch()
    time.sleep(0.1)
    if seed == 5 and len(list(Path(log).glob("5-*"))) == 1:
        os.kill(os.getpid(), getattr(signal, "SIGKILL", signal.SIGTERM))
    return seed * seed


def process(seed: int) -> int:
    return os.getpid()


def always_deadly(seed: int) -> int:
    if seed == 1:
        os.kill(os.getpid(), getattr(signal, "SIGKILL", signal.SIGTERM))
    return seed


def unfit(seed: int) -> object:
    return object()


@pytest.fixture
def log(tmp_path: Path) -> Path:
    directory = tmp_path / "log"
    directory.mkdir()
    return directory


@pytest.mark.parametrize("engine", ENGINES, ids=["one job", "two jobs"])
def test_results_are_complete_and_in_order(tmp_path, log, engine):
    parameters = [{"log": str(log), "x": x} for x in (2.5, 1.0)]
    path = tmp_path / "runs.jsonl"
    runs = sweep(logged, parameters, range(4), path, engine)
    assert runs == [
        Run(chosen, seed, [chosen["x"], seed])
        for chosen in parameters
        for seed in range(4)
    ]
    assert len(calls(log)) == 8
    lines = [json.loads(line) for line in path.read_text("utf-8").splitlines()]
    assert {line["function"] for line in lines} == {f"{__name__}.logged"}
    assert sorted((line["parameters"]["x"], line["seed"]) for line in lines) == [
        (x, seed) for x in (1.0, 2.5) for seed in range(4)
    ]
    assert not failures(path).exists()


@pytest.mark.parametrize("engine", ENGINES, ids=["one job", "two jobs"])
def test_failed_runs_are_kept_apart(tmp_path, capsys, engine):
    path = tmp_path / "runs.jsonl"
    parameters = [{"x": 2.0}, {"x": 0.0}]
    runs = sweep(broken, parameters, range(3), path, engine)
    assert [(run.parameters, run.seed) for run in runs] == [
        ({"x": 2.0}, 0),
        ({"x": 2.0}, 2),
    ]
    failed = failures(path).read_text("utf-8").splitlines()
    assert sorted(
        (f["parameters"]["x"], f["seed"]) for f in map(json.loads, failed)
    ) == [(0.0, 0), (0.0, 1), (0.0, 2), (2.0, 1)]
    assert sum("no result for" in line for line in failed) == 2
    assert f"runs that failed, in {failures(path)}: 4\n" in capsys.readouterr().out
    # Tried again, not added to.
    sweep(broken, parameters, range(3), path, engine)
    assert len(failures(path).read_text("utf-8").splitlines()) == 4
    assert len(path.read_text("utf-8").splitlines()) == 2


def test_a_value_that_json_cannot_hold_is_a_failed_run(tmp_path):
    path = tmp_path / "runs.jsonl"
    assert sweep(unfit, [{}], [0], path) == []
    assert "not JSON serializable" in failures(path).read_text("utf-8")


def test_finished_runs_are_not_run_again(tmp_path, log, capsys):
    path = tmp_path / "runs.jsonl"
    parameters = [{"log": str(log), "x": x} for x in (1.0, 2.0)]
    sweep(logged, parameters[:1], range(3), path)
    assert calls(log) == [f"1.0-{seed}" for seed in range(3)]
    runs = sweep(logged, parameters, range(3), path)
    assert f"in {path}, not run again: 3\n" in capsys.readouterr().out
    assert calls(log) == [f"{x}-{seed}" for x in (1.0, 2.0) for seed in range(3)]
    assert [run.value for run in runs] == [
        [x, seed] for x in (1.0, 2.0) for seed in range(3)
    ]


def test_a_sweep_that_is_stopped_goes_on(tmp_path, log):
    def stops(seed: int) -> int:
        if seed == 2 and not (log / "stopped").exists():
            (log / "stopped").touch()
            raise KeyboardInterrupt
        (log / f"{seed}-{time.time_ns()}").touch()
        return seed

    path = tmp_path / "runs.jsonl"
    with pytest.raises(KeyboardInterrupt):
        sweep(stops, [{}], range(4), path)
    assert len(path.read_text("utf-8").splitlines()) == 2
    assert [run.value for run in sweep(stops, [{}], range(4), path)] == [0, 1, 2, 3]
    (log / "stopped").unlink()
    assert calls(log) == ["0", "1", "2", "3"]


@pytest.mark.parametrize("kept", [1, 40, -1])
def test_a_line_cut_short_is_run_again(tmp_path, log, kept):
    path = tmp_path / "runs.jsonl"
    parameters = [{"log": str(log), "x": 1.0}]
    whole = sweep(logged, parameters, range(3), path)
    lines = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(lines[0] + lines[1] + lines[2][:kept])
    assert sweep(logged, parameters, range(3), path) == whole
    assert calls(log) == ["1.0-0", "1.0-1", "1.0-2", "1.0-2"]
    assert path.read_bytes().splitlines(keepends=True) == lines


def test_engines_that_cannot_be_are_refused():
    with pytest.raises(ValueError, match="positive"):
        Engine(jobs=0)
    with pytest.raises(ValueError, match="scheduler is for dask"):
        Engine(scheduler="tcp://127.0.0.1:8786")


@pytest.mark.parametrize(
    "arguments, message",
    [
        ("pile --jobs 2", "--jobs is for sweeps, not for pile"),
        ("packing --scheduler tcp://127.0.0.1:8786", "a scheduler is for dask"),
    ],
)
def test_command_line_refuses_what_it_would_not_heed(arguments, message):
    finished = subprocess.run(
        [sys.executable, "-m", "demos", *arguments.split()],
        cwd=Path(__file__).parent.parent,
        capture_output=True,
        encoding="utf-8",
    )
    assert finished.returncode == 2
    assert message in finished.stderr


@pytest.fixture(scope="module")
def cluster():
    """Two worker processes and a scheduler."""
    distributed = pytest.importorskip(
        "dask.distributed", reason="the cluster is Dask's"
    )
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address="localhost:0"
    ) as cluster:
        yield cluster


def test_a_killed_worker_loses_nothing(tmp_path, log, cluster):
    engine = Engine(2, "dask", cluster.scheduler_address)
    path = tmp_path / "runs.jsonl"
    runs = sweep(deadly, [{"log": str(log)}], range(12), path, engine)
    assert [run.value for run in runs] == [seed * seed for seed in range(12)]
    # The killed one's run was started twice.
    assert calls(log).count("5") == 2
    lines = [json.loads(line) for line in path.read_text("utf-8").splitlines()]
    assert sorted(line["seed"] for line in lines) == list(range(12))
    assert not failures(path).exists()


def test_a_cluster_of_one_thread_is_used(tmp_path):
    pytest.importorskip("dask.distributed", reason="the cluster is Dask's")
    runs = sweep(process, [{}], range(3), tmp_path / "runs.jsonl", Engine(1, "dask"))
    assert len({run.value for run in runs} - {os.getpid()}) == 1


def test_a_run_that_kills_every_worker_ends_the_sweep(tmp_path, cluster):
    from dask.distributed import KilledWorker

    engine = Engine(1, "dask", cluster.scheduler_address)
    path = tmp_path / "runs.jsonl"
    with pytest.raises(KilledWorker):
        sweep(always_deadly, [{}], range(3), path, engine)
    assert '"seed": 0' in path.read_text("utf-8")
    runs = sweep(always_deadly, [{}], [0, 2], path, engine)
    assert [run.value for run in runs] == [0, 2]
