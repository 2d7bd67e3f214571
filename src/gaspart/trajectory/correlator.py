"""Time correlations, accumulated while a run goes on, so that its frames need not be kept for them.

Exact: every pair of samples up to a largest lag counts, in double precision. For the largest lag L of K
velocity components the memory is that of L + 1 samples, and a sample costs about L K additions.
"""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from gaspart.errors import SceneError
from gaspart.scene.scene import Scene
from gaspart.scene.validation import count_of, number
from gaspart.simulation import Simulation
from gaspart.state.tally import ACTION, HEAT

SUMS = {
    "velocity_product_sum": "v(0).v(t)",
    "squared_displacement_sum": "|r(t) - r(0)|^2",
    "displacement_velocity_sum": "(r(t) - r(0)).(v(t) + v(0))",
}
"""Sums over pairs of samples, by lag, of means over particles."""
STRESS = {"shear": ACTION, "bulk": ACTION, "heat": HEAT}
"""What is correlated of the stress tensor and the heat flux, with the units of its time integral G: the mean
over the components that shear, a d-th of the trace, and the mean over the components of the heat flux."""
_PREFIX = "correlator "  # of its arrays in a checkpoint


@dataclass(frozen=True)
class Correlations:
    """Which time correlations a run accumulates.

    interval: time between two samples; lags: the largest lag, in intervals; start: time of the first sample,
    an integer multiple of the interval; stress: of the stress tensor and the heat flux, not of velocities.
    Raises SceneError for other values.
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
        """The number of the first sample, in intervals from time 0."""
        return round(self.start / self.interval)

    def to_json(self) -> str:
        """Its form in the attributes of a file."""
        return json.dumps({key: value for key, value in asdict(self).items() if value is not False})

    @classmethod
    def from_json(cls, text: str) -> Correlations:
        """The inverse of `to_json`. Raises SceneError, and TypeError or ValueError for another text."""
        return cls(**json.loads(text))


def sums_of(displacements: bool) -> list[str]:
    """The names of the sums of a run with or without displacements."""
    return [name for name in SUMS if displacements or "displacement" not in name]


def stress_sums() -> list[str]:
    """The names of the sums of a run that correlates the stress tensor and the heat flux."""
    return [f"{name}_{kind}_sum" for name in STRESS for kind in ("product", "square")]


def stress_units() -> dict[str, str]:
    """The units of these."""
    units = {f"{name}_square_sum": f"({unit})^2" for name, unit in STRESS.items()}
    return units | {f"{name}_product_sum": f"({unit})^2/time^2" for name, unit in STRESS.items()}


def meaning_of(name: str) -> str:
    """What a sum adds up."""
    if name in SUMS:
        return f"mean over moving particles of {SUMS[name]}"
    group, kind = name.split("_")[:2]
    product = "J(0) J(t), J = dG/dt over an interval" if kind == "product" else "(G(t) - G(0))^2"
    return f"{product}, G the time integral of the volume times the {group} flux"


class _Sums:
    """Sums over all pairs of samples of K components, up to a largest lag of slots - 1.

    positioned: whether a sample has positions beside velocities (2, K), or not (1, K).
    """

    def __init__(self, positioned: bool, components: int, slots: int) -> None:
        self.earlier = np.zeros((2 if positioned else 1, components, slots))
        self.sums = np.zeros((3 if positioned else 1, slots))
        self.samples = 0

    def add(self, now: np.ndarray, terms: int) -> None:
        """The next sample; its products, summed over components, are divided by `terms`."""
        from gaspart.kernels.correlation import add_displacement_products, add_velocity_products

        slots = self.earlier.shape[2]
        slot, used = self.samples % slots, min(self.samples + 1, slots)
        self.earlier[:, :, slot] = now
        added = np.zeros_like(self.sums)
        add_products = add_displacement_products if len(now) > 1 else add_velocity_products
        add_products(self.earlier, now, used, added)
        lags = (slot - np.arange(used)) % slots
        self.sums[:, lags] += added[:, :used] / terms
        self.samples += 1

    def arrays(self, prefix: str = _PREFIX) -> dict[str, Any]:
        """All that a continuation needs."""
        arrays = {"samples": np.array(self.samples), "earlier": self.earlier, "sums": self.sums}
        return {prefix + name: values for name, values in arrays.items()}

    def restore(self, arrays: dict[str, np.ndarray], prefix: str = _PREFIX) -> None:
        """Continue from these."""
        self.samples = int(arrays[prefix + "samples"])
        self.earlier[...] = arrays[prefix + "earlier"]
        self.sums[...] = arrays[prefix + "sums"]


class Correlator:
    """Correlations of the motion of the particles.

    Velocities and positions of the moving particles count, relative to those of the centre of mass along
    axes where its velocity is conserved: periodic ones, if no particle is fixed.

    masses: (N,), infinite for fixed particles; displacements: whether positions are correlated too. Raises
    SceneError if no particle moves.
    """

    def __init__(self, settings: Correlations, scene: Scene, masses: np.ndarray, displacements: bool) -> None:
        self._moving = np.isfinite(masses)
        if not self._moving.any():
            raise SceneError("correlations", scene.count, "no particle moves")
        weights = masses[self._moving]
        self._weights = (weights / weights.sum())[:, None]
        self._conserved = np.array(scene.container.periodic) & self._moving.all()
        self._positioned = displacements
        self._sums = _Sums(displacements, self._moving.sum() * scene.dimension, settings.lags + 1)
        self.interval, self._first = settings.interval, settings.first

    @property
    def next(self) -> int:
        """The number of the next sample, in intervals from time 0."""
        return self._first + self._sums.samples

    def add(self, simulation: Simulation) -> None:
        """The next sample."""
        state = simulation.state
        values = (state.velocities, state.unwrapped) if self._positioned else (state.velocities,)
        self._sums.add(np.array([self._relative(each) for each in values]), self._moving.sum())

    def _relative(self, values: np.ndarray) -> np.ndarray:
        """(M d,) values (N, d) of the moving particles relative to the centre of mass."""
        values = values[self._moving]
        centre = (values * self._weights).sum(axis=0)
        return (values - np.where(self._conserved, centre, 0.0)).ravel()

    def sums(self) -> dict[str, np.ndarray | float]:
        """The sums of `SUMS` so far, (lags + 1,) each, and the number of samples."""
        named = zip(SUMS, self._sums.sums, strict=False)
        return {"correlated_samples": float(self._sums.samples), **dict(named)}

    def checkpoint(self) -> dict[str, Any]:
        """Arrays from which `restore` continues to the same bits."""
        return self._sums.arrays()

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        """Continue from a checkpoint of a correlator of the same settings."""
        self._sums.restore(arrays)


class StressCorrelator:
    """Correlations of the stress tensor and the heat flux, each the mean over an interval: with its impulses,
    which last no time, it is finite so. The first sample gives no mean and does not count."""

    def __init__(self, settings: Correlations, dimension: int) -> None:
        components = {"shear": dimension * (dimension + 1) // 2 - 1, "bulk": 1, "heat": dimension}
        self._sums = {name: _Sums(True, number, settings.lags + 1) for name, number in components.items()}
        self._latest = np.zeros(dimension * dimension + dimension)
        self._begun = False
        self.interval, self._first = settings.interval, settings.first

    @property
    def next(self) -> int:
        """The number of the next sample, in intervals from time 0."""
        return self._first + self._begun + self._sums["bulk"].samples

    def add(self, simulation: Simulation) -> None:
        """The next sample. Raises ValueError for a simulation without a tally of the stress."""
        tally = simulation.tally
        if tally.stress_sum is None or tally.heat_sum is None:
            raise ValueError("the tally has no stress tensor")
        moments = np.concatenate([tally.stress_sum.ravel(), tally.heat_sum])
        if self._begun:
            flux, now = _parts((moments - self._latest) / self.interval), _parts(moments)
            for name, sums in self._sums.items():
                sums.add(np.array([flux[name], now[name]]), len(now[name]))
        self._latest[...], self._begun = moments, True

    def sums(self) -> dict[str, np.ndarray | float]:
        """The sums of `stress_sums` so far, (lags + 1,) each, and the number of samples."""
        rows = [row for sums in self._sums.values() for row in sums.sums[:2]]
        named = zip(stress_sums(), rows, strict=True)
        return {"correlated_samples": float(self._sums["bulk"].samples), **dict(named)}

    def checkpoint(self) -> dict[str, Any]:
        """Arrays from which `restore` continues to the same bits."""
        parts = {_PREFIX + "latest": self._latest, _PREFIX + "begun": np.array(self._begun)}
        for name, sums in self._sums.items():
            parts |= sums.arrays(f"{_PREFIX}{name} ")
        return parts

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        """Continue from a checkpoint of a correlator of the same settings."""
        self._latest[...], self._begun = arrays[_PREFIX + "latest"], bool(arrays[_PREFIX + "begun"])
        for name, sums in self._sums.items():
            sums.restore(arrays, f"{_PREFIX}{name} ")


def _parts(moments: np.ndarray) -> dict[str, np.ndarray]:
    """The components of each of `STRESS`, from a tensor (d, d), by rows, and a vector (d,).

    In an isotropic fluid the differences of normal stresses fluctuate as the off-diagonal components do.
    """
    d = 2 if len(moments) == 6 else 3
    tensor = moments[: d * d].reshape(d, d)
    normal = np.diag(tensor)
    upper = np.triu_indices(d, 1)
    shear = [*(0.5 * (tensor + tensor.T)[upper]), 0.5 * (normal[0] - normal[1])]
    if d == 3:
        shear.append((normal[0] + normal[1] - 2.0 * normal[2]) / (2.0 * math.sqrt(3.0)))
    return {"shear": np.array(shear), "bulk": normal.mean(keepdims=True), "heat": moments[d * d :]}
