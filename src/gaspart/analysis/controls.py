"""Control variates: what fluctuates with a mean over time, and has itself a mean that is known exactly.

A wall is given what particles carry to it. By the virial theorem along its normal, of particles of one size
between two walls whose centres can move a distance h,

    (I_low + I_high) h / 2 = int dt sum m v^2 + sum of r dp over contacts - change of sum m x v,

with x from the middle, and I_low - I_high is the change of the momentum. Of the right-hand side all but the
collisional part has a known mean: both changes 0, and sum m v^2 that of an energy which all directions share
evenly. So their deviations from these are taken off, as much as a regression says (docs/design-notes.md).
"""

from __future__ import annotations

import numpy as np

from gaspart.analysis.estimators import engine_class, knows_energies
from gaspart.analysis.impulses import kept
from gaspart.analysis.run import Run

_LEAST, _MOST = 32, 128
"""Groups of a run, from half of which coefficients are estimated: with fewer they are not, with more no
better. In each a particle collides once or more, so that its energy turns to other directions."""
FEWEST = 10
"""Moving particles without which pressures have no controls: fewer share their energy among directions too
slowly for coefficients of a regression. Of two discs in 2.6 x 2.9, 52 of 60 values were within two errors."""


def wall_controls(run: Run, axis: int) -> np.ndarray | None:
    """(T - 1, 3) in each interval, per time: sum m v^2 of the velocities along an axis less its known mean,
    and the changes of the momentum and of sum m x v along it. None unless the run has kept impulses along
    this axis and the states of all particles, and is in equilibrium at a constant kinetic energy."""
    has = kept(run.data)
    if has is None or has.axis != "xyz"[axis] or not run.has_states:
        return None
    if not knows_energies(engine_class(run), run.scene):
        return None
    time = np.diff(run.time)
    width = float(run.scene.container.lengths[axis]) / has.bins
    carried = run.increments("momentum_flux_sum").sum(axis=(1, 2)) * width / time
    changes = np.diff(stores(run)[axis], axis=0) / time[:, None]
    return np.column_stack([carried - run.scene.moving_count * run.temperature, changes])


def stores(run: Run) -> np.ndarray:
    """(d, T, 2) of each axis the total momentum and sum m x v of the moving particles at each frame, x from
    the middle; (d, T, 0) of a file that lacks some."""
    if not run.has_states:
        return np.zeros((run.dimension, len(run.time), 0))
    velocities, masses = run.velocities[:, run.moving], run.masses[run.moving]
    centred = run.positions[:, run.moving] - 0.5 * np.array(run.scene.container.lengths)
    momentum = np.einsum("tnd,n->dt", velocities, masses)
    return np.stack([momentum, np.einsum("tnd,tnd,n->dt", centred, velocities, masses)], axis=2)


def group_count(run: Run) -> int:
    """Return in how many groups the intervals of a run are for a regression; 0 if they or the particles are
    too few."""
    if run.moving.sum() < FEWEST:
        return 0
    collided = 2.0 * run.increments("collisions").sum() / max(1, int(run.moving.sum()))
    found = min(_MOST, len(run.time) - 1, int(collided))
    return found if found >= _LEAST else 0


def controlled(series: np.ndarray, controls: np.ndarray, groups: int) -> np.ndarray:
    """(K,) a series less what it has in common with controls (K, R) of mean 0.

    The coefficients for each half are those of a regression of the other half, in half of so many groups of
    consecutive values: they depend on no noise that they multiply, so that the mean is unbiased.
    """
    half, found = len(series) // 2, series.copy()
    first, second = slice(None, half), slice(half, None)
    for used, other in ((first, second), (second, first)):
        values = np.column_stack([series[other], controls[other]])
        means = np.stack([part.mean(axis=0) for part in np.array_split(values, groups // 2)])
        means -= means.mean(axis=0)
        found[used] -= controls[used] @ np.linalg.lstsq(means[:, 1:], means[:, 0], rcond=None)[0]
    return found
