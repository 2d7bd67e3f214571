"""All bodies at one time: what engines take, and give back."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np


@dataclass
class State:
    """All bodies at one time.

    time; positions (N, d), inside the container on periodic axes; velocities (N, d); images (N, d), how
    often each body has crossed the container on periodic axes; radii, masses (N,); species (N,), the index
    of the body's species, explicit bodies counting as one species after the others; lengths (d,).
    """

    time: float
    positions: np.ndarray
    velocities: np.ndarray
    images: np.ndarray
    radii: np.ndarray
    masses: np.ndarray
    species: np.ndarray
    lengths: np.ndarray

    @property
    def count(self) -> int:
        return len(self.positions)

    @property
    def dimension(self) -> int:
        return self.positions.shape[1]

    @property
    def unwrapped(self) -> np.ndarray:
        """(N, d) positions as if periodic axes went on for ever."""
        return self.positions + self.images * self.lengths

    @property
    def momentum(self) -> np.ndarray:
        """(d,) total momentum."""
        return (self.masses[:, None] * self.velocities).sum(axis=0)

    @property
    def kinetic_energy(self) -> float:
        return 0.5 * float(
            (self.masses[:, None] * self.velocities**2).sum()
        )  # not @: BLAS differs by machine

    def copy(self) -> State:
        """A state that shares no array with this one."""
        arrays = {key: value.copy() for key, value in vars(self).items() if isinstance(value, np.ndarray)}
        return replace(self, **arrays)
