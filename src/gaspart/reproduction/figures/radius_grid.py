r"""Cost and Z at several radii, at one packing fraction or for one number of particles, by both engines.

Counts are predicted for N particles in a periodic container of side L, with n boxes of width w = L/n a side:

- crossings of the boundaries between boxes, per particle and time. Kinetic theory predicts exactly
  :math:`d\, \langle |v_x| \rangle (n-1)/L = d \sqrt{2 k_B T / (\pi m)}\,(n-1)/(n w)`. The factor
  n - 1 occurs because the periodic face, one of the n boundaries of an axis, is counted separately.
- pair tests of the time-stepped engine, per particle and step: half the other particles in the 3^d boxes
  around a particle, as each pair is tested once. Let f be the fraction of the volume in these boxes, and
  S = S(0) the structure factor at zero wave number, :math:`1/S = d(\eta Z)/d\eta`. The prediction is
  :math:`\tfrac12 [f N + (S - 1) - f S]`. The integral :math:`\rho \int (g - 1) = S - 1` is the hole around
  a particle; -f S compensates for it, because the number of particles is fixed. The prediction holds if the
  range of correlations is below w.
- counts per collision depend only on the packing fraction and the boxes per particle, because a larger radius
  is a change of the unit of length, up to order 1/N, and 1/n at the periodic faces.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis import statistics
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import average, correlated_mean, fit_power_law
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import Parts, Series, combine, runs, series_of, totals
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, table
from gaspart.scene.scene import Scene

TITLE, CHAPTER = "Equation of state", "Equation of state and structure"
ETA, COUNT = "packing fraction", "count"  # what is constant in a series


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure Z of event-driven points, and counted operations of both engines, with predictions. Counts are
    per collision (event-driven), or per particle and step; `crossings` is per particle and time, over kinetic
    theory.
    """
    etas: dict[str, set[float]] = {}
    for point in points:
        etas.setdefault(point.experiment, set()).add(round(point.scene.packing_fraction, 9))
    return table("point", points, _row).assign(
        series=("point", [ETA if len(etas[point.experiment]) == 1 else COUNT for point in points]),
        engine=("point", [point.settings.get("engine", "event") for point in points]),
    )


def _row(point: Point) -> dict[str, Any]:
    scene = point.scene
    per_side = getattr(point.engine, "boxes_per_side", None)
    assert isinstance(per_side, tuple), "every point of this figure gives its boxes"
    side, eta, dimension = per_side[0], scene.packing_fraction, scene.dimension
    row: dict[str, Any] = {"radius": scene.largest_radius, "count": scene.count}
    row |= {"packing_fraction": eta, "boxes_per_side": side}
    replicas = [series_of(run) for run in runs(point)]
    counted = totals(replicas)
    is_step = point.settings.get("engine") == "step"
    number = counted["steps"] * scene.count if is_step else counted["collisions"]
    row |= {name: counted[name] / number for name in ("pair_tests", "box_visits")}
    if is_step:
        return row | {"pair_tests_expected": expected_pair_tests(scene.count, side, eta, dimension)}
    shift = float(theory.finite_size_correction(eta, dimension, scene.count, ensemble="canonical"))
    width = scene.container.lengths[0] / side / (2.0 * scene.largest_radius)
    stated = theory.compressibility_factor(eta, dimension), theory.compressibility_uncertainty(eta, dimension)
    return row | {
        "Z": combine(replicas).z - shift,
        "crossings": _crossings(replicas, scene, side),
        "finite_size": shift,
        "reference": (float(stated[0]), float(stated[1])),
        "collisions": counted["collisions"],
        "crossings_counted": counted["crossings"] / number,
        "crossings_expected": crossings_per_collision(eta, width, side, dimension),
    }


def _crossings(replicas: list[Series], scene: Scene, per_side: int) -> Estimate:
    between = scene.dimension * (per_side - 1) / scene.container.lengths[0] * math.sqrt(2.0 / math.pi)
    between *= scene.count
    ratios = [one.counters["crossings"] / (one.interval * between * one.speed) for one in replicas]
    return average([correlated_mean(ratio).estimate for ratio in ratios])


def crossings_per_collision(packing_fraction: float, width: float, per_side: int, dimension: int) -> float:
    """Compute 2 d sqrt(2 / pi) (n - 1) / (n w nu), with the width w of a box in diameters. Here nu is
    Enskog's collision rate of a particle with k_B T = m = sigma = 1.
    """
    rate = float(theory.collision_rate(packing_fraction, dimension))
    return 2.0 * dimension * math.sqrt(2.0 / math.pi) * (per_side - 1) / (per_side * width * rate)


def expected_pair_tests(count: int, per_side: int, packing_fraction: float, dimension: int) -> float:
    """Compute the pair tests per particle and step of the time-stepped engine (see the module)."""
    share = (3.0 / per_side) ** dimension if per_side > 3 else 1.0
    compressibility = float(theory.reduced_compressibility(packing_fraction, dimension))
    return 0.5 * (share * count + (compressibility - 1.0) - share * compressibility)


def _series(dataset: xr.Dataset) -> tuple[Table, Table]:
    gases = Table(dataset, "point")
    return gases[gases.engine == "event"], gases[gases.engine == "step"]


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield claims that Z depends on the packing fraction alone, and that costs are those predicted."""
    event, step = _series(dataset)
    same, other = event[event.series == ETA], event[event.series == COUNT]
    ratios = step.pair_tests / step.pair_tests_expected
    yield _same_state(same)
    yield Claim.joint(
        f"Z of N = {other.count[0]:.0f} at all radii against the equation of state",
        (other.Z - other.reference).deviation, "[Kolafa 2004], shifted to first order in 1/N",
        "Z is biased at some radius",
    )  # fmt: skip
    yield Claim.joint(
        "crossings of box boundaries per particle and time over d <|v_x|> (n-1)/L, all radii",
        (event.crossings - 1.0).deviation, "kinetic theory, exact in equilibrium",
        "crossings are missed or counted twice, or velocities are not Maxwellian",
    )  # fmt: skip
    yield Claim.within(
        "exponent of the event-driven engine's pair tests per collision, "
        "against the radius at one packing fraction",
        fit_power_law(same.radius, same.pair_tests).estimate, 0.0, 0.05,
        "scale invariance: the same gas, enlarged, except for periodic images (order 1/n)",
        "the cost of a collision depends on the number of particles",
    )  # fmt: skip
    yield Claim.within(
        "pair tests per particle and step over those expected, time-stepped, mean over all radii",
        Estimate(ratios.mean(), ratios.std(ddof=1) / np.sqrt(ratios.size)), 1.0, 0.01,
        "half of the particles in 3^d boxes, minus the hole that each makes: "
        "f N + (S - 1) - f S, 1/S = d(eta Z)/d eta",
        "pairs are tested twice or missed, or particles are kept in wrong boxes",
    )  # fmt: skip


def _same_state(same: Table) -> Claim:
    """Return the claim that values of Z at one packing fraction agree; theory is the 1/N correction alone."""
    mean, radii, counts = statistics.combine(same.Z), same.radius, same.count
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


RADIUS = "radius (container: side 16)"


def draw(dataset: xr.Dataset) -> Figure:
    """Draw Z, its residuals, and counted operations, against the radius."""
    figure, (upper, middle, lower) = style.new((2.2, 1.2), (2.8,))
    event, step = (part.sorted_by("radius") for part in _series(dataset))
    style.band(middle, -3.0, 3.0)
    style.level(middle, 0.0)
    widest = 0.0
    for kind, name in enumerate((ETA, COUNT)):
        own, steps = event[event.series == name], step[step.series == name]
        _z(upper, own, kind, name)
        deviation = own.Z - own.reference
        sigmas = deviation.value / deviation.error
        widest = max(widest, *np.abs(sigmas))
        style.points(middle, own.radius, sigmas, np.ones(sigmas.size), kind=kind)
        style.points(lower, own.radius, own.pair_tests, kind=kind)
        style.points(lower, own.radius, own.crossings_counted, kind=kind, hollow=True)
        lower.plot(own.radius, own.crossings_expected, color=style.COLOURS[kind])
        style.points(lower, steps.radius, steps.pair_tests, kind=kind, marker="x")
        lower.plot(steps.radius, steps.pair_tests_expected, color=style.COLOURS[kind], linestyle="--")
    style.label_axes(upper, y="compressibility factor $Z$", legend="upper left")
    half = max(4.0, widest + 1.5)
    style.label_axes(middle, RADIUS, "$(Z-Z_\\mathrm{ref})/\\sigma$", ylim=(-half, half))
    style.label_axes(lower, RADIUS, "counted work", yscale="log", ylim=(0.2, 6e2))
    highest = 1.2 * event.pair_tests.max()
    above = {
        "event-driven: pair tests per collision": highest,
        "time-stepped: pair tests per particle and step": min(1.25 * step.pair_tests.max(), 0.4 * highest),
        "event-driven: boundaries crossed per collision": 0.23,
    }
    for text, height in above.items():
        lower.text(0.97, height, text, transform=lower.get_yaxis_transform(), ha="right", va="bottom")
    style.letters(upper, middle, lower)
    return figure


def _z(axis: Axes, own: Table, kind: int, name: str) -> None:
    radius, eta, number = own.radius, own.packing_fraction, own.count
    fine = np.linspace(radius[0], radius[-1], 200)
    if name == COUNT:
        label = f"$N={number[0]:.0f}$, $\\eta$ = {eta.min():.2g} – {eta.max():.2g}"
        between = eta[0] * (fine / radius[0]) ** 3
    else:
        label = f"$\\eta={eta[0]:g}$, $N$ = {number.min():.0f} – {number.max():.0f}"
        between = np.full(fine.size, eta[0])
    style.points(axis, radius, own.Z, kind=kind, label=label)
    axis.plot(fine, theory.compressibility_factor(between, 3), color=style.COLOURS[kind])


FIGURES = {"radius_grid": Parts({}, measure, claims, draw)}
