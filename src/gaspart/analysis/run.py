"""Measured part of a run, from a trajectory or a simulation."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, fields, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import xarray as xr

from gaspart import analysis, theory
from gaspart.analysis.conditions import SLIDING, VARYING
from gaspart.analysis.flow import Peculiar, about_the_flow, mean_motion, sum_squares
from gaspart.analysis.observables import OBSERVABLES, require_selection
from gaspart.analysis.run_data import ABOUT, FLOW, RunData
from gaspart.engines import engine_to_dict
from gaspart.errors import SceneError
from gaspart.keys.values import count_of, number, one_of
from gaspart.scene.boundaries import refuse_open, refuse_sheared
from gaspart.scene.facts import Gas, Mixture
from gaspart.scene.scene import Scene
from gaspart.simulation import Simulation
from gaspart.state.state import by_number
from gaspart.state.tally import Tally
from gaspart.trajectory.correlator import PairCounter
from gaspart.trajectory.reading import open_trajectory
from gaspart.trajectory.run_options import tallies_to_json
from gaspart.yaml_text import dump_yaml, parse_yaml

if TYPE_CHECKING:
    import xarray as xr

    from gaspart.analysis.observable import Observable


Source: TypeAlias = str | Path | xr.Dataset | Simulation

EQUILIBRATION = 0.25
"""Fraction of a run that is discarded, unless the caller passes a time."""
REPEATED = 129
"""Number of frames if a simulation is run again for a measurement; fewer if there are many particles."""
_AT_REST = 1e-24  # fraction of a kinetic energy: the square of a rounding error
_MOST = 20_000_000  # maximum number of values in these frames


@dataclass(frozen=True)
class Run(RunData):
    """Measured part of a run, with temperatures and the gas that theory knows."""

    @cached_property
    def motion(self) -> Peculiar:
        """Velocities of moving particles relative to the local flow if the gas flows, else to the centre of
        mass.
        """
        return about_the_flow(self)

    @property
    def peculiar(self) -> np.ndarray:
        """Velocities (T, M, d) of `motion`."""
        return self.motion.velocities

    @cached_property
    def freedoms(self) -> np.ndarray:
        """Translational degrees of freedom in each frame (T,); SceneError without any."""
        moving = int(self.moving.sum())
        values = np.full(len(self.time), self.dimension * moving - int(self.conserved.sum()), dtype=float)
        if self.flow_axes:
            values = self._energies[2]
        if not values.min() >= 1.0:
            raise SceneError("count", moving, "too few moving particles for a temperature")
        return values

    @property
    def freedom(self) -> float:
        """Mean number of degrees of freedom over the frames; an integer unless the gas flows."""
        return float(self.freedoms.mean())

    @cached_property
    def temperatures(self) -> np.ndarray:
        """Temperature k_B T of each frame, shape (T,). The temperature is twice the translational kinetic
        energy per degree of freedom, relative to the mean motion (see `motion`). It is set to 0 if this
        energy is only a rounding error of the centre-of-mass velocity. If the file does not contain all
        particles, the temperature is computed by `_of_all`. Raises SceneError under the conditions of
        `freedoms`.
        """
        refuse_open(self.scene, "changes the particles: there is no temperature of the whole run")
        lacking = self.is_subset or "velocities" not in self.data
        if lacking and (self.centred or "stress_sum" in self.data):
            return self._of_all
        freedoms, masses, scene = self.freedoms, self.masses[self.moving], self.scene
        if self.flow_axes or scene.rough or scene.thermostat or scene.shear_rate is not None:
            energies, total, _ = self._energies
        else:  # the energy has double precision, and the momentum is the same in all frames
            total = 2.0 * self.data["kinetic_energy"].values
            first = self.frame("velocities", 0)[self.moving]
            momentum = np.where(self.conserved, masses @ first, 0.0)
            energies = total - (momentum @ momentum) / (masses.sum() or 1.0)
        moves = energies.mean() > _AT_REST * total.mean()
        return np.asarray(energies / freedoms) if moves else np.zeros(len(self.time))

    @cached_property
    def _energies(self) -> np.ndarray:
        """Twice the energy relative to the flow, twice that relative to rest, and degrees of freedom
        (3, T).
        """
        masses, about, rows = self.masses[self.moving], mean_motion(self), []
        for _, part in self.parts():
            motion = about(part)
            squares = sum_squares(part.velocities[:, self.moving])
            energies = motion.energies(masses).sum(axis=1)
            rows.append([energies, (masses * squares).sum(axis=1), motion.freedoms().sum(axis=1)])
        return np.concatenate(rows, axis=1)

    @property
    def _of_all(self) -> np.ndarray:
        """Temperature k_B T (T,) of each frame, from the energy of all particles. The run must be centred or
        contain the tally of the stress. The energy includes rotation and is relative to the centre of mass of
        all particles, even if the file contains only some of them.
        """
        d, count = self.dimension, self.count
        freedom = d * count - int(self.conserved.sum()) + self.scene.rough * count * (d * (d - 1) // 2)
        if freedom < 1:
            raise SceneError("count", count, "too few moving particles for a temperature")
        drift = self.data["flux_velocity"].values[-1] if "flux_velocity" in self.data else np.zeros(d)
        drift = drift * (self.about == FLOW)
        drift_energy = self.masses.sum() * (drift @ drift)
        return np.asarray((2.0 * self.data["kinetic_energy"].values - drift_energy) / freedom)

    @cached_property
    def temperature(self) -> float:
        """Mean of `temperatures` over the frames, k_B T."""
        return float(self.temperatures.mean())

    @property
    def has_gravity(self) -> bool:
        """True if gravity acts."""
        return bool(np.any(self.scene.gravity))

    @property
    def dissipates(self) -> bool:
        """True if contacts lose energy."""
        return self.scene.dissipates

    @property
    def fluid(self) -> Gas | None:
        """Gas of at least two particles in a periodic container, as a fluid within its equation of state;
        else None.
        """
        gas = self.scene.gas
        if gas is None or gas.count < 2 or not self.periodic.all():
            return None
        return gas if self._is_fluid else None

    @property
    def _is_fluid(self) -> bool:
        """True if the density is in the range of the fluid, and the run does not begin in a crystal. Above
        the freezing density a crystal does not melt, whereas a compressed fluid remains one for long.
        """
        scene = self.scene
        if scene.packing_fraction > theory.HIGHEST_PACKING_FRACTION[scene.dimension]:
            return False
        lattice = any(kind.arrangement == "lattice" for kind in scene.species)
        given = "initial_positions" in self.data
        freezing = theory.coexistence_packing_fractions(scene.dimension)[0]
        return scene.packing_fraction <= freezing or not (lattice or given)

    @property
    def mixture(self) -> Mixture | None:
        """Mixture of the scene, in which identical species are combined; None as for `fluid`."""
        mixture = self.scene.mixture
        if mixture is None or not self.periodic.all() or self.count < 2:
            return None
        return mixture if self._is_fluid else None

    @property
    def moving_fluid(self) -> Gas | None:
        """The `fluid` at the temperature of the run; None if nothing moves."""
        gas = self.fluid
        return replace(gas, temperature=self.temperature) if gas and self.temperature > 0.0 else None


def select_particles(run: Run, species: int | None, particles: Sequence[int] | None) -> np.ndarray:
    """Return indices of the selected particles among the moving particles (M,); by default all. `species`:
    species number, as in `Run.species`. `particles`: particle numbers, as in the file. Raises SceneError if
    both arguments are passed, if a number does not exist, and if no selected particle moves.
    """
    moving = np.flatnonzero(run.moving)
    if species is not None and particles is not None:
        raise SceneError("species", species, "excludes particles")
    chosen = np.arange(len(moving))
    if species is not None:
        kinds = len(run.scene.species) + bool(run.scene.particles)
        if count_of("species", species) >= kinds:
            raise SceneError("species", species, f"there are {kinds}, numbered from 0")
        chosen = np.flatnonzero(run.species[moving] == species)
    if particles is not None:
        indices = [count_of("particles", index) for index in particles]
        if any(index >= run.count for index in indices):
            raise SceneError("particles", max(indices), f"there are {run.count}, numbered from 0")
        chosen = np.flatnonzero(np.isin(moving, indices))
    if not chosen.size:
        key, value = ("species", species) if particles is None else ("particles", list(particles))
        raise SceneError(key, value, "none of them moves")
    return chosen


def require_collisions(run: Run) -> None:
    """Raise SceneError without a collision in the measured run: the scatter would be unknown."""
    if not run.increments("collisions").any():
        raise SceneError("collisions", 0, "none happened in the measured part; make a longer run")


@contextmanager
def open_run(
    source: Source,
    start: float | None,
    pairs: bool = False,
    sheared: bool = False,
    varying: bool = False,
    about: str = FLOW,
) -> Iterator[Run]:
    """Open the part of a source after the time `start`. By default the first quarter of the run is discarded.
    A simulation is run again from its start to its present time. If `pairs` is True, the collisions of each
    pair of species are counted. `sheared`: True if the observable is defined in a sheared gas. `varying`:
    True if the observable is defined with open faces. `about`: see `Run`. Raises SceneError if the observable
    is undefined for the scene, if there are fewer than two frames, and for input that `open_trajectory`
    rejects.
    """
    one_of("about", about, ABOUT)
    if isinstance(source, Simulation):
        opened = nullcontext(repeat_run(source, pairs))
    elif isinstance(source, xr.Dataset):
        opened = nullcontext(source)
    else:
        opened = open_trajectory(source)
    with opened as data:
        if "scene" not in data.attrs or "kinetic_energy" not in data:
            raise SceneError(
                "source", type(source).__name__, "must be a trajectory, its path or a simulation"
            )
        time = data["time"].values
        last = float(time[-1]) if len(time) else 0.0
        begin = EQUILIBRATION * last if start is None else number("start", start, "must be a finite number")
        chosen = time >= begin - 1e-9 * last
        if chosen.sum() < 2:
            raise SceneError("start", begin, f"leaves {chosen.sum()} frames of a run until time {last:g}")
        part = data.isel(frame=slice(int(np.argmax(chosen)), None))
        scene = Scene.from_dict(parse_yaml(data.attrs["scene"]))
        if not sheared:
            refuse_sheared(scene, SLIDING)
        if not varying:
            refuse_open(scene, VARYING)
        yield Run(scene, time[chosen], part, about=about)


def repeat_run(simulation: Simulation, pairs: bool = False) -> xr.Dataset:
    """Run a simulation again and return evenly spaced frames; SceneError if it has not advanced."""
    scene, engine = simulation.scene, simulation.engine
    if simulation.time <= 0.0:
        raise SceneError("simulation", "at time 0", "has not advanced; call advance(duration=...) first")
    frames = int(np.clip(_MOST // (3 * max(1, scene.count) * scene.dimension), 33, REPEATED))
    times = np.linspace(0.0, simulation.time, frames)
    if step := engine.quantum:  # half a step more, so that rounding does not lose a step
        steps = max(1, round(simulation.time / step) // (frames - 1))
        times = np.append(0.0, (steps * np.arange(1, frames) + 0.5) * step)
        times = times[times < simulation.time + step]
    again, rows = simulation.again(), []
    counter = PairCounter(again) if pairs else None
    for time in times:
        again.advance(until=time)
        row = frame_of(again)
        if counter:
            counter.take()
            row["pair_collisions"] = counter.counts.copy()
        rows.append(row)
    return with_frames(simulation, rows)


def frame_of(simulation: Simulation) -> dict[str, Any]:
    """Return the present state of a simulation as the variables of a frame."""
    state, scene = simulation.state, simulation.scene
    vectors = {"coordinates": state.positions, "velocities": state.velocities}
    vectors["displacements"] = state.unwrapped
    row = {name: by_number(state, values, scene.capacity) for name, values in vectors.items()}
    if state.piston is not None:
        row["piston_position"] = state.piston[0]
    row = {**vars(simulation.tally), **row, "time": simulation.time, "kinetic_energy": state.kinetic_energy}
    return {name: value for name, value in row.items() if value is not None}


def with_frames(simulation: Simulation, rows: Sequence[dict[str, Any]]) -> xr.Dataset:
    """Return the frames `rows` of a simulation in the form of a trajectory."""
    scene, engine = simulation.scene, simulation.engine
    columns = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    columns["displacements"] = columns["displacements"] - columns["displacements"][0]
    if scene.is_open:
        del columns["displacements"]  # displacements have no common initial position
    sums = {field.name: field.metadata.get("along", ()) for field in fields(Tally)}
    along = {**dict.fromkeys(("coordinates", "displacements", "velocities"), ("atom", "spatial")), **sums}
    along["pair_collisions"] = ("pair",)
    return xr.Dataset(
        {name: (("frame", *along.get(name, ())), values) for name, values in columns.items()},
        attrs={
            "scene": dump_yaml(scene.to_dict()),
            "engine": json.dumps(engine_to_dict(engine)),
            "tallies": tallies_to_json(simulation.tallies),
        },
    )


def measure_single(
    source: Source, name: str, start: float | None = None, end: float | None = None, **selection: Any
) -> Observable:
    """Measure an observable of one run by its name, without a remark on drifts; see `measuring.measure`."""
    declared = OBSERVABLES[name]
    require_selection(name, selection)
    function = getattr(analysis, declared.function)
    with until_time(source, end, declared.needs == "pairs") as part:
        result: Observable = function(part, start=start, **declared.arguments, **selection)
    return result


@contextmanager
def until_time(source: Source, end: float | None, pairs: bool = False) -> Iterator[Source]:
    """Return the frames of a source up to `end`, with collisions of each pair of species if `pairs`."""
    if end is None:
        yield source
        return
    from gaspart.keys.values import number

    with open_frames(source, pairs) as data:
        time = data["time"].values
        last = number("end", end, "must be a finite number")
        count = int((time <= last + 1e-9 * abs(last)).sum())
        if count < 2:
            longest = float(time[-1]) if len(time) else 0.0
            raise SceneError("end", end, f"leaves {count} frames of a run until time {longest:g}")
        yield data.isel(frame=slice(count))


@contextmanager
def open_frames(source: Source, pairs: bool = False) -> Iterator[xr.Dataset]:
    """Yield the frames of a source; they are read or computed only once."""
    from gaspart.simulation import Simulation
    from gaspart.trajectory.reading import open_trajectory

    if isinstance(source, Simulation):
        source = repeat_run(source, pairs)
    with open_trajectory(source) if isinstance(source, str | Path) else nullcontext(source) as data:
        yield data
