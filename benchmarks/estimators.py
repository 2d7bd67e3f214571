"""Densities from impulses against counts, in the same runs: whether they agree, their gain and their cost.

    python benchmarks/estimators.py scenes [--frames 3201] [--seeds 1]    all kinds of scene that have any
    python benchmarks/estimators.py coverage [--runs 300]     of intervals of 95 %, of each bin
    python benchmarks/estimators.py cost [--rounds 9]         time per event, with over without, alternately

`scenes` prints for each scene the root mean square, over bins, of the difference of both over its error by 32
blocks, its largest value, and the variance of counts over that of impulses and of the mixture (medians).
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
from gaspart.analysis.run import Run, open_run
from gaspart.state.optional_tallies import ImpulseTally

BLOCKS = 32
FINE, COARSE = 64, 16
FILLED = 0.02
"""Of the mean density: bins that are filled more rarely have skewed differences."""
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
    for name, case in cases():
        found: dict[int, list] = {FINE: [], COARSE: []}
        for seed in range(given.seeds):
            with TemporaryDirectory() as folder, ExitStack() as stack:
                duration, path = case.interval * (given.frames - 1), Path(folder) / "run.nc"
                kept = f"{case.axis}:{FINE}"
                gp.run(case.scene, gp.EventDriven(), seed, duration, case.interval, path, impulses=kept)
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


def coverage(given: argparse.Namespace) -> None:
    """How often intervals of 95 % of the density have the mean of all runs in them."""
    scene, found = column(spheres(0.1), pull=-0.5), []
    for seed in range(given.runs):
        with TemporaryDirectory() as folder:
            path = Path(folder) / "run.nc"
            gp.run(scene, gp.EventDriven(), seed, 400.0, 0.5, path, impulses=f"z:{COARSE}")
            found.append(gp.analysis.profile(path))
    values = np.array([one.estimate.values for one in found])
    errors = np.array([one.error.values for one in found])
    reach = errors * stats.t.ppf(0.975, np.array([one["density_freedom"].values for one in found]))
    inside = (abs(values - values.mean(axis=0)) <= reach)[:, 1:-1]
    own = 1.96 * math.sqrt(0.05 * 0.95 / given.runs)
    print(f"covered: {inside.mean(axis=0).round(3)} (0.95 +- {own:.3f} each); all: {inside.mean():.4f}")


def cost(given: argparse.Namespace) -> None:
    """The time per event with impulses over that without, of both alternately."""
    for fraction in (0.05, 0.2, 0.4):
        side = (4000 * math.pi / 6.0 / fraction) ** (1.0 / 3.0)
        start = "lattice" if fraction > 0.25 else "random"
        gas = gp.Species(4000, 0.5, temperature=1.0, arrangement=start)
        scene = gp.Scene(gp.Container((side,) * 3, PLANES), [gas])
        asked = ((), (ImpulseTally("z", 200),))
        both = [gp.Simulation(scene, gp.EventDriven(), 1, tallies=tallies) for tallies in asked]
        taken: list[list[float]] = [[], []]
        for _ in range(given.rounds + 1):
            for one, times in zip(both, taken, strict=True):
                begun = time.process_time()
                one.advance(max_events=200_000)
                times.append(time.process_time() - begun)
        ratios = np.divide(taken[1][1:], taken[0][1:])
        low, middle, high = np.percentile(ratios, [25, 50, 75])
        print(f"{fraction}: {middle:.3f} ({low:.3f} to {high:.3f})")


def main() -> None:
    """Do what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("what", choices=("scenes", "coverage", "cost"))
    for name, default in (("frames", 3201), ("seeds", 1), ("runs", 300), ("rounds", 9)):
        parser.add_argument(f"--{name}", type=int, default=default)
    given = parser.parse_args()
    {"scenes": scenes, "coverage": coverage, "cost": cost}[given.what](given)


if __name__ == "__main__":
    main()
