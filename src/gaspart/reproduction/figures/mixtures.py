"""Z, contact values and collision rates of mixtures and polydisperse gases, beside theories.

A point is a periodic gas, polydisperse or of two sizes, whose collisions are counted by pairs of species.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.pairs import contact_scales, estimates_of, rate_scales
from gaspart.analysis.run import Run
from gaspart.analysis.series import compressibility
from gaspart.analysis.statistics import average, correlated_mean
from gaspart.errors import SceneError
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import PARTICLES, Parts, runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, table
from gaspart.scene.facts import Mixture
from gaspart.scene.sizes import DISTRIBUTIONS, relative_radii
from gaspart.theory.mixtures import MIXTURE_THEORIES
from gaspart.theory.speeds import mean_speed_factor
from gaspart.trajectory.correlator import pairs_of

TITLE, CHAPTER = "Mixtures", "Equation of state and structure"
PAIRS = {"large-large": (0, 0), "large-small": (0, 1), "small-small": (1, 1)}


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure Z of the infinite gas and, for two sizes, the virial, contact values and rates of pairs.
    Theories stand beside them, such as contact_boublik. A rate counts collisions of a particle of the first
    kind with all of the second.
    """
    units = {"rate": "sqrt(k_B T / m) / diameter"}
    return table("point", points, _gas, inner=("pair",), units=units).assign_coords(pair=list(PAIRS))


def _gas(point: Point) -> dict[str, Any]:
    scene, settings = point.scene, point.settings
    gas, two = scene.mixture, "size_ratio" in settings
    if gas is None:
        raise SceneError("species", len(scene.kinds), "must be smooth and elastic particles alone")
    eta, d = gas.packing_fraction, gas.dimension
    correction = float(theory.finite_size_correction(eta, d, scene.count, "canonical"))
    replicas = [_replica(run, two) for run in runs(point)]
    means = {name: average([replica[name] for replica in replicas]) for name in replicas[0]}
    if two:
        means["rate"] /= _unit_of_rate(gas)
    return {
        "dimension": d,
        "packing_fraction": eta,
        "count": scene.count,
        **{key: settings.get(key, math.nan) for key in ("size_ratio", "small_fraction", "polydispersity")},
        "distribution": "" if two else settings.get("radius_distribution", DISTRIBUTIONS[0]),
        **means,
        "Z": means["Z"] - correction,
        "correction": correction,
        "reference_error": float(theory.compressibility_uncertainty(eta, d)),
        **_theories(gas),
    }


def _replica(run: Run, two: bool) -> dict[str, Estimate]:
    row = {"Z": correlated_mean(compressibility(run)).estimate}
    if two:
        row["virial"] = _virial(run)
        row["contact"] = Estimate.stack(estimates_of(run, contact_scales(run)))
        row["rate"] = Estimate.stack(estimates_of(run, rate_scales(run)))
    return row


def _virial(run: Run) -> Estimate:
    """Compute the sum of |dr . dp| over that of Maxwellian velocities for each pair's collisions, minus 1.
    The mean of |dr . dp| for colliding particles of reduced mass mu is sigma sqrt(2 pi mu k_B T).
    """
    weights = []
    for i, j in pairs_of(run.scene):
        first, second = run.scene.species[i], run.scene.species[j]
        reduced = first.mass * second.mass / (first.mass + second.mass)
        impulse = math.sqrt(2.0 * math.pi * reduced * run.temperature) / mean_speed_factor(run.freedom)
        weights.append((first.radius + second.radius) * impulse)
    predicted = run.increments("pair_collisions") @ np.array(weights)
    return correlated_mean(run.increments("virial_sum") / predicted - 1.0).estimate


def _theories(gas: Mixture) -> dict[str, Any]:
    """Return Z by each theory; for two sizes also contact value and rate of each pair."""
    row: dict[str, Any] = {}
    z, sizes = theory.mixture_compressibility_factor, gas.sizes
    for name, dimensions in MIXTURE_THEORIES.items():
        if gas.dimension not in dimensions:
            continue
        row[name] = z(*sizes, theory=name)
        if len(gas.diameters) == 2:
            contact = theory.mixture_contact_values(*sizes, theory=name)
            rate = theory.mixture_collision_rates(
                *sizes, theory=name, temperature=gas.temperature, masses=gas.masses
            ) / _unit_of_rate(gas)
            row[f"contact_{name}"] = [contact[pair] for pair in PAIRS.values()]
            row[f"rate_{name}"] = [rate[pair] for pair in PAIRS.values()]
    if gas.dimension == 3:
        eta = gas.packing_fraction
        pure = (float(theory.carnahan_starling(eta)) - 1.0) / (4.0 * eta)
        row["starling"] = z(*sizes, theory="linear", pure=pure)
    return row


def _unit_of_rate(gas: Mixture) -> float:
    """Return sqrt(k_B T / m) divided by the larger diameter."""
    return math.sqrt(gas.temperature / gas.masses[0]) / gas.diameters[0]


REQUIRED = 1e-3  # relative, of Z
DILUTE = 0.1 * (1.0 + 1e-6)  # theories hardly differ: all have the exact second virial coefficient
# "santos" and "linear", exact for equal sizes, hardly differ within these limits.
RATIO, POLYDISPERSITY = 0.9, 0.1
# The correction of first order in 1/N is derived for equal particles, and is exact for any sizes to first
# order in the packing fraction.
UNSURE = 0.5
SYH = "[Santos 2002], with the reference equation of equal particles"
NAMES = {
    "boublik": "[Boublik 1970], [Mansoori 1971]",
    "linear": "[Santos 1999]",
    "santos": "[Santos 2002]",
}
BETWEEN = "distance of the interpolations of [Santos 1999] and [Santos 2002], both exact for equal sizes"


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield claims on Z where theory is accurate, on collisions of pairs, and on approximate theories."""
    gases = Table(dataset, "point")
    for gas in gases:
        alike = gas.size_ratio >= RATIO or gas.polydispersity <= POLYDISPERSITY
        if alike or gas.packing_fraction <= DILUTE:
            yield _compressibility(gas)
        if gas.size_ratio >= RATIO and gas.small_fraction == 0.5:
            yield from _contacts(gas)
        if np.isfinite(gas.size_ratio):
            yield Claim(
                f"virial sum over that of the numbers of collisions of each pair, {_where(gas)}",
                gas.virial + 1.0, 1.0, REQUIRED,
                "velocities at contact are Maxwellian in equilibrium [Chapman 1970]",
                "collisions of some pair that are not counted, or impulses of the wrong mass",
            )  # fmt: skip
    for dimension, names in ((3, tuple(NAMES)), (2, ("santos",))):
        part = gases[gases.dimension == dimension]
        if part and dimension == 3:
            yield _better(part)
        for name in names if part else ():
            percent = 100.0 * _deviations(part, name)
            largest = percent[np.argmax(np.abs(percent.value))]
            yield Claim(
                f"largest deviation of Z of {PARTICLES[dimension]} from {NAMES[name]}, per cent",
                Estimate(largest.value, largest.error), 0.0, 0.1, NAMES[name],
                "nothing: the number is reported",
                no_verdict="reported only: the literature states no uncertainty of this approximation",
            )  # fmt: skip


def _where(gas: Row) -> str:
    if np.isfinite(gas.size_ratio):
        sizes = f"size ratio {gas.size_ratio:g}, {gas.small_fraction:.0%} small"
    else:
        sizes = f"{gas.distribution} polydispersity {gas.polydispersity:g}"
    return f"{PARTICLES[gas.dimension]}, {sizes}, packing fraction {gas.packing_fraction:.3g}"


def _compressibility(gas: Row) -> Claim:
    """Return the claim on Z; for spheres that are not dilute it must exclude Boublik's equation."""
    allowance = math.hypot(gas.reference_error, gas.santos - gas.linear, gas.correction * UNSURE)
    over, subject, required, alternative = gas.santos, "Z over that of [Santos 2002]", REQUIRED, None
    if gas.dimension == 3 and gas.packing_fraction > DILUTE:
        over, subject, alternative = gas.boublik, "Z over Boublik's and Mansoori's", 1.0
        required = abs(gas.santos / over - 1.0) / 5.0
    of_discs = "" if gas.dimension == 3 else "uncertainty of the equation of equal discs, and "
    return Claim(
        f"{subject}, {_where(gas)}", gas.Z / over, Estimate(gas.santos, allowance) / over, required, SYH,
        "missed or spurious contacts, wrong radii, or a fluid that is not in equilibrium",
        allowance_source=of_discs + BETWEEN, alternative=alternative,
    )  # fmt: skip


def _contacts(gas: Row) -> Iterator[Claim]:
    for pair in Table(gas.dataset, "pair"):
        stated = pair.contact_santos
        of_few = abs(gas.correction) / (gas.santos - 1.0) * stated  # a part of Z - 1, as N is finite
        yield Claim(
            f"contact value of {pair.pair}, {_where(gas)}", pair.contact,
            Estimate(stated, np.hypot(stated - pair.contact_linear, of_few)), 5e-3 * stated, SYH,
            "collisions that are counted for another pair of species, or missed",
            allowance_source=f"{BETWEEN}; and the part that 1/N changes of Z - 1",
        )  # fmt: skip


def _better(spheres: Table) -> Claim:
    """Return the claim of a source that its equation agrees better with simulations than Boublik's."""
    mine, its = _deviations(spheres, "starling"), _deviations(spheres, "boublik")
    squares = [np.sum(deviation.value**2) for deviation in (mine, its)]
    ratio = np.sqrt(squares[0] / squares[1])
    gradient = (mine.value / squares[0] - its.value / squares[1]) * ratio
    return Claim.at_most(
        "spheres: rms deviation of Z from [Santos 1999], with Carnahan and Starling's equation, over "
        "that from [Boublik 1970] and [Mansoori 1971]",
        Estimate(ratio, np.sqrt(np.sum((gradient * its.error) ** 2))), 1.0, 0.2,
        "abstract of [Santos 1999]", "mixtures that the equation describes less well",
        kind="reproduction", source_error="the statement is of the mixtures that had been simulated then",
    )  # fmt: skip


def _deviations(gases: Table, theory: str) -> Estimate:
    return gases.Z / getattr(gases, theory) - 1.0


BASE = {3: "boublik", 2: "santos"}  # theory from which deviations are drawn
OVER = {3: r"$Z/Z_\mathrm{BMCSL}-1$ (%)", 2: r"$Z/Z_\mathrm{SYH}-1$ (%)"}
SHORT = {3: "spheres / BMCSL", 2: "discs / SYH"}
RATIOS = np.linspace(0.28, 1.0, 60)


def draw(dataset: xr.Dataset) -> Figure:
    """Draw deviations of Z from theory by size ratio, density and polydispersity; contacts and rates."""
    figure, axes = style.new(*[(2.1,)] * 6)
    ratio, density, discs, many, contact, rate = axes
    gases = Table(dataset, "point")
    two = gases[np.isfinite(gases.size_ratio)]
    _by_ratio(ratio, two, 3)
    _by_density(density, two)
    _by_ratio(discs, two, 2)
    _by_polydispersity(many, gases[np.isfinite(gases.polydispersity)])
    _pairs(contact, two, "contact", theory.mixture_contact_values)
    style.label_axes(contact, y=r"contact value $g_{ij}$, spheres")
    _pairs(rate, two, "rate", theory.mixture_collision_rates)
    style.label_axes(rate, y=r"rate $\nu_{ij}\,\sigma_1\sqrt{m/k_\mathrm{B}T}$, spheres", yscale="log")
    style.letters(*axes)
    return figure


def _by_ratio(axis: Axes, two: Table, dimension: int) -> None:
    for kind, (small, gases) in enumerate(_most_frequent(two, dimension).by("small_fraction")):
        beside = gases.size_ratio + 0.008 * (kind - 0.5)
        percent = 100.0 * _deviations(gases, BASE[dimension])
        style.points(axis, beside, percent, kind=kind, label=f"{small:.0%} small")
        if dimension == 3:
            eta = gases.packing_fraction[0]
            spheres = [(eta, (1.0, ratio), (1.0 - small, small)) for ratio in RATIOS]
            _curves(axis, RATIOS, spheres, kind, named=kind == 0)
    axis.axhline(0.0, color=style.GREY, lw=0.8, label="BMCSL" if dimension == 3 else "SYH 1999, 2002")
    over = f"{OVER[dimension]}, {PARTICLES[dimension]}"
    style.label_axes(axis, r"size ratio $\sigma_2/\sigma_1$", over, legend="best")


def _most_frequent(gases: Table, dimension: int) -> Table:
    """Return the points of a dimension at the most frequent packing fraction."""
    part = gases[gases.dimension == dimension]
    if not part:
        return part
    values, counts = np.unique(np.round(part.packing_fraction, 9), return_counts=True)
    return part[np.isclose(part.packing_fraction, values[np.argmax(counts)])]


def _curves(axis: Axes, x: np.ndarray, spheres: Sequence[tuple], kind: int, named: bool = True) -> None:
    """Draw other theories of spheres over BMCSL: packing fraction, diameters and numbers for each x."""

    def z(name: str) -> np.ndarray:
        factor = theory.mixture_compressibility_factor
        return np.array([factor(eta, 3, sizes, numbers, name) for eta, sizes, numbers in spheres])

    for name, dashes, title in (("linear", "--", "SYH 1999"), ("santos", "-", "SYH 2002")):
        percent = 100.0 * (z(name) / z("boublik") - 1.0)
        axis.plot(x, percent, dashes, color=style.COLOURS[kind], lw=0.9, label=title if named else None)


def _by_density(axis: Axes, two: Table) -> None:
    half = two[np.isclose(two.size_ratio, 0.5) & np.isclose(two.small_fraction, 0.5)]
    fractions = np.linspace(0.01, 0.46, 60)
    spheres = [(eta, (1.0, 0.5), (0.5, 0.5)) for eta in fractions]
    _both(axis, half.sorted_by("packing_fraction"), "packing_fraction", fractions, spheres)
    style.label_axes(axis, r"packing fraction $\eta$, size ratio 0.5", xlim=(0.0, None))


def _by_polydispersity(axis: Axes, many: Table) -> None:
    spreads = np.linspace(0.0, 0.32, 33)
    etas = many[many.dimension == 3].packing_fraction[:1] if many else []
    spheres = [(eta, relative_radii(500, spread, "lognormal"), None) for eta in etas for spread in spreads]
    _both(axis, many, "polydispersity", spreads, spheres)
    style.label_axes(axis, "polydispersity of the radii")


def _both(axis: Axes, gases: Table, name: str, x: np.ndarray, spheres: Sequence[tuple]) -> None:
    """Draw deviations of spheres and discs against a column, with theories of spheres."""
    for kind, dimension in enumerate((3, 2)):
        part = gases[gases.dimension == dimension] if gases else gases
        if not part:
            continue
        percent = 100.0 * _deviations(part, BASE[dimension])
        style.points(axis, getattr(part, name), percent, kind=kind, label=SHORT[dimension])
        if dimension == 3:
            _curves(axis, x, spheres, kind)
    axis.axhline(0.0, color=style.GREY, lw=0.8)
    style.label_axes(axis, y=r"$Z/Z_\mathrm{theory}-1$ (%)", legend="best")


def _pairs(axis: Axes, two: Table, name: str, predicted: Callable[..., np.ndarray]) -> None:
    """Draw a property of each pair of species against the size ratio, for half of small spheres."""
    gases = _most_frequent(two, 3)
    gases = gases[np.isclose(gases.small_fraction, 0.5)]
    if not gases:
        return
    eta = gases.packing_fraction[0]
    for dashes, kind, title in (("-", "boublik", "BMCSL"), ("--", "santos", "SYH 2002")):
        curves = np.array([predicted(eta, 3, (1.0, q), (0.5, 0.5), theory=kind) for q in RATIOS])
        for n, (i, j) in enumerate(PAIRS.values()):
            label = title if n == 0 else None
            axis.plot(RATIOS, curves[:, i, j], dashes, color=style.COLOURS[n], lw=0.9, label=label)
    for n, pair in enumerate(gases.pair):
        style.points(axis, gases.size_ratio, getattr(gases, name)[:, n], kind=n, label=pair)
    style.label_axes(axis, r"size ratio $\sigma_2/\sigma_1$", legend="best")


FIGURES = {"mixture_state": Parts({}, measure, claims, draw, key=4)}
