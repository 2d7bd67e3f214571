"""What the module of a figure needs: the parts of a figure, and averages over blocks with errors."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import jackknife
from gaspart.keys import Kind


@dataclass(frozen=True)
class Parts:
    """The parts of a figure: the settings of its config entry, and three functions.

    measure(points, settings) returns the data set, claims(dataset) its claims, draw(dataset) the picture.
    """

    settings: dict[str, Kind]
    measure: Callable[..., Any]
    claims: Callable[..., Iterable[Any]]
    draw: Callable[..., Any]


class Blocks:
    """Averages over independent blocks; a call returns a function of the means with its jackknife error.

    Each block is a tuple of numbers or arrays, which are the arguments of the function.
    """

    def __init__(self, blocks: Iterable[tuple]) -> None:
        self._series = [np.array(series) for series in zip(*blocks, strict=True)]

    def __call__(self, function: Callable[..., Any]) -> Estimate:
        """Return a function of the means with its error."""
        value, error = jackknife(function, *self._series)
        return Estimate(value, error, len(self._series[0]) - 1)
