"""Parts of a run; each part implements one feature of a scene.

A module of this package contains all that engines need for a feature: the data of the feature in the kernel
model (None if the scene does not have the feature), and a `Part`. An engine calls the same methods of all
parts of a scene, and does not depend on any particular feature.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from gaspart.kernels.model import Gravity, Model, Shear, no_support
from gaspart.scene.faces import FLOW, GRADIENT
from gaspart.scene.restitution import Thermostat
from gaspart.scene.scene import Scene
from gaspart.state.random import key_of
from gaspart.state.state import State

if TYPE_CHECKING:
    from gaspart.kernels.model import Model, Particles, Tally


class Part:
    """State of a feature during a run. Its methods do nothing by default."""

    gained = 0.0

    def __init__(
        self,
        arrays: dict[str, np.ndarray],
        times: Iterable[np.ndarray] = (),
        scheduled: np.ndarray | None = None,
        sums: dict[str, np.ndarray] | None = None,
    ) -> None:
        self.sums = sums or {}
        self.arrays, self._times, self._scheduled = arrays, times, scheduled

    @property
    def next(self) -> float:
        """Time of the next scheduled event on the clocks of the epoch; infinite without an event."""
        return math.inf if self._scheduled is None else float(self._scheduled[0])

    @property
    def at_rest(self) -> bool:
        """True if the part has permanently stopped all particles."""
        return False

    @property
    def stored(self) -> float:
        """Energy that particles store in this feature and that contacts may convert to motion."""
        return 0.0

    @property
    def given(self) -> float:
        """Energy added by scheduled events of the part since the last `reset`."""
        return 0.0

    def set_clock(self, clock: float) -> None:
        """Set the present time, on the clocks of the epoch, at the start of a run."""

    def begin_epoch(self, length: float, start: float, model: Model) -> Model:
        """Set data that depend on the epoch, of this length and start; return the kernel model with them."""
        return model

    def close_epoch(self, length: float) -> None:
        """Add the contribution of flights in an epoch of this length before particles move to its end."""

    def end_epoch(self, length: float, start: float) -> None:
        """Shift the times of the part to a new origin of the clocks. At the end of an epoch with this
        `length`, the clocks restart from zero at the time `start`. If epochs become shorter within an epoch,
        the clocks continue with the new origin `start`.
        """
        for times in self._times:
            times -= length

    def apply_event(self, particles: Particles, model: Model, tally: Tally, start: float) -> bool:
        """Perform the event due at `next`; return True if all events must be predicted again."""
        raise NotImplementedError

    def reset(self, clock: float) -> None:
        """Reset the counters at this time on the clocks of the epoch."""
        for sums in self.sums.values():
            sums[...] = 0

    def counts(self, clock: float) -> dict[str, Any]:
        """Return the counters since the last `reset`, by their names in `Tally`, at `clock` of the epoch."""
        return {}

    def write(self, state: State, clock: float) -> None:
        """Write the properties of this feature, at `clock` of the epoch, into a state."""


class TallyPart(Part):
    """Optional tally during a run (`state.tally`).

    name : name of the tally
    kernel : data to which the kernels add: the field `name` of the kernels' tally
    """

    def __init__(
        self,
        name: str,
        kernel: Any,
        arrays: dict[str, np.ndarray],
        sums: dict[str, np.ndarray] | None = None,
    ) -> None:
        super().__init__(arrays, sums=sums)
        self.name, self.kernel = name, kernel

    def read(self, clock: float) -> np.ndarray:
        """Return all sums since the last `reset`, at `clock` of the epoch, in one array."""
        raise NotImplementedError


def arrays_of(parts: Iterable[Part]) -> dict[str, np.ndarray]:
    """Return the arrays of several parts, by name."""
    return {key: array for part in parts for key, array in part.arrays.items()}


def sums_of(parts: Iterable[Part]) -> dict[str, np.ndarray]:
    """Return the arrays `sums` of several parts, by name."""
    return {key: array for part in parts for key, array in part.sums.items()}


def write_parts(parts: Iterable[Part], state: State, clock: float = 0.0) -> None:
    """Write the properties of several parts into a state. Vibrational energies are added."""
    if state.vibrations is not None:
        state.vibrations = np.zeros(state.count)
    for part in parts:
        part.write(state, clock)


# Gravity, and particles that it holds on interior walls.


_SHORTEST_BOUNCE = 2.0**-44  # longest bounce on a floor that counts as rest, in epochs
_LOWEST = 2.0**-44  # highest bounce on an interior wall that counts as rest, in container lengths


def gravity_of(scene: Scene, state: State) -> Gravity | None:
    """Return the initial data of gravity for the kernels; None without gravity."""
    if scene.gravity is None:
        return None
    height = _LOWEST * max(scene.container.lengths)
    support = no_support(state.count, height) if scene.walls else None
    return Gravity(scene.gravity, np.isinf(state.masses), 0.0, support)


class GravityPart(Part):
    """Gravity in a container with sides `lengths`, and support of particles at interior walls."""

    def __init__(self, gravity: Gravity, lengths: tuple[float, ...]) -> None:
        support = gravity.support._asdict() if gravity.support else {}
        super().__init__({f"support_{key}": array for key, array in support.items() if key != "height"})
        falls = (abs(g) * length for g, length in zip(gravity.acceleration, lengths, strict=True))
        self.gained = 2.0 * sum(falls)

    def begin_epoch(self, length: float, start: float, model: Model) -> Model:
        """Set the duration below which a bounce means rest, because clocks do not resolve it."""
        assert model.gravity is not None  # otherwise this part would not exist
        return model._replace(gravity=model.gravity._replace(shortest_bounce=_SHORTEST_BOUNCE * length))


# Periodic faces whose images slide (`scene.faces.LeesEdwards`).


def shear_of(scene: Scene) -> Shear | None:
    """Return the initial shear of a scene, or None."""
    rate = scene.shear_rate
    if rate is None:
        return None
    velocity = rate * scene.container.lengths[GRADIENT]
    return Shear(rate, velocity, np.zeros(1), np.zeros(1, dtype=np.int64), np.zeros(3))


class ShearPart(Part):
    """Displacement of the periodic images in a sheared scene. The displacement follows from the time and the
    initial state, so that checkpoints need not contain it. At each crossing of a sheared face, a particle may
    gain the velocity of the images.
    """

    def __init__(self, scene: Scene, state: State, shear: Shear) -> None:
        super().__init__({})
        self._shear, self._length = shear, scene.container.lengths[FLOW]
        self._start = state.displaced or 0.0
        self.gained = shear.velocity**2

    def begin_epoch(self, length: float, start: float, model: Model) -> Model:
        """Continue the displacement at time 0 of the clocks, by an exact remainder that does not drift."""
        shear = self._shear
        period = self._length / abs(shear.velocity) if shear.velocity else math.inf
        phase = math.fmod(start, period)
        shear.origin[0] = self._start + shear.velocity * phase
        shear.turns[0] = round(math.copysign((start - phase) / period, shear.velocity))
        return model

    def write(self, state: State, clock: float) -> None:
        """Write the displacement of the images beyond the upper face. Rounding may place particles beyond a
        sheared face that they have just reached. They are moved to the face, because they have not crossed it
        yet.
        """
        shear = self._shear
        here = shear.origin[0] + shear.velocity * clock
        state.displaced = float(here + shear.turns[0] * self._length)
        inside = np.nextafter(state.lengths[GRADIENT], 0.0)
        state.positions[:, GRADIENT] = np.clip(state.positions[:, GRADIENT], 0.0, inside)


# Kicks of a thermostat at regular times, which do not depend on where a run is split.


_MOST_NUMBERS = 2**63 - 1  # largest kick number, after which numbers restart
_KICK_DRAWS = 3  # stream number of these random numbers, after those of thermal walls


def _width(thermostat: Thermostat, dimension: int, unit_mass: float) -> float:
    """Return the standard deviation of a kick's velocity components for a particle of unit mass."""
    return math.sqrt(2.0 * thermostat.power * thermostat.interval / (dimension * unit_mass))


class Kicks(Part):
    """Thermostat of a scene under the event-driven engine. The arrays contain the time of the next kick on
    the clocks of the epoch, the number of kicks, and the energy added since the last reset.
    """

    def __init__(
        self, thermostat: Thermostat, dimension: int, seed: int | tuple[int, ...], unit_mass: float
    ) -> None:
        self._interval, self._unit_mass = thermostat.interval, unit_mass
        self._width = _width(thermostat, dimension, unit_mass)
        self._key = key_of(seed, _KICK_DRAWS)
        self._next = np.array([thermostat.interval])
        self._number = np.zeros(1, dtype=np.int64)
        self._given = np.zeros((1, 2))
        arrays = {"next": self._next, "number": self._number, "given": self._given}
        super().__init__({f"scheduled_{key}": array for key, array in arrays.items()}, scheduled=self._next)

    @property
    def given(self) -> float:
        from gaspart.kernels.physics import running_sum  # importing numba takes 0.4 s

        return running_sum.net(self._given) * self._unit_mass

    def end_epoch(self, length: float, start: float) -> None:
        """Set the time of the next kick to a multiple of the interval. The multiple has a single rounding
        error, while a sum of intervals would accumulate errors.
        """
        self._next[0] = (int(self._number[0]) + 1) * self._interval - start

    def reset(self, clock: float) -> None:
        self._given[:] = 0.0

    def apply_event(self, particles: Particles, model: Model, tally: Tally, start: float) -> bool:
        """Kick all particles, and return True, because all events must be predicted again."""
        from gaspart.kernels.event.pair_contact import kick_all

        counter = self._key, int(self._number[0])
        kick_all(particles.flights, self.next, self._width, counter, model, self._given)
        self._number += 1
        self.end_epoch(0.0, start)
        return True


def kicks(scene: Scene, seed: int | tuple[int, ...], unit_mass: float) -> Kicks | None:
    """Return the kicks of a thermostat; None if there is no thermostat or no moving particle."""
    if scene.thermostat is None or not any(not kind.fixed for kind in scene.kinds):
        return None
    return Kicks(scene.thermostat, scene.dimension, seed, unit_mass)


class StepKicks(Part):
    """Thermostat of a scene for engines with time steps. If several kicks are due in a step, a single kick of
    the same total strength is applied at its end.

    given_terms : (1, 2), energy added since the last reset, as two terms (see `physics.running_sum.add`)
    """

    def __init__(
        self, thermostat: Thermostat, dimension: int, time_step: float, seed: int | tuple[int, ...]
    ) -> None:
        self._per_step = time_step / thermostat.interval
        self._width = _width(thermostat, dimension, 1.0)
        self._key = key_of(seed, _KICK_DRAWS)
        self.given_terms = np.zeros((1, 2))
        super().__init__({"given": self.given_terms})

    def reset(self, clock: float) -> None:
        self.given_terms[:] = 0.0

    def _kicks_by(self, steps: float) -> int:
        """Return the number of kicks due by the end of a number of steps."""
        return math.floor(steps * self._per_step * (1.0 + 4e-16) + 1e-9)

    def until(self, steps: float, part: float) -> int:
        """Return the number of parts, of length `part` in steps, until the next kick at their end."""
        due = self._kicks_by(steps)
        number = max(1, math.floor(((due + 1) / self._per_step - steps) / part) - 1)
        while self._kicks_by(steps + number * part) <= due:
            number += 1
        return number

    def due(self, steps: float, part: float) -> tuple[float, tuple[np.ndarray, int]] | None:
        """Return width and number of the kick that is due after these steps and a part, or None."""
        due = self._kicks_by(steps)
        number = due - self._kicks_by(steps - part)
        if number <= 0:
            return None
        return self._width * math.sqrt(number), (self._key, due & _MOST_NUMBERS)


def step_kicks(scene: Scene, time_step: float, seed: int | tuple[int, ...]) -> StepKicks | None:
    """Return the kicks of a thermostat for time steps; None if there is no thermostat."""
    if scene.thermostat is None or not scene.count:
        return None
    return StepKicks(scene.thermostat, scene.dimension, time_step, seed)
