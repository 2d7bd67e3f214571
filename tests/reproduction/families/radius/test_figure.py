import numpy as np
import xarray as xr
from reproduction.families.drawn import Points, column, draw, follows, lines, obeys, shows, varied

from gaspart import theory
from gaspart.reproduction.families.radius.figure import radius_grid


def gases():
    """What `measure.radius_grid` gives: two series of three gases by each engine."""
    names = (
        "Z", "Z_error", "reference", "reference_error", "pair_tests", "pair_tests_expected",
        "crossings_counted", "crossings_expected",
    )  # fmt: skip
    ds = varied(xr.Dataset({name: ("point", np.ones(12)) for name in names}))
    ds["radius"] = ("point", np.tile([0.4, 0.5, 0.6], 4))
    ds["series"] = ("point", np.tile(np.repeat(["packing fraction", "count"], 3), 2))
    ds["engine"] = ("point", np.repeat(["event", "step"], 6))
    ds["packing_fraction"] = ("point", np.tile([0.1, 0.1, 0.1, 0.05, 0.1, 0.17], 2))
    ds["count"] = ("point", np.tile([200, 100, 60, 125, 125, 125], 2))
    return ds


def test_z_its_deviation_and_the_counted_work_are_drawn_against_the_radius():
    ds = gases()
    z, deviation, work = draw(radius_grid, ds).axes
    event = [ds.isel(point=slice(0, 3)), ds.isel(point=slice(3, 6))]
    step = [ds.isel(point=slice(6, 9)), ds.isel(point=slice(9, 12))]
    shows(
        z, "", "compressibility", column(event[0], "$\\eta=0.1$", "radius", "Z"),
        column(event[1], "$N=125$", "radius", "Z"),
    )  # fmt: skip
    sigmas = []
    for one in event:
        sigma = np.hypot(one["Z_error"], one["reference_error"])
        sigmas.append(Points(None, one["radius"], (one["Z"] - one["reference"]) / sigma, np.ones(3)))
    shows(deviation, "", "sigma", *sigmas)
    counted = [
        (one, name)
        for events, steps in zip(event, step, strict=True)
        for one, name in ((events, "pair_tests"), (events, "crossings_counted"), (steps, "pair_tests"))
    ]
    shows(work, "radius", "counted work", *(Points(None, one["radius"], one[name]) for one, name in counted))
    expected = [
        (one, name)
        for events, steps in zip(event, step, strict=True)
        for one, name in ((events, "crossings_expected"), (steps, "pair_tests_expected"))
    ]
    for curve, (one, name) in zip(lines(work), expected, strict=True):
        follows(curve, one["radius"], one[name])
    obeys(lines(z)[0], lambda r: theory.compressibility_factor(0.1 + 0.0 * r, 3))
    obeys(lines(z)[1], lambda r: theory.compressibility_factor(0.05 * (r / 0.4) ** 3, 3))
