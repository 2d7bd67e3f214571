import numpy as np
import pytest
from reproduction.families.displacement.data import discs, spheres
from reproduction.families.drawn import Points, column, draw, shows, varied

from gaspart import theory
from gaspart.reproduction.families.displacement import figure as displacement
from gaspart.reproduction.table import Table

KEPT = ("packing_fraction", "time", "interval")


def running(row, eta, dimension):
    """D(t) of a row over Enskog's, against collisions per particle."""
    enskog = float(theory.enskog_diffusion(eta, dimension))
    time = float(theory.collision_rate(eta, dimension)) * row["time"]
    return Points(time, row["running"] / enskog, row["running_error"] / enskog, some=True)


def test_spheres():
    ds = varied(spheres(), *KEPT)
    msd, slope, density, size = draw(displacement.msd_spheres, ds).axes
    long, fine = ds.isel(point=4), ds.isel(point=5)
    shows(msd, column(fine, "time", "msd", some=True), column(long, "time", "msd", some=True))
    shows(slope, running(fine, 0.3, 3), running(long, 0.3, 3))
    row = ds.isel(point=[0, 1, 4])
    enskog = theory.enskog_diffusion(row["packing_fraction"].values, 3)
    both = np.hypot(row["diffusion_error"], row["correction_uncertainty"])
    shows(
        density,
        Points(row["packing_fraction"], row["diffusion"] / enskog, row["diffusion_error"] / enskog),
        Points(row["packing_fraction"], (row["diffusion"] + row["correction"]) / enskog, both / enskog),
    )
    row = ds.isel(point=[2, 3, 4])
    known = float(theory.erpenbeck_wood_diffusion(0.3))
    shows(
        size,
        Points([0.0], [known], [theory.ERPENBECK_WOOD_UNCERTAINTY * known]),
        Points(1.0 / row["side"], row["diffusion"], row["diffusion_error"]),
    )
    ds["in_series"] = ("point", np.zeros(ds.sizes["point"], dtype=bool))
    assert not draw(displacement.msd_spheres, ds).axes[3].axison  # no series of sizes


def test_discs():
    ds = varied(discs(), *KEPT)
    msd, slope, logarithm = draw(displacement.msd_discs, ds).axes
    dilute, long, fine = (ds.isel(point=k) for k in range(3))
    shows(msd, column(fine, "time", "msd", some=True), column(long, "time", "msd", some=True))
    shows(slope, running(dilute, 0.1, 2), running(fine, 0.3, 2), running(long, 0.3, 2))
    shows(logarithm, column(ds.isel(point=[0, 1]), "packing_fraction", "logarithmic_slope"))


@pytest.mark.parametrize("data", [discs, spheres])
def test_no_lag_is_drawn_twice(data):
    pieces = list(displacement._pieces(Table(data(), "point"), 0.3))
    drawn = [time for run, lags in pieces for time in run.time[lags]]
    assert len(pieces) >= 2 and np.all(np.diff(drawn) > 0.0)
