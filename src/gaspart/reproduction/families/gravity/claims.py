"""Claims about gases under gravity."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.table import Row, Table, each
from gaspart.theory.gravity import ideal_heat_capacity

HYDROSTATICS = "hydrostatics dP/dz = -m g rho"
REFERENCE = "virial series to B10 with a linear tail ([Clisby 2006])"
EXCHANGE = "exchange of two discs of one size costs (M - m) g dz (exact at any density)"
C = "notebooks of [source C]'s code (tms-ninja/billiards)"
IDEAL = 0.01
"""Largest packing fraction of a column that counts as an ideal gas."""


def barometric(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on the barometric formula, equation of state, and uniform temperature.

    The equation of state follows from the weight of the column.
    """
    return [claim for column in Table(ds, "point") for claim in _of_one_kind(column)]


def separation(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on scale heights of species, and on their density ratio.

    In a dilute gas each species has its own scale height. The ratio of densities is exponential at any
    density.
    """
    return [claim for column in Table(ds, "point") for claim in _of_two_kinds(column)]


def _of_one_kind(row: Row) -> list[Claim]:
    if row.column == "source":
        return _source_column(row)
    at = _at(row)
    if row.column == "later":
        # Heat crosses the column in about the duration of a block: only local quantities are independent in
        # each block.
        return [_balance(row, at), *_pressures(row, at)]
    discs = Table(row.dataset, "species")[0]
    return [
        _slope(discs, "discs", at, 0.005 if _dilute(row) else 0.01),
        Claim(
            claim=f"temperature against height, d ln T / dz over -1/(scale height), {at}",
            measured=-row.temperature_gradient,
            expected=0.5 / row.count,
            required=0.005,
            source="an isothermal column ([Maxwell 1867]); at fixed energy 1/C_V more, 2Nk in a high one",
            fails_if="a column that is warmer at one end: not in equilibrium, or an engine that heats",
        ),
        _balance(row, at),
        *([_mean_height(discs, "discs", at)] if _dilute(row) else _pressures(row, at)),
    ]


def _of_two_kinds(row: Row) -> list[Claim]:
    at = _at(row)
    claims = [_species_temperature(row, at), _balance(row, at)]
    if row.column == "source":
        return claims + _source_mixture(row)
    claims.append(
        Claim(
            claim=f"slope of ln(heavy/light) over -(M - m) g / kT, {at}",
            measured=row.exchange_ratio,
            expected=1.0,
            required=0.01 if _dilute(row) else 0.02,
            source=EXCHANGE,
            fails_if="species that do not separate according to their weights, or runs too short for it",
        )
    )
    if not _dilute(row):
        return claims + _pressures(row, at)
    species = list(zip(Table(row.dataset, "species"), ("light", "heavy"), strict=True))
    claims += [_slope(kind, name, at, 0.005) for kind, name in species]
    return claims + [_mean_height(kind, name, at) for kind, name in species]


def _source_column(row: Row) -> list[Claim]:
    """Return the claims on source C's column at the time of its sample.

    Our column is in the same state. It is not yet in equilibrium.
    """
    return [
        _collisions(row),
        Claim.within(
            claim="temperature of the source's column over the source's, in its sample",
            kind="reproduction",
            measured=row.temperature / row.source_temperature,
            expected=1.0,
            half_width=0.02,
            source=f"{C}, gravity: {row.source_temperature:g}, fitted to ten bins of speeds, of a "
            "sample that is shorter than a period of the oscillation",
            fails_if="a column that falls, bounces or heats up otherwise",
        ),
        Claim.at_most(
            claim="amplitude of the oscillation of the temperature in the source's sample, in per cent",
            kind="reproduction",
            measured=row.ringing * 100.0,
            bound=1.0,
            required=0.3,
            source=f"{C}, gravity: takes the column to be in equilibrium after its collisions",
            source_error="the oscillation after the fall decays as slowly as sound does over 200 diameters",
            fails_if="a column that still rings more than the accuracy of the other claims",
        ),
        _balance(row, _at(row)),
    ]


def _source_mixture(row: Row) -> list[Claim]:
    """Return the claims on source C's mixture at the end of its run.

    Our mixture is separated to the same degree. It is not in equilibrium.
    """
    reported = Estimate(row.source_shares, row.share.error)
    return [
        _collisions(row),
        Claim.joint(
            claim="share of light discs in ten layers, over the source's",
            kind="reproduction",
            deviations=(row.share - reported).deviation,
            source=f"{C}, separation, last picture: as many discs in a layer, so the error is as large",
            fails_if="discs that diffuse through each other, or fall, faster or more slowly",
        ),
        Claim.at_most(
            claim="slope of ln(heavy/light) over -(M - m) g / kT, the source's mixture at the end of its run",
            kind="reproduction",
            measured=row.exchange_ratio,
            bound=0.9,
            required=0.05,
            source=f"{EXCHANGE}; {C}, separation, does not state that its run has arrived there",
            fails_if="a mixture that separates within the source's collisions",
        ),
    ]


def _collisions(row: Row) -> Claim:
    """Return the claim on the number of collisions of the source's run until its end.

    The number comes from a single run.
    """
    reported, count = row.source_collisions, row.collisions
    return Claim.within(
        claim=f"collisions until the source's {reported:.1e}, over them",
        kind="reproduction",
        measured=Estimate(count, np.sqrt(count)) / reported,
        expected=1.0,
        half_width=0.01,
        source=f"{C}: the time at which its run ends; walls count, and its grid is square",
        fails_if="an engine that misses contacts or makes up others, or another scene than the source's",
    )


def _species_temperature(row: Row, at: str) -> Claim:
    return Claim(
        claim=f"temperature of the heavy over that of the light discs, {at}",
        measured=row.species_temperature_ratio[-1],
        expected=1.0,
        required=0.01,
        source="equipartition",
        fails_if="species that do not share their energy",
    )


def _dilute(row: Row) -> bool:
    return bool(row.packing_fraction.value.max() < IDEAL)


def _at(row: Row) -> str:
    density = "dilute" if _dilute(row) else "dense"
    whose = "the source's " if row.column == "source" else ""
    return f"{whose}{density} column of {row.count:g} discs"


def _slope(species: Row, name: str, at: str, required: float) -> Claim:
    """Return the claim on the slope of the chemical potential of a species."""
    return Claim(
        claim=f"slope of the chemical potential of the {name} over -m g / kT, {at}",
        measured=species.slope_ratio,
        expected=1.0,
        required=required,
        source="ln rho + mu_excess(rho) + m g z / kT is uniform in equilibrium; in a dilute gas ln rho alone",
        fails_if="a density that does not decay exponentially with its own scale height",
    )


def _mean_height(species: Row, name: str, at: str) -> Claim:
    """Return the claim on the mean height of a species."""
    return Claim(
        claim=f"mean height of the {name} over the ideal gas's, {at}",
        measured=species.mean_height_ratio,
        expected=1.0 + species.packing_fraction.value.max(),
        required=0.01,
        source="<z> = kT/mg - H/(exp(mgH/kT) - 1); B2 raises it by the packing fraction at the floor (first "
        "order, high column)",
        fails_if="a gas that does not fill its container according to Boltzmann's factor",
    )


def _pressures(row: Row, at: str) -> list[Claim]:
    ranges = Table(row.dataset, "range")
    ranges = ranges[np.isfinite(ranges.range_ratio.value)]
    return each(
        ranges,
        "pressure that carries the weight above over rho kT Z(eta), "
        f"eta from {{range_low:g}} to {{range_high:g}}, {at}",
        measured=ranges.range_ratio,
        expected=1.0,
        required=0.01,
        source=f"{HYDROSTATICS}, Z of the {REFERENCE}",
        fails_if="a density profile that is not the equation of state's",
    )


def _balance(row: Row, at: str) -> Claim:
    return Claim.at_most(
        claim=f"(floor - ceiling - weight - gain of momentum) over the weight, {at}",
        kind="identity",
        measured=Estimate(row.imbalance, 1e-9),
        bound=1e-8,
        required=1e-8,
        source="balance of momentum (exact)",
        fails_if="impulses on floor and ceiling that are not those of the particles",
    )


def heat_capacity(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on the heat capacity from energy differences and from fluctuations."""
    return [claim for pair in Table(ds, "pair") for claim in _capacities(pair)]


def _capacities(pair: Row) -> list[Claim]:
    x = abs(pair.x)
    kind, at = "test" if x else "identity", f"gravity {pair.gravity:g}"
    ideal = f"d/2 + 1 - x^2 e^x/(e^x - 1)^2 = {float(ideal_heat_capacity(x, 2)):.4f}"
    finite = f"{ideal}, here for {pair.count} particles at the runs' energies"
    rounding = Estimate(0.0, 1e-9)  # without gravity both are exact except for this correction
    runs = Table(pair.dataset, "run").assign(number=[1, 2])
    return [
        Claim(
            claim=f"heat capacity C_V/Nk as dE/dT, {at}",
            kind=kind,
            measured=pair.slope + rounding,
            expected=pair.slope_expected,
            required=0.02,
            source=finite,
            fails_if="an energy that is not distributed over height and motion by Boltzmann's factor",
        ),
        *each(
            runs,
            f"heat capacity C_V/Nk from fluctuations, {at}, run {{number}}",
            kind=kind,
            measured=runs.fluctuation + rounding,
            expected=runs.fluctuation_expected,
            required=0.03,
            source=f"[Lebowitz 1967]; {finite}",
            fails_if="fluctuations that are not the microcanonical ones: not ergodic, or energy lost",
        ),
    ]
