"""The lengths of a step that fit a scene, whatever speeds its particles come to.

A step is short enough if a particle of the mean speed flies at most 0.2 mean free paths and half of the
container in it, and no faster by what gravity and kicks give it in the step. Where speeds can rise, an own
step is divided into 2^level parts, as many as the present speeds require to within a factor sqrt 2. The level
is found again before each part; it follows from the state, and so do all bits. A step that was given is never
divided: the run stops before one in which particles would meet more than `MOST` others.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaspart.engines.dsmc.rates import Rates, highest_speed, rates
from gaspart.errors import SceneError, SimulationError
from gaspart.scene.scene import Scene
from gaspart.state.state import State

if TYPE_CHECKING:
    from gaspart.kernels.dsmc.pace import Pace

LONGEST = 0.2
"""The longest step that is recommended, in mean free times."""
CROSSED = 0.5
"""Of the time that a particle takes to cross the container: the longest step in a gas without collisions."""
FALLEN = 0.125
"""Of the container's length along the way that particles fall: the longest way in a step."""
MOST = 1024.0
"""Mean free paths, or crossings between walls, that a particle of the mean speed may make in a step."""
FINEST = 40
"""The highest level."""
ROOM = math.sqrt(2.0)
"""By so much a step may be longer than recommended before it is divided."""
_HOTTER = 2.0
"""By so much a given state may be faster than the scene's own: steps are then too long by as much, which
changes coefficients by 1 %."""
_KICKED = 0.09
"""Of the mean speed: the width of the kicks of a step, unless a step has one kick at most. They come at its
end, and the energy there is above its mean over time by half of what they give, 0.35 % at most."""
_FIRST = 20
"""The level of parts that are as short as a start from rest needs, however many kicks are due in one."""


@dataclass(frozen=True)
class Reach:
    """Bounds of the way of a particle in a step. path: the mean free path; across: the shortest side;
    fall: that between walls along which particles fall; walled: the shortest side between walls; pull: the
    acceleration towards walls; push: the mean width of kicks over the square root of time; interval: between
    kicks."""

    path: float
    across: float
    fall: float
    walled: float
    pull: float
    push: float
    interval: float

    @property
    def recommended(self) -> float:
        """The longest way that is."""
        return min(LONGEST * self.path, CROSSED * self.across, FALLEN * self.fall)

    @property
    def most(self) -> float:
        """The longest way that is possible."""
        return MOST * min(self.path, self.walled)

    def steady(self) -> bool:
        """Whether nothing accelerates the particles."""
        return self.pull == 0.0 and self.push == 0.0

    def way(self, speed: float, step: float) -> float:
        """How far a particle flies in a step."""
        return (speed + self.pull * step + self.push * math.sqrt(step)) * step

    def speed(self, way: float, step: float) -> float:
        """The speed at which it flies that far."""
        return way / step - self.pull * step - self.push * math.sqrt(step)

    def longest(self, speed: float, way: float) -> float:
        """The longest step in which it flies no farther."""
        low, high = -300.0, 300.0  # of the logarithm to base 2; the way grows with the step
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.way(speed, 2.0**middle) <= way else (low, middle)
        return 2.0**low


def reach_of(scene: Scene, path: float) -> Reach:
    """The bounds of a scene, for a mean free path."""
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


def falling_axis(scene: Scene) -> int | None:
    """The axis between walls along which gravity is strongest, if any."""
    periodic = scene.container.periodic
    pulls = [0.0 if around else abs(g) for g, around in zip(scene.gravity or (), periodic, strict=False)]
    return pulls.index(max(pulls)) if any(pulls) else None


def may_speed_up(scene: Scene) -> bool:
    """Whether the mean speed can come to be so much above that of the start that steps must follow it."""
    if scene.gravity is not None or scene.thermostat is not None or scene.faces or scene.rough:
        return True
    return highest_speed(scene) > ROOM * rates(scene, False).speed


def is_hotter(state: State, found: Rates) -> bool:
    """Whether a state that was given is so much faster than the scene's own, about its mean velocity, that
    steps must follow its speeds."""
    velocities = state.velocities[np.isfinite(state.masses)]
    if not len(velocities):
        return False
    apart = velocities - velocities.mean(axis=0)
    return float(np.sqrt((apart**2).sum(axis=1)).mean()) > _HOTTER * found.speed


def levels(reach: Reach, step: float, divided: bool) -> tuple[np.ndarray, np.ndarray]:
    """The lowest and the highest mean speed (levels,) that fit each level of a step; only one level if it is
    not divided."""
    if not divided:
        return np.zeros(1), np.array([reach.speed(reach.most, step)])
    steps = [math.ldexp(step, -level) for level in range(FINEST + 1)]
    several = [part > reach.interval and level < _FIRST for level, part in enumerate(steps)]
    kicked = [
        reach.push * math.sqrt(part) / _KICKED * many for many, part in zip(several, steps, strict=True)
    ]
    return np.array(kicked), np.array([reach.speed(ROOM * reach.recommended, part) for part in steps])


def pace_for(scene: Scene, reach: Reach, step: float, divided: bool) -> Pace:
    """The kernels' form of it."""
    from gaspart.kernels.dsmc import pace

    pulls = scene.gravity or (0.0,) * scene.dimension
    drifts = tuple(around and g != 0.0 for around, g in zip(scene.container.periodic, pulls, strict=True))
    return pace.Pace(*levels(reach, step, divided), 0, drifts, np.zeros(1))


_TOO_LONG = f"lets particles fly more than {MOST:g} mean free paths, or {MOST:g} times from wall to wall"


def check_step(reach: Reach, step: float, found: Rates) -> None:
    """Raise SceneError for a step in which particles would meet more than `MOST` others, or cross the
    container more often between walls."""
    if reach.way(found.speed, step) > reach.most:
        fit = reach.longest(found.speed, reach.most)
        raise SceneError("time_step", step, f"{_TOO_LONG}: {fit:.2g} at most")


def too_fast(time: float, step: float, reach: Reach, pace: Pace) -> SimulationError:
    """The error for particles that have become so fast that no level fits."""
    if len(pace.low) > 1:
        rule = f"at time {time:g} the speeds have risen so much that a step needs more than 2^{FINEST} parts"
        return SimulationError(f"{rule}: give a shorter time_step")
    fit = reach.longest(float(pace.fastest[0]), reach.most)
    return SimulationError(f"at time {time:g} time_step = {step:g} {_TOO_LONG}: {fit:.2g} would do")
