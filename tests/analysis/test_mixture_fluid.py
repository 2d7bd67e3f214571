"""Mixtures: structure factors of pairs, chemical potentials of species, heat conducted without diffusion."""

from dataclasses import replace

import numpy as np
import pytest

import gaspart as gp
from gaspart.analysis.run import open_run
from gaspart.analysis.transport import green_kubo
from gaspart.theory.mixture_properties import dilute_mixture_conductivity
from gaspart.yaml_text import dump_yaml

A = gp.analysis
MIXTURE = gp.Scene(
    gp.Container((5.0, 6.0, 5.0), "periodic"),
    [gp.Species(56, 0.5, temperature=1.0), gp.Species(30, 0.3, temperature=1.0, mass=0.3)],
)


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """Spheres of two sizes at a packing fraction of 0.22."""
    folder = tmp_path_factory.mktemp("mixture")
    return gp.run(MIXTURE, gp.EventDriven(), 1, 200.0, 0.5, folder / "run.nc")


def test_partial_factors_sum_to_that_of_all(path):
    found, whole = (function(path, bins=12, highest=14.0) for function in PARTS)
    assert found.estimate.dims == ("pair", "wave_number")
    like, unlike, other = found.estimate.values
    first = 56 / 86
    total = first * like + (1.0 - first) * other + 2.0 * (first * (1.0 - first)) ** 0.5 * unlike
    np.testing.assert_allclose(total, whole.estimate, rtol=1e-12)


PARTS = (A.partial_structure_factors, A.structure_factor)


def test_partial_factors_are_those_of_percus_and_yevick(path):
    """To 0.05, the size of what that lacks at the first maximum; beside it, 0 and 1 would be off by 0.7."""
    found = A.partial_structure_factors(path, bins=12, highest=14.0)
    assert (np.abs(found.estimate - found.theory) < 0.05 + 3.0 * found.error).all()
    assert float(found.error.median()) < 0.02
    assert float(np.abs(found.theory - [[1.0], [0.0], [1.0]]).max()) > 0.6


def test_each_species_has_its_chemical_potential(path):
    """By the equation of state of Santos and others, with the correction for 86 particles (0.03 of the large
    ones), which insertion resolves; without places near the others' surfaces it would be less by half."""
    with gp.open_trajectory(path) as data:
        found = A.chemical_potential(data.isel(frame=slice(0, None, 2)), trials=256)
    assert found.estimate.dims == ("species",) and (found.error < 0.02).all()
    assert (np.abs(found.estimate - found.theory) < 3.0 * found.error).all()
    assert (found["frames_with_success"] > 140).all()


@pytest.mark.parametrize("function", [A.chemical_potential, A.thermal_conductivity])
def test_many_sizes_have_no_species(path, function):
    many = replace(MIXTURE, species=[replace(MIXTURE.species[0], polydispersity=0.1), MIXTURE.species[1]])
    with gp.open_trajectory(path) as data, pytest.raises(gp.SceneError, match=r"species\[0\].polydispersity"):
        function(data.assign_attrs(scene=dump_yaml(many.to_dict())))


@pytest.mark.thorough
def test_a_mixture_conducts_without_diffusion(tmp_path):
    """Ten times as heavy spheres: half of the flux of energy is that of diffusing species. Of equal ones it
    is what their common gas conducts."""
    light = gp.Species(32, 0.5, temperature=1.0, exact_temperature=True)
    scene = gp.Scene(gp.Container((14.0,) * 3, "periodic"), [light, replace(light, mass=10.0)])
    kept = {"correlations": gp.Correlations(5.0, 20, stress=True), "displacements": True}
    path = gp.run(scene, gp.EventDriven(), 1, 60000.0, 10.0, tmp_path / "run.nc", **kept)
    found = A.thermal_conductivity(path)
    expected = dilute_mixture_conductivity([1.0, 1.0], masses=[1.0, 10.0])
    error = np.hypot(float(found.error), 0.025 * expected)  # higher approximations
    assert error < 0.08 * expected
    assert float(found.estimate) == pytest.approx(expected, abs=3.0 * error)
    with open_run(path, None) as run:
        assert green_kubo(run, "heat").mean(axis=0)[-1] > 1.6 * expected
    with pytest.raises(gp.SceneError, match="sample_interval = 10"):
        A.thermal_conductivity(path, lag=5.0 - 1e-9)


def test_two_names_of_one_gas_conduct_alike(tmp_path):
    half = gp.Species(16, 0.5, temperature=1.0)
    scene = gp.Scene(gp.Container((4.0,) * 3, "periodic"), [half, half])
    settings = gp.Correlations(0.25, 8, stress=True)
    settings = {"correlations": settings, "pairs": True}
    path = gp.run(scene, gp.EventDriven(), 1, 200.0, 0.25, tmp_path / "run.nc", **settings)
    with gp.open_trajectory(path) as data:
        whole = A.thermal_conductivity(data)
        other = replace(scene, species=[half, replace(half, mass=1.0 + 1e-12)])
        parts = A.thermal_conductivity(data.assign_attrs(scene=dump_yaml(other.to_dict())))
    assert "without diffusion" in parts.estimate.attrs["long_name"]
    assert float(parts.estimate) == pytest.approx(float(whole.estimate), abs=0.5 * float(whole.error))


def test_a_species_that_finds_no_place_does_not_hide_the_others():
    """A large sphere finds a place among 100 small ones with a chance of about e^-20, a small one often."""
    kinds = [gp.Species(1, 1.2, temperature=1.0), gp.Species(100, 0.25, temperature=1.0)]
    simulation = gp.Simulation(gp.Scene(gp.Container((4.0,) * 3, "periodic"), kinds), seed=1)
    simulation.advance(1.0)
    found = A.chemical_potential(simulation, trials=20)
    assert np.isnan(found.estimate[0]) and np.isnan(found.error[0])
    assert abs(float(found.estimate[1] - found.theory[1])) < 0.05 and np.isfinite(found.theory).all()
    assert found.attrs["note"] == "no place was free for species 0"
