"""Routes to one number in small fluids, and the thermodynamics of a known equation of state."""

from __future__ import annotations

import numpy as np
import pytest
from reproduction.made import simulated

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import fit_polynomial
from gaspart.reproduction.figures import chemical_potential, structure
from gaspart.reproduction.figures.chemical_potential import STATE_POWERS, MeasuredState
from gaspart.reproduction.points.point import Point

GAS = {
    "dimension": 3, "count": 108, "radius": 0.5, "boundary": "periodic", "temperature": 1.0,
    "arrangement": "lattice", "engine": "event", "collisions_per_particle": 400, "equilibration": 20,
    "samples": 200,
}  # fmt: skip


@pytest.fixture(scope="module")
def points(tmp_path_factory):
    """Spheres at three packing fractions, of which the last two are measured."""
    folder = str(tmp_path_factory.mktemp("points"))
    made = []
    for name, eta in (("a", 0.05), ("b", 0.12), ("c", 0.2)):
        settings = GAS | {"packing_fraction": eta}
        experiment = "states" if name == "a" else "frames"
        made.append(simulated(Point(experiment, name, "simulate", settings, folder, 1)))
    return made


def test_the_routes_agree(points):
    settings = {"measured": ["frames"], "small": 4.0, "highest": 12.0, "furthest": 2.5, "frames": 100}
    ds = structure.measure(points, settings)
    assert ds["packing_fraction"].values == pytest.approx([0.12, 0.2])
    for name, most in (("s0_ratio", 0.12), ("g_ratio", 0.12), ("rate_ratio", 0.02)):
        error = ds[f"{name}_error"].values
        assert (error < most).all() and (abs(ds[name].values - 1.0) < 4.5 * error).all()
        assert (ds[f"{name}_freedom"].values >= 9).all()
    contact = theory.contact_value(np.array([0.12, 0.2]), 3)
    assert ds["contact_z"].values == pytest.approx(contact, rel=0.03)
    assert ds["g"].values[:, ds["distance"].values[0] < 0.97].max() == 0.0
    dense = ds.isel(point=1).dropna("shell", subset=["s"])
    law = theory.verlet_weis_structure_factor(dense["wave_number"].values, 0.2)
    chi = float((((dense["s"] - law) / dense["s_error"]) ** 2).mean())
    assert chi < 2.0


def test_insertion_agrees_with_the_integrated_pressure(points):
    settings = {"measured": ["frames"], "trials": 64, "frames": 100, "enough": 90}
    ds = chemical_potential.measure(points, settings)
    assert (ds["works"] == 1).all() and (ds["hit_frames"] > 90).all()
    assert (ds["ratio_error"].values < 0.03).all()
    assert (abs(ds["ratio"].values - 1.0) < 4.5 * ds["ratio_error"].values).all()
    assert ds["resolution"].values == pytest.approx(1.0 / ds["places"].values)
    assert (abs(ds["integrated"] - ds["reference"]) < 4.5 * ds["integrated_error"]).all()
    assert "ln_q" not in ds  # of two points no curve is made


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_thermodynamics_of_a_known_equation_of_state(dimension):
    """Z_ref (1 + 0.02 eta): what the fit adds to the reference, by differences of its integrals."""
    eta = np.linspace(0.05, 0.45, 9)
    fit = fit_polynomial(eta, 0.02 * eta, np.full(9, 1e-6), powers=STATE_POWERS)
    state, at = MeasuredState(dimension, fit), 0.4

    def z(x):
        return theory.compressibility_factor(x, dimension) * (1.0 + 0.02 * x)

    slope = ((at + 1e-4) * z(at + 1e-4) - (at - 1e-4) * z(at - 1e-4)) / 2e-4
    assert state.inverse_compressibility(at).value == pytest.approx(slope, rel=1e-5)
    inner = np.linspace(1e-6, at, 4001)
    free = np.trapezoid((z(inner) - 1.0) / inner, inner)
    assert state.free_energy(at).value == pytest.approx(free, rel=1e-4)
    assert state.chemical_potential(at).value == pytest.approx(free + z(at) - 1.0, rel=1e-4)
    assert 0.0 < state.chemical_potential(at).error < 1e-4


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_configuration_integral_of_a_known_chemical_potential(dimension):
    eta = np.array([0.1, 0.2, 0.3, 0.4])
    inserted = Estimate(theory.excess_chemical_potential(eta, dimension), 0.01, 20.0)
    fit_eta = np.linspace(0.05, 0.45, 9)
    state = MeasuredState(
        dimension, fit_polynomial(fit_eta, 0.0 * fit_eta, np.full(9, 1e-6), powers=STATE_POWERS)
    )
    found = chemical_potential.ln_q(eta, inserted, dimension)
    free = theory.excess_free_energy(eta, dimension)
    assert found.value == pytest.approx(free, rel=1e-6)
    assert [state.free_energy(one).value for one in eta] == pytest.approx(free, rel=1e-6)
    assert (found.error > 0.0).all() and (found.error < 0.05).all()
