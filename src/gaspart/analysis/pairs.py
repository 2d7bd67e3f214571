"""Pairs of particles: the radial distribution function.

Uncertainties come from the scatter between consecutive blocks of the run.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from gaspart.analysis.estimate import Estimate
from gaspart.analysis.expected.equilibrium import describe, equation_of
from gaspart.analysis.impulses import estimator, mixture
from gaspart.analysis.observable import LEAST_INTERVALS, Observable, observable, with_freedom
from gaspart.analysis.observables import KEPT, require_defined
from gaspart.analysis.run import Run, Source, open_run, require_collisions
from gaspart.analysis.statistics import correlated_mean, histogram_means
from gaspart.errors import SceneError
from gaspart.keys.values import count_of, number
from gaspart.state.tally import FURTHEST, PairImpulseTally
from gaspart.theory.bulk import EXACT
from gaspart.theory.geometry import unit_sphere_surface
from gaspart.theory.speeds import mean_speed_factor
from gaspart.trajectory.correlator import pair_names, pairs_of
from gaspart.trajectory.run_options import stored_tally
from gaspart.workers import in_threads

# Pairs in a periodic container, counted by their distance.

_COLUMNS, _BOXES = 2, 8
"""Numbers of columns and of boxes per largest distance in `count_pairs`, unless the density is low."""
_MOST_BOXES = 4
"""Maximum number of boxes per particle."""


def pair_counts(
    frames: np.ndarray, lengths: Sequence[float] | np.ndarray, bins: int, furthest: float, threads: int = 1
) -> np.ndarray:
    """Count the pairs of all frames in equal intervals of the distance to the nearest image, in float64."""
    from gaspart.kernels.analysis.pairs import MARGIN, count_pairs  # importing numba takes 0.4 s

    sides = np.asarray(lengths, dtype=float)
    if not 0.0 < furthest <= 0.5 * sides.min():
        raise ValueError(f"furthest: {furthest} (must be positive, and at most {0.5 * sides.min()})")
    _, count, dimension = np.shape(frames)
    if count < 2:
        return np.zeros(bins, dtype=np.int64)
    size, first = np.ones(3), 3 - dimension  # discs: a first axis with a single column is added
    size[first:] = sides
    numbers = _boxes(size, count, furthest, first)
    spans = np.ceil(MARGIN * furthest * numbers / size).astype(np.int64)[:2]
    spans[:first] = 0

    def of_frame(positions: np.ndarray) -> np.ndarray:
        coordinates, counts = np.zeros((3, count)), np.zeros(bins, dtype=np.int64)
        coordinates[first:] = np.asarray(positions).T
        count_pairs(coordinates, size, numbers, spans, float(furthest), counts)
        return counts

    counts = in_threads(of_frame, frames, threads)
    return np.asarray(np.sum(counts, axis=0, initial=0, dtype=np.int64))


def _boxes(size: np.ndarray, count: int, furthest: float, first: int) -> np.ndarray:
    """Return the numbers of boxes along each axis for `count_pairs`."""
    numbers = np.ones(3, dtype=np.int64)
    width = max(furthest / _COLUMNS, float(size.prod() / count) ** (1.0 / (3 - first)))
    most = _MOST_BOXES * count
    while True:
        numbers[first:2] = np.clip(size[first:2] / width, 1, most)
        if numbers.prod() <= most:
            break
        width *= 2.0
    numbers[2] = int(np.clip(_BOXES * size[2] / furthest, 1, most // numbers[:2].prod()))
    return numbers


def radial_distribution(
    frames: np.ndarray, lengths: Sequence[float] | np.ndarray, bins: int, furthest: float, threads: int = 1
) -> tuple[np.ndarray, np.ndarray]:
    """Compute centres (bins,) of shells and g(r) of frames (T, N, d), over N (N - 1) / 2 pairs of an ideal
    gas.
    """
    count = np.shape(frames)[1]
    counts = pair_counts(frames, lengths, bins, furthest, threads)
    g = counts / (len(frames) * ideal_counts(count, lengths, bins, furthest))
    return (np.arange(bins) + 0.5) * (furthest / bins), g


def ideal_counts(count: int, lengths: Sequence[float] | np.ndarray, bins: int, furthest: float) -> np.ndarray:
    """Compute the mean `pair_counts` of a frame of an ideal gas."""
    dimension = len(lengths)
    unit = unit_sphere_surface(dimension) / dimension * (furthest / bins) ** dimension
    pairs = 0.5 * count * (count - 1)
    return np.asarray(pairs * unit * shell_volumes(bins, dimension) / np.prod(lengths))


# g(r) from the momentum that pairs of particles gain along their separation.
#
# In equilibrium this determines k_B T g(r) without counting noise, apart from a constant that is common to
# all distances (`Tally.contact_impulse_sum`; docs/estimators.md has the derivation). The constant follows
# from the counted number of pairs within the largest distance. In wide shells of a dense fluid counts have
# less noise. So both estimates are averaged with weights, as densities are (`gaspart.analysis.impulses`).


_ALIKE = 1e-9
"""Relative difference of two shell thicknesses that is attributed to rounding."""


def read_pair_impulses(run: Run) -> PairImpulseTally | None:
    """Return the stored pair impulses of a run; None without them or without a known temperature."""
    return None if run.is_subset else stored_tally(run.data.attrs, PairImpulseTally)


def shell_volumes(bins: int, dimension: int) -> np.ndarray:
    """Compute the volumes (bins,) of shells of equal thickness, divided by the first volume."""
    return np.diff(np.arange(bins + 1.0) ** dimension)


def g_by_impulses(run: Run, starts: np.ndarray, bins: int, furthest: float) -> np.ndarray | None:
    """Compute two contributions (2, S, bins) to g(r): from colliding pairs and from all other pairs. The
    contributions are for S blocks of a run that begin at the frames `starts` (S,). Return None if the run has
    not stored pair impulses, if the shells do not consist of whole stored shells, if a block has no duration,
    or if no pair has collided. Without collisions impulses do not determine g(r), although g(r) is not 0.
    """
    has = read_pair_impulses(run)
    if has is None or starts[-1] == len(run.time) - 1 or furthest > has.furthest * (1.0 + _ALIKE):
        return None
    each = furthest / bins * has.shells / has.furthest
    merged = round(each)
    if merged < 1 or abs(each - merged) > _ALIKE * each:
        return None
    ends = np.append(starts, len(run.time) - 1)
    sums = np.stack([run.data[name].values[ends] for name in ("contact_impulse_sum", "other_impulse_sum")])
    if not (sums[0, -1] - sums[0, 0]).any():
        return None
    rates = np.diff(sums, axis=1) / (run.temperature * np.diff(run.time[ends])[:, None])
    fine = shell_volumes(bins * merged, run.dimension)
    parts = (rates[..., : len(fine)] * fine).reshape(2, len(starts), bins, merged).sum(axis=3)
    return np.asarray(parts / fine.reshape(bins, merged).sum(axis=1))


def mixed_g(counted: np.ndarray, parts: np.ndarray, volumes: np.ndarray) -> np.ndarray:
    """Compute g(r) (S, bins) from counts (S, bins) and impulses (2, S, bins); `volumes` (bins,) of shells."""
    contacts, total = parts[0].mean(axis=0), parts.sum(axis=0)
    missing = ((counted - total) @ volumes) / (contacts @ volumes)
    impulses = total + missing[:, None] * contacts
    return counted + mixture(counted, impulses, periodic=False) * (impulses - counted)


STRETCHES = 16
_BINS = 100
MOST_FRAMES = 320
"""Maximum number of evenly spaced frames in which pairs are counted."""


def rdf(
    source: Source, bins: int | None = None, furthest: float | None = None, start: float | None = None
) -> Observable:
    """Measure the radial distribution function g(r) of all particles of a periodic scene.

    g(r) is the number of pairs at the distance r divided by the mean number for N independent particles,
    which form N (N - 1) / 2 pairs. So it is 1 at all distances in an ideal gas of any N. In a fluid it tends
    to 1 + (1 - S(0)) / N at large distances; S(0) is the reduced compressibility (J. L. Lebowitz and J. K.
    Percus, Phys. Rev. 122, 1675 (1961)).

    If the run has stored pair impulses, and each bin consists of an equal number of stored shells, g(r) is
    more accurate than from counts alone (`gaspart.analysis.pairs`). The attribute `estimator` names the
    method. The theoretical value is the mean over each bin of the approximation of Verlet and Weis, for
    spheres in the fluid phase. The error of an empty bin is NaN, or 0 at distances at which hard particles
    would overlap.

    Parameters
    ----------
    bins : int, optional
        Number of bins. Default: 100, or the bins of the stored pair impulses.
    furthest : float, [length], optional
        Largest distance. Default: the largest distance of the stored pair impulses. Without stored impulses,
        the default is five times the largest diameter, but less than half of the shortest side.

    Returns
    -------
    Observable
        The function g(r), dimensionless, shape (distance,), averaged over up to 320 frames.

    Raises
    ------
    SceneError
        If the scene has walls or fewer than two particles, if there are too few frames, or if the distance is
        too large.
    """
    with open_run(source, start) as run:
        require_defined("rdf", run.scene)
        has = read_pair_impulses(run)
        bins = count_of("bins", bins or (has.shells if has else _BINS), least=2)
        stored, lengths = run.data.sizes["atom"], run.scene.container.lengths
        if stored < 2:
            raise SceneError("count", stored, "a pair needs two particles")
        diameter, half = 2.0 * run.scene.largest_radius, FURTHEST * min(lengths)
        rule = f"must be positive and below half of the shortest side, {half:.4g}"
        end = min(5.0 * diameter, half) if has is None else has.furthest
        end = end if furthest is None else furthest
        end = number("furthest", end, rule, above=0.0, most=half)
        stretches, ideal = stretches_of(run), ideal_counts(stored, lengths, bins, end)
        each = np.empty((STRETCHES, bins))
        for n, part in enumerate(stretches):
            blocks = run.blocks("coordinates", part)
            counts = sum(pair_counts(block, lengths, bins, end) for block in blocks)
            each[n] = counts / (len(run.time[part]) * ideal)
        parts = g_by_impulses(run, np.array([part.start for part in stretches]), bins, end)
        if parts is not None:
            each = mixed_g(each, parts, shell_volumes(bins, run.dimension))
        values, errors, freedoms = histogram_means(each)
        distance = (np.arange(bins) + 0.5) * (end / bins)
        if equation_of(run) == EXACT:  # centres of hard particles are never closer than this
            within = distance + 0.5 * end / bins <= 2.0 * run.radii[:stored].min()
            exact = within & (values == 0.0)
            errors[exact], freedoms[exact] = 0.0, STRETCHES - 1.0
        along = {"distance": (distance, {"units": "length", "long_name": "distance"})}
        about = describe("rdf", run, distance, end / bins)
        result = observable("rdf", along, values, errors, **about)
        tally = PairImpulseTally(float(end), 200, 0.1)
        result.attrs |= estimator(run, "counts", "counts and impulses", parts is not None, tally)
        return with_freedom(result, freedoms)


def chosen_frames(run: Run, values: np.ndarray) -> np.ndarray:
    """Select the values in up to `MOST_FRAMES` evenly spaced frames."""
    if len(run.time) < STRETCHES:
        raise SceneError("frames", len(run.time), f"an error needs {STRETCHES} or more")
    return values[:: -(-len(run.time) // MOST_FRAMES)]


def stretches_of(run: Run) -> list[slice]:
    """Divide the `chosen_frames` of a run into 16 consecutive blocks."""
    numbers = chosen_frames(run, np.arange(len(run.time)))
    step = int(numbers[1] - numbers[0])
    return [slice(int(part[0]), int(part[-1]) + 1, step) for part in np.array_split(numbers, STRETCHES)]


# Collision rates and contact values of each pair of species.


def pair_collision_rates(source: Source, start: float | None = None) -> Observable:
    """Measure the collision rate of a particle of one species with a second species.

    The theoretical rate is exact except for the contact values. These are for an infinite mixture. A particle
    of species i has N_i - 1 partners of its own species. The mean speed is computed for the finite number of
    particles at fixed energy.

    Parameters
    ----------
    source : str, Path, Dataset or Simulation
        A trajectory of a run with `pairs` (a path or an open trajectory), or a simulation, which is run
        again.

    Returns
    -------
    Observable
        Collision rate for each pair of species, (pair,), in [1/time]: the number of collisions per time of
        one particle of the first species with all particles of the second species.

    Raises
    ------
    SceneError
        If the scene has single particles, if there are too few frames, or if the run was made without
        `pairs`.

    Examples
    --------
    >>> import gaspart as gp
    >>> box = gp.Container((10.0, 10.0), boundary="periodic")
    >>> gases = [gp.Species(20, radius, temperature=1.0) for radius in (0.3, 0.5)]
    >>> scene = gp.Scene(box, gases)
    >>> simulation = gp.Simulation(scene, seed=1)
    >>> simulation.advance(40.0)
    >>> gp.analysis.pair_collision_rates(simulation).sizes["pair"]
    3
    """
    with open_run(source, start, pairs=True) as run:
        require_defined("pair_rates", run.scene)
        return _of_pairs("pair_rates", "pair_collision_rate", run, estimates_of(run, rate_scales(run)))


def contact_values(source: Source, start: float | None = None) -> Observable:
    """Measure the contact value g_ij of each pair of species from its collision rate.

    The number N_ij of collisions in the time t is

        n_ij S sigma_ij^(d-1) g_ij sqrt(k_B T / (2 pi mu_ij)) t / V,

    with n_ij = N_i N_j or N_i (N_i - 1) / 2 pairs of particles, S = 2 pi (2D) or 4 pi (3D), and the reduced
    mass mu_ij. This formula is exact in equilibrium (S. Chapman and T. G. Cowling (1970)), if the mean speed
    is computed for the finite number of particles at fixed energy.

    Parameters
    ----------
    source : str, Path, Dataset or Simulation
        A trajectory of a run with `pairs` (a path or an open trajectory), or a simulation, which is run
        again.

    Returns
    -------
    Observable
        The contact values (pair,), dimensionless.

    Raises
    ------
    SceneError
        Under the conditions of `pair_collision_rates`, and for a scene with walls, contacts that lose energy,
        or a polydisperse species.
    """
    with open_run(source, start, pairs=True) as run:
        estimates = estimates_of(run, contact_scales(run))
        return _of_pairs("contact_values", "contact_value", run, estimates)


def rate_scales(run: Run) -> np.ndarray:
    """Compute collisions of each pair of species per collision of one particle of the pair's first
    species.
    """
    counts = [kind.count for kind in run.scene.species]
    pairs = pairs_of(run.scene)
    return np.array([counts[i] / (2.0 if i == j else 1.0) for i, j in pairs])


def contact_scales(run: Run) -> np.ndarray:
    """Compute the collision rate of each pair of species divided by its contact value."""
    require_defined("contact_values", run.scene)
    scene, d = run.scene, run.dimension
    scales = []
    for i, j in pairs_of(scene):
        first, second = scene.species[i], scene.species[j]
        number = first.count * second.count if i != j else first.count * (first.count - 1) / 2.0
        speed = math.sqrt(run.temperature * (1.0 / first.mass + 1.0 / second.mass) / (2.0 * math.pi))
        between = (first.radius + second.radius) ** (d - 1)
        scales.append(number * unit_sphere_surface(d) * between * speed / scene.container.volume)
    return np.array(scales) * mean_speed_factor(run.freedom)


def estimates_of(run: Run, scales: np.ndarray) -> list[Estimate]:
    """Estimate the collision rate of each pair of species, divided by the scale of the pair."""
    if "pair_collisions" not in run.data:
        raise SceneError(*KEPT["pairs"])
    if len(run.time) <= LEAST_INTERVALS:
        raise SceneError("frames", len(run.time), f"an error needs {LEAST_INTERVALS + 1} or more")
    require_collisions(run)
    rates = run.increments("pair_collisions") / np.diff(run.time)[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):  # a species with a single particle has no pair
        series = (rates / scales).T
    nothing = Estimate(math.nan, math.nan)
    return [
        correlated_mean(values, LEAST_INTERVALS).estimate if np.ptp(values) > 0.0 else nothing
        for values in series
    ]


def _of_pairs(observed: str, name: str, run: Run, estimates: list[Estimate]) -> Observable:
    """Build the result of the observable `observed` of pairs, with a variable called `name`."""
    along = {"pair": (np.array(pair_names(run.scene)), {"long_name": "numbers of two species, from 0"})}
    values, errors = np.array([[estimate.value, estimate.error] for estimate in estimates]).T
    return observable(name, along, values, errors, **describe(observed, run))
