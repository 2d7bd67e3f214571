"""Choice of engine and settings: parts of the error, and cost of an accuracy."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gaspart import theory

QUANTILE = 1.96
"""Half width of a 95 % interval, in standard errors. Figures compare engines at an accuracy that 95 % of all
runs have."""
ENGINES = ("event", "step", "boltzmann", "enskog")
"""Engines that are compared; the last two are the models of the DSMC engine."""
PARTS = ("model", "discretisation", "noise", "equilibration", "finite_size")
"""Parts of an error, from the bottom of a stacked bar; the parts that add up to the accuracy come first."""


@dataclass(frozen=True)
class Choice:
    """Engine with its settings, for one observable of one gas.

    model : bound on the relative error of the equation that the engine solves.
    discretisation : bound on the relative error of time steps and cells.
    finite_size : error that remains after theory's correction for the number of particles. It is the same for
        every engine and run length.
    unit : CPU time in s for a relative variance of 1; the time is inversely proportional to the variance.
    least : CPU time of the shortest run that averages over time.
    equilibration : CPU time before the measurement.
    decay : CPU time in which the slowest trace of the initial state falls to 1/e; 0 if this decay itself is
        measured.
    trace : maximum relative change of the observable by this trace, initially.
    uncertainty : relative uncertainty of all these times, from the timings.
    """

    engine: str
    model: float
    discretisation: float
    finite_size: float
    unit: float
    least: float
    equilibration: float
    decay: float
    trace: float
    uncertainty: float

    @property
    def bias(self) -> float:
        """Systematic error, which a longer run does not reduce."""
        return self.model + self.discretisation

    def measuring_time(self, accuracy: float) -> float:
        """Compute the CPU time in s of the measurement alone, for an accuracy.

        95 % of all runs have the accuracy. The time is infinite if the systematic error exceeds the accuracy.
        """
        return required_length(self.unit, accuracy, self.bias, self.least)

    def cost(self, accuracy: float) -> float:
        """Compute the CPU time in s for an accuracy, including the equilibration."""
        return self.measuring_time(accuracy) + self.equilibration

    def parts(self, accuracy: float) -> dict[str, float]:
        """Compute the relative error by `PARTS` of a run for an accuracy.

        If the accuracy is out of reach, the run is infinitely long.

        The trace of the initial state decays during the measurement. Its mean is the decay time divided by
        the time of the measurement, times the trace that remains after equilibration.
        """
        length = self.measuring_time(accuracy)
        remainder = 0.0
        if self.decay and math.isfinite(length):
            remainder = self.trace * math.exp(-self.equilibration / self.decay) * self.decay / length
        noise = QUANTILE * math.sqrt(self.unit / length)
        return dict(
            zip(PARTS, (self.model, self.discretisation, noise, remainder, self.finite_size), strict=True)
        )


def required_length(variance: float, accuracy: float, bias: float, least: float = 0.0) -> float:
    """Return the length of the measurement for an accuracy that 95 % of all runs have.

    It is at least `least`. A measurement of unit length has the given relative variance. The length is inf if
    the bias exceeds the accuracy.
    """
    margin = (accuracy - bias) / QUANTILE
    return max(variance / margin**2, least) if margin > 0.0 else math.inf


def cheapest(choices: Sequence[Choice], accuracy: float) -> Choice:
    """Return the cheapest choice for an accuracy.

    If no choice reaches the accuracy, the least biased choice is returned.
    """
    return min(choices, key=lambda choice: (choice.cost(accuracy), choice.bias))


# Theoretical time in which equal speeds relax to Maxwell's distribution.


FREE_TIMES = 2.5
"""Mean free times over which the relaxation of speeds is integrated."""


def relaxation_time(slower: float) -> float:
    """Compute the relaxation time of a gas whose collisions are rarer by a factor.

    The speeds follow the homogeneous Boltzmann equation.
    """
    times = np.linspace(0.0, FREE_TIMES / slower, 251)
    curve = theory.relaxation(3)
    end = theory.kurtosis(3)
    remainder = (end - curve.kurtosis(curve.collisions(times))) / (end - 1.0)
    return float(np.trapezoid(remainder, times) * slower)
