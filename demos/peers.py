"""Beside the peers: speed and accuracy of contacts and scenes in MuJoCo, coal, FCL, Box2D and pymunk."""

from __future__ import annotations

import csv
from importlib import import_module
from pathlib import Path
from types import ModuleType

from tqdm import tqdm

from pymunk_ellipse import backend

from . import rocking
from ._builders import CIRCLE
from ._peers_charts import draw_pairs, draw_scenes, draw_small
from ._peers_pairs import (
    CASES,
    OURS,
    Case,
    PairScores,
    compare,
    methods_of_pymunk,
)
from ._peers_scenes import (
    Engine,
    PileSize,
    Seen,
    engines_of_pymunk,
    gas,
    period_off,
    piles,
    rock,
)
from ._picture import save

# By the name of the library that each needs.
PEERS = {
    "mujoco": "_peers_mujoco",
    "coal": "_peers_coal",
    "fcl": "_peers_fcl",
    "Box2D": "_peers_box2d",
}
RATES = 60, 120, 240
GAS_SECONDS = 10.0


def run(out: Path, quick: bool) -> None:
    """Compare whatever is installed; a quick run has fewer pairs and rounds, a smaller pile and a shorter gas."""
    peers = installed()
    table = pairs(peers, quick)
    seen = scenes(peers, quick)
    write_pairs(table, out / "peers_pairs.csv")
    write_scenes(seen, out / "peers_scenes.csv")
    read_pairs(table)
    read_scenes(seen)
    save(draw_pairs(table), out / "peers.png", dpi=110)
    save(draw_scenes(seen), out / "peers_scenes.png", dpi=110)
    save(draw_small(CASES[0], table[CASES[0]], seen), out / "peers_small.png", dpi=110)


def installed() -> list[ModuleType]:
    """The peers that are there; those that are not are left out, and that is printed."""
    found = []
    for library, module in PEERS.items():
        try:
            found.append(import_module(f"demos.{module}"))
        except ModuleNotFoundError as error:
            if error.name != library:
                raise
            print(f"left out: {library} (not installed)")
    return found


def pairs(peers: list[ModuleType], quick: bool) -> dict[Case, PairScores]:
    methods = methods_of_pymunk()
    for peer in peers:
        methods += peer.pair_methods()
    count, rounds = (40, 1) if quick else (400, 9)
    return {
        case: compare(methods, case.pairs(count), rounds, str(case)) for case in CASES
    }


def scenes(peers: list[ModuleType], quick: bool) -> dict[Engine, Seen]:
    engines = engines_of_pymunk()
    for peer in peers:
        if hasattr(peer, "engines"):
            engines += peer.engines()
    seen = {engine: Seen() for engine in engines}
    piles(
        engines,
        PileSize(30, 6, 2.0, 2, 5) if quick else PileSize(500, 30, 4.0, 15, 10),
        seen,
    )
    for engine in tqdm(engines, "rocking and gas", unit="engine"):
        if engine.make is not CIRCLE.make:
            for tilt in rocking.TILTS:
                seen[engine].rocking[tilt] = rock(engine, tilt)
        for rate in RATES[-1:] if quick else RATES:
            seen[engine].gas[rate] = gas(engine, rate, 2.0 if quick else GAS_SECONDS)
    return seen


def write_pairs(table: dict[Case, PairScores], path: Path) -> None:
    with open(path, "w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        rows.writerow(
            (
                "aspect ratio",
                "depth / b from",
                "to",
                "method",
                "number",
                "microseconds",
                "called from Python",
                "depth off / b, median",
                "worst",
                "normal off (rad), median",
                "worst",
                "missed",
                "wrong",
            )
        )
        for case, scores in table.items():
            for method, found in scores.items():
                rows.writerow(
                    (
                        case.aspect_ratio,
                        case.least,
                        case.largest,
                        method.family,
                        method.number,
                        f"{1e6 * found.bare:.4g}",
                        f"{1e6 * found.called:.4g}",
                        *(f"{off:.3g}" for off in (*found.depth, *found.normal)),
                        found.missed,
                        found.wrong,
                    )
                )
    print(f"table: {path}")


def write_scenes(seen: dict[Engine, Seen], path: Path) -> None:
    rates = list(next(iter(seen.values())).gas)
    with open(path, "w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        rows.writerow(
            (
                "engine",
                "shape",
                "pile, ms per step",
                "kinetic energy / (weight b)",
                "overlap / b, mean",
                "worst",
                "outside",
                *(f"period off, {tilt:g} rad" for tilt in rocking.TILTS),
                *(f"swing kept, {tilt:g} rad" for tilt in rocking.TILTS),
                *(f"energy of the gas, 1/{rate} s" for rate in rates),
            )
        )
        for engine, found in seen.items():
            swings = [found.rocking.get(tilt) for tilt in rocking.TILTS]
            rows.writerow(
                (
                    engine.family,
                    engine.shape,
                    f"{found.milliseconds:.4g}",
                    f"{found.restless:.3g}",
                    *(f"{depth:.3g}" for depth in found.overlap),
                    found.outside,
                    *(
                        f"{error:+.2e}"
                        if (error := period_off(found, tilt)) is not None
                        else ""
                        for tilt in rocking.TILTS
                    ),
                    *(
                        f"{swing.amplitude_kept:.4f}" if swing else ""
                        for swing in swings
                    ),
                    *(f"{found.gas[rate]:.4g}" for rate in rates),
                )
            )
    print(f"table: {path}")


def read_pairs(table: dict[Case, PairScores]) -> None:
    """Say in numbers what the chart shows."""
    print(f"pairs, by this package's {backend()} backend:")
    for case, scores in table.items():
        print(f"{case}:")
        for method, found in scores.items():
            print(
                f"  {method.label:22} {1e6 * found.bare:8.3f} us, called from Python {1e6 * found.called:7.2f} us; "
                f"depth off by {found.depth[0]:.1e} b (worst {found.depth[1]:.1e}), "
                f"normal by {found.normal[0]:.1e} (worst {found.normal[1]:.1e}); "
                f"missed {found.missed}, wrong {found.wrong}"
            )
        ours = next(found for method, found in scores.items() if method.family == OURS)
        faster = [
            method.label
            for method, found in scores.items()
            if found.called < ours.called and not method.family.startswith(OURS)
        ]
        print("  faster as called from Python: " + ("; ".join(faster) or "none"))


def read_scenes(seen: dict[Engine, Seen]) -> None:
    tilt = rocking.TILTS[1]
    print(f"scenes (rocking from {tilt:g} rad):")
    for engine, found in seen.items():
        error = period_off(found, tilt)
        swing = found.rocking.get(tilt)
        energies = ", ".join(
            f"{energy:.3g} at 1/{rate} s" for rate, energy in found.gas.items()
        )
        print(
            f"  {engine!s:28} {found.milliseconds:7.3f} ms, energy left {found.restless:.1e}, "
            f"overlap {found.overlap[0]:.1e} b (worst {found.overlap[1]:.1e}), outside {found.outside}; "
            + ("does not rock" if error is None else f"period {error:+.3%}")
            + (f", swing kept {swing.amplitude_kept:.1%}" if swing else "")
            + f"; gas {energies}"
        )
