"""Claims about vibrated granular beds."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.statistics import Fit, fit_polynomial
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared.claims import freedoms, rows
from gaspart.reproduction.families.shared.rows import estimates

WAVEFORMS = {0: "sawtooth", 1: "sine"}
"""Names of the motions of the floor."""
BALANCE = (
    "energy balance of an isothermal, nearly elastic bed, to first order in the density "
    "(gaspart.theory.vibrated), losses at the floor included; the form is that of [Kumaran 1998] and of "
    "[McNamara 1998]"
)


def small_parameter(ds: xr.Dataset) -> np.ndarray:
    """The power that each bed would lose over its weight and the speed sqrt(T)."""
    return np.asarray(theory.bed_loss(*_bed_of(ds)))


def _bed_of(ds: xr.Dataset) -> tuple[np.ndarray, ...]:
    """The arguments of theory."""
    return tuple(ds[key].values for key in ("layers", "restitution", "packing_fraction"))


def expected_temperature(ds: xr.Dataset) -> np.ndarray:
    """The temperature of each bed where that parameter is small."""
    sawtooth = np.asarray(theory.sawtooth_temperature(*_bed_of(ds)))
    sine = np.asarray(theory.sine_temperature(*_bed_of(ds)))
    return np.where(ds["sine"].values == 1, sine, sawtooth) * ds["speed"].values ** 2


def extrapolation(ds: xr.Dataset) -> Fit:
    """The temperature over that of theory, as a polynomial of second order in the small parameter."""
    unit = expected_temperature(ds)
    ratio, error = estimates(ds, "temperature") / unit
    few = freedoms(ds, "temperature")
    return fit_polynomial(small_parameter(ds), ratio, error, powers=(0, 1, 2), freedoms=few)


def vibrated_bed(ds: xr.Dataset) -> list[Claim]:
    """What the floor gives, what contacts take, and the temperature and height where the two balance."""
    claims = []
    for kind, name in WAVEFORMS.items():
        beds = ds.isel(bed=(ds["sine"] == kind).values)
        if beds.sizes["bed"] > 2:
            fit = extrapolation(beds)
            claims.append(
                Claim(
                    claim=f"temperature over that of theory in the limit of elastic discs, {name}",
                    measured=fit.estimate(0),
                    expected=1.0,
                    required=0.03,
                    source=BALANCE,
                    fails_if="a floor that gives another energy, contacts that lose another, or a law of "
                    "another power of the speed or of the number of layers",
                )
            )
        claims += [claim for bed in rows(beds, "bed") for claim in _of_bed(bed, name)]
    return claims


def _of_bed(bed: xr.Dataset, name: str) -> list[Claim]:
    which = f"{name}, restitution {float(bed['restitution']):g}"
    claims = [
        Claim(
            claim=f"energy lost in contacts over that which the floor gives, {which}",
            kind="identity",
            measured=Estimate.of(bed, "lost") / float(bed["given"]),
            expected=1.0,
            required=0.01,
            source="conservation of energy in a steady state (the difference is what the bed stores)",
            fails_if="a bed that still cools or warms, or work that is not counted",
        ),
        Claim(
            claim=f"mean height times weight over the vertical temperature, {which}",
            measured=Estimate.of(bed, "height"),
            expected=float(theory.bed_height(bed["packing_fraction"].values)),
            required=0.01,
            source="the virial of a gas under gravity, to first order in its density",
            fails_if="falls or bounces that are not those of mechanics, discs of another size",
        ),
    ]
    if name == "sawtooth":
        claims.append(
            Claim(
                claim=f"energy given over weight and speed of the floor, {which}",
                kind="identity",
                measured=Estimate.of(bed, "given") / float(bed["speed"]),
                expected=1.0,
                required=0.01,
                source="exact: a floor that always moves at one speed gives it times the force, the weight",
                fails_if="bounces in which the floor has another speed, or is missed",
            )
        )
    return claims
