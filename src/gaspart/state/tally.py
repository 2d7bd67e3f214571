"""Counters and sums of an engine."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from gaspart.errors.guidance import with_guidance

ENERGY, IMPULSE = "mass length^2/time^2", "mass length/time"
ACTION, HEAT = "mass length^2/time", "mass length^3/time^2"
SPEED, PRESSED, HEATED = "length/time", "mass length^(2-d)/time", "mass length^(3-d)/time^2"
"""Units of sums, and of the velocity that goes with them; of momentum and heat per area."""


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


@with_guidance
@dataclass
class Tally:
    """Counters and sums of a simulation since the last reset.

    F faces: the 2 d faces of the container (x low, x high, y low, ...), then the interior walls.

    Parameters
    ----------
    time : float, [time]
        Simulated time.
    collisions : int
        Collisions of pairs.
    wall_hits : ndarray of int, shape (F,)
        Particles that hit each face. With open faces: number of particles that have left through each face.
    wall_impulse : ndarray, shape (F,), [mass length/time]
        Momentum given to each face. With open faces: the normal momentum of particles that leave and enter.
    wall_energy : ndarray, shape (F,), [energy]
        Heat given to each face by particles that the face re-emitted thermally. If there is a `wall_shear`,
        the heat includes the work of the face. If faces are open: the energy of particles that have left less
        the energy of particles that have entered.
    virial_sum : float, [mass length^2/time]
        Sum of abs(dr.dp) over collisions.
    pair_tests : int
        Pairs examined.
    box_visits : int
        Boxes searched.
    fixed_collisions : int, default 0
        Collisions with fixed particles, which are also among `collisions`.
    crossings : int, default 0
        Crossings of box boundaries.
    worst_contact : float, default 0.0, [1]
        Largest abs(r^2/sigma^2 - 1) at a contact.
    dissipated_energy : float, default 0.0, [energy]
        Energy lost in inelastic contacts.
    elastic_contacts : int, default 0
        Contacts of pairs and with walls that were elastic because an earlier contact of the same particle had
        not ended (`Restitution.contact_duration`).
    retained_energy : float, default 0.0, [energy]
        Energy that these contacts would have dissipated.
    thermostat_energy : float, default 0.0, [energy]
        Energy added by kicks.
    steps : int, default 0
        Steps of the engine, if it has time steps.
    overlaps_left : int, default 0
        Pairs that still overlap and approach when a step ends: an error of the time-stepped engine.
    deepest_overlap : float, default 0.0, [1]
        Deepest overlap that occurred, as a fraction of the contact distance: an error of the time-stepped
        engine.
    multiple_contacts : int, default 0
        Particles that met more than one other particle in a step: an error of the time-stepped engine.
    rebuilds : int, default 0
        Rebuilds of the neighbour list of the time-stepped engine.
    wall_shear : ndarray, shape (F, d), optional, [mass length/time]
        Momentum along each axis given to each thermal face by particles whose velocity components are all
        drawn when they leave. None unless a thermal face moves, or a force drives the gas along a thermal
        face.
    entries : ndarray of int, shape (F,), optional
        Particles that have entered through each face. None unless faces are open.
    momentum_per_area : ndarray, shape (F, d), optional, [mass length^(2-d)/time]
        Momentum along each axis given to each face, positive along the outward normal. The momentum of each
        particle is divided by the area of the face that centres of its size can reach (`scene.accessible`),
        in the container at the start. The value is 0 for interior walls and for faces that an engine does not
        tally. None unless particles of different sizes can reach different areas of faces.
    heat_per_area : ndarray, shape (F,), optional, [mass length^(3-d)/time^2]
        Energy of `wall_energy`, divided in the same way, and with the same zeros. Absent without
        `momentum_per_area`.
    stress_sum : ndarray, shape (d, d), optional, [mass length^2/time]
        Time integral of the stress tensor times the volume: of m v v and, at a collision, of r dp. Here r is
        the vector from the second particle to the first, and dp is the momentum that the first particle
        gains. None unless requested.
    collisional_stress_sum : ndarray, shape (d, d), optional, [mass length^2/time]
        Collisional part of `stress_sum`.
    heat_sum : ndarray, shape (d,), optional, [mass length^3/time^2]
        Time integral of the heat flux times the volume: of E v and r dE [1]_.
    flux_velocity : ndarray, shape (d,), optional, [length/time]
        Velocity of the centre of mass; all velocities in the fluxes are relative to it. In a sheared gas they
        are relative to the flow, and this is the velocity at time 0.
    momentum_flux_sum : ndarray, shape (species, bins), optional, [mass length/time]
        Momentum of each species (single particles last) along an axis, transported through planes across the
        axis by the particles themselves: m v^2 of the particles that cross, times the time. Each value is the
        mean over the planes in a bin. Under gravity, the momentum that gravity has given to the particles
        below the plane is subtracted (`analysis.impulses`). None unless requested.
    contact_impulse_sum : ndarray, shape (shells,), optional, [mass length^2/time]
        Mean over each shell of k_B T g(r) times the time, from the pairs that collide
        (`analysis.pairs`). None unless requested.
    other_impulse_sum : ndarray, shape (shells,), optional, [mass length^2/time]
        Contribution of all other pairs to the same quantity.

    See Also
    --------
    Simulation : Simulation that has a tally.

    References
    ----------
    .. [1] E. Helfand, Phys. Rev. 119, 1 (1960).

    Examples
    --------
    >>> import gaspart as gp
    >>> import numpy as np
    >>> hits, impulse = np.array([0, 2, 1, 0]), np.array([0.0, 4.0, 2.0, 0.0])
    >>> tally = gp.Tally(10.0, 3, hits, impulse, np.zeros(4), virial_sum=5.0, pair_tests=9, box_visits=0)
    >>> tally.wall_impulse / tally.time
    array([0. , 0.4, 0.2, 0. ])
    """

    time: float
    collisions: int
    wall_hits: np.ndarray = field(metadata={"along": ("face",)})
    wall_impulse: np.ndarray = field(metadata={"along": ("face",), "units": IMPULSE})
    wall_energy: np.ndarray = field(metadata={"along": ("face",), "units": ENERGY})
    virial_sum: float = field(metadata={"units": ACTION})
    pair_tests: int
    box_visits: int
    fixed_collisions: int = field(default=0, metadata={"only": "fixed_collisions"})
    crossings: int = 0
    worst_contact: float = 0.0
    dissipated_energy: float = field(default=0.0, metadata={"units": ENERGY})
    elastic_contacts: int = 0
    retained_energy: float = field(default=0.0, metadata={"units": ENERGY})
    thermostat_energy: float = field(default=0.0, metadata={"units": ENERGY})
    steps: int = 0
    overlaps_left: int = 0
    deepest_overlap: float = 0.0
    multiple_contacts: int = 0
    rebuilds: int = 0
    wall_shear: np.ndarray | None = field(
        default=None, metadata={"along": ("face", "axis"), "units": IMPULSE, "only": "wall_shear"}
    )
    entries: np.ndarray | None = field(default=None, metadata={"along": ("face",), "only": "entries"})
    momentum_per_area: np.ndarray | None = field(
        default=None, metadata={"along": ("face", "axis"), "units": PRESSED, "only": "per_area"}
    )
    heat_per_area: np.ndarray | None = field(
        default=None, metadata={"along": ("face",), "units": HEATED, "only": "per_area"}
    )
    stress_sum: np.ndarray | None = field(
        default=None, metadata={"along": ("axis", "direction"), "units": ACTION, "only": "stress"}
    )
    collisional_stress_sum: np.ndarray | None = field(
        default=None, metadata={"along": ("axis", "direction"), "units": ACTION, "only": "stress"}
    )
    heat_sum: np.ndarray | None = field(
        default=None, metadata={"along": ("axis",), "units": HEAT, "only": "stress"}
    )
    flux_velocity: np.ndarray | None = field(
        default=None, metadata={"along": ("axis",), "units": SPEED, "only": "stress"}
    )
    momentum_flux_sum: np.ndarray | None = field(
        default=None, metadata={"along": ("species", "bin"), "units": IMPULSE, "only": "impulses"}
    )
    contact_impulse_sum: np.ndarray | None = field(
        default=None, metadata={"along": ("shell",), "units": ACTION, "only": "pair_impulses"}
    )
    other_impulse_sum: np.ndarray | None = field(
        default=None, metadata={"along": ("shell",), "units": ACTION, "only": "pair_impulses"}
    )


def compressibility_factor(
    virial: np.ndarray | float, count: int, dimension: int, temperature: float, time: np.ndarray | float
) -> np.ndarray:
    """Compute the compressibility factor of particles without walls from their virial sum.

    Parameters
    ----------
    virial : float or ndarray, [mass length^2/time]
        Sum of abs(dr.dp) over the collisions in a time t.
    count : int
        Number N of particles.
    dimension : {2, 3}
        Discs or spheres.
    temperature : float, [energy]
        Temperature k_B T.
    time : float or ndarray, [time]
        Time t.

    Returns
    -------
    ndarray, [1]
        Z = 1 + sum abs(dr.dp) / (d N k_B T t).
    """
    return np.asarray(1.0 + virial / (dimension * count * temperature * time))
