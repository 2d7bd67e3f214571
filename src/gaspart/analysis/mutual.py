"""Mutual diffusion: how two species pass through one another."""

from __future__ import annotations

import numpy as np

from gaspart.analysis.diffusion import lags_of_slopes
from gaspart.analysis.expected.described import described
from gaspart.analysis.motion import unwrapped
from gaspart.analysis.observable import Observable, scalar
from gaspart.analysis.observables import require_defined
from gaspart.analysis.run import Run, Source, open_run


def mutual_diffusion(source: Source, start: float | None = None) -> Observable:
    """Measure the coefficient of mutual diffusion of two species by Maxwell and Stefan.

    Parameters
    ----------
    source : str, Path, Dataset or Simulation
        A trajectory, by its path or open, or a simulation.
    start : float, [time], optional
        Frames before this time are discarded. Default: a quarter of the run.

    Returns
    -------
    Observable
        D_12 in [length^2/time]. Theory: Enskog's in the first approximation.

    Raises
    ------
    SceneError
        For other numbers of species, fixed particles, walls, contacts that lose energy, discs, which have no
        such coefficient, frames too far apart, and runs that are too short.

    Notes
    -----
    With X_1 and X_2 the mean displacements of the species, x_1 and x_2 their fractions of N particles, it is

        D_12 = x_1 x_2 N / (2 d) d/dt <|X_1(t) - X_2(t)|^2>,

    by the rise from 12 to 24 collisions of a particle [1]_ [2]_. Fick's coefficient is D_12 times the
    thermodynamic factor, which is 1 for species of one size. Of species that differ in nothing but their
    numbers D_12 is the D of a single particle, exactly. X_1 - X_2 is one vector, however many particles there
    are: only longer runs are more accurate.

    References
    ----------
    .. [1] E. Helfand, Phys. Rev. 119, 1 (1960).
    .. [2] R. Krishna and J. M. van Baten, Ind. Eng. Chem. Res. 44, 6939 (2005).

    Examples
    --------
    >>> import gaspart as gp
    >>> box = gp.Container((5.0, 5.0, 5.0), boundary="periodic")
    >>> gases = [gp.Species(20, radius, temperature=1.0) for radius in (0.4, 0.5)]
    >>> scene = gp.Scene(box, gases)
    >>> simulation = gp.Simulation(scene, seed=1)
    >>> simulation.advance(60.0)
    >>> gp.analysis.mutual_diffusion(simulation).estimate.attrs["units"]
    'length^2 / time'
    """
    with open_run(source, start) as run:
        require_defined("mutual_diffusion", run.scene)
        _, early, late = lags_of_slopes(run)
        apart = _separation(run)
        rise = _squares(apart, late) - _squares(apart, early)[: len(apart) - late]
        lag = run.interval * (late - early)
        first, second = (kind.count / run.count for kind in run.scene.species)
        series = first * second * run.count / (2.0 * run.dimension * lag) * rise
        edges = run.time[: len(series) + 1]
        return scalar("mutual_diffusion", series, edges, **described("mutual_diffusion", run))


def _separation(run: Run) -> np.ndarray:
    """(T, d) X_1 - X_2."""
    paths = unwrapped(run)
    return np.subtract(*(paths[:, run.species == kind].mean(axis=1) for kind in (0, 1)))


def _squares(path: np.ndarray, lag: int) -> np.ndarray:
    """(T - lag,) the squared change over a lag, from each time on."""
    return ((path[lag:] - path[:-lag]) ** 2).sum(axis=1)
