"""The cells and the time step of a scene, and the error that they bring."""

from __future__ import annotations

import math
import operator
from typing import TYPE_CHECKING

import numpy as np

from gaspart.engines.dsmc.pace import CROSSED, LONGEST, falling_axis, reach_of
from gaspart.engines.dsmc.rates import Rates, accessible
from gaspart.errors import SceneError
from gaspart.scene.scene import Scene
from gaspart.state.boxes import cube_side

if TYPE_CHECKING:
    from gaspart.engines.dsmc.settings import DSMC

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
