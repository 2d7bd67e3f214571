"""Counters of the event-driven engine, energies that leave or enter a scene, and epochs."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from gaspart.engines.features.part import Part, TallyPart
from gaspart.engines.features.tallies import PARTS
from gaspart.errors import SimulationError
from gaspart.kernels import model as kernels
from gaspart.kernels.event.pair_contact import CollapseWatch
from gaspart.kernels.model import Model
from gaspart.kernels.physics.running_sum import net, values
from gaspart.scene.scene import Scene
from gaspart.state.optional_tallies import OptionalTally
from gaspart.state.state import State
from gaspart.state.tally import Tally

_OPTIONAL = kernels.Tally._field_defaults  # fields of a part


def tally_parts(
    tallies: Iterable[OptionalTally],
    flights: np.ndarray,
    model: kernels.Model,
    unit_mass: float,
    scene: Scene,
    state: State,
) -> list[TallyPart]:
    """Return the parts for optional tallies, from `flights` (N,) of the particles and the initial state."""
    return [PARTS[tally.name](tally, flights, model, unit_mass, scene, state) for tally in tallies]


class EventTally:
    """Counters of a running scene since the last `reset`."""

    def __init__(self, scene: Scene, unit_mass: float, parts: Sequence[Part]) -> None:
        self._unit_mass, self._parts = unit_mass, parts
        self._optional = {part.name: part.kernel for part in parts if isinstance(part, TallyPart)}
        self._surfaces = 2 * scene.dimension + len(scene.walls)
        self.lost = np.zeros(2)

    def reset(self, time: float, clock: float) -> None:
        """Reset the counters at a time `clock` of the epoch, after energies removed so far are stored."""
        self.lost = np.array([self.dissipated, self.exchanged])
        self.begin(time, clock)

    def begin(self, time: float, clock: float) -> None:
        """Reset the counters, without storing the energies that have been removed so far."""
        self.arrays = kernels.empty_tally(self._surfaces)._replace(**self._optional)
        for part in self._parts:
            part.reset(clock)
        self.since = time

    @property
    def changing(self) -> dict[str, np.ndarray]:
        """Arrays of counters that change during a run, by name, except the arrays of parts."""
        return {key: array for key, array in self.arrays._asdict().items() if key not in _OPTIONAL}

    def read(self, time: float, clock: float) -> Tally:
        """Return counters and sums up to the present `time`."""
        arrays = self.arrays
        sums = (net(terms) * self._unit_mass for terms in arrays.sums)
        counted: dict[str, Any] = dict(zip(kernels.COUNTS, arrays.counts.tolist(), strict=True))
        counted |= zip(kernels.SUMS, sums, strict=True)
        for part in self._parts:
            counted |= part.counts(clock)
        del counted["outdated"]
        return Tally(
            time=time - self.since,
            wall_hits=arrays.wall_hits.copy(),
            wall_impulse=values(arrays.wall_impulse) * self._unit_mass,
            wall_energy=values(arrays.wall_energy) * self._unit_mass,
            worst_contact=float(arrays.worst[0]),
            thermostat_energy=self._given,
            **counted,
        )

    @property
    def dissipated(self) -> float:
        """Energy removed by contacts and thermal walls since time 0, minus the energy added by kicks."""
        losses = self.arrays.sums[kernels.LOSS], self.arrays.wall_energy
        return float(self.lost[0]) + net(*losses) * self._unit_mass - self._given

    @property
    def exchanged(self) -> float:
        """Sum of the absolute energies that contacts and each face have exchanged since time 0."""
        gross = net(self.arrays.sums[kernels.LOSS]) + float(np.abs(values(self.arrays.wall_energy)).sum())
        return float(self.lost[1]) + gross * self._unit_mass + self._given

    @property
    def _given(self) -> float:
        """Energy added by scheduled events since the last reset."""
        return sum(part.given for part in self._parts)


# Epochs: the clocks of the event-driven engine restart from zero in each epoch, to keep their precision.


_LENGTH = 2.0**10  # flight in an epoch, in smallest diameters
_SMALL = 2.0**4  # number of such flights through the container above which an epoch is one flight through it
_AT_REST = 2.0**960  # epoch length of a scene in which nothing moves
_RESOLVED = 2.0**-52  # relative resolution of speeds
_OTHER = 2.0**10  # factor by which speeds must change before the epoch length changes
QUIET = 64
"""Number of epochs without an event after which the epoch length is doubled."""


class Epochs:
    """Epoch lengths of a scene. The length follows from a time of flight, over many of the smallest
    diameters. If particles are so small that a flight through the container would take many epochs, it is the
    time of this flight, in which clocks are as precise as positions. The speed is the rms speed plus the
    largest gain of speed due to gravity and faces.

    masses : (N,), masses, infinite for fixed particles
    gained : square of the largest speed that the scene can give a particle
    """

    def __init__(self, scene: Scene, masses: np.ndarray, gained: float) -> None:
        self._gained = gained if len(masses) else 0.0
        self._across = max(scene.container.lengths)
        path = 2.0 * scene.smallest_radius * _LENGTH
        self._path = path if self._across < _SMALL * path else self._across
        self._moving = np.isfinite(masses)
        self._masses = masses[self._moving]

    def speed(self, velocities: np.ndarray) -> float:
        """Return the speed from which times of flight follow, for velocities (N, d)."""
        square = float((velocities**2).sum(axis=1).mean()) if len(velocities) else 0.0
        return math.sqrt(square + self._gained)

    def _equipartition_speed(self, velocities: np.ndarray, stored: float) -> float:
        """Return the rms speed after equipartition of the energy. The present rms speed would be too low: in
        a gas at rest, a few heavy or spinning particles can transfer their energy to all others within an
        epoch. `stored`: energy of the particles in other forms than translation.
        """
        if not len(self._masses):
            return 0.0
        squares = (velocities[self._moving] ** 2).sum(axis=1)
        energy = 0.5 * float((self._masses * squares).sum()) + stored  # not @: BLAS differs
        return math.sqrt(2.0 * energy / len(self._masses) * float((1.0 / self._masses).mean()))

    def base(self, velocities: np.ndarray, stored: float, present: float = 0.0) -> float:
        """Return the epoch length for velocities (N, d) and a `stored` energy. The length `present` is
        retained under the condition in `length`.
        """
        length = self.length(self.speed(velocities), present)
        return min(length, self.length(self._equipartition_speed(velocities, stored), length))

    def flights(self, velocities: np.ndarray, length: float) -> float:
        """Return the number of flights through the container in an epoch at the mean relative speed.
        Velocities (N, d) are relative to the motion of the whole gas, because particles that move together do
        not collide. The result is 0 if the relative velocities are due to rounding only.
        """
        relative = self.speed(velocities - velocities.mean(axis=0))
        return relative * length / self._across if relative > _RESOLVED * self.speed(velocities) else 0.0

    def length(self, speed: float, present: float = 0.0) -> float:
        """Return the time after which clocks restart from zero. The length is a power of two, so that results
        scale exactly with the units. The length `present` is retained until speeds have changed by a factor
        of 2^10. In a cooling gas epochs become longer, because each epoch has the same cost.
        """
        length = _power_of_two(self._path / speed) if speed > 0.0 else _AT_REST
        return present if present / _OTHER < length < present * _OTHER else length

    def quiet(self, speed: float, length: float, number: int) -> float:
        """Return the epoch length after a `number` of epochs without an event. The length is twice the
        previous length, but at most a time of flight through the container. Up to this length the clocks are
        as precise as the positions.
        """
        most = _power_of_two(self._across / speed) if speed > 0.0 else length
        doublings = min(max(number - QUIET, 0), max(0, math.frexp(most)[1] - math.frexp(length)[1]))
        return math.ldexp(length, doublings)


def _power_of_two(time: float) -> float:
    """Return the next power of two above a time, but at most `_AT_REST`."""
    return min(math.ldexp(1.0, math.frexp(time)[1]), _AT_REST) if time < _AT_REST else _AT_REST


# Detection of stalled runs: endless collisions at one time, or no collision at all.


MANY = 1 << 18
"""Number of events in which time must advance by more than the sum of their clock resolutions."""
# A run without an end time is stopped after this number of epochs without an event, and as many flights
# through the container. If particles move almost uniformly, so that flights take longer, it is stopped after
# more epochs.
_QUIET, _FLIGHTS, _QUIET_TOGETHER = QUIET + 2000, 1000, 1 << 17
# More contacts of one particle than this number, within this fraction of an epoch, count as a collapse. For a
# constant restitution, intervals between contacts shrink geometrically until rounding separates the
# particles, so only few contacts occur. Slow contacts of viscoelastic particles are nearly elastic.
_MOST, _INTERVAL = 1000, 2.0**-44
_INELASTIC_MOST, _INELASTIC_INTERVAL = 12, 2.0**-34
_MOST_OF_STACK = MANY >> 3  # contacts at one time that count as a stack at rest
# Elastic particles do not collapse: between two surfaces at an angle a, a particle has pi/a contacts at one
# time. In a stack under gravity they touch forever.
_UNLIMITED = np.iinfo(np.int64).max
_REST = "a stack at rest"
_COLLAPSE = "an inelastic collapse, or a stack at rest, which a contact_duration allows"


def check_progress(time: float, spent: float, epoch: float) -> None:
    """Raise SimulationError if `MANY` events span less time than the clocks can resolve. The order of such
    events would depend only on rounding. `time`: present time. `spent`: duration of these events. `epoch`:
    length of the epoch.
    """
    if spent < MANY * _RESOLVED * epoch:
        raise SimulationError(
            f"at time {time:g} there were {MANY} events within a time of {spent:g}: "
            "particles have no room to move"
        )


def check_clocks(start: float, epoch: float) -> None:
    """Raise SimulationError if an `epoch` is so short that the time `start` does not resolve it."""
    if start + epoch == start:
        raise SimulationError(
            f"at time {start:g} particles are so fast that {epoch:g} of time holds a thousand flights over a "
            "diameter, or a flight through the container: less than such a time resolves"
        )


def check_events(time: float, quiet: int, flights: float) -> None:
    """Raise SimulationError after too many `quiet` epochs, of `flights` through the container each."""
    if quiet <= _QUIET or (0.0 < quiet * flights < _FLIGHTS and quiet <= _QUIET_TOGETHER):
        return
    cause = "particles move together" if 0.0 < quiet * flights < _FLIGHTS else "particles miss one another"
    raise SimulationError(f"no event up to time {time:g} in {quiet} epochs of the clocks: {cause}")


class CollapsePart(Part):
    """Detection of an inelastic collapse in a scene of `count` particles.

    watch : counters of the kernels; None if no collapse is possible
    """

    def __init__(self, model: Model, count: int) -> None:
        law = model.law
        most, self._interval = _MOST, _INTERVAL
        if law and law.normal < 1.0 and law.viscous is None and not law.duration:
            most, self._interval = _INELASTIC_MOST, _INELASTIC_INTERVAL
        elif law is None or (law.normal == 1.0 and abs(law.tangential) == 1.0 and law.vibrations is None):
            most = _MOST_OF_STACK if model.gravity else _UNLIMITED
        self.watch: CollapseWatch | None = None
        if not (law or model.gravity):
            super().__init__({})
            return
        since, contacts = np.full(count, -np.inf), np.zeros(count, dtype=np.int64)
        super().__init__({"contacts_since": since, "contacts": contacts}, times=(since,))
        self.watch = CollapseWatch(since, contacts, 0.0, most)

    def begin_epoch(self, length: float, start: float, model: Model) -> Model:
        """Set the time interval in which too many contacts of a particle mean a collapse."""
        self.watch = self.watch and self.watch._replace(interval=self._interval * length)
        return model

    def error(self, time: float) -> SimulationError:
        """Return the error for a scene in which a particle has had too many contacts up to `time`."""
        watch = self.watch
        assert watch is not None  # otherwise the kernels would have counted none
        return SimulationError(
            f"at time {time:g} particle {watch.contacts.argmax()} has had "
            f"{watch.most} contacts within a time of {watch.interval:g}: "
            f"{_REST if watch.most == _MOST_OF_STACK else _COLLAPSE}; the state is that of the present time"
        )
