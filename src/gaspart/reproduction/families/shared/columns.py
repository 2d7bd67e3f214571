"""A column of gas under gravity: heights, energies and forces of runs, averaged over blocks of time.

Gravity points down the last axis of a container of two dimensions. Heights are those of particles' centres
above the lowest place that the centre of the smallest particle can reach.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.points.point import Point
from gaspart.scene.species import Particle, Species


@dataclass(frozen=True)
class Field:
    """The gravity, container and particles of a point's scene, in its units.

    strength: of gravity, positive downwards; width and height: of the place where the centres of the smallest
    particles can be (the width of a periodic axis is its length); diameter: of the smallest particles; masses
    (N,), infinite for fixed particles; species (N,), numbered as in the scene, single particles after them;
    across: whether the other axis is periodic, so that momentum along it is conserved.
    """

    strength: float
    width: float
    height: float
    diameter: float
    masses: np.ndarray
    species: np.ndarray
    across: bool

    @property
    def weight(self) -> float:
        """The temperature of all particles that move."""
        return float(self.strength * self.masses[np.isfinite(self.masses)].sum())


def field(point: Point) -> Field:
    """The field and the container of a point."""
    scene = point.scene
    radius = scene.smallest_radius
    lower, upper = scene.reach(radius)
    parts: list[tuple[Species | Particle, int, int]] = [
        (particle, 1, len(scene.species)) for particle in scene.particles
    ]
    parts += [(kind, kind.count, n) for n, kind in enumerate(scene.species)]
    return Field(
        strength=-scene.gravity[-1] if scene.gravity else 0.0,
        width=upper[0] - lower[0],
        height=upper[1] - lower[1],
        diameter=2.0 * radius,
        masses=np.concatenate([np.full(k, np.inf if kind.fixed else kind.mass) for kind, k, _ in parts]),
        species=np.concatenate([np.full(k, n) for _, k, n in parts]),
        across=scene.container.periodic[0],
    )


@dataclass(frozen=True)
class Stretch:
    """Consecutive frames of one run; T frames, N particles.

    positions (T, N, 2), the second one the height; energies (T, N), kinetic ones, without the centre of
    mass's motion along a periodic axis; floor, ceiling: mean forces on them; gain: mean rate at which the
    particles' upward momentum grew.
    """

    positions: np.ndarray
    energies: np.ndarray
    floor: float
    ceiling: float
    gain: float

    @property
    def heights(self) -> np.ndarray:
        """(T, N)."""
        return self.positions[..., 1]


def stretches(point: Point, number: int) -> list[Stretch]:
    """The measured part of every replica, cut into `number` stretches of equal length (a remainder is
    omitted).

    Neighbours share a frame at which momenta are read, and no other. Raises ValueError for too few frames.
    """
    place, found = field(point), []
    for run in runs(point):
        impulse = run.data["wall_impulse"].values[:, 2:4]
        length = run.block_length(number)
        for start in range(0, number * length, length):
            stop = start + length
            duration = run.time[stop] - run.time[start]
            forces = (impulse[stop] - impulse[start]) / duration
            frames = slice(start + 1, stop + 1)
            ends = run.velocities[[start, stop], :, 1]
            parts = run.positions[frames], run.velocities[frames], ends, forces, duration
            found.append(_stretch(place, *parts))
    return found


def _stretch(
    place: Field,
    positions: np.ndarray,
    velocities: np.ndarray,
    ends: np.ndarray,
    forces: np.ndarray,
    duration: float,
) -> Stretch:
    moving = np.isfinite(place.masses)
    masses = np.where(moving, place.masses, 0.0)
    drift = np.zeros((len(velocities), 1))
    if place.across and moving.all():  # a fixed particle takes momentum away
        drift = (velocities[..., 0] @ masses / masses.sum())[:, None]
    energies = 0.5 * masses * ((velocities[..., 0] - drift) ** 2 + velocities[..., 1] ** 2)
    heights = positions[..., 1] - 0.5 * place.diameter
    return Stretch(
        positions=np.stack([positions[..., 0], heights], axis=-1),
        energies=energies,
        floor=float(forces[0]),
        ceiling=float(forces[1]),
        gain=float((ends[1] - ends[0]) @ masses / duration),
    )


def temperature(place: Field, stretch: Stretch) -> float:
    """Twice the mean kinetic energy per degree of freedom (one is lost with a conserved momentum)."""
    moving = np.isfinite(place.masses)
    freedom = 2 * moving.sum() - (place.across and moving.all())
    return 2.0 * float(stretch.energies.sum(axis=1).mean()) / freedom


@dataclass(frozen=True)
class Profile:
    """Averages in B bins of height: density (S, B) of each species; temperature (B,), NaN in empty bins;
    pressure (B,), the force per length that carries the gas above: that of the ceiling and the weight."""

    density: np.ndarray
    temperature: np.ndarray
    pressure: np.ndarray


def profile(place: Field, stretch: Stretch, bins: int) -> Profile:
    """Profiles of a stretch without fixed particles, averaged over each of `bins` equal bins of height.

    In a steady state the momentum below any height is constant, so the pressure at z is (F_ceiling +
    sum of m g over particles above z) / width (exact; no equation of state is used).
    """
    frames, count = stretch.heights.shape
    scaled = stretch.heights.ravel() * (bins / place.height)
    bin_of = np.clip(scaled.astype(int), 0, bins - 1)
    masses = np.tile(place.masses, frames)
    kinds = int(place.species.max()) + 1
    places = np.tile(place.species, frames) * bins + bin_of
    counts = np.bincount(places, minlength=kinds * bins).reshape(kinds, bins)
    total = counts.sum(axis=0)
    energy = np.bincount(bin_of, stretch.energies.ravel(), minlength=bins)
    # In a bin's average over z, a particle within it counts for the part of the bin that lies below it.
    mass = np.bincount(bin_of, masses, minlength=bins)
    within = np.bincount(bin_of, masses * np.clip(scaled - bin_of, 0.0, 1.0), minlength=bins)
    above = np.cumsum(mass[::-1])[::-1] - mass + within
    area = place.width * place.height / bins
    lost = 2.0 * count / (2.0 * count - place.across)  # the momentum that is conserved
    with np.errstate(invalid="ignore"):
        temperature = np.where(total > 0, lost * energy / np.maximum(total, 1), np.nan)
    return Profile(
        density=counts / (frames * area),
        temperature=temperature,
        pressure=(stretch.ceiling + place.strength * above / frames) / place.width,
    )
