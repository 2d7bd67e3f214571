"""Dynamics of a scene under the time-stepped engine: the arrays of its kernels, and their control."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from gaspart.engines.features.law import largest_terms
from gaspart.engines.features.tallies import ThreadedPerAreaPart, inverse_areas
from gaspart.engines.step.arrays import (
    empty_particles,
    masses_of,
    model_for,
    parts_for,
    search_for,
    step_tally,
    tally_parts,
)
from gaspart.engines.step.limits import (
    check_late,
    check_precision,
    check_scene,
    check_step,
    oversized_particles,
)
from gaspart.engines.stepped import SteppedDynamics
from gaspart.kernels.physics import running_sum
from gaspart.kernels.step import box_search as loop
from gaspart.kernels.step import model as layout
from gaspart.scene.scene import Scene
from gaspart.state.optional_tallies import OptionalTally
from gaspart.state.state import State

if TYPE_CHECKING:
    from gaspart.engines.step.settings import StepSettings

_BY_THREAD = ("wall_hits", "wall_impulse", "wall_loss")
_OF_ALL = ("counts", "sums", "extremes")
"""Arrays of `StepTally` that are summed over all threads."""


class StepDynamics(SteppedDynamics):
    """Dynamics of a scene under the time-stepped engine. Its time is an integer number of steps."""

    def __init__(
        self,
        engine: StepSettings,
        scene: Scene,
        state: State,
        seed: int | tuple[int, ...],
        tallies: Sequence[OptionalTally] = (),
    ) -> None:
        engine.check_features(scene)
        oversized = oversized_particles(state)
        check_scene(scene, state, oversized)
        check_precision(engine, scene, state)
        check_step(engine, state)
        unit_mass, _ = masses_of(scene, state)
        super().__init__(scene, state, engine.time_step, engine.threads, unit_mass)
        self._engine = engine
        self._real = np.dtype(engine.precision).type
        ordinary = state.radii[~oversized]
        self._particles = empty_particles(engine, scene, state, len(ordinary))
        slots = np.argsort(oversized, kind="stable")  # oversized particles come last
        self._place(slots, state.positions, state.velocities, state.images)
        self._search = search_for(engine, scene, state, ordinary)
        self._model = model_for(engine, scene, state, seed, ordinary)
        self._largest = largest_terms(scene, state, unit_mass)
        units = unit_mass, self._largest[0]
        parts = tally_parts(tallies, self._particles, self._model, scene, engine.threads, units)
        self._parts = [*parts_for(scene, self._model.rules), *parts]
        areas = inverse_areas(scene, state) if scene.has_unequal_areas else None
        self._tally = step_tally(
            2 * scene.dimension, engine.threads, self._largest, parts, areas, scene.has_fixed
        )
        if areas is not None:
            read = partial(self._per_area, float(areas[0].max()))
            assert self._tally.per_area is not None
            self._parts.append(ThreadedPerAreaPart(self._tally.per_area, read))

    def _place(
        self, slots: np.ndarray, positions: np.ndarray, velocities: np.ndarray, images: np.ndarray
    ) -> None:
        particles = self._particles
        particles.positions[...] = positions[slots].T
        particles.velocities[...] = velocities[slots].T
        particles.images[...] = images.T
        particles.radii[...] = self._reference.radii[slots]
        particles.index[...] = slots

    @property
    def _slots(self) -> np.ndarray:
        return self._particles.index

    @property
    def _positions(self) -> np.ndarray:
        return self._particles.positions

    @property
    def _velocities(self) -> np.ndarray:
        return self._particles.velocities

    @property
    def _images(self) -> np.ndarray:
        return self._particles.images

    @property
    def _heat(self) -> np.ndarray:
        if self._model.rules is None:
            return np.zeros((2 * self._scene.dimension, 2))
        return running_sum.whole_parts(self._model.rules.heat, self._largest[1])

    @property
    def _loss(self) -> np.ndarray:
        tally = self._tally
        at_walls = running_sum.whole_parts(tally.wall_loss, self._largest[1])
        return np.vstack([tally.sums[layout.LOSS], at_walls])

    def _advance_to(self, step: int) -> None:
        self._run(step - self._steps)
        self._steps = step
        counts = self._tally.counts
        numbers = (int(counts[n]) for n in (layout.COLLISIONS, layout.LATE, layout.PASSED))
        check_late(self._engine, self.time, *numbers)

    def _run(self, steps: int) -> None:
        """Run the kernel for a number of steps; with 0 steps, only make a neighbour list."""
        settings = self._real(self.time_step), self._engine.rewind, self._engine.passes
        pairs = loop.run_steps(
            self._particles, self._search, self._model, settings, steps, self._tally, self._threads
        )
        self._search = self._search._replace(pairs=pairs)

    def _sums(self) -> dict[str, np.ndarray]:
        common = {key: getattr(self._tally, key)[np.newaxis] for key in _OF_ALL}
        return common | {key: getattr(self._tally, key) for key in _BY_THREAD}

    def _per_area(self, most: float, sums: np.ndarray) -> np.ndarray:
        """Return momentum along each axis and heat per accessible area (2d, d + 1); `most`: inverse of the
        least.
        """
        d = self._scene.dimension
        units = np.array(self._largest) * (self._unit_mass * most)
        transfers = running_sum.whole_parts(sums.sum(axis=0), 1.0).sum(axis=-1) * units
        result, faces = np.zeros((2 * d, d + 1)), np.arange(2 * d)
        result[faces, faces // 2], result[:, d] = transfers.T
        return result

    def _counts(self) -> dict[str, Any]:
        tally = self._tally
        impulse = running_sum.whole_parts(tally.wall_impulse.sum(axis=0), self._largest[0])
        counts: dict[str, Any] = dict(zip(layout.COUNTS, tally.counts.tolist(), strict=False))
        counts |= zip(layout.EXTREMES, tally.extremes.tolist(), strict=True)
        return counts | {
            "wall_hits": tally.wall_hits.sum(axis=0),
            "wall_impulse": impulse.sum(axis=-1) * self._unit_mass,
            "virial_sum": running_sum.net(tally.sums[layout.VIRIAL]) * self._unit_mass,
        }

    def _checkpoint_data(self) -> dict[str, Any]:
        return {**super()._checkpoint_data(), "reach": self._particles.bounds, **self._list_parts()}

    def _required_arrays(self, checkpoint: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        """Return arrays required from a checkpoint, which may lack the list's origin if the search
        differs.
        """
        spared = self._list_parts()
        return {key: array for key, array in self.checkpoint().items() if key not in spared}

    def _place_again(self, checkpoint: dict[str, np.ndarray]) -> None:
        super()._place_again(checkpoint)
        self._particles.bounds[...] = 0.0, np.inf  # as at the start: the next step makes a list
        if self._has_list_of(checkpoint):
            self._list_from(checkpoint["origin"])
            self._particles.bounds[...] = checkpoint["reach"]

    def _list_parts(self) -> dict[str, np.ndarray]:
        """Return positions (d, N), by slot, at which the neighbour list was made, and its settings."""
        if self._search.cells is None:
            return {}
        settings = {key: np.array(getattr(self._search.cells, key)) for key in ("skin", "per_side")}
        return {"origin": self._search.cells.origin, "threads": np.array(self._engine.threads), **settings}

    def _has_list_of(self, checkpoint: dict[str, np.ndarray]) -> bool:
        """Return True if a checkpoint contains a neighbour list for this engine's settings."""
        own = self._list_parts()
        if not own or not checkpoint["reach"][layout.DISPLACEMENT] < np.inf:
            return False
        origin = np.shape(own.pop("origin")) == np.shape(checkpoint.get("origin", ()))
        return origin and all(np.array_equal(checkpoint.get(key, ()), value) for key, value in own.items())

    def _list_from(self, origin: np.ndarray) -> None:
        """Make the neighbour list again from positions `origin` (d, N) of the particles by slot."""
        particles = self._particles
        now = particles.positions.copy()
        particles.positions[...] = origin
        particles.bounds[layout.DISPLACEMENT] = np.inf  # no list can be that old
        self._run(0)
        particles.positions[...] = now
