"""Claims about the pressure on walls."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis.statistics import combine_estimates, fit_power_law
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared import PARTICLES
from gaspart.reproduction.table import Table, each

RELATIVE_ERROR = 1e-3
"""The largest standard error of a pressure, relative to it, at which a mean of comparisons means anything."""
THEORY: dict[str, Any] = {
    "source": "bulk equation of state; surfaces, edges and corners of the container to fifth order in the "
    "density, by cluster integrals (gaspart.theory.film); canonical ensemble to first order in 1/N",
    "allowance_source": "surfaces, edges and corners: a sixth order as large as the larger of the two before",
    "fails_if": "wall collisions are missed or counted twice, or the wrong area, volume or density is taken",
}
LESS_CERTAIN = "surfaces and edges are less certain than the measurement, by an estimate of what is left out"
"""Why there is no verdict where theory's uncertainty, which is an estimate, exceeds the measurement's."""


def wall_pressure(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims on the pressure on walls, with the container's surface terms.

    It is the bulk's with these terms, and proportional to T; without them the deviation is far larger than
    the error.
    """
    table = Table(dataset, "point")
    table = table.assign(particles=[PARTICLES[dimension] for dimension in table.dimension])
    slits, closed = table[table.axes < table.dimension], table[table.axes == table.dimension]
    claims = [claim for _, part in slits.by("dimension") for claim in _between_walls(part)]
    theory = closed.expected.value
    measured, expected = closed.pressure / theory, closed.expected / theory
    claims += each(
        closed,
        "pressure of {count} {particles} in a closed container over theory's, "
        "packing fraction {packing_fraction:.2g}",
        measured=measured,
        expected=expected,
        required=RELATIVE_ERROR,
        no_verdict=np.where(expected.error > measured.error, LESS_CERTAIN, ""),
        **THEORY,
    )
    small = (closed.count == np.where(closed.dimension == 2, 100, 125)) & (
        abs(closed.packing_fraction - 0.1) < 0.005
    )
    for _, naive in closed[small].by("dimension"):
        claims += _naive(naive[:1])
    return claims + _temperature(table)


def _between_walls(slits: Table) -> list[Claim]:
    ratio, expected = slits.pressure / slits.expected.value, slits.expected / slits.expected.value
    mean = combine_estimates(Estimate(ratio.value, ratio.error))
    measured, allowance = Estimate(mean.value, mean.error), ratio.weights @ expected.error
    name = f"pressure of {slits.particles[0]} between two walls"
    return [
        Claim(
            claim=f"{name} over theory's, mean of {len(slits)} slits",
            measured=measured,
            expected=Estimate(1.0, allowance),
            required=RELATIVE_ERROR,
            no_verdict=LESS_CERTAIN if slits.dimension[0] == 2 and allowance > measured.error else "",
            **THEORY,
        ),
        Claim.joint(
            claim=f"{name} against theory's",
            deviations=(slits.pressure - slits.expected).deviation,
            source=THEORY["source"],
            fails_if="an error that grows with density, or wrong error bars",
        ),
    ]


def _naive(closed: Table) -> list[Claim]:
    return each(
        closed,
        "bulk pressure at N/V over that on the walls of {count} {particles}, packing fraction 0.1",
        Claim.at_most,
        measured=closed.bulk_pressure / closed.pressure,
        bound=np.where(closed.dimension == 2, 0.95, 0.8),
        required=0.01,
        source="the accessible volume is smaller than the container's: -7 % (discs), -34 % (spheres)",
        fails_if="the pressure on walls does not depend on the particles' size",
    )


def _temperature(table: Table) -> list[Claim]:
    claims = []
    for *_, part in table.by("axes", "dimension", table.density.round(9)):
        if part.temperature.max() < 2.0 * part.temperature.min():
            continue
        pressure = part.pressure * part.temperature
        law = fit_power_law(part.temperature, pressure.value, pressure.error)
        claims.append(
            Claim(
                claim=f"exponent of P against T at packing fraction {part.packing_fraction[0]:.3g}",
                kind="identity",
                measured=Estimate(law.exponent, law.exponent_error),
                expected=1.0,
                required=2e-3,
                source="hard particles have no energy scale (exact)",
                fails_if="the program has a hidden energy or time scale",
            )
        )
    return claims
