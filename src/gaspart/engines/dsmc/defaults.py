"""How often particles collide, what the engine's settings follow from, and with what error.

Mean values of a gas that fills its container evenly, with Maxwellian velocities of each kind's mean square.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from gaspart.errors import SceneError, SimulationError
from gaspart.scene.geometry import ball_volume
from gaspart.scene.scene import Scene
from gaspart.scene.species import Particle, Species
from gaspart.state.boxes import cube_side
from gaspart.state.state import State

if TYPE_CHECKING:
    from gaspart.engines.dsmc.settings import DSMC
    from gaspart.kernels.dsmc.model import Pace


SLOPE, BEND = {2: 0.5625, 3: 1.5}, {2: 0.0, 3: 0.5}
"""Coefficients of the contact value, see `contact_values`, by dimension."""
_HIGHEST = 0.7  # packing fraction up to which contact values are evaluated


@dataclass(frozen=True)
class Rates:
    """frequency: collisions of a particle per time; speed: the mean speed; path: the mean free path with all
    kinds of particles at one temperature, infinite if nothing collides."""

    frequency: float
    speed: float
    path: float

    def crowded(self, times: float) -> Rates:
        """The rates where the density is so many times as high."""
        return Rates(times * self.frequency, self.speed, self.path / times)


def accessible(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """(d,), (d,): the lowest and highest coordinates of centres of the smallest particles."""
    lower, upper = scene.reach(scene.smallest_radius)
    return np.array(lower), np.array(upper)


def contact_values(number_densities: np.ndarray, radii: np.ndarray, dimension: int) -> np.ndarray:
    """(K, K) pair distributions at contact of a mixture.

    Boublik, J. Chem. Phys. 53, 471 (1970), and Mansoori et al., J. Chem. Phys. 54, 1523 (1971), for spheres,
    which for one species is Carnahan & Starling's; Jenkins & Mancini, J. Appl. Mech. 54, 27 (1987), for
    discs, which is Henderson's.
    """
    filled = ball_volume(dimension) * float((number_densities * radii**dimension).sum())
    free = 1.0 - min(filled, _HIGHEST)
    surface = ball_volume(dimension) * float((number_densities * radii ** (dimension - 1)).sum())
    ratio = surface * 2.0 * radii[:, None] * radii / (radii[:, None] + radii)
    return 1.0 / free + SLOPE[dimension] * ratio / free**2 + BEND[dimension] * ratio**2 / free**3


Kinds: TypeAlias = Sequence[Species | Particle]


def rates(scene: Scene, dense: bool, instead: Kinds | None = None) -> Rates:
    """The rates of a scene at its start, or as hot as its faces; dense: with contact values of a dense gas;
    instead: fewer kinds of particles that stand for those of the scene, each pair of which is evaluated."""
    d, kinds = scene.dimension, scene.moving_kinds if instead is None else instead
    heat = max(scene.face_temperatures, default=0.0)
    if not kinds:
        return Rates(0.0, 0.0, math.inf)
    squares = [max(square_of(kind, d), heat / kind.mass) for kind in kinds]
    often, speed = _rates(scene, kinds, dense, [1.0 / kind.mass for kind in kinds])
    return Rates(*_rates(scene, kinds, dense, squares), path=speed / often if often > 0.0 else math.inf)


def highest_speed(scene: Scene) -> float:
    """The highest mean speed that particles can come to have with the energy of the start, all of it shared
    so that each has the same momentum."""
    kinds = scene.moving_kinds
    energy = sum(
        0.5 * kind.count * kind.mass * scene.dimension * square_of(kind, scene.dimension) for kind in kinds
    )
    inverse, number = sum(kind.count / kind.mass for kind in kinds), sum(kind.count for kind in kinds)
    return math.sqrt(2.0 * energy * inverse) / max(1, number)


def _rates(scene: Scene, kinds: Kinds, dense: bool, squares: list[float]) -> tuple[float, float]:
    """Frequency and speed of kinds with these mean squares of a velocity component."""
    d, square = scene.dimension, np.array(squares)
    radius = np.array([kind.radius for kind in kinds])
    number = np.array([float(kind.count) for kind in kinds])
    lower, upper = accessible(scene)
    density = number / float((upper - lower).prod())
    sigma = radius[:, None] + radius
    section = math.pi * sigma**2 if d == 3 else 2.0 * sigma
    mean = 8.0 / math.pi if d == 3 else math.pi / 2.0  # of <v>^2 / (kT/m)
    relative = np.sqrt(mean * (square[:, None] + square))
    pairs = density[:, None] * (number - np.eye(len(number)))
    contact = contact_values(density, radius, d) if dense else 1.0
    frequency = float((np.maximum(pairs, 0.0) * section * relative * contact).sum() / number.sum())
    return frequency, float((number * np.sqrt(mean * square)).sum() / number.sum())


def square_of(kind: Species | Particle, dimension: int) -> float:
    """The mean square of a velocity component at the start."""
    if isinstance(kind, Particle):
        return sum(v * v for v in kind.velocity) / dimension
    return (
        kind.temperature / kind.mass if kind.temperature is not None else (kind.speed or 0.0) ** 2 / dimension
    )


# The lengths of a step that fit a scene, whatever speeds its particles come to.
#
# A step is short enough if a particle of the mean speed flies at most 0.2 mean free paths and half of the
# container in it, and no faster by what gravity and kicks give it in the step. Where speeds can rise, an
# own step is divided into 2^level parts, as many as the present speeds require to within a factor sqrt 2.
# The level is found again before each part; it follows from the state, and so do all bits. A step that was
# given is never divided: the run stops before one in which particles would meet more than `MOST` others.


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
    from gaspart.kernels.dsmc import model as pace

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


# The cells and the time step of a scene, and the error that they bring.


WIDEST = 1.0 / 3.0
"""The widest cell that is recommended, in mean free paths."""
FEWEST = {"boltzmann": 8.0, "enskog": 64.0}
"""Particles that must be in a cell, even if it is wider then. Pairs that have met in a dense gas part, and
with few others in a cell those that approach become rare: with 8 in each a gas at a packing fraction of 0.4
has 6 % too few collisions."""
USUAL = 16.0
"""Particles in a cell that are enough: it is narrower than recommended rather than with more."""
LAYERS = 8
"""Cells along the way that particles fall between walls, at least: their speeds depend on the height."""
_DIGITS = 2.0**10  # a step is rounded to so many parts, so that it does not depend on how sums are rounded
_VISCOSITY = {2: math.pi / 24.0, 3: 16.0 / (45.0 * math.pi)}
_VISCOSITY_IN_TIME, _DIFFUSION_IN_TIME = 16.0 / (75.0 * math.pi), 4.0 / (27.0 * math.pi)
CELL_LOSS = 0.5
"""Part of its collisions that the Enskog model loses at most, times the particles in a cell: those that have
met part, and among few others those that approach become rare (docs/dsmc.md: 8 in a cell lose 3 % at a
packing fraction of 0.1, 6 % at 0.4)."""


def cells_for(engine: DSMC, scene: Scene, found: Rates, crowding: float = 1.0) -> tuple[int, ...]:
    """(d,) the cells along each axis: the engine's, or the recommended ones of a gas that is so many times as
    dense where its particles are as on average."""
    given, d = engine.cells_per_side, scene.dimension
    if given is not None and not (engine.adapts_cells and crowding > 1.0):
        sides = tuple(given) if isinstance(given, (tuple, list)) else (given,) * d
        if len(sides) != d:
            raise SceneError("cells_per_side", given, f"must be one number, or one for each of {d} axes")
        return sides
    return recommended_cells(engine.model, scene, found.crowded(crowding), crowding * scene.count)


def recommended_cells(model: str, scene: Scene, found: Rates, number: float) -> tuple[int, ...]:
    """(d,) those of a model for so many particles in the container. Where particles fall there are `LAYERS`
    along the way, if the particles are enough, and what is left of them is shared by the other axes."""
    lower, upper = accessible(scene)
    lengths = tuple(float(length) for length in upper - lower)
    fit, axis = _fitting(lengths, found, number, model), falling_axis(scene)
    layers = min(LAYERS, math.floor(number / FEWEST[model]))
    if axis is None or layers <= fit[axis]:
        return fit
    others = _fitting(lengths[:axis] + lengths[axis + 1 :], found, number / layers, model)
    return (*others[:axis], layers, *others[axis:])


def _fitting(lengths: tuple[float, ...], found: Rates, number: float, model: str) -> tuple[int, ...]:
    """Cells along axes of these lengths that share so many particles."""
    width = min(WIDEST * found.path, cube_side(lengths, number / USUAL))
    width = max(width, cube_side(lengths, number / FEWEST[model]))
    return tuple(max(1, math.floor(length / width + 1e-9)) for length in lengths)


def step_for(engine: DSMC, scene: Scene, found: Rates) -> float:
    """The length of a step: the engine's, or the recommended one. Raises SceneError where nothing moves."""
    if engine.time_step is not None:
        return engine.time_step
    reach = reach_of(scene, found.path)
    if reach.steady():
        if not found.speed > 0.0:
            raise SceneError("time_step", None, "must be given for particles that start at rest, and stay")
        crossing = min(scene.container.lengths) / found.speed
        free = 1.0 / found.frequency if found.frequency > 0.0 else math.inf
        longest = min(LONGEST * free, CROSSED * crossing)
    else:
        longest = reach.longest(found.speed, reach.recommended)
    fraction, exponent = math.frexp(longest)
    return math.ldexp(round(fraction * _DIGITS) / _DIGITS, exponent)


def widths_of(cells: tuple[int, ...], scene: Scene) -> np.ndarray:
    """(d,) the sides of a cell."""
    lower, upper = accessible(scene)
    return (upper - lower) / np.array(cells)


def predicted_error(cells: tuple[int, ...], step: float, scene: Scene, found: Rates) -> float:
    """By how much, relatively, cells and step make the shear viscosity too high.

    16/(45 pi) (w/l)^2 + 16/(75 pi) (c dt/l)^2 for spheres, w the side of a cell, l the mean free path and
    c = sqrt(2 kT/m): Alexander, Garcia & Alder, Phys. Fluids 10, 1540 (1998); Hadjiconstantinou, Phys. Fluids
    12, 2634 (2000); Garcia & Wagner, Phys. Fluids 12, 2621 (2000). Of discs the first is pi/24 (w/l)^2, by
    the same argument, and the second that of spheres, an estimate. An axis with one cell between periodic
    faces has no profile to spoil.
    """
    if not found.path < math.inf:
        return 0.0
    d, widths = scene.dimension, widths_of(cells, scene)
    flat = [n == 1 and around for n, around in zip(cells, scene.container.periodic, strict=True)]
    width = max((float(w) for w, one in zip(widths, flat, strict=True) if not one), default=0.0)
    return _VISCOSITY[d] * (width / found.path) ** 2 + _VISCOSITY_IN_TIME * _moved(step, d, found) ** 2


def diffusion_error(step: float, scene: Scene, found: Rates) -> float:
    """By how much, relatively, a step makes the diffusion coefficient too high: 4/(27 pi) (c dt/l)^2 for
    spheres (as of `predicted_error`); of discs the same, an estimate. Cells have no effect."""
    return _DIFFUSION_IN_TIME * _moved(step, scene.dimension, found) ** 2 if found.path < math.inf else 0.0


def lost_collisions(engine: DSMC, cells: tuple[int, ...], scene: Scene) -> float:
    """Bound on the part of its collisions that the Enskog model loses; none in a single cell."""
    number = math.prod(cells)
    return CELL_LOSS * number / scene.count if engine.model == "enskog" and number > 1 else 0.0


def _moved(step: float, dimension: int, found: Rates) -> float:
    """c dt / l."""
    mean = math.sqrt(8.0 / math.pi) if dimension == 3 else math.sqrt(math.pi / 2.0)
    return math.sqrt(2.0) * found.speed / mean * step / found.path


def coarse(
    engine: DSMC, cells: tuple[int, ...], step: float, scene: Scene, found: Rates, crowding: float = 1.0
) -> dict[str, str]:
    """Warnings, by setting: cells and steps that were given and are coarser than recommended, with
    those that are not. found: the rates at present; crowding: see `cells_for`."""
    texts = {}
    fit = recommended_cells(engine.model, scene, found, crowding * scene.count)
    effect = f"makes the viscosity {100.0 * predicted_error(cells, step, scene, found):.2g} % too high"
    wide, met = float(widths_of(cells, scene).max()) / found.path, step * found.frequency
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
