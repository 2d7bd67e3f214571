"""What the figure of a fluid between two walls claims."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.claims import Claim

CONTACT = "contact theorem (exact: momentum balance at a hard wall)"


def thin_film(dataset: xr.Dataset) -> list[Claim]:
    """The contact theorem, the bulk far from the walls, and how the pressure oscillates with the width."""
    widest = dataset.isel(width=-1)
    ratio = dataset["contact"] / dataset["pressure"]
    relative = np.hypot(
        np.hypot(dataset["contact_error"], dataset["truncation"]) / dataset["contact"],
        dataset["pressure_error"] / dataset["pressure"],
    )
    sigmas = ((ratio - 1.0) / relative).values
    claims = [
        Claim(
            f"density at the wall times k_B T over the pressure on it, width {float(widest['width']):g}",
            "test",
            float(ratio[-1]),
            float(relative[-1]),
            0.01,
            1.0,
            CONTACT,
            fails_if="hits at walls are missed or made up, or spheres pile up at walls",
        ),
        Claim.chi_square(
            "density at the wall times k_B T over the pressure on it, all widths (chi-square per degree "
            "of freedom)",
            "test",
            float(np.sum(sigmas**2)),
            sigmas.size,
            CONTACT,
            "a bias too small for one width, or error bars that are wrong",
        ),
        _bulk(dataset, widest),
        _potential(dataset, widest),
    ]
    return claims + (_oscillation(dataset) if dataset.sizes["width"] >= 6 else [])


def _eta(density: float) -> float:
    return float(theory.packing_fraction(density, 3))


def _bulk(dataset: xr.Dataset, widest: xr.Dataset) -> Claim:
    """The wall's pressure is the bulk's at the density found in the middle."""
    density, error = float(dataset["middle"]), float(dataset["middle_error"])
    step = 1e-4
    pressure, above = (
        x * float(theory.compressibility_factor(_eta(x), 3)) for x in (density, density + step)
    )
    return Claim(
        f"pressure on the walls over the bulk's at the density in the middle, "
        f"width {float(widest['width']):g}",
        "test",
        float(widest["pressure"]) / pressure,
        math.hypot(float(widest["pressure_error"]), (above - pressure) / step * error) / pressure,
        0.005,
        1.0,
        "uniform normal pressure (exact) and Kolafa, Labík and Malijevský 2004",
        expected_uncertainty=1e-3,  # layers that have not died out, by the density functional
        fails_if="momentum given to walls is wrong, or the layers reach the middle",
    )


def _potential(dataset: xr.Dataset, widest: xr.Dataset) -> Claim:
    density, error = float(dataset["middle"]), float(dataset["middle_error"])
    step = 1e-4
    here, above = (
        math.log(x) + float(theory.excess_chemical_potential(_eta(x), 3)) for x in (density, density + step)
    )
    return Claim(
        f"chemical potential by insertion less the bulk's at the density in the middle, k_B T, "
        f"width {float(widest['width']):g}",
        "test",
        float(widest["chemical_potential"]) - here,
        math.hypot(float(widest["chemical_potential_error"]), (above - here) / step * error),
        0.1,
        0.0,
        "uniform chemical potential (exact) and Kolafa, Labík and Malijevský 2004",
        expected_uncertainty=0.005,
        fails_if="the slit is not in equilibrium, or too small for its number to fluctuate freely",
    )


def _oscillation(dataset: xr.Dataset) -> list[Claim]:
    narrow = dataset.isel(width=slice(0, -1))
    excess = (narrow["at_bulk"] - dataset.attrs["bulk_pressure"]).values
    expected = (narrow["functional_pressure"] - dataset.attrs["functional_bulk_pressure"]).values
    weights = narrow["at_bulk_error"].values ** -2.0
    slope = np.sum(weights * excess * expected) / np.sum(weights * expected**2)
    return [
        Claim.within(
            "period of the solvation pressure in diameters",
            "test",
            float(dataset.attrs["period"]),
            float(dataset.attrs["period_error"]),
            1.0,
            0.1,
            "layers of spheres, one diameter thick",
            "no layers, or widths too far apart to see them",
        ),
        Claim.within(
            "solvation pressure over that of the density functional, fitted to all widths but the widest",
            "test",
            float(slope),
            float(np.sum(weights * expected**2) ** -0.5),
            1.0,
            0.15,
            "White Bear functional (Roth and others 2002; computed)",
            "the slits are not in equilibrium with one bulk",
        ),
    ]
