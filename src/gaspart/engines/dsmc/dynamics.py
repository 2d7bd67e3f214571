"""A scene under the DSMC engine."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from gaspart.engines.dsmc.defaults import cells_for, step_for, warn_if_coarse
from gaspart.engines.dsmc.limits import check_scene
from gaspart.engines.dsmc.rates import rates
from gaspart.engines.features.law import LawPart, contact_law
from gaspart.engines.features.part import Part, arrays_of, write_parts
from gaspart.engines.features.thermostat import step_kicks
from gaspart.errors import SceneError
from gaspart.scene.scene import Scene
from gaspart.state.state import State
from gaspart.state.tally import Tally, tallied_fluxes

if TYPE_CHECKING:
    from gaspart.engines.dsmc.settings import DSMC
    from gaspart.engines.event_log import EventLog

_MOST_STEPS = 2.0**53  # above, float64 does not distinguish their numbers


class DsmcDynamics:
    """A scene under way; its time is a whole number of steps.

    cells_per_side (d,), time_step: what was chosen.
    """

    def __init__(
        self, engine: DSMC, scene: Scene, state: State, seed: int | tuple[int, ...], stress: bool
    ) -> None:
        from gaspart.engines.dsmc import arrays
        from gaspart.kernels.dsmc import loop, model
        from gaspart.kernels.model import Space
        from gaspart.kernels.physics import running_sum

        engine.check_features(scene)
        check_scene(scene, state)
        found = rates(scene, engine.model == "enskog")
        self.cells_per_side = cells_for(engine, scene, found)
        self.time_step = step_for(engine, scene, found)
        warn_if_coarse(engine, self.cells_per_side, self.time_step, scene, found)
        self._engine, self._scene, self._reference = engine, scene, state
        self._arrays, self._loop, self._layout, self._sums = arrays, loop, model, running_sum
        self._particles = arrays.empty_particles(state)
        self._grid = arrays.grid_for(scene, state, self.cells_per_side, engine.threads)
        self._tools = arrays.tools_for(engine, scene, state, self.time_step, seed)
        space = Space(scene.container.lengths, scene.container.periodic, self._tools.margin)
        self._setting = model.Setting(space, self._tools, 0)
        self._gravity = scene.gravity
        law = contact_law(scene, state)
        self._faces, self._law = arrays.faces_for(scene, engine.threads), arrays.law_for(law)
        self._dense = None
        if engine.model == "enskog":
            from gaspart.engines.dsmc.dense import dense_for

            self._dense = dense_for(scene, state, self._grid, len(self._tools.radius))
        self._stress = arrays.stress_for(scene, state, engine.threads) if stress else None
        self._kicks = step_kicks(scene, self.time_step, seed)
        parts = (
            LawPart(law) if law else None,
            Part({"fields": self._dense.fields}) if self._dense else None,
            Part({"given": self._kicks.given}) if self._kicks else None,
        )
        self._parts = [part for part in parts if part]
        self._place(np.arange(state.count), state.positions, state.velocities, state.images)
        self._lost = np.zeros(2)  # net and gross, before the tally began
        self._start, self._since = state.time, 0

    def _place(
        self, slots: np.ndarray, positions: np.ndarray, velocities: np.ndarray, images: np.ndarray
    ) -> None:
        """Put the particles into their slots: (N,) which particle is in each."""
        particles, d = self._particles, self._scene.dimension
        particles.rows[:-1] = np.arange(2 * d + 1)
        particles.rows[-1] = 0
        particles.data[:d] = positions[slots].T
        particles.data[d : 2 * d] = velocities[slots].T
        particles.numbers[0] = slots
        particles.images[...] = images.T

    def _by_particle(self, first: int) -> np.ndarray:
        """(N, d) of the particles in their own order, from the rows of positions (first 0) or velocities."""
        particles, d = self._particles, self._scene.dimension
        found = np.empty((particles.data.shape[1], d))
        for k in range(d):
            found[self._slots, k] = particles.data[particles.rows[first + k]]
        return found

    @property
    def _slots(self) -> np.ndarray:
        """(N,) which particle is in each slot."""
        return self._particles.numbers[self._particles.rows[-1]]

    @property
    def _steps(self) -> int:
        """How many steps have been made."""
        return int(self._tools.clock[0])

    @property
    def time(self) -> float:
        """The time reached, at the end of a step."""
        return self._start + self._steps * self.time_step

    def advance(
        self, until: float, most: int | None = None, log: EventLog | None = None, work: int | None = None
    ) -> None:
        """Step to the last whole step not after `until` (to within 1e-9 of a step).

        Raises SceneError for what only the event-driven engine can do, count or record events, and for a time
        that is not within 2^53 steps.
        """
        wanted = {"max_events": most, "max_work": work, "record_events": None if log is None else True}
        for key, value in wanted.items():
            if value is not None:
                raise SceneError(key, value, 'needs the "event" engine; this one makes whole steps only')
        steps = (until - self._start) / self.time_step
        if not steps < _MOST_STEPS:
            raise SceneError("until", until, f"must be within {_MOST_STEPS:g} steps of {self.time_step:g}")
        target = math.floor(steps * (1.0 + 4e-16) + 1e-9)
        if target > self._steps and self._engine.threads > 1:
            from numba import config, set_num_threads

            set_num_threads(min(self._engine.threads, config.NUMBA_NUM_THREADS))
        while self._steps < target:
            stop = target if self._kicks is None else min(target, self._kicks.next_step(self._steps))
            self._run(stop - self._steps)
            if self._kicks is not None:
                self._kicks.happen(self._particles, self._tools, self._steps)

    def _run(self, steps: int) -> None:
        """Let the kernel make so many steps."""
        threads = self._engine.threads if self._engine.threads > 1 else None
        options = self._gravity, self._faces, self._law, self._dense, self._stress
        self._loop.run_steps(self._particles, self._grid, self._setting, steps, threads, options)

    def reset_tally(self) -> None:
        """Begin to count anew."""
        self._lost = np.array([self.dissipated, self.exchanged])
        for key in self._arrays.TALLY:
            getattr(self._tools, key)[...] = 0
        if self._kicks is not None:
            self._kicks.given[:] = 0.0
        for sums in self._optional.values():
            sums[...] = 0
        self._since = self._steps

    @property
    def _optional(self) -> dict[str, np.ndarray]:
        """Sums (threads, ...) of what not every scene has, by their names in a checkpoint."""
        stress, shear = self._stress and self._stress.sums, self._faces and self._faces.shear
        return {key: sums for key, sums in {"stress": stress, "shear": shear}.items() if sums is not None}

    @property
    def _heat(self) -> np.ndarray:
        """(2d, 2) what each face was given by particles that left it at its temperature, in two parts."""
        return self._sums.whole_parts(self._tools.wall_heat.sum(axis=0), self._tools.scales[1])

    @property
    def _loss(self) -> np.ndarray:
        """(2,) the energy that contacts have taken, likewise."""
        return self._sums.whole_parts(self._tools.loss.sum(axis=0), self._tools.scales[1])

    @property
    def _given(self) -> np.ndarray:
        """(1, 2) the energy that kicks have given, likewise."""
        return np.zeros((1, 2)) if self._kicks is None else self._kicks.given

    @property
    def dissipated(self) -> float:
        """The energy that contacts and thermal walls have taken since time 0, less what kicks have given."""
        return float(self._lost[0]) + self._sums.net(self._loss, self._heat, -self._given)

    @property
    def exchanged(self) -> float:
        """The sum of what contacts and each face have taken or given since time 0, each counted positive."""
        gross = self._sums.net(self._loss) + float(np.abs(self._heat.sum(axis=1)).sum())
        return float(self._lost[1]) + gross + abs(self._sums.net(self._given))

    @property
    def flux_sums(self) -> np.ndarray:
        """(2 d^2 + d,) the sums of the stress tensor, of its collisional part and of the heat flux."""
        assert self._stress is not None
        sums, (action, heat) = self._stress.sums.sum(axis=0), self._stress.scales
        found = self._sums.whole_parts(sums, action).sum(axis=-1)
        found[-self._scene.dimension :] *= heat / action  # powers of two
        return found

    @property
    def state(self) -> State:
        """All particles at the present time."""
        d = self._scene.dimension
        state = replace(
            self._reference,
            time=self.time,
            positions=self._by_particle(0),
            velocities=self._by_particle(d),
            images=self._particles.images.T.astype(self._reference.images.dtype),
        )
        write_parts(self._parts, state)
        return state

    @property
    def tally(self) -> Tally:
        """What was counted since the last `reset_tally`."""
        tools, layout = self._tools, self._layout
        more: dict[str, Any] = {}
        if self._stress is not None:
            more = tallied_fluxes(self.flux_sums, self._stress.drift)
        if (shear := self._optional.get("shear")) is not None:
            parts = self._sums.whole_parts(shear.sum(axis=0), tools.scales[layout.MOMENTUM])
            more["wall_shear"] = parts.sum(axis=-1)
        counts = tools.counts.sum(axis=0)
        impulse = self._sums.whole_parts(tools.wall_impulse.sum(axis=0), tools.scales[layout.MOMENTUM])
        virial = self._sums.whole_parts(tools.virial.sum(axis=0), tools.scales[layout.ACTION])
        return Tally(
            time=(self._steps - self._since) * self.time_step,
            collisions=int(counts[layout.COLLISIONS]),
            wall_hits=tools.wall_hits.sum(axis=0),
            wall_impulse=impulse.sum(axis=-1),
            wall_energy=self._heat.sum(axis=1),
            virial_sum=self._sums.net(virial),
            pair_tests=int(counts[layout.TRIALS]),
            box_visits=0,
            dissipated_energy=self._sums.net(self._loss),
            thermostat_energy=self._sums.net(self._given),
            steps=self._steps - self._since,
            **more,
        )

    def checkpoint(self) -> dict[str, np.ndarray]:
        """Everything that a continuation to the same bits needs."""
        return {
            "steps": np.array(self._steps),
            "since": np.array(self._since),
            "lost": self._lost.copy(),
            "positions": self._by_particle(0),
            "velocities": self._by_particle(self._scene.dimension),
            "images": self._particles.images.T.copy(),
            "slots": self._slots.copy(),
            **{key: getattr(self._tools, key).sum(axis=0) for key in self._arrays.TALLY},
            **{key: array.copy() for key, array in arrays_of(self._parts).items()},
            **{key: sums.sum(axis=0) for key, sums in self._optional.items()},
        }

    def restore(self, parts: dict[str, np.ndarray]) -> None:
        """Go on from a checkpoint of the same scene and engine, by whatever number of threads."""
        self._place(*(parts[key] for key in ("slots", "positions", "velocities", "images")))
        for key in self._arrays.TALLY:
            array = getattr(self._tools, key)
            array[...] = 0
            array[0] = parts[key]
        for key, array in arrays_of(self._parts).items():
            array[...] = parts[key]
        for key, sums in self._optional.items():
            sums[...] = 0
            sums[0] = parts[key]
        self._tools.clock[0], self._since = int(parts["steps"]), int(parts["since"])
        self._lost = parts["lost"].copy()
