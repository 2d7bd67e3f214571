"""Equal cells along one or more axes, and sums over particles in them: the one histogram of the analysis."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True)
class Grid:
    """Cells between `lower` (A,) and `upper` (A,), as many along each axis as `numbers` (A,) states."""

    lower: tuple[float, ...]
    upper: tuple[float, ...]
    numbers: tuple[int, ...]

    @classmethod
    def line(cls, lower: float, upper: float, number: int) -> Grid:
        """Cells along one axis."""
        return cls((float(lower),), (float(upper),), (int(number),))

    @cached_property
    def size(self) -> int:
        """The number of cells."""
        return math.prod(self.numbers)

    @property
    def edges(self) -> list[np.ndarray]:
        """Of the cells along each axis, (cells + 1,)."""
        sides = zip(self.lower, self.upper, self.numbers, strict=True)
        return [np.linspace(low, high, number + 1) for low, high, number in sides]

    @property
    def middles(self) -> list[np.ndarray]:
        """Of the cells along each axis, (cells,)."""
        return [0.5 * (edge[1:] + edge[:-1]) for edge in self.edges]

    @property
    def volume(self) -> float:
        """Of one cell, along its axes."""
        sides = zip(self.lower, self.upper, self.numbers, strict=True)
        return math.prod((high - low) / number for low, high, number in sides)

    def cells(self, places: np.ndarray, inside: bool = False) -> np.ndarray:
        """(...) the number of the cell at each place (..., A), -1 outside and at none (NaN). The upper end
        belongs to the last cell. inside: what rounding put outside counts to the nearest cell."""
        shape = np.shape(places)[:-1]
        found, outside = np.zeros(shape, dtype=np.int64), np.zeros(shape, dtype=bool)
        for k, (low, high, number) in enumerate(zip(self.lower, self.upper, self.numbers, strict=True)):
            x = places[..., k].astype(float)
            outside |= np.isnan(x)
            cell = np.floor((np.nan_to_num(x) - low) * (number / (high - low)))
            if not inside:
                outside |= (x < low) | (x > high)
            found = found * number + np.clip(cell, 0, number - 1).astype(np.int64)
        return np.where(outside, -1, found)

    def sums(
        self,
        cells: np.ndarray,
        weights: np.ndarray | None = None,
        blocks: np.ndarray | None = None,
    ) -> np.ndarray:
        """(*numbers) the sum of weights, or the number of particles, in each cell.

        cells: as of `cells`; weights: of a shape that extends to that of cells. blocks: the number of the
        block of each row (T,) of cells (T, ...): the sums are those of each block, (blocks, *numbers).
        """
        number = 1 if blocks is None else int(blocks.max(initial=-1)) + 1
        slot = cells
        if blocks is not None:
            slot = cells + self.size * blocks.reshape(-1, *[1] * (cells.ndim - 1))
        slot = np.where(cells < 0, number * self.size, slot).ravel()
        spread = None if weights is None else np.broadcast_to(weights, cells.shape).ravel()
        found = np.bincount(slot, spread, minlength=number * self.size + 1)[:-1]
        return found.reshape(self.numbers if blocks is None else (number, *self.numbers))
