"""Collision law for all engines, and internal degrees of freedom of particles: spins and vibrations."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gaspart.engines.features.faces import face_energy
from gaspart.engines.features.part import Part
from gaspart.kernels.model import NONE, ContactDuration, ContactLaw, Gravity, no_support
from gaspart.kernels.physics import running_sum
from gaspart.scene.restitution import Restitution
from gaspart.scene.scene import Scene
from gaspart.state.insertion import per_particle
from gaspart.state.state import State

if TYPE_CHECKING:
    from gaspart.kernels.model import Model, Particles, Tally


_BISECTIONS = 100  # until adjacent floating-point numbers enclose the damping of viscoelastic particles


def contact_law(scene: Scene, state: State) -> ContactLaw | None:
    """Return the collision law for the kernels; None for elastic, smooth collisions without fixed
    particles.
    """
    rule = scene.restitution or Restitution()
    if rule.smooth_and_elastic and not np.isinf(state.masses).any():
        return None
    spins = np.zeros((state.count, 3))
    if scene.dimension == 2:
        spins[:, 2] = state.spins
    else:
        spins[:] = state.spins
    vibrations = None
    modes = per_particle(scene, "vibrates")
    if modes.any() and state.vibrations is not None:
        vibrations = np.where(modes, state.vibrations, -1.0)
    inverses = 1 / state.masses, 1 / state.moments_of_inertia
    return ContactLaw(rule.normal, rule.tangential, _viscous(scene), *inverses, spins, vibrations, None)


def _viscous(scene: Scene) -> float | None:
    """Return the damping constant of viscoelastic particles, or None for a constant restitution. The constant
    follows from the coefficient of restitution for two particles of the first species. If there are no
    species, it follows from the coefficient for two copies of the first particle.
    """
    rule = scene.restitution
    if rule is None or rule.reference_speed is None:
        return None
    from gaspart.kernels.physics.contact import fifth_root, restitution_of

    first = (scene.species or scene.particles)[0]
    least, most = 0.0, 1.0
    while restitution_of(most) > rule.normal:
        most *= 2.0
    for _ in range(_BISECTIONS):
        middle = 0.5 * (least + most)
        least, most = (middle, most) if restitution_of(middle) > rule.normal else (least, middle)
    return most / fifth_root(rule.reference_speed * 0.5 * first.radius * (2.0 / first.mass) ** 2)


class LawPart(Part):
    """State of particles under a collision law: spins (N, 3), and energies (N,) of vibrations."""

    def __init__(self, law: ContactLaw) -> None:
        super().__init__({"spins": law.spins})
        self._inverse_inertia = law.inverse_inertia
        if law.vibrations is not None:
            self.arrays["vibrations"] = law.vibrations

    @property
    def stored(self) -> float:
        squares = (self.arrays["spins"] ** 2).sum(axis=1)
        turning = squares > 0.0  # excludes smooth particles, whose moment of inertia may be infinite
        spins = 0.5 * float((squares[turning] / self._inverse_inertia[turning]).sum())
        vibrations = self.arrays.get("vibrations")
        return spins + (0.0 if vibrations is None else float(np.maximum(vibrations, 0.0).sum()))

    def write(self, state: State, clock: float) -> None:
        spins = self.arrays["spins"]
        state.spins = (spins[:, 2] if state.dimension == 2 else spins).copy()
        if state.vibrations is not None and "vibrations" in self.arrays:
            state.vibrations += np.maximum(self.arrays["vibrations"], 0.0)


# Masses of the particles in the unit of the kernels; power-of-two bounds of momenta and energies, for
# fixed-point sums.


def scaled_masses(masses: np.ndarray) -> tuple[float, np.ndarray | None]:
    """Return the unit of mass, and masses in this unit (None if all are identical). If all particles have the
    same mass, the kernel model contains no masses, and its sums are later multiplied by the unit.
    """
    if len(masses) == 0:
        return 1.0, None
    return (float(masses[0]), None) if (masses == masses[0]).all() else (1.0, masses)


def largest_terms(scene: Scene, state: State, unit_mass: float) -> tuple[float, float]:
    """Return bounds of momentum and energy that few particles exceed. Each bound is a power of two in units
    that contain `unit_mass`. Sums over threads are integer multiples of small fractions of these bounds.
    """
    moving = np.isfinite(state.masses)
    if not moving.any():
        return 1.0, 1.0
    masses = state.masses[moving] / unit_mass
    gain = face_energy(scene) + state.vibrational_energy
    energies = (state.kinetic_energies[moving] + gain) / unit_mass
    if scene.gravity is not None:
        energies += masses * sum(
            abs(g) * length for g, length in zip(scene.gravity, state.lengths, strict=True)
        )
    momentum = float(np.sqrt(2.0 * masses * energies).max())
    energy = float(energies.max())
    return 2.0 ** math.frexp(momentum or 1.0)[1], 2.0 ** math.frexp(energy or 1.0)[1]


# Jams in a scene under gravity: particles that are held fixed until a contact moves them
# (`kernels.event.jams`).
#
# All criteria follow from the definition of rest, a displacement of less than 2^-8 of the smallest diameter
# d. Two disturbances must not move a particle of a jam by this displacement within the time sqrt(d/g) of a
# fall. One is gravity g tilted by an angle a with tangent 2^-2. The other is a contact that gives the
# particle a speed below v; up a slope of this angle it would come v^2/(2 g sin a) far. At least one particle
# of a jam is pressed: averaged over the time of a fall, its contacts are more frequent than those of two
# particles that only gravity presses together.


FURTHEST = 2.0**-8  # smallest displacement of a particle that is not at rest, in smallest diameters
_TILT = 2.0**-2
_PLANES = 24  # maximum number of planes per particle; further planes are ignored


def slowest_that_moves(scene: Scene) -> float:
    """Return the lowest impact speed that frees a particle from a jam; infinite without gravity."""
    gravity = math.hypot(*(scene.gravity or ()))
    if gravity == 0.0:
        return math.inf
    return math.sqrt(4.0 * gravity * math.sin(math.atan(_TILT)) * FURTHEST * scene.smallest_radius)


def _tilt(gravity: tuple[float, ...]) -> np.ndarray:
    """Return gravity tilted in all directions, (2, 3) or (4, 3), against each of which a support
    must hold.
    """
    acceleration = np.zeros(3)
    acceleration[: len(gravity)] = gravity
    across = [np.array([-acceleration[1], acceleration[0], 0.0])]
    if len(gravity) == 3:
        normal = np.cross(acceleration, np.eye(3)[np.argmin(np.abs(acceleration))])
        across = [normal, np.cross(acceleration, normal)]
    sides = [_TILT * math.hypot(*acceleration) / math.hypot(*vector) * vector for vector in across]
    return np.array([acceleration + sign * side for side in sides for sign in (-1.0, 1.0)])


class Jams:
    """Search for jams in a scene, which is repeated after each time interval `window`.

    axis : axis with walls along which gravity acts
    reach : largest gap between two particles at which they are treated as touching
    """

    def __init__(self, scene: Scene, axis: int, reach: float, window: float) -> None:
        from gaspart.kernels.event.jams import Limits
        from gaspart.kernels.physics.contact import SHORTEST

        gravity = scene.gravity or ()
        self._axis, self._most = axis, window / (SHORTEST * scene.contact_duration)
        support = no_support(1, 0.0)._replace(normal=np.zeros((1, _PLANES, 3)))
        least = 2.0 * FURTHEST * math.hypot(*gravity)
        self._limits = Limits(_tilt(gravity), least, reach, support)
        self._plain = self._limits._replace(pulls=self._limits.pulls[:2].mean(axis=0, keepdims=True))

    def hold(
        self,
        particles: Particles,
        positions: np.ndarray,
        stays: np.ndarray,
        model: Model,
        tally: Tally,
        time: float,
    ) -> bool:
        """Fix the particles of jams, for positions (N, d); `stays` (N,): unmoved. True if events change."""
        from gaspart.kernels.event.jams import (
            HELD,
            PRESSED,
            STAYS,
            Line,
            free_unstable,
            jam,
            join,
            keep_stable,
        )

        law, flights = model.law, particles.flights
        assert law is not None and law.duration is not None  # as required by `rest_watch`
        duration, moves = law.duration, law.duration.inverse_mass > 0.0
        marks = np.empty((3, len(flights)), dtype=bool)
        marks[HELD], marks[STAYS] = stays & moves, stays | ~moves
        marks[PRESSED] = duration.contacts > self._most
        duration.contacts[:] = 0
        if not (marks[HELD] & marks[PRESSED]).any() and duration.island.max() < len(flights):
            return False
        order = np.flatnonzero(marks[STAYS])
        order = order[np.argsort(positions[order, self._axis], kind="stable")]
        line = Line(order, positions, self._axis)
        keep_stable(flights, line, self._limits, model, marks)
        kept = marks[:2] | (stays & (duration.island >= len(flights)))
        if (kept != marks[:2]).any():  # particles in the jam before remain unless gravity moves them
            marks[:2] = kept
            keep_stable(flights, line, self._plain, model, marks)
        freed = free_unstable(flights, time, marks, model)
        order = order[marks[HELD][order]]
        parent = np.empty(len(flights), dtype=np.int64)
        join(flights, order, positions, self._axis, self._limits.reach, model.space, parent)
        return jam(flights, order, time, marks, parent, model, tally) or freed


# Lasting contacts: a contact shortly after an earlier contact of the same particle is elastic.


_ARRAYS = ("latest", "met", "island", "contacts", "elastic", "kept")


def contact_duration(scene: Scene, law: ContactLaw) -> ContactDuration | None:
    """Return the initial data for lasting contacts; None if every contact dissipates."""
    return lasting_contacts(scene, law) if scene.contact_duration > 0.0 else None


def lasting_contacts(scene: Scene, law: ContactLaw) -> ContactDuration:
    """Return the initial data for the rule of lasting contacts, also for the duration 0."""
    never = np.full(scene.count, -np.inf)
    return ContactDuration(
        length=scene.contact_duration,
        latest=never,
        met=never.copy(),
        island=np.full(scene.count, NONE),
        contacts=np.zeros(scene.count, dtype=np.int64),
        inverse_mass=law.inverse_mass.copy(),
        moving=slowest_that_moves(scene),
        elastic=np.zeros(1, dtype=np.int64),
        kept=np.zeros((1, 2)),
    )


class DurationPart(Part):
    """State of lasting contacts, and of islands and jams under gravity. An island is a group of particles at
    rest that gravity does not move. A jam is a group that contacts do not move either.
    """

    def __init__(self, law: ContactLaw, duration: ContactDuration, gravity: Gravity | None) -> None:
        arrays = {f"contact_{key}": getattr(duration, key) for key in _ARRAYS}
        super().__init__(arrays, times=(duration.latest, duration.met))
        self._duration = duration
        if gravity:
            self.arrays["gravity_fixed"] = gravity.fixed
            self.arrays["inverse_mass"] = law.inverse_mass

    def reset(self, clock: float) -> None:
        self._duration.elastic[:], self._duration.kept[:] = 0, 0.0

    def counts(self, clock: float) -> dict[str, float]:
        kept = running_sum.net(self._duration.kept)
        return {"elastic_contacts": int(self._duration.elastic[0]), "retained_energy": kept}


# Scenes under gravity that come to rest.
#
# With a contact duration, a settled pile has tiny elastic contacts forever. A scene counts as at rest, and
# has no more events, under two conditions. For the time sqrt(d/g) of a fall, each particle has stayed within
# 2^-8 of the smallest diameter d. Each particle also lies on a wall or has lasting contacts. The same applies
# to a part of a scene: particles with lasting contacts, and particles that lie or move within 2^-8 d of them.
# It ends when another particle collides with one of them. The translational kinetic energy then counts as
# dissipated. Spins, on which elastic contacts do not act, are kept.


class RestWatch(Part):
    """Test at regular times whether all particles rest. The times do not depend on whether a run is
    interrupted and continued. The arrays contain the positions (N, d) at the last test, the time of the next
    test on the clocks of the epoch, and the result of the test.
    """

    def __init__(self, scene: Scene, state: State) -> None:
        diameter, gravity = 2.0 * scene.smallest_radius, scene.gravity or ()
        self._window = math.sqrt(diameter / math.hypot(*gravity))
        self._most = FURTHEST * diameter
        self._axis = int(np.argmax(np.abs(gravity)))
        self._jams = Jams(scene, self._axis, self._most, self._window)
        self._before = state.positions.copy()
        self._next = np.array([self._window])
        self._rests = np.zeros(1, dtype=bool)
        arrays = {"before": self._before, "next": self._next, "rests": self._rests}
        arrays = {f"scheduled_{key}": array for key, array in arrays.items()}
        super().__init__(arrays, times=(self._next,), scheduled=self._next)

    @property
    def at_rest(self) -> bool:
        return bool(self._rests[0])

    def set_clock(self, clock: float) -> None:
        """Schedule the first test after the duration of a fall through the container."""
        self._next[0] = clock + self._window

    def apply_event(self, particles: Particles, model: Model, tally: Tally, start: float) -> bool:
        """Find particles at rest, and stop them; True if events must be predicted again, False if
        all rest.
        """
        from gaspart.kernels.event.jams import MOVES, RESTS, find_resting, stop_all

        flights, positions, time = particles.flights, self._before, self.next
        self._next += self._window
        marks = np.empty((3, len(flights)), dtype=bool)
        find_resting(flights, positions, time, self._most, model, marks)
        if marks[RESTS].all():
            stop_all(flights, time, model, tally)
            self._rests[0] = True
            return False
        any_new = self._hold(particles, marks, model, tally, time)
        return self._jams.hold(particles, positions, ~marks[MOVES], model, tally, time) or any_new

    def _hold(self, particles: Particles, marks: np.ndarray, model: Model, tally: Tally, time: float) -> bool:
        """Fix the particles of islands, and return True if there are new islands."""
        from gaspart.kernels.event.jams import RESTS, TOUCHES, hold, join
        from gaspart.kernels.model import NONE

        flights, positions, law = particles.flights, self._before, model.law
        assert law is not None and law.duration is not None  # as required by `rest_watch`
        awake = (law.duration.island == NONE) & (law.inverse_mass > 0.0)
        if not (marks[RESTS] & marks[TOUCHES] & awake).any():
            return False
        near = np.flatnonzero(marks.any(axis=0) & awake)  # excludes sliding particles without a contact
        order = near[np.argsort(positions[near, self._axis], kind="stable")]
        parent = np.empty(len(flights), dtype=np.int64)
        join(flights, order, positions, self._axis, self._most, model.space, parent)
        return hold(flights, order, time, marks, parent, model, tally)


def rest_watch(scene: Scene, state: State) -> RestWatch | None:
    """Return the test for a scene whose particles may all rest (nothing adds energy), or None."""
    falls = scene.gravity is not None and not scene.driven_axes
    still = not (scene.faces or scene.face_temperatures)
    return RestWatch(scene, state) if scene.contact_duration > 0.0 and falls and still else None
