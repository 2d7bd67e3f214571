"""The symmetry of size: from 2 to 500 particles, every observable that states a theory agrees with it."""

import numpy as np
import pytest

import gaspart as gp
from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.observables import OBSERVABLES

COLLISIONS, FRAMES = 60_000, 257
CASES = [
    (3, 2, 0.1),
    (3, 2, 0.3),
    (3, 3, 0.1),
    (3, 8, 0.2),
    (3, 32, 0.3),
    (3, 108, 0.47),
    (2, 2, 0.3),
    (2, 12, 0.5),
]
GRID = [
    (d, n, eta)
    for d in (2, 3)
    for n in (2, 3, 4, 5, 7, 10, 20, 50, 100, 200, 500)
    for eta in (0.05, 0.2, 0.4, 0.48)
]


def disagreements(dimension, count, eta, folder):
    """Return the observables with a theory, and those that are further than 4 standard errors from it."""
    side = (count * theory.particle_volume(dimension) / eta) ** (1.0 / dimension)
    container = gp.Container((side,) * dimension, boundary="periodic")
    kind = gp.Species(count, 0.5, temperature=1.0, arrangement="compressed", exact_temperature=True)
    scene = gp.Scene(container, [kind])
    interval = 2.0 * COLLISIONS / count / FRAMES / float(theory.collision_rate(eta, dimension))
    path = gp.run(
        scene, seed=3, duration=(FRAMES - 1) * interval, sample_interval=interval, path=folder / "a.nc"
    )
    stated, wrong = [], []
    for name in OBSERVABLES:
        try:
            result = gp.measure(path, name)
        except gp.SceneError:
            continue
        key = next(iter(result.data_vars))
        if f"{key}_theory" not in result:
            continue
        if np.isnan(result[f"{key}_theory_error"]).all():
            continue
        stated.append(name)
        measured = Estimate.of(result, key)
        unsure = result[f"{key}_theory_error"].values
        difference = measured - Estimate(result[f"{key}_theory"].values, np.hypot(unsure, 1e-12))
        z = np.abs(np.atleast_1d(difference.deviation))
        cells = np.isfinite(z)
        if cells.any() and z[cells].max() > 4.0 + 0.5 * (cells.sum() > 20):
            wrong.append((name, float(z[cells].max())))
    return stated, wrong


@pytest.mark.thorough
@pytest.mark.parametrize(("dimension", "count", "eta"), CASES)
def test_few_particles_are_as_theory_states(dimension, count, eta, tmp_path):
    stated, wrong = disagreements(dimension, count, eta, tmp_path)
    assert not wrong and {"Z", "collision_rate"} <= set(stated)


@pytest.mark.thorough
@pytest.mark.parametrize(("dimension", "count", "eta"), GRID)
def test_any_number_of_particles_is_as_theory_states(dimension, count, eta, tmp_path):
    assert not disagreements(dimension, count, eta, tmp_path)[1]
