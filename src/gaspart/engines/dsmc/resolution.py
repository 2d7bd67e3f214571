"""Cells and steps of a run, which are adapted to the gas."""

from __future__ import annotations

import math
import warnings
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gaspart.engines.dsmc.arrays import dense_for, grid_for, moved_fields
from gaspart.engines.dsmc.cells import Medium, cells_for, medium_for, neglected, remarks, spreads
from gaspart.engines.dsmc.defaults import (
    FINEST,
    check_step,
    is_hotter,
    may_speed_up,
    pace_for,
    reach_of,
    step_for,
    too_fast,
)
from gaspart.kernels.dsmc.enskog import Dense
from gaspart.kernels.dsmc.model import Grid, Pace, Particles, fitting_level
from gaspart.kernels.model import Open
from gaspart.scene.scene import Scene
from gaspart.state.state import State
from gaspart.theory.rates import Rates, accessible, rates, usual_count

if TYPE_CHECKING:
    from gaspart.engines.dsmc.settings import DsmcSettings


# Density around the particles of a gas, relative to the mean density; the cells must resolve it.
#
# It is the density around a particle, averaged over particles and divided by the mean density of the
# container. It is computed as the number of pairs in cells divided by the number in a uniform gas. It is
# determined at the start and after every `EPOCH` steps, counted from time 0. So it does not depend on where a
# run is split or sampled.


EPOCH = 64
"""Number of steps between two measurements of the density."""
HIGHEST = 6
"""Largest density level. The density is 2^level times the mean; a larger level would need too many cells for
the particles.
"""
_CHANGED = 0.75
"""Difference between the measured density and the present level, in levels, at which the level changes."""


_SIGNIFICANT = 25.0
"""Squared amplitude of a wave above which it is no fluctuation, in units of its mean in a homogeneous gas."""


def may_crowd(scene: Scene) -> bool:
    """Return True if the density can become nonuniform."""
    return scene.is_open or (
        scene.count > 1
        and (bool(scene.gravity and any(scene.gravity)) or bool(scene.faces) or not spreads(scene))
    )


def crowding(positions: np.ndarray, cells: tuple[int, ...], scene: Scene) -> float:
    """Return the density around particles at (N, d) over the usual one, from the pairs in cells."""
    lower, upper = accessible(scene)
    coordinates = (positions - lower) / (upper - lower) * cells
    at = np.clip(coordinates.astype(np.int64), 0, np.array(cells) - 1)
    counts = np.bincount(np.ravel_multi_index(tuple(at.T), cells)).astype(float)
    number = len(positions)
    if number < 2:
        return 0.0
    usual = usual_count(scene) if scene.is_open else number
    return float((counts * (counts - 1.0)).sum()) * math.prod(cells) / (usual * (number - 1.0))


def next_level(level: int, times: float) -> int:
    """Return the new density level, from the present one, for a gas with the relative density `times`."""
    exact = math.log2(max(times, 1.0))
    return level if abs(exact - level) <= _CHANGED else min(round(exact), HIGHEST)


def varies_along(state: State, axis: int, length: float) -> bool:
    """Return True if density or velocity of a state have a significant longest wave along an axis."""
    moving = np.isfinite(state.masses) & np.isfinite(state.positions).all(axis=1)
    if not moving.any():
        return False
    phases = np.exp(2j * math.pi * state.positions[moving, axis] / length)
    velocities = state.velocities[moving]
    fields = np.column_stack([np.ones(len(phases)), velocities - velocities.mean(axis=0)])
    return bool((np.abs(phases @ fields) ** 2 > _SIGNIFICANT * (fields**2).sum(axis=0)).any())


class Resolution:
    """Present cells and step lengths of a run; the constructor raises SceneError if they do not fit."""

    def __init__(
        self, engine: DsmcSettings, scene: Scene, state: State, kinds: int, opened: Open | None = None
    ) -> None:
        self._engine, self._scene, self._state, self._kinds = engine, scene, state, kinds
        self._present = opened.present if opened else None
        self._found = rates(scene, engine.model == "enskog")
        self.step = step_for(engine, scene, self._found)
        check_step(reach_of(scene, self._found.path), self.step, self._found)
        self.crowds, self._warned = may_crowd(scene), set[str]()
        self.dense: Dense | None = None
        self.grid: Grid | None = None
        self.set(0)
        texts = [neglected(engine, scene), self._unresolved() if engine.adapts_cells else None]
        for text in filter(None, texts):
            warnings.warn(f"gaspart: {text}", stacklevel=5)
        self._warn(self._medium(0), "")

    def _unresolved(self) -> str | None:
        """Return a remark if the initial state varies along a periodic axis with a single default cell."""
        periodic = self._scene.container.periodic
        for axis, (n, around) in enumerate(zip(self.cells, periodic, strict=True)):
            if n == 1 and around and varies_along(self._state, axis, self._scene.container.lengths[axis]):
                rule = f"does not resolve the initial state, which varies along {'xyz'[axis]}: give the cells"
                return f"cells_per_side = {self.cells} {rule}"
        return None

    def _medium(self, crowded: int) -> Medium:
        """Return the gas at a density level."""
        return medium_for(self._engine, self._scene, self._found, 2.0**crowded)

    def cells_of(self, crowded: int) -> tuple[int, ...]:
        """Return the number of cells along each axis (d,) for a density level."""
        return cells_for(self._engine, self._medium(crowded), self.step, 2.0**crowded)

    def set(self, crowded: int) -> None:
        """Set the cells and the step lengths for a density level."""
        engine, scene, state = self._engine, self._scene, self._state
        self.crowded, self.cells = crowded, self.cells_of(crowded)
        grid = grid_for(scene, state, self.cells, engine.threads)
        if engine.model == "enskog":
            dense = dense_for(scene, state, grid, self._kinds)
            if self.dense is not None and self.grid is not None:
                dense.fields[...] = moved_fields(self.dense.fields, self.grid, grid)
            self.dense = dense
        self.grid = grid
        self._reach = reach_of(scene, self._found.at_density(2.0**crowded).path)
        self.pace: Pace | None = None
        if may_speed_up(scene) or is_hotter(state, self._found):
            self.pace = pace_for(scene, self._reach, self.step, engine.adapts_steps, self._present)

    def look(self, positions: np.ndarray, time: float) -> None:
        """Adapt the cells to the density around particles at positions (N, d)."""
        cells = self._medium(self.crowded).recommended(self.step)
        crowded = next_level(self.crowded, crowding(positions, cells, self._scene))
        if crowded != self.crowded:
            self.set(crowded)
            self._warn(self._medium(crowded), f" where most particles are at time {time:g}")

    def level(self, particles: Particles, position: int, time: float) -> int:
        """Return the level of division for the next part of a step. If the completed fraction of the step is
        not a multiple of a part at this level, a higher level is returned. Raises SimulationError if the
        particles are too fast for every level. `position`: completed fraction of the step, in units of the
        shortest part.
        """
        if self.pace is None:
            return 0
        level = fitting_level(particles, self.pace)
        if level == len(self.pace.low):
            raise too_fast(time, self.step, self._reach, self.pace)
        return max(level, 0 if position == 0 else FINEST + 1 - (position & -position).bit_length())

    def warn_of_speed(self, time: float) -> None:
        """Warn if a step is too long for the highest mean speed until now."""
        if self.pace is not None:
            speed = float(self.pace.fastest[0])
            gas_rates = Rates(speed / self._reach.path, speed, self._reach.path)
            self._warn(replace(self._medium(self.crowded), gas_rates=gas_rates), f" by time {time:g}")

    def _warn(self, medium: Medium, when: str) -> None:
        """Warn once about each setting with a notable error; `when` describes the time."""
        for key, text in remarks(self._engine, medium, self.cells, self.step, when).items():
            if key not in self._warned:
                self._warned.add(key)
                warnings.warn(f"gaspart: {text}", stacklevel=6)
