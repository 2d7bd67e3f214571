"""Runs for numbers that others have published with smaller uncertainties than ours, and the comparison."""

import math
from dataclasses import dataclass, field

import gaspart as gp
from gaspart import theory
from gaspart.theory.virial import linear_tail, linear_tail_uncertainty


@dataclass(frozen=True)
class Published:
    """A run of particles of diameter 1 at temperature 1 in a periodic square or cube, and what it gives.

    kind: "pressure", of this number of particles; "Z", of the infinite system; or "B5", the coefficient over
    B_2^4 that follows from Z and all others. value, error: as published; `of_theory` where they are None.
    """

    what: str
    kind: str
    dimension: int
    count: int
    packing_fraction: float
    duration: float
    source: str
    value: float | None = None
    error: float | None = None
    seed: int = field(default=11, kw_only=True)


_LI = "Li and others, J. Chem. Phys. 157, 234111 (2022), event-chain programs"
_KOLAFA = "Kolafa, Labik and Malijevsky, Phys. Chem. Chem. Phys. 6, 2335 (2004)"
_CLISBY = "Clisby and McCoy, J. Stat. Phys. 122, 15 (2006)"
PUBLISHED = [
    Published("pressure of 870 discs at 0.70", "pressure", 2, 870, 0.70, 75000.0, _LI, 9.12966, 0.00015),
    Published("pressure of 870 discs at 0.68", "pressure", 2, 870, 0.68, 35000.0, _LI, 8.513249, 0.000037),
    Published("Z of spheres at 0.30", "Z", 3, 2048, 0.30, 3000.0, _KOLAFA),
    Published("Z of spheres at 0.45", "Z", 3, 2048, 0.45, 1500.0, _KOLAFA),
    Published("B5 / B2^4 of discs, from Z at 0.30", "B5", 2, 1024, 0.30, 12000.0, _CLISBY),
    Published("B5 / B2^4 of spheres, from Z at 0.20", "B5", 3, 1024, 0.20, 6000.0, _CLISBY),
]
"""Longest first. The pressures are those of a square; the figure freezing_discs has those of a rectangle."""


def compared(number, folder):
    """Run and compare: our number, the published one, and their uncertainties.

    `change`: by how much ours would change if the measured pressure were larger by itself.
    """
    path = folder / f"published_{number.kind}_{number.dimension}_{number.packing_fraction:g}.nc"
    gp.run(scene(number), gp.EventDriven(), number.seed, number.duration, number.duration / 1000.0, path)
    found = gp.analysis.compressibility_factor(path, start=0.02 * number.duration)
    z, error = (float(found[name]) for name in ("compressibility_factor", "compressibility_factor_error"))
    path.unlink()
    eta, d = number.packing_fraction, number.dimension
    row = {"what": number.what, "source": number.source}
    if number.kind == "pressure":
        density = eta / theory.particle_volume(d)
        ours, theirs = (density * z, density * error, density * z), (number.value, number.error)
    else:
        z -= float(theory.finite_size_correction(eta, d, number.count, "canonical"))
        if number.kind == "Z":
            ours = z, error, z
            known = theory.compressibility_factor(eta, d), theory.compressibility_uncertainty(eta, d)
            theirs = tuple(map(float, known))
        else:
            ours, theirs = fifth_coefficient(z, error, eta, d)
    names = "ours", "error", "change", "theirs", "their_error"
    return row | dict(zip(names, (*ours, *theirs), strict=True))


def scene(number):
    d, eta = number.dimension, number.packing_fraction
    side = (number.count * theory.particle_volume(d) / eta) ** (1.0 / d)
    species = gp.Species(count=number.count, radius=0.5, temperature=1.0, arrangement="compressed")
    return gp.Scene(container=gp.Container(lengths=(side,) * d, boundary="periodic"), species=[species])


def fifth_coefficient(z, error, eta, dimension):
    """B_5 / B_2^4 from Z, with all other coefficients to B_10 and the linear tail: (ours, its error, its
    change), (published, its uncertainty)."""
    coefficients, uncertainties = theory.virial_coefficients(dimension)
    scale = coefficients[1] ** 4
    per_z = 1.0 / (scale * eta**4)
    others = float(theory.partial_sum(eta, 10, dimension) + linear_tail(eta, dimension))
    others -= float(coefficients[4]) * eta**4
    of_others = math.hypot(*(u * eta**n for n, u in enumerate(uncertainties) if n != 4))
    spread = math.hypot(error, of_others, float(linear_tail_uncertainty(eta, dimension)))
    ours = (z - others) * per_z, spread * per_z, z * per_z
    return ours, (float(coefficients[4] / scale), float(uncertainties[4] / scale))
