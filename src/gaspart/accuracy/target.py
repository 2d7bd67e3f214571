"""Observable to measure in a scene, and the sampling schedule that it needs."""

from __future__ import annotations

import math
import shlex
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from gaspart.accuracy.scales import KNUDSEN
from gaspart.analysis.diffusion import LINEAR_FROM
from gaspart.analysis.impulses import USUAL_BINS, knows_energies, useful_impulses
from gaspart.analysis.observables import (
    OBSERVABLES,
    Named,
    observable_name,
    require_defined,
    require_steady_value,
    walls_of,
)
from gaspart.analysis.paths import MOST_FRAMES
from gaspart.analysis.run import EQUILIBRATION
from gaspart.engines import Engine, reference_engine
from gaspart.errors import SceneError
from gaspart.scene.boundaries import refuse_open
from gaspart.scene.scene import Scene
from gaspart.scene.surfaces import wall_of
from gaspart.simulation import Simulation
from gaspart.state.initial import initial_state
from gaspart.state.optional_tallies import OptionalTally
from gaspart.state.state import State
from gaspart.theory.conditions import Conditions, known_conditions
from gaspart.theory.rates import rate_at_scatterers, rates
from gaspart.trajectory.correlator import Correlations
from gaspart.trajectory.run_options import required_contents

SEED = 0
_FRAMES = 48, 512
_HELD = 20_000_000
"""Maximum number of values in all frames of a pilot, unless there are only few frames."""
_PLACED = 100_000
"""Maximum number of particles in all frames of an observable of pairs; measuring pairs takes longer than
simulating.
"""
_LONGEST_LAG = 10.0
"""Longest lag of correlations in collisions per particle."""
_LEAST_FRAMES = 24
"""Minimum number of frames of a run with correlations; three quarters of these frames suffice for an error.
"""
_FALL = 8.0
"""Number of container crossings in which particles that start at rest are set in motion."""
_COLLIDED = 40.0
"""Number of collisions per particle in which particles that start at rest are set in motion."""


@dataclass(frozen=True)
class Target:
    """Observable of `gaspart measure` in a scene.

    face : for observables of walls, the wall (`x low`); by default all walls.
    settled : steady state of the scene, if it is known.
    """

    scene: Scene
    observable: str
    face: str | None = None
    settled: State | None = field(default=None, compare=False)

    @classmethod
    def from_name(cls, scene: Scene, name: str) -> Target:
        """Return the target of a name, `Z` or `pressure:x low`; SceneError if unknown, undefined or without
        wall.
        """
        observable, colon, face = str(name).partition(":")
        face = wall_of(face)
        observable = observable_name(observable)
        walls = walls_of(observable, scene)
        if scene.count:  # an empty scene has no plan
            _require_defined(scene, observable, name)
        if colon and face not in walls:
            rule = f"must be one of the walls, {', '.join(walls)}" if walls else "has no walls"
            if "face" not in OBSERVABLES[observable].along:
                rule = f"{observable} is not of a wall"
            raise SceneError("observable", name, rule)
        return cls(scene, observable, face or None)

    @cached_property
    def start(self) -> State | None:
        """State from which pilots start; None for the default initial state. A state other than the default
        is a settled state. If particles are compressed and no settled state is known, the state at time 0 is
        stored, because the compression takes long.
        """
        if self.settled is not None:
            return self.settled
        compressed = any(kind.arrangement == "compressed" for kind in self.scene.species if kind.count)
        return initial_state(self.scene, SEED) if compressed and not self.scene.vibrates else None

    @cached_property
    def initial(self) -> State:
        """Initial state of pilots; by default the state at time 0 for their seed."""
        return self.start or initial_state(self.scene, SEED)

    @cached_property
    def conditions(self) -> Conditions | None:
        """Local density and temperature of the steady scene; None if theory does not cover the scene."""
        return known_conditions(self.scene, self.initial)

    @cached_property
    def frequency(self) -> float:
        """Collisions of a particle per time. The frequency is computed from theory, for a gas at its initial
        temperature, or for the column that the gas forms under gravity. In a free-molecular gas between
        walls, it is the number of crossings of the container per time. If the particles start at rest, it is
        measured in the second half of a short run.
        """
        frequency = rates(self.scene, dense=True).frequency + rate_at_scatterers(self.scene)
        if frequency > 0.0:
            gas = self.conditions if self.scene.gravity else None
            frequency *= 1.0 if gas is None or gas.columns is None else gas.quickened
            free = not self.scene.is_periodic and frequency * self.crossing * KNUDSEN < 1.0
            return 1.0 / self.crossing if free else frequency
        simulation = Simulation(self.scene, reference_engine(), SEED, initial=self.start)
        times, counts = [0.0], [0.0]
        while times[-1] < _FALL * self.crossing and counts[-1] < _COLLIDED * self.scene.count:
            simulation.advance(duration=self.crossing / 32.0)
            times.append(simulation.time)
            counts.append(2.0 * float(simulation.tally.collisions))
        half = (len(times) - 1) // 2
        return (counts[-1] - counts[half]) / (self.scene.count * (times[-1] - times[half]))

    @cached_property
    def crossing(self) -> float:
        """Time in which a particle crosses the shortest side; SceneError if nothing moves."""
        scene = self.scene
        squares = [
            kind.temperature / kind.mass if kind.temperature else (kind.speed or 0.0) ** 2
            for kind in scene.species
        ]
        squares += [sum(v * v for v in particle.velocity) for particle in scene.particles]
        squares += scene.face_temperatures
        if scene.gravity:
            squares.append(max(map(abs, scene.gravity)) * min(scene.container.lengths))
        fastest = math.sqrt(max(squares))
        if not fastest > 0.0:
            raise SceneError("temperature", 0.0, "advice is for moving particles")
        return min(scene.container.lengths) / fastest

    @property
    def declared(self) -> Named:
        """Entry of the observable in the table of all observables."""
        return OBSERVABLES[self.observable]

    @property
    def name(self) -> str:
        """Name of the observable, with its wall."""
        return f"{self.observable}:{self.face}" if self.face else self.observable

    @property
    def needs_paths(self) -> bool:
        """True if the observable needs displacements in the frames."""
        return self.declared.needs == "paths"

    @property
    def correlated(self) -> bool:
        """True if the run accumulates correlations."""
        return self.declared.lags > 0

    def tallies(self, engine: Engine) -> tuple[OptionalTally, ...]:
        """Return the optional tallies with which a run of an engine measures the observable more accurately.
        For pressures on walls across a single axis, the tallies are along this axis.
        """
        if not self.declared.by_impulses:
            return ()
        axes = {self.scene.dimension - 1}
        if "face" in self.declared.along:
            faces = [self.face] if self.face else walls_of(self.observable, self.scene)
            axes = {"xyz".index(face[0]) for face in faces} if knows_energies(engine, self.scene) else set()
        if len(axes) != 1:
            return ()
        return useful_impulses(self.scene, engine.tallies, axes.pop(), USUAL_BINS)

    def contents(self, engine: Engine) -> dict[str, Any]:
        """Return the fields of `Contents` that a run needs for the observable, without correlations."""
        return {**required_contents({self.declared.needs}), "tallies": self.tallies(engine)}

    @property
    def span(self) -> tuple[float, float]:
        """Maximum time between frames and length of a run that lose no accuracy; for diffusion by
        its lags.
        """
        if self.declared.samples != "paths" or not self.frequency > 0.0:
            return math.inf, math.inf
        interval = 0.5 * LINEAR_FROM / self.frequency
        return interval, interval * MOST_FRAMES / (1.0 - EQUILIBRATION)

    def schedule(self, engine: Engine, length: float) -> tuple[float, float, Correlations | None]:
        """Return duration, time between frames and correlations of a run of about a given length."""
        if self.correlated:
            return self._schedule_correlations(engine, length)
        least, most = _FRAMES
        longest_interval, longest = self.span
        length = min(length, longest)
        numbers = max(1, 3 * self.scene.count * self.scene.dimension)
        if self.declared.samples == "structure":
            most = max(least, min(most, _PLACED // max(1, self.scene.count)))
        frames = int(np.clip(_HELD // numbers, least, most))
        interval = min(length / frames, longest_interval)
        frames = math.ceil(length / interval * (1.0 - 1e-9))
        if quantum := engine.for_scene(self.scene).quantum:
            interval = max(1, round(interval / quantum)) * quantum
        return frames * interval, interval, None

    def correlations(self, engine: Engine) -> Correlations:
        """Return the correlations that the observable needs; SceneError for a scene without collisions."""
        lags = self.declared.lags
        if not self.frequency > 0.0:
            raise SceneError("observable", self.observable, "needs particles that collide")
        sample = float(f"{_LONGEST_LAG / lags / self.frequency:.1g}")
        if quantum := engine.for_scene(self.scene, sample).quantum:
            sample = rounded_to_12_digits(max(1, round(sample / quantum)) * quantum)
        return Correlations(sample, lags, stress=self.declared.needs == "fluxes")

    def _schedule_correlations(self, engine: Engine, length: float) -> tuple[float, float, Correlations]:
        """Return the `schedule` with correlations; the time between frames is at least the longest lag."""
        correlations = self.correlations(engine)
        sample = correlations.interval
        per_frame = max(correlations.lags, round(length / sample / _FRAMES[0]))
        interval = rounded_to_12_digits(per_frame * sample)
        return (
            rounded_to_12_digits(max(_LEAST_FRAMES, round(length / interval)) * interval),
            interval,
            correlations,
        )


def _require_defined(scene: Scene, observable: str, name: str) -> None:
    """Raise SceneError, with the command line's name, if an observable is undefined in a scene."""
    try:
        require_defined(observable, scene)
        require_steady_value(observable, scene)
        until = shlex.quote(f"{name}=0.01")
        remedy = f"`gaspart run SCENE -o run.nc --until {until}` ends when the error is that small"
        refuse_open(scene, f"lets particles enter and leave, and no cost is predicted; {remedy}")
    except SceneError as error:
        raise SceneError("observable", name, f"{error.key}: {error.rule}") from None


def rounded_to_12_digits(multiple: float) -> float:
    """Round a multiple to 12 digits, so that commands do not show its rounding error."""
    return float(f"{multiple:.12g}")
