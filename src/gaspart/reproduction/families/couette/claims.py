"""Claims about Couette flow between sliding walls."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.statistics import combine_estimates
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.figures.transport import ACCURATE, ENSKOG, FEW_PER_CENT
from gaspart.reproduction.table import Row, Table, each
from gaspart.theory.shear import ELEMENTARY_SLIP, NORMAL_STRESSES, VELOCITY_SLIP

DILUTE_SLIP = 0.03
"""Largest packing fraction of a gas that counts as dilute. The finite volume of its particles changes the
slip by less than this."""
SLIP_FLOW, FREE = 0.08, 20.0
"""Knudsen numbers. Below SLIP_FLOW the middle of a gas is not affected by the walls. Above FREE its particles
fly freely."""
FAST = 2.2
"""Difference of the walls' speeds above which a flow tests effects of second order."""
NEAR = 0.005
"""Largest difference of packing fractions that are compared. The viscosity relative to Enskog theory then
differs by less than 1 %."""
SECOND = 4.0
"""Bound of terms of second order, relative to the square of stress over pressure.

The bound is 2.5 times `NORMAL_STRESSES`.
"""


ALLOWED = "terms of second order in stress over pressure a: 4 a^2 as 3 sigma"
RESPONSE: dict[str, Any] = {
    "expected": 1.0,
    "source": "Green and Kubo: the response is linear, its coefficient an integral of fluctuations",
}


def couette(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on viscosity, slip, free flight, heating and normal stresses.

    Here viscosity is the response to shear.
    """
    gases = Table(ds, "point")
    gases = gases.assign(gas=[_name_gas(gas) for gas in gases])
    flows, sheared, still = (gases[gases.part == name] for name in ("flows", "sheared", "equilibrium"))
    narrow, wide = flows[flows.knudsen > FREE], flows[flows.knudsen < SLIP_FLOW]
    slow, fast = wide[wide.speed < FAST], wide[wide.speed > FAST]
    dilute, dense = slow[slow.packing_fraction < DILUTE_SLIP], slow[slow.packing_fraction > DILUTE_SLIP]
    return [
        *_dilute(dilute),
        *_dense(dense[dense.packing_fraction < ACCURATE + NEAR]),
        *_equilibrium(dense, still),
        *_uniform(sheared, still),
        *_pressure(slow),
        *_free(narrow),
        *(claim for flow in fast for claim in (_heating(flow), *_normal(flow))),
    ]


def _name_gas(gas: Row) -> str:
    """Return the name of a gas: its engine and gap, or its density."""
    if gas.packing_fraction < DILUTE_SLIP:
        return f"dilute spheres, mean free path {gas.knudsen:.2g} of the gap, {gas.engine} engine"
    return f"spheres at packing fraction {gas.packing_fraction:.2f}"


def _second(flows: Table) -> Estimate:
    """Return 1; its 3-sigma uncertainty bounds terms of second order in the stress."""
    return Estimate(1.0, SECOND * flows.reduced_rate.value**2 / 3.0)


def _dilute(dilute: Table) -> list[Claim]:
    """Return the claims on viscosity and slip of dilute gases, for both engines."""
    return [
        *each(
            dilute,
            "stress over gradient, over Enskog's viscosity, {gas}",
            measured=dilute.viscosity,
            expected=_second(dilute),
            required=0.015,
            source=ENSKOG,
            allowance_source=ALLOWED,
            alternative=1.0 / (1.0 + 2.0 * VELOCITY_SLIP * dilute.knudsen),
            fails_if="a wrong stress on the walls, or a gradient that includes the slip",
        ),
        Claim(
            claim="velocity slip of dilute spheres over mean free path and gradient",
            measured=combine_estimates(dilute.slip),
            expected=VELOCITY_SLIP,
            required=0.05,
            source="the linearised Boltzmann equation of spheres [Ohwada 1989], derived again by moments",
            alternative=ELEMENTARY_SLIP,
            fails_if="particles that leave a wall with the distribution of another velocity",
        ),
    ]


def _dense(dense: Table) -> list[Claim]:
    """Return the claims on the viscosity of dense gases, compared with Enskog theory."""
    return each(
        dense,
        "stress over gradient, over Enskog's viscosity, {gas}",
        Claim.within,
        measured=dense.viscosity,
        expected=1.0,
        half_width=FEW_PER_CENT,
        source=f"{ENSKOG}; correlated collisions change it by a few per cent [Alder 1970b]",
        fails_if="momentum that does not pass at contacts as the theory states",
    )


def _over_equilibrium(responses: Table, still: Table) -> dict[str, Estimate]:
    """Compute the viscosity divided by the equilibrium value at the same density.

    The equilibrium value follows from fluctuations. Gases without such a value are left out.
    """
    ratios = {}
    for gas in responses:
        apart = np.abs(still.packing_fraction - gas.packing_fraction)
        if np.any(apart < NEAR):
            ratios[gas.gas] = gas.viscosity / still[int(apart.argmin())].viscosity
    return ratios


def _equilibrium(dense: Table, still: Table) -> list[Claim]:
    """Return the claims on the viscosity of dense gases relative to equilibrium.

    There is a claim for each gas, and a claim for all gases together. In equilibrium the viscosity follows
    from the fluctuations of the stress.
    """
    ratios = _over_equilibrium(dense, still)
    stated = {name: (ratio, 0.03) for name, ratio in ratios.items()}
    stated["spheres at all densities"] = combine_estimates(list(ratios.values())), 0.015
    return [
        Claim(
            claim=f"viscosity from the response over that from equilibrium, {name}",
            measured=ratio,
            required=required,
            **RESPONSE,
            fails_if="a stress tensor, or momentum on the walls, that is not that of the particles",
            follows=name not in ratios,
        )
        for name, (ratio, required) in stated.items()
    ]


def _uniform(sheared: Table, still: Table) -> list[Claim]:
    """Return the claims on the viscosity of gases that are sheared without walls."""
    return [
        Claim(
            claim=f"viscosity from uniform shear over that from equilibrium, {name}",
            measured=ratio,
            required=0.03,
            **RESPONSE,
            fails_if="images that slide at another speed, or a stress that contains the flow",
        )
        for name, ratio in _over_equilibrium(sheared, still).items()
    ]


def _pressure(slow: Table) -> list[Claim]:
    """Return the claims on wall pressure from density and temperature in the middle."""
    normal = NORMAL_STRESSES[0] * slow.reduced_rate.value**2
    return each(
        slow,
        "pressure on the walls over that of the middle's state, {gas}",
        measured=slow.pressure,
        expected=_second(slow) + np.where(slow.packing_fraction < DILUTE_SLIP, normal, 0.0),
        required=0.005,
        source="no force acts across the gap: the equation of state of the middle, and of dilute gases the "
        "normal stress",
        allowance_source=ALLOWED,
        fails_if="a wrong momentum on the walls, or a gas that is not in local equilibrium",
    )


def _free(narrow: Table) -> list[Claim]:
    """Return the claims on the stress of free flight.

    The first correction is approximately minus the gap divided by the mean free path.
    """
    return each(
        narrow,
        "shear stress over that of free flight, {gas}",
        Claim.within,
        measured=narrow.stress,
        expected=1.0 - 0.5 / narrow.knudsen,
        half_width=1.0 / narrow.knudsen,
        source="two streams, each with the velocity of the wall that it comes from (exact), less than twice "
        "the gap over the mean free path for collisions",
        fails_if="walls that do not give the whole of their velocity",
    )


def _heating(flow: Row) -> Claim:
    """Return the claim on the parabolic temperature profile."""
    return Claim(
        claim=f"-dT/du^2 over half of viscosity over conductivity, walls of speed {flow.speed:g}",
        measured=flow.heating / float(theory.viscous_heating(flow.packing_fraction, 3)),
        expected=1.0,
        required=0.05,
        source=f"heat made by the stress flows to the walls; {ENSKOG}",
        alternative=1.5,
        fails_if="work of the walls that is not conserved as heat",
    )


def _normal(flow: Row) -> list[Claim]:
    """Return the claims on normal stresses, which are of second order in the shear rate.

    The stresses are measured on the walls, and along two axes in the middle.
    """
    square = flow.reduced_rate.value**2
    across, along, _ = NORMAL_STRESSES
    source = "moments of the Boltzmann equation (gaspart.theory.shear), exact for Maxwell molecules to "
    source += "second order [Santos 2009]"
    return [
        Claim.within(
            claim="stress on the walls less pressure, over pressure and squared rate of shear",
            measured=(flow.pressure - 1.0) / square,
            expected=across,
            half_width=0.1 * abs(across),
            source=f"{source}; a tenth for spheres and higher orders",
            fails_if="a gas that is Newtonian, in which this is 0",
        ),
        Claim.at_least(
            claim="stress along flow less that along gradient, over pressure and squared rate of shear",
            measured=(flow.normal_y - flow.normal_x) / square,
            bound=0.5 * (along - across),
            required=0.25,
            source=f"{source}; half of it, since the sign and the size are claimed",
            fails_if="a gas that is Newtonian, in which this is 0",
        ),
    ]
