"""Claims about viscosity and thermal conductivity."""

from __future__ import annotations

import xarray as xr

from gaspart.analysis.statistics import combine_estimates
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared import ENSKOG_LIMIT, PARTICLES
from gaspart.reproduction.table import Row, Table

DILUTE_BAND = 0.01
"""Largest relative difference between a coefficient of a dilute gas and Enskog theory. At packing fraction
0.02, a particle collides again with a former partner in 2 of 100 collisions, which changes D by 0.6 %."""
ENSKOG = "Enskog's theory, with the Sonine polynomials that matter [Chapman 1970]"
ACCURATE = 0.3
"""Largest packing fraction at which Enskog's coefficients of spheres are accurate to a few per cent."""
FEW_PER_CENT = 0.05


def viscosity(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on the shear and the bulk viscosity of spheres and discs."""
    gases = Table(ds, "point")
    return _claims(gases, "viscosity") + [_bulk(gas) for gas in gases]


def conductivity(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on the thermal conductivity of spheres and discs."""
    return _claims(Table(ds, "point"), "conductivity")


def _is_within(gas: Row, packing_fraction: float) -> bool:
    """Return True if a gas has at most this packing fraction, except for rounding."""
    return bool(gas.packing_fraction <= packing_fraction * (1.0 + 1e-6))


def _which(gas: Row) -> str:
    particles = PARTICLES[gas.dimension]
    return f"{particles}, packing fraction {gas.packing_fraction:.3g}, {gas.count} particles"


def _bulk(gas: Row) -> Claim:
    """Return the claim on the bulk viscosity."""
    unknown = {
        2: "of discs its integral grows with the logarithm of time",
        3: "what correlated collisions do near freezing is not known",
    }[gas.dimension]
    return Claim.within(
        claim=f"bulk viscosity over Enskog's, {_which(gas)}",
        measured=gas.bulk,
        expected=1.0,
        half_width=FEW_PER_CENT,
        source="[Chapman 1970]; expansion changes what passes at contacts at once, and kinetic parts not",
        no_verdict="" if _is_within(gas, {2: ENSKOG_LIMIT, 3: ACCURATE}[gas.dimension]) else unknown,
        fails_if="a pressure that is not that of the contacts",
    )


def _claims(gases: Table, name: str) -> list[Claim]:
    claims = []
    for gas in gases:
        if _is_within(gas, ENSKOG_LIMIT):
            claims.append(
                Claim.within(
                    claim=f"{name} over Chapman and Enskog's, {_which(gas)}",
                    measured=gas.value / gas.finite,
                    expected=1.0,
                    half_width=DILUTE_BAND,
                    source=ENSKOG,
                    fails_if="a wrong flux, correlations cut too early, or a wrong effect of finite numbers",
                )
            )
        elif gas.dimension == 3 and _is_within(gas, ACCURATE):
            claims.append(
                Claim.within(
                    claim=f"{name} over Enskog's, {_which(gas)}",
                    measured=gas.value,
                    expected=1.0,
                    half_width=FEW_PER_CENT + 1.0 - gas.finite,
                    source=f"{ENSKOG}; correlated collisions change it by a few per cent [Alder 1970b], the "
                    "finite number as in a dilute gas",
                    fails_if="a collisional part of the flux that is wrong or missing",
                )
            )
        claims.append(
            Claim.within(
                claim=f"growth by Helfand over Green and Kubo's integral, {name}, {_which(gas)}",
                kind="identity",
                measured=gas.difference + 1.0,
                expected=1.0,
                half_width=0.01,
                source="both are one double integral (exact), but for pairs at the ends of the runs",
                fails_if="sums that are not those of the same fluxes",
            )
        )
    return claims


def logarithmic_growth(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on the logarithmic growth of discs' coefficients with time."""
    gases = Table(ds, "point")
    growths = {
        "viscosity": (gases.viscosity_growth, gases.viscosity_short_waves),
        "conductivity": (gases.conductivity_growth, gases.conductivity_short_waves),
    }
    return [
        Claim(
            claim=f"growth of the {name}'s integral with time over that of the containers' modes",
            measured=combine_estimates(growth),
            expected=Estimate(1.0, short_waves.max()),
            required=0.25,
            source="mode coupling [Ernst 1971] with delayed vertices and relaxing fluxes, the modes of the "
            "containers (gaspart.theory.mode_pairs)",
            allowance_source="waves of one to two mean free paths, which are hardly modes",
            alternative=0.0,
            fails_if=f"a flux without a 1/t tail, so that the {name} exists",
        )
        for name, (growth, short_waves) in growths.items()
    ]
