"""Time correlations that are accumulated during a run, without stored frames.

The correlation functions include all pairs of samples up to a largest lag, in double precision. With a
largest lag of L samples and with K velocity components, L + 1 samples are in memory, and each new sample
costs about L K additions.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import asdict, dataclass
from itertools import combinations_with_replacement
from typing import Any

import numpy as np

from gaspart.errors import SceneError
from gaspart.keys.values import count_of, number
from gaspart.scene.scene import Scene
from gaspart.simulation import Simulation
from gaspart.state.optional_tallies import OptionalTally
from gaspart.state.tally import ACTION, HEAT, StressTally

SUMS = {
    "velocity_product_sum": "v(0).v(t)",
    "squared_displacement_sum": "|r(t) - r(0)|^2",
    "displacement_velocity_sum": "(r(t) - r(0)).(v(t) + v(0))",
}
"""Averages over particles that are summed over pairs of samples, separately for each lag."""
STRESS = {"shear": ACTION, "rotational": ACTION, "collisional": ACTION, "bulk": ACTION, "heat": HEAT}
"""Correlated components of stress tensor and heat flux, with the units of their time integrals G.

The fluxes are: the mean over the shear components of the symmetric part; the mean over the components of the
antisymmetric part; the mean over the shear components of the collisional part; 1/d of the trace; and the mean
over the components of the heat flux.
"""
CORRELATED = {
    "product": "J(0) J(t), J = dG/dt over an interval",
    "square": "(G(t) - G(0))^2",
    "ends": "(J(0) + J(t)) / 2, J = dG/dt over an interval",
    "change": "G(t) - G(0)",
}
"""Terms summed over pairs of samples; the last two only for `bulk`, whose mean is not zero."""
_PREFIX = "correlator "  # prefix of its arrays in a checkpoint


@dataclass(frozen=True)
class Correlations:
    """Time correlations that a run accumulates.

    Parameters
    ----------
    interval : float, [time]
        Time between two samples.
    lags : int
        Largest lag, in intervals.
    start : float, default 0.0, [time]
        Time of the first sample; must be an integer multiple of `interval`.
    stress : bool, default False
        Correlate the stress tensor and the heat flux instead of the velocities.

    Examples
    --------
    >>> import gaspart as gp
    >>> gp.Correlations(interval=0.1, lags=100, start=2.0).first
    20
    """

    interval: float
    lags: int
    start: float = 0.0
    stress: bool = False

    def __post_init__(self) -> None:
        interval = number("correlations.interval", self.interval, "must be positive", above=0.0)
        start = number("correlations.start", self.start, "must not be negative", least=0.0)
        object.__setattr__(self, "interval", interval)
        object.__setattr__(self, "start", start)
        object.__setattr__(self, "lags", count_of("correlations.lags", self.lags, least=1))

    @property
    def first(self) -> int:
        """Index of the first sample, in intervals from time 0."""
        return round(self.start / self.interval)

    @property
    def tallies(self) -> tuple[OptionalTally, ...]:
        """Optional tallies that the correlations need."""
        return (StressTally(),) if self.stress else ()

    def to_json(self) -> str:
        """Return the settings as text for the attributes of a file.

        Returns
        -------
        str
            JSON of the settings.
        """
        return json.dumps({key: value for key, value in asdict(self).items() if value is not False})

    @classmethod
    def from_json(cls, text: str) -> Correlations:
        """Return the correlations that a text describes, the inverse of `to_json`.

        Parameters
        ----------
        text : str
            JSON of the settings.

        Returns
        -------
        Correlations
            The correlations.
        TypeError, ValueError
            If the text does not describe correlations.
        """
        return cls(**json.loads(text))


def sums_of(displacements: bool) -> list[str]:
    """Return the names of the sums of a run with or without displacements."""
    return [name for name in SUMS if displacements or "displacement" not in name]


def stress_sums() -> list[str]:
    """Return the names of the sums of a run that correlates stress and heat flux."""
    means = [f"bulk_{kind}_sum" for kind in ("ends", "change")]
    return [f"{name}_{kind}_sum" for name in STRESS for kind in ("product", "square")] + means


def sum_names(settings: Correlations, displacements: bool) -> list[str]:
    """Return the names of the sums of a run with these correlations, with or without displacements."""
    return stress_sums() if settings.stress else sums_of(displacements)


def stress_units() -> dict[str, str]:
    """Return the units of the sums of the stress tensor and the heat flux, by name."""
    units = {f"{name}_square_sum": f"({unit})^2" for name, unit in STRESS.items()}
    units |= {"bulk_ends_sum": f"{ACTION}/time", "bulk_change_sum": ACTION}
    return units | {f"{name}_product_sum": f"({unit})^2/time^2" for name, unit in STRESS.items()}


def meaning_of(name: str) -> str:
    """Return a description of the terms in a sum."""
    if name in SUMS:
        return f"mean over moving particles of {SUMS[name]}"
    group, kind = name.split("_")[:2]
    return f"{CORRELATED[kind]}, G the time integral of the volume times the {group} flux"


class _Correlator:
    """Sums over all pairs of samples up to a largest lag, the last axis of `earlier` and `sums`."""

    def __init__(self, settings: Correlations, earlier: tuple[int, ...], sums: tuple[int, ...]) -> None:
        self._earlier = np.zeros((*earlier, settings.lags + 1))
        self._sums = np.zeros((*sums, settings.lags + 1))
        self.interval, self._first, self._samples = settings.interval, settings.first, 0

    @property
    def next(self) -> int:
        """Index of the next sample, in intervals from time 0."""
        return self._first + self._samples

    def _add(self, now: np.ndarray, add_products: Callable[..., None], terms: float | np.ndarray) -> None:
        """Add the products of the next sample and the earlier samples, divided by `terms`."""
        slots = self._earlier.shape[-1]
        slot, used = self._samples % slots, min(self._samples + 1, slots)
        self._earlier[..., slot] = now
        added = np.zeros_like(self._sums)
        add_products(self._earlier, now, used, added)
        lags = (slot - np.arange(used)) % slots
        self._sums[..., lags] += added[..., :used] / terms
        self._samples += 1

    def checkpoint(self) -> dict[str, Any]:
        """Return arrays from which `restore` continues bitwise identically."""
        arrays = {"samples": np.array(self._samples), "earlier": self._earlier, "sums": self._sums}
        return {_PREFIX + name: values for name, values in arrays.items()}

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        """Continue from the checkpoint of a correlator with the same settings."""
        self._samples = int(arrays[_PREFIX + "samples"])
        self._earlier[...] = arrays[_PREFIX + "earlier"]
        self._sums[...] = arrays[_PREFIX + "sums"]


class Correlator(_Correlator):
    """Correlations of the motion of the particles. Velocities and positions of all moving particles are used.
    Along axes with conserved momentum (`Scene.conserved_axes`), they are relative to the centre of mass. If
    faces slide, their mean velocity is subtracted. The subtraction of the motion of the centre of mass
    multiplies the mean square for a particle of mass m by 1 - m / M, where M is the total mass. If masses
    differ, or if momentum is not conserved along all axes, components are rescaled so that the factor is 1 -
    1 / N for all N particles and all axes.
    """

    def __init__(self, settings: Correlations, scene: Scene, masses: np.ndarray, displacements: bool) -> None:
        self._moving = np.isfinite(masses)
        if not self._moving.any():
            raise SceneError("correlations", scene.count, "no particle moves")
        weights = masses[self._moving]
        self._weights = (weights / weights.sum())[:, None]
        self._conserved = np.array(scene.conserved_axes)
        self._frame = np.array(scene.frame_velocity)
        self._scale = _scale(self._weights, self._conserved)
        self._positioned = displacements
        components = self._moving.sum() * scene.dimension
        earlier = (2 if displacements else 1, components)
        super().__init__(settings, earlier, (len(sums_of(displacements)),))

    def add(self, simulation: Simulation) -> None:
        """Add the next sample."""
        from gaspart.kernels.correlation import add_displacement_products, add_velocity_products

        state = simulation.state
        values = [state.velocities, state.unwrapped] if self._positioned else [state.velocities]
        if self._frame.any():
            drifts = self._frame, self._frame * state.time
            values = [value - drift for value, drift in zip(values, drifts, strict=False)]
        now = np.array([self._relative(each) for each in values])
        products = add_displacement_products if self._positioned else add_velocity_products
        self._add(now, products, self._moving.sum())

    def _relative(self, values: np.ndarray) -> np.ndarray:
        """Return values (M d,) of moving particles, from (N, d), relative to the centre of mass."""
        values = values[self._moving]
        centre = (values * self._weights).sum(axis=0)
        return (self._scale * (values - np.where(self._conserved, centre, 0.0))).ravel()

    def sums(self) -> dict[str, np.ndarray | float]:
        """Return the sums of `SUMS` so far, (lags + 1,) each, and the number of samples."""
        named = zip(SUMS, self._sums, strict=False)
        return {"correlated_samples": float(self._samples), **dict(named)}


def _scale(weights: np.ndarray, conserved: np.ndarray) -> np.ndarray:
    """Return rescaling factors (M, d) relative to the centre of mass; `weights` (M, 1) are parts of the total
    mass.
    """
    count = len(weights)
    if count < 2 or not conserved.any():
        return np.ones((count, len(conserved)))
    lower = 1.0 - 1.0 / count
    relative = 1.0 if np.ptp(weights) == 0.0 else np.sqrt(lower / (1.0 - weights))
    return np.where(conserved, relative, math.sqrt(lower)) * np.ones((count, 1))


class StressCorrelator(_Correlator):
    """Correlations of the stress tensor and the heat flux, after both are averaged over an interval. The
    stress is averaged because impulses are instantaneous, while their mean over an interval is finite. The
    first sample is not counted, because there is no interval before it.
    """

    def __init__(self, settings: Correlations, dimension: int) -> None:
        shear = dimension * (dimension + 1) // 2 - 1
        turning = dimension * (dimension - 1) // 2
        number = [shear, turning, shear, 1, dimension]  # numbers of components, as in STRESS
        self._groups = np.repeat(np.arange(len(STRESS)), number)
        self._terms = np.array(number, dtype=float)[:, None, None]
        self._dimension, self._latest, self._begun = dimension, np.zeros(len(self._groups)), False
        super().__init__(settings, (2, len(self._groups)), (len(STRESS), len(CORRELATED)))

    @property
    def next(self) -> int:
        return super().next + self._begun

    def add(self, simulation: Simulation) -> None:
        """Add the next sample from a simulation that tallies the stress."""
        from gaspart.kernels.correlation import add_flux_products, flux_components

        integrals = np.empty_like(self._latest)
        flux_components(simulation.sums_of(StressTally.name), self._dimension, integrals)
        if self._begun:
            now = np.array([(integrals - self._latest) / self.interval, integrals])

            def add(earlier: np.ndarray, now: np.ndarray, used: int, sums: np.ndarray) -> None:
                add_flux_products(earlier, now, self._groups, used, sums)

            self._add(now, add, self._terms)
        self._latest, self._begun = integrals, True

    def sums(self) -> dict[str, np.ndarray | float]:
        """Return the sums of `stress_sums` so far, (lags + 1,) each, and the number of samples."""
        groups, kinds = list(STRESS), list(CORRELATED)
        parts = ((name, *name.split("_")[:2]) for name in stress_sums())
        named = {name: self._sums[groups.index(group), kinds.index(kind)] for name, group, kind in parts}
        return {"correlated_samples": float(self._samples), **named}

    def checkpoint(self) -> dict[str, Any]:
        begun = {_PREFIX + "latest": self._latest, _PREFIX + "begun": np.array(self._begun)}
        return {**super().checkpoint(), **begun}

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        super().restore(arrays)
        self._latest, self._begun = arrays[_PREFIX + "latest"].copy(), bool(arrays[_PREFIX + "begun"])


def correlator_for(
    settings: Correlations, simulation: Simulation, displacements: bool
) -> Correlator | StressCorrelator:
    """Return the correlator of a run with these settings."""
    if settings.stress:
        return StressCorrelator(settings, simulation.scene.dimension)
    return Correlator(settings, simulation.scene, simulation.initial_state.masses, displacements)


# Collisions of each pair of species, counted from recorded events.


_NAME = "pair collisions"  # name of the array in a checkpoint


def pairs_of(scene: Scene) -> list[tuple[int, int]]:
    """Return the pairs of species by index, the lower first; SceneError for single particles."""
    if scene.particles:
        raise SceneError(
            "particles", len(scene.particles), "excludes pairs, which are counted for species only"
        )
    return list(combinations_with_replacement(range(len(scene.species)), 2))


def pair_names(scene: Scene) -> list[str]:
    """Return the names of the pairs of species, such as "0-1"."""
    return [f"{first}-{second}" for first, second in pairs_of(scene)]


class PairCounter:
    """Numbers of collisions of each pair of species since time 0, from recorded events.

    counts : (pairs,), in the order of `pairs_of`.
    """

    def __init__(self, simulation: Simulation) -> None:
        scene = simulation.scene
        pairs, kinds = pairs_of(scene), len(scene.species)
        self._number = np.zeros((kinds, kinds), dtype=np.int64)
        for n, (first, second) in enumerate(pairs):
            self._number[first, second] = self._number[second, first] = n
        self._species = np.repeat(np.arange(kinds), [kind.count for kind in scene.species])
        self.counts = np.zeros(len(pairs))
        self._simulation = simulation
        simulation.record_events = True

    def take(self) -> None:
        """Count the events since the last call, and discard them."""
        particles = self._simulation.events["particles"]
        # only pairs, without hits of faces and walls
        species = self._species[particles[particles[:, 1] >= 0]]
        numbers = self._number[species[:, 0], species[:, 1]]
        self.counts += np.bincount(numbers, minlength=len(self.counts))
        self._simulation.record_events = True  # start a new, empty list

    def checkpoint(self) -> dict[str, np.ndarray]:
        """Return arrays from which `restore` continues."""
        return {_NAME: self.counts}

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        """Continue from a checkpoint."""
        self.counts = arrays[_NAME].copy()
