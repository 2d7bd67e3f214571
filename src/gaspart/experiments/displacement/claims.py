"""What the displacement figures claim: D of spheres against theory; of discs, that D(t) grows as ln t."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.statistics import combine
from gaspart.claims import Claim

DILUTE = 0.02
"""Packing fraction up to which a gas counts as dilute: D is within 0.7 % of Enskog's there."""
ERPENBECK_WOOD = "Erpenbeck & Wood 1991 (recalled; good to 3 %)"


def msd_spheres(ds: xr.Dataset) -> list[Claim]:
    """D against Enskog where the gas is dilute, and against simulations of the literature where it is not."""
    claims = [_dilute_limit(ds)]
    for point in np.flatnonzero(ds["largest"]):
        row = ds.isel(point=point)
        eta = float(row["packing_fraction"])
        if eta > DILUTE * (1.0 + 1e-6):
            expected = theory.erpenbeck_wood_diffusion(eta)
            claims.append(
                Claim.within(
                    f"D over Erpenbeck and Wood's at packing fraction {eta:g}",
                    "test",
                    float(row["diffusion"] + row["correction"]) / expected,
                    _error(row) / expected,
                    1.0,
                    theory.ERPENBECK_WOOD_UNCERTAINTY,
                    ERPENBECK_WOOD,
                    "correlated collisions missing, a msd not yet straight, a wrong finite-size correction",
                )
            )
    if bool(ds["in_series"].any()):
        claims.append(_size_slope(ds))
    return claims + _short_times(ds, 3)


def _error(row: xr.Dataset) -> float:
    return float(np.hypot(row["diffusion_error"], row["correction_uncertainty"]))


def _dilute_limit(ds: xr.Dataset) -> Claim:
    """Mean of D over Enskog's at the lowest packing fractions, weighted by the errors."""
    rows = [ds.isel(point=point) for point in np.flatnonzero(ds["largest"])]
    rows = [row for row in rows if row["packing_fraction"] <= DILUTE * (1.0 + 1e-6)]
    enskog = [float(theory.enskog_diffusion(float(row["packing_fraction"]), 3)) for row in rows]
    ratios = [
        float(row["diffusion"] + row["correction"]) / value for row, value in zip(rows, enskog, strict=True)
    ]
    errors = [_error(row) / value for row, value in zip(rows, enskog, strict=True)]
    mean = combine(ratios, errors) if rows else None
    return Claim.within(
        f"D over Enskog's in the dilute limit (packing fraction {DILUTE:g} and below)",
        "test",
        mean.value if mean else math.nan,
        mean.error if mean else math.nan,
        1.0,
        0.02,
        "Enskog theory, 1.01895 times the first Sonine approximation",
        "a wrong mean free path, or a msd not yet straight; the first approximation is 1.9 % low",
        required_uncertainty=0.005,
    )


def _size_slope(ds: xr.Dataset) -> Claim:
    series = ds.isel(point=ds["in_series"].values)
    first = series.isel(point=0)
    expected = -float(first["correction"] * first["side"])
    return Claim(
        f"slope of D against 1/L at packing fraction {float(first['packing_fraction']):g}",
        "test",
        ds["size_slope"],
        ds["size_slope_error"],
        0.15 * abs(expected),
        expected,
        "Yeh & Hummer 2004, with Enskog's viscosity",
        0.05 * abs(expected),
        "D that does not depend on the container as hydrodynamics says",
    )


def msd_discs(ds: xr.Dataset) -> list[Claim]:
    """The slope of D(t) against ln t; no D, for there is none."""
    claims = []
    for point in np.flatnonzero(np.isfinite(ds["logarithmic_slope"])):
        row = ds.isel(point=point)
        eta = float(row["packing_fraction"])
        expected = float(theory.logarithmic_slope(eta))
        claims.append(
            Claim(
                f"slope of D(t) against ln t at packing fraction {eta:g}",
                "test",
                row["logarithmic_slope"],
                row["logarithmic_slope_error"],
                0.15 * expected,
                expected,
                "mode coupling with Enskog's D and viscosity (Ernst, Hauge & van Leeuwen 1970; recalled)",
                expected * _renormalisation(row),
                "a velocity autocorrelation that has no 1/t tail, so that D exists",
            )
        )
    return claims + _short_times(ds, 2)


def _renormalisation(row: xr.Dataset) -> float:
    """Relative uncertainty of the predicted slope: what the measured D(t) for Enskog's D would change."""
    eta = float(row["packing_fraction"])
    enskog = float(theory.enskog_diffusion(eta, 2))
    middle = math.sqrt(float(row["fit_from"]) * float(row["fit_to"]))
    measured = float(np.interp(middle, row["time"].dropna("lag"), row["running"].dropna("lag")))
    kinematic = float(row["viscosity"]) / theory.number_density(eta, 2)
    return float(abs(measured - enskog) / (enskog + kinematic))


def _short_times(ds: xr.Dataset, dimension: int) -> list[Claim]:
    """From the finely sampled runs: the ballistic start, and Einstein's D(t) against Green and Kubo's."""
    claims = []
    for point in np.flatnonzero(np.isfinite(ds["integral_difference"])):
        row = ds.isel(point=point)
        eta = float(row["packing_fraction"])
        first = row.isel(lag=1)
        ballistic = theory.enskog_mean_squared_displacement(float(first["time"]), eta, dimension)
        claims += [
            Claim.within(
                f"Green-Kubo integral over Einstein slope at packing fraction {eta:g}",
                "identity",
                1.0 + float(row["integral_difference"]),
                row["integral_difference_error"],
                1.0,
                0.01,
                "stationarity (exact)",
                "displacements that are not the integral of the velocities, or sampling too coarse",
            ),
            Claim.within(
                f"msd over Enskog's after {float(row['interval']):.2g} collisions, packing fraction {eta:g}",
                "test",
                float(first["msd"]) / ballistic,
                float(first["msd_error"]) / ballistic,
                1.0,
                0.005,
                "exponential velocity autocorrelation, 2 to 3 % of whose rate matter (Enskog)",
                "a wrong temperature, time or initial decay of the velocity",
            ),
        ]
    return claims
