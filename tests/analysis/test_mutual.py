"""Mutual diffusion of two species."""

import math
from functools import partial

import numpy as np
import pytest
from scipy.signal import lfilter

import gaspart as gp
from gaspart import theory
from gaspart.analysis import diffusion
from gaspart.errors import SceneError


def _scene(eta, *kinds, dimension=3, boundary="periodic"):
    volume = sum(
        kind.count * theory.particle_volume(dimension) * (2.0 * kind.radius) ** dimension for kind in kinds
    )
    return gp.Scene(gp.Container(((volume / eta) ** (1.0 / dimension),) * dimension, boundary), kinds)


def _kind(count, radius=0.5, mass=1.0):
    return gp.Species(count, radius, mass=mass, temperature=1.0, exact_temperature=True)


def _run(scene, path, seed, collisions, engine=None):
    kinds = scene.species
    rates = theory.mixture_collision_rates(
        scene.packing_fraction,
        3,
        [2.0 * kind.radius for kind in kinds],
        [kind.count for kind in kinds],
        masses=[kind.mass for kind in kinds],
    )
    each = float(np.average(rates.sum(axis=1), weights=[kind.count for kind in kinds]))
    return gp.run(
        scene, engine or gp.EventDriven(), seed, collisions / each, 1.0 / each, path, displacements=True
    )


def test_species_alike_diffuse_as_single_particles(tmp_path):
    """Labels do not matter to the motion, so D_12 is D, exactly; both are of the same runs."""
    ratios = []
    for seed in range(6):
        path = _run(_scene(0.2, _kind(40), _kind(88)), tmp_path / f"{seed}.nc", seed, 4000.0)
        mutual, single = gp.analysis.mutual_diffusion(path), gp.analysis.diffusion_coefficient(path)
        ratios.append(float(mutual.estimate) / float(single.estimate))
    assert np.mean(ratios) == pytest.approx(1.0, abs=3.0 * 0.075 / math.sqrt(6))  # 7.5 % for each run


def test_dilute_gas_of_unequal_masses(tmp_path):
    """Chapman and Enskog's value, to which higher approximations add some 3 %."""
    scene = _scene(0.01, _kind(100), _kind(100, mass=8.0))
    found = [gp.analysis.mutual_diffusion(_run(scene, tmp_path / f"{n}.nc", n, 3000.0)) for n in range(4)]
    ratios = [float(one.estimate / one.theory) for one in found]
    scatter = np.mean([float(one.error / one.theory) ** 2 for one in found]) ** 0.5
    assert scatter < 0.12
    assert np.mean(ratios) == pytest.approx(1.015, abs=3.0 * scatter / 2.0 + 0.015)


def _last(path, run):
    return path[-len(run.time) :]


def test_lags_are_those_from_which_on_the_coefficient_no_longer_changes(tmp_path, monkeypatch):
    """Separations whose velocity is correlated over 10 frames, a collision each: at 12 to 24, .825 of D."""
    path = _run(_scene(0.05, _kind(4), _kind(4)), tmp_path / "a.nc", 1, 6000.0)
    decay, values, lags = math.exp(-0.1), [], []
    for seed in range(6):
        kicks = np.random.default_rng(seed).normal(size=(9000, 3))
        separations = np.cumsum(lfilter([1.0], [1.0, -decay], kicks, axis=0), axis=0)
        monkeypatch.setattr(diffusion, "_separation", partial(_last, separations))
        result = gp.analysis.mutual_diffusion(path)
        values.append(float(result.estimate))
        lags.append(float(result.attrs["lags"][1]))
        with gp.open_trajectory(path) as run:
            interval = float(run["time"][1])
    exact = 0.25 * 8.0 / 2.0 / (1.0 - decay) ** 2 / interval  # N x_1 x_2 times half of the slope per axis
    assert np.mean(values) / exact == pytest.approx(0.97, abs=0.1)
    assert np.mean(values) / exact > 0.89 and np.mean(lags) / interval > 35.0


@pytest.mark.parametrize("dimension", [2, 3])
def test_theory_of_species_alike_is_that_of_self_diffusion(dimension):
    """Enskog's D in the first approximation: 3/(8 n sigma^2 g) and 1/(2 n sigma g) sqrt(kT / (pi m))."""
    eta, mass, temperature = 0.25, 3.0, 2.0
    found = theory.enskog_mutual_diffusion(
        eta, dimension, [1.0, 1.0], [1, 3], temperature=temperature, masses=mass
    )
    contact = float(theory.contact_value(eta, dimension))
    density = float(theory.number_density(eta, dimension))
    factor = {2: 0.5, 3: 0.375}[dimension]
    expected = factor / (density * contact) * math.sqrt(temperature / (math.pi * mass))
    assert found == pytest.approx(expected, rel=1e-9)


def test_theory_refuses_three_species():
    with pytest.raises(SceneError, match="that of two species"):
        theory.enskog_mutual_diffusion(0.1, 3, [1.0, 1.0, 1.0])


@pytest.mark.parametrize(
    ("scene", "line"),
    [
        (_scene(0.1, _kind(50)), "that of two species"),
        (_scene(0.1, _kind(20), _kind(20), boundary="wall"), "needs a periodic container"),
        (_scene(0.1, _kind(20), _kind(20), dimension=2), "no diffusion coefficient"),
    ],
)
def test_refusals(scene, line):
    simulation = gp.Simulation(scene, gp.EventDriven(), seed=1)
    simulation.advance(duration=20.0)
    with pytest.raises(SceneError, match=line):
        gp.analysis.mutual_diffusion(simulation)
