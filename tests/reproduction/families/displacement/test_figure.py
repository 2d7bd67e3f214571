import numpy as np
import pytest
from reproduction.families.displacement.data import discs, spheres
from reproduction.families.drawn import Points, column, draw, follows, line, lines, obeys, shows, varied

from gaspart import theory
from gaspart.reproduction.families.displacement import figure as displacement

KEPT = ("packing_fraction", "time", "interval")


def running(row, eta, dimension, label):
    """D(t) of a row over Enskog's, against collisions per particle."""
    enskog = float(theory.enskog_diffusion(eta, dimension))
    time = float(theory.collision_rate(eta, dimension)) * row["time"]
    return Points(label, time, row["running"] / enskog, row["running_error"] / enskog, some=True)


def test_spheres():
    ds = varied(spheres(), *KEPT)
    msd, slope, density, size = draw(displacement.msd_spheres, ds).axes
    long, fine = ds.isel(point=4), ds.isel(point=5)
    shows(
        msd, "time", "Delta", column(fine, r"$\eta=0.3$", "time", "msd", some=True),
        column(long, None, "time", "msd", some=True),
    )  # fmt: skip
    obeys(lines(msd)[0], lambda t: theory.enskog_mean_squared_displacement(t, 0.3, 3))
    obeys(line(msd, "ballistic"), lambda t: 3.0 * t**2)
    shows(
        slope, "collisions per particle", "D(t)",
        running(fine, 0.3, 3, r"$\eta=0.3$"), running(long, 0.3, 3, None),
    )  # fmt: skip
    rate, enskog = float(theory.collision_rate(0.3, 3)), float(theory.enskog_diffusion(0.3, 3))
    follows(lines(slope)[0], rate * fine["time"][1:], fine["integral"][1:] / enskog)
    row = ds.isel(point=[0, 1, 4])
    enskog = theory.enskog_diffusion(row["packing_fraction"].values, 3)
    both = np.hypot(row["diffusion_error"], row["correction_uncertainty"])
    shows(
        density, "packing fraction", "Enskog",
        Points("as measured", row["packing_fraction"], row["diffusion"] / enskog,
               row["diffusion_error"] / enskog),
        Points("infinite", row["packing_fraction"], (row["diffusion"] + row["correction"]) / enskog,
               both / enskog),
    )  # fmt: skip
    obeys(line(density, "Erpenbeck"), theory.erpenbeck_wood_ratio)
    row = ds.isel(point=[2, 3, 4])
    known = float(theory.erpenbeck_wood_diffusion(0.3))
    shows(
        size, "sigma/L", "D_L",
        Points("Erpenbeck", [0.0], [known], [theory.ERPENBECK_WOOD_UNCERTAINTY * known]),
        Points(r"$\eta=0.3$", 1.0 / row["side"], row["diffusion"], row["diffusion_error"]),
    )  # fmt: skip
    obeys(line(size, "fit"), lambda x: float(ds["size_intercept"]) + float(ds["size_slope"]) * x)
    predicted = -float(row["correction"][0] * row["side"][0])
    obeys(line(size, "Yeh"), lambda x: float(ds["size_limit"]) + predicted * x)
    assert [one.get_text() for one in size.texts[:3]] == ["256", "864", "2048"]


def test_discs():
    ds = varied(discs(), *KEPT)
    msd, slope, logarithm = draw(displacement.msd_discs, ds).axes
    dilute, long, fine = (ds.isel(point=k) for k in range(3))
    shows(
        msd, "time", "Delta", column(fine, r"$\eta=0.3$", "time", "msd", some=True),
        column(long, None, "time", "msd", some=True),
    )  # fmt: skip
    shows(
        slope, "collisions per particle", "D(t)", running(dilute, 0.1, 2, r"$\eta=0.1$"),
        running(fine, 0.3, 2, r"$\eta=0.3$"), running(long, 0.3, 2, None),
    )  # fmt: skip
    row = ds.isel(point=[0, 1])
    shows(
        logarithm, "packing fraction", "ln t",
        column(row, "measured", "packing_fraction", "logarithmic_slope"),
    )  # fmt: skip
    obeys(line(logarithm, "infinite system"), theory.logarithmic_slope)
    known = ds.isel(point=np.isfinite(ds["slope_expected"].values)).sortby("packing_fraction")
    follows(line(logarithm, "this container"), known["packing_fraction"], known["slope_expected"])


def test_no_series_of_sizes_leaves_its_panel_empty():
    ds = spheres()
    ds["in_series"] = ("point", np.zeros(ds.sizes["point"], dtype=bool))
    assert not draw(displacement.msd_spheres, ds).axes[3].axison


@pytest.mark.parametrize("data", [discs, spheres])
def test_no_lag_is_drawn_twice(data):
    pieces = list(displacement._pieces(data(), 0.3))
    drawn = [time for row, lags in pieces for time in row["time"].values[lags]]
    assert len(pieces) >= 2 and np.all(np.diff(drawn) > 0.0)
