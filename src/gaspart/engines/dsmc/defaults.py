"""Default settings of the engine, and the errors of settings."""

from __future__ import annotations

import math
import operator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaspart.errors import SceneError, SimulationError
from gaspart.scene.scene import Scene
from gaspart.state.boxes import cube_side
from gaspart.state.state import State
from gaspart.theory.discretisation import CELL_VISCOSITY, STEP_COEFFICIENTS
from gaspart.theory.rates import MEAN_SQUARE, Rates, accessible, highest_speed, rates, usual_count

if TYPE_CHECKING:
    from gaspart.engines.dsmc.settings import DSMC
    from gaspart.kernels.dsmc.model import Pace


# Length of a step for a scene, for any speeds that its particles reach.
#
# A step is short enough under two conditions. A particle of the mean speed flies at most 0.2 mean free paths
# and at most half of the container. Gravity and kicks do not accelerate it beyond these distances during the
# step. If speeds can rise, a default step is divided into 2^level parts. The level is the smallest at which
# the present speeds satisfy these conditions within a factor sqrt 2. The level is determined again before
# each part. It depends only on the state, so results do not depend on where a run is split. A prescribed step
# is never divided. The run stops before a step in which particles would collide with more than `MOST` others.


LONGEST = 0.2
"""Longest recommended step in mean free times."""
CROSSED = 0.5
"""Longest step in a gas without collisions, as a fraction of the time in which a particle crosses the
container.
"""
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
    """Bounds on the distance that a particle flies in a step.

    Attributes
    ----------
    path : mean free path
    across : shortest side
    fall : side length between walls along the direction of fall
    walled : shortest distance between two opposite walls
    pull : acceleration by gravity along axes with walls
    push : mean over particles of the width of kicks, divided by the square root of the time
    interval : time between kicks
    """

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


def falling_axis(scene: Scene) -> int | None:
    """Return the axis between walls along which gravity is strongest, or None."""
    periodic = scene.container.periodic
    pulls = [0.0 if around else abs(g) for g, around in zip(scene.gravity or (), periodic, strict=False)]
    return pulls.index(max(pulls)) if any(pulls) else None


def may_speed_up(scene: Scene) -> bool:
    """Return True if the mean speed can rise so much that steps must be adapted."""
    if scene.gravity is not None or scene.thermostat is not None or scene.faces or scene.rough:
        return True
    return highest_speed(scene) > ROOM * rates(scene, False).speed


def is_hotter(state: State, gas_rates: Rates) -> bool:
    """Return True if the initial state is so fast that steps must be adapted.

    The speeds relative to the mean velocity of `state` are compared with the speeds in the scene's own
    initial state.
    """
    velocities = state.velocities[np.isfinite(state.masses)]
    if not len(velocities):
        return False
    apart = velocities - velocities.mean(axis=0)
    return float(np.sqrt((apart**2).sum(axis=1)).mean()) > _HOTTER * gas_rates.speed


def levels(reach: Reach, step: float, divided: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return the lowest and the highest mean speed for each level of a step, shape (levels,).

    If the step is not divided, there is only one level.
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
    """Return the levels of a step as the kernels' `Pace`.

    present : see `kernels.dsmc.model.Faces`
    """
    from gaspart.kernels.dsmc import model as pace

    pulls = scene.gravity or (0.0,) * scene.dimension
    drifts = tuple(around and g != 0.0 for around, g in zip(scene.container.periodic, pulls, strict=True))
    return pace.Pace(*levels(reach, step, divided), 0, drifts, np.zeros(1), present)


_TOO_LONG = f"lets particles fly more than {MOST:g} mean free paths, or {MOST:g} times from wall to wall"


def check_step(reach: Reach, step: float, gas_rates: Rates) -> None:
    """Raise SceneError for a step in which particles fly too far.

    A step is rejected if, during the step, a particle would collide more than `MOST` times, or fly from wall
    to wall more than `MOST` times.
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


# Cells and time step of a scene, and their errors.


WIDEST = 1.0 / 3.0
"""Largest recommended cell width in mean free paths."""
FEWEST = {"boltzmann": 8.0, "enskog": 64.0}
"""Minimum number of particles per cell, even if the cell then becomes wider.

After a collision in a dense gas the two particles move apart. If the cell contains few other particles, few
pairs that approach remain. With 8 particles per cell a gas at a packing fraction of 0.4 has 6 % too few
collisions.
"""
USUAL = 16.0
"""Sufficient number of particles per cell. If there are more, cells become narrower than recommended."""
LAYERS = 8
"""Minimum number of cells along gravity between walls, because speeds depend on the height."""
_DIGITS = 2.0**10  # parts to which a step is rounded, so that it does not depend on the rounding of sums
CELL_LOSS = 0.5
"""Maximum fraction of collisions that the Enskog model misses, multiplied by the number of particles per
cell.

The two particles move apart after a collision. If the cell contains few other particles, few pairs that
approach remain (docs/dsmc.md: with 8 particles per cell 3 % of the collisions are missing at a packing
fraction of 0.1, 6 % at 0.4).
"""


def cells_for(engine: DSMC, scene: Scene, gas_rates: Rates, crowding: float = 1.0) -> tuple[int, ...]:
    """Return the prescribed or recommended number of cells along each axis (d,).

    crowding : density around a particle, averaged over particles, divided by the mean density
    """
    prescribed, d = engine.cells_per_side, scene.dimension
    if prescribed is not None and not (engine.adapts_cells and crowding > 1.0):
        sides = tuple(prescribed) if isinstance(prescribed, (tuple, list)) else (prescribed,) * d
        if len(sides) != d:
            raise SceneError("cells_per_side", prescribed, f"must be one number, or one for each of {d} axes")
        return sides
    return recommended_cells(
        engine.model, scene, gas_rates.at_density(crowding), crowding * usual_count(scene)
    )


def recommended_cells(model: str, scene: Scene, gas_rates: Rates, number: float) -> tuple[int, ...]:
    """Return the recommended number of cells along each axis (d,), for a number of particles.

    Along the direction of gravity there are `LAYERS` cells, if there are enough particles. The remaining
    cells are divided among the other axes.
    """
    lower, upper = accessible(scene)
    lengths = tuple(float(length) for length in upper - lower)
    fit, axis = _fitting(lengths, gas_rates, number, model), falling_axis(scene)
    layers = min(LAYERS, math.floor(number / FEWEST[model]))
    if axis is None or layers <= fit[axis]:
        return fit
    others = _fitting(lengths[:axis] + lengths[axis + 1 :], gas_rates, number / layers, model)
    return (*others[:axis], layers, *others[axis:])


def _fitting(lengths: tuple[float, ...], gas_rates: Rates, number: float, model: str) -> tuple[int, ...]:
    """Return the number of cells along each axis that suits a number of particles."""
    width = min(WIDEST * gas_rates.path, cube_side(lengths, number / USUAL))
    width = max(width, cube_side(lengths, number / FEWEST[model]))
    return tuple(max(1, math.floor(length / width + 1e-9)) for length in lengths)


def step_for(engine: DSMC, scene: Scene, gas_rates: Rates) -> float:
    """Return the length of a step: the engine's setting or the recommended length.

    Raises SceneError if nothing moves.
    """
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


def widths_of(cells: tuple[int, ...], scene: Scene) -> np.ndarray:
    """Return the sides (d,) of a cell."""
    lower, upper = accessible(scene)
    return (upper - lower) / np.array(cells)


def predicted_error(cells: tuple[int, ...], step: float, scene: Scene, gas_rates: Rates) -> float:
    """Return the relative error of the shear viscosity due to cells and step.

    The error makes the viscosity too high. It is a (w/l)^2 + b (c dt/l)^2, where w is the side of a cell, l
    the mean free path and c = sqrt(2 kT/m); a is from `CELL_VISCOSITY` and b from `STEP_COEFFICIENTS`. The
    value of b for discs is an estimate, the value for spheres. A periodic axis with a single cell does not
    contribute, because the gas has no profile along it.
    """
    if not gas_rates.path < math.inf:
        return 0.0
    d, widths = scene.dimension, widths_of(cells, scene)
    flat = [n == 1 and around for n, around in zip(cells, scene.container.periodic, strict=True)]
    width = max((float(w) for w, is_flat in zip(widths, flat, strict=True) if not is_flat), default=0.0)
    return (
        CELL_VISCOSITY[d] * (width / gas_rates.path) ** 2
        + STEP_COEFFICIENTS["viscosity"] * _thermal_step(step, d, gas_rates) ** 2
    )


def diffusion_error(step: float, scene: Scene, gas_rates: Rates) -> float:
    """Return the positive relative error of the diffusion coefficient due to a step.

    For spheres the error is b (c dt/l)^2, with the quantities of `predicted_error`. For discs the same value
    is an estimate. Cells do not affect the diffusion coefficient.
    """
    return (
        STEP_COEFFICIENTS["diffusion"] * _thermal_step(step, scene.dimension, gas_rates) ** 2
        if gas_rates.path < math.inf
        else 0.0
    )


def lost_collisions(engine: DSMC, cells: tuple[int, ...], scene: Scene) -> float:
    """Return an upper bound of the fraction of collisions that the Enskog model misses.

    With a single cell the model misses none.
    """
    number = math.prod(cells)
    return CELL_LOSS * number / scene.count if engine.model == "enskog" and number > 1 else 0.0


def _thermal_step(step: float, dimension: int, gas_rates: Rates) -> float:
    """Return the step in thermal units, c dt / l (see `predicted_error`)."""
    return math.sqrt(2.0) * gas_rates.speed / math.sqrt(MEAN_SQUARE[dimension]) * step / gas_rates.path


def coarse(
    engine: DSMC, cells: tuple[int, ...], step: float, scene: Scene, gas_rates: Rates, crowding: float = 1.0
) -> dict[str, str]:
    """Return warnings, by setting, about prescribed cells and steps that are too coarse.

    Each warning recommends a value.

    gas_rates : collision rates at the present time
    crowding : see `cells_for`
    """
    texts = {}
    fit = recommended_cells(engine.model, scene, gas_rates, crowding * usual_count(scene))
    effect = f"makes the viscosity {100.0 * predicted_error(cells, step, scene, gas_rates):.2g} % too high"
    wide, met = float(widths_of(cells, scene).max()) / gas_rates.path, step * gas_rates.frequency
    if not engine.adapts_cells and wide > WIDEST * (1.0 + 1e-9) and any(map(operator.lt, cells, fit)):
        texts["cells_per_side"] = (
            f"gaspart: cells_per_side = {engine.cells_per_side} gives cells of {wide:.2g} mean free paths"
            f"{{when}} and {effect}; {fit} would do"
        )
    if not engine.adapts_steps and met > LONGEST * (1.0 + 2.0 / _DIGITS):
        texts["time_step"] = (
            f"gaspart: time_step = {step:g} is {met:.2g} mean free times{{when}} and {effect};"
            f" a step of {step * LONGEST / met:.2g} would do"
        )
    return texts
