import numpy as np
import xarray as xr
from reproduction.families.drawn import Points, column, draw, shows, varied

from gaspart.reproduction.families.radius.figure import radius_grid


def gases():
    """What `measure.radius_grid` gives: two series of three gases by each engine."""
    names = ["pair_tests", "pair_tests_expected", "crossings_counted", "crossings_expected"]
    names += ["Z", "Z_error", "reference", "reference_error"]
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
    shows(z, column(event[0], "radius", "Z"), column(event[1], "radius", "Z"))
    sigmas = []
    for one in event:
        sigma = np.hypot(one["Z_error"], one["reference_error"])
        sigmas.append(Points(one["radius"], (one["Z"] - one["reference"]) / sigma, np.ones(3)))
    shows(deviation, *sigmas)
    counted = []
    for events, steps in zip(event, step, strict=True):
        columns = events["pair_tests"], events["crossings_counted"], steps["pair_tests"]
        counted += [Points(events["radius"], column) for column in columns]
    shows(work, *counted)
