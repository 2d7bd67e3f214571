import numpy as np
import pytest
from reproduction.claims.data import judged
from reproduction.families.couette.data import measured

from gaspart.reproduction.families.couette.claims import couette


def test_what_theory_states_agrees():
    found = judged(couette(measured()))
    assert len(found) == 2 + 1 + 1 + 2 + 1 + 3 + 1 + 1 + 2
    assert set(found.values()) == {"agrees"}


@pytest.mark.parametrize(
    ("point", "name", "factor", "text"),
    [
        (0, "viscosity", 0.97, "over Enskog's viscosity, dilute"),
        (0, "slip", 0.8, "velocity slip"),
        (4, "viscosity", 1.1, "over Enskog's viscosity, spheres at"),
        (4, "viscosity", 1.06, "from the response over that from equilibrium"),
        (6, "viscosity", 1.06, "from uniform shear over that from equilibrium"),
        (3, "pressure", 1.01, "pressure on the walls"),
        (2, "stress", 0.9, "free flight"),
        (1, "heating", 1.2, "-dT/du^2"),
        (1, "normal_y", -0.9, "along gradient"),
        (1, "pressure", 1.003, "on the walls less pressure"),
    ],
)
def test_each_claim_can_fail(point, name, factor, text):
    ds = measured()
    values = ds[name].values.copy()
    values[point] *= factor
    found = judged(couette(ds.assign({name: (ds[name].dims, values)})))
    assert "disagrees" in {verdict for claim, verdict in found.items() if text in claim}


def test_noise_is_inconclusive():
    ds = measured(error=30.0)
    found = judged(couette(ds))
    assert "inconclusive" in set(found.values()) and np.isfinite(ds["slip"].values[0])
    for text in ("velocity slip", "from the response", "over Enskog's viscosity, dilute"):
        assert {verdict for claim, verdict in found.items() if text in claim} == {"inconclusive"}
