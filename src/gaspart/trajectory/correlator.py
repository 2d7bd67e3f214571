"""Time correlations, accumulated while a run goes on, so that its frames need not be kept for them.

Exact: every pair of samples up to a largest lag counts, in double precision. For the largest lag L of K
velocity components the memory is that of L + 1 samples, and a sample costs about L K additions.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from gaspart.errors import SceneError
from gaspart.scene.scene import Scene
from gaspart.scene.validation import count_of, number
from gaspart.state.state import State

SUMS = {
    "velocity_product_sum": "v(0).v(t)",
    "squared_displacement_sum": "|r(t) - r(0)|^2",
    "displacement_velocity_sum": "(r(t) - r(0)).(v(t) + v(0))",
}
"""Sums over pairs of samples, by lag, of means over particles."""
_PREFIX = "correlator "  # of its arrays in a checkpoint


@dataclass(frozen=True)
class Correlations:
    """Which time correlations a run accumulates.

    interval: time between two samples; lags: the largest lag, in intervals; start: time of the first sample,
    an integer multiple of the interval. Raises SceneError for other values.
    """

    interval: float
    lags: int
    start: float = 0.0

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
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> Correlations:
        """The inverse of `to_json`. Raises SceneError, and TypeError or ValueError for another text."""
        return cls(**json.loads(text))


def sums_of(displacements: bool) -> list[str]:
    """The names of the sums of a run with or without displacements."""
    return [name for name in SUMS if displacements or "displacement" not in name]


class Correlator:
    """Sums over all pairs of samples of a run, up to a largest lag.

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
        components, slots = self._moving.sum() * scene.dimension, settings.lags + 1
        self._earlier = np.zeros((2 if displacements else 1, components, slots))
        self._sums = np.zeros((len(sums_of(displacements)), slots))
        self.interval, self._first, self._samples = settings.interval, settings.first, 0

    @property
    def next(self) -> int:
        """The number of the next sample, in intervals from time 0."""
        return self._first + self._samples

    def add(self, state: State) -> None:
        """The next sample."""
        from gaspart.kernels.correlation import add_displacement_products, add_velocity_products

        positioned, slots = len(self._earlier) > 1, self._earlier.shape[2]
        slot, used = self._samples % slots, min(self._samples + 1, slots)
        values = (state.velocities, state.unwrapped) if positioned else (state.velocities,)
        now = np.array([self._relative(each) for each in values])
        self._earlier[:, :, slot] = now
        added = np.zeros_like(self._sums)
        add_products = add_displacement_products if positioned else add_velocity_products
        add_products(self._earlier, now, used, added)
        lags = (slot - np.arange(used)) % slots
        self._sums[:, lags] += added[:, :used] / self._moving.sum()
        self._samples += 1

    def _relative(self, values: np.ndarray) -> np.ndarray:
        """(M d,) values (N, d) of the moving particles relative to the centre of mass."""
        values = values[self._moving]
        centre = (values * self._weights).sum(axis=0)
        return (values - np.where(self._conserved, centre, 0.0)).ravel()

    def sums(self) -> dict[str, np.ndarray | float]:
        """The sums of `SUMS` so far, (lags + 1,) each, and the number of samples."""
        named = zip(SUMS, self._sums, strict=False)
        return {"correlated_samples": float(self._samples), **dict(named)}

    def checkpoint(self) -> dict[str, Any]:
        """Arrays from which `restore` continues to the same bits."""
        arrays = {"samples": np.array(self._samples), "earlier": self._earlier, "sums": self._sums}
        return {_PREFIX + name: values for name, values in arrays.items()}

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        """Continue from a checkpoint of a correlator of the same settings."""
        self._samples = int(arrays[_PREFIX + "samples"])
        self._earlier[...] = arrays[_PREFIX + "earlier"]
        self._sums[...] = arrays[_PREFIX + "sums"]
