import numpy as np
from reproduction.families.drawn import Points, draw, estimates, shows, varied
from reproduction.families.structure.data import chemical_potential, structure

from gaspart.reproduction.families.structure import figure as figures
from gaspart.reproduction.families.structure.figure import SHIFT

ETA = "packing_fraction"


def of(ds, dimension):
    return ds.isel(point=np.flatnonzero(ds["dimension"].values == dimension))


def test_curves_and_ratios_are_drawn():
    ds = varied(structure(), "packing_fraction", "distance", "wave_number")
    g, s, zero, contact = draw(figures.structure, ds).axes
    parts = [of(ds, 3), of(ds, 2)]
    last = [part.isel(point=-1) for part in parts]
    beyond = last[0]["distance"].values >= 1.0
    shows(g, *(Points(one["distance"][beyond], *estimates(one, "g")[:, beyond]) for one in last))
    shows(s, *(Points(one["wave_number"], *estimates(one, "s")) for one in last))
    expected = [
        Points(part[ETA].values + SHIFT * (kind - 0.5), *estimates(part, "s0_ratio"))
        for kind, part in enumerate(parts)
    ]
    shows(zero, *expected)
    expected = [
        Points(part[ETA].values + SHIFT * (kind - 0.5 + 0.4 * n), *estimates(part, name))
        for kind, part in enumerate(parts)
        for n, name in enumerate(("g_ratio", "rate_ratio"))
    ]
    shows(contact, *expected)


def test_the_chemical_potential_and_its_chance_are_drawn():
    ds = varied(chemical_potential(), "packing_fraction")
    upper, ratio, chance, partition = draw(figures.chemical_potential, ds).axes
    panels = {"inserted": upper, "ratio": ratio, "probability": chance, "ln_q": partition}
    for name, axis in panels.items():
        shows(axis, *(Points(part[ETA], *estimates(part, name)) for part in (of(ds, 3), of(ds, 2))))
