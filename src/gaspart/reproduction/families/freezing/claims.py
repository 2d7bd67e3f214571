"""Claims about freezing.

A run that has not come to equilibrium is no evidence: its drift is part of its uncertainty, so that its
claims are inconclusive, not confirmed.
"""

from __future__ import annotations

import math

import numpy as np
import xarray as xr
from scipy.special import bdtrc, ndtri

from gaspart import theory
from gaspart.analysis.statistics import average
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared.claims import rows

TOLERANCE = 0.02
"""Relative half-width of the band around a coexistence pressure."""
EQUILIBRIUM_LIMIT = 3.0
"""Deviations between starts and halves, in standard errors, above which a run counts as not in
equilibrium."""
COMPARED = 6
"""Deviations at a packing fraction, of which the largest is taken: of pressure and order, between the starts
and between the halves of each run."""
REQUIRED = {0.68: 2e-4, 0.70: 4e-4}
"""Relative uncertainty of the pressure of 870 discs by packing fraction: what four processor-minutes reach.
The published ones are 4e-6 and 2e-5; the memory of the order is six times as long at 0.70."""
DISCS_SOURCE = "[Bernard 2011], [Engel 2013]"
SPHERES_SOURCE = "[Fernandez 2012]"


def freezing_discs(dataset: xr.Dataset) -> list[Claim]:
    """Plateau pressure from each start and their difference; melting and freezing; both branches;
    equilibrium."""
    expected = theory.COEXISTENCE_PRESSURE[2]
    claims = [_plateau(side, expected) for side in rows(dataset, "start")]
    if dataset.sizes["start"] == 2:
        first, second = (Estimate.of(side, "plateau") for side in rows(dataset, "start"))
        claims.append(
            Claim(
                claim="plateau pressure from the crystal minus that from the fluid, k_B T / sigma^2",
                measured=first - second,
                expected=0.0,
                required=TOLERANCE * expected / 2.0,
                source="one equation of state, whatever the start",
                fails_if="one of the runs still depends on its start",
            )
        )
    low, high = (dataset.isel(packing_fraction=k) for k in (0, -1))
    orders = [_orientation(low, melted=True), _orientation(high, melted=False)]
    branches = [*_liquid_of_discs(dataset), *_crystal_of_discs(dataset)]
    return [*claims, *orders, *branches, _equilibrium(dataset)]


def freezing_spheres(dataset: xr.Dataset) -> list[Claim]:
    """Where a crystal melts and where it is stable; both branches of Z; the pressure of coexisting phases."""
    crystal = dataset.sel(start="crystal").dropna("packing_fraction", subset=["order"])
    eta = crystal["packing_fraction"].values
    claims = []
    for mask, melted in ((eta <= 0.4501, True), (eta >= 0.5599, False)):
        if mask.any():
            claims.append(_lattice(crystal.isel(packing_fraction=mask), melted))
    melting = theory.coexistence_packing_fractions(3)[1]
    for at in (at for side in rows(dataset, "start") for at in rows(side, "packing_fraction")):
        if np.isfinite(at["order"]):  # there is a run
            claims.append(_branch(at, melting))
    return [*claims, *_slab(dataset)]


def _plateau(side: xr.Dataset, expected: float) -> Claim:
    return Claim.within(
        claim=f"plateau pressure of discs in k_B T / sigma^2, from the {side['start'].item()}",
        measured=Estimate.of(side, "plateau"),
        expected=expected,
        half_width=TOLERANCE * expected,
        source=DISCS_SOURCE,
        no_verdict="the literature's is that of 10^6 discs, and how much fewer discs shift it is not known",
        fails_if="runs not in equilibrium, a loop too coarse, or far too few discs (the pressure falls with "
        "1/N)",
    )


def _extreme(dataset: xr.Dataset, dimension: str, melted: bool) -> xr.Dataset:
    """The part furthest from equilibrium: the most ordered where all is melted, else the least ordered."""
    return dataset.isel({dimension: int((np.argmax if melted else np.argmin)(dataset["order"].values))})


def _orientation(at: xr.Dataset, melted: bool) -> Claim:
    make, bound = (Claim.at_most, 0.3) if melted else (Claim.at_least, 0.6)
    return make(
        claim=f"global |psi_6| at packing fraction {float(at['packing_fraction']):.4g}, "
        f"of the start that is {'most' if melted else 'least'} ordered",
        measured=Estimate.of(_extreme(at, "start", melted), "order"),
        bound=bound,
        required=0.1,
        source="liquid below 0.700, one orientation throughout above 0.720 ([Bernard 2011])",
        fails_if="the crystal has not melted"
        if melted
        else "the fluid has not frozen, or into several grains",
    )


def _lattice(at: xr.Dataset, melted: bool) -> Claim:
    eta = at["packing_fraction"].values
    make, bound = (Claim.at_most, 0.1) if melted else (Claim.at_least, 0.4)
    where = f"up to {eta.max():.4g}" if melted else f"from {eta.min():.4g}"
    return make(
        claim=f"{'largest' if melted else 'smallest'} global Q_6 from a face-centred cubic start, "
        f"packing fractions {where}",
        measured=Estimate.of(_extreme(at, "packing_fraction", melted), "order"),
        bound=bound,
        required=0.02,
        source="spheres melt below 0.49 and are stable above 0.55 ([Hoover 1968])",
        fails_if="a crystal that cannot melt, or one that disintegrates: contacts are wrong",
    )


def _with_drift(side: xr.Dataset, name: str) -> Estimate:
    """The variable `name`; half the drift between the halves is in its uncertainty if significant."""
    measured, drift = Estimate.of(side, name), Estimate.of(side, f"{name}_drift")
    significant = abs(drift.value) > EQUILIBRIUM_LIMIT * drift.error
    return Estimate(measured.value, math.hypot(measured.error, 0.5 * drift.value if significant else 0.0))


def _liquid_of_discs(dataset: xr.Dataset) -> list[Claim]:
    """Pressures of as many discs as published, in the same container; the virial series is too inaccurate."""
    claims = []
    for at in rows(dataset, "compared_packing_fraction"):
        eta = round(float(at["compared_packing_fraction"]), 9)
        if eta not in theory.LIQUID_OF_870_DISCS:
            continue
        expected = Estimate(*theory.LIQUID_OF_870_DISCS[eta])
        claims.append(
            Claim(
                claim=f"pressure of 870 discs at packing fraction {eta:g}, k_B T / sigma^2",
                measured=average([_with_drift(side, "compared_pressure") for side in rows(at, "start")]),
                expected=expected,
                required=REQUIRED[eta] * expected.value,
                source="[Li 2022], event-chain programs, the same container",
                allowance_source="its statement",
                fails_if="contacts are missed or counted twice, or runs are shorter than their memory",
            )
        )
    return claims


def _crystal_of_discs(dataset: xr.Dataset) -> list[Claim]:
    """The crystal's pressure where the literature has as many discs, to the literature's uncertainty."""
    eta, expected, allowance = theory.CRYSTAL_OF_1024_DISCS
    same = np.abs(dataset["packing_fraction"].values - eta) < 1e-4
    return [
        Claim(
            claim=f"pressure of the crystal of 1024 discs at packing fraction {eta:g}, k_B T / sigma^2",
            measured=_with_drift(at.isel(start=0), "pressure"),
            expected=Estimate(expected, allowance),
            required=allowance,
            source="[Zollweg 1992], figure 1",
            allowance_source="its statement",
            fails_if="contacts are missed, a crystal is strained, or the other phase remains or grows",
        )
        for at in rows(dataset.isel(packing_fraction=same), "packing_fraction")
        if int(at["count"]) == 1024
    ]


def _equilibrium(dataset: xr.Dataset) -> Claim:
    """The chance of so many differences in equilibrium is exact: binomial. A fluid that is compressed further
    than where the ordered phase melts freezes with defects, which do not heal in any such run."""
    melting = theory.coexistence_packing_fractions(2)[1]
    differences = dataset["disagreement"].sel(packing_fraction=slice(None, melting))
    number = differences.size
    found = int((differences > EQUILIBRIUM_LIMIT).sum())
    chance = 1.0 - (1.0 - math.erfc(EQUILIBRIUM_LIMIT / math.sqrt(2.0))) ** COMPARED
    deviation = float(-ndtri(bdtrc(found - 1, number, chance)))
    return Claim(
        claim=f"packing fractions of {number} up to {melting:.3g} whose starts or halves differ by more "
        f"than {EQUILIBRIUM_LIMIT:g} standard errors",
        measured=Estimate(found),
        expected=number * chance,
        required=0.0,
        exact_deviation=max(deviation, 0.0),
        source="equilibrium does not depend on the start; some differ by chance (binomial)",
        fails_if="runs too short to become independent of their start",
    )


def _branch(at: xr.Dataset, melting: float) -> Claim:
    """Z on the branch that a run is on; a superheated crystal may be melting, and has no verdict."""
    solid, reference = bool(at["crystalline"]), float(at["reference"])
    eta = float(at["packing_fraction"])
    superheated = solid and eta < melting
    known = not solid and math.isfinite(reference)
    allowance = float(theory.compressibility_uncertainty(eta, 3)) if known else 0.0
    scaled = at.assign(
        Z_drift=at["pressure_drift"] / at["density"], Z_drift_error=at["pressure_drift_error"] / at["density"]
    )
    return Claim(
        claim=f"Z of the {'crystal' if solid else 'fluid'} at packing fraction {eta:.4g}, "
        f"from the {at['start'].item()}",
        measured=_with_drift(scaled, "Z"),
        expected=Estimate(reference, allowance),
        required=2e-3 * reference,
        source="[Speedy 1998], by SklogWiki's table of coefficients" if solid else "[Kolafa 2004]",
        allowance_source="" if solid else "its distance from etomica's equation, or from the virial series",
        no_verdict="a superheated crystal, which may be melting" if superheated else "",
        fails_if="contacts are missed, defects, or the other phase has begun to grow",
    )


def _slab(dataset: xr.Dataset) -> list[Claim]:
    expected, drift = theory.COEXISTENCE_PRESSURE[3], Estimate.of(dataset, "slab_drift")
    fraction = dataset["crystal_fraction"].values
    what = "pressure of crystal beside fluid"
    return [
        Claim.within(
            claim=f"{what}, k_B T / sigma^3",
            measured=Estimate(dataset["slab_pressure"], math.hypot(dataset["slab_error"], 0.5 * drift.value)),
            expected=expected,
            half_width=TOLERANCE * expected,
            source=SPHERES_SOURCE,
            fails_if="one phase has vanished, the crystal is strained, or contacts are missed",
        ),
        Claim(
            claim=f"{what}: second half of the run minus the first, k_B T / sigma^3",
            measured=drift,
            expected=0.0,
            required=TOLERANCE * expected,
            source="a stationary state",
            fails_if="one phase is still growing",
        ),
        Claim.within(
            claim="part of the spheres that are crystalline at the end of the run",
            measured=Estimate(fraction[-1], abs(fraction[-1] - fraction[0])),
            expected=0.5,
            half_width=0.3,
            source="the container holds both phases at the mean of their densities (lever rule)",
            fails_if="one phase has vanished",
        ),
    ]
