"""The thermodynamics of a known equation of state."""

import numpy as np
import pytest
from reproduction.made import made
from scenes import gas

from gaspart import theory
from gaspart.analysis.statistics import fit_polynomial
from gaspart.reproduction.figures import chemical_potential
from gaspart.reproduction.figures.chemical_potential import STATE_POWERS, MeasuredState


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


def test_a_crystal_without_a_free_place_has_no_potential(tmp_path):
    """In no part of any frame a centre could be, so that no trial is made."""
    crystal = gas(3, 108, 0.53, arrangement="lattice")
    point = made(tmp_path, "crystal", crystal, duration=0.2, samples=4, replicas=2)
    eta = np.linspace(0.1, 0.4, 9)
    state = MeasuredState(3, fit_polynomial(eta, np.zeros(9), np.full(9, 1e-6), powers=STATE_POWERS))
    settings = {"frames": 4, "trials": 64, "enough": 1}
    row = chemical_potential._row(point, state, settings)
    assert row["probability"].value == row["resolution"] == 0.0 and not row["works"]
    assert np.isnan(row["inserted"].value)
