"""Claims about a fluid between two walls."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared.claims import rows

CONTACT = "contact theorem (exact: momentum balance at a hard wall)"


def thin_film(dataset: xr.Dataset) -> list[Claim]:
    """The contact theorem, the bulk far from the walls, and how the pressure oscillates with the width."""
    claims = [*_contact(dataset), _bulk(dataset), _potential(dataset)]
    return claims + (_oscillation(dataset) if dataset.sizes["width"] >= 6 else [])


def _contact(dataset: xr.Dataset) -> list[Claim]:
    ratios = [_contact_ratio(at) for at in rows(dataset, "width")]
    what = "density at the wall times k_B T over the pressure on it"
    return [
        Claim(
            claim=f"{what}, {_width(dataset)}",
            measured=ratios[-1],
            expected=1.0,
            required=0.01,
            source=CONTACT,
            fails_if="missed or spurious collisions with walls, or spheres that accumulate at walls",
        ),
        Claim.joint(
            claim=f"{what}, all widths",
            deviations=[(ratio - 1.0).deviation for ratio in ratios],
            source=CONTACT,
            fails_if="a bias too small for one width, or error bars that are wrong",
        ),
    ]


def _contact_ratio(at: xr.Dataset) -> Estimate:
    """k_B T times the density at the wall over the pressure on it; the error of the extrapolation counts."""
    density = Estimate.of(at, "contact") + Estimate(0.0, at["truncation"])
    return density / Estimate.of(at, "pressure")


def _width(dataset: xr.Dataset) -> str:
    return f"width {float(dataset['width'][-1]):g}"


def _in_the_middle(dataset: xr.Dataset, function: Callable[[float], float]) -> Estimate:
    """A function of the density, at the density measured in the middle of the widest slit."""
    density, step = Estimate.of(dataset, "middle"), 1e-4
    here, above = function(density.value), function(density.value + step)
    return Estimate(here, (above - here) / step * density.error, density.freedom)


def _eta(density: float) -> float:
    return float(theory.packing_fraction(density, 3))


def _bulk(dataset: xr.Dataset) -> Claim:
    """The wall's pressure is the bulk's at the density found in the middle."""
    pressure = Estimate.of(dataset.isel(width=-1), "pressure")
    bulk = _in_the_middle(dataset, lambda x: x * float(theory.compressibility_factor(_eta(x), 3)))
    return Claim(
        claim=f"pressure on the walls over the bulk's at the density in the middle, {_width(dataset)}",
        measured=(pressure + (bulk - bulk.value)) / bulk.value,
        expected=1.0,
        required=0.005,
        source="uniform normal pressure (exact) and [Kolafa 2004]",
        fails_if="wrong momentum transfer to walls, or layers that reach the middle",
    )


def _potential(dataset: xr.Dataset) -> Claim:
    measured = Estimate.of(dataset.isel(width=-1), "chemical_potential")
    bulk = _in_the_middle(
        dataset, lambda x: math.log(x) + float(theory.excess_chemical_potential(_eta(x), 3))
    )
    return Claim(
        claim="chemical potential by insertion minus the bulk's at the density in the middle, k_B T, "
        f"{_width(dataset)}",
        measured=measured - bulk,
        expected=0.0,
        required=0.1,
        source="uniform chemical potential (exact) and [Kolafa 2004]",
        fails_if="the slit is not in equilibrium, or too small for its number to fluctuate freely",
    )


def _oscillation(dataset: xr.Dataset) -> list[Claim]:
    narrow = dataset.isel(width=slice(0, -1))
    excess = (narrow["at_bulk"] - dataset.attrs["bulk_pressure"]).values
    expected = (narrow["functional_pressure"] - dataset.attrs["functional_bulk_pressure"]).values
    weights = narrow["at_bulk_error"].values ** -2.0
    norm = np.sum(weights * expected**2)
    return [
        Claim(
            claim="period of the solvation pressure in diameters",
            measured=Estimate(dataset.attrs["period"], dataset.attrs["period_error"]),
            expected=dataset.attrs["functional_period"],
            required=0.05,
            source="White Bear functional ([Roth 2002]; computed), the same fit to the same widths",
            fails_if="no layers, or widths too far apart to resolve them",
        ),
        Claim.within(
            claim="solvation pressure over that of the density functional, fitted to all widths but the "
            "widest",
            measured=Estimate(np.sum(weights * excess * expected) / norm, norm**-0.5),
            expected=1.0,
            half_width=0.15,
            source="White Bear functional ([Roth 2002]; computed)",
            fails_if="the slits are not in equilibrium with one bulk",
        ),
    ]
