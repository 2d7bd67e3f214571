"""The cells and the time step of a scene, and the error that they bring."""

from __future__ import annotations

import math
import warnings
from typing import TYPE_CHECKING

import numpy as np

from gaspart.engines.dsmc.rates import Rates, accessible
from gaspart.errors import SceneError
from gaspart.scene.scene import Scene
from gaspart.state.boxes import cube_side

if TYPE_CHECKING:
    from gaspart.engines.dsmc.settings import DSMC

WIDEST = 1.0 / 3.0
"""The widest cell that is recommended, in mean free paths."""
LONGEST = 0.2
"""The longest step that is recommended, in mean free times."""
CROSSED = 0.5
"""Of the time that a particle takes to cross the container: the longest step in a gas without collisions."""
FEWEST = {"boltzmann": 8.0, "enskog": 64.0}
"""Particles that must be in a cell, even if it is wider then. Pairs that have met in a dense gas part, and
with few others in a cell those that approach become rare: with 8 in each a gas at a packing fraction of 0.4
has 6 % too few collisions."""
USUAL = 16.0
"""Particles in a cell that are enough: it is narrower than recommended rather than with more."""
_DIGITS = 2.0**10  # a step is rounded to so many parts, so that it does not depend on how sums are rounded
_VISCOSITY = {2: math.pi / 24.0, 3: 16.0 / (45.0 * math.pi)}
_VISCOSITY_IN_TIME, _DIFFUSION_IN_TIME = 16.0 / (75.0 * math.pi), 4.0 / (27.0 * math.pi)
CELL_LOSS = 0.5
"""Part of its collisions that the Enskog model loses at most, times the particles in a cell: those that have
met part, and among few others those that approach become rare (docs/dsmc.md: 8 in a cell lose 3 % at a
packing fraction of 0.1, 6 % at 0.4)."""


def cells_for(engine: DSMC, scene: Scene, found: Rates) -> tuple[int, ...]:
    """(d,) the cells along each axis: the engine's, or the recommended ones."""
    given, d = engine.cells_per_side, scene.dimension
    if given is not None:
        sides = tuple(given) if isinstance(given, (tuple, list)) else (given,) * d
        if len(sides) != d:
            raise SceneError("cells_per_side", given, f"must be one number, or one for each of {d} axes")
        return sides
    lower, upper = accessible(scene)
    lengths = tuple(float(length) for length in upper - lower)
    width = min(WIDEST * found.path, cube_side(lengths, scene.count / USUAL))
    width = max(width, cube_side(lengths, scene.count / FEWEST[engine.model]))
    return tuple(max(1, math.floor(length / width + 1e-9)) for length in lengths)


def step_for(engine: DSMC, scene: Scene, found: Rates) -> float:
    """The length of a step: the engine's, or the recommended one. Raises SceneError where nothing moves."""
    if engine.time_step is not None:
        return engine.time_step
    if not found.speed > 0.0:
        raise SceneError("time_step", None, "must be given for particles that start at rest")
    crossing = min(scene.container.lengths) / found.speed
    free = 1.0 / found.frequency if found.frequency > 0.0 else math.inf
    longest = min(LONGEST * free, CROSSED * crossing)
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


def warn_if_coarse(engine: DSMC, cells: tuple[int, ...], step: float, scene: Scene, found: Rates) -> None:
    """Warn of cells and steps that were given and are coarser than recommended, with those that are not."""
    fit = cells_for(type(engine)(model=engine.model), scene, found)
    error = 100.0 * predicted_error(cells, step, scene, found)
    effect = f"makes the viscosity {error:.2g} % too high"
    wide = float(widths_of(cells, scene).max()) > WIDEST * found.path * (1.0 + 1e-9)
    if engine.cells_per_side is not None and wide and any(n < m for n, m in zip(cells, fit, strict=True)):
        path = float(widths_of(cells, scene).max()) / found.path
        warnings.warn(
            f"gaspart: cells_per_side = {engine.cells_per_side} gives cells of {path:.2g} mean free paths and"
            f" {effect}; {fit} would do",
            stacklevel=4,
        )
    met = step * found.frequency
    if engine.time_step is not None and met > LONGEST * (1.0 + 2.0 / _DIGITS):
        warnings.warn(
            f"gaspart: time_step = {step:g} is {met:.2g} mean free times and {effect};"
            f" a step of {step * LONGEST / met:.2g} would do",
            stacklevel=4,
        )
