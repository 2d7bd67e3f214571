import numpy as np
import pytest
from reproduction.claims.data import judged
from reproduction.families.dsmc.data import measured

from gaspart.reproduction.families.dsmc.claims import dsmc_convergence


def test_what_theory_states_agrees():
    found = judged(dsmc_convergence(measured()))
    assert len(found) == 3 + 4 + 1 + 6 + 2
    assert set(found.values()) == {"agrees"}


@pytest.mark.parametrize(
    ("part", "name", "change", "text"),
    [
        ("fluxes", "viscosity", lambda row, x: x * 1.03, "viscosity over Chapman"),
        ("fluxes", "conductivity", lambda row, x: x - 0.02 * row["step"] ** 2, "in the conductivity"),
        ("fluxes", "viscosity", lambda row, x: x - 0.02 * row["step"] ** 2, "(c step/l)^2 in the viscosity"),
        ("paths", "diffusion", lambda row, x: x + 0.02 * row["width"] ** 2, "cells wider"),
        ("paths", "diffusion", lambda row, x: x - 0.02 * row["step"] ** 2, "in the diffusion"),
        ("dense", "rate", lambda row, x: 0.97 * x, "collision rate over Enskog's in the Enskog model"),
        ("dense", "excess", lambda row, x: 0.97 * x, "Z - 1"),
        ("plates", "flux", lambda row, x: 1.05 * x, "heat flux"),
    ],
)
def test_each_claim_can_fail(part, name, change, text):
    ds = measured()
    values = ds[name].values.copy()
    for n in np.flatnonzero(ds["part"].values == part):
        values[n] = change({key: float(ds[key][n]) for key in ("width", "step")}, values[n])
    found = judged(dsmc_convergence(ds.assign({name: (ds[name].dims, values)})))
    assert "disagrees" in {verdict for claim, verdict in found.items() if text in claim}


def test_another_transfer_disagrees():
    found = judged(dsmc_convergence(measured().assign(coefficient=0.14)))
    assert {verdict for claim, verdict in found.items() if "(width/l)^2" in claim} == {"disagrees"}


def test_noise_is_inconclusive():
    ds = measured()
    noisy = judged(dsmc_convergence(ds.assign(viscosity_error=20.0 * ds["viscosity_error"])))
    about = [claim for claim in noisy if "viscosity" in claim and "width" not in claim]
    assert {noisy[claim] for claim in about} == {"inconclusive"}
