"""Estimators from impulses against others, in the same runs: whether they agree, their gain and their cost.

    python benchmarks/estimators.py scenes [--frames 3201] [--seeds 1]    densities in all kinds of scene
    python benchmarks/estimators.py pairs [--seeds 12]        g(r) in periodic ones
    python benchmarks/estimators.py walls [--seeds 12]        pressures on walls
    python benchmarks/estimators.py coverage [--runs 300]     of intervals of 95 %, of each
    python benchmarks/estimators.py cost [--rounds 9]         CPU time with over without, alternately

`scenes` prints for each scene the root mean square, over bins, of the difference of both over its error by 32
blocks, its largest value, and the variance of counts over that of impulses and of the mixture (medians).
With `--step 0.01` the time-stepped engine makes the runs of `scenes`, `walls` and `cost`, of what it models.
`pairs` does so of impulses without the number of pairs that is counted, over bins and seeds. `walls` prints
by how many errors pressures with and without what is known differ, and the ratio of their squared errors.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from scipy import stats

import gaspart as gp
from gaspart.analysis.impulses import mixture, numbers_by_impulses
from gaspart.analysis.pairs import STRETCHES, g_by_impulses, radial_distribution
from gaspart.analysis.run import Run, open_run
from gaspart.engines import Engine
from gaspart.state.tally import ImpulseTally

BLOCKS = 32
FINE, COARSE = 64, 16
FILLED = 0.02
"""Of the mean density: bins that are filled more rarely have skewed differences."""
EXPECTED_OF_STRETCHES = (STRETCHES - 1.0) / (STRETCHES - 3.0)
"""The mean square of Student's t of an error by stretches."""
PLANES = ("periodic", "periodic", "wall")


@dataclass(frozen=True)
class Case:
    """A scene, the axis of its profile, and the time between frames."""

    scene: gp.Scene
    axis: str = "z"
    interval: float = 0.5


def spheres(fraction: float, radius: float = 0.5, **rest) -> gp.Species:
    """So many that they fill this fraction of 5 x 5 x 8."""
    count = round(fraction * 200.0 / (4.0 / 3.0 * math.pi * radius**3))
    dense = {"arrangement": "lattice"} if fraction > 0.25 else {}
    return gp.Species(count, radius, temperature=1.0, **dense, **rest)


def column(*species: gp.Species, boundary=PLANES, pull: float = 0.0, **rest) -> gp.Scene:
    """A container of 5 x 5 x 8, with a pull along its last axis."""
    gravity = {"gravity": (0.0, 0.0, pull)} if pull else {}
    return gp.Scene(gp.Container((5.0, 5.0, 8.0), boundary), list(species), **gravity, **rest)


def engine_of(given: argparse.Namespace) -> Engine:
    """The engine that is asked for."""
    return gp.TimeStepped(given.step) if given.step else gp.EventDriven()


def models(engine: Engine, scene: gp.Scene) -> bool:
    """Whether an engine models a scene."""
    try:
        engine.check_features(scene)
    except gp.SceneError:
        return False
    return True


def cases() -> Iterator[tuple[str, Case]]:
    """All scenes, with their names."""
    heavy = spheres(0.1, 0.4, mass=4.0)
    for fraction in (0.05, 0.1, 0.2, 0.3, 0.4):
        yield f"walls {fraction}", Case(column(spheres(fraction)))
    for fraction in (0.05, 0.1, 0.2, 0.3):
        yield f"falling {fraction}", Case(column(spheres(fraction), pull=-1.0))
        yield f"rising {fraction}", Case(column(spheres(fraction), pull=0.3))
        wells = {"z_low": gp.Well(1.5, 0.7), "z_high": gp.Well(0.5, 1.2)}
        yield f"wells {fraction}", Case(column(spheres(fraction), faces=wells))
        hot = {"z_low": gp.Thermal(2.0), "z_high": gp.Thermal(2.0)}
        yield f"thermal {fraction}", Case(column(spheres(fraction), faces=hot))
        yield f"thermal, falling {fraction}", Case(column(spheres(fraction), faces=hot, pull=-1.0))
        both = spheres(fraction / 2.0), spheres(fraction / 2.0, 0.3, mass=0.3)
        yield f"mixture {fraction}", Case(column(*both))
    for pull in (-0.2, 0.5):
        yield f"mixture, falling {pull}", Case(column(spheres(0.1), heavy, pull=pull))
    yield "ideal gas, falling", Case(column(gp.Species(100, 0.05, temperature=1.0), pull=-1.0), interval=1.0)
    yield "periodic mixture", Case(column(spheres(0.1), heavy, boundary="periodic"))
    yield "two walls aside", Case(column(spheres(0.1, 0.4), boundary="wall", pull=-1.0), "x")
    yield "rough", Case(column(spheres(0.1), restitution=gp.Restitution(1.0, 1.0)))
    yield "rough, falling", Case(column(spheres(0.1), restitution=gp.Restitution(1.0, 1.0), pull=-0.5))
    yield (
        "sizes, centres at walls",
        Case(column(spheres(0.1, 0.4, polydispersity=0.3), centres_to_walls=True)),
    )
    flat, discs = gp.Container((8.0, 12.0)), gp.Species(40, 0.5, temperature=1.0)
    yield "discs, falling", Case(gp.Scene(flat, [discs], gravity=(0.0, -0.3)), "y")
    tilted = [gp.Wall((2.0, 3.0), (6.0, 6.0))]
    yield "discs, an interior wall", Case(gp.Scene(flat, [discs], walls=tilted, gravity=(0.0, -0.3)), "y")
    yield "discs, walls aside", Case(gp.Scene(flat, [discs]), "x")


def blocks_of(run: Run, axis: int, bins: int) -> tuple[np.ndarray, np.ndarray]:
    """(BLOCKS, bins) particles in each bin by counts, and by impulses."""
    found = numbers_by_impulses(run, axis, bins, None)
    assert found is not None
    used = len(found) // BLOCKS * BLOCKS
    length, size = run.scene.container.lengths[axis], used // BLOCKS
    frames = run.positions[1 : used + 1, :, axis]
    counts = np.stack([np.histogram(frame, bins, (0.0, length))[0] for frame in frames])
    times = np.diff(run.time)[:used].reshape(BLOCKS, size).sum(axis=1)[:, None]
    return counts.reshape(BLOCKS, size, bins).mean(axis=1), found[:used].reshape(BLOCKS, size, bins).sum(
        axis=1
    ) / times


def compared(run: Run, axis: int, bins: int) -> tuple[np.ndarray, float, float]:
    """(filled bins,) the difference over its error, and the medians of the two variance ratios."""
    counted, impulses = blocks_of(run, axis, bins)
    filled = counted.mean(axis=0) > FILLED * counted.mean()
    filled &= impulses.any(axis=0)  # after a step centres may lie beyond a wall
    counted, impulses = counted[:, filled], impulses[:, filled]
    apart = counted - impulses
    z = apart.mean(axis=0) / apart.std(axis=0, ddof=1) * math.sqrt(BLOCKS)
    mixed = counted + mixture(counted, impulses, run.periodic[axis]) * (impulses - counted)
    own, other, both = (one.var(axis=0, ddof=1) for one in (counted, impulses, mixed))
    return z, float(np.median(own / other)), float(np.median(own / both))


def scenes(given: argparse.Namespace) -> None:
    """Compare both in all scenes."""
    expected = (BLOCKS - 1.0) / (BLOCKS - 3.0)  # the mean square of t
    total: dict[int, list[float]] = {FINE: [], COARSE: []}
    engine = engine_of(given)
    for name, case in cases():
        if not models(engine, case.scene):
            continue
        found: dict[int, list] = {FINE: [], COARSE: []}
        for seed in range(given.seeds):
            with TemporaryDirectory() as folder, ExitStack() as stack:
                duration, path = case.interval * (given.frames - 1), Path(folder) / "run.nc"
                kept = gp.ImpulseTally(case.axis, FINE)
                gp.run(case.scene, engine, seed, duration, case.interval, path, tallies=[kept])
                run = stack.enter_context(open_run(path, 50.0))
                for bins, rows in found.items():
                    rows.append(compared(run, "xyz".index(case.axis), bins))
        texts = []
        for bins, rows in found.items():
            z = np.concatenate([row[0] for row in rows])
            total[bins].append(float((z**2).mean()) / expected)
            gains = np.median([row[1:] for row in rows], axis=0)
            text = f"{bins:3} bins: rms {math.sqrt(total[bins][-1]):.2f}, largest {abs(z).max():.1f}, "
            texts.append(text + f"impulses {gains[0]:.1f}, mixture {gains[1]:.1f}")
        print(f"{name:28} {'; '.join(texts)}", flush=True)
    for bins, squares in total.items():
        print(f"all {len(squares)} scenes, {bins} bins: rms {math.sqrt(np.mean(squares)):.3f}")


def pairs(given: argparse.Namespace) -> None:
    """Compare g(r) by counts and by impulses, in bins of three widths."""
    small = gp.Species(20, 0.3, mass=0.3, temperature=1.0)
    rough = {"restitution": gp.Restitution(1.0, 1.0)}
    cube = gp.Container((6.0, 6.0, 6.0), "periodic")
    flat = gp.Container((10.0, 10.0), "periodic")
    gases = {f"spheres {fraction}": gp.Scene(cube, [spheres(fraction)]) for fraction in (0.05, 0.1, 0.2, 0.4)}
    gases["mixture"] = gp.Scene(cube, [spheres(0.1), small])
    gases["rough"] = gp.Scene(cube, [spheres(0.1)], **rough)
    gases["discs"] = gp.Scene(flat, [gp.Species(30, 0.5, temperature=1.0)])
    widths, furthest = (1, 10, 25), 2.5
    squares: dict[int, list[float]] = {width: [] for width in widths}
    for name, scene in gases.items():
        found: dict[int, list[np.ndarray]] = {width: [] for width in widths}
        for seed in range(given.seeds):
            with TemporaryDirectory() as folder:
                path, kept = Path(folder) / "run.nc", gp.PairImpulseTally(furthest, 250, 0.5)
                gp.run(scene, gp.EventDriven(), seed, 200.0, 1.0, path, tallies=[kept])
                with open_run(path, 8.0) as run:
                    for width, rows in found.items():
                        rows.append(pairs_apart(run, furthest, 250 // width))
        texts = []
        for width, rows in found.items():
            z = np.array(rows)
            squares[width].append(float((z**2).mean()) / EXPECTED_OF_STRETCHES)
            texts.append(
                f"{0.01 * width:g}: rms {math.sqrt(squares[width][-1]):.2f}, largest {abs(z).max():.1f}"
            )
        print(f"{name:14} bins of {'; '.join(texts)}", flush=True)
    for width, each in squares.items():
        print(f"all {len(each)} scenes, bins of {0.01 * width:g}: rms {math.sqrt(np.mean(each)):.3f}")


def pairs_apart(run: Run, furthest: float, bins: int) -> np.ndarray:
    """(bins that pairs come to,) the difference of g(r) by counts and by impulses alone over its error."""
    stretches = np.array_split(np.arange(len(run.time)), STRETCHES)
    lengths = run.scene.container.lengths
    counted = [radial_distribution(run.positions[part], lengths, bins, furthest)[1] for part in stretches]
    impulses = g_by_impulses(run, np.array([part[0] for part in stretches]), bins, furthest)
    assert impulses is not None
    apart = np.array(counted) * run.count / (run.count - 1.0) - impulses.sum(axis=0)
    met = np.array(counted).mean(axis=0) > FILLED
    apart = apart[:, met]
    return np.asarray(apart.mean(axis=0) / apart.std(axis=0, ddof=1) * math.sqrt(STRETCHES))


def walls(given: argparse.Namespace) -> None:
    """Compare pressures on walls with and without what is known, run by run."""
    box = gp.Container((5.0, 5.0, 8.0))
    alike = {f"walls {fraction}": column(spheres(fraction)) for fraction in (0.05, 0.1, 0.2, 0.3, 0.4)}
    alike["mixture"] = column(spheres(0.1), spheres(0.05, 0.3, mass=0.3))
    alike["walls on all sides"] = gp.Scene(box, [spheres(0.1)])
    alike["an interior wall"] = gp.Scene(
        gp.Container((8.0, 12.0)),
        [gp.Species(30, 0.5, temperature=1.0)],
        walls=[gp.Wall((2.0, 3.0), (6.0, 6.0))],
    )
    engine = engine_of(given)
    for name, scene in alike.items():
        if not models(engine, scene):
            continue
        rows, along = [], "xyz"[scene.dimension - 1]
        for seed in range(given.seeds):
            rows.append(wall_pressures(scene, engine, seed, gp.ImpulseTally(along, 8), f"{along} low"))
        values, errors, _ = np.array(rows).transpose(1, 2, 0)
        apart = values[0] - values[1]
        z = apart.mean() / apart.std(ddof=1) * math.sqrt(len(apart))
        gain = np.mean(errors[0] ** 2) / np.mean(errors[1] ** 2)
        print(f"{name:20} apart by {z:.1f} errors; ratio of squared errors {gain:.1f}", flush=True)


def wall_pressures(
    scene: gp.Scene, engine: Engine, seed: int, kept: gp.ImpulseTally, face: str
) -> np.ndarray:
    """(3, 2) the pressure on a face, its error and the degrees of freedom of that, by impulses alone and with
    what is known."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "run.nc"
        gp.run(scene, engine, seed, 300.0, 0.5, path, tallies=[kept])
        return pressures_of(path, face)


def pressures_of(path: Path, face: str) -> np.ndarray:
    """The same of a file."""
    found = []
    with gp.open_trajectory(path) as data:
        for one in (data.assign_attrs(tallies="[]"), data):
            part = gp.analysis.wall_pressure(one).sel(face=face)
            freedom = part.get("wall_pressure_freedom", STRETCHES - 1)
            found.append([float(part.estimate), float(part.error), float(freedom)])
    return np.transpose(found)


def coverage(given: argparse.Namespace) -> None:
    """How often intervals of 95 % have the mean of all runs in them: of a density, of a pressure on a wall
    by impulses alone and with what is known, and of g(r)."""
    exact = {"temperature": 1.0, "exact_temperature": True}
    slit = column(gp.Species(38, 0.5, **exact))
    fluid = gp.Scene(gp.Container((6.0, 6.0, 6.0), "periodic"), [gp.Species(41, 0.5, **exact)])
    density, pressure, pair = [], [], []
    for seed in range(given.runs):
        with TemporaryDirectory() as folder:
            path = Path(folder) / "run.nc"
            gp.run(slit, gp.EventDriven(), seed, 300.0, 0.5, path, tallies=[gp.ImpulseTally("z", COARSE)])
            found = gp.analysis.profile(path).isel(position=slice(1, -1))
            density.append([found.estimate, found.error, found["density_freedom"]])
            pressure.append(pressures_of(path, "z low"))
            gp.run(
                fluid,
                gp.EventDriven(),
                seed,
                200.0,
                1.0,
                path,
                tallies=[gp.PairImpulseTally(2.5, 25, 0.2)],
                overwrite=True,
            )
            found = gp.analysis.rdf(path).isel(distance=slice(10, None))
            pair.append([found.estimate, found.error, np.full(15, STRETCHES - 1.0)])
    own = 1.96 * math.sqrt(0.05 * 0.95 / given.runs)
    for name, rows in (("density", density), ("pressure, plain and better", pressure), ("g(r)", pair)):
        value, error, freedom = np.array(rows, dtype=float).swapaxes(0, 1)
        reach = error * stats.t.ppf(0.975, freedom)
        inside = abs(value - value.mean(axis=0)) <= reach * math.sqrt(1.0 + 1.0 / given.runs)
        each = inside.mean(axis=0).round(3)
        print(f"{name}: covered {each} (0.95 +- {own:.3f} each); all: {inside.mean():.4f}", flush=True)
        errors = np.sqrt((error**2).mean(axis=0)) / value.std(axis=0, ddof=1)
        print(f"  errors over the scatter of runs: {errors.round(2)}", flush=True)


def cost(given: argparse.Namespace) -> None:
    """The CPU time of equal work with impulses over that without, of both alternately."""
    engine = engine_of(given)
    for fraction in (0.05, 0.2, 0.4):
        side = (4000 * math.pi / 6.0 / fraction) ** (1.0 / 3.0)
        start = "lattice" if fraction > 0.25 else "random"
        gas = gp.Species(4000, 0.5, temperature=1.0, arrangement=start)
        scene = gp.Scene(gp.Container((side,) * 3, PLANES), [gas])
        asked = ((), (ImpulseTally("z", 200),))
        both = [gp.Simulation(scene, engine, 1, tallies=tallies) for tallies in asked]
        work = {"duration": 500.0 * given.step} if given.step else {"max_events": 200_000}
        taken: list[list[float]] = [[], []]
        for _ in range(given.rounds + 1):
            for one, times in zip(both, taken, strict=True):
                begun = time.process_time()
                one.advance(**work)
                times.append(time.process_time() - begun)
        ratios = np.divide(taken[1][1:], taken[0][1:])
        low, middle, high = np.percentile(ratios, [25, 50, 75])
        print(f"{fraction}: {middle:.3f} ({low:.3f} to {high:.3f})")


COMMANDS = {"scenes": scenes, "pairs": pairs, "walls": walls, "coverage": coverage, "cost": cost}


def main() -> None:
    """Do what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("what", choices=tuple(COMMANDS))
    for name, default in (("frames", 3201), ("seeds", 1), ("runs", 300), ("rounds", 9)):
        parser.add_argument(f"--{name}", type=int, default=default)
    parser.add_argument("--step", type=float, default=0.0)
    given = parser.parse_args()
    COMMANDS[given.what](given)


if __name__ == "__main__":
    main()
