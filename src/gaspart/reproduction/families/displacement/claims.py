"""Claims about displacements: D of spheres against theory; of discs, that D(t) grows as ln t."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared.claims import ENSKOG_LIMIT, MODE_COUPLING, rows, weighted_mean

DILUTE_BAND = 0.007
"""Most that D differs from Enskog's there, as a part of it: by Erpenbeck and Wood's fit 0.6 % at 0.02."""
ERPENBECK_WOOD = "[Erpenbeck 1991]"
REQUIRED = 0.015
"""Relative uncertainty of D above which the claim is inconclusive."""


def msd_spheres(ds: xr.Dataset) -> list[Claim]:
    """D against Enskog where the gas is dilute, and against simulations of the literature where it is not."""
    largest = rows(ds.isel(point=np.flatnonzero(ds["largest"])), "point")
    claims = [_dilute_limit([row for row in largest if _is_dilute(row)])]
    for row in largest:
        if not _is_dilute(row):
            eta = float(row["packing_fraction"])
            claims.append(
                Claim(
                    claim=f"D over Erpenbeck and Wood's at packing fraction {eta:g}",
                    measured=_diffusion(row) / theory.erpenbeck_wood_diffusion(eta),
                    expected=Estimate(1.0, theory.ERPENBECK_WOOD_UNCERTAINTY),
                    required=REQUIRED,
                    source=ERPENBECK_WOOD,
                    allowance_source="its largest difference from [Pieprzyk 2019]",
                    fails_if="correlated collisions missing, a msd not yet straight, a wrong finite-size "
                    "correction",
                )
            )
    if bool(ds["in_series"].any()):
        claims.append(_size_slope(ds))
    return claims + _short_times(ds, 3)


def _is_dilute(row: xr.Dataset) -> bool:
    return bool(row["packing_fraction"] <= ENSKOG_LIMIT * (1.0 + 1e-6))


def _diffusion(row: xr.Dataset) -> Estimate:
    return Estimate.of(row, "diffusion") + Estimate(row["correction"], row["correction_uncertainty"])


def _dilute_limit(dilute: list[xr.Dataset]) -> Claim:
    """Mean of D over Enskog's at the lowest packing fractions, weighted by the errors."""
    ratios = [_diffusion(row) / theory.enskog_diffusion(float(row["packing_fraction"]), 3) for row in dilute]
    return Claim.within(
        claim=f"D over Enskog's in the dilute limit (packing fraction {ENSKOG_LIMIT:g} and below)",
        measured=weighted_mean(ratios),
        expected=1.0,
        half_width=DILUTE_BAND,
        source="Enskog theory, 1.01895 times the first Sonine approximation",
        alternative=1.0 / 1.01895,
        fails_if="a wrong mean free path, or a msd not yet straight; the first approximation is 1.9 % low",
    )


def _size_slope(ds: xr.Dataset) -> Claim:
    first = ds.isel(point=ds["in_series"].values).isel(point=0)
    expected = -float(first["correction"] * first["side"])
    return Claim(
        claim=f"slope of D against 1/L at packing fraction {float(first['packing_fraction']):g}",
        measured=Estimate.of(ds, "size_slope"),
        expected=expected,
        required=0.15 * abs(expected),
        source="[Yeh 2004], with the measured viscosity and modes that decay with nu + D",
        alternative=0.0,
        fails_if="D that does not depend on the container as hydrodynamics states",
    )


def msd_discs(ds: xr.Dataset) -> list[Claim]:
    """The slope of D(t) against ln t; no D, since none exists."""
    claims = []
    for row in rows(ds.isel(point=np.isfinite(ds["logarithmic_slope"].values)), "point"):
        eta = float(row["packing_fraction"])
        expected = float(row["slope_expected"])
        claims.append(
            Claim(
                claim=f"slope of D(t) against ln t at packing fraction {eta:g}",
                measured=Estimate.of(row, "logarithmic_slope"),
                expected=expected,
                required=0.15 * expected,
                source=MODE_COUPLING,
                alternative=0.0,
                fails_if="a velocity autocorrelation that has no 1/t tail, so that D exists",
            )
        )
    return claims + _short_times(ds, 2)


def _short_times(ds: xr.Dataset, dimension: int) -> list[Claim]:
    """From the finely sampled runs: the ballistic start, and Einstein's D(t) against Green and Kubo's."""
    claims = []
    for row in rows(ds.isel(point=np.isfinite(ds["integral_difference"].values)), "point"):
        eta, first = float(row["packing_fraction"]), row.isel(lag=1)
        ballistic = theory.enskog_mean_squared_displacement(float(first["time"]), eta, dimension)
        claims += [
            Claim.within(
                claim=f"Green-Kubo integral over Einstein slope at packing fraction {eta:g}",
                kind="identity",
                measured=Estimate.of(row, "integral_difference") + 1.0,
                expected=1.0,
                half_width=0.01,
                source="stationarity (exact)",
                fails_if="displacements that are not the integral of the velocities, or sampling too coarse",
            ),
            Claim.within(
                claim=f"msd over Enskog's after {float(row['interval']):.2g} collisions, "
                f"packing fraction {eta:g}",
                measured=Estimate.of(first, "msd") / ballistic,
                expected=1.0,
                half_width=0.005,
                source="exponential velocity autocorrelation, 2 to 3 % of whose rate matter (Enskog)",
                fails_if="a wrong temperature, time or initial decay of the velocity",
            ),
        ]
    return claims
