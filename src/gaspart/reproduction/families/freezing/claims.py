"""Claims about freezing.

A run that is not in equilibrium is no evidence. Its drift is part of its uncertainty, so that its claims are
inconclusive, not confirmed.
"""

from __future__ import annotations

import math

import numpy as np
import xarray as xr
from scipy.special import bdtrc, ndtri

from gaspart import theory
from gaspart.analysis.statistics import average
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.table import Row, Table, each

TOLERANCE = 0.02
"""Relative half-width of the interval around a coexistence pressure."""
EQUILIBRIUM_LIMIT = 3.0
"""Largest deviation between starts or halves, in standard errors, of a run in equilibrium."""
COMPARED = 6
"""Number of deviations at a packing fraction, of which the largest is used. They compare pressure and order,
between the starts and between the halves of each run."""
REQUIRED = {True: 2e-4, False: 4e-4}
"""Required relative uncertainty of the pressure of 870 discs, below NEAR and above it. It is reached in four
minutes of CPU time. Published values have 4e-6 to 2e-5. The correlation time of the order at 0.70 is six
times that at 0.68."""
NEAR = 0.69
DISCS_SOURCE = "[Bernard 2011], [Engel 2013]"
SPHERES_SOURCE = "[Fernandez 2012]"


def freezing_discs(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims on plateau pressures, melting and freezing, branches, equilibrium.

    The claims concern the plateaus of both starts, and their difference.
    """
    starts, states = Table(dataset, "start"), Table(dataset, "packing_fraction")
    expected = theory.COEXISTENCE_PRESSURE[2]
    return [
        *_plateau(starts, expected),
        *([_same_plateau(starts.plateau, expected)] if len(starts) == 2 else []),
        _orientation(states[0], melted=True),
        _orientation(states[-1], melted=False),
        *_liquid_of_discs(Table(dataset, "compared_packing_fraction")),
        *_crystal_of_discs(states),
        _equilibrium(states),
    ]


def freezing_spheres(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims on melting and stability of a crystal, branches of Z, coexistence."""
    starts = {side.start: _runs(side) for side in Table(dataset, "start")}
    crystal = starts["crystal"]
    eta = crystal.packing_fraction
    melts, stable = crystal[eta <= 0.4501], crystal[eta >= 0.5599]
    return [
        *([_lattice(melts, melted=True)] if melts else []),
        *([_lattice(stable, melted=False)] if stable else []),
        *(_branch(state) for side in starts.values() for state in side),
        *_slab(Row(dataset)),
    ]


def _runs(side: Row) -> Table:
    """Return the packing fractions of the runs with this start."""
    states = Table(side.dataset, "packing_fraction")
    return states[np.isfinite(states.order.value)]


def _plateau(starts: Table, expected: float) -> list[Claim]:
    return each(
        starts,
        "plateau pressure of discs in k_B T / sigma^2, from the {start}",
        Claim.within,
        measured=starts.plateau,
        expected=expected,
        half_width=TOLERANCE * expected,
        source=DISCS_SOURCE,
        no_verdict="the literature's is that of 10^6 discs, and how much fewer discs shift it is not known",
        fails_if="runs not in equilibrium, a loop too coarse, or far too few discs (the pressure falls with "
        "1/N)",
    )


def _same_plateau(plateau: Estimate, expected: float) -> Claim:
    return Claim(
        claim="plateau pressure from the crystal minus that from the fluid, k_B T / sigma^2",
        measured=plateau[0] - plateau[1],
        expected=0.0,
        required=TOLERANCE * expected / 2.0,
        source="one equation of state, whatever the start",
        fails_if="one of the runs still depends on its start",
    )


def _extreme(order: Estimate, melted: bool) -> Estimate:
    """Return the order that is furthest from equilibrium.

    This is the largest order if all should be melted, else the smallest order.
    """
    return order[int((np.argmax if melted else np.argmin)(order.value))]


def _orientation(state: Row, melted: bool) -> Claim:
    make, bound = (Claim.at_most, 0.3) if melted else (Claim.at_least, 0.6)
    return make(
        claim=f"global |psi_6| at packing fraction {state.packing_fraction:.4g}, "
        f"of the start that is {'most' if melted else 'least'} ordered",
        measured=_extreme(state.order, melted),
        bound=bound,
        required=0.1,
        source="liquid below 0.700, one orientation throughout above 0.720 ([Bernard 2011])",
        fails_if="the crystal has not melted"
        if melted
        else "the fluid has not frozen, or into several grains",
    )


def _lattice(crystal: Table, melted: bool) -> Claim:
    eta = crystal.packing_fraction
    make, bound = (Claim.at_most, 0.1) if melted else (Claim.at_least, 0.4)
    where = f"up to {eta.max():.4g}" if melted else f"from {eta.min():.4g}"
    return make(
        claim=f"{'largest' if melted else 'smallest'} global Q_6 from a face-centred cubic start, "
        f"packing fractions {where}",
        measured=_extreme(crystal.order, melted),
        bound=bound,
        required=0.02,
        source="spheres melt below 0.49 and are stable above 0.55 ([Hoover 1968])",
        fails_if="a crystal that cannot melt, or one that disintegrates: contacts are wrong",
    )


def _with_drift(measured: Estimate, drift: Estimate) -> Estimate:
    """Add half the drift between the halves of a run to its uncertainty, if significant."""
    significant = abs(drift.value) > EQUILIBRIUM_LIMIT * drift.error
    return Estimate(measured.value, math.hypot(measured.error, 0.5 * drift.value if significant else 0.0))


def _liquid_of_discs(states: Table) -> list[Claim]:
    """Return the claims on pressures of liquid discs, for the published particle number.

    The container is the published one, too. The virial series is too inaccurate here.
    """
    claims = []
    published = theory.literature("pressure", 2)
    references = {row.packing_fraction: row for row in published[published.container == "29 x 30"]}
    for state in states:
        eta = round(state.compared_packing_fraction, 9)
        if eta not in references:
            continue
        expected = Estimate(float(references[eta].value), float(references[eta].error))
        starts = zip(state.compared_pressure, state.compared_pressure_drift, strict=True)
        claims.append(
            Claim(
                claim=f"pressure of 870 discs at packing fraction {eta:g}, k_B T / sigma^2",
                measured=average([_with_drift(pressure, drift) for pressure, drift in starts]),
                expected=expected,
                required=REQUIRED[eta < NEAR] * expected.value,
                source="[Li 2022], event-chain programs, the same container",
                allowance_source="its statement",
                fails_if="contacts are missed or counted twice, or runs are shorter than their memory",
            )
        )
    return claims


def _crystal_of_discs(states: Table) -> list[Claim]:
    """Return the claims on the pressure of crystals of discs, for the published particle number.

    The required uncertainty is the uncertainty of the literature.
    """
    eta, expected, allowance = theory.CRYSTAL_OF_1024_DISCS
    same = states[(np.abs(states.packing_fraction - eta) < 1e-4) & (states.count == 1024)]
    return [
        Claim(
            claim=f"pressure of the crystal of 1024 discs at packing fraction {eta:g}, k_B T / sigma^2",
            measured=_with_drift(state.pressure[0], state.pressure_drift[0]),
            expected=Estimate(expected, allowance),
            required=allowance,
            source="[Zollweg 1992], figure 1",
            allowance_source="its statement",
            fails_if="contacts are missed, a crystal is strained, or the other phase remains or grows",
        )
        for state in same
    ]


def _equilibrium(states: Table) -> Claim:
    """Return the claim on the number of differences that agree with equilibrium.

    The probability is an exact binomial one. A fluid that is compressed beyond the melting point of the
    ordered phase freezes with defects. They do not heal in any such run.
    """
    melting = theory.coexistence_packing_fractions(2)[1]
    differences = states[states.packing_fraction <= melting].disagreement
    number = differences.size
    outliers = int((differences > EQUILIBRIUM_LIMIT).sum())
    chance = 1.0 - (1.0 - math.erfc(EQUILIBRIUM_LIMIT / math.sqrt(2.0))) ** COMPARED
    deviation = float(-ndtri(bdtrc(outliers - 1, number, chance)))
    return Claim(
        claim=f"packing fractions of {number} up to {melting:.3g} whose starts or halves differ by more "
        f"than {EQUILIBRIUM_LIMIT:g} standard errors",
        measured=Estimate(outliers),
        expected=number * chance,
        required=0.0,
        exact_deviation=max(deviation, 0.0),
        source="equilibrium does not depend on the start; some differ by chance (binomial)",
        fails_if="runs too short to become independent of their start",
    )


def _branch(state: Row) -> Claim:
    """Return the claim on Z on the branch of a run.

    A superheated crystal may melt during the run, and has no verdict.
    """
    eta, reference, solid = state.packing_fraction, state.reference, bool(state.crystalline)
    has_reference = not solid and math.isfinite(reference)
    allowance = float(theory.compressibility_uncertainty(eta, 3)) if has_reference else 0.0
    if solid:
        next_order = (theory.CLOSE_PACKING[3] / eta - 1.0) * state.finite_size
        allowance = math.hypot(theory.ETOMICA_CRYSTAL_UNCERTAINTY * reference, next_order)
    superheated = solid and eta < theory.coexistence_packing_fractions(3)[1]
    return Claim(
        claim=f"Z of the {'crystal' if solid else 'fluid'} at packing fraction {eta:.4g}, "
        f"from the {state.start}",
        measured=_with_drift(state.Z, state.pressure_drift / state.density),
        expected=Estimate(reference, allowance),
        required=2e-3 * reference,
        source="etomica's fit to simulations of its authors" if solid else "[Kolafa 2004]",
        allowance_source="its distance from runs behind [Pieprzyk 2019]; the next order of finite numbers"
        if solid
        else "its distance from etomica's equation, or from the virial series",
        no_verdict="a superheated crystal, which may be melting" if superheated else "",
        fails_if="contacts are missed, defects, or the other phase has begun to grow",
    )


def _slab(slab: Row) -> list[Claim]:
    expected, drift = theory.COEXISTENCE_PRESSURE[3], slab.slab_drift
    early, late = slab.crystal_fraction
    subject = "pressure of crystal beside fluid"
    return [
        Claim.within(
            claim=f"{subject}, k_B T / sigma^3",
            measured=Estimate(slab.slab_pressure, math.hypot(slab.slab_error, 0.5 * drift.value)),
            expected=expected,
            half_width=TOLERANCE * expected,
            source=SPHERES_SOURCE,
            fails_if="one phase has vanished, the crystal is strained, or contacts are missed",
        ),
        Claim(
            claim=f"{subject}: second half of the run minus the first, k_B T / sigma^3",
            measured=drift,
            expected=0.0,
            required=TOLERANCE * expected,
            source="a stationary state",
            fails_if="one phase is still growing",
        ),
        Claim.within(
            claim="part of the spheres that are crystalline at the end of the run",
            measured=Estimate(late, abs(late - early)),
            expected=0.5,
            half_width=0.3,
            source="the container holds both phases at the mean of their densities (lever rule)",
            fails_if="one phase has vanished",
        ),
    ]
