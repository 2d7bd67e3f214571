"""Claims about heat conduction between walls."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.table import Row, Table
from gaspart.theory.heat import ELEMENTARY_JUMP, METAL_BEND, METAL_BEND_ERROR, METAL_GAP, TEMPERATURE_JUMP

FREE = 100.0
"""Knudsen number above which collisions between particles are negligible."""
CHANNELS = 0.1
"""Upper bound of the relative increase of the flux by channels of a grid, compared with randomly placed
scatterers. Electrons that fly from wall to wall add w/a (sqrt(1 + (L/w)^2) - L/w) = 0.008 of the flux of free
flight. This is 0.06 of the flux (gap L = 40, channels of width w = 1.18 with period a = 2.22). The rest of
the bound is for flights that end in the gap."""


def heat_conduction_gas(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on steady flux, limits, profile, and the source's rule."""
    claims = []
    for row in Table(ds, "point"):
        at = _at(row)
        claims += _steady(row, at)
        if row.knudsen > FREE:
            claims.append(_free(row, at))
        if np.isfinite(row.slab_flux):
            claims += _fluid(row, at)
    return claims


def _at(row: Row) -> str:
    rule = "normal component only" if row.normal else "full accommodation"
    return f"{row.dimension}D, {rule}, Knudsen number {row.knudsen:.2g}"


def _steady(row: Row, at: str) -> list[Claim]:
    """Return the claims that the heat from the hot wall enters the cold wall.

    There is a claim early in the run, and one late.
    """
    conserved = Claim.at_most(
        claim=f"|heat from the walls - energy of the particles| over the transferred heat, {at}",
        kind="identity",
        measured=Estimate(row.imbalance, 1e-7),
        bound=1e-6,
        required=1e-6,
        source="conservation of energy (exact)",
        fails_if="heat of walls that is not what particles gain and lose there",
    )
    return [conserved] + [
        Claim(
            claim=f"{text}, {at}",
            kind=kind,
            measured=row[name],
            expected=1.0,
            required=required,
            source="a steady state",
            fails_if=fails_if,
        )
        for kind, text, name, required, fails_if in (
            (
                # both fluxes are counted at wall hits: they differ by the energy that the gas stores
                "identity",
                "flux into the cold over flux out of the hot wall",
                "wall_ratio",
                0.02,
                "a gas that still warms up or cools down",
            ),
            (
                "test",
                "flux in the second over that in the first half of the run",
                "half_ratio",
                0.06,
                "a profile that is not yet stationary",
            ),
        )
    ]


def _free(row: Row, at: str) -> Claim:
    share = f"{2 if row.normal else row.dimension + 1}/{row.dimension + 1}"
    return Claim(
        claim=f"flux over n (d + 1) sqrt(T1 T2 / 2 pi m) (sqrt T1 - sqrt T2), {at}",
        measured=row.flux / row.full,
        expected=row.free / row.full,
        required=0.01,
        source=f"particles that collide with walls only: {share} (exact)",
        fails_if="outgoing velocities that are not weighted by the flux, or a component that is not drawn",
    )


def _fluid(row: Row, at: str) -> list[Claim]:
    theory = "Fourier's law with Enskog's conductivity and temperature jumps ([Sone 1989])"
    square = row.knudsen**2
    neglected = "the square of the Knudsen number, which an asymptotic theory of first order in it neglects"
    return [
        Claim(
            claim=f"flux over that of theory, {at}",
            measured=row.flux / row.slab_flux,
            expected=Estimate(1.0, square),
            required=0.02,
            source=theory,
            allowance_source=neglected,
            fails_if="a conductivity that is not that of hard spheres, or walls that do not accommodate",
        ),
        Claim(
            claim=f"temperature away from the walls over that of theory, {at}",
            measured=row.profile_ratio,
            expected=Estimate(1.0, square),
            required=0.01,
            source=theory,
            allowance_source=neglected,
            fails_if="a profile that is not that of a conductivity growing as sqrt T",
        ),
        Claim(
            claim=f"temperature jump over mean free path times slope, {at}",
            measured=row.jump,
            expected=Estimate(TEMPERATURE_JUMP, TEMPERATURE_JUMP * square),
            required=0.3,
            source="[Sone 1989], linear in the slope",
            allowance_source=neglected,
            alternative=ELEMENTARY_JUMP,
            fails_if="a gas that has the temperature of the wall, or one that the wall does not warm",
        ),
    ]


def heat_conduction_metal(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on equipartition, Dulong and Petit's law, and effects of a grid.

    Equipartition is between electrons and vibrational modes.
    """
    points = Table(ds, "point")
    law = f"N_e d/2 + N_s = {points.expected[0]:g} (classical statistical mechanics, exact)"
    claims, conducting = [], {}
    for row in points:
        if row.hot == row.cold:
            claims += _isothermal(row, law)
        else:
            claims += [_local(row)] if row.regular else [_local(row), *_linear(row)]
            conducting[bool(row.regular)] = row
    if len(conducting) == 2:
        claims.append(_channels(conducting[True], conducting[False]))
    return [
        *claims,
        Claim(
            claim="heat capacity dE/dT from runs at several temperatures",
            measured=points.slope,
            expected=1.0,
            required=0.02,
            source=law,
            fails_if="modes that freeze out, or take more than kT",
        ),
    ]


def _channels(regular: Row, random: Row) -> Claim:
    return Claim.within(
        claim="flux among scatterers on the source's grid over that at random places",
        measured=regular.flux / random.flux,
        expected=1.0 + 0.5 * CHANNELS,
        half_width=0.5 * CHANNELS,
        source="channels between the rows of a grid lengthen flights, few of which reach from wall to wall",
        fails_if="electrons that fly along the channels for ever, or that a grid holds up",
    )


def _local(row: Row) -> Claim:
    arrangement = "on a grid" if row.regular else "at random places"
    return Claim.within(
        claim=f"energy of a mode over the temperature of the electrons around it, scatterers {arrangement}",
        measured=row.share,
        expected=1.0,
        half_width=0.05,
        source="local equilibrium, to the square of the slope over a mean free path",
        fails_if="modes that do not take the temperature of the electrons",
    )


def _linear(row: Row) -> list[Claim]:
    """Return the claims on the curvature of the temperature profile.

    In a gas T^(3/2) would be linear. There is no claim on a grid: electrons fly far in channels, so that
    their temperature is not local. There is no claim on walls and gaps for which theory has not been
    computed.
    """
    if row.hot != 2.0 * row.cold or abs(row.gap_over_path / METAL_GAP - 1.0) > 0.1:
        return []
    slope, level = np.polyfit(row.position[1:-1], row.electrons.value[1:-1], 1)
    return [
        Claim(
            claim="second-order coefficient of the electrons' temperature against position over the gap",
            measured=row.bend,
            expected=Estimate(row.cold * METAL_BEND, row.cold * METAL_BEND_ERROR),
            required=0.1 * row.cold,
            source="the Boltzmann equation of electrons and modes (gaspart.theory.electrons)",
            allowance_source="the statistical error of its direct simulation",
            alternative=-0.25 * slope**2 / (level + 0.5 * slope),
            fails_if="electrons that conduct as a gas does, whose T^(3/2) is linear",
        )
    ]


def _isothermal(row: Row, law: str) -> list[Claim]:
    return [
        Claim(
            claim=f"{text}, T = {row.hot:g}",
            measured=row[name],
            expected=1.0,
            required=required,
            source=source,
            fails_if="energy that electrons, modes and walls do not share as kT per mode",
        )
        for name, text, required, source in (
            ("mode_ratio", "mean energy of a mode over kT of the walls", 0.01, "equipartition, <E> = kT"),
            ("energy_ratio", "E / T over the heat capacity", 0.01, law),
        )
    ] + [
        Claim(
            claim=f"ln of var E / T^2 over the heat capacity, T = {row.hot:g}",
            measured=row.log_fluctuation,
            expected=0.0,
            required=0.1,
            source=law,
            alternative=math.log(row.electrons_part),
            fails_if="modes whose energies do not fluctuate",
        )
    ]
