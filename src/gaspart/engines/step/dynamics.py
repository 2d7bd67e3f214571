"""A scene under the time-stepped engine: the arrays that its kernels work on, and how they are driven."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import DTypeLike

from gaspart.engines.belonging import check_parts
from gaspart.engines.dynamics import EngineDynamics
from gaspart.engines.event_log import EventLog
from gaspart.engines.features.masses import largest_terms
from gaspart.engines.features.part import arrays_of, write_parts
from gaspart.engines.step.arrays import empty_particles, masses_of, model_for, parts_for, step_tally
from gaspart.engines.step.limits import (
    check_late,
    check_precision,
    check_scene,
    check_step,
    oversized_particles,
)
from gaspart.engines.step.search import search_for
from gaspart.errors import SceneError
from gaspart.kernels.physics import running_sum
from gaspart.kernels.step import loop
from gaspart.kernels.step import model as layout
from gaspart.scene.scene import Scene
from gaspart.state.state import State
from gaspart.state.tally import Tally

if TYPE_CHECKING:
    from gaspart.engines.step.settings import TimeStepped

_MOST_STEPS = 2.0**53  # above, float64 does not distinguish their numbers


class StepDynamics(EngineDynamics):
    """A scene under way; its time is a whole number of steps."""

    def __init__(self, engine: TimeStepped, scene: Scene, state: State, seed: int | tuple[int, ...]) -> None:
        engine.check_features(scene)
        oversized = oversized_particles(state)
        check_scene(scene, state, oversized)
        check_precision(engine, scene, state)
        check_step(engine, state)
        self._engine, self._scene, self._reference = engine, scene, state
        self._real = np.dtype(engine.precision).type
        self._unit_mass, _ = masses_of(scene, state)
        ordinary = state.radii[~oversized]
        self._particles = empty_particles(engine, scene, state, len(ordinary))
        slots = np.argsort(oversized, kind="stable")  # oversized particles last
        self._place(slots, state.positions, state.velocities, state.images)
        self._search = search_for(engine, scene, state, ordinary)
        self._model = model_for(engine, scene, state, seed, ordinary)
        self._threads = engine.threads if engine.threads > 1 else None
        self._parts = parts_for(scene, self._model.rules)
        self._largest = largest_terms(scene, state, self._unit_mass)
        self._lost = np.zeros(2)  # net and gross, before the tally began
        self._start, self._steps = state.time, 0
        self._count()

    def _place(
        self, slots: np.ndarray, positions: np.ndarray, velocities: np.ndarray, images: np.ndarray
    ) -> None:
        """Put the particles into their slots: (N,) which particle is in each."""
        particles = self._particles
        particles.positions[...] = positions[slots].T
        particles.velocities[...] = velocities[slots].T
        particles.images[...] = images.T
        particles.radii[...] = self._reference.radii[slots]
        particles.index[...] = slots

    def _by_particle(self, values: np.ndarray, dtype: DTypeLike) -> np.ndarray:
        """(N, d) of the particles in their own order, from (d, N) by slot."""
        found = np.empty(values.shape[::-1], dtype)
        found[self._particles.index] = values.T
        return found

    def reset_tally(self) -> None:
        """Begin to count anew."""
        self._lost = np.array([self.dissipated, self.exchanged])
        self._count()

    def _count(self) -> None:
        """Set the tally to zero."""
        if self._model.rules:
            self._model.rules.heat[:] = 0
        faces = 2 * self._scene.dimension
        self._tally = step_tally(faces, self._engine.threads, self._largest)
        self._since = self._steps

    @property
    def dissipated(self) -> float:
        """The energy that contacts and thermal walls have taken since time 0."""
        return float(self._lost[0]) + running_sum.net(*self._loss, self._heat) * self._unit_mass

    @property
    def exchanged(self) -> float:
        """The sum of what contacts and each face have taken or given since time 0, each counted positive."""
        gross = running_sum.net(*self._loss) + float(np.abs(self._heat.sum(axis=1)).sum())
        return float(self._lost[1]) + gross * self._unit_mass

    @property
    def _heat(self) -> np.ndarray:
        """(2d, 2) what each face was given by particles that left it at its temperature, since the tally
        began, in two parts, in units of the unit mass."""
        if self._model.rules is None:
            return np.zeros((2 * self._scene.dimension, 2))
        return running_sum.whole_parts(self._model.rules.heat, self._largest[1])

    @property
    def _loss(self) -> tuple[np.ndarray, np.ndarray]:
        """The energy that contacts of particles (2,) and with walls (threads, 2) have taken, likewise."""
        tally = self._tally
        return tally.sums[layout.LOSS], running_sum.whole_parts(tally.wall_loss, self._largest[1])

    @property
    def time(self) -> float:
        """The time reached, at the end of a step."""
        return self._start + self._steps * self._engine.time_step

    def advance(
        self, until: float, most: int | None = None, log: EventLog | None = None, work: int | None = None
    ) -> None:
        """Step to the last whole step not after `until` (to within 1e-9 of a step).

        Raises SceneError for what only the event-driven engine can do, count or record events, and for a time
        that is not within 2^53 steps.
        """
        for key, limit in (("max_events", most), ("max_work", work)):
            if limit is not None:
                raise SceneError(key, limit, 'needs the "event" engine; this one makes whole steps only')
        if log is not None:
            raise SceneError(
                "record_events", True, 'needs the "event" engine; this one makes whole steps only'
            )
        steps = (until - self._start) / self._engine.time_step
        if not steps < _MOST_STEPS:
            rule = f"must be within {_MOST_STEPS:g} steps of {self._engine.time_step:g}"
            raise SceneError("until", until, rule)
        target = int(np.floor(steps * (1.0 + 4e-16) + 1e-9))
        if target > self._steps:
            if self._threads is not None:
                from numba import config, set_num_threads

                set_num_threads(min(self._threads, config.NUMBA_NUM_THREADS))
            self._run(target - self._steps)
            self._steps = target
            counts = self._tally.counts
            found = (int(counts[n]) for n in (layout.COLLISIONS, layout.LATE, layout.PASSED))
            check_late(self._engine, self.time, *found)

    def _run(self, steps: int) -> None:
        """Let the kernel make so many steps; or, if none, only a list."""
        settings = self._real(self._engine.time_step), self._engine.rewind, self._engine.passes
        pairs = loop.run_steps(
            self._particles, self._search, self._model, settings, steps, self._tally, self._threads
        )
        self._search = self._search._replace(pairs=pairs)

    @property
    def state(self) -> State:
        """All particles at the present time, in float64 whatever the precision."""
        state = replace(
            self._reference,
            time=self.time,
            positions=self._by_particle(self._particles.positions, float),
            velocities=self._by_particle(self._particles.velocities, float),
            images=self._particles.images.T.astype(self._reference.images.dtype),
        )
        write_parts(self._parts, state)
        return state

    @property
    def tally(self) -> Tally:
        """What was counted since the last `reset_tally`."""
        tally = self._tally
        impulse = running_sum.whole_parts(tally.wall_impulse.sum(axis=0), self._largest[0])
        sums = (running_sum.net(terms) * self._unit_mass for terms in tally.sums)
        values: dict[str, Any] = dict(zip(layout.COUNTS, tally.counts.tolist(), strict=False))
        values |= zip(layout.EXTREMES, tally.extremes.tolist(), strict=True)
        values |= zip(layout.SUMS, sums, strict=True)
        values["dissipated_energy"] = running_sum.net(*self._loss) * self._unit_mass
        return Tally(
            time=(self._steps - self._since) * self._engine.time_step,
            wall_hits=tally.wall_hits.sum(axis=0),
            wall_impulse=impulse.sum(axis=-1) * self._unit_mass,
            wall_energy=self._heat.sum(axis=1) * self._unit_mass,
            steps=self._steps - self._since,
            **values,
        )

    def checkpoint(self) -> dict[str, np.ndarray]:
        """Everything that a continuation to the same bits needs."""
        particles = self._particles
        return {
            "steps": np.array(self._steps),
            "since": np.array(self._since),
            "lost": self._lost.copy(),
            "positions": self._by_particle(particles.positions, self._real),
            "velocities": self._by_particle(particles.velocities, self._real),
            "images": particles.images.T.copy(),
            "slots": particles.index.copy(),
            **({} if self._search.cells is None else self._list_parts()),
            **{key: array.copy() for key, array in arrays_of(self._parts).items()},
            "reach": self._particles.bounds.copy(),
            **{key: np.array(value) for key, value in self._tally._asdict().items()},
        }

    def restore(self, parts: dict[str, np.ndarray]) -> None:
        """Go on from a checkpoint of the same scene and settings, to the same bits whatever its search and
        threads. Raises SceneError, with nothing changed, for one that lacks an array."""
        particles, tally, rules = self._particles, self._tally, arrays_of(self._parts)
        by_thread = ("wall_hits", "wall_impulse", "wall_loss")
        sums = dict(parts)
        sums |= {key: parts[key].sum(axis=0) for key in by_thread if key in parts}  # whole: in any order
        wanted: dict[str, np.ndarray] = {
            "slots": particles.index,
            "positions": particles.positions.T,
            "velocities": particles.velocities.T,
            "images": particles.images.T,
            "reach": particles.bounds,
            "lost": self._lost,
            **{key: np.array(0) for key in ("steps", "since")},
            **{key: getattr(tally, key) for key in ("counts", "sums", "extremes")},
            **{key: getattr(tally, key)[0] for key in by_thread},
            **rules,
        }
        check_parts(sums, wanted)
        self._place(*(parts[key] for key in ("slots", "positions", "velocities", "images")))
        self._particles.bounds[...] = 0.0, np.inf  # as at the start: the next step makes a list
        if self._search.cells is not None and self._has_list_of(parts):
            self._list_from(parts["origin"])
            self._particles.bounds[...] = parts["reach"]
        for key in ("counts", "sums", "extremes"):
            getattr(tally, key)[...] = parts[key]
        for key in by_thread:
            getattr(tally, key)[...] = 0
            getattr(tally, key)[0] = sums[key]
        for key, array in rules.items():
            array[...] = parts[key]
        self._steps, self._since = int(parts["steps"]), int(parts["since"])
        self._lost = parts["lost"].copy()

    def _list_parts(self) -> dict[str, np.ndarray]:
        """What the neighbour list is made of: `origin` (d, N), where particles were, by slot; settings."""
        settings = {key: np.array(getattr(self._search.cells, key)) for key in ("skin", "per_side")}
        origin = self._search.cells.origin.copy()
        return {"origin": origin, "threads": np.array(self._engine.threads), **settings}

    def _has_list_of(self, parts: dict[str, np.ndarray]) -> bool:
        """Whether a checkpoint has a list that was made with the settings of this engine."""
        if not parts["reach"][layout.DISPLACEMENT] < np.inf:
            return False
        own = self._list_parts()
        del own["origin"]
        return all(key in parts and np.array_equal(parts[key], value) for key, value in own.items())

    def _list_from(self, origin: np.ndarray) -> None:
        """Make the list again that was made when particles were at `origin` (d, N), by slot."""
        particles = self._particles
        now = particles.positions.copy()
        particles.positions[...] = origin
        particles.bounds[layout.DISPLACEMENT] = np.inf  # no list is as old as that
        self._run(0)
        particles.positions[...] = now
