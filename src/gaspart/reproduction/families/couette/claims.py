"""Claims about gases between sliding walls."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared.claims import rows, weighted_mean
from gaspart.reproduction.families.transport.claims import ACCURATE, ENSKOG, FEW_PER_CENT
from gaspart.theory.shear import ELEMENTARY_SLIP, NORMAL_STRESSES, VELOCITY_SLIP

DILUTE_SLIP = 0.03
"""Packing fraction up to which a gas counts as dilute: its volume changes slip by less than this."""
SLIP_FLOW, FREE = 0.08, 20.0
"""Knudsen numbers up to which a gas has a middle that walls do not see, and from which on it flies freely."""
FAST = 2.2
"""Difference of the walls' speeds from which on a flow tests what is of second order in it."""
NEAR = 0.005
"""Packing fractions that differ by less are compared: the ratio to Enskog's changes by less than 1 %."""
SECOND = 4.0
"""Of the square of stress over pressure: a bound of terms of second order, 2.5 times `NORMAL_STRESSES`."""


def couette(ds: xr.Dataset) -> list[Claim]:
    """Viscosity from the response, slip, free flight, heating and normal stresses."""
    flows = rows(ds.isel(point=np.flatnonzero(ds["part"].values == "flows")), "point")
    sheared = rows(ds.isel(point=np.flatnonzero(ds["part"].values == "sheared")), "point")
    still = rows(ds.isel(point=np.flatnonzero(ds["part"].values == "equilibrium")), "point")
    narrow = [row for row in flows if float(row["knudsen"]) > FREE]
    wide = [row for row in flows if float(row["knudsen"]) < SLIP_FLOW]
    slow = [row for row in wide if float(row["speed"]) < FAST]
    fast = [row for row in wide if float(row["speed"]) > FAST]
    dilute = [row for row in slow if float(row["packing_fraction"]) < DILUTE_SLIP]
    dense = [row for row in slow if float(row["packing_fraction"]) > DILUTE_SLIP]
    claims = [*(_dilute(row) for row in dilute), _slip(dilute)]
    claims += [_dense(row) for row in dense if float(row["packing_fraction"]) < ACCURATE + NEAR]
    claims += _equilibrium(dense, still) + _uniform(sheared, still)
    claims += [_pressure(row) for row in slow] + [_free(row) for row in narrow]
    return claims + [claim for row in fast for claim in (_heating(row), *_normal(row))]


def _named(row: xr.Dataset) -> str:
    """Engine and gap or density of a flow."""
    engine = row["engine"].item()
    eta = float(row["packing_fraction"])
    if eta < DILUTE_SLIP:
        return f"dilute spheres, mean free path {float(row['knudsen']):.2g} of the gap, {engine} engine"
    return f"spheres at packing fraction {eta:.2f}"


def _second(row: xr.Dataset) -> Estimate:
    """1, with what terms of the second order in the stress may add, as 3 sigma."""
    return Estimate(1.0, SECOND * float(row["reduced_rate"]) ** 2 / 3.0)


ALLOWED = "terms of second order in stress over pressure a: 4 a^2 as 3 sigma"


def _dilute(row: xr.Dataset) -> Claim:
    """The viscosity of a dilute gas."""
    return Claim(
        claim=f"stress over gradient, over Enskog's viscosity, {_named(row)}",
        measured=Estimate.of(row, "viscosity"),
        expected=_second(row),
        required=0.015,
        source=ENSKOG,
        allowance_source=ALLOWED,
        alternative=1.0 / (1.0 + 2.0 * VELOCITY_SLIP * float(row["knudsen"])),
        fails_if="a wrong stress on the walls, or a gradient that includes the slip",
    )


def _slip(dilute: list[xr.Dataset]) -> Claim:
    """The slip at the walls, from both engines."""
    return Claim(
        claim="velocity slip of dilute spheres over mean free path and gradient",
        measured=weighted_mean([Estimate.of(row, "slip") for row in dilute]),
        expected=VELOCITY_SLIP,
        required=0.05,
        source="the linearised Boltzmann equation of spheres [Ohwada 1989], derived again by moments",
        alternative=ELEMENTARY_SLIP,
        fails_if="particles that leave a wall with the distribution of another velocity",
    )


def _dense(row: xr.Dataset) -> Claim:
    """The viscosity of a dense gas, against Enskog."""
    return Claim.within(
        claim=f"stress over gradient, over Enskog's viscosity, {_named(row)}",
        measured=Estimate.of(row, "viscosity"),
        expected=1.0,
        half_width=FEW_PER_CENT,
        source=f"{ENSKOG}; correlated collisions change it by a few per cent [Alder 1970b]",
        fails_if="momentum that does not pass at contacts as the theory states",
    )


def _ratios(responses: list[xr.Dataset], still: list[xr.Dataset]) -> dict[str, Estimate]:
    """The viscosity of gases over that from the fluctuations at the same density, if it is known."""
    ratios = {}
    for row in responses:
        eta = float(row["packing_fraction"])
        beside = [one for one in still if abs(float(one["packing_fraction"]) - eta) < NEAR]
        if beside:
            nearest = min(beside, key=lambda one: abs(float(one["packing_fraction"]) - eta))
            ratios[_named(row)] = Estimate.of(row, "viscosity") / Estimate.of(nearest, "viscosity")
    return ratios


def _uniform(sheared: list[xr.Dataset], still: list[xr.Dataset]) -> list[Claim]:
    """The same of gases that are sheared without walls."""
    return [
        Claim(
            claim=f"viscosity from uniform shear over that from equilibrium, {name}",
            measured=ratio,
            expected=1.0,
            required=0.03,
            source="Green and Kubo: the response is linear, its coefficient an integral of fluctuations",
            fails_if="images that slide at another speed, or a stress that contains the flow",
        )
        for name, ratio in _ratios(sheared, still).items()
    ]


def _equilibrium(dense: list[xr.Dataset], still: list[xr.Dataset]) -> list[Claim]:
    """The viscosity of dense gases, against that from the fluctuations of the stress: of each, and of all
    together."""
    ratios = _ratios(dense, still)
    stated = {name: (ratio, 0.03) for name, ratio in ratios.items()}
    stated["spheres at all densities"] = weighted_mean(list(ratios.values())), 0.015
    return [
        Claim(
            claim=f"viscosity from the response over that from equilibrium, {name}",
            measured=ratio,
            expected=1.0,
            required=required,
            source="Green and Kubo: the response is linear, its coefficient an integral of fluctuations",
            fails_if="a stress tensor, or momentum on the walls, that is not that of the particles",
            follows=name not in ratios,
        )
        for name, (ratio, required) in stated.items()
    ]


def _pressure(row: xr.Dataset) -> Claim:
    """The pressure on the walls against density and temperature in the middle."""
    first = NORMAL_STRESSES[0] * float(row["reduced_rate"]) ** 2
    return Claim(
        claim=f"pressure on the walls over that of the middle's state, {_named(row)}",
        measured=Estimate.of(row, "pressure"),
        expected=_second(row) + (first if float(row["packing_fraction"]) < DILUTE_SLIP else 0.0),
        required=0.005,
        source="no force acts across the gap: the equation of state of the middle, and of dilute gases the "
        "normal stress",
        allowance_source=ALLOWED,
        fails_if="a wrong momentum on the walls, or a gas that is not in local equilibrium",
    )


def _free(row: xr.Dataset) -> Claim:
    """The stress of free flight: the first correction is about minus the gap over the mean free path."""
    return Claim.within(
        claim=f"shear stress over that of free flight, {_named(row)}",
        measured=Estimate.of(row, "stress"),
        expected=1.0 - 0.5 / float(row["knudsen"]),
        half_width=1.0 / float(row["knudsen"]),
        source="two streams, each with the velocity of the wall that it comes from (exact), less than twice "
        "the gap over the mean free path for collisions",
        fails_if="walls that do not give the whole of their velocity",
    )


def _heating(row: xr.Dataset) -> Claim:
    """The parabola of the temperature."""
    expected = float(theory.viscous_heating(float(row["packing_fraction"]), 3))
    return Claim(
        claim=f"-dT/du^2 over half of viscosity over conductivity, walls of speed {float(row['speed']):g}",
        measured=Estimate.of(row, "heating") / expected,
        expected=1.0,
        required=0.05,
        source=f"heat made by the stress flows to the walls; {ENSKOG}",
        alternative=1.5,
        fails_if="work of the walls that is not conserved as heat",
    )


def _normal(row: xr.Dataset) -> list[Claim]:
    """Normal stresses, of second order in the rate: on the walls, and in the middle along two axes."""
    square = float(row["reduced_rate"]) ** 2
    across, along, _ = NORMAL_STRESSES
    source = (
        "moments of the Boltzmann equation (gaspart.theory.shear), exact for Maxwell molecules to second "
    )
    source += "order [Santos 2009]"
    return [
        Claim.within(
            claim="stress on the walls less pressure, over pressure and squared rate of shear",
            measured=(Estimate.of(row, "pressure") - Estimate(1.0)) / square,
            expected=across,
            half_width=0.1 * abs(across),
            source=f"{source}; a tenth for spheres and higher orders",
            fails_if="a gas that is Newtonian, in which this is 0",
        ),
        Claim.at_least(
            claim="stress along flow less that along gradient, over pressure and squared rate of shear",
            measured=(Estimate.of(row, "normal_y") - Estimate.of(row, "normal_x")) / square,
            bound=0.5 * (along - across),
            required=0.25,
            source=f"{source}; half of it, since the sign and the size are claimed",
            fails_if="a gas that is Newtonian, in which this is 0",
        ),
    ]
