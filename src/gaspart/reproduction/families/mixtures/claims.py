"""Claims about mixtures and polydisperse gases."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared.claims import PARTICLES, rows
from gaspart.reproduction.families.shared.rows import estimates

REQUIRED = 1e-3
"""The largest uncertainty of Z, relative to it, at which its comparison means anything."""
CONTACT = 5e-3
"""The same of a contact value of one pair of species."""
THEORIES_AGREE = 0.1
"""Packing fraction up to which the theories of mixtures hardly differ: all have the exact second virial
coefficient."""
NEARLY_EQUAL = {"size_ratio": 0.9, "polydispersity": 0.1}
"""So nearly equal sizes that "santos" and "linear", which are exact for equal ones, hardly differ."""
BETWEEN = "distance of the interpolations of [Santos 1999] and [Santos 2002], both exact for equal sizes"
_UNSURE = 0.5
"""Of the correction of first order in 1/N, which is that of equal particles: its uncertainty. To first order
in the packing fraction it is exact for any sizes."""
OF_PURE = "uncertainty of the equation of equal discs, and " + BETWEEN
REPORTED = "reported only: the literature states no uncertainty of this approximation"
_SYH = "[Santos 2002], with the reference equation of equal particles"
_NAMES = {
    "boublik": "[Boublik 1970], [Mansoori 1971]",
    "linear": "[Santos 1999]",
    "santos": "[Santos 2002]",
}


def mixture_state(dataset: xr.Dataset) -> list[Claim]:
    """Z where theory is sharp, its deviations from approximate theories, and collisions of pairs."""
    claims = []
    for row in rows(dataset, "point"):
        if _sharp(row):
            claims.append(_compressibility(row))
        if float(row["size_ratio"]) >= NEARLY_EQUAL["size_ratio"] and float(row["small_fraction"]) == 0.5:
            claims += [_contact(row, pair) for pair in dataset["pair"].values]
        if np.isfinite(row["size_ratio"]):
            claims.append(_virial(row))
    spheres = dataset.isel(point=np.flatnonzero(dataset["dimension"] == 3))
    if spheres.sizes["point"]:
        claims.append(_better(spheres))
    return [*claims, *_reported(dataset)]


def _where(row: xr.Dataset) -> str:
    """What the point is."""
    if np.isfinite(row["size_ratio"]):
        sizes = f"size ratio {float(row['size_ratio']):g}, {float(row['small_fraction']):.0%} small"
    else:
        sizes = f"{row['distribution'].item()} polydispersity {float(row['polydispersity']):g}"
    return (
        f"{PARTICLES[int(row['dimension'])]}, {sizes}, packing fraction {float(row['packing_fraction']):.3g}"
    )


def _sharp(row: xr.Dataset) -> bool:
    """Whether the uncertainty of theory is small."""
    ratio, spread = float(row["size_ratio"]), float(row["polydispersity"])
    alike = ratio >= NEARLY_EQUAL["size_ratio"] or spread <= NEARLY_EQUAL["polydispersity"]
    return alike or float(row["packing_fraction"]) <= THEORIES_AGREE * (1.0 + 1e-6)


def _compressibility(row: xr.Dataset) -> Claim:
    """Of spheres as deviation from Boublik's equation, which must be excluded unless they are dilute."""
    expected, base = float(row["santos"]), float(row["santos"])
    allowance = np.hypot(float(row["reference_error"]), expected - float(row["linear"]))
    allowance = np.hypot(allowance, abs(float(row["correction"])) * _UNSURE)
    others: dict = {}
    what, required = "Z over that of [Santos 2002]", REQUIRED
    if int(row["dimension"]) == 3 and float(row["packing_fraction"]) > THEORIES_AGREE * (1.0 + 1e-6):
        base = float(row["boublik"])
        what, others = "Z over Boublik's and Mansoori's", {"alternative": 1.0}
        required = abs(expected / base - 1.0) / 5.0
    return Claim(
        claim=f"{what}, {_where(row)}",
        measured=Estimate.of(row, "Z") / base,
        expected=Estimate(expected, allowance) / base,
        required=required,
        source=_SYH,
        allowance_source=BETWEEN if int(row["dimension"]) == 3 else OF_PURE,
        fails_if="missed or spurious contacts, wrong radii, or a fluid that is not in equilibrium",
        **others,
    )


def _contact(row: xr.Dataset, pair: str) -> Claim:
    at = row.sel(pair=pair)
    expected = float(at["contact_santos"])
    # of a finite number as of Z - 1, whose part it is
    unsure = abs(float(row["correction"])) / (float(row["santos"]) - 1.0) * expected
    allowance = np.hypot(expected - float(at["contact_linear"]), unsure)
    return Claim(
        claim=f"contact value of {pair}, {_where(row)}",
        measured=Estimate.of(at, "contact"),
        expected=Estimate(expected, allowance),
        required=CONTACT * expected,
        source=_SYH,
        allowance_source=f"{BETWEEN}; and the part that 1/N changes of Z - 1",
        fails_if="collisions that are counted for another pair of species, or missed",
    )


def _virial(row: xr.Dataset) -> Claim:
    return Claim(
        claim=f"virial sum over that of the numbers of collisions of each pair, {_where(row)}",
        measured=Estimate.of(row, "virial") + 1.0,
        expected=1.0,
        required=REQUIRED,
        source="velocities at contact are Maxwellian in equilibrium [Chapman 1970]",
        fails_if="collisions of some pair that are not counted, or impulses of the wrong mass",
    )


def deviations(dataset: xr.Dataset, theory: str) -> tuple[np.ndarray, np.ndarray]:
    """(points,) Z / Z_theory - 1, and its error."""
    value, error = estimates(dataset, "Z") / dataset[theory].values
    return value - 1.0, error


def _better(spheres: xr.Dataset) -> Claim:
    """The abstract of [Santos 1999]: their extension of Carnahan and Starling's equation agrees better with
    simulations than Boublik's."""
    mine, its = (deviations(spheres, name) for name in ("starling", "boublik"))
    squares = [float(np.sum(value**2)) for value, _ in (mine, its)]
    ratio = np.sqrt(squares[0] / squares[1])
    parts = (mine[0] / squares[0] - its[0] / squares[1]) * ratio * its[1]  # of the gradient, times the errors
    return Claim.at_most(
        claim="spheres: rms deviation of Z from [Santos 1999], with Carnahan and Starling's equation, over "
        "that from [Boublik 1970] and [Mansoori 1971]",
        kind="reproduction",
        measured=Estimate(ratio, float(np.sqrt(np.sum(parts**2)))),
        bound=1.0,
        required=0.2,
        source="abstract of [Santos 1999]",
        fails_if="mixtures that the equation describes less well",
        why="the statement is of the mixtures that had been simulated then",
    )


def _reported(dataset: xr.Dataset) -> list[Claim]:
    """The largest deviation of each theory."""
    claims = []
    for dimension, names in ((3, tuple(_NAMES)), (2, ("santos",))):
        part = dataset.isel(point=np.flatnonzero(dataset["dimension"] == dimension))
        for name in names if part.sizes["point"] else ():
            value, error = deviations(part, name)
            most = int(np.argmax(np.abs(value)))
            claims.append(
                Claim(
                    claim=f"largest deviation of Z of {PARTICLES[dimension]} from {_NAMES[name]}, per cent",
                    measured=Estimate(100.0 * value[most], 100.0 * error[most]),
                    expected=0.0,
                    required=0.1,
                    source=_NAMES[name],
                    fails_if="nothing: the number is reported",
                    no_verdict=REPORTED,
                )
            )
    return claims
