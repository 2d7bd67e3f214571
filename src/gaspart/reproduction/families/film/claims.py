"""Claims about a dense fluid between two walls."""

from __future__ import annotations

import math
from collections.abc import Callable

import xarray as xr

from gaspart import theory
from gaspart.analysis.statistics import fit_polynomial
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.table import Row, Table

CONTACT = "contact theorem (exact: momentum balance at a hard wall)"


def thin_film(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims on the contact theorem, the bulk, and the oscillating pressure.

    The fluid far from the walls is the bulk. The pressure oscillates with the distance between the walls.
    """
    slits = Table(dataset, "width")
    claims = [*_contact(slits), _bulk(slits[-1]), _potential(slits[-1])]
    return claims + (_oscillation(slits) if len(slits) >= 6 else [])


def contact_ratio(slits: Table) -> Estimate:
    """Compute k_B T times the density at the wall, divided by the pressure, for each slit.

    The error includes the error of the extrapolation to the wall.
    """
    density = slits.contact + Estimate(0.0, slits.truncation)
    return density / slits.pressure


def _contact(slits: Table) -> list[Claim]:
    ratio = contact_ratio(slits)
    subject = "density at the wall times k_B T over the pressure on it"
    return [
        Claim(
            claim=f"{subject}, width {slits.width[-1]:g}",
            measured=ratio[-1],
            expected=1.0,
            required=0.01,
            source=CONTACT,
            fails_if="missed or spurious collisions with walls, or spheres that accumulate at walls",
        ),
        Claim.joint(
            claim=f"{subject}, all widths",
            deviations=(ratio - 1.0).deviation,
            source=CONTACT,
            fails_if="a bias too small for one width, or error bars that are wrong",
        ),
    ]


def _of_density(function: Callable[[float], float], density: Estimate) -> Estimate:
    """Compute a function of a measured density, with its error."""
    step = 1e-4
    here, above = function(density.value), function(density.value + step)
    return Estimate(here, (above - here) / step * density.error, density.freedom)


def _eta(density: float) -> float:
    return float(theory.packing_fraction(density, 3))


def _bulk(widest: Row) -> Claim:
    """Return the claim that the wall pressure is the bulk pressure at the middle's density."""
    bulk = _of_density(lambda x: x * float(theory.compressibility_factor(_eta(x), 3)), widest.middle)
    return Claim(
        claim=f"pressure on the walls over the bulk's at the density in the middle, width {widest.width:g}",
        measured=(widest.pressure + (bulk - bulk.value)) / bulk.value,
        expected=1.0,
        required=0.005,
        source="uniform normal pressure (exact) and [Kolafa 2004]",
        fails_if="wrong momentum transfer to walls, or layers that reach the middle",
    )


def _potential(widest: Row) -> Claim:
    bulk = _of_density(
        lambda x: math.log(x) + float(theory.excess_chemical_potential(_eta(x), 3)), widest.middle
    )
    return Claim(
        claim="chemical potential by insertion minus the bulk's at the density in the middle, k_B T, "
        f"width {widest.width:g}",
        measured=widest.chemical_potential - bulk,
        expected=0.0,
        required=0.1,
        source="uniform chemical potential (exact) and [Kolafa 2004]",
        fails_if="the slit is not in equilibrium, or too small for its number to fluctuate freely",
    )


def _oscillation(slits: Table) -> list[Claim]:
    narrow = slits[:-1]
    excess = narrow.at_bulk - slits.bulk_pressure
    functional = narrow.functional_pressure - slits.functional_bulk_pressure
    return [
        Claim(
            claim="period of the solvation pressure in diameters",
            measured=Estimate(slits.period, slits.period_error),
            expected=slits.functional_period,
            required=0.05,
            source="White Bear functional ([Roth 2002]; computed), the same fit to the same widths",
            fails_if="no layers, or widths too far apart to resolve them",
        ),
        Claim.within(
            claim="solvation pressure over that of the density functional, fitted to all widths but the "
            "widest",
            measured=fit_polynomial(functional, excess, powers=(1,)).estimate(0),
            expected=1.0,
            half_width=0.15,
            source="White Bear functional ([Roth 2002]; computed)",
            fails_if="the slits are not in equilibrium with one bulk",
        ),
    ]
