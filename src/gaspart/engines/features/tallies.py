"""Sums of stress, heat flux and impulses, and sums for each area of a face."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from gaspart.engines.features.part import Part, TallyPart
from gaspart.kernels.event import impulses as kernels
from gaspart.kernels.event.impulses import MEETING, OTHERS, PairImpulses
from gaspart.kernels.event.simd import PLACES
from gaspart.kernels.event.stress import Stress, add_flights, add_sheared_flights
from gaspart.kernels.model import Model
from gaspart.kernels.physics.flight import advance_all
from gaspart.kernels.physics.per_area import PerArea
from gaspart.kernels.physics.running_sum import values
from gaspart.kernels.simd import WIDTH
from gaspart.scene.accessible import Accessible
from gaspart.scene.faces import FLOW, GRADIENT
from gaspart.scene.features import row_count
from gaspart.scene.limits import ball_volume
from gaspart.scene.scene import Scene
from gaspart.state.optional_tallies import OptionalTally
from gaspart.state.state import State, drift_of
from gaspart.state.tally import ImpulseTally, PairImpulseTally, PerAreaTally


def tallied_fluxes(sums: np.ndarray, drift: np.ndarray) -> dict[str, np.ndarray]:
    """Return the fields of `Tally` for the fluxes of momentum and heat.

    Parameters
    ----------
    sums : ndarray, shape (2 d^2 + d,)
        Sums of the stress tensor and of its collisional part, each by rows, and of the heat flux.
    drift : ndarray, shape (d,), [length/time]
        Velocity about which the sums are.

    Returns
    -------
    dict of str to ndarray
        `stress_sum`, `collisional_stress_sum`, `heat_sum` and `flux_velocity`.
    """
    dimension = len(drift)
    stress = sums[: 2 * dimension**2].reshape(2, dimension, dimension)
    heat = sums[2 * dimension**2 :]
    fluxes = {"stress_sum": stress[0], "collisional_stress_sum": stress[1], "heat_sum": heat}
    return {**fluxes, "flux_velocity": drift.copy()}


class StressPart(TallyPart):
    """Stress tensor and heat flux of a gas without walls.

    flights : (N,), particles, each with a velocity that is constant until its next contact
    drift : (d,), velocity of their centre of mass
    """

    kernel: Stress

    def __init__(self, flights: np.ndarray, model: Model, unit_mass: float, drift: np.ndarray) -> None:
        self._flights, self._unit_mass = flights, unit_mass
        self._masses = model.space, model.masses, model.law
        self._drift, d = drift, len(drift)
        sums = np.zeros((2 * d * d + d, 2))
        super().__init__("stress", Stress(sums, np.zeros((2, d + 1)), drift.copy()), {"stress": sums})

    def end_epoch(self, length: float, start: float) -> None:
        """Add the transport by the flights of the epoch."""
        add_flights(self._flights, length, *self._masses, self.kernel)

    def reset(self, clock: float) -> None:
        """Begin to count from zero."""
        self.kernel.sums[...] = 0.0
        add_flights(self._flights, -clock, *self._masses, self.kernel)

    def read(self, clock: float) -> np.ndarray:
        """Return the sums (2 d^2 + d,) until this time on the clocks of the epoch."""
        total = self.kernel._replace(sums=self.kernel.sums.copy())
        add_flights(self._flights, clock, *self._masses, total)
        return values(total.sums) * self._unit_mass

    def counts(self, clock: float) -> dict[str, Any]:
        """Return the sums by the fields of `Tally`."""
        return tallied_fluxes(self.read(clock), self._drift)


class ShearedStressPart(StressPart):
    """Stress tensor and heat flux of a sheared gas.

    Velocities relative to the flow change in flight, so that each flight counts from its clock on.
    """

    def __init__(self, flights: np.ndarray, model: Model, unit_mass: float, drift: np.ndarray) -> None:
        super().__init__(flights, model, unit_mass, drift)
        self._model = model

    def begin_epoch(self, length: float, start: float, model: Model) -> Model:
        """Set the velocity of the centre of mass relative to the flow.

        The velocity component across the flow is constant, so the component along the flow decreases
        steadily.
        """
        assert model.shear is not None  # or there were no such part
        across = self._drift[GRADIENT]
        self.kernel.drift[FLOW] = self._drift[FLOW] - model.shear.rate * across * start
        return model

    def close_epoch(self, length: float) -> None:
        """Add the transport by the flights until the end of the epoch."""
        add_sheared_flights(self._flights, length, 1.0, self._model, self.kernel)

    def end_epoch(self, length: float, start: float) -> None:
        """Do nothing: the motion of the epoch begins again."""

    def reset(self, clock: float) -> None:
        """Begin to count from zero."""
        self.kernel.sums[...] = 0.0
        add_sheared_flights(self._flights, clock, -1.0, self._model, self.kernel)

    def read(self, clock: float) -> np.ndarray:
        """Return the sums (2 d^2 + d,) until this time on the clocks of the epoch."""
        total = self.kernel._replace(sums=self.kernel.sums.copy())
        add_sheared_flights(self._flights, clock, 1.0, self._model, total)
        return values(total.sums) * self._unit_mass


def stress_part(
    tally: OptionalTally, flights: np.ndarray, model: Model, unit_mass: float, scene: Scene, state: State
) -> StressPart:
    """Return the part for a gas that is sheared or not.

    state : state at time 0
    """
    kind = StressPart if model.shear is None else ShearedStressPart
    return kind(flights, model, unit_mass, drift_of(scene, state))


# Momentum that particles carry through planes across an axis, from the impulses that they receive.


def rows_of(scene: Scene) -> np.ndarray:
    """Return the row (N,) of each particle: the number of its species.

    Single particles have the number after the last, and are the first particles.
    """
    counts = [len(scene.particles), *(kind.count for kind in scene.species)]
    return np.repeat([len(scene.species), *range(len(scene.species))], counts)


class ImpulsesPart(TallyPart):
    """Momentum below each plane at the last reset, and all impulses since then.

    The present momentum below each plane is subtracted at reading.

    flights : (N,), particles, each at its own clock
    """

    kernel: kernels.Impulses

    def __init__(
        self, flights: np.ndarray, model: Model, unit_mass: float, scene: Scene, axis: int, bins: int
    ) -> None:
        self._flights, self._unit_mass = flights, unit_mass
        self._model = model._replace(faces=None, walls=None, oversized=None)
        rows, per_length = row_count(scene), bins / scene.container.lengths[axis]
        sums = np.zeros((rows, bins + 1))
        row = rows_of(scene) if rows > 1 else None
        super().__init__("impulses", kernels.Impulses(sums, axis, per_length, row), {"impulses": sums})

    def _add_momenta(self, clock: float, sign: float, sums: np.ndarray) -> None:
        """Add `sign` times the momenta of all particles at a time.

        clock : this time on the clocks of the epoch
        """
        flights, model = self._flights.copy(), self._model
        advance_all(flights, clock, model.space, model.gravity)
        kernels.add_momenta(flights, sign, model, self.kernel._replace(sums=sums))

    def reset(self, clock: float) -> None:
        """Begin to count from zero."""
        self.kernel.sums[...] = 0.0
        self._add_momenta(clock, 1.0, self.kernel.sums)

    def read(self, clock: float) -> np.ndarray:
        """Return the momentum (species, bins) transported until this time on the clocks of the epoch."""
        sums = self.kernel.sums.copy()
        self._add_momenta(clock, -1.0, sums)
        return np.asarray(self._unit_mass * np.cumsum(sums, axis=1)[:, :-1])

    def counts(self, clock: float) -> dict[str, Any]:
        """Return the momentum by the field of `Tally`."""
        return {"momentum_flux_sum": self.read(clock)}


def impulses_part(
    tally: OptionalTally, flights: np.ndarray, model: Model, unit_mass: float, scene: Scene, state: State
) -> ImpulsesPart:
    """Return the part of an `ImpulseTally`."""
    assert isinstance(tally, ImpulseTally)
    return ImpulsesPart(flights, model, unit_mass, scene, "xyz".index(tally.axis), tally.bins)


# Momentum that pairs gain along their separation, from the impulses of contacts.


_FINEST = 2.0**-27
"""Unit of whole numbers, as a fraction of a thermal momentum's contribution to a pair at contact.

The distance is the smallest diameter; a sum holds 2^36 of these contributions.
"""


class PairImpulsesPart(TallyPart):
    """Impulses of pairs, in whole numbers.

    unit : unit of these numbers in units of `Tally`
    """

    kernel: PairImpulses

    def __init__(self, kernel: PairImpulses, unit: float) -> None:
        super().__init__("pair_impulses", kernel, {"pair_impulses": kernel.sums})
        self._units = np.array([[unit], [unit / kernel.share]])

    def reset(self, clock: float) -> None:
        """Begin to count from zero."""
        self.kernel.sums[...] = 0

    def read(self, clock: float) -> np.ndarray:
        """Return k_B T g(r) times the time, (2, shells), of colliding pairs and of others."""
        return np.asarray(self._units * np.cumsum(self.kernel.sums, axis=1)[:, :-1])

    def counts(self, clock: float) -> dict[str, Any]:
        """Return the sums by the fields of `Tally`."""
        sums = self.read(clock)
        return {"contact_impulse_sum": sums[MEETING], "other_impulse_sum": sums[OTHERS]}


def pair_impulses_part(
    tally: OptionalTally, flights: np.ndarray, model: Model, unit_mass: float, scene: Scene, state: State
) -> PairImpulsesPart:
    """Return the part of a `PairImpulseTally`."""
    assert isinstance(tally, PairImpulseTally)
    d, n = scene.dimension, scene.count
    momentum = math.sqrt(2.0 * state.kinetic_energy / n * float(state.masses.max())) / unit_mass
    largest = momentum / (2.0 * scene.smallest_radius) ** (d - 1)
    per_unit = 2.0 ** -round(math.log2(largest * _FINEST)) if largest > 0.0 else 1.0
    per_volume = 1.0 / np.diff(np.arange(tally.shells + 1.0) ** d)
    kernel = PairImpulses(
        sums=np.zeros((2, tally.shells + 1), np.int64),
        impulse=np.zeros(d),
        furthest=float(tally.furthest),
        per_length=tally.shells / tally.furthest,
        per_volume=per_volume,
        per_unit=per_unit,
        share=float(tally.share),
        listed=np.zeros(n + PLACES + WIDTH, np.uint32),
        separations=np.zeros((2, WIDTH)),
    )
    pairs = 0.5 * n * (n - 1) * d * ball_volume(d)  # per volume and distance^(d - 1), if independent
    return PairImpulsesPart(kernel, unit_mass * scene.container.volume / (pairs * per_unit))


PARTS = {"stress": stress_part, "impulses": impulses_part, "pair_impulses": pair_impulses_part}
"""Functions that make the part of an optional tally of the event-driven engine, by its name."""


# Momentum and heat given to faces by particles of several sizes, divided by accessible areas.
#
# Areas are the areas of the container at the start; faces and walls that move are at their positions then.


def inverse_areas(scene: Scene, state: State) -> tuple[np.ndarray, np.ndarray]:
    """Return the inverse accessible area (sizes, 2d) of each face, and the particles' sizes (N,).

    The inverse is 0 for faces that no centre reaches. Fixed particles have the first size.
    """
    fixed = ~np.isfinite(state.masses)
    sizes, size = np.unique(state.radii[~fixed], return_inverse=True)
    areas = Accessible(scene, (state.positions[fixed], state.radii[fixed])).areas(sizes)
    numbers = np.zeros(state.count, np.int64)
    numbers[~fixed] = size
    return np.divide(1.0, areas, out=np.zeros_like(areas), where=areas > 0.0), numbers


def per_area_fields(momentum: np.ndarray, heat: np.ndarray, walls: int) -> dict[str, np.ndarray]:
    """Return the fields of `Tally` from the sums of faces, (2d, d) and (2d,).

    Interior walls have 0.
    """
    return {
        "momentum_per_area": np.pad(momentum, ((0, walls), (0, 0))),
        "heat_per_area": np.pad(heat, (0, walls)),
    }


class EventPerAreaPart(TallyPart):
    """Sums of the event-driven engine, with masses in units of `unit_mass`."""

    kernel: PerArea

    def __init__(self, scene: Scene, state: State, unit_mass: float) -> None:
        d = scene.dimension
        sums = np.zeros((2 * d * (d + 1), 2))
        super().__init__(PerAreaTally.name, PerArea(*inverse_areas(scene, state), sums), {"per_area": sums})
        self._scene, self._unit_mass = scene, unit_mass

    def reset(self, clock: float) -> None:
        """Begin to count from zero."""
        self.kernel.sums[...] = 0.0

    def counts(self, clock: float) -> dict[str, Any]:
        """Return the sums by the fields of `Tally`."""
        d = self._scene.dimension
        sums = values(self.kernel.sums).reshape(2 * d, d + 1) * self._unit_mass
        return per_area_fields(sums[:, :d], sums[:, d], len(self._scene.walls))


class ThreadedPerAreaPart(Part):
    """Sums of an engine whose threads add to them.

    read : function that returns the value of the sums, (2d, d + 1)
    """

    def __init__(self, sums: np.ndarray, read: Callable[[np.ndarray], np.ndarray]) -> None:
        super().__init__({}, sums={"per_area": sums})
        self._read = read

    def counts(self, clock: float) -> dict[str, Any]:
        """Return the sums by the fields of `Tally`."""
        sums = self._read(self.sums["per_area"])
        return per_area_fields(sums[:, :-1], sums[:, -1], 0)
