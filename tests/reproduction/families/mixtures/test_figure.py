import numpy as np
from reproduction.families.drawn import Points, draw, estimates, shows
from reproduction.families.mixtures.data import measured

from gaspart.reproduction.families.mixtures import figure as mixtures
from gaspart.reproduction.families.mixtures.claims import deviations
from gaspart.reproduction.table import Table


def test_deviations_contact_values_and_rates_are_drawn():
    ds = measured()
    ratio, density, discs, many, contact, rate = draw(mixtures.mixture_state, ds).axes

    def points(base, x, chosen, shift=0.0):
        part = ds.isel(point=np.flatnonzero(chosen)).sortby(x)
        percent = 100.0 * deviations(Table(part, "point"), base)
        return Points(part[x] + shift, percent.value, percent.error)

    spheres = (ds["dimension"] == 3) & np.isclose(ds["packing_fraction"], 0.4)
    few, most = ((ds["small_fraction"] == small) for small in (0.5, 0.9))
    shows(
        ratio,
        points("boublik", "size_ratio", spheres & few, -0.004),
        points("boublik", "size_ratio", spheres & most, 0.004),
    )
    shows(
        discs,
        points("santos", "size_ratio", (ds["dimension"] == 2) & few, -0.004),
        points("santos", "size_ratio", (ds["dimension"] == 2) & most, 0.004),
    )
    half = few & (ds["size_ratio"] == 0.5)
    shows(
        density,
        points("boublik", "packing_fraction", (ds["dimension"] == 3) & half),
        points("santos", "packing_fraction", (ds["dimension"] == 2) & half),
    )
    unequal = np.isfinite(ds["polydispersity"])
    shows(
        many,
        points("boublik", "polydispersity", (ds["dimension"] == 3) & unequal),
        points("santos", "polydispersity", (ds["dimension"] == 2) & unequal),
    )
    for axis, name in ((contact, "contact"), (rate, "rate")):
        part = ds.isel(point=np.flatnonzero(spheres & few))
        series = [
            Points(part["size_ratio"], *estimates(part.sel(pair=pair), name)) for pair in ds["pair"].values
        ]
        shows(axis, *series)
