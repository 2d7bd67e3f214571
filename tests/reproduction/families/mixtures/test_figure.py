import numpy as np
from reproduction.families.drawn import Points, draw, shows
from reproduction.families.mixtures.data import measured

from gaspart.reproduction.families.mixtures import figure as mixtures
from gaspart.reproduction.families.mixtures.claims import deviations
from gaspart.reproduction.families.shared.rows import estimates


def test_deviations_contact_values_and_rates_are_drawn():
    ds = measured()
    ratio, density, discs, many, contact, rate = draw(mixtures.mixture_state, ds).axes

    def points(label, base, x, chosen, shift=0.0):
        part = ds.isel(point=np.flatnonzero(chosen)).sortby(x)
        value, error = deviations(part, base)
        return Points(label, part[x] + shift, 100.0 * value, 100.0 * error)

    spheres = (ds["dimension"] == 3) & np.isclose(ds["packing_fraction"], 0.4)
    few, most = ((ds["small_fraction"] == small) for small in (0.5, 0.9))
    shows(
        ratio, "size ratio", "spheres",
        points("50% small", "boublik", "size_ratio", spheres & few, -0.004),
        points("90% small", "boublik", "size_ratio", spheres & most, 0.004),
    )  # fmt: skip
    shows(
        discs, "size ratio", "discs",
        points("50% small", "santos", "size_ratio", (ds["dimension"] == 2) & few, -0.004),
        points("90% small", "santos", "size_ratio", (ds["dimension"] == 2) & most, 0.004),
    )  # fmt: skip
    half = few & (ds["size_ratio"] == 0.5)
    shows(
        density, "packing fraction", "theory",
        points("spheres", "boublik", "packing_fraction", (ds["dimension"] == 3) & half),
        points("discs", "santos", "packing_fraction", (ds["dimension"] == 2) & half),
    )  # fmt: skip
    unequal = np.isfinite(ds["polydispersity"])
    shows(
        many, "polydispersity", "theory",
        points("spheres", "boublik", "polydispersity", (ds["dimension"] == 3) & unequal),
        points("discs", "santos", "polydispersity", (ds["dimension"] == 2) & unequal),
    )  # fmt: skip
    for axis, name, text in ((contact, "contact", "contact value"), (rate, "rate", "rate")):
        part = ds.isel(point=np.flatnonzero(spheres & few))
        series = [
            Points(pair, part["size_ratio"], *estimates(part.sel(pair=pair), name))
            for pair in ds["pair"].values
        ]
        shows(axis, "size ratio", text, *series)
