"""Steps of a scene: the default, the longest, and their division if speeds rise."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaspart.engines.dsmc.cells import LONGEST, falling_axis
from gaspart.errors import SceneError, SimulationError
from gaspart.scene.scene import Scene
from gaspart.state.state import State
from gaspart.theory.rates import Rates, highest_speed, rates

if TYPE_CHECKING:
    from gaspart.engines.dsmc.settings import DsmcSettings
    from gaspart.kernels.dsmc.model import Pace


# Length of a step for a scene, for any speeds that its particles reach.
#
# A step is short enough under two conditions. A particle of the mean speed flies at most 0.2 mean free paths
# and at most half of the container. Gravity and kicks do not accelerate it beyond these distances during the
# step. If speeds can rise, a default step is divided into 2^level parts. The level is the smallest at which
# the present speeds satisfy these conditions within a factor sqrt 2. The level is determined again before
# each part. It depends only on the state, so results do not depend on where a run is split. A prescribed step
# is never divided. The run stops before a step in which particles would collide with more than `MOST` others.


CROSSED = 0.5
"""Longest step in a gas without collisions, as a fraction of the time in which a particle crosses the
container.
"""
_DIGITS = 2.0**10  # parts to which a step is rounded, so that it does not depend on the rounding of sums
FALLEN = 0.125
"""Maximum fall per step, as a fraction of the container's length along gravity."""
MOST = 1024.0
"""Maximum distance that a particle of the mean speed may fly in a step, in mean free paths or in distances
between walls.
"""
FINEST = 40
"""Largest level of the division of a step."""
ROOM = math.sqrt(2.0)
"""Ratio of a step to the recommended step above which the step is divided."""
_HOTTER = 2.0
"""Largest ratio of initial speeds to the scene's own initial speeds at which steps are not adapted.

Steps that are not adapted are then too long by at most this factor, which changes transport coefficients by 1
%.
"""
_KICKED = 0.09
"""Width of the kicks in a step divided by the mean speed, unless a step has at most one kick.

Kicks are applied at the end of a step. The energy there exceeds its time average by half of the energy of the
kicks, at most 0.35 %.
"""
_FIRST = 20
"""Level to which steps are divided at a start from rest, even if a part then has several kicks."""


@dataclass(frozen=True)
class Reach:
    """Bounds on the distance that a particle flies in a step."""

    path: float
    across: float
    fall: float
    walled: float
    pull: float
    push: float
    interval: float

    @property
    def recommended(self) -> float:
        """Longest recommended flight distance in a step."""
        return min(LONGEST * self.path, CROSSED * self.across, FALLEN * self.fall)

    @property
    def most(self) -> float:
        """Longest allowed flight distance in a step."""
        return MOST * min(self.path, self.walled)

    def steady(self) -> bool:
        """Return True if nothing accelerates the particles."""
        return self.pull == 0.0 and self.push == 0.0

    def way(self, speed: float, step: float) -> float:
        """Return an upper estimate of the distance that a particle flies in a step."""
        return (speed + self.pull * step + self.push * math.sqrt(step)) * step

    def speed(self, way: float, step: float) -> float:
        """Return the initial speed with which a particle flies a given distance in a step."""
        return way / step - self.pull * step - self.push * math.sqrt(step)

    def longest(self, speed: float, way: float) -> float:
        """Return the longest step in which a particle flies at most a given distance."""
        low, high = -300.0, 300.0  # bisection in log2 of the step
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.way(speed, 2.0**middle) <= way else (low, middle)
        return 2.0**low


def reach_of(scene: Scene, path: float) -> Reach:
    """Return the bounds on flight distances in a scene, for a mean free path."""
    lengths, periodic = scene.container.lengths, scene.container.periodic
    walled = [length for length, around in zip(lengths, periodic, strict=True) if not around]
    pull = [g for g, around in zip(scene.gravity or (), periodic, strict=False) if not around]
    push, interval = 0.0, math.inf
    if scene.thermostat is not None and scene.count:
        light = sum(kind.count / math.sqrt(kind.mass) for kind in scene.kinds) / scene.count
        push, interval = math.sqrt(2.0 * scene.thermostat.power) * light, scene.thermostat.interval
    axis = falling_axis(scene)
    fall = math.inf if axis is None else lengths[axis]
    return Reach(path, min(lengths), fall, min(walled, default=math.inf), math.hypot(*pull), push, interval)


def may_speed_up(scene: Scene) -> bool:
    """Return True if the mean speed can rise so much that steps must be adapted."""
    if scene.gravity is not None or scene.thermostat is not None or scene.faces or scene.rough:
        return True
    return highest_speed(scene) > ROOM * rates(scene, False).speed


def is_hotter(state: State, gas_rates: Rates) -> bool:
    """Return True if the initial state is so fast that steps must be adapted."""
    velocities = state.velocities[np.isfinite(state.masses)]
    if not len(velocities):
        return False
    apart = velocities - velocities.mean(axis=0)
    return float(np.sqrt((apart**2).sum(axis=1)).mean()) > _HOTTER * gas_rates.speed


def levels(reach: Reach, step: float, divided: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return lowest and highest mean speed for each level of a step, (levels,): one level if it is not
    divided.
    """
    if not divided:
        return np.zeros(1), np.array([reach.speed(reach.most, step)])
    steps = [math.ldexp(step, -level) for level in range(FINEST + 1)]
    several = [part > reach.interval and level < _FIRST for level, part in enumerate(steps)]
    kicked = [
        reach.push * math.sqrt(part) / _KICKED * many for many, part in zip(several, steps, strict=True)
    ]
    return np.array(kicked), np.array([reach.speed(ROOM * reach.recommended, part) for part in steps])


def pace_for(
    scene: Scene, reach: Reach, step: float, divided: bool, present: np.ndarray | None = None
) -> Pace:
    """Return the levels of a step as the kernels' `Pace`. `present`: see `kernels.dsmc.model.Faces`."""
    from gaspart.kernels.dsmc import model as pace

    pulls = scene.gravity or (0.0,) * scene.dimension
    drifts = tuple(around and g != 0.0 for around, g in zip(scene.container.periodic, pulls, strict=True))
    return pace.Pace(*levels(reach, step, divided), 0, drifts, np.zeros(1), present)


_TOO_LONG = f"lets particles fly more than {MOST:g} mean free paths, or {MOST:g} times from wall to wall"


def check_step(reach: Reach, step: float, gas_rates: Rates) -> None:
    """Raise SceneError for a step in which a particle would collide, or fly from wall to wall, more than
    `MOST` times.
    """
    if reach.way(gas_rates.speed, step) > reach.most:
        fit = reach.longest(gas_rates.speed, reach.most)
        raise SceneError("time_step", step, f"{_TOO_LONG}: {fit:.2g} at most")


def too_fast(time: float, step: float, reach: Reach, pace: Pace) -> SimulationError:
    """Return the error for particles that are too fast for all levels."""
    if len(pace.low) > 1:
        rule = f"at time {time:g} the speeds have risen so much that a step needs more than 2^{FINEST} parts"
        return SimulationError(f"{rule}: give a shorter time_step")
    fit = reach.longest(float(pace.fastest[0]), reach.most)
    return SimulationError(f"at time {time:g} time_step = {step:g} {_TOO_LONG}: {fit:.2g} would do")


def step_for(engine: DsmcSettings, scene: Scene, gas_rates: Rates) -> float:
    """Return the length of a step, set or recommended; SceneError if nothing moves."""
    if engine.time_step is not None:
        return engine.time_step
    reach = reach_of(scene, gas_rates.path)
    if reach.steady():
        if not gas_rates.speed > 0.0:
            raise SceneError("time_step", None, "must be given for particles that start at rest, and stay")
        crossing = min(scene.container.lengths) / gas_rates.speed
        free = 1.0 / gas_rates.frequency if gas_rates.frequency > 0.0 else math.inf
        longest = min(LONGEST * free, CROSSED * crossing)
    else:
        longest = reach.longest(gas_rates.speed, reach.recommended)
    fraction, exponent = math.frexp(longest)
    return math.ldexp(round(fraction * _DIGITS) / _DIGITS, exponent)
