"""Claims about adsorption of particles on walls."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.analysis.statistics import combine_estimates, fit_polynomial, fit_power_law
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.table import Table, each
from gaspart.theory.adsorption import planck_constant, slow_flux_share

KINDS = ("ideal", "layer", "sticky")
"""Kinds of walls: potential wells wider than a particle, narrower wells, and the sticky wall of the source.
"""
LANGMUIR = (
    "Boltzmann factor of the well (exact for an ideal gas; Langmuir's formula, [source A], section 4.5); "
    "what spheres close to each other is subtracted, to first order in their density"
)
OWN_LENGTH = (
    "equilibrium of an ideal gas with a step well: the length is its width (exact); what spheres close to "
    "each other is subtracted, to first order in their density"
)


def adsorption(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims on slope, prefactor, hard layer, and detailed balance.

    The sticky wall of the source violates detailed balance.
    """
    walls = Table(dataset, "point")
    ideal, layer, sticky = (walls[walls.kind == kind] for kind in KINDS)
    return [*_ideal(ideal), *_layer(layer), *_sticky(sticky, ideal)]


def _ideal(wells: Table) -> list[Claim]:
    claims = []
    for width, same in wells.by("width"):
        claims.append(
            Claim(
                claim=f"length in place of the thermal wavelength over the well's width, width {width:g}",
                measured=combine_estimates(same.length) / width,
                expected=1.0,
                required=0.01,
                source=OWN_LENGTH,
                fails_if="an additional prefactor: particles enter or leave against the Boltzmann factor",
            )
        )
        for depth, line in same.by("depth"):
            if len(line) > 1:
                claims += _slopes(line, depth)
    return claims


def _slopes(well: Table, depth: float) -> list[Claim]:
    """Return the claims on the temperature dependence of adsorption in one well."""
    slope = fit_polynomial(1.0 / well.temperature, well.log_ratio)
    planck = planck_constant(1.0, well.mass, well.temperature) * well.length
    power = fit_power_law(well.temperature, planck)
    return [
        Claim(
            claim=f"slope of ln(N_ads/N_gas) against 1/kT over the depth, depth {depth:g}",
            measured=slope.estimate(1) / depth,
            expected=1.0,
            required=0.005,
            source=LANGMUIR,
            fails_if="particles leave the well with less, or more, than its depth",
        ),
        Claim(
            claim=f"power of T in h = lambda sqrt(2 pi m k T), lambda that length, depth {depth:g}",
            measured=power.estimate,
            expected=0.5,
            required=0.02,
            source=f"{OWN_LENGTH}; Planck's constant would be constant, the power 0",
            fails_if="a length that depends on T: a thermal wavelength, and so Planck's constant, at -1/2",
        ),
    ]


def _layer(layers: Table) -> list[Claim]:
    """Return the claims on the coverage of layers as a function of the gas pressure.

    A further claim states that the activity of the gas alone does not determine a low coverage.
    """
    if not layers:
        return []
    subject = "coverage over that of hard discs at the gas' pressure"
    source = (
        "spheres in a layer thinner than their diameter, as hard discs (virial series to B10), at the "
        "density P/kT that a hard wall has at contact (exact where the coverage is low), and to first order "
        "in the gas' density what the layer closes to it (scaled-particle theory), and in 1/N what a gas of "
        "N loses to the layer"
    )
    by_activity = layers.filling.value / layers.filling_by_activity.value
    return [
        *each(
            layers,
            f"{subject}, depth {{depth:g}}",
            measured=layers.filling,
            expected=1.0,
            required=0.04,
            source=source,
            alternative=np.where(layers.depth == layers.depth.min(), by_activity, None),
            fails_if="adsorbed spheres do not collide with each other, or each has a site of its own; or the "
            "gas' activity takes the place of its pressure",
        ),
        Claim(
            claim=f"{subject}, mean of all depths",
            measured=combine_estimates(layers.filling),
            expected=1.0,
            required=0.005,
            source=source,
            fails_if="adsorbed spheres close as much of the gas' room as single ones, or a part of it twice",
        ),
        Claim.joint(
            claim=f"{subject}, all depths",
            deviations=(layers.filling - 1.0).deviation,
            source=source,
            fails_if="uncertainties too small, as from time blocks that are not independent",
        ),
    ]


def _sticky(walls: Table, wells: Table) -> list[Claim]:
    power = fit_power_law(walls.gas_density.value, walls.coverage)
    slow = float(slow_flux_share(walls.slow_speed[0]))
    return [
        Claim.at_most(
            claim="sticky rule: power of the gas' density in the coverage of a wall at low coverage",
            measured=power.estimate,
            bound=0.2,
            required=0.1,
            source="the gas both brings and frees particles, both as its density; Henry's law requires 1",
            fails_if="a coverage that is proportional to the pressure, as under detailed balance",
        ),
        Claim.at_most(
            claim="sticky rule: slow particles that leave the wall, over those that would in equilibrium",
            measured=combine_estimates(walls.slow_share) / slow,
            bound=0.5,
            required=0.1,
            source="slow particles stick, and none is sent back so slowly: only those slowed down when freed "
            "remain",
            fails_if="a wall that sends back as many slow particles as it takes",
        ),
        Claim(
            claim="wells: share of the particles that leave below sqrt(kT/m)",
            measured=combine_estimates(wells.slow_share),
            expected=slow_flux_share(1.0),
            required=0.005,
            source="flux of a Maxwellian, 1 - e^(-1/2) (exact)",
            fails_if="a well that selects particles by their speed",
        ),
    ]
