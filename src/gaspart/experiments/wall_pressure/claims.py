"""What the figure about the pressure on walls claims."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.analysis.statistics import combine, fit_power_law
from gaspart.claims import Claim

RELATIVE_ERROR = 1e-3
"""The largest standard error of a pressure, relative to it, at which a mean of comparisons means anything."""
THEORY = (
    "bulk equation of state, surface tension and edges of the container (Hansen-Goos & Roth 2006; computed)"
)
NAMES = {2: "discs", 3: "spheres"}
FAILS = "walls miss hits or count them twice, or the wrong area, volume or density is taken"


def wall_pressure(ds: xr.Dataset) -> list[Claim]:
    """Walls feel the bulk's pressure, once the container is accounted for; it is proportional to T; without
    that account the comparison is off by far more than the error."""
    slits, closed = (
        ds.isel(point=((ds["axes"] < ds["dimension"]) == chosen).values) for chosen in (True, False)
    )
    claims = []
    for dimension in sorted(set(slits["dimension"].values)):
        claims += _between_walls(slits.isel(point=(slits["dimension"] == dimension).values), NAMES[dimension])
    claims += [_closed(closed.isel(point=point)) for point in range(closed.sizes["point"])]
    for dimension, count in ((2, 100), (3, 125)):
        small = (closed["dimension"] == dimension) & (closed["count"] == count)
        small &= np.abs(closed["packing_fraction"] - 0.1) < 0.005
        if small.any():
            claims.append(_naive(closed.isel(point=small.values).isel(point=0)))
    return claims + _temperature(ds)


def _between_walls(part: xr.Dataset, name: str) -> list[Claim]:
    error = np.hypot(part["pressure_error"], part["expected_error"])
    sigmas = ((part["pressure"] - part["expected"]) / error).values
    ratio = combine((part["pressure"] / part["expected"]).values, np.asarray(error / part["expected"]))
    return [
        Claim(
            f"pressure of {name} between two walls over theory's, mean of {sigmas.size} slits",
            "test",
            ratio.value,
            ratio.error,
            RELATIVE_ERROR,
            1.0,
            THEORY,
            fails_if=FAILS,
        ),
        Claim.chi_square(
            f"pressure of {name} between two walls against theory's (chi-square per degree of freedom)",
            "test",
            float(np.sum(sigmas**2)),
            sigmas.size,
            THEORY,
            "an error that grows with density, or wrong error bars",
        ),
    ]


def _closed(row: xr.Dataset) -> Claim:
    expected = float(row["expected"])
    eta, name = float(row["packing_fraction"]), NAMES[int(row["dimension"])]
    return Claim(
        f"pressure of {int(row['count'])} {name} in a closed container over theory's, "
        f"packing fraction {eta:.2g}",
        "test",
        float(row["pressure"]) / expected,
        float(row["pressure_error"]) / expected,
        RELATIVE_ERROR,
        1.0,
        THEORY,
        float(row["expected_error"]) / expected,
        FAILS,
    )


def _naive(row: xr.Dataset) -> Claim:
    ratio = float(row["bulk_pressure"] / row["pressure"])
    name, count = NAMES[int(row["dimension"])], int(row["count"])
    return Claim.at_most(
        f"bulk pressure at N/V over what the walls of {count} {name} measure, packing fraction 0.1",
        "test",
        ratio,
        ratio * float(row["pressure_error"] / row["pressure"]),
        0.01,
        {2: 0.95, 3: 0.8}[int(row["dimension"])],
        "the accessible volume is smaller than the container's: -7 % (discs), -34 % (spheres)",
        "walls that need no account of the bodies' size",
    )


def _temperature(ds: xr.Dataset) -> list[Claim]:
    claims = []
    group = np.round(ds["density"].values, 9) + 10.0 * ds["dimension"].values + 100.0 * ds["axes"].values
    for key in sorted(set(group)):
        part = ds.isel(point=group == key)
        temperature = part["temperature"].values
        if temperature.max() < 2.0 * temperature.min():
            continue
        law = fit_power_law(
            temperature, part["pressure"].values * temperature, part["pressure_error"].values * temperature
        )
        claims.append(
            Claim(
                f"exponent of P against T at packing fraction {float(part['packing_fraction'][0]):.3g}",
                "identity",
                law.exponent,
                law.exponent_error,
                2e-3,
                1.0,
                "hard bodies have no energy scale (exact)",
                fails_if="an energy or time scale hides in the program",
            )
        )
    return claims
