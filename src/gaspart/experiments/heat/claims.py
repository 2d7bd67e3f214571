"""What the figures of heat between walls claim."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.claims import Claim
from gaspart.theory.heat import TEMPERATURE_JUMP

FREE = 100.0
"""Knudsen number above which bodies count as meeting nothing but the walls."""


def heat_conduction_gas(ds: xr.Dataset) -> list[Claim]:
    """A steady flux, its two limits, the profile between them, and the source's rule."""
    claims = []
    for n in range(ds.sizes["point"]):
        row = ds.isel(point=n)
        at = _at(row)
        claims += _steady(row, at)
        if row["knudsen"] > FREE:
            claims.append(_free(row, at))
        if np.isfinite(row["slab_flux"]):
            claims += _fluid(row, at)
    return claims


def _at(row: xr.Dataset) -> str:
    rule = "normal component only" if row["normal"] else "full accommodation"
    return f"{int(row['dimension'])}D, {rule}, Knudsen number {float(row['knudsen']):.2g}"


def _steady(row: xr.Dataset, at: str) -> list[Claim]:
    """What comes out of the hot wall goes into the cold one, early and late."""
    return [
        Claim.at_most(
            f"|heat from the walls - energy of the bodies| over the heat that went through, {at}",
            "identity",
            row["imbalance"],
            1e-7,
            1e-6,
            1e-6,
            "conservation of energy (exact)",
            "heat of walls that is not what bodies gain and lose there",
        ),
        Claim(
            f"flux into the cold over flux out of the hot wall, {at}",
            "test",
            row["wall_ratio"],
            row["wall_ratio_error"],
            0.02,
            1.0,
            "a steady state",
            fails_if="a gas that still warms up or cools down",
        ),
        Claim(
            f"flux in the second over that in the first half of the run, {at}",
            "test",
            row["half_ratio"],
            row["half_ratio_error"],
            0.06,
            1.0,
            "a steady state",
            fails_if="a profile that is still on its way",
        ),
    ]


def _free(row: xr.Dataset, at: str) -> Claim:
    share = f"{2 if row['normal'] else int(row['dimension']) + 1}/{int(row['dimension']) + 1}"
    return Claim(
        f"flux over n (d + 1) sqrt(T1 T2 / 2 pi m) (sqrt T1 - sqrt T2), {at}",
        "test",
        row["flux"] / row["full"],
        row["flux_error"] / row["full"],
        0.01,
        row["free"] / row["full"],
        f"bodies that meet nothing but walls: {share} (exact)",
        fails_if="outgoing velocities that are not weighted by the flux, or a component that is not drawn",
    )


def _fluid(row: xr.Dataset, at: str) -> list[Claim]:
    theory = "Fourier's law with Enskog's conductivity and temperature jumps (Sone, Ohwada and Aoki 1989)"
    square = float(row["knudsen"]) ** 2
    return [
        Claim(
            f"flux over that of theory, {at}",
            "test",
            row["flux"] / row["slab_flux"],
            row["flux_error"] / row["slab_flux"],
            0.02,
            1.0,
            theory,
            expected_uncertainty=0.005 + square,
            fails_if="a conductivity that is not that of hard spheres, or walls that do not accommodate",
        ),
        Claim(
            f"temperature away from the walls over that of theory, {at}",
            "test",
            row["profile_ratio"],
            row["profile_ratio_error"],
            0.01,
            1.0,
            theory,
            expected_uncertainty=0.002 + square,
            fails_if="a profile that is not that of a conductivity growing as sqrt T",
        ),
        Claim(
            f"temperature jump over mean free path times slope, {at}",
            "test",
            row["jump"],
            row["jump_error"],
            0.3,
            TEMPERATURE_JUMP,
            "Sone, Ohwada and Aoki, Phys. Fluids A 1, 363 (1989), linear in the slope",
            expected_uncertainty=TEMPERATURE_JUMP * (0.03 + square),
            fails_if="a gas that has the temperature of the wall, or one that the wall does not warm",
        ),
    ]


def heat_conduction_metal(ds: xr.Dataset) -> list[Claim]:
    """Equipartition among electrons and modes, and the law of Dulong and Petit."""
    claims = []
    law = f"N_e d/2 + N_s = {float(ds['expected'][0]):g} (classical statistical mechanics, exact)"
    for n in range(ds.sizes["point"]):
        row = ds.isel(point=n)
        if row["hot"] != row["cold"]:
            claims.append(
                Claim.within(
                    "energy of a mode over the temperature of the electrons around it, between two walls",
                    "test",
                    row["share"],
                    row["share_error"],
                    1.0,
                    0.05,
                    "local equilibrium, to the square of the slope over a mean free path",
                    "modes that do not take the temperature of the electrons",
                )
            )
            continue
        at = f"T = {float(row['hot']):g}"
        for name, text, required in (
            ("mode_ratio", "mean energy of a mode over kT of the walls", 0.01),
            ("energy_ratio", "E / T over the heat capacity", 0.01),
            ("fluctuation", "var E / T^2 over the heat capacity", 0.1),
        ):
            source = "equipartition, <E> = kT" if name == "mode_ratio" else law
            claims.append(
                Claim(
                    f"{text}, {at}",
                    "test",
                    row[name],
                    row[f"{name}_error"],
                    required,
                    1.0,
                    source,
                    fails_if="energy that electrons, modes and walls do not share as kT a mode",
                )
            )
    claims.append(
        Claim(
            "heat capacity dE/dT from runs at several temperatures",
            "test",
            ds["slope"],
            ds["slope_error"],
            0.02,
            1.0,
            law,
            fails_if="modes that freeze out, or take more than kT",
        )
    )
    return claims
