"""Homogeneous Boltzmann equation of hard spheres and discs, by direct simulation (Nanbu 1980, Babovsky 1986).

The programs behind the tables `rough_cooling.csv` and `rough_start.csv` of gaspart.theory: rough discs that
cool, and rough discs that start without spins. `homogeneous_gas` tests the tables `relaxation_2d.csv` and
`_3d.csv` and the fourth cumulant of a cooling gas.
"""

from dataclasses import dataclass

import numpy as np

from gaspart.theory.boltzmann import _meetings, directions, dot
from gaspart.theory.geometry import checked_dimension
from gaspart.theory.granular import rough_ratio


@dataclass(frozen=True)
class Homogeneous:
    """Evolution of a homogeneous gas: values at the start and after S - 1 steps."""

    collisions: np.ndarray
    kurtosis: np.ndarray
    never_hit: np.ndarray
    energy: np.ndarray


def homogeneous_gas(
    count: int, dimension: int, collisions: float, restitution: float = 1.0, seed: int = 0
) -> Homogeneous:
    """Simulate a gas of particles that start with speed 1 and isotropic directions."""
    rng, d = np.random.default_rng(seed), checked_dimension(dimension)
    velocity = directions(rng, count, d)
    hit = np.zeros(count, dtype=bool)
    progress, rows = 0.0, [(0.0, 1.0, 1.0, 1.0)]
    while progress < collisions:
        i, j, normal, approach = _meetings(rng, velocity)
        change = 0.5 * (1.0 + restitution) * approach[:, None] * normal
        velocity[i] -= change
        velocity[j] += change
        hit[i] = hit[j] = True
        progress += 2.0 * len(i) / count
        square = dot(velocity, velocity)
        rows.append((progress, (square**2).mean() / square.mean() ** 2, 1.0 - hit.mean(), square.mean()))
    return Homogeneous(*np.array(rows).T)


def rough_discs(
    count: int, collisions: float, inertia: float, tangential: float, normal: float = 1.0, seed: int = 0
) -> np.ndarray:
    """Simulate the ratio of rotational to translational temperature of cooling rough discs."""
    rng = np.random.default_rng(seed)
    velocity, spin = rng.standard_normal((count, 2)), rng.standard_normal(count)  # spin: R omega
    spin *= np.sqrt(rough_ratio(inertia, tangential, normal) / inertia)
    progress, ratios = 0.0, []
    while progress < collisions:
        progress += _rough_step(rng, velocity, spin, inertia, tangential, normal)
        ratios.append(2.0 * inertia * (spin**2).mean() / dot(velocity, velocity).mean())
    return np.array(ratios)


def rough_start(
    count: int, collisions: float, inertia: float, seed: int = 0
) -> tuple[np.ndarray, np.ndarray]:
    """Simulate perfectly rough discs with initially Maxwellian velocities and zero spins."""
    rng = np.random.default_rng(seed)
    velocity, spin = rng.standard_normal((count, 2)), np.zeros(count)
    start = 0.5 * dot(velocity, velocity).mean()
    progress, rows = 0.0, [(0.0, 1.0)]
    while progress < collisions:
        progress += _rough_step(rng, velocity, spin, inertia, 1.0, 1.0)
        difference = 0.5 * dot(velocity, velocity).mean() - inertia * (spin**2).mean()
        rows.append((progress, difference / start))
    where, differences = np.array(rows).T
    return where, differences


def _rough_step(
    rng: np.random.Generator,
    velocity: np.ndarray,
    spin: np.ndarray,
    inertia: float,
    tangential: float,
    normal: float,
) -> float:
    """Advance rough discs by a step in place, and return the number of collisions per disc."""
    share = inertia * (1.0 + tangential) / (2.0 * inertia + 2.0)
    i, j, along, approach = _meetings(rng, velocity)
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    slip = dot(velocity[i] - velocity[j], across) + spin[i] + spin[j]
    change = 0.5 * (1.0 + normal) * approach[:, None] * along + share * slip[:, None] * across
    velocity[i] -= change
    velocity[j] += change
    spin[i] -= share / inertia * slip
    spin[j] -= share / inertia * slip
    return 2.0 * len(i) / len(velocity)
