"""Dynamics of a scene under the DSMC engine."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from gaspart.engines.dsmc.arrays import TALLY, empty_particles, faces_for, kinds_of, law_for, workspace_for
from gaspart.engines.dsmc.defaults import FINEST
from gaspart.engines.dsmc.resolution import EPOCH, HIGHEST, Resolution
from gaspart.engines.dynamics import check_parts
from gaspart.engines.features.faces import OpenPart, crowded_error, open_of, reservoirs_of, with_room
from gaspart.engines.features.law import LawPart, contact_law
from gaspart.engines.features.part import Part, TallyPart, step_kicks
from gaspart.engines.features.tallies import ThreadedPerAreaPart, tallied_fluxes
from gaspart.engines.step.limits import oversized_particles
from gaspart.engines.stepped import SteppedDynamics
from gaspart.errors import SceneError, SimulationError
from gaspart.kernels.dsmc import loop
from gaspart.kernels.dsmc import model as layout
from gaspart.kernels.dsmc.boltzmann import Stress
from gaspart.kernels.dsmc.model import kick_all
from gaspart.kernels.model import Space
from gaspart.kernels.physics.exact_sum import WIDTH, exact_parts, sum_over_threads
from gaspart.scene.boundaries import mean_count, refuse_open
from gaspart.scene.scene import Scene
from gaspart.state.optional_tallies import OptionalTally
from gaspart.state.state import State, drift_of

if TYPE_CHECKING:
    from gaspart.engines.dsmc.settings import DsmcSettings


# Scenes that the DSMC engine supports.


MOST_PARTICLES = 2**32 - 1
_OVERSIZED = (
    'needs the "event" or the "step" engine: a few particles that are much larger than the others have no '
    "partners to be drawn from"
)


def check_scene(scene: Scene, state: State) -> None:
    """Raise SceneError if the engine does not model these particles, or if there are too many."""
    if oversized_particles(state).any():
        raise SceneError("radius", scene.largest_radius, _OVERSIZED)
    if state.count > MOST_PARTICLES:
        raise SceneError("count", state.count, f"the DSMC engine takes {MOST_PARTICLES} particles at most")
    if (mean := mean_count(scene)) > scene.capacity:
        rule = f"lets in {mean:.3g} particles of an ideal gas, of which {scene.capacity} fit"
        refuse_open(scene, f'{rule}: a reservoir of this density needs the "event" engine')


def check_made(counts: np.ndarray, time: float, most: int) -> None:
    """Raise SimulationError if steps could not be completed; `most` is the maximum number of particles."""
    from gaspart.kernels.dsmc.model import CROWDED, FAR, UNFINISHED

    if counts[:, UNFINISHED].any():
        raise SimulationError(
            f"at time {time:g} a particle has met faces of the container more than 2^24 times in a step,"
            " which is not finished: give a shorter time_step"
        )
    if counts[:, CROWDED].any():
        raise crowded_error(time, most)
    if counts[:, FAR].any():
        raise SimulationError(
            f"at time {time:g} a particle has crossed the container 2^31 times along a periodic axis,"
            " more often than is counted"
        )


# Optional tallies of the DSMC engine. Threads add to them without rounding errors.


class StressPart(TallyPart):
    """Stress tensor and heat flux relative to the initial velocity of the centre of mass."""

    kernel: Stress

    def __init__(self, tally: OptionalTally, scene: Scene, state: State, threads: int) -> None:
        d = scene.dimension
        number = 2 * d * d + d
        sums, cell = np.zeros((threads, number, WIDTH), np.int64), np.zeros((threads, number))
        kernel = Stress(sums, cell, np.zeros((threads, 2, d + 1)), drift_of(scene, state))
        super().__init__("stress", kernel, {}, {"stress": sums})

    def read(self, clock: float) -> np.ndarray:
        """Return the sums (2 d^2 + d,) of stress tensor, collisional part and heat flux."""
        return exact_parts(self.kernel.sums)[:, 0]

    def counts(self, clock: float) -> dict[str, Any]:
        return tallied_fluxes(self.read(clock), self.kernel.drift)


class WallShearPart(Part):
    """Tangential momentum given to faces.

    shear : (threads, 2d, d, WIDTH)
    """

    def __init__(self, shear: np.ndarray) -> None:
        super().__init__({}, sums={"shear": shear})

    def counts(self, clock: float) -> dict[str, Any]:
        return {"wall_shear": exact_parts(self.sums["shear"])[..., 0]}


PARTS = {"stress": StressPart}
"""Classes of the parts for optional tallies, by name."""


def tally_parts(
    tallies: Iterable[OptionalTally], scene: Scene, state: State, threads: int
) -> list[TallyPart]:
    """Return the parts for optional tallies. `state`: state at time 0."""
    return [PARTS[tally.name](tally, scene, state, threads) for tally in tallies]


_WHOLE = 2**FINEST
"""Number of equal subdivisions of a step in which the position within the step is counted."""


class DsmcDynamics(SteppedDynamics):
    """Dynamics of a scene under the DSMC engine. Its time is an integer number of steps. A step may be
    divided into parts, and cells may become narrower: see `defaults` and `resolution`.

    time_step : length of a step, prescribed or chosen by the engine
    """

    numbers = ("steps", "since", "place_in_step", "clock_since")

    def __init__(
        self,
        engine: DsmcSettings,
        scene: Scene,
        state: State,
        seed: int | tuple[int, ...],
        tallies: Sequence[OptionalTally] = (),
    ) -> None:
        engine.check_features(scene)
        check_scene(scene, state)
        state = with_room(scene, state)
        self._open = open_of(scene, state)
        self._reservoirs = reservoirs_of(scene, seed, self._open) if self._open else None
        self._resolution = Resolution(engine, scene, state, len(kinds_of(state)[0]), self._open)
        super().__init__(scene, state, self._resolution.step, engine.threads)
        self._particles = empty_particles(state)
        self._workspace = workspace_for(engine, scene, state, self.time_step, seed)
        self._space = Space(scene.container.lengths, scene.container.periodic, self._workspace.margin)
        law = contact_law(scene, state)
        self._faces, self._law = faces_for(scene, engine.threads, self._open), law_for(law)
        self._kicks = step_kicks(scene, self.time_step, seed)
        parts = (
            LawPart(law) if law else None,
            self._kicks,
            WallShearPart(self._faces.shear) if self._faces and self._faces.shear is not None else None,
            ThreadedPerAreaPart(self._workspace.per_area, _per_area) if scene.has_unequal_areas else None,
            OpenPart(scene, self._open, self._reservoirs) if self._open else None,
        )
        optional = tally_parts(tallies, scene, state, engine.threads)
        self._parts = [*(part for part in parts if part), *optional]
        self._optional = {part.name: part.kernel for part in optional}
        for part in self._parts:
            part.set_clock(0.0)
        middle = 0.5 * np.array(scene.container.lengths)  # where slots without a particle are at rest
        positions = np.where(np.isnan(state.positions), middle, state.positions)
        self._place(np.arange(state.count), positions, state.velocities, state.images)
        self._place_in_step = self._clock_since = 0
        self._look()

    @property
    def cells_per_side(self) -> tuple[int, ...]:
        """Present number of cells along each axis (d,)."""
        return self._resolution.cells

    def _look(self) -> None:
        """Adapt the cells to the present density of the gas."""
        if self._resolution.crowds:
            positions = self._positions.T
            if self._open:
                positions = positions[self._open.present[self._slots] > 0]
            self._resolution.look(positions, self.time)

    def _place(
        self, slots: np.ndarray, positions: np.ndarray, velocities: np.ndarray, images: np.ndarray
    ) -> None:
        particles, d = self._particles, self._scene.dimension
        particles.rows[:-1] = np.arange(2 * d + 1)
        particles.rows[-1] = 0
        particles.data[:d] = positions[slots].T
        particles.data[d : 2 * d] = velocities[slots].T
        particles.numbers[0] = slots
        particles.images[...] = images.T

    @property
    def _slots(self) -> np.ndarray:
        return self._particles.numbers[self._particles.rows[-1]]

    @property
    def _positions(self) -> np.ndarray:
        return self._particles.data[self._particles.rows[: self._scene.dimension]]

    @property
    def _velocities(self) -> np.ndarray:
        d = self._scene.dimension
        return self._particles.data[self._particles.rows[d : 2 * d]]

    @property
    def _images(self) -> np.ndarray:
        return self._particles.images

    @property
    def _progress(self) -> float:
        return self._steps + self._place_in_step / _WHOLE

    def _advance_to(self, step: int) -> None:
        while self._steps < step:
            epoch = self._steps - self._steps % EPOCH + EPOCH
            self._make(min(step, epoch) if self._resolution.crowds else step)
            if self._steps % EPOCH == 0:
                self._look()
        self._resolution.warn_of_speed(self.time)

    def _make(self, stop: int) -> None:
        """Perform all steps up to the step `stop`."""
        while self._steps < stop:
            level = self._resolution.level(self._particles, self._place_in_step, self.time)
            part, at = _WHOLE >> level, self._steps * _WHOLE + self._place_in_step
            number = (stop * _WHOLE - at) // part
            if self._kicks is not None:
                number = min(number, self._kicks.until(at / _WHOLE, 0.5**level))
            at += part * self._run(level, number)
            self._steps, self._place_in_step = divmod(at, _WHOLE)
            if self._kicks is not None and (kick := self._kicks.due(at / _WHOLE, 0.5**level)):
                kick_all(self._particles, self._workspace, *kick, self._kicks.given_terms)
            check_made(self._workspace.counts, self.time, self._scene.capacity)

    def _run(self, level: int, number: int) -> int:
        """Run the kernel for some of the 2^level parts of a step, and return the number of completed ones."""
        now = self._resolution
        pace = now.pace and now.pace._replace(level=level)
        workspace = self._workspace._replace(dt=math.ldexp(self.time_step, -level))
        context = layout.ThreadContext(self._space, workspace, 0)
        stress = self._optional.get("stress")
        options = (self._scene.gravity, self._faces, self._law, now.dense, stress, pace, self._reservoirs)
        return loop.run_steps(self._particles, now.grid, context, number, self._threads, options)

    def reset_tally(self) -> None:
        super().reset_tally()
        self._clock_since = int(self._workspace.clock[0])

    @property
    def _heat(self) -> np.ndarray:
        return exact_parts(self._workspace.wall_heat)

    @property
    def _loss(self) -> np.ndarray:
        return exact_parts(self._workspace.loss)[np.newaxis]

    @property
    def _given(self) -> np.ndarray:
        return super()._given if self._kicks is None else self._kicks.given_terms

    def _sums(self) -> dict[str, np.ndarray]:
        return {key: getattr(self._workspace, key) for key in TALLY}

    def _sum_threads(self, sums: np.ndarray) -> np.ndarray:
        return sum_over_threads(sums) if sums.shape[-1] == WIDTH else super()._sum_threads(sums)

    def _counts(self) -> dict[str, Any]:
        workspace, counts = self._workspace, self._workspace.counts.sum(axis=0)
        return {
            "collisions": int(counts[layout.COLLISIONS]),
            "wall_hits": workspace.wall_hits.sum(axis=0),
            "wall_impulse": exact_parts(workspace.wall_impulse)[..., 0],
            "virial_sum": float(exact_parts(workspace.virial)[0]),
            "pair_tests": int(counts[layout.TRIALS]),
            "box_visits": 0,
            "steps": int(workspace.clock[0] - self._clock_since),
        }

    def _arrays(self) -> dict[str, np.ndarray]:
        return {**super()._arrays(), "clock": self._workspace.clock}

    def _checkpoint_data(self) -> dict[str, Any]:
        dense = self._resolution.dense
        fields = {"fields": dense.fields} if dense else {}
        return {**super()._checkpoint_data(), "crowded": self._resolution.crowded, **fields}

    def _required_arrays(self, checkpoint: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        """Return the data required from a checkpoint, with fields for its density level."""
        check_parts(checkpoint, {"crowded": np.array(0)})
        crowded = int(checkpoint["crowded"])
        if not 0 <= crowded <= HIGHEST:
            raise SceneError("checkpoint", crowded, "is no level of density: the checkpoint is damaged")
        required = self.checkpoint()
        if "fields" in required:
            required["fields"] = np.empty(
                (len(required["fields"]), math.prod(self._resolution.cells_of(crowded)))
            )
        return required

    def _place_again(self, checkpoint: dict[str, np.ndarray]) -> None:
        resolution, crowded = self._resolution, int(checkpoint["crowded"])
        if crowded != resolution.crowded:
            resolution.set(crowded)
        if resolution.dense:
            resolution.dense.fields[...] = checkpoint["fields"]
        super()._place_again(checkpoint)


def _per_area(sums: np.ndarray) -> np.ndarray:
    """Return the sums divided by the accessible area."""
    return exact_parts(sums)[..., 0]
