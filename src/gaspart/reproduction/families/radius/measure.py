r"""Cost and Z at several radii, for one packing fraction and one number of particles.

Predicted counts (periodic container of side L, n boxes of width w = L/n a side, N particles):

- crossings of the boundaries between boxes, per particle and time, from kinetic theory (exact):
  :math:`d\, \langle |v_x| \rangle (n-1)/L = d \sqrt{2 k_B T / (\pi m)}\,(n-1)/(n w)`, since the periodic face
  of the container, one of the n boundaries of an axis, is counted apart;
- the time-stepped engine's pair tests per particle and step, each pair in neighbouring boxes once: half
  of the other particles in the 3^d boxes around a particle, which hold the fraction f of the volume:
  :math:`\tfrac12 [f N + (S - 1) - f S]`, S = S(0) the structure factor at zero wave number,
  :math:`1/S = d(\eta Z)/d\eta`: :math:`\rho \int (g - 1) = S - 1` is the hole that a particle makes around
  itself, and -f S what the others make up for because their number is fixed. Holds if correlations end
  within w;
- per collision, everything depends on the packing fraction and the boxes per particle alone: a larger
  radius in the same container is the same gas magnified. There remain terms of order 1/N, and of order
  1/n at the periodic faces.
"""

from __future__ import annotations

import math
from typing import Any

import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import average, correlated_mean
from gaspart.reproduction.families.shared.pressure import Series, combine, series_of, totals
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import table
from gaspart.scene.scene import Scene


def radius_grid(points: list[Point], settings: dict) -> xr.Dataset:
    """Return Z and the counted work of periodic points, of both engines.

    An experiment whose points have one packing fraction is the series "packing fraction", else "count".

    Returns over `point`: series, engine ("event" or "step"), radius, count, packing_fraction, boxes_per_side.
    Event-driven points: Z, Z_error (corrected to the infinite system), finite_size, reference and its error;
    crossings, per particle and time over the kinetic theory's, and its error; pair_tests, box_visits and
    crossings_counted, per collision; crossings_expected, the same from kinetic theory and Enskog's rate.
    Time-stepped points: pair_tests and box_visits per particle and step, pair_tests_expected. NaN elsewhere.
    """
    experiments = {point.experiment for point in points}
    fixed = {
        name: len({round(p.scene.packing_fraction, 9) for p in points if p.experiment == name}) == 1
        for name in experiments
    }
    series = ["packing fraction" if fixed[point.experiment] else "count" for point in points]
    return table("point", points, _row).assign(
        series=("point", series),
        engine=("point", [point.settings.get("engine", "event") for point in points]),
    )


def _row(point: Point) -> dict[str, Any]:
    scene, engine = point.scene, point.engine
    per_side = getattr(engine, "boxes_per_side", None)
    assert isinstance(per_side, tuple), "every point of this figure gives its boxes"
    eta, dimension = scene.packing_fraction, scene.dimension
    row: dict[str, Any] = {
        "radius": scene.largest_radius,
        "count": scene.count,
        "packing_fraction": eta,
        "boxes_per_side": per_side[0],
    }
    replicas = [series_of(run) for run in runs(point)]
    counted = totals(replicas)
    if point.settings.get("engine") == "step":
        searches = counted["steps"] * scene.count
        return row | {
            "pair_tests": counted["pair_tests"] / searches,
            "box_visits": counted["box_visits"] / searches,
            "pair_tests_expected": expected_pair_tests(scene.count, per_side[0], eta, dimension),
        }
    z = combine(replicas).z
    shift = float(theory.finite_size_correction(eta, dimension, scene.count, ensemble="canonical"))
    width = scene.container.lengths[0] / per_side[0] / (2.0 * scene.largest_radius)
    return row | {
        "Z": z - shift,
        "crossings": _crossings(replicas, scene, per_side[0]),
        "finite_size": shift,
        "reference": (
            float(theory.compressibility_factor(eta, dimension)),
            float(theory.compressibility_uncertainty(eta, dimension)),
        ),
        "collisions": counted["collisions"],
        "pair_tests": counted["pair_tests"] / counted["collisions"],
        "box_visits": counted["box_visits"] / counted["collisions"],
        "crossings_counted": counted["crossings"] / counted["collisions"],
        "crossings_expected": crossings_per_collision(eta, width, per_side[0], dimension),
    }


def _crossings(replicas: list[Series], scene: Scene, per_side: int) -> Estimate:
    """Compute crossings per particle and time over the kinetic theory's."""
    between = scene.dimension * (per_side - 1) / scene.container.lengths[0] * math.sqrt(2.0 / math.pi)
    between *= scene.count
    ratios = [
        series.counters["crossings"] / (series.interval * between * series.speed) for series in replicas
    ]
    return average([correlated_mean(ratio).estimate for ratio in ratios])


def crossings_per_collision(packing_fraction: float, width: float, per_side: int, dimension: int) -> float:
    """Compute the crossed boundaries between boxes for each collision.

    The width of a box is in diameters. It is 2 d sqrt(2 / pi) (n - 1) / (n w nu), nu Enskog's rate of one
    particle with k_B T = m = sigma = 1.
    """
    rate = float(theory.collision_rate(packing_fraction, dimension))
    return 2.0 * dimension * math.sqrt(2.0 / math.pi) * (per_side - 1) / (per_side * width * rate)


def expected_pair_tests(count: int, per_side: int, packing_fraction: float, dimension: int) -> float:
    """Compute the pair tests per particle and step of the time-stepped engine.

    The container is periodic (see the module).
    """
    share = (3.0 / per_side) ** dimension if per_side > 3 else 1.0
    compressibility = float(theory.reduced_compressibility(packing_fraction, dimension))
    return 0.5 * (share * count + (compressibility - 1.0) - share * compressibility)
