r"""Measurements of random insertion and the densest packings.

Random sequential insertion: failed attempts per particle, and saturation.

With k particles in the container, an attempt succeeds with a probability called the available fraction. It is
the probability that a random point is free. The number of failures before the next success has a geometric
distribution. Time is the number of attempts T, as :math:`t = T v / V` with the volume v of a particle and V
of the container. Late particles fill single small holes. The sizes of these holes are uniformly distributed
down to zero, so :math:`\eta_s - \eta(t) \propto t^{-1/d}` (Feder 1980, Swendsen 1981). A straight line in
:math:`t^{-1/d}` is therefore extrapolated to the saturation :math:`\eta_s`, although no run ever reaches it.

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
"""Number of times, equally spaced in ln t, at which the line of a window is fitted."""
TIMES = 60
"""Number of times, equally spaced in ln t, at which the packing fraction is stored for the figure."""


@dataclass(frozen=True)
class Fill:
    """All replicas of one container.

    failures : (replica, particle), number of failures before each particle; -1 for a particle that was never
    placed.
    attempts : (replica,), total number of attempts.
    particle : packing fraction of a single particle.
    dimension : dimension.
    """

    failures: np.ndarray
    attempts: np.ndarray
    particle: float
    dimension: int

    @property
    def placed(self) -> np.ndarray:
        """Number of placed particles, (replica,)."""
        return (self.failures >= 0).sum(axis=1)

    @property
    def last_time(self) -> float:
        """Last time t that every replica reached."""
        return float(self.attempts.min()) * self.particle

    def packing_fraction(self, times: np.ndarray) -> np.ndarray:
        """Compute the packing fraction (replica, times) at given times t."""
        attempts = times / self.particle
        placed_at = [np.cumsum(series[series >= 0] + 1) for series in self.failures]
        return self.particle * np.array(
            [np.searchsorted(series, attempts, side="right") for series in placed_at]
        )

    def trials(self) -> tuple[np.ndarray, np.ndarray]:
        """Return failures and successes (replica, particle) at each particle number; 0 beyond the last."""
        successes = (self.failures >= 0).astype(int)
        failures = np.where(self.failures >= 0, self.failures, 0)
        for k, placed in enumerate(self.placed):
            # attempts after the last success belong to the state after this success
            if placed < failures.shape[1]:
                failures[k, placed] = self.attempts[k] - failures[k].sum() - placed
        return failures, successes


def fill_failures(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure failures per particle against packing fraction, and saturation, of each container.

    The settings are:

    bins : number of bins of packing fraction, up to the densest fill
    windows : list of ratios of last to first time of the fitted window; the first window is claimed
    saturated : experiments that are filled to saturation
    dilute : largest packing fraction at which failures are compared with the low-density expansion

    Variables over `container` (the name of the experiment):

    dimension, side_over_diameter, rule, replicas : properties of the container
    placed : mean number of placed particles
    final, final_spread : mean and standard deviation of the final packing fraction of a single fill
    last_time : last time, in t
    failures_per_particle : with error, at `packing_fraction` (container, bin); NaN if there were no attempts
    filled : mean packing fraction at `time`, over (container, sample)
    saturation, slope : fitted saturation with error; slope of the line in t^(-1/d) (container, window)
    approach : exponent p of eta_s - eta ~ t^-p with error; eta_s is from literature
    dilute_failures : failures divided by the expected failures at low density, with error

    Saturation and slope are NaN except for `saturated` containers. The degrees of freedom of the saturation
    are over container. The approach is only for `saturated` periodic containers, and `dilute_failures` only
    for periodic containers. The attribute is dilute_up_to.
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
    """Compute mean packing fraction, failures per placed particle, and their error, (bins,).

    The bins are of equal width, from 0 to the densest fill. Results are NaN if less than half of the replicas
    placed a particle in the bin, because the others are a biased sample. The error is a jackknife error over
    the replicas. It is at least the scatter of the geometric distribution.
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

    The result is 0 if the error cannot be determined.
    """
    if np.any(denominator == denominator.sum()):  # all successes are in one replica, which cannot be left out
        return 0.0
    return float(jackknife(lambda lost, won: lost / won, numerator, denominator)[1])


def saturation(fill: Fill, window: float) -> tuple[float, float, float]:
    """Fit the packing fraction at t = infinity, its error from the replicas, and the slope.

    At least two replicas are required.

    For each replica, a straight line of eta against t^(-1/d) is fitted by least squares. The fit uses SAMPLES
    times, equally spaced in ln t between last_time / window and last_time.
    """
    times = np.geomspace(fill.last_time / window, fill.last_time, SAMPLES)
    x = times ** (-1.0 / fill.dimension)
    lines = np.array([fit_polynomial(x, eta).values for eta in fill.packing_fraction(times)])
    ends = mean_of(lines[:, 0])
    return ends.value, ends.error, float(lines[:, 1].mean())


def approach_exponent(fill: Fill, window: float) -> tuple[float, float]:
    """Fit p in eta_s - eta ~ t^-p, and its standard error (jackknife over replicas).

    eta_s is the value of the literature.
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
    """Compute failures below the packing fraction `up_to`, divided by the expected failures.

    For each particle k, `theory.failures_per_particle` at k particles is expected. The error follows from the
    geometric distribution: sqrt(sum of f (1 + f)) divided by the sum of f.
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
"""Largest gap, in diameters, between two particles of a jammed packing that count as touching. Contacts at
the reduced pressure 10^6 have gaps of about 10^-6. Few other neighbours are as near as 10^-4."""
BACKBONE = 4
"""Minimum number of contacts of a sphere that is held in place; other spheres rattle in their cages."""


def densest_fill(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure packing fractions with standard errors over replicas, and contacts.

    The result also has the first replica of each packing, for the picture.

    packing_fraction, error : packing fraction with its error, over (packing,)
    contacts, contacts_error : contacts per sphere that does not rattle (packing,); NaN for inserted spheres
    rule : rule of the packing, over (packing,)
    position, radius, length : (packing, particle, axis); (packing,); of the container, (packing, axis)
    freedom : degrees of freedom of the errors
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
    """Compute the mean of values, and its standard error."""
    error = values.std(ddof=1) / np.sqrt(len(values)) if len(values) > 1 else np.nan
    return float(values.mean()), float(error)


def contacts(positions: np.ndarray, radius: float, lengths: np.ndarray) -> float:
    """Count contacts per sphere in a periodic packing (N, 3), for spheres that do not rattle.

    Each of these spheres has at least four contacts with other such spheres. An isostatic packing has 6 - 6/N
    contacts per sphere.
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
