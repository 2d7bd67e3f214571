"""Choice of engine and settings: parts of its error, and cost of an accuracy."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gaspart import theory

QUANTILE = 1.96
"""Half of a 95 % interval, in standard errors: figures compare engines at an accuracy of 95 % of all runs."""
ENGINES = ("event", "step", "boltzmann", "enskog")
"""The engines that are compared; the last two are the models of the DSMC engine."""
PARTS = ("model", "discretisation", "noise", "equilibration", "finite_size")
"""Parts of an error, in the order of the stack: first those that add up to the accuracy."""


@dataclass(frozen=True)
class Choice:
    """Engine with its settings, for one observable of one gas.

    model : relative error of the equation that it solves.
    discretisation : relative error of time steps and cells; both are bounds without sign.
    finite_size : error left by theory's correction for the number of particles, which every engine has in
        common and no cost removes.
    unit : CPU time in s for a relative variance of 1, in proportion to its inverse.
    least : CPU time of the shortest run that averages over time.
    equilibration : CPU time before anything is measured.
    decay : CPU time in which the slowest trace of the initial state falls to 1/e (0: it is itself what is
        measured).
    trace : maximum relative change of the observable by that trace at first.
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
        """The systematic error that a longer run does not reduce."""
        return self.model + self.discretisation

    def measuring_time(self, accuracy: float) -> float:
        """Compute the CPU time in s of the measurement alone, for an accuracy.

        95 % of all runs have the accuracy. The time is infinite if the systematic error leaves nothing for
        noise.
        """
        return required_length(self.unit, accuracy, self.bias, self.least)

    def cost(self, accuracy: float) -> float:
        """Compute the CPU time in s, with the equilibration."""
        return self.measuring_time(accuracy) + self.equilibration

    def parts(self, accuracy: float) -> dict[str, float]:
        """Compute the relative error by `PARTS` of a run for an accuracy.

        The run is endless if the accuracy is out of reach.

        The mean of the initial state's trace over the measurement is the part of the decay in that, times the
        remainder after equilibration.
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

    It is at least `least`. The unit is that in which a measurement has this relative variance; inf if the
    bias leaves no noise.
    """
    margin = (accuracy - bias) / QUANTILE
    return max(variance / margin**2, least) if margin > 0.0 else math.inf


def cheapest(choices: Sequence[Choice], accuracy: float) -> Choice:
    """Return the choice that costs least, or the least biased one where none reaches the accuracy."""
    return min(choices, key=lambda choice: (choice.cost(accuracy), choice.bias))


# The time in which speeds that are equal at first become Maxwell's, by theory.


FREE_TIMES = 2.5
"""Mean free times over which the relaxation of speeds is integrated."""


def relaxation_time(slower: float) -> float:
    """Compute the relaxation time of a gas with collisions rarer by a factor.

    Its speeds follow the homogeneous Boltzmann equation.
    """
    times = np.linspace(0.0, FREE_TIMES / slower, 251)
    curve = theory.relaxation(3)
    end = theory.kurtosis(3)
    remainder = (end - curve.kurtosis(curve.collisions(times))) / (end - 1.0)
    return float(np.trapezoid(remainder, times) * slower)
