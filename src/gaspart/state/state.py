"""All particles at one time: the input and the output of engines."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gaspart.scene.faces import FLOW, GRADIENT


@dataclass(repr=False)
class State:
    """All particles at one time.

    time; positions (N, d), inside the container on periodic axes; velocities (N, d); images (N, d), how often
    each particle has crossed the container on periodic axes; radii, masses (N,); species (N,), the index of
    the particle's species, explicit particles being one more species after the others; lengths (d,); spins,
    angular velocities, (N,) in 2D and (N, 3) in 3D; moments_of_inertia (N,); gravity (d,) or None;
    well_energies (N,), the potential energy in the wells of the faces, and vibrations (N,), the energy of
    each particle's vibration, or None; piston (2,), its place along its axis and its velocity, and
    piston_face, the face of the container or the interior wall that it is, or None; of a sheared gas
    displaced, how far images above the container are displaced along x, and shear_rate, du_x / dy of the flow
    that the velocities include, or None; where faces are open, numbers (N,), which of the particles of the
    run are inside, or None. The mass and moment of inertia of a fixed particle are infinite; they count in no
    sum.
    """

    time: float
    positions: np.ndarray
    velocities: np.ndarray
    images: np.ndarray
    radii: np.ndarray
    masses: np.ndarray
    species: np.ndarray
    lengths: np.ndarray
    spins: np.ndarray
    moments_of_inertia: np.ndarray
    gravity: np.ndarray | None = None
    well_energies: np.ndarray | None = None
    vibrations: np.ndarray | None = None
    piston: np.ndarray | None = None
    piston_face: str | None = None
    displaced: float | None = None
    shear_rate: float | None = None
    numbers: np.ndarray | None = None

    def __repr__(self) -> str:
        kind = "discs" if self.dimension == 2 else "spheres"
        return f"<State of {self.count} {kind} at time {self.time:g}>"

    @property
    def count(self) -> int:
        """N, the number of particles."""
        return len(self.positions)

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return self.positions.shape[1]

    @property
    def unwrapped(self) -> np.ndarray:
        """(N, d) positions continued across periodic faces."""
        places = self.positions + self.images * self.lengths
        if self.displaced is not None:
            places[:, FLOW] += self.images[:, GRADIENT] * self.displaced
        return places

    @property
    def speeds(self) -> np.ndarray:
        """(N,) speeds."""
        return np.sqrt((self.velocities**2).sum(axis=1))

    @property
    def kinetic_energies(self) -> np.ndarray:
        """(N,) kinetic energies, of flight and spin together; 0 for a fixed particle."""
        flight = _finite(self.masses) * (self.velocities**2).sum(axis=1)
        turning = _finite(self.moments_of_inertia) * self.spins.T**2
        return 0.5 * (flight + (turning if turning.ndim == 1 else turning.sum(axis=0)))

    @property
    def momentum(self) -> np.ndarray:
        """(d,) total momentum."""
        return (_finite(self.masses)[:, None] * self.velocities).sum(axis=0)  # not @: BLAS differs by machine

    @property
    def angular_momentum(self) -> np.ndarray | float:
        """Total angular momentum about the container's origin, spins included: a number in 2D, (3,) in 3D."""
        orbital = np.cross(self.unwrapped, self.velocities) if self.dimension == 3 else _cross(self)
        return (_finite(self.masses) * orbital.T + _finite(self.moments_of_inertia) * self.spins.T).sum(
            axis=-1
        )

    @property
    def translational_energy(self) -> float:
        """Kinetic energy of flight, of all particles."""
        return 0.5 * float((_finite(self.masses)[:, None] * self.velocities**2).sum())

    @property
    def rotational_energy(self) -> float:
        """Kinetic energy of spin, of all particles."""
        if not self.spins.any():  # those of smooth particles, at a fraction of the cost
            return 0.0
        return 0.5 * float((_finite(self.moments_of_inertia) * (self.spins**2).T).sum())

    @property
    def temperature(self) -> float:
        """k_B T of a gas without walls: that of flight about the centre of mass, per degree of freedom.
        Raises ZeroDivisionError for fewer than two particles."""
        momentum = self.momentum
        whole = 0.5 * float((momentum**2).sum()) / float(_finite(self.masses).sum())
        return 2.0 * (self.translational_energy - whole) / (self.dimension * (self.count - 1))

    @property
    def kinetic_energy(self) -> float:
        """Translational and rotational."""
        return self.translational_energy + self.rotational_energy

    @property
    def potential_energy(self) -> float:
        """The energy of all particles in wells and under gravity, 0 where their centres are at the origin; on
        periodic axes it goes on falling from image to image."""
        energy = 0.0 if self.well_energies is None else float(self.well_energies.sum())
        if self.gravity is not None:
            energy -= float((_finite(self.masses)[:, None] * self.unwrapped * self.gravity).sum())
        return energy

    @property
    def vibrational_energy(self) -> float:
        """The energy of the vibrations of all particles; 0 where none vibrates."""
        return 0.0 if self.vibrations is None else float(self.vibrations.sum())

    @property
    def energy(self) -> float:
        """Kinetic, potential and vibrational."""
        return self.kinetic_energy + self.potential_energy + self.vibrational_energy

    def copy(self) -> State:
        """A state that shares no array with this one, to be changed and given to another simulation."""
        arrays: dict[str, Any] = {
            key: value.copy() for key, value in vars(self).items() if isinstance(value, np.ndarray)
        }
        return replace(self, **arrays)

    def read_only(self) -> State:
        """A state whose arrays cannot be changed: a change would not be that of the simulation."""
        state = replace(self)
        for key, value in vars(self).items():
            if isinstance(value, np.ndarray):
                view = value.view()
                view.flags.writeable = False
                setattr(state, key, view)
        return state


def by_number(state: State, values: np.ndarray, capacity: int) -> np.ndarray:
    """(capacity, ...) values (N, ...) of the particles of a state, each at its number in the run; NaN where
    there is no particle. The same values without open faces."""
    if state.numbers is None:
        return values
    every = np.full((capacity, *values.shape[1:]), np.nan)
    every[state.numbers] = values
    return every


def _finite(values: np.ndarray) -> np.ndarray:
    """Values with infinity replaced by 0."""
    return np.where(np.isinf(values), 0.0, values)


def _cross(state: State) -> np.ndarray:
    """(N,) r x v in 2D."""
    r, v = state.unwrapped, state.velocities
    return r[:, 0] * v[:, 1] - r[:, 1] * v[:, 0]
