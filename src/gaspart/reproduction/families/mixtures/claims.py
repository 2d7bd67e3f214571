"""Claims about mixtures and polydisperse gases."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared import PARTICLES
from gaspart.reproduction.table import Row, Table, each

REQUIRED = 1e-3
"""Largest relative uncertainty of Z for which its comparison is conclusive."""
CONTACT = 5e-3
"""Required uncertainty of the contact value of a pair of species."""
THEORIES_AGREE = 0.1
"""Packing fraction below which theories of mixtures hardly differ: all have the exact second virial
coefficient."""
NEARLY_EQUAL = {"size_ratio": 0.9, "polydispersity": 0.1}
"""Limits of nearly equal sizes. There "santos" and "linear", exact for equal sizes, hardly differ."""
BETWEEN = "distance of the interpolations of [Santos 1999] and [Santos 2002], both exact for equal sizes"
_UNSURE = 0.5
"""Relative uncertainty of the correction of first order in 1/N, which is derived for equal particles.

To first order in the packing fraction it is exact for any sizes.
"""
OF_PURE = "uncertainty of the equation of equal discs, and " + BETWEEN
REPORTED = "reported only: the literature states no uncertainty of this approximation"
_SYH = "[Santos 2002], with the reference equation of equal particles"
_NAMES = {
    "boublik": "[Boublik 1970], [Mansoori 1971]",
    "linear": "[Santos 1999]",
    "santos": "[Santos 2002]",
}


def mixture_state(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims on Z, deviations from approximate theories, and collisions of pairs.

    Z is claimed only if theory is accurate.
    """
    gases, claims = Table(dataset, "point"), []
    for gas in gases:
        if _sharp(gas):
            claims.append(_compressibility(gas))
        if gas.size_ratio >= NEARLY_EQUAL["size_ratio"] and gas.small_fraction == 0.5:
            claims += _contacts(gas)
        if np.isfinite(gas.size_ratio):
            claims.append(_virial(gas))
    spheres = gases[gases.dimension == 3]
    if spheres:
        claims.append(_better(spheres))
    return [*claims, *_report_theories(gases)]


def _where(gas: Row) -> str:
    """Return a description of the point for the text of a claim."""
    if np.isfinite(gas.size_ratio):
        sizes = f"size ratio {gas.size_ratio:g}, {gas.small_fraction:.0%} small"
    else:
        sizes = f"{gas.distribution} polydispersity {gas.polydispersity:g}"
    return f"{PARTICLES[gas.dimension]}, {sizes}, packing fraction {gas.packing_fraction:.3g}"


def _dilute(gas: Row) -> bool:
    return bool(gas.packing_fraction <= THEORIES_AGREE * (1.0 + 1e-6))


def _sharp(gas: Row) -> bool:
    """Return True if the uncertainty of theory is small."""
    alike = (
        gas.size_ratio >= NEARLY_EQUAL["size_ratio"] or gas.polydispersity <= NEARLY_EQUAL["polydispersity"]
    )
    return alike or _dilute(gas)


def _compressibility(gas: Row) -> Claim:
    """Return the claim on Z; for spheres, on its deviation from Boublik's equation.

    Unless the spheres are dilute, the claim must exclude Boublik's equation.
    """
    allowance = math.hypot(gas.reference_error, gas.santos - gas.linear, gas.correction * _UNSURE)
    over, subject, required, alternative = gas.santos, "Z over that of [Santos 2002]", REQUIRED, None
    if gas.dimension == 3 and not _dilute(gas):
        over, subject, alternative = gas.boublik, "Z over Boublik's and Mansoori's", 1.0
        required = abs(gas.santos / over - 1.0) / 5.0
    return Claim(
        claim=f"{subject}, {_where(gas)}",
        measured=gas.Z / over,
        expected=Estimate(gas.santos, allowance) / over,
        required=required,
        source=_SYH,
        allowance_source=BETWEEN if gas.dimension == 3 else OF_PURE,
        fails_if="missed or spurious contacts, wrong radii, or a fluid that is not in equilibrium",
        alternative=alternative,
    )


def _contacts(gas: Row) -> list[Claim]:
    pairs = Table(gas.dataset, "pair")
    expected = pairs.contact_santos
    # a part of Z - 1, due to the finite number of particles
    unsure = abs(gas.correction) / (gas.santos - 1.0) * expected
    return each(
        pairs,
        f"contact value of {{pair}}, {_where(gas)}",
        measured=pairs.contact,
        expected=Estimate(expected, np.hypot(expected - pairs.contact_linear, unsure)),
        required=CONTACT * expected,
        source=_SYH,
        allowance_source=f"{BETWEEN}; and the part that 1/N changes of Z - 1",
        fails_if="collisions that are counted for another pair of species, or missed",
    )


def _virial(gas: Row) -> Claim:
    return Claim(
        claim=f"virial sum over that of the numbers of collisions of each pair, {_where(gas)}",
        measured=gas.virial + 1.0,
        expected=1.0,
        required=REQUIRED,
        source="velocities at contact are Maxwellian in equilibrium [Chapman 1970]",
        fails_if="collisions of some pair that are not counted, or impulses of the wrong mass",
    )


def deviations(gases: Table, theory: str) -> Estimate:
    """Compute Z / Z_theory - 1, shape (points,)."""
    return gases.Z / getattr(gases, theory) - 1.0


def _better(spheres: Table) -> Claim:
    """Return the claim of the abstract of [Santos 1999].

    The abstract states that their extension of Carnahan and Starling's equation agrees better with
    simulations than Boublik's equation.
    """
    mine, its = deviations(spheres, "starling"), deviations(spheres, "boublik")
    squares = [np.sum(deviation.value**2) for deviation in (mine, its)]
    ratio = np.sqrt(squares[0] / squares[1])
    gradient = (mine.value / squares[0] - its.value / squares[1]) * ratio
    return Claim.at_most(
        claim="spheres: rms deviation of Z from [Santos 1999], with Carnahan and Starling's equation, over "
        "that from [Boublik 1970] and [Mansoori 1971]",
        kind="reproduction",
        measured=Estimate(ratio, np.sqrt(np.sum((gradient * its.error) ** 2))),
        bound=1.0,
        required=0.2,
        source="abstract of [Santos 1999]",
        fails_if="mixtures that the equation describes less well",
        source_error="the statement is of the mixtures that had been simulated then",
    )


def _report_theories(gases: Table) -> list[Claim]:
    """Return the claims, without verdict, on the largest deviation of each theory."""
    claims = []
    for dimension, names in ((3, tuple(_NAMES)), (2, ("santos",))):
        part = gases[gases.dimension == dimension]
        for name in names if part else ():
            percent = 100.0 * deviations(part, name)
            largest = percent[np.argmax(np.abs(percent.value))]
            claims.append(
                Claim(
                    claim=f"largest deviation of Z of {PARTICLES[dimension]} from {_NAMES[name]}, per cent",
                    measured=Estimate(largest.value, largest.error),
                    expected=0.0,
                    required=0.1,
                    source=_NAMES[name],
                    fails_if="nothing: the number is reported",
                    no_verdict=REPORTED,
                )
            )
    return claims
