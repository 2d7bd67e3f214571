r"""Measurements of random insertion and the densest packings.

Random sequential insertion: failed attempts per particle, and saturation.

With k particles in the container an attempt succeeds with the probability that a random point is free, the
available fraction; failures before the next success are geometric. Time is counted in attempts per volume
of a particle, :math:`t = T v / V` for T attempts. Late insertion fills single small holes, whose sizes are
uniform down to zero, so :math:`\eta_s - \eta(t) \propto t^{-1/d}` (Feder 1980, Swendsen 1981):
a straight line in :math:`t^{-1/d}` leads to the saturation :math:`\eta_s`, although no run ever reaches it.

The densest random packings: packing fractions, and contacts per particle.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from scipy.spatial import cKDTree

from gaspart import theory
from gaspart.analysis.statistics import fit_polynomial, jackknife, mean_of
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import table

SAMPLES = 24
"""Times, equally spaced in ln t, at which a window's line is fitted."""
TIMES = 60
"""Times, equally spaced in ln t, at which the growing packing fraction is kept for the figure."""


@dataclass(frozen=True)
class Fill:
    """All replicas of one container.

    failures : (replica, particle), failures before each particle, -1 for a particle that was never placed.
    attempts : (replica,), all attempts.
    particle : packing fraction of one particle.
    dimension : dimension.
    """

    failures: np.ndarray
    attempts: np.ndarray
    particle: float
    dimension: int

    @property
    def placed(self) -> np.ndarray:
        """(replica,) particles placed."""
        return (self.failures >= 0).sum(axis=1)

    @property
    def last_time(self) -> float:
        """The time t that every replica reached."""
        return float(self.attempts.min()) * self.particle

    def packing_fraction(self, times: np.ndarray) -> np.ndarray:
        """Compute (replica, times): packing fraction at the times t."""
        attempts = times / self.particle
        placed_at = [np.cumsum(series[series >= 0] + 1) for series in self.failures]
        return self.particle * np.array(
            [np.searchsorted(series, attempts, side="right") for series in placed_at]
        )

    def trials(self) -> tuple[np.ndarray, np.ndarray]:
        """Return failures and successes (replica, particle) at each number of particles; zero beyond."""
        successes = (self.failures >= 0).astype(int)
        failures = np.where(self.failures >= 0, self.failures, 0)
        for k, placed in enumerate(self.placed):
            if placed < failures.shape[1]:  # the attempts after the last success belong to the state after it
                failures[k, placed] = self.attempts[k] - failures[k].sum() - placed
        return failures, successes


def fill_failures(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure failures per particle against packing fraction, and saturation, of every container.

    The settings are `bins`, number of packing-fraction bins up to the densest fill; `windows`, list of the
    ratios of the last time to the first one of the fitted window (the first is the one claimed); `saturated`,
    the experiments that are filled to saturation; `dilute`, the packing fraction up to which failures are
    compared with the low-density expansion.

    Returns over `container` (the experiment's name): dimension, side_over_diameter, rule, replicas, placed
    (mean); final and final_spread, mean and standard deviation of the packing fraction of a single fill at
    its end; last_time, in t; failures_per_particle with its error at packing_fraction, each (container, bin),
    NaN without attempts; filled (container, sample), mean packing fraction at `time` (container, sample);
    saturation with its error (container, window) and the degrees of freedom of that (container), NaN for
    others than `saturated` ones, and slope of its line in t^(-1/d); approach and its error: exponent p of
    eta_s - eta ~ t^-p with the literature's eta_s (saturated periodic containers only); dilute_failures with
    error, failures over the expected ones at low density (periodic containers only). Attribute dilute_up_to.
    """
    inner = {
        **dict.fromkeys(("packing_fraction", "failures_per_particle"), ("bin",)),
        **dict.fromkeys(("time", "filled"), ("sample",)),
        **dict.fromkeys(("saturation", "saturation_slope"), ("window",)),
    }
    units = dict.fromkeys(("time", "last_time"), "attempts v / V")
    dataset = table("container", points, _container, settings, inner=inner, units=units)
    windows = np.array(settings["windows"], dtype=float)
    return dataset.assign_coords(window=windows).assign_attrs(dilute_up_to=settings["dilute"])


def _container(point: Point, settings: dict) -> dict[str, Any]:
    fill, windows, absent = _read(point), settings["windows"], (np.nan, np.nan)
    saturates, periodic = point.experiment in settings["saturated"], point.scene.container.periodic[0]
    eta, failures, error = failures_by_density(fill, settings["bins"])
    ends = [saturation(fill, window) if saturates else (*absent, np.nan) for window in windows]
    end, end_error, slope = np.transpose(ends)
    times = np.geomspace(1.0, max(fill.last_time, 1.0), TIMES)
    final = fill.placed * fill.particle
    return {
        "container": point.experiment if point.name == "single" else f"{point.experiment}/{point.name}",
        "dimension": fill.dimension,
        "side_over_diameter": min(point.extents[2]) / (2.0 * point.extents[1]),
        "rule": _rule(point),
        "replicas": len(fill.attempts),
        "placed": fill.placed.mean(),
        "final": final.mean(),
        "final_spread": final.std(ddof=1),
        "last_time": fill.last_time,
        "packing_fraction": eta,
        "failures_per_particle": (failures, error),
        "time": times,
        "filled": fill.packing_fraction(times).mean(axis=0),
        "saturation": (end, end_error),
        "saturation_freedom": len(fill.attempts) - 1,
        "saturation_slope": slope,
        "approach": approach_exponent(fill, windows[0]) if saturates and periodic else absent,
        "dilute_failures": dilute_failures(fill, settings["dilute"]) if periodic else absent,
    }


def _read(point: Point) -> Fill:
    with xr.open_dataset(point.path) as dataset:
        return Fill(
            failures=dataset["failures"].values.astype(np.int64),
            attempts=dataset["attempts"].values.astype(np.int64),
            particle=float(dataset.attrs["packing_fraction_per_particle"]),
            dimension=point.settings["dimension"],
        )


def _rule(point: Point) -> str:
    if point.scene.container.periodic[0]:
        return "periodic"
    return "centres_to_walls" if point.settings.get("centres_to_walls", False) else "wall"


def failures_by_density(fill: Fill, bins: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Compute mean packing fraction, failures per particle placed, and their error.

    Each is (bins,). The bins are of equal width from 0 to the densest fill. NaN where less than half of the
    replicas placed a particle: the others are a biased sample. The error is the jackknife over the replicas,
    but no less than the geometric distribution's own scatter.
    """
    failures, successes = fill.trials()
    states = np.arange(failures.shape[1])
    bin_of = np.minimum(states * bins // max(int(fill.placed.max()), 1), bins - 1)
    result = np.full((3, bins), np.nan)
    for k in range(bins):
        lost, won = failures[:, bin_of == k].sum(axis=1), successes[:, bin_of == k].sum(axis=1)
        if 2 * np.count_nonzero(won) < len(won) or not won.sum():
            continue
        ratio = lost.sum() / won.sum()
        tried = (failures + successes)[:, bin_of == k].sum(axis=0) > 0
        own = np.sqrt(ratio * (1.0 + ratio) / won.sum())
        result[:, k] = (
            states[bin_of == k][tried].mean() * fill.particle,
            ratio,
            max(own, _ratio_error(lost, won)),
        )
    return result[0], result[1], result[2]


def _ratio_error(numerator: np.ndarray, denominator: np.ndarray) -> float:
    """Compute the standard error of sum(numerator) / sum(denominator) over replicas.

    It is 0 if undetermined.
    """
    if np.any(denominator == denominator.sum()):  # all successes in one replica: nothing to omit
        return 0.0
    return float(jackknife(lambda lost, won: lost / won, numerator, denominator)[1])


def saturation(fill: Fill, window: float) -> tuple[float, float, float]:
    """Fit the packing fraction at t = infinity, its error from the replicas, and the slope.

    There are at least two replicas.

    A straight line of eta against t^(-1/d), by least squares to SAMPLES times equally spaced in ln t between
    last_time / window and last_time, for each replica.
    """
    times = np.geomspace(fill.last_time / window, fill.last_time, SAMPLES)
    x = times ** (-1.0 / fill.dimension)
    lines = np.array([fit_polynomial(x, eta).values for eta in fill.packing_fraction(times)])
    ends = mean_of(lines[:, 0])
    return ends.value, ends.error, float(lines[:, 1].mean())


def approach_exponent(fill: Fill, window: float) -> tuple[float, float]:
    """Fit p of eta_s - eta ~ t^-p and its standard error (jackknife over replicas).

    eta_s is the literature's.
    """
    times = np.geomspace(fill.last_time / window, fill.last_time, SAMPLES)
    gap = theory.RSA_SATURATION[fill.dimension] - fill.packing_fraction(times)

    def exponent(mean_gap: np.ndarray) -> float:
        if np.any(mean_gap <= 0.0):
            return np.nan
        return -fit_polynomial(np.log(times), np.log(mean_gap)).values[1]

    value, error = jackknife(exponent, gap)
    return float(value), float(error)


def dilute_failures(fill: Fill, up_to: float) -> tuple[float, float]:
    """Compute failures below the packing fraction `up_to`, relative to the expected ones.

    Expected are, for each particle k, the `theory.failures_per_particle` at k particles. The error is the
    geometric distribution's, sqrt(sum of f (1 + f)) over the sum of f.
    """
    failures, _ = fill.trials()
    states = np.arange(failures.shape[1])
    below = (states * fill.particle <= up_to) & (states < fill.placed.min())
    expected = theory.failures_per_particle(states[below] * fill.particle, fill.dimension)
    replicas = len(failures)
    total = replicas * expected.sum()
    if total == 0.0:
        return np.nan, np.nan
    scatter = np.sqrt(replicas * np.sum(expected * (1.0 + expected)))
    return float(failures[:, below].sum() / total), float(scatter / total)


TOUCH = 1e-4
"""Gap, in diameters, up to which two particles of a jammed packing count as touching: contacts that carry the
reduced pressure of 10^6 have gaps of some 10^-6, and few other neighbours are as near."""
BACKBONE = 4
"""Contacts that hold a sphere in place; one with fewer rattles in its cage."""


def densest_fill(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure packing fractions with standard errors over replicas, and contacts.

    Contacts are per sphere where the spheres were grown; the first replica of each packing is returned for
    the picture. Returns a dataset with packing_fraction, error, contacts, contacts_error (packing,), contacts
    of spheres that do not rattle, NaN for insertions; rule (packing,); position (packing, particle, axis),
    radius (packing,), length (packing, axis). freedom are the degrees of freedom of the errors.
    """
    inner = {"position": ("particle", "axis"), "length": ("axis",)}
    units = dict.fromkeys(("position", "radius", "length"), "length")
    return table("packing", points, _packing, inner=inner, units=units)


def _packing(point: Point) -> dict[str, Any]:
    dataset = xr.load_dataset(point.path)
    fractions, positions, radii = (
        dataset[name].values for name in ("packing_fraction", "position", "radius")
    )
    length, compressed = dataset["length"].values, point.settings.get("arrangement") == "compressed"
    rule = "centres_to_walls" if point.settings.get("centres_to_walls") else point.settings["boundary"]
    touching = [np.nan]
    if compressed:
        touching = [contacts(*packing, length) for packing in zip(positions, radii, strict=True)]
    fraction, error = _mean(fractions)
    return {
        "rule": "compressed" if compressed else rule,
        "packing_fraction": fraction,
        "error": error,
        "freedom": max(1, fractions.size - 1),
        "contacts": _mean(np.array(touching)),
        "position": positions[0],
        "radius": float(radii[0]),
        "length": length,
    }


def _mean(values: np.ndarray) -> tuple[float, float]:
    """Compute the mean and its standard error."""
    error = values.std(ddof=1) / np.sqrt(len(values)) if len(values) > 1 else np.nan
    return float(values.mean()), float(error)


def contacts(positions: np.ndarray, radius: float, lengths: np.ndarray) -> float:
    """Count contacts per sphere of a periodic packing (N, 3), among spheres that do not rattle.

    Each of these has at least four contacts with others of them. An isostatic packing has 6, less 6/N.
    """
    tree = cKDTree(positions % lengths, boxsize=lengths)
    pairs = tree.query_pairs(2.0 * radius * (1.0 + TOUCH), output_type="ndarray")
    held = np.ones(len(positions), dtype=bool)
    while True:
        pairs = pairs[held[pairs].all(axis=1)]
        degree = np.bincount(pairs.ravel(), minlength=len(positions))
        loose = held & (degree < BACKBONE)
        if not loose.any():
            return 2.0 * len(pairs) / max(1, int(held.sum()))
        held &= ~loose
