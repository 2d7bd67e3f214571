"""Pairs of particles: the radial distribution function.

Uncertainties are the scatter of consecutive blocks of the run.
"""

from __future__ import annotations

import numpy as np

from gaspart.analysis.estimators import estimator
from gaspart.analysis.expected.described import described
from gaspart.analysis.observable import Observable, observable
from gaspart.analysis.observables import require_defined
from gaspart.analysis.pair_impulses import g_by_impulses, kept, mixed_g, shell_volumes
from gaspart.analysis.run import Run, Source, open_run
from gaspart.analysis.statistics import means_of
from gaspart.errors import SceneError
from gaspart.keys.values import count_of, number
from gaspart.scene.impulses import FURTHEST
from gaspart.state.optional_tallies import PairImpulseTally

STRETCHES = 16
_BINS = 100
MOST_FRAMES = 320
"""Frames, evenly spaced, that are searched for pairs of particles."""


def rdf(
    source: Source, bins: int | None = None, furthest: float | None = None, start: float | None = None
) -> Observable:
    """Measure the radial distribution function g(r) of all particles of a periodic scene.

    Parameters
    ----------
    source : str, Path, Dataset or Simulation
        A trajectory, by its path or open, or a simulation.
    bins : int, optional
        Number of bins. Default: 100, or as the impulses of pairs that the run has stored.
    furthest : float, [length], optional
        Largest distance. Default: five of the largest diameters, or just below half of the shortest side; or
        as the impulses of pairs that the run has stored.
    start : float, [time], optional
        Frames before this time are discarded. Default: a quarter of the run.

    Returns
    -------
    Observable
        The function (distance,), dimensionless, mean over up to 320 frames.

    Raises
    ------
    SceneError
        For walls, fewer than two particles, too few frames and too large a distance.

    Notes
    -----
    g(r) is the number of pairs divided by the number for N particles that are independent of one another, N
    (N - 1) / 2 pairs in the volume: 1 at every distance in an ideal gas of any number. Of a fluid it tends to
    1 + (1 - S(0)) / N at large distances, S(0) its reduced compressibility [1]_.

    Impulses of pairs, in shells of which each bin has as many, make g(r) more accurate than counts
    (`gaspart.analysis.pair_impulses`); the attribute `estimator` says so. Theory: the value at contact that
    belongs to the pressure of N particles, at the first bins beyond the diameter only.

    References
    ----------
    .. [1] J. L. Lebowitz and J. K. Percus, Phys. Rev. 122, 1675 (1961).

    Examples
    --------
    >>> import gaspart as gp
    >>> box = gp.Container((10.0, 10.0), boundary="periodic")
    >>> scene = gp.Scene(box, [gp.Species(32, 0.5, temperature=1.0)])
    >>> simulation = gp.Simulation(scene, seed=1)
    >>> simulation.advance(40.0)
    >>> gp.analysis.rdf(simulation, bins=20).sizes["distance"]
    20
    """
    from gaspart.analysis.bond_order import radial_distribution

    with open_run(source, start) as run:
        require_defined("rdf", run.scene)
        has = kept(run)
        bins = count_of("bins", bins or (has.shells if has else _BINS), least=2)
        stored, lengths = run.data.sizes["atom"], run.scene.container.lengths
        if stored < 2:
            raise SceneError("count", stored, "a pair needs two particles")
        diameter, half = 2.0 * run.scene.largest_radius, FURTHEST * min(lengths)
        rule = f"must be positive and below half of the shortest side, {half:.4g}"
        end = min(5.0 * diameter, half) if has is None else has.furthest
        end = end if furthest is None else furthest
        end = number("furthest", end, rule, above=0.0, most=half)
        stretches = np.array_split(chosen_frames(run, np.arange(len(run.time))), STRETCHES)
        found = [radial_distribution(run.positions[part], lengths, bins, end) for part in stretches]
        each = np.array([g for _, g in found], dtype=float)
        parts = g_by_impulses(run, np.array([part[0] for part in stretches]), bins, end)
        if parts is not None:
            each = mixed_g(each, parts, shell_volumes(bins, run.dimension))
        values, errors = means_of(each)
        distance = np.asarray(found[0][0], dtype=float)
        along = {"distance": (distance, {"units": "length", "long_name": "distance"})}
        about = described("rdf", run, distance, end / bins)
        result = observable("rdf", along, values, errors, **about)
        asked = PairImpulseTally(float(end), 200, 0.1)
        result.attrs |= estimator(run, "counts", "counts and impulses", parts is not None, asked)
        return result


def chosen_frames(run: Run, values: np.ndarray) -> np.ndarray:
    """Return the values of up to `MOST_FRAMES` frames, evenly spaced.

    Parameters
    ----------
    run : Run
        The run.
    values : ndarray, shape (T, ...)
        Values of all frames.

    Returns
    -------
    ndarray
        The values of the chosen frames.

    Raises
    ------
    SceneError
        If there are too few frames.
    """
    if len(run.time) < STRETCHES:
        raise SceneError("frames", len(run.time), f"an error needs {STRETCHES} or more")
    return values[:: -(-len(run.time) // MOST_FRAMES)]
