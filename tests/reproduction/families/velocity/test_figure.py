import numpy as np
import pytest
from reproduction.families.drawn import Points, column, draw, shows, varied
from reproduction.families.velocity.data import correlations

from gaspart import theory
from gaspart.reproduction.families.velocity.figure import velocity_autocorrelation


@pytest.mark.parametrize("points", [[0, 1, 2, 3], [0], [3]])
def test_the_tail_the_start_and_their_ratio_are_drawn(points):
    ds = correlations().isel(point=points)
    whole = varied(ds, "packing_fraction", "sound", "start_rate", "tail_ratio", "tail_correction")
    ds = whole.assign({name: ds[name] for name in ("tail_from", "tail_to")})
    tails, starts, ratios = draw(velocity_autocorrelation, ds).axes
    fine = [ds.isel(point=k) for k in range(len(points)) if np.isfinite(ds["start_rate"][k])]
    long = [ds.isel(point=k) for k in range(len(points)) if np.isfinite(ds["tail_ratio"][k])]
    for axis, rows in ((tails, long), (starts, fine)):
        shows(axis, *(column(row, "collisions", "correlation", some=True) for row in rows))
    expected = []
    for row in long:
        at = row.isel(lag=np.flatnonzero(row["collisions"].values > 5.0))
        gas = float(row["packing_fraction"]), int(row["dimension"]), int(row["count"])
        modes = theory.velocity_autocorrelation_modes(at["time"].values, *gas)
        share = 1.0 / int(row["count"])
        seen = (at["correlation"] - share) / (modes - share), at["correlation_error"] / (modes - share)
        expected.append(Points(at["collisions"], *seen, some=True))
    shows(ratios, *expected)
