"""The cells and the lengths of steps of a run, which follow its gas."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

from gaspart.engines.dsmc.arrays import grid_for
from gaspart.engines.dsmc.crowding import crowding, may_crowd, next_level
from gaspart.engines.dsmc.defaults import cells_for, coarse, recommended_cells, step_for
from gaspart.engines.dsmc.dense import dense_for, moved_fields
from gaspart.engines.dsmc.pace import (
    FINEST,
    check_step,
    is_hotter,
    may_speed_up,
    pace_for,
    reach_of,
    too_fast,
)
from gaspart.engines.dsmc.rates import Rates, rates
from gaspart.kernels.dsmc.enskog import Dense
from gaspart.kernels.dsmc.model import Grid, Particles
from gaspart.kernels.dsmc.pace import Pace, fitting_level
from gaspart.scene.scene import Scene
from gaspart.state.state import State

if TYPE_CHECKING:
    from gaspart.engines.dsmc.settings import DSMC


class Resolution:
    """step: the length of a step; cells (d,), along each axis. crowded: the gas is 2^crowded times as dense
    where its particles are as on average; crowds: whether that can change. grid, dense and pace: what the
    kernels have of it, the second for a dense gas, the third where steps follow the speeds.

    Raises SceneError for settings that do not fit the scene.
    """

    def __init__(self, engine: DSMC, scene: Scene, state: State, kinds: int) -> None:
        self._engine, self._scene, self._state, self._kinds = engine, scene, state, kinds
        self._found = rates(scene, engine.model == "enskog")
        self.step = step_for(engine, scene, self._found)
        check_step(reach_of(scene, self._found.path), self.step, self._found)
        self.crowds, self._warned = may_crowd(scene), set[str]()
        self.dense: Dense | None = None
        self.grid: Grid | None = None
        self.set(0)
        self._warn(self._found, "")

    def cells_of(self, crowded: int) -> tuple[int, ...]:
        """(d,) the cells of a gas so dense."""
        return cells_for(self._engine, self._scene, self._found, 2.0**crowded)

    def set(self, crowded: int) -> None:
        """Make the cells, and find the lengths of steps, for a gas so dense."""
        engine, scene, state = self._engine, self._scene, self._state
        self.crowded, self.cells = crowded, self.cells_of(crowded)
        grid = grid_for(scene, state, self.cells, engine.threads)
        if engine.model == "enskog":
            dense = dense_for(scene, state, grid, self._kinds)
            if self.dense is not None and self.grid is not None:
                dense.fields[...] = moved_fields(self.dense.fields, self.grid, grid)
            self.dense = dense
        self.grid = grid
        self._reach = reach_of(scene, self._found.crowded(2.0**crowded).path)
        self.pace: Pace | None = None
        if may_speed_up(scene) or is_hotter(state, self._found):
            self.pace = pace_for(scene, self._reach, self.step, engine.adapts_steps)

    def look(self, places: np.ndarray, time: float) -> None:
        """Let the cells fit the density of particles at these places (N, d)."""
        scene, times = self._scene, 2.0**self.crowded
        cells = recommended_cells(self._engine.model, scene, self._found.crowded(times), times * scene.count)
        crowded = next_level(self.crowded, crowding(places, cells, scene))
        if crowded != self.crowded:
            self.set(crowded)
            found = self._found.crowded(2.0**crowded)
            self._warn(found, f" where most particles are at time {time:g}")

    def level(self, particles: Particles, place: int, time: float) -> int:
        """The level of the next part of a step: that which fits the particles, or a higher one, of which a
        whole number have been made. place: in the step, in parts of the finest level. Raises SimulationError
        if none fits."""
        if self.pace is None:
            return 0
        level = fitting_level(particles, self.pace)
        if level == len(self.pace.low):
            raise too_fast(time, self.step, self._reach, self.pace)
        return max(level, 0 if place == 0 else FINEST + 1 - (place & -place).bit_length())

    def warn_of_speed(self, time: float) -> None:
        """Warn of a step that is too long for the highest mean speed that there was."""
        if self.pace is not None:
            speed = float(self.pace.fastest[0])
            found = Rates(speed / self._reach.path, speed, self._reach.path)
            self._warn(found, f" by time {time:g}")

    def _warn(self, found: Rates, when: str) -> None:
        """Warn once of each setting that was given and is coarser than recommended. when: words for the
        time."""
        texts = coarse(self._engine, self.cells, self.step, self._scene, found, 2.0**self.crowded)
        for key, text in texts.items():
            if key not in self._warned:
                self._warned.add(key)
                warnings.warn(text.format(when=when), stacklevel=6)
