"""All particles at one time: the input and the output of engines."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gaspart.errors import SceneError
from gaspart.scene.boundaries import flow
from gaspart.scene.faces import FLOW, GRADIENT
from gaspart.scene.scene import Scene


@dataclass(repr=False)
class State:
    """All particles at one time: the input and the output of engines.

    The mass and the moment of inertia of a fixed particle are infinite. Sums over particles exclude fixed
    particles.

    Parameters
    ----------
    time : float, [time]
        Time.
    positions : ndarray, shape (N, d), [length]
        Positions of the centres; on periodic axes, of the images inside the container.
    velocities : ndarray, shape (N, d), [length/time]
        Velocities.
    images : ndarray of int, shape (N, d)
        Net number of times that each particle has crossed the container along each periodic axis.
    radii : ndarray, shape (N,), [length]
        Radii.
    masses : ndarray, shape (N,), [mass]
        Masses.
    species : ndarray of int, shape (N,)
        Index of the species of each particle. All single particles together form an additional species, the
        last.
    lengths : ndarray, shape (d,), [length]
        Lengths of the container.
    spins : ndarray, shape (N,) in 2D or (N, 3) in 3D, [1/time]
        Angular velocities.
    moments_of_inertia : ndarray, shape (N,), [mass length^2]
        Moments of inertia.
    gravity : ndarray, shape (d,), optional, [length/time^2]
        Acceleration. None if there is no gravity.
    well_energies : ndarray, shape (N,), optional, [energy]
        Potential energy of each particle in the wells of the faces. None if no face has a well.
    vibrations : ndarray, shape (N,), optional, [energy]
        Energy of each particle's vibration. None if no particle vibrates.
    piston : ndarray, shape (2,), optional, [length] and [length/time]
        Position of the piston along its axis, and its velocity. None if there is no piston.
    piston_face : str, optional
        Name of the face or interior wall that is the piston. None if there is no piston.
    displaced : float, optional, [length]
        Displacement along x of the periodic images above the container. None if the gas is not sheared.
    shear_rate : float, optional, [1/time]
        Shear rate du_x / dy of the flow, which is included in the velocities. None if the gas is not sheared.
    numbers : ndarray of int, shape (N,), optional
        Number in the run of each particle that is inside. None if no face is open.

    See Also
    --------
    Simulation : Advance a state in time.
    last_state : Return the state at the end of a run.

    Examples
    --------
    >>> import gaspart as gp
    >>> from gaspart.state.initial import initial_state
    >>> disc = gp.Particle(position=(2.0, 5.0), velocity=(3.0, 4.0), radius=0.5)
    >>> state = initial_state(gp.Scene(gp.Container((10.0, 10.0)), particles=[disc]), seed=1)
    >>> state
    <State of 1 discs at time 0>
    >>> state.positions, state.moments_of_inertia
    (array([[2., 5.]]), array([0.125]))
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

    def __setattr__(self, name: str, value: object) -> None:
        if vars(self).get("_fixed"):  # a new array in a view would not affect the simulation
            rule = (
                "cannot be set in the state of a simulation: change its copy(), and start from the copy by "
            )
            raise SceneError(name, value, rule + "Simulation(scene, initial=copy)")
        super().__setattr__(name, value)

    def __repr__(self) -> str:
        kind = "discs" if self.dimension == 2 else "spheres"
        return f"<State of {self.count} {kind} at time {self.time:g}>"

    @property
    def count(self) -> int:
        """Number N of particles."""
        return len(self.positions)

    @property
    def dimension(self) -> int:
        """Number of dimensions, 2 or 3."""
        return self.positions.shape[1]

    @property
    def unwrapped(self) -> np.ndarray:
        """Positions that continue beyond periodic faces without jumps, shape (N, d), [length].

        Examples
        --------
        >>> import gaspart as gp
        >>> from gaspart.state.initial import initial_state
        >>> disc = gp.Particle(position=(2.0, 5.0), velocity=(3.0, 4.0), radius=0.5)
        >>> box = gp.Container((10.0, 10.0), boundary="periodic")
        >>> state = initial_state(gp.Scene(box, particles=[disc]), seed=1)
        >>> state.images[0] = 1, 0
        >>> state.unwrapped
        array([[12.,  5.]])
        """
        positions = self.positions + self.images * self.lengths
        if self.displaced is not None:
            positions[:, FLOW] += self.images[:, GRADIENT] * self.displaced
        return positions

    @property
    def speeds(self) -> np.ndarray:
        """Speeds of the particles, shape (N,), [length/time]."""
        return np.sqrt((self.velocities**2).sum(axis=1))

    @property
    def kinetic_energies(self) -> np.ndarray:
        """Translational plus rotational energy of each particle, (N,), [energy]; 0 for fixed particles."""
        flight = _finite(self.masses) * (self.velocities**2).sum(axis=1)
        turning = _finite(self.moments_of_inertia) * self.spins.T**2
        return 0.5 * (flight + (turning if turning.ndim == 1 else turning.sum(axis=0)))

    @property
    def momentum(self) -> np.ndarray:
        """Total momentum, shape (d,), [mass length/time]."""
        # not @, because BLAS differs between machines
        return (_finite(self.masses)[:, None] * self.velocities).sum(axis=0)

    @property
    def angular_momentum(self) -> np.ndarray | float:
        """Total angular momentum about the origin, including spins, [mass length^2/time].

        The result is a number in 2D and has the shape (3,) in 3D.

        Examples
        --------
        >>> import gaspart as gp
        >>> from gaspart.state.initial import initial_state
        >>> disc = gp.Particle(position=(2.0, 5.0), velocity=(3.0, 4.0), radius=0.5)
        >>> state = initial_state(gp.Scene(gp.Container((10.0, 10.0)), particles=[disc]), seed=1)
        >>> float(state.angular_momentum)
        -7.0
        """
        orbital = np.cross(self.unwrapped, self.velocities) if self.dimension == 3 else _cross(self)
        return (_finite(self.masses) * orbital.T + _finite(self.moments_of_inertia) * self.spins.T).sum(
            axis=-1
        )

    @property
    def translational_energy(self) -> float:
        """Kinetic energy of flight of all particles, [energy]."""
        return 0.5 * float((_finite(self.masses)[:, None] * self.velocities**2).sum())

    @property
    def rotational_energy(self) -> float:
        """Kinetic energy of spin of all particles, [energy]."""
        if not self.spins.any():  # equal for smooth particles, and much cheaper
            return 0.0
        return 0.5 * float((_finite(self.moments_of_inertia) * (self.spins**2).T).sum())

    @property
    def temperature(self) -> float:
        """Temperature k_B T from velocities relative to the centre of mass, [energy].

        The temperature of N particles is 2 E / (d (N - 1)), where E is the translational energy relative to
        the centre of mass. This is correct for a gas without walls.

        Raises
        ------
        ZeroDivisionError
            If there are fewer than 2 particles.
        """
        momentum = self.momentum
        centre_energy = 0.5 * float((momentum**2).sum()) / float(_finite(self.masses).sum())
        return 2.0 * (self.translational_energy - centre_energy) / (self.dimension * (self.count - 1))

    @property
    def kinetic_energy(self) -> float:
        """Kinetic energy of flight and spin of all particles, [energy]."""
        return self.translational_energy + self.rotational_energy

    @property
    def potential_energy(self) -> float:
        """Energy of all particles in wells and under gravity, [energy].

        The energy under gravity is 0 for a centre at the origin. On periodic axes it is computed from
        positions that continue beyond the faces (`unwrapped`).
        """
        energy = 0.0 if self.well_energies is None else float(self.well_energies.sum())
        if self.gravity is not None:
            energy -= float((_finite(self.masses)[:, None] * self.unwrapped * self.gravity).sum())
        return energy

    @property
    def vibrational_energy(self) -> float:
        """Energy of the vibrations of all particles, [energy]; 0 if no particle vibrates."""
        return 0.0 if self.vibrations is None else float(self.vibrations.sum())

    @property
    def energy(self) -> float:
        """Sum of the kinetic, potential and vibrational energy of all particles, [energy]."""
        return self.kinetic_energy + self.potential_energy + self.vibrational_energy

    def copy(self) -> State:
        """Return a state that shares no array with this state.

        Returns
        -------
        State
            Copy, which may be changed and may start another simulation.

        Examples
        --------
        >>> import gaspart as gp
        >>> from gaspart.state.initial import initial_state
        >>> disc = gp.Particle(position=(2.0, 5.0), velocity=(3.0, 4.0), radius=0.5)
        >>> state = initial_state(gp.Scene(gp.Container((10.0, 10.0)), particles=[disc]), seed=1)
        >>> reverse = state.copy()
        >>> reverse.velocities *= -1.0
        >>> state.momentum, reverse.momentum
        (array([3., 4.]), array([-3., -4.]))
        """
        arrays: dict[str, Any] = {
            key: value.copy() for key, value in vars(self).items() if isinstance(value, np.ndarray)
        }
        return replace(self, **arrays)

    def read_only(self) -> State:
        """Return a state whose arrays cannot be changed.

        Returns
        -------
        State
            State with read-only views of the same arrays. They are read-only because a change would not
            affect the simulation.
        """
        state = replace(self)
        for key, value in vars(self).items():
            if isinstance(value, np.ndarray):
                view = value.view()
                view.flags.writeable = False
                setattr(state, key, view)
        vars(state)["_fixed"] = True
        return state


def by_number(state: State, values: np.ndarray, capacity: int) -> np.ndarray:
    """Return values of the particles of a state, ordered by the numbers of the particles."""
    if state.numbers is None:
        return values
    every = np.full((capacity, *values.shape[1:]), np.nan)
    every[state.numbers] = values
    return every


def _finite(values: np.ndarray) -> np.ndarray:
    """Return an array in which infinite values are replaced by 0."""
    return np.where(np.isinf(values), 0.0, values)


def _cross(state: State) -> np.ndarray:
    """Return the cross product r x v of each particle in 2D, shape (N,)."""
    r, v = state.unwrapped, state.velocities
    return r[:, 0] * v[:, 1] - r[:, 1] * v[:, 0]


# Velocity of the centre of mass of a gas; fluxes are computed relative to it.


_ROUNDED = 2.0**-46  # mean velocity, in units of the rms speed, that is attributed to rounding


def drift_of(scene: Scene, state: State) -> np.ndarray:
    """Return the velocity of the centre of mass of a state without fixed particles."""
    velocities = state.velocities - flow(scene, state.positions)
    shares = (state.masses / state.masses.sum())[:, None] if state.count else np.zeros((0, 1))
    drift = (shares * velocities).sum(axis=0)
    return np.where(abs(drift) > _ROUNDED * np.sqrt((shares * velocities**2).sum()), drift, 0.0)
