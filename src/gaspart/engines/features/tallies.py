"""Tallies of stress, heat flux and impulses, and of sums per area of a face."""

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
from gaspart.scene.scene import Scene
from gaspart.scene.sizes import ball_volume
from gaspart.state.optional_tallies import OptionalTally
from gaspart.state.state import State, drift_of
from gaspart.state.tally import ImpulseTally, PairImpulseTally, PerAreaTally


def tallied_fluxes(sums: np.ndarray, drift: np.ndarray) -> dict[str, np.ndarray]:
    """Return the sums of the fluxes of momentum and heat as fields of `Tally`."""
    dimension = len(drift)
    stress = sums[: 2 * dimension**2].reshape(2, dimension, dimension)
    heat = sums[2 * dimension**2 :]
    fluxes = {"stress_sum": stress[0], "collisional_stress_sum": stress[1], "heat_sum": heat}
    return {**fluxes, "flux_velocity": drift.copy()}


class StressPart(TallyPart):
    """Stress tensor and heat flux of a gas without walls.

    flights : (N,), flights of the particles; velocities are constant until the next contact
    drift : (d,), velocity of the centre of mass
    """

    kernel: Stress

    def __init__(self, flights: np.ndarray, model: Model, unit_mass: float, drift: np.ndarray) -> None:
        self._flights, self._unit_mass = flights, unit_mass
        self._masses = model.space, model.masses, model.law
        self._drift, d = drift, len(drift)
        sums = np.zeros((2 * d * d + d, 2))
        super().__init__("stress", Stress(sums, np.zeros((2, d + 1)), drift.copy()), {"stress": sums})

    def end_epoch(self, length: float, start: float) -> None:
        add_flights(self._flights, length, *self._masses, self.kernel)

    def reset(self, clock: float) -> None:
        self.kernel.sums[...] = 0.0
        add_flights(self._flights, -clock, *self._masses, self.kernel)

    def read(self, clock: float) -> np.ndarray:
        """Return the sums (2 d^2 + d,) up to this time on the epoch's clocks."""
        total = self.kernel._replace(sums=self.kernel.sums.copy())
        add_flights(self._flights, clock, *self._masses, total)
        return values(total.sums) * self._unit_mass

    def counts(self, clock: float) -> dict[str, Any]:
        return tallied_fluxes(self.read(clock), self._drift)


class ShearedStressPart(StressPart):
    """Stress tensor and heat flux of a sheared gas, by flights since their last events."""

    def __init__(self, flights: np.ndarray, model: Model, unit_mass: float, drift: np.ndarray) -> None:
        super().__init__(flights, model, unit_mass, drift)
        self._model = model

    def begin_epoch(self, length: float, start: float, model: Model) -> Model:
        """Set the velocity of the centre of mass relative to the flow. The component along the gradient of
        the flow is constant. Therefore the component along the flow decreases linearly with time.
        """
        assert model.shear is not None  # otherwise this part would not exist
        across = self._drift[GRADIENT]
        self.kernel.drift[FLOW] = self._drift[FLOW] - model.shear.rate * across * start
        return model

    def close_epoch(self, length: float) -> None:
        add_sheared_flights(self._flights, length, 1.0, self._model, self.kernel)

    def end_epoch(self, length: float, start: float) -> None:
        """Do nothing, because the motion starts again in the next epoch."""

    def reset(self, clock: float) -> None:
        self.kernel.sums[...] = 0.0
        add_sheared_flights(self._flights, clock, -1.0, self._model, self.kernel)

    def read(self, clock: float) -> np.ndarray:
        total = self.kernel._replace(sums=self.kernel.sums.copy())
        add_sheared_flights(self._flights, clock, 1.0, self._model, total)
        return values(total.sums) * self._unit_mass


def stress_part(
    tally: OptionalTally, flights: np.ndarray, model: Model, unit_mass: float, scene: Scene, state: State
) -> StressPart:
    """Return the stress part for a gas with or without shear. `state`: initial state."""
    kind = StressPart if model.shear is None else ShearedStressPart
    return kind(flights, model, unit_mass, drift_of(scene, state))


# Momentum that particles carry through planes across an axis, computed from their impulses.


def rows_of(scene: Scene) -> np.ndarray:
    """Return the row (N,) of each particle in sums by species; single particles have the last row."""
    counts = [len(scene.particles), *(kind.count for kind in scene.species)]
    return np.repeat([len(scene.species), *range(len(scene.species))], counts)


class ImpulsesPart(TallyPart):
    """Momentum that particles transport through planes across an axis. The sums contain the momentum below
    each plane at the last reset, plus all impulses since then. When the tally is read, the present momentum
    below each plane is subtracted.

    flights : (N,), particles at the times of their last events
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
        """Add `sign` times the momenta of all particles at `clock` of the epoch to the sums."""
        flights, model = self._flights.copy(), self._model
        advance_all(flights, clock, model.space, model.gravity)
        kernels.add_momenta(flights, sign, model, self.kernel._replace(sums=sums))

    def reset(self, clock: float) -> None:
        self.kernel.sums[...] = 0.0
        self._add_momenta(clock, 1.0, self.kernel.sums)

    def read(self, clock: float) -> np.ndarray:
        """Return the transported momentum (species, bins) up to this time on the clocks of the epoch."""
        sums = self.kernel.sums.copy()
        self._add_momenta(clock, -1.0, sums)
        return np.asarray(self._unit_mass * np.cumsum(sums, axis=1)[:, :-1])

    def counts(self, clock: float) -> dict[str, Any]:
        return {"momentum_flux_sum": self.read(clock)}


def impulses_part(
    tally: OptionalTally, flights: np.ndarray, model: Model, unit_mass: float, scene: Scene, state: State
) -> ImpulsesPart:
    """Return the part for an `ImpulseTally`."""
    assert isinstance(tally, ImpulseTally)
    return ImpulsesPart(flights, model, unit_mass, scene, "xyz".index(tally.axis), tally.bins)


# Momentum that pairs gain along their separation, computed from the impulses of contacts.


_FINEST = 2.0**-27
"""Unit of the integer sums, divided by the contribution of a contact with a thermal momentum.

The distance in this contribution is the smallest diameter. A sum does not overflow for up to 2^36 of these
contributions.
"""


class PairImpulsesPart(TallyPart):
    """Sums over pairs of particles for g(r), stored as integers.

    unit : value of the integer 1 in the units of `Tally`
    """

    kernel: PairImpulses

    def __init__(self, kernel: PairImpulses, unit: float) -> None:
        super().__init__("pair_impulses", kernel, {"pair_impulses": kernel.sums})
        self._units = np.array([[unit], [unit / kernel.share]])

    def reset(self, clock: float) -> None:
        self.kernel.sums[...] = 0

    def read(self, clock: float) -> np.ndarray:
        """Return k_B T g(r) times the time (2, shells), for colliding and for other pairs."""
        return np.asarray(self._units * np.cumsum(self.kernel.sums, axis=1)[:, :-1])

    def counts(self, clock: float) -> dict[str, Any]:
        sums = self.read(clock)
        return {"contact_impulse_sum": sums[MEETING], "other_impulse_sum": sums[OTHERS]}


def pair_impulses_part(
    tally: OptionalTally, flights: np.ndarray, model: Model, unit_mass: float, scene: Scene, state: State
) -> PairImpulsesPart:
    """Return the part for a `PairImpulseTally`."""
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
"""Functions that make the parts for optional tallies of the event-driven engine, by name."""


# Momentum and heat given to faces by particles of each size, divided by the accessible areas.
#
# The areas are those of the initial container, with moving faces and walls at their initial positions.


def inverse_areas(scene: Scene, state: State) -> tuple[np.ndarray, np.ndarray]:
    """Return inverse accessible areas (sizes, 2d) of faces, 0 if unreachable, and particles' index
    of size.
    """
    fixed = ~np.isfinite(state.masses)
    sizes, size = np.unique(state.radii[~fixed], return_inverse=True)
    areas = Accessible(scene, (state.positions[fixed], state.radii[fixed])).areas(sizes)
    numbers = np.zeros(state.count, np.int64)
    numbers[~fixed] = size
    return np.divide(1.0, areas, out=np.zeros_like(areas), where=areas > 0.0), numbers


def per_area_fields(momentum: np.ndarray, heat: np.ndarray, walls: int) -> dict[str, np.ndarray]:
    """Return the fields of `Tally` from sums over faces, (2d, d) and (2d,), with 0 for interior walls."""
    return {
        "momentum_per_area": np.pad(momentum, ((0, walls), (0, 0))),
        "heat_per_area": np.pad(heat, (0, walls)),
    }


class EventPerAreaPart(TallyPart):
    """Momentum and heat per accessible area, in units with `unit_mass`, for the event-driven engine."""

    kernel: PerArea

    def __init__(self, scene: Scene, state: State, unit_mass: float) -> None:
        d = scene.dimension
        sums = np.zeros((2 * d * (d + 1), 2))
        super().__init__(PerAreaTally.name, PerArea(*inverse_areas(scene, state), sums), {"per_area": sums})
        self._scene, self._unit_mass = scene, unit_mass

    def reset(self, clock: float) -> None:
        self.kernel.sums[...] = 0.0

    def counts(self, clock: float) -> dict[str, Any]:
        d = self._scene.dimension
        sums = values(self.kernel.sums).reshape(2 * d, d + 1) * self._unit_mass
        return per_area_fields(sums[:, :d], sums[:, d], len(self._scene.walls))


class ThreadedPerAreaPart(Part):
    """Momentum and heat per accessible area, for engines with several threads.

    read : function that returns the sums, shape (2d, d + 1)
    """

    def __init__(self, sums: np.ndarray, read: Callable[[np.ndarray], np.ndarray]) -> None:
        super().__init__({}, sums={"per_area": sums})
        self._read = read

    def counts(self, clock: float) -> dict[str, Any]:
        sums = self._read(self.sums["per_area"])
        return per_area_fields(sums[:, :-1], sums[:, -1], 0)
