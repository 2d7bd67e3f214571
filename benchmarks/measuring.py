"""Measuring beside what else a user would take: processor time, in turns in one process, medians.

    OMP_NUM_THREADS=1 python benchmarks/measuring.py [--file run.nc] [--rounds 5] [--threads 2] [--large]

Without a file, it first makes one: 4000 spheres at a packing fraction of 0.3, 501 frames with displacements.
With --large, only rows of 10^6 spheres in 13 frames are made, each work in a process of its own, with its
processor time from start to end and its largest memory.
freud, MDAnalysis and tidynamics are timed where they are installed, from arrays in memory. gaspart takes the
same arrays, and in the last rows measures the file from its opening to the result. Each row is a line of a
table in Markdown: the work, and of each program its time and how far its result is from gaspart's.
"""

from __future__ import annotations

import argparse
import importlib.util
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import netCDF4
import numpy as np

import gaspart as gp
from gaspart.analysis.motion import autocorrelation, squared_displacement
from gaspart.analysis.pairs import radial_distribution
from gaspart.analysis.structure_factors import factors, shells_of
from gaspart.yaml_text import dump_yaml, parse_yaml

BINS, FURTHEST, HIGHEST = 100, 5.0, 20.0
PAIRED, WAVED = 20, 4
"""Frames whose pairs are counted, and whose waves are summed."""
Work = Callable[[], np.ndarray]


def gas(count: int) -> gp.Scene:
    """Return the scene of this many spheres."""
    side = (count * np.pi / 6.0 / 0.3) ** (1.0 / 3.0)
    return gp.Scene(gp.Container((side,) * 3, "periodic"), [gp.Species(count, 0.5, temperature=1.0)])


def make(path: Path) -> Path:
    """Run the gas that is measured."""
    return gp.run(gas(4000), gp.EventDriven(), 1, 50.0, 0.1, path, displacements=True)


def is_installed(name: str) -> bool:
    """Return True if a package is there."""
    return importlib.util.find_spec(name) is not None


def pair_works(frames: np.ndarray, lengths: np.ndarray, threads: int) -> dict[str, Work]:
    """Ways to g(r)."""
    works: dict[str, Work] = {"gaspart": lambda: radial_distribution(frames, lengths, BINS, FURTHEST)[1]}
    if threads > 1:
        shared = f"gaspart, {threads} threads (wall-clock)"
        works[shared] = lambda: radial_distribution(frames, lengths, BINS, FURTHEST, threads)[1]
    if is_installed("freud"):
        works["freud"] = lambda: freud_rdf(frames, lengths)
    if is_installed("MDAnalysis"):
        works["MDAnalysis"] = lambda: mdanalysis_rdf(frames, lengths)
    return works


def freud_rdf(frames: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """g(r) by freud, on one thread."""
    import freud

    freud.parallel.set_num_threads(1)
    rdf = freud.density.RDF(bins=BINS, r_max=FURTHEST, normalization_mode="finite_size")
    box = freud.box.Box(*lengths)
    for frame in frames:
        rdf.compute((box, box.wrap((frame - 0.5 * lengths).astype(np.float32))), reset=False)
    return np.asarray(rdf.rdf)


def mdanalysis_rdf(frames: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """g(r) by the search of pairs that MDAnalysis' InterRDF makes."""
    from MDAnalysis.lib.distances import self_capped_distance

    box = np.array([*lengths, 90.0, 90.0, 90.0], dtype=np.float32)
    counts = np.zeros(BINS)
    for frame in frames:
        _, distances = self_capped_distance(frame.astype(np.float32), FURTHEST, box=box)
        counts += np.histogram(distances, BINS, (0.0, FURTHEST))[0]
    shells = 4.0 / 3.0 * np.pi * np.diff(np.linspace(0.0, FURTHEST, BINS + 1) ** 3)
    count = frames.shape[1]
    return counts / (len(frames) * 0.5 * count * (count - 1) * shells / lengths.prod())


def wave_works(frames: np.ndarray, lengths: np.ndarray) -> dict[str, Work]:
    """Ways to S(k) at the same wave vectors; freud takes vectors of its own."""
    waves, _, _ = shells_of(lengths, HIGHEST, 60, 24)
    vectors = 2.0 * np.pi * waves / lengths

    def by_numpy() -> np.ndarray:
        return np.array(
            [abs(np.exp(1j * (frame @ vectors.T)).sum(axis=0)) ** 2 / len(frame) for frame in frames]
        )

    works: dict[str, Work] = {"gaspart": lambda: factors(frames, lengths, waves), "numpy": by_numpy}
    if is_installed("freud"):
        works["freud (other vectors)"] = lambda: freud_factors(frames, lengths, len(waves))
    return works


def freud_factors(frames: np.ndarray, lengths: np.ndarray, number: int) -> np.ndarray:
    """S(k) by freud's direct sums, at about as many wave vectors."""
    import freud

    made = freud.diffraction.StaticStructureFactorDirect(
        bins=60, k_max=HIGHEST, k_min=0.1, num_sampled_k_points=number
    )
    box = freud.box.Box(*lengths)
    for frame in frames:
        made.compute((box, box.wrap((frame - 0.5 * lengths).astype(np.float32))), reset=False)
    return np.asarray(made.S_k)


def msd_works(paths: np.ndarray) -> dict[str, Work]:
    """Ways to the mean-squared displacement."""
    lags = len(paths) // 2
    works: dict[str, Work] = {"gaspart": lambda: squared_displacement(paths, lags)}
    if is_installed("freud"):
        works["freud"] = lambda: freud_msd(paths)[:lags]
    if is_installed("tidynamics"):
        works["tidynamics"] = lambda: tidynamics_mean("msd", paths)[:lags]
    return works


def freud_msd(paths: np.ndarray) -> np.ndarray:
    """The displacement by freud."""
    import freud

    return np.asarray(freud.msd.MSD(mode="window").compute(paths).msd)


def tidynamics_mean(name: str, values: np.ndarray) -> np.ndarray:
    """A function of tidynamics, which takes one particle at a time."""
    import tidynamics

    function = getattr(tidynamics, name)
    return np.mean([function(values[:, n]) for n in range(values.shape[1])], axis=0)


def vacf_works(velocities: np.ndarray) -> dict[str, Work]:
    """Ways to the velocity autocorrelation."""
    lags, dimension = len(velocities) // 2, velocities.shape[2]
    works: dict[str, Work] = {"gaspart": lambda: dimension * autocorrelation(velocities, lags)}
    if is_installed("tidynamics"):
        works["tidynamics"] = lambda: tidynamics_mean("acf", velocities)[:lags]
    return works


def walk_works(path: Path) -> dict[str, Work]:
    """Ways to all frames of a file, one after the other; by gaspart in blocks of 40 frames, or each alone."""

    def by_netcdf() -> np.ndarray:
        with netCDF4.Dataset(path) as file:
            vectors = file["coordinates"], file["velocities"]
            return np.array([[each[n].sum() for each in vectors] for n in range(len(vectors[0]))])

    def in_blocks() -> np.ndarray:
        rows = []
        with gp.open_trajectory(path) as data:
            for first in range(0, data.sizes["frame"], 40):
                block = data[["coordinates", "velocities"]].isel(frame=slice(first, first + 40)).load()
                vectors = block["coordinates"].values, block["velocities"].values
                rows += [[each[n].sum() for each in vectors] for n in range(len(vectors[0]))]
        return np.array(rows)

    def one_by_one() -> np.ndarray:
        with gp.open_trajectory(path) as data:
            vectors = data.variables["coordinates"], data.variables["velocities"]
            return np.array([[each[n].values.sum() for each in vectors] for n in range(len(vectors[0]))])

    return {"gaspart": in_blocks, "gaspart, one by one": one_by_one, "netCDF4": by_netcdf}


RUN_LARGE = """
import sys, gaspart as gp
gp.run(gp.Scene.from_file(sys.argv[2]), gp.EventDriven(), 1, 0.6, 0.05, sys.argv[1])
"""
LARGE = {
    "start of gaspart": "import gaspart.analysis.observables, gaspart.trajectory.reading; import xarray",
    "speeds": "import gaspart as gp; gp.measure(RUN, 'speeds')",
    "speeds, numpy": """
import netCDF4, numpy as np
velocities, counts = netCDF4.Dataset(RUN)["velocities"], 0
velocities.set_auto_mask(False)
for n in range(len(velocities) // 4, len(velocities)):
    v = velocities[n].astype(float)
    v -= v.mean(axis=0)
    counts += np.histogram(np.sqrt((v**2).sum(axis=1)), 40, (0.0, 4.0))[0]
""",
    "msd": "import gaspart as gp; gp.measure(RUN, 'msd')",
    "msd, numpy": """
import netCDF4, numpy as np
file = netCDF4.Dataset(RUN)
positions, side = file["coordinates"], file["cell_lengths"][0, 0]
positions.set_auto_mask(False)
r = positions[len(positions) // 4 :].astype(float)
steps = np.diff(r, axis=0)
steps -= side * np.round(steps / side)
paths = np.concatenate([np.zeros_like(r[:1]), np.cumsum(steps, axis=0)])
paths -= paths.mean(axis=1, keepdims=True)
msd = [((paths[lag:] - paths[: len(paths) - lag]) ** 2).sum(axis=2).mean() for lag in range(len(paths) // 2)]
""",
    "vacf": "import gaspart as gp; gp.measure(RUN, 'vacf')",
    "check of the file": "from gaspart.cli import main; sys.argv[1:] = ['check', RUN]; main()",
    "check of the scene": "from gaspart.cli import main; sys.argv[1:] = ['check', SCENE]; main()",
    "Simulation()": "import gaspart as gp; gp.Simulation(gp.Scene.from_file(SCENE), seed=1)",
}
"""Programs that measure 10^6 spheres, by their names."""


def print_large(folder: Path, rounds: int) -> None:
    """Print the processor time and the largest memory of each program of `LARGE`."""
    (folder / "scene.yaml").write_text(dump_yaml(gas(1_000_000).to_dict()))
    path = folder / "run.nc"
    spend(RUN_LARGE, path)  # not here: a process begins with the largest memory of the one that starts it
    for name, program in LARGE.items():
        used = [spend(f"import sys\nRUN, SCENE = sys.argv[1:3]\n{program}", path) for _ in range(rounds)]
        seconds, memory = np.array(used).T
        cell = f"{np.median(seconds):.3g} s ({seconds.min():.3g} to {seconds.max():.3g})"
        print(f"| {name} | {cell} | {np.median(memory):.0f} MB |", flush=True)


def spend(program: str, path: Path) -> tuple[float, float]:
    """Run a program; return its processor time and its largest memory in MB."""
    arguments = [sys.executable, "-c", program, str(path), str(path.with_name("scene.yaml"))]
    child = subprocess.Popen(arguments, stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(child.pid, 0)
    if status:
        raise SystemExit(f"{program}\nended with status {status}")
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024.0


def timed(works: dict[str, Work], rounds: int) -> tuple[dict[str, list[float]], dict[str, np.ndarray]]:
    """Return the times of each work in turns, without a first turn that compiles, and its result."""
    times: dict[str, list[float]] = {name: [] for name in works}
    results = {name: work() for name, work in works.items()}
    for _ in range(rounds):
        for name, work in works.items():
            clock = time.perf_counter if "wall-clock" in name else time.process_time
            before = clock()
            work()
            times[name].append(clock() - before)
    return times, results


def print_row(label: str, works: dict[str, Work], rounds: int) -> None:
    """Time the works, and print a line of the table."""
    times, results = timed(works, rounds)
    base = statistics.median(times["gaspart"])
    cells = []
    for name, each in times.items():
        middle = statistics.median(each)
        cell = f"{name} {middle:.3g} s ({min(each):.3g} to {max(each):.3g})"
        if name != "gaspart":
            cell += f", {middle / base:.3g} times"
            if results[name].shape == results["gaspart"].shape and "other" not in name:
                apart = np.nanmax(np.abs(results[name] - results["gaspart"]))
                cell += f", differs by {apart:.1g} of {np.nanmax(np.abs(results['gaspart'])):.3g}"
        cells.append(cell)
    print(f"| {label} | {' | '.join(cells)} |", flush=True)


def main() -> None:
    """Carry out the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--file", type=Path)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--large", action="store_true")
    given = parser.parse_args()
    with TemporaryDirectory() as folder:
        if given.large:
            print_large(Path(folder), given.rounds)
            return
        path = given.file or make(Path(folder) / "run.nc")
        with gp.open_trajectory(path) as data:
            lengths = np.array([float(one) for one in scene_of(data).container.lengths])
            first = len(data["time"]) // 4
            positions = data["coordinates"][-PAIRED:].values.astype(float)
            paths = data["displacements"][first:].values.astype(float)
            velocities = data["velocities"][first:].values.astype(float)
        print_row(f"g(r), {PAIRED} frames", pair_works(positions, lengths, given.threads), given.rounds)
        print_row(f"S(k), {WAVED} frames", wave_works(positions[:WAVED], lengths), given.rounds)
        print_row(f"msd, {len(paths)} frames", msd_works(paths), given.rounds)
        print_row(f"vacf, {len(velocities)} frames", vacf_works(velocities), given.rounds)
        print_row("frames in their order", walk_works(path), given.rounds)
        for name in ("rdf", "structure_factor", "msd", "vacf", "speeds", "density", "temperature"):
            work = {"gaspart": lambda name=name: np.asarray(gp.measure(path, name).estimate)}
            print_row(f"{name}, file", work, given.rounds)


def scene_of(data) -> gp.Scene:
    """The scene of an open trajectory."""
    return gp.Scene.from_dict(parse_yaml(data.attrs["scene"]))


if __name__ == "__main__":
    main()
