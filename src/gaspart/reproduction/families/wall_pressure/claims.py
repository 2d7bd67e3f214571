"""Claims about the pressure on walls."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.analysis.statistics import combine, fit_power_law
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared.claims import PARTICLES, deviations, rows
from gaspart.reproduction.families.shared.rows import estimates

RELATIVE_ERROR = 1e-3
"""The largest standard error of a pressure, relative to it, at which a mean of comparisons means anything."""
THEORY = (
    "bulk equation of state; surfaces, edges and corners of the container to fifth order in the density, by "
    "cluster integrals (gaspart.theory.clusters); canonical ensemble to first order in 1/N"
)
TENSION = "surfaces, edges and corners: a sixth order as large as the larger of the two before"
FAILS = "wall collisions are missed or counted twice, or the wrong area, volume or density is taken"


def wall_pressure(ds: xr.Dataset) -> list[Claim]:
    """The pressure on walls is the bulk's, with the container's surface terms; it is proportional to T;
    without these terms the deviation is far larger than the error."""
    slits, closed = (
        ds.isel(point=((ds["axes"] < ds["dimension"]) == chosen).values) for chosen in (True, False)
    )
    claims = []
    for dimension in sorted(set(slits["dimension"].values)):
        part = slits.isel(point=(slits["dimension"] == dimension).values)
        claims += _between_walls(part, PARTICLES[dimension])
    claims += [_closed(row) for row in rows(closed, "point")]
    for dimension, count in ((2, 100), (3, 125)):
        small = (closed["dimension"] == dimension) & (closed["count"] == count)
        small &= np.abs(closed["packing_fraction"] - 0.1) < 0.005
        if small.any():
            claims.append(_naive(closed.isel(point=small.values).isel(point=0)))
    return claims + _temperature(ds)


def _between_walls(part: xr.Dataset, name: str) -> list[Claim]:
    errors = (part["pressure_error"] / part["expected"]).values
    ratio = combine((part["pressure"] / part["expected"]).values, errors)
    weights = errors**-2 / np.sum(errors**-2)
    measured = Estimate(ratio.value, ratio.error)
    allowance = float(weights @ (part["expected_error"] / part["expected"]).values)
    return [
        Claim(
            claim=f"pressure of {name} between two walls over theory's, mean of {part.sizes['point']} slits",
            measured=measured,
            expected=Estimate(1.0, allowance),
            required=RELATIVE_ERROR,
            source=THEORY,
            allowance_source=TENSION,
            no_verdict=_uncertain(measured, allowance) if name == PARTICLES[2] else "",
            fails_if=FAILS,
        ),
        Claim.joint(
            claim=f"pressure of {name} between two walls against theory's",
            deviations=deviations(part, "pressure", "expected"),
            source=THEORY,
            fails_if="an error that grows with density, or wrong error bars",
        ),
    ]


def _uncertain(measured: Estimate, allowance: float) -> str:
    """Why there is no verdict where theory, whose uncertainty is an estimate, is less certain than the
    measurement; else nothing."""
    if allowance <= measured.error:
        return ""
    return "surfaces and edges are less certain than the measurement, by an estimate of what is left out"


def _closed(row: xr.Dataset) -> Claim:
    expected = Estimate.of(row, "expected")
    measured = Estimate.of(row, "pressure") / expected.value
    return Claim(
        claim=f"pressure of {int(row['count'])} {PARTICLES[int(row['dimension'])]} in a closed container "
        f"over theory's, packing fraction {float(row['packing_fraction']):.2g}",
        measured=measured,
        expected=expected / expected.value,
        required=RELATIVE_ERROR,
        source=THEORY,
        allowance_source=TENSION,
        no_verdict=_uncertain(measured, expected.error / expected.value),
        fails_if=FAILS,
    )


def _naive(row: xr.Dataset) -> Claim:
    dimension, count = int(row["dimension"]), int(row["count"])
    return Claim.at_most(
        claim=f"bulk pressure at N/V over that on the walls of {count} {PARTICLES[dimension]}, "
        "packing fraction 0.1",
        measured=Estimate(row["bulk_pressure"]) / Estimate.of(row, "pressure"),
        bound={2: 0.95, 3: 0.8}[dimension],
        required=0.01,
        source="the accessible volume is smaller than the container's: -7 % (discs), -34 % (spheres)",
        fails_if="the pressure on walls does not depend on the particles' size",
    )


def _temperature(ds: xr.Dataset) -> list[Claim]:
    claims = []
    group = np.round(ds["density"].values, 9) + 10.0 * ds["dimension"].values + 100.0 * ds["axes"].values
    for key in sorted(set(group)):
        part = ds.isel(point=group == key)
        temperature = part["temperature"].values
        if temperature.max() < 2.0 * temperature.min():
            continue
        pressure, error = estimates(part, "pressure") * temperature
        law = fit_power_law(temperature, pressure, error)
        claims.append(
            Claim(
                claim=f"exponent of P against T at packing fraction {float(part['packing_fraction'][0]):.3g}",
                kind="identity",
                measured=Estimate(law.exponent, law.exponent_error),
                expected=1.0,
                required=2e-3,
                source="hard particles have no energy scale (exact)",
                fails_if="the program has a hidden energy or time scale",
            )
        )
    return claims
