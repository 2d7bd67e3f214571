"""What the figures of gases under gravity claim."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.claims import Claim
from gaspart.theory.gravity import ideal_heat_capacity

HYDROSTATICS = "hydrostatics dP/dz = -m g rho"
REFERENCE = "virial series to B10 with a linear tail (Clisby and McCoy 2006)"
DILUTE = 0.01
"""Packing fraction up to which a column counts as an ideal gas."""


def barometric(ds: xr.Dataset) -> list[Claim]:
    """The barometric formula, the equation of state from the weight of the column, and one temperature."""
    claims = []
    for n in range(ds.sizes["point"]):
        row = ds.isel(point=n)
        at = _at(row)
        claims += [
            _slope(row, 0, "discs", at, 0.005 if _dilute(row) else 0.01),
            Claim(
                f"temperature against height, d ln T / dz over -1/(scale height), {at}",
                "test",
                -row["temperature_gradient"],
                row["temperature_gradient_error"],
                0.005,
                0.0,
                "an isothermal column (Maxwell 1867); at fixed energy 1/(N C_V) more",
                expected_uncertainty=1.0 / float(row["count"]),
                fails_if="a column that is warmer at one end: not in equilibrium, or an engine that heats",
            ),
            _balance(row, at),
        ]
        claims += [_mean_height(row, 0, "discs", at)] if _dilute(row) else _pressures(row, at)
    return claims


def separation(ds: xr.Dataset) -> list[Claim]:
    """Each kind has its own scale height in a dilute gas; their ratio is exponential at any density."""
    claims = []
    for n in range(ds.sizes["point"]):
        row = ds.isel(point=n)
        at = _at(row)
        claims += [
            Claim(
                f"slope of ln(heavy/light) over -(M - m) g / kT, {at}",
                "test",
                row["exchange_ratio"],
                row["exchange_ratio_error"],
                0.01 if _dilute(row) else 0.02,
                1.0,
                "exchange of two discs of one size costs (M - m) g dz (exact at any density)",
                fails_if="kinds that do not separate as their weights say, or have not had the time to",
            ),
            Claim(
                f"temperature of the heavy over that of the light discs, {at}",
                "test",
                row["species_temperature_ratio"][-1],
                row["species_temperature_ratio_error"][-1],
                0.01,
                1.0,
                "equipartition",
                fails_if="kinds that do not share their energy",
            ),
            _balance(row, at),
        ]
        if _dilute(row):
            claims += [_slope(row, kind, name, at, 0.005) for kind, name in enumerate(("light", "heavy"))]
            claims += [_mean_height(row, kind, name, at) for kind, name in enumerate(("light", "heavy"))]
        else:
            claims += _pressures(row, at)
    return claims


def _dilute(row: xr.Dataset) -> bool:
    return float(row["packing_fraction"].max()) < DILUTE


def _at(row: xr.Dataset) -> str:
    kind = "dilute" if _dilute(row) else "dense"
    return f"{kind} column (packing fraction to {float(row['packing_fraction'][row['used']].max()):.2g})"


def _slope(row: xr.Dataset, kind: int, name: str, at: str, required: float) -> Claim:
    return Claim(
        f"slope of the chemical potential of the {name} over -m g / kT, {at}",
        "test",
        row["slope_ratio"][kind],
        row["slope_ratio_error"][kind],
        required,
        1.0,
        "ln rho + mu_excess(rho) + m g z / kT is uniform in equilibrium; in a dilute gas ln rho alone",
        fails_if="a density that does not fall off exponentially with its own scale height",
    )


def _mean_height(row: xr.Dataset, kind: int, name: str, at: str) -> Claim:
    return Claim(
        f"mean height of the {name} over the ideal gas's, {at}",
        "test",
        row["mean_height_ratio"][kind],
        row["mean_height_ratio_error"][kind],
        0.01,
        1.0,
        "<z> = kT/mg - H/(exp(mgH/kT) - 1); excluded area lifts it by about the floor's packing fraction",
        expected_uncertainty=float(row["packing_fraction"].max()),
        fails_if="a gas that does not fill its box as Boltzmann's factor says",
    )


def _pressures(row: xr.Dataset, at: str) -> list[Claim]:
    return [
        Claim(
            f"pressure that carries the weight above over rho kT Z(eta), eta from {low:g} to {high:g}, {at}",
            "test",
            value,
            error,
            0.01,
            1.0,
            f"{HYDROSTATICS}, Z of the {REFERENCE}",
            fails_if="a density profile that is not the equation of state's",
        )
        for low, high, value, error in zip(
            row["range_low"].values,
            row["range_high"].values,
            row["range_ratio"].values,
            row["range_ratio_error"].values,
            strict=True,
        )
        if np.isfinite(value)
    ]


def _balance(row: xr.Dataset, at: str) -> Claim:
    return Claim.at_most(
        f"(floor - ceiling - weight - gain of momentum) over the weight, {at}",
        "identity",
        row["imbalance"],
        1e-9,
        1e-8,
        1e-8,
        "balance of momentum (exact)",
        "impulses on floor and ceiling that are not those of the bodies",
    )


def heat_capacity(ds: xr.Dataset) -> list[Claim]:
    """Heat capacity from neighbouring energies and from fluctuations."""
    claims = []
    for n in range(ds.sizes["pair"]):
        row = ds.isel(pair=n)
        x = abs(float(row["x"]))
        kind = "test" if x else "identity"
        ideal = f"d/2 + 1 - x^2 e^x/(e^x - 1)^2 = {float(ideal_heat_capacity(x, 2)):.4f}"
        finite = f"{ideal}, here for {ds.attrs['count']} bodies at the runs' energies"
        claims.append(
            Claim(
                f"heat capacity C_V/Nk as dE/dT, x = mgH/kT = {x:.2f}",
                kind,
                row["slope"],
                max(float(row["slope_error"]), 1e-9),
                0.02,
                row["slope_expected"],
                finite,
                fails_if="an energy that does not go into height and motion as Boltzmann's factor says",
            )
        )
        for run in range(ds.sizes["run"]):
            one = row.isel(run=run)
            claims.append(
                Claim(
                    f"heat capacity C_V/Nk from fluctuations, x = {abs(float(one['run_x'])):.2f}, "
                    f"run {run + 1}",
                    kind,
                    one["fluctuation"],
                    max(float(one["fluctuation_error"]), 1e-9),
                    0.03,
                    one["fluctuation_expected"],
                    f"Lebowitz, Percus and Verlet (1967); {finite}",
                    fails_if="fluctuations that are not the microcanonical ones: not ergodic, or energy lost",
                )
            )
    return claims
