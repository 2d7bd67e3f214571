"""Counters and sums of an engine."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

ENERGY, IMPULSE = "mass length^2/time^2", "mass length/time"
ACTION, HEAT = "mass length^2/time", "mass length^3/time^2"
SPEED, PRESSED, HEATED = "length/time", "mass length^(2-d)/time", "mass length^(3-d)/time^2"
"""Units of sums, and of the velocity that goes with them; of momentum and heat per area."""


def tallied_fluxes(sums: np.ndarray, drift: np.ndarray) -> dict[str, np.ndarray]:
    """The fields of `Tally` from the sums of the stress tensor, of its collisional part, each by rows, and of
    the heat flux, (2 d^2 + d,), and from the velocity (d,) about which they are."""
    dimension = len(drift)
    stress = sums[: 2 * dimension**2].reshape(2, dimension, dimension)
    heat = sums[2 * dimension**2 :]
    fluxes = {"stress_sum": stress[0], "collisional_stress_sum": stress[1], "heat_sum": heat}
    return {**fluxes, "flux_velocity": drift.copy()}


@dataclass
class Tally:
    """Counters of a simulation and other sums, since the last reset.

    time: simulated time covered; collisions of pairs; wall_hits and wall_impulse (2d + interior walls,), the
    momentum given to each face (x low, x high, y low ...) and then to each interior wall; wall_energy, the
    heat given to each of them by particles that it re-emitted thermally; virial_sum: sum of
    |dr.dp| over collisions; pair_tests: pairs examined; box_visits: boxes searched; crossings of box
    boundaries; worst_contact: largest |r^2/sigma^2 - 1| at a contact; dissipated_energy: energy lost in
    inelastic contacts; elastic_contacts, of pairs and with walls, that were elastic since an earlier one of
    the same particle had not ended (`Restitution.contact_duration`), and retained_energy, what they would
    have dissipated; thermostat_energy: energy given by kicks.

    If a thermal face moves, or a force drives the gas along it, otherwise None: wall_shear (2d + interior
    walls, d), the momentum along each axis given to each thermal face by particles that leave it with all
    components drawn; wall_energy then includes the work that the face does.

    If faces are open, otherwise None: entries (2d + interior walls,), of particles through each of them;
    wall_hits are then those that have left there, wall_impulse the momentum along the normal that both carry
    through, and wall_energy the energy of those that have left less that of those that have entered.

    If particles of several sizes reach other areas of faces, otherwise None: momentum_per_area (2d + interior
    walls, d), the momentum along each axis given to each face, outwards along its normal, with that of each
    particle divided by the area of the face that centres of its size can reach (`scene.accessible`), in the
    container at the start; heat_per_area (2d + interior walls,), likewise of wall_energy. Those of interior
    walls are 0, and those that an engine does not tally.

    If particles are fixed, fixed_collisions: the collisions with these, which are among `collisions`, too.

    If they were asked for, otherwise None: stress_sum (d, d), the time integral of the stress tensor times
    the volume, of m v v and, at a collision, of r dp, with r the vector from the second particle to the
    first and dp the momentum that this gains; collisional_stress_sum (d, d), the latter alone; heat_sum
    (d,), that of the heat flux times the volume, likewise of E v and r dE (Helfand, Phys. Rev. 119, 1
    (1960)); flux_velocity (d,), that of the centre of mass, about which all these velocities are; of a
    sheared gas about the flow, at time 0. momentum_flux_sum (species, bins): of each species, and last
    of all single particles, the momentum along an axis that has flown through planes across it with the
    particles themselves (m v^2 of those that cross, times the time), the mean over the planes of each bin;
    under gravity less the momentum that this has given to the particles below (`analysis.impulses`).
    contact_impulse_sum, other_impulse_sum (shells,): k_B T g(r) times the time, the mean over each shell, as
    the pairs that collide give it, and what all other pairs add (`analysis.pair_impulses`).

    The time-stepped engine also reports its errors: steps; overlaps_left, pairs that still overlap and
    approach when a step ends; deepest_overlap met, as a fraction of the contact distance;
    multiple_contacts, particles that met more than one other in a step; rebuilds of its neighbour list.
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
    """Z = 1 + sum |dr . dp| / (d N k_B T t) of N particles without walls, from the virial sum of a time t."""
    return np.asarray(1.0 + virial / (dimension * count * temperature * time))
