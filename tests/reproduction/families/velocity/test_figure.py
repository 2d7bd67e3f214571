import numpy as np
import pytest
from reproduction.families.drawn import Points, column, draw, follows, lines, obeys, shows, varied
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
    names = {2: "discs", 3: "spheres"}
    series = {
        kind: [
            column(
                row, f"{names[row['dimension'].item()]}, $\\eta={row['packing_fraction'].item():g}",
                "collisions", "correlation", some=True,
            )
            for row in rows
        ]
        for kind, rows in (("fine", fine), ("long", long))
    }  # fmt: skip
    shows(tails, "", "C=", *series["long"])
    shows(starts, "collisions per particle", "C", *series["fine"])
    expected = []
    for n, row in enumerate(long):
        time, eta, dimension = (row[name] for name in ("time", "packing_fraction", "dimension"))
        tail = theory.velocity_autocorrelation_tail(np.maximum(time, 1e-9), float(eta), int(dimension))
        at = row.isel(lag=np.flatnonzero(row["collisions"].values > 5.0))
        modes = theory.velocity_autocorrelation_modes(
            at["time"].values, float(eta), int(dimension), int(row["count"])
        )
        share = 1.0 / int(row["count"])
        seen = (at["correlation"] - share) / (modes - share), at["correlation_error"] / (modes - share)
        expected.append(Points(None, at["collisions"], *seen, some=True))
        late = (row["collisions"] > 3.0).values
        follows(lines(tails)[2 + n], row["collisions"][late], np.asarray(tail)[late])
    shows(ratios, "collisions per particle", "modes", *expected)
    for one, row in zip(lines(ratios), long, strict=True):
        amplitude, correction = row["tail_ratio"].item(), row["tail_correction"].item()
        obeys(one, lambda s, a=amplitude, b=correction: a + b / s)
    for one, row in zip(lines(starts), fine, strict=True):
        dimension = int(row["dimension"])
        obeys(one, lambda s, d=dimension: np.exp(-2.0 / d * s))
