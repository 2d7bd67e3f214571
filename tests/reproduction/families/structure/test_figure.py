import numpy as np
from reproduction.families.drawn import Points, draw, line, obeys, shows, varied
from reproduction.families.structure.data import chemical_potential, structure

from gaspart import theory
from gaspart.reproduction.families.shared.rows import estimates
from gaspart.reproduction.families.structure import figure as figures
from gaspart.reproduction.families.structure.figure import SHIFT

ETA = "packing_fraction"


def of(ds, dimension):
    return ds.isel(point=np.flatnonzero(ds["dimension"].values == dimension))


def test_curves_and_ratios_are_drawn():
    ds = varied(structure(), "packing_fraction", "distance", "wave_number")
    g, s, zero, contact = draw(figures.structure, ds).axes
    parts = {kind: of(ds, dimension) for kind, dimension in enumerate((3, 2))}
    names = {0: "spheres", 1: "discs"}
    last = {kind: part.isel(point=-1) for kind, part in parts.items()}
    beyond = last[0]["distance"].values >= 1.0
    shows(g, "distance", "g(r)", *(
        Points(names[kind], one["distance"].values[beyond], *estimates(one, "g")[:, beyond])
        for kind, one in last.items()
    ))  # fmt: skip
    shows(s, "wave number", "S(k)", *(
        Points(names[kind], one["wave_number"], *estimates(one, "s")) for kind, one in last.items()
    ))  # fmt: skip
    obeys(line(g, "Weis"), lambda r: theory.verlet_weis_rdf(r, 0.45))
    obeys(line(s, "Percus"), lambda k: theory.percus_yevick_structure_factor(k, 0.45))
    expected = [
        Points(
            names[kind], part["packing_fraction"].values + SHIFT * (kind - 0.5), *estimates(part, "s0_ratio")
        )
        for kind, part in parts.items()
    ]
    shows(zero, "packing fraction", "S(0)", *expected)
    expected = [
        Points(
            names[kind],
            part["packing_fraction"].values + SHIFT * (kind - 0.5 + 0.4 * n),
            *estimates(part, name),
        )
        for kind, part in parts.items()
        for n, name in enumerate(("g_ratio", "rate_ratio"))
    ]
    shows(contact, "packing fraction", "from", *expected)


def test_the_chemical_potential_and_its_chance_are_drawn():
    ds = varied(chemical_potential(), "packing_fraction")
    upper, ratio, chance, partition = draw(figures.chemical_potential, ds).axes
    parts = [("spheres", of(ds, 3)), ("discs", of(ds, 2))]
    shows(
        upper, "", "excess", *(Points(f"{n}, insertion", p[ETA], *estimates(p, "inserted")) for n, p in parts)
    )
    shows(ratio, "packing", "integral", *(Points(None, p[ETA], *estimates(p, "ratio")) for _, p in parts))
    shows(chance, "packing", "chance", *(Points(n, p[ETA], *estimates(p, "probability")) for n, p in parts))
    shows(partition, "packing", "ln Q", *(Points(None, p[ETA], *estimates(p, "ln_q")) for _, p in parts))
    obeys(line(upper, "discs, integral"), lambda x: theory.excess_chemical_potential(x, 2))
