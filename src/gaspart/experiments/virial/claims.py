"""What the equation-of-state figures claim."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.statistics import combine
from gaspart.claims import Claim

RELATIVE_ERROR = 1e-3
"""The largest standard error of Z, relative to it, at which its comparison means anything."""
WANTED = {2: 1e-3, 3: 1e-2, 4: 1e-1}
"""How well each virial coefficient is to be known, relative to it; its standard error is to be half of it."""
REFERENCE = {
    2: "virial series to B10 (Clisby and McCoy 2006) and a linear tail",
    3: "Kolafa, Labík and Malijevský 2004",
}
EXACT = {
    2: "exact: source C, Eq. 48 (Rowlinson 1964, Hemmer 1965)",
    3: "exact: Boltzmann 1899",
}
KOLAFA_RANGE = (0.19, 0.41)
"""Packing fractions at which Carnahan and Starling's equation is 0.13 to 0.3 % low, and can be told apart."""


def virial_discs(dataset: xr.Dataset) -> list[Claim]:
    """Z at every packing fraction; B2, B3, B4; the collision rate; and that the error bars are right."""
    return equation_of_state(dataset)


def virial_spheres(dataset: xr.Dataset) -> list[Claim]:
    """As for discs, and that Kolafa, Labík and Malijevský's equation is told from Carnahan and Starling's."""
    claims = equation_of_state(dataset)
    eta = dataset["packing_fraction"].values
    chosen = dataset.isel(packing_fraction=(eta >= KOLAFA_RANGE[0]) & (eta <= KOLAFA_RANGE[1]))
    if chosen.sizes["packing_fraction"]:
        claims.append(_told_apart(chosen))
    return claims


def equation_of_state(dataset: xr.Dataset) -> list[Claim]:
    """The claims that both dimensions share."""
    dimension = int(dataset.attrs["dimension"])
    claims = [
        _compressibility(dataset.isel(packing_fraction=k), dimension)
        for k in range(dataset.sizes["packing_fraction"])
    ]
    claims.append(_jointly(dataset, dimension))
    if dataset.sizes["fit"]:
        claims += [_coefficient(dataset.isel(fit=0), order, dimension) for order in WANTED]
    claims += [_rate(dataset), *_replicas(dataset)]
    return claims


def _compressibility(at: xr.Dataset, dimension: int) -> Claim:
    reference = float(at["reference"])
    return Claim(
        f"Z at packing fraction {float(at['packing_fraction']):.4g}",
        "test",
        float(at["Z"]),
        float(at["Z_error"]),
        RELATIVE_ERROR * reference,
        reference,
        REFERENCE[dimension],
        expected_uncertainty=float(at["reference_error"]),
        fails_if="contacts are missed or made up, impulses are wrong, or the fluid is not in equilibrium",
    )


def _jointly(dataset: xr.Dataset, dimension: int) -> Claim:
    spread = np.hypot(dataset["Z_error"], dataset["reference_error"])
    sigmas = ((dataset["Z"] - dataset["reference"]) / spread).values
    return Claim.chi_square(
        "Z at all packing fractions together (chi-square per degree of freedom)",
        "test",
        float(np.sum(sigmas**2)),
        sigmas.size,
        REFERENCE[dimension],
        "a bias too small for one point is common to many, or the error bars are wrong",
    )


def _coefficient(fit: xr.Dataset, order: int, dimension: int) -> Claim:
    at = fit.sel(order=order)
    exact = float(at["exact"])
    held = (
        f"B{int(fit['free']) + 1} to B10 held at literature values"
        if int(fit["held"])
        else "higher ones zero"
    )
    return Claim(
        f"B{order} in powers of the body's {'area' if dimension == 2 else 'volume'} "
        f"(B2 to B{int(fit['free'])} fitted up to packing fraction {float(fit['up_to']):g}, {held})",
        "test",
        float(at["coefficient"]),
        float(np.hypot(at["coefficient_error"], at["held_error"])),
        0.5 * WANTED[order] * exact,
        exact,
        EXACT[dimension],
        fails_if="Z is biased at low density, where every error of Z - 1 is an error of B2",
    )


def _rate(dataset: xr.Dataset) -> Claim:
    # Enskog's rate is as good as Z - 1: the same reference, the same uncertainty.
    excess = dataset["reference_error"] / (dataset["reference"] - 1.0)
    spread = np.hypot(dataset["collision_rate_error"], excess)
    sigmas = ((dataset["collision_rate"] - 1.0) / spread).values
    return Claim.chi_square(
        "collision rate over Enskog's at all packing fractions (chi-square per degree of freedom)",
        "test",
        float(np.sum(sigmas**2)),
        sigmas.size,
        "Enskog's rate, exact in equilibrium, with the reference's contact value",
        "collisions are missed or counted twice, or velocities at contact are not Maxwellian",
    )


def _replicas(dataset: xr.Dataset) -> list[Claim]:
    freedom = int(dataset["replica_degrees_of_freedom"].sum())
    if not freedom:
        return []
    return [
        Claim.chi_square(
            "error bars: scatter of replicas over what their blocks predict "
            "(chi-square per degree of freedom)",
            "test",
            float(dataset["replica_chi_square"].sum()),
            freedom,
            "independent replicas of one state have one mean",
            "blocks are too short, runs are not equilibrated, or seeds are not independent",
        )
    ]


def _told_apart(chosen: xr.Dataset) -> Claim:
    """Mean of Z / Z_CS - 1: what Kolafa, Labík and Malijevský's equation gives there, not 0."""
    eta = chosen["packing_fraction"].values
    starling = theory.carnahan_starling(eta)
    errors = (chosen["Z_error"] / starling).values
    mean = combine((chosen["Z"] / starling - 1.0).values, errors)
    weights = errors**-2 / np.sum(errors**-2)
    expected = float(np.sum(weights * (chosen["reference"] / starling - 1.0).values))
    return Claim(
        f"excess of Z over Carnahan-Starling, mean of packing fractions {eta.min():.2g} to {eta.max():.2g}",
        "test",
        mean.value,
        mean.error,
        expected / 5.0,
        expected,
        f"{REFERENCE[3]}; Carnahan and Starling themselves would have 0, five standard errors away or more",
        expected_uncertainty=float(np.sum(weights * (chosen["reference_error"] / starling).values)),
        fails_if="Z is too imprecise or biased to tell the two equations apart",
    )
