"""A choice of engine and settings: what makes its error, and what a required accuracy costs with it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

QUANTILE = 1.96
"""Half of a 95 % interval, in standard errors: figures compare engines at an accuracy of 95 % of all runs."""
ENGINES = ("event", "step", "boltzmann", "enskog")
"""The engines that are compared; the last two are the models of the DSMC engine."""
PARTS = ("model", "discretisation", "noise", "equilibration", "finite_size")
"""What makes an error, in the order in which it is stacked: first what adds up to the required accuracy."""


@dataclass(frozen=True)
class Choice:
    """One engine with its settings, for one observable of one gas.

    model: relative error of the equation that it solves; discretisation: that of time steps and cells, both
    bounds without sign; finite_size: what theory's correction for the number of particles leaves, which every
    engine has in common and no cost removes. Of processor time, in s: unit, for a relative variance of 1, in
    proportion to its inverse; least, of the shortest run that averages over time;
    equilibration, before anything is measured; decay, in which the slowest trace of the initial state falls
    to 1/e (0: it is itself what is measured). trace: how much that trace changes the
    observable at first, relatively, at most. uncertainty: relative, of all these times, from the timings.
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

    def measured(self, accuracy: float) -> float:
        """Processor time in s of the measurement alone, for an accuracy that 95 % of all runs have; infinite
        if the systematic error leaves no room for noise."""
        return required(self.unit, accuracy, self.bias, self.least)

    def cost(self, accuracy: float) -> float:
        """Processor time in s, with the equilibration."""
        return self.measured(accuracy) + self.equilibration

    def parts(self, accuracy: float) -> dict[str, float]:
        """The relative error by `PARTS` of a run for an accuracy, of an endless run if it is out of reach.

        The mean of the initial state's trace over the measurement is the part of the decay in that, times
        what the equilibration has left of it.
        """
        length = self.measured(accuracy)
        left = 0.0
        if self.decay and math.isfinite(length):
            left = self.trace * math.exp(-self.equilibration / self.decay) * self.decay / length
        noise = QUANTILE * math.sqrt(self.unit / length)
        return dict(zip(PARTS, (self.model, self.discretisation, noise, left, self.finite_size), strict=True))


def required(variance: float, accuracy: float, bias: float, least: float = 0.0) -> float:
    """Return how much is measured for an accuracy that 95 % of all runs have, `least` at least.

    The unit is that in which a measurement has this relative variance; inf if the bias leaves no room.
    """
    left = (accuracy - bias) / QUANTILE
    return max(variance / left**2, least) if left > 0.0 else math.inf


def cheapest(choices: Sequence[Choice], accuracy: float) -> Choice:
    """Return the choice that costs least, or the least biased one where none reaches the accuracy."""
    return min(choices, key=lambda one: (one.cost(accuracy), one.bias))
