"""Claims about the equation of state."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.statistics import combine_estimates
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.table import Row, Table, each

RELATIVE_ERROR = 1e-3
"""The largest standard error of Z, relative to it, at which its comparison means anything."""
WANTED = {2: 1e-3, 3: 1e-2, 4: 1e-1}
"""Wanted relative accuracy of each virial coefficient; its standard error is to be half of it."""
REFERENCE: dict[int, dict[str, Any]] = {
    2: {
        "source": "virial series to B10 ([Clisby 2006]) and a linear tail",
        "allowance_source": "of the virial coefficients ([Clisby 2006]), and the tail's distance from Liu's "
        "equation",
    },
    3: {
        "source": "[Kolafa 2004]",
        "allowance_source": "its distance from the equation of etomica, or from the virial series, if less",
    },
}
EXACT = {
    2: "exact: [source C], Eq. 48 ([Rowlinson 1964], [Hemmer 1965])",
    3: "exact: [Boltzmann 1899]",
}
KOLAFA_RANGE = (0.19, 0.41)
"""Packing fractions at which Carnahan and Starling's equation is 0.13 to 0.3 % low, which is resolved."""


def virial_discs(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims on Z, B2, B3, B4, the collision rate, and correct error bars.

    Z is claimed at every packing fraction.
    """
    gases, fits = Table(dataset, "packing_fraction"), Table(dataset, "fit")
    dimension = gases.dimension
    # Enskog's rate is as accurate as Z - 1: the same reference, the same uncertainty.
    enskog = Estimate(1.0, gases.reference.error / (gases.reference.value - 1.0))
    return [
        *each(
            gases,
            "Z at packing fraction {packing_fraction:.4g}",
            measured=gases.Z,
            expected=gases.reference,
            required=RELATIVE_ERROR * gases.reference.value,
            **REFERENCE[dimension],
            fails_if="missed or spurious contacts, wrong impulses, or a fluid that is not in equilibrium",
        ),
        Claim.joint(
            claim="Z at all packing fractions together",
            deviations=(gases.Z - gases.reference).deviation,
            source=REFERENCE[dimension]["source"],
            fails_if="a bias too small for one point is common to many, or the error bars are wrong",
        ),
        *(_coefficients(fits[0], dimension) if fits else []),
        Claim.joint(
            claim="collision rate over Enskog's at all packing fractions",
            deviations=(gases.collision_rate - enskog).deviation,
            source="Enskog's rate, exact in equilibrium, with the reference's contact value",
            fails_if="collisions are missed or counted twice, or velocities at contact are not Maxwellian",
        ),
        *_replicas(gases),
    ]


def virial_spheres(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims of `virial_discs`, and that two equations are distinguished.

    They are Kolafa, Labík and Malijevský's and Carnahan and Starling's.
    """
    gases, (low, high) = Table(dataset, "packing_fraction"), KOLAFA_RANGE
    chosen = gases[(gases.packing_fraction >= low) & (gases.packing_fraction <= high)]
    return virial_discs(dataset) + ([_distinguish(chosen)] if chosen else [])


def _coefficients(fit: Row, dimension: int) -> list[Claim]:
    orders = Table(fit.dataset.sel(order=list(WANTED)), "order")
    held = f"B{fit.free + 1} to B10 held at literature values" if fit.held else "higher ones zero"
    return each(
        orders,
        f"B{{order}} in powers of the particle's {'area' if dimension == 2 else 'volume'} "
        f"(B2 to B{fit.free} fitted up to packing fraction {fit.up_to:g}, {held})",
        measured=orders.coefficient + Estimate(0.0, orders.held_error),
        expected=orders.exact.value,
        required=0.5 * np.array(list(WANTED.values())) * orders.exact.value,
        source=EXACT[dimension],
        fails_if="Z is biased at low density, where every error of Z - 1 is an error of B2",
    )


def _replicas(gases: Table) -> list[Claim]:
    freedom = int(gases.replica_degrees_of_freedom.sum())
    if not freedom:
        return []
    return [
        Claim.chi_square(
            claim="error bars: scatter of replicas over what their blocks predict "
            "(chi-square per degree of freedom)",
            chi_square=float(gases.replica_chi_square.sum()),
            degrees_of_freedom=freedom,
            source="independent replicas of one state have one mean",
            fails_if="blocks are too short, runs are not equilibrated, or seeds are not independent",
        )
    ]


def _distinguish(chosen: Table) -> Claim:
    """Return the claim on the mean of Z / Z_CS - 1.

    It is the value of Kolafa, Labík and Malijevský's equation there, not 0.
    """
    eta = chosen.packing_fraction
    measured, stated = (z / theory.carnahan_starling(eta) - 1.0 for z in (chosen.Z, chosen.reference))
    expected = Estimate(measured.weights @ stated.value, measured.weights @ stated.error)
    return Claim(
        claim=f"excess of Z over Carnahan-Starling, mean of packing fractions {eta.min():.2g} to "
        f"{eta.max():.2g}",
        measured=combine_estimates(measured),
        expected=expected,
        required=expected.value / 5.0,
        **REFERENCE[3],
        alternative=0.0,
        fails_if="Z is too imprecise or biased to distinguish the two equations",
    )
