"""A scene under the DSMC engine."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from gaspart.engines.belonging import check_parts
from gaspart.engines.dsmc.crowding import EPOCH, HIGHEST
from gaspart.engines.dsmc.limits import check_made, check_scene
from gaspart.engines.dsmc.pace import FINEST
from gaspart.engines.dynamics import EngineDynamics
from gaspart.engines.features.law import LawPart, contact_law
from gaspart.engines.features.part import Part, arrays_of, sums_of, write_parts
from gaspart.engines.features.thermostat import step_kicks
from gaspart.errors import SceneError
from gaspart.kernels.physics.running_sum import net
from gaspart.scene.scene import Scene
from gaspart.state.optional_tallies import OptionalTally
from gaspart.state.state import State
from gaspart.state.tally import Tally

if TYPE_CHECKING:
    from gaspart.engines.dsmc.settings import DSMC
    from gaspart.engines.event_log import EventLog

_MOST_STEPS = 2.0**53  # above, float64 does not distinguish their numbers
_WHOLE = 2**FINEST
"""Parts of a step, in which the place within it is counted."""


class DsmcDynamics(EngineDynamics):
    """A scene under way; its time is a whole number of steps.

    time_step: what was chosen. A step may be made in parts, and cells may become narrower: see `pace` and
    `crowding`.
    """

    def __init__(
        self,
        engine: DSMC,
        scene: Scene,
        state: State,
        seed: int | tuple[int, ...],
        tallies: Sequence[OptionalTally] = (),
    ) -> None:
        from gaspart.engines.dsmc import arrays
        from gaspart.engines.dsmc.resolution import Resolution
        from gaspart.engines.dsmc.tallies import WallShearPart, tally_parts
        from gaspart.kernels.dsmc import loop, model
        from gaspart.kernels.model import Space
        from gaspart.kernels.physics import exact_sum

        engine.check_features(scene)
        check_scene(scene, state)
        self._resolution = Resolution(engine, scene, state, len(arrays.kinds_of(state)[0]))
        self.time_step = self._resolution.step
        self._engine, self._scene, self._reference = engine, scene, state
        self._arrays, self._loop, self._layout, self._sums = arrays, loop, model, exact_sum
        self._particles = arrays.empty_particles(state)
        self._tools = arrays.tools_for(engine, scene, state, self.time_step, seed)
        self._space = Space(scene.container.lengths, scene.container.periodic, self._tools.margin)
        self._gravity = scene.gravity
        law = contact_law(scene, state)
        self._faces, self._law = arrays.faces_for(scene, engine.threads), arrays.law_for(law)
        self._kicks = step_kicks(scene, self.time_step, seed)
        parts = (
            LawPart(law) if law else None,
            Part({"given": self._kicks.given}) if self._kicks else None,
            WallShearPart(self._faces.shear) if self._faces and self._faces.shear is not None else None,
        )
        self._parts = [part for part in parts if part]
        self._parts += tally_parts(tallies, scene, state, engine.threads)
        stress = self._tally_part("stress")
        self._stress = stress and stress.kernel
        self._place(np.arange(state.count), state.positions, state.velocities, state.images)
        self._lost = np.zeros(2)  # net and gross, before the tally began
        self._start, self._steps, self._place_in_step, self._since = state.time, 0, 0, np.zeros(2, np.int64)
        self._look()

    @property
    def cells_per_side(self) -> tuple[int, ...]:
        """(d,) the cells along each axis at present."""
        return self._resolution.cells

    def _look(self) -> None:
        """Let the cells fit the density that the gas has now."""
        if self._resolution.crowds:
            particles = self._particles
            self._resolution.look(particles.data[particles.rows[: self._scene.dimension]].T, self.time)

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
    def time(self) -> float:
        """The time reached, at the end of a step."""
        return self._start + (self._steps + self._place_in_step / _WHOLE) * self.time_step

    def advance(
        self, until: float, most: int | None = None, log: EventLog | None = None, work: int | None = None
    ) -> None:
        """Step to the last whole step not after `until` (to within 1e-9 of a step).

        Raises SceneError for what only the event-driven engine can do, count or record events, and for a time
        that is not within 2^53 steps; SimulationError if the particles come to be too fast for a step.
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
            epoch = self._steps - self._steps % EPOCH + EPOCH
            self._make(min(target, epoch) if self._resolution.crowds else target)
            if self._steps % EPOCH == 0:
                self._look()
        self._resolution.warn_of_speed(self.time)

    def _make(self, stop: int) -> None:
        """Make all steps up to one."""
        while self._steps < stop:
            level = self._resolution.level(self._particles, self._place_in_step, self.time)
            part, at = _WHOLE >> level, self._steps * _WHOLE + self._place_in_step
            number = (stop * _WHOLE - at) // part
            if self._kicks is not None:
                number = min(number, self._kicks.until(at / _WHOLE, 0.5**level))
            at += part * self._run(level, number)
            self._steps, self._place_in_step = divmod(at, _WHOLE)
            if self._kicks is not None:
                self._kicks.happen(self._particles, self._tools, at / _WHOLE, 0.5**level)
            check_made(self._tools.counts, self.time)

    def _run(self, level: int, number: int) -> int:
        """Let the kernel make so many parts of a step of a level. Returns how many it has made."""
        threads = self._engine.threads if self._engine.threads > 1 else None
        now = self._resolution
        pace = now.pace and now.pace._replace(level=level)
        tools = self._tools._replace(dt=math.ldexp(self.time_step, -level))
        setting = self._layout.Setting(self._space, tools, 0)
        options = self._gravity, self._faces, self._law, now.dense, self._stress, pace
        return self._loop.run_steps(self._particles, now.grid, setting, number, threads, options)

    def reset_tally(self) -> None:
        """Begin to count anew."""
        self._lost = np.array([self.dissipated, self.exchanged])
        for array in self._counted.values():
            array[...] = 0
        if self._kicks is not None:
            self._kicks.given[:] = 0.0
        self._since[:] = self._steps, self._tools.clock[0]

    @property
    def _counted(self) -> dict[str, np.ndarray]:
        """The arrays (threads, ...) that count, by their names in a checkpoint."""
        found = {key: getattr(self._tools, key) for key in self._arrays.TALLY}
        return found | sums_of(self._parts)

    @property
    def _heat(self) -> np.ndarray:
        """(2d, 2) what each face was given by particles that left it at its temperature, in two parts."""
        return self._sums.exact_parts(self._tools.wall_heat)

    @property
    def _loss(self) -> np.ndarray:
        """(2,) the energy that contacts have taken, likewise."""
        return self._sums.exact_parts(self._tools.loss)

    @property
    def _given(self) -> np.ndarray:
        """(1, 2) the energy that kicks have given, likewise."""
        return np.zeros((1, 2)) if self._kicks is None else self._kicks.given

    @property
    def dissipated(self) -> float:
        """The energy that contacts and thermal walls have taken since time 0, less what kicks have given."""
        return float(self._lost[0]) + net(self._loss, self._heat, -self._given)

    @property
    def exchanged(self) -> float:
        """The sum of what contacts and each face have taken or given since time 0, each counted positive."""
        gross = net(self._loss) + float(np.abs(self._heat.sum(axis=1)).sum())
        return float(self._lost[1]) + gross + abs(net(self._given))

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
        tools, layout, value = self._tools, self._layout, self._sums.exact_parts
        more: dict[str, Any] = {}
        for part in self._parts:
            more |= part.counts(0.0)
        counts = tools.counts.sum(axis=0)
        return Tally(
            time=(self._steps - int(self._since[0])) * self.time_step,
            collisions=int(counts[layout.COLLISIONS]),
            wall_hits=tools.wall_hits.sum(axis=0),
            wall_impulse=value(tools.wall_impulse)[..., 0],
            wall_energy=self._heat[:, 0],
            virial_sum=float(value(tools.virial)[0]),
            pair_tests=int(counts[layout.TRIALS]),
            box_visits=0,
            dissipated_energy=float(self._loss[0]),
            thermostat_energy=net(self._given),
            steps=int(tools.clock[0] - self._since[1]),
            **more,
        )

    def checkpoint(self) -> dict[str, np.ndarray]:
        """Everything that a continuation to the same bits needs."""
        return {
            "steps": np.array([self._steps, self._place_in_step, self._tools.clock[0]]),
            "since": self._since.copy(),
            "crowded": np.array(self._resolution.crowded),
            "lost": self._lost.copy(),
            "positions": self._by_particle(0),
            "velocities": self._by_particle(self._scene.dimension),
            "images": self._particles.images.T.copy(),
            "slots": self._slots.copy(),
            **{key: self._over_threads(array) for key, array in self._counted.items()},
            **{key: array.copy() for key, array in arrays_of(self._parts).items()},
            **({"fields": dense.fields.copy()} if (dense := self._resolution.dense) else {}),
        }

    def _over_threads(self, array: np.ndarray) -> np.ndarray:
        """The sum over threads of an array (threads, ...) that counts."""
        exact = array.shape[-1] == self._sums.WIDTH
        return self._sums.joined(array) if exact else array.sum(axis=0)

    def restore(self, parts: dict[str, np.ndarray]) -> None:
        """Go on from a checkpoint of the same scene and engine, by whatever number of threads. Raises
        SceneError, with nothing changed, for one that lacks an array."""
        check_parts(parts, {"crowded": np.array(0)})
        crowded = int(parts["crowded"])
        if not 0 <= crowded <= HIGHEST:
            raise SceneError("checkpoint", crowded, "is no level of density: the checkpoint is damaged")
        wanted, resolution = self.checkpoint(), self._resolution
        if "fields" in wanted:
            wanted["fields"] = np.empty((len(wanted["fields"]), math.prod(resolution.cells_of(crowded))))
        check_parts(parts, wanted)
        if crowded != resolution.crowded:
            resolution.set(crowded)
        self._place(*(parts[key] for key in ("slots", "positions", "velocities", "images")))
        for key, array in self._counted.items():
            array[...] = 0
            array[0] = parts[key]
        for key, array in arrays_of(self._parts).items():
            array[...] = parts[key]
        if resolution.dense:
            resolution.dense.fields[...] = parts["fields"]
        self._steps, self._place_in_step, self._tools.clock[0] = map(int, parts["steps"])
        self._since, self._lost = parts["since"].copy(), parts["lost"].copy()
