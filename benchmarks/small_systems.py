"""Small periodic systems of equal hard spheres and discs: contact value, Z, collision rate and D.

    python benchmarks/small_systems.py run results/small_systems.jsonl [--rounds 40]    (resumable)
    python benchmarks/small_systems.py fit results/small_systems.jsonl
    python benchmarks/small_systems.py table results/small_systems.jsonl > small_systems.csv

Each line of the file is one independent run of the event engine: its own seed, compressed from random
positions, equilibrated, then counted. Runs go where they lower the summed variance most per CPU time, until
the contact value of every row is known to `TARGET`. Errors follow from the scatter of independent runs.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections import defaultdict
from pathlib import Path

import numpy as np
from scipy.optimize import minimize

import gaspart as gp
from gaspart import theory
from gaspart.theory import finite_size

COUNTS = (3, 4, 5, 6, 8, 12, 16, 24, 32, 48, 64)
"""Numbers of particles; two particles have a closed form (`finite_size.pair_contact_value`)."""
LARGER = (96, 192)
"""Numbers of particles that show how the remainder of the expansion in 1/N decreases."""
FRACTIONS = {
    2: (0.1, 0.2, 0.3, 0.4, 0.5, 0.55, 0.6, 0.65, 0.69),
    3: (0.1, 0.2, 0.3, 0.35, 0.4, 0.45, 0.475, 0.5),
}
DENSE = {2: (0.5, 0.65, 0.69), 3: (0.3, 0.45, 0.5)}
CHECKS = (
    (3, 108, 0.5113),
    (3, 108, 0.47),
    (3, 32, 0.49),
    (2, 56, 0.69),
    (3, 2, 0.1),
    (3, 2, 0.4),
    (2, 2, 0.5),
)
"""Systems that are known from elsewhere."""
TARGET = 3e-4
"""Relative standard error of the contact value at which a row is complete."""
EVENTS, LEAST_PER_PARTICLE = 100_000, 1500
"""Collisions that are counted in a run, and the least number of them divided by that of particles."""
EQUILIBRATION = 500
"""Collisions before these, divided by the number of particles."""
SAMPLES, SPACING = 600, 10.0
"""Positions in a run, and Enskog's collisions of a particle between two of them."""
LAGS = (1, 2, 3, 4, 6, 8, 12, 16, 24)
"""Lags of the mean-squared displacement, in samples."""
LEAST_FITTED, SHORTEST = 4, 2.2
"""Number of particles and side, in diameters, from which on rows determine the remainder."""
LEAST_RUNS, MANY_RUNS = 4, 8
"""Runs from which on their own scatter is their error, and from which on it is known well enough."""
SEPARATE = 8.0
"""Scatter, divided by that of independent collisions, above which runs are in several states: fluids have 1
to 7, 64 spheres at 0.5 17, five spheres at 0.475 618, whose contact value is 108, 131 or 1291."""
PILOT, BATCH, ATTEMPTS = 1, 2, 20
"""Runs of each row at first, in a turn, and attempts at a start without a jam."""


def rows() -> list[tuple[int, int, float]]:
    """Dimension, number of particles and packing fraction of all systems, the most instructive ones first."""
    first = [(2, n, eta) for n in (8, 16, 32) for eta in (0.3, 0.5, 0.6, 0.69)]
    first += [(3, n, eta) for n in (32, 64) for eta in (0.3, 0.4, 0.45, 0.5)] + list(CHECKS)
    first += [(2, n, eta) for n in (4, 6, 12, 24) for eta in (0.3, 0.5, 0.69)]
    first += [(d, n, eta) for d in (3, 2) for n in LARGER for eta in DENSE[d]]
    grid = [(d, n, eta) for n in reversed(COUNTS) for d in (2, 3) for eta in FRACTIONS[d]]
    return list(dict.fromkeys(first + grid))


def side_of(dimension: int, count: int, fraction: float) -> float:
    """The side of a square or cube in diameters."""
    return float((count * theory.particle_volume(dimension) / fraction) ** (1.0 / dimension))


def scene(dimension: int, count: int, fraction: float) -> gp.Scene:
    """A periodic cube or square of particles of diameter, mass and temperature 2 E / (d (N - 1)) of 1."""
    side = side_of(dimension, count, fraction)
    container = gp.Container(lengths=(side,) * dimension, boundary="periodic")
    kind = gp.Species(
        count=count, radius=0.5, temperature=1.0, arrangement="compressed", exact_temperature=True
    )
    return gp.Scene(container=container, species=[kind])


def one_run(dimension: int, count: int, fraction: float, number: int) -> dict | None:
    """Contact values of one run by its virial and by its collisions, and sums of squared displacements."""
    begun = time.process_time()
    for attempt in range(ATTEMPTS):
        seed = (dimension, count, round(1e4 * fraction), number, attempt)
        try:
            simulation = gp.Simulation(scene(dimension, count, fraction), gp.EventDriven(), seed=seed)
            break
        except gp.SceneError:  # jammed while growing
            continue
    else:
        return None
    events = max(EVENTS, LEAST_PER_PARTICLE * count)
    simulation.advance(max_events=EQUILIBRATION * count, until=math.inf)
    simulation.reset_tally()
    interval = SPACING / float(theory.collision_rate(fraction, dimension))
    places = np.empty((SAMPLES, count, dimension))
    for place in places:
        simulation.advance(duration=interval, max_events=events)
        place[...] = simulation.state.unwrapped
    middle = simulation.tally
    rest = max(events - middle.collisions, events // 4)
    simulation.advance(max_events=rest, until=math.inf)
    moved = [float(((places[lag:] - places[:-lag]) ** 2).sum(axis=2).mean()) for lag in LAGS]
    tally = simulation.tally
    halves = [
        contact_values(dimension, count, fraction, *part)
        for part in (
            (middle.time, middle.collisions, middle.virial_sum),
            (
                tally.time - middle.time,
                tally.collisions - middle.collisions,
                tally.virial_sum - middle.virial_sum,
            ),
        )
    ]
    whole = contact_values(dimension, count, fraction, tally.time, tally.collisions, tally.virial_sum)
    return {
        "row": [dimension, count, fraction],
        "number": number,
        "attempt": attempt,
        "events": tally.collisions,
        "middle": middle.collisions,
        "virial": whole[0],
        "rate": whole[1],
        "halves": halves,
        "interval": interval,
        "moved": moved,
        "time": tally.time,
        "cpu": time.process_time() - begun,
    }


def contact_values(
    dimension: int, count: int, fraction: float, duration: float, collisions: int, virial: float
) -> tuple[float, float]:
    """g at contact of N (N - 1) / 2 pairs, by the virial, (Z - 1) / (2^(d-1) eta), and by the collisions."""
    twice_energy = dimension * (count - 1.0)
    by_virial = virial / (twice_energy * duration) / (2.0 ** (dimension - 1) * fraction)
    unit = float(theory.collision_rate(fraction, dimension, contact=1.0))
    unit *= (count - 1.0) / count * theory.speeds.mean_speed_factor(dimension * (count - 1))
    return by_virial, 2.0 * collisions / (count * duration) / unit


def read(path: Path) -> dict[tuple, list[dict]]:
    """The runs of each system, in the order of their numbers."""
    runs = defaultdict(list)
    for line in path.read_text().splitlines() if path.exists() else ():
        entry = json.loads(line)
        dimension, count, fraction = entry["row"]
        runs[dimension, count, fraction].append(entry)
    return runs


def combined(runs: list[dict]) -> tuple[float, float]:
    """Return the contact value of both estimates with least variance, and its standard error.

    The error follows from the scatter of runs, or of half runs if there are fewer than `LEAST_RUNS`.
    """
    if len(runs) < LEAST_RUNS:
        values = np.array([half for run in runs for half in run["halves"]])
        weights = np.array([part for run in runs for part in (run["middle"], run["events"] - run["middle"])])
    else:
        values = np.array([(run["virial"], run["rate"]) for run in runs])
        weights = np.array([run["events"] for run in runs])
    weights = weights / weights.sum()
    difference = values[:, 0] - values[:, 1]
    spread = np.sqrt(weights)[:, None] * (values - weights @ values)
    scatter = np.sqrt(weights) * difference
    share = np.clip(-(spread[:, 1] @ scatter) / (scatter @ scatter), 0.0, 1.0)  # E[difference] = 0, exactly
    each = values[:, 1] + share * difference
    mean = float(weights @ each)
    return mean, math.sqrt(weights @ (each - mean) ** 2 / (len(each) - 1.0))


def results(runs: dict[tuple, list[dict]]) -> dict[tuple, tuple[float, float]]:
    """Return the contact value of each row, and its standard error.

    Few runs do not know their own scatter. Of fewer than `MANY_RUNS`, the error is no less than half the rows
    of this density have for as many collisions, nor than independent collisions have. Where runs do not pass
    between the states of a system, the error is the standard deviation of runs: no number of them tells how
    likely each state is.
    """
    found = {row: combined(entries) for row, entries in runs.items()}
    events = {row: sum(entry["events"] for entry in entries) for row, entries in runs.items()}
    kinds = defaultdict(list)
    for row, (value, error) in found.items():
        kinds[row[0], row[2]].append(error / value * math.sqrt(events[row]))
    for row, (value, error) in found.items():
        if len(runs[row]) < MANY_RUNS:
            least = max(1.0, float(np.median(kinds[row[0], row[2]]))) / math.sqrt(events[row])
            found[row] = value, max(error, value * least)
        elif error / value * math.sqrt(events[row]) > SEPARATE:
            found[row] = value, error * math.sqrt(len(runs[row]))
    return found


def run_all(path: Path, rounds: int) -> None:
    """Append runs until every contact value is known to the target."""
    runs, failed = read(path), set()
    with path.open("a") as stream:

        def more(row: tuple, times: int) -> None:
            for _ in range(times):
                entry = one_run(*row, len(runs[row]))
                if entry is None:
                    failed.add(row)
                    return
                runs[row].append(entry)
                stream.write(json.dumps(entry) + "\n")
                stream.flush()

        for row in rows():
            more(row, PILOT - len(runs[row]))
        for turn in range(rounds):
            gain = gains({row: runs[row] for row in rows() if row not in failed})
            if not gain:
                return
            chosen = sorted(gain, key=gain.__getitem__, reverse=True)[:30]
            for row in chosen:
                more(row, BATCH)
            print(turn, len(gain), "rows above the target; least gain", gain[chosen[-1]], flush=True)


def gains(runs: dict[tuple, list[dict]]) -> dict[tuple, float]:
    """By how much one more run lowers the relative variance of each row above the target, per CPU time."""
    gain = {}
    for row, (value, error) in results(runs).items():
        if error / value > TARGET:
            gain[row] = (error / value) ** 2 / sum(entry["cpu"] for entry in runs[row])
    return gain


def table(path: Path) -> list[list]:
    """Rows of the table in the form of `theory.literature`."""
    found, runs = [], read(path)
    known = results(runs)
    for dimension, count, fraction in sorted(runs):
        container = {2: "square", 3: "cube"}[dimension]

        def row(quantity: str, value: float, error: float) -> list:
            digits = max(0, 1 - math.floor(math.log10(error)))
            numbers = f"{value:.{digits}f}", f"{error:.{digits}f}"
            return [dimension, quantity, fraction, count, container, *numbers, "small_systems"]  # noqa: B023

        value, error = known[dimension, count, fraction]
        first_order = 2.0 ** (dimension - 1) * fraction * (1.0 - 1.0 / count)
        rate = float(theory.collision_rate(fraction, dimension, contact=1.0)) * (1.0 - 1.0 / count)
        rate *= theory.speeds.mean_speed_factor(dimension * (count - 1))
        found.append(row("contact_value", value, error))
        found.append(row("Z", 1.0 + first_order * value, first_order * error))
        found.append(row("collision_rate", rate * value, rate * error))
        if diffusive := diffusion(dimension, count, runs[dimension, count, fraction]):
            found.append(row("diffusion", *diffusive))
    return found


def diffusion(dimension: int, count: int, runs: list[dict]) -> tuple[float, float] | None:
    """D by the slope of squared displacements from 10 to 60 collisions, and its error as of Brownian motion.

    None where the slope after 20 and after 60 collisions differ, as in a cage or without horizon.
    """
    moved = np.mean([np.array(run["moved"]) / run["interval"] for run in runs], axis=0) / (2.0 * dimension)
    freedoms = 0.5 * dimension * (count - 1.0) * SAMPLES * len(runs)

    def slope(first: int, last: int) -> tuple[float, float]:
        value = (moved[LAGS.index(last)] - moved[LAGS.index(first)]) / (last - first)
        return float(value), float(value) * math.sqrt(2.0 / 3.0 * last / freedoms)

    (early, first), (value, error), (late, last) = slope(1, 3), slope(1, 6), slope(6, 12)
    if value <= 0.0 or abs(late - early) > 3.0 * math.hypot(first, last) + 0.05 * value:
        return None
    return value, math.hypot(error, 0.5 * abs(late - early))


def fit(path: Path) -> None:
    """Print the coefficients of `finite_size.finite_size_remainder` that make the table most likely."""
    for dimension in (2, 3):
        rows = [(row, *known) for row, known in results(read(path)).items()]
        rows = [row for row in rows if row[0][0] == dimension and row[0][1] >= LEAST_FITTED]
        rows = [row for row in rows if side_of(*row[0]) >= SHORTEST]
        eta = np.array([row[2] for row, *_ in rows])
        count = np.array([row[1] for row, *_ in rows])
        side = np.array([side_of(*row) for row, *_ in rows])
        expansion = [finite_size._expansion(row[2], dimension, row[1], 100.0) for row, *_ in rows]
        value, error = np.array(expansion).T
        contact = np.array([entry[1] for entry in rows])
        scatter = np.array([entry[2] for entry in rows])
        differences, known = contact / value - 1.0, np.hypot(scatter, error) / value

        def deviation(p: np.ndarray) -> np.ndarray:
            return np.exp(p[0] + eta * (p[1] + eta * p[2]) - side * np.exp(p[3] + eta * p[4]))  # noqa: B023

        def surprise(p: np.ndarray) -> float:
            variance = deviation(p) ** 2 + known**2  # noqa: B023
            return 0.5 * float((np.log(variance) + differences**2 / variance).sum())  # noqa: B023

        starts = [(0, 0, 0, 1, -1), (2, 0, 0, 2, -3), (0, 5, 0, 1, 0), (10, -10, 0, 2, -4)]
        options = {"maxiter": 60000, "maxfev": 60000, "xatol": 1e-6, "fatol": 1e-8}
        found = min(
            (minimize(surprise, start, method="Nelder-Mead", options=options) for start in starts),
            key=lambda result: result.fun,
        )
        z = differences / np.hypot(deviation(found.x), known)
        print(
            dimension,
            len(rows),
            "rows",
            found.x.round(3).tolist(),
            "rms",
            np.sqrt((z**2).mean()),
            "max",
            abs(z).max(),
        )
        for n in np.lexsort((side, eta)):
            print(
                f"  {count[n]:4d} {eta[n]:.3f} side {side[n]:.2f} {differences[n]:+.4f} +- {known[n]:.4f}",
                f"remainder {deviation(found.x)[n]:.4f}",
            )


def main() -> None:
    """Run the systems, print their table, or fit the remainder."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("action", choices=["run", "table", "fit"])
    parser.add_argument("path", type=Path)
    parser.add_argument("--rounds", type=int, default=1000)
    options = parser.parse_args()
    if options.action == "run":
        run_all(options.path, options.rounds)
    elif options.action == "fit":
        fit(options.path)
    else:
        print("dimension,quantity,packing_fraction,count,container,value,error,source")
        print(*(",".join(map(str, row)) for row in table(options.path)), sep="\n")


if __name__ == "__main__":
    main()
