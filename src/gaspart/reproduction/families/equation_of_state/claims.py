"""Claims about the equation of state, several radii, and published values."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.statistics import combine, combine_estimates, fit_power_law
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared import PARTICLES
from gaspart.reproduction.table import Row, Table, each

RELATIVE_ERROR = 1e-3
"""Largest relative standard error of Z for which its comparison is conclusive."""
WANTED = {2: 1e-3, 3: 1e-2, 4: 1e-1}
"""Required relative accuracy of each virial coefficient. Its standard error must be half of this."""
REFERENCE: dict[int, dict[str, Any]] = {
    2: {
        "source": "virial series to B10 ([Clisby 2006]) and a linear tail",
        "allowance_source": "of the virial coefficients ([Clisby 2006]), and the tail's distance from Liu's "
        "equation",
    },
    3: {
        "source": "[Kolafa 2004]",
        "allowance_source": "its distance from the equation of etomica, or from the virial series, if less",
    },
}
EXACT = {
    2: "exact: [source C], Eq. 48 ([Rowlinson 1964], [Hemmer 1965])",
    3: "exact: [Boltzmann 1899]",
}
KOLAFA_RANGE = (0.19, 0.41)
"""Packing fractions at which the Carnahan-Starling equation is 0.13 to 0.3 % too low, which is resolved."""


def virial_discs(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims on Z, B2, B3, B4, the collision rate, and correct error bars.

    There is a claim on Z at every packing fraction.
    """
    gases, fits = Table(dataset, "packing_fraction"), Table(dataset, "fit")
    dimension = gases.dimension
    # Enskog's collision rate is as accurate as Z - 1: same reference, same uncertainty.
    enskog = Estimate(1.0, gases.reference.error / (gases.reference.value - 1.0))
    return [
        *each(
            gases,
            "Z at packing fraction {packing_fraction:.4g}",
            measured=gases.Z,
            expected=gases.reference,
            required=RELATIVE_ERROR * gases.reference.value,
            **REFERENCE[dimension],
            fails_if="missed or spurious contacts, wrong impulses, or a fluid that is not in equilibrium",
        ),
        Claim.joint(
            claim="Z at all packing fractions together",
            deviations=(gases.Z - gases.reference).deviation,
            source=REFERENCE[dimension]["source"],
            fails_if="a bias too small for one point is common to many, or the error bars are wrong",
        ),
        *(_coefficients(fits[0], dimension) if fits else []),
        Claim.joint(
            claim="collision rate over Enskog's at all packing fractions",
            deviations=(gases.collision_rate - enskog).deviation,
            source="Enskog's rate, exact in equilibrium, with the reference's contact value",
            fails_if="collisions are missed or counted twice, or velocities at contact are not Maxwellian",
        ),
        *_replicas(gases),
    ]


def virial_spheres(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims of `virial_discs`, and the claim that two equations are distinguished.

    These are the equations of Kolafa, Labík and Malijevský and of Carnahan and Starling.
    """
    gases, (low, high) = Table(dataset, "packing_fraction"), KOLAFA_RANGE
    chosen = gases[(gases.packing_fraction >= low) & (gases.packing_fraction <= high)]
    return virial_discs(dataset) + ([_distinguish(chosen)] if chosen else [])


def _coefficients(fit: Row, dimension: int) -> list[Claim]:
    orders = Table(fit.dataset.sel(order=list(WANTED)), "order")
    held = f"B{fit.free + 1} to B10 held at literature values" if fit.held else "higher ones zero"
    return each(
        orders,
        f"B{{order}} in powers of the particle's {'area' if dimension == 2 else 'volume'} "
        f"(B2 to B{fit.free} fitted up to packing fraction {fit.up_to:g}, {held})",
        measured=orders.coefficient + Estimate(0.0, orders.held_error),
        expected=orders.exact.value,
        required=0.5 * np.array(list(WANTED.values())) * orders.exact.value,
        source=EXACT[dimension],
        fails_if="Z is biased at low density, where every error of Z - 1 is an error of B2",
    )


def _replicas(gases: Table) -> list[Claim]:
    freedom = int(gases.replica_degrees_of_freedom.sum())
    if not freedom:
        return []
    return [
        Claim.chi_square(
            claim="error bars: scatter of replicas over what their blocks predict "
            "(chi-square per degree of freedom)",
            chi_square=float(gases.replica_chi_square.sum()),
            degrees_of_freedom=freedom,
            source="independent replicas of one state have one mean",
            fails_if="blocks are too short, runs are not equilibrated, or seeds are not independent",
        )
    ]


def _distinguish(chosen: Table) -> Claim:
    """Return the claim on the mean of Z / Z_CS - 1.

    The mean equals the value by Kolafa, Labík and Malijevský's equation, not 0.
    """
    eta = chosen.packing_fraction
    measured, stated = (z / theory.carnahan_starling(eta) - 1.0 for z in (chosen.Z, chosen.reference))
    expected = Estimate(measured.weights @ stated.value, measured.weights @ stated.error)
    return Claim(
        claim=f"excess of Z over Carnahan-Starling, mean of packing fractions {eta.min():.2g} to "
        f"{eta.max():.2g}",
        measured=combine_estimates(measured),
        expected=expected,
        required=expected.value / 5.0,
        **REFERENCE[3],
        alternative=0.0,
        fails_if="Z is too imprecise or biased to distinguish the two equations",
    )


def radius_grid(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims that Z depends on packing fraction alone, and on predicted costs."""
    table = Table(dataset, "point")
    event, step = (table[table.engine == name] for name in ("event", "step"))
    same, other = (event[event.series == name] for name in ("packing fraction", "count"))
    ratios = step.pair_tests / step.pair_tests_expected
    return [
        _same_state(same),
        Claim.joint(
            claim=f"Z of N = {other.count[0]:.0f} at all radii against the equation of state",
            deviations=(other.Z - other.reference).deviation,
            source="[Kolafa 2004], shifted to first order in 1/N",
            fails_if="Z is biased at some radius",
        ),
        Claim.joint(
            claim="crossings of box boundaries per particle and time over d <|v_x|> (n-1)/L, all radii",
            deviations=(event.crossings - 1.0).deviation,
            source="kinetic theory, exact in equilibrium",
            fails_if="crossings are missed or counted twice, or velocities are not Maxwellian",
        ),
        Claim.within(
            claim="exponent of the event-driven engine's pair tests per collision, "
            "against the radius at one packing fraction",
            measured=fit_power_law(same.radius, same.pair_tests).estimate,
            expected=0.0,
            half_width=0.05,
            source="scale invariance: the same gas, enlarged, except for periodic images (order 1/n)",
            fails_if="the cost of a collision depends on the number of particles",
        ),
        Claim.within(
            claim="pair tests per particle and step over those expected, time-stepped, mean over all radii",
            measured=Estimate(ratios.mean(), ratios.std(ddof=1) / np.sqrt(ratios.size)),
            expected=1.0,
            half_width=0.01,
            source="half of the particles in 3^d boxes, minus the hole that each makes: "
            "f N + (S - 1) - f S, 1/S = d(eta Z)/d eta",
            fails_if="pairs are tested twice or missed, or particles are kept in wrong boxes",
        ),
    ]


def _same_state(same: Table) -> Claim:
    """Return the claim that values of Z at equal packing fraction agree with their mean.

    The only theory in this claim is the 1/N correction.
    """
    mean, radii, counts = combine(same.Z), same.radius, same.count
    return Claim.chi_square(
        claim=f"one Z at packing fraction {same.packing_fraction[0]:.3g} for all radii, "
        f"{radii.min():.3g} to {radii.max():.3g} (N = {counts.min():.0f} to {counts.max():.0f}), "
        "corrected to first order in 1/N (chi-square per degree of freedom about their mean)",
        chi_square=mean.chi_square,
        degrees_of_freedom=mean.degrees_of_freedom,
        error_freedom=mean.error_freedom,
        source="hard spheres have no length but their diameter: Z is a function of the packing fraction",
        fails_if="something depends on the radius other than through the packing fraction, or the 1/N "
        "correction is wrong",
    )


EQUILIBRIUM = ("Z", "Z_crystal", "pressure")
NAMES = {
    "Z": "Z of the fluid of",
    "Z_crystal": "Z of the face-centred cubic crystal of",
    "pressure": "pressure of",
    "diffusion": "diffusion coefficient of",
    "viscosity": "viscosity of",
    "conductivity": "conductivity of",
}
REQUIRED = {"Z": 1e-3, "Z_crystal": 1e-3, "diffusion": 0.015, "viscosity": 0.1, "conductivity": 0.1}
"""Largest relative uncertainty of our values for a conclusive claim.

The published values have uncertainties of up to 1e-5, 0.2 %, and 3 to 11 %.
"""
SOURCES = {
    "Chudak": "runs by the program DynamO of an author of [Pieprzyk 2019]",
    "DynamO test": "[Bannerman 2011], expected by a test of its authors' program",
    "DynamO tutorial": "[Bannerman 2011], a run of its authors' tutorial",
}
"""Names of sources that are not keys of references."""


def literature(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims that our values agree with published values, singly and all together."""
    values = Table(dataset, "value")
    named = values.assign(
        name=[NAMES[quantity] for quantity in values.quantity],
        particles=[PARTICLES[dimension] for dimension in values.dimension],
    )
    own = named[named.judged == 1]
    required = [REQUIRED[row.quantity] * row.theirs.value for row in own]
    static = [quantity in EQUILIBRIUM for quantity in values.quantity]
    return [
        *each(
            own,
            "{name} {particles} at packing fraction {packing_fraction:.4g}, {count} particles, by {source}",
            measured=own.ours,
            expected=own.theirs,
            required=required,
            source=[_cite(source) for source in own.source],
            allowance_source="their statement",
            fails_if="contacts are missed, correlations cut too early, or finite numbers act otherwise",
        ),
        *_together(values[static], "Z and pressures beside those of others"),
        *_together(
            values[[not is_static for is_static in static]], "transport coefficients beside those of others"
        ),
    ]


def _cite(source: str) -> str:
    return SOURCES.get(source, f"[{source}]")


def _together(values: Table, claim: str) -> list[Claim]:
    """Return the claim that deviations scatter as both uncertainties predict."""
    if not values:
        return []
    return [
        Claim.joint(
            claim=claim,
            deviations=(values.ours - values.theirs).deviation,
            source=f"programs of others: {', '.join(map(_cite, dict.fromkeys(values.source)))}",
            fails_if="a bias too small for one value is common to many, or error bars are wrong",
        )
    ]
