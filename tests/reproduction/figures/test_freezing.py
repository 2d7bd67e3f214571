"""What a drift adds to an uncertainty."""

import numpy as np
import pytest
import xarray as xr

from gaspart.analysis.estimate import Estimate
from gaspart.reproduction.figures._freezing import EQUILIBRIUM_LIMIT, disagreement, mean_and_drift, with_drift
from gaspart.reproduction.table import entries


def test_a_run_that_creeps_is_less_certain():
    noise = np.random.default_rng(1).standard_normal(1000)
    mean, drift = mean_and_drift([noise, noise[::-1]])
    assert drift.value == pytest.approx(0.0, abs=1e-12) and drift.error == pytest.approx(2.0 * mean.error)
    assert with_drift(mean, drift) == mean
    mean, drift = mean_and_drift([noise + np.linspace(0.0, 4.0, 1000)])
    assert drift.value == pytest.approx(2.0, abs=0.2)
    creeping = with_drift(Estimate(10.0, 0.1, 9.0), Estimate(0.8, 0.2))
    assert creeping == Estimate(10.0, np.hypot(0.1, 0.4), 9.0)


def test_an_uncertainty_from_a_short_run_has_few_degrees_of_freedom():
    """Four errors between two starts of a run as short as its memory are no disagreement."""
    walk = np.cumsum(np.random.default_rng(2).standard_normal(32)) / 8.0
    mean, drift = mean_and_drift([walk])
    assert mean.freedom < 6.0 and drift.freedom == mean.freedom

    def worst(freedom):
        row = entries({"pressure": Estimate([9.0, 9.4], 0.07, freedom)})
        row |= {f"{name}{part}": np.zeros(2) for name in ("order",) for part in ("", "_drift")}
        row["pressure_drift"] = np.zeros(2)
        row |= {f"{name}_error": np.ones(2) for name in ("order", "order_drift", "pressure_drift")}
        columns = {name: (("start", "packing_fraction"), values[:, None]) for name, values in row.items()}
        return disagreement(xr.Dataset(columns))

    assert worst(np.inf) == pytest.approx([0.4 / (0.07 * np.sqrt(2.0))])
    assert worst(2.0) < EQUILIBRIUM_LIMIT
