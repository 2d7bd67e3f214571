"""Theory of a large particle's motion, by Langevin's and by the linear Boltzmann equation.

The latter is for a light particle.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from gaspart import theory
from gaspart.errors import SceneError
from gaspart.reproduction.points.point import Point
from gaspart.theory.boltzmann import relaxing_speeds, tagged_paths

HEAVY = 10.0
"""Mass divided by a gas particle's mass above which Langevin's equation is taken as exact.

It is exact for a sphere in the limit of a large ratio; the velocity autocorrelation of a particle of equal
mass decays 0.6 % more slowly up to half a friction time.
"""
GROUPS, MOST = 200, 300
"""Groups of paths of the linear Boltzmann equation, and the maximum number of paths in each.

Each group has as many paths as the point has replicas, up to MOST: the statistical error of theory is the
error of the measurement divided by sqrt(200), which is negligible, or the error of 60 000 paths.
"""
GAS = 100_000
"""Gas particles from whose speeds those that hit are drawn."""


@dataclass(frozen=True)
class BrownianMotion:
    """Theory's predictions for a point.

    `share` is the large particle's part of all mass where momentum is conserved (all axes periodic), else 0.
    """

    mass: float
    gas_mass: float
    radius: float
    temperature: float
    contact: float
    friction: float
    diffusion: float
    share: float
    mean_free_path: float

    @property
    def is_light(self) -> bool:
        """True if the particle is too light for Langevin's equation."""
        return self.mass <= HEAVY * self.gas_mass


def motion_of(point: Point) -> BrownianMotion:
    """Return the motion of a point's scene of one particle and one species.

    Raises SceneError for others.
    """
    scene, where = point.scene, f"experiments.{point.experiment}.scene"
    if len(scene.particles) != 1 or len(scene.species) != 1:
        raise SceneError(
            where, point.settings.get("scene"), "must have one entry of particles and one species"
        )
    particle, gas = scene.particles[0], scene.species[0]
    temperature = gas.initial_temperature(3)
    contact = particle.radius + gas.radius
    lower, upper = scene.reach(gas.radius)
    room = math.prod(b - a for a, b in zip(lower, upper, strict=True))
    density = gas.count / (room - theory.particle_volume(3, 2.0 * contact))
    friction = float(theory.friction_rate(density, contact, particle.mass, gas.mass, temperature))
    conserved = scene.is_periodic
    return BrownianMotion(
        mass=particle.mass,
        gas_mass=gas.mass,
        radius=particle.radius,
        temperature=temperature,
        contact=contact,
        friction=friction,
        diffusion=float(theory.tagged_diffusion(friction, particle.mass, gas.mass, temperature)),
        share=particle.mass / (particle.mass + gas.count * gas.mass) if conserved else 0.0,
        mean_free_path=1.0 / (math.sqrt(2.0) * math.pi * density * (2.0 * gas.radius) ** 2),
    )


def light_paths(point: Point, motion: BrownianMotion) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Yield paths of the linear Boltzmann equation from rest, in GROUPS.

    They are sampled as the point's runs: times (T,), displacements and velocities (T, N, 3). A gas of equal
    speeds relaxes by its own collisions meanwhile.
    """
    gas, times = point.scene.species[0], point.schedule
    frames = times.equilibration_frames + times.samples
    # n pi d^2, from the mean free path of Maxwell's gas, 1 / (sqrt(2) n pi d^2)
    own = 1.0 / (math.sqrt(2.0) * motion.mean_free_path)
    middle = times.sample_interval * (np.arange(frames) + 0.5)
    if gas.speed is not None:
        speeds = gas.speed * relaxing_speeds(GAS, gas.speed * middle, own)
    else:
        thermal = math.sqrt(motion.temperature / motion.gas_mass)
        even = (np.arange(GAS) + 0.5) / GAS
        speeds = [np.asarray(theory.maxwell_ppf(even, 3, thermal**2))] * frames
    hits = own * (motion.contact / (2.0 * gas.radius)) ** 2
    time = times.sample_interval * np.arange(frames + 1)
    size = min(point.replicas, MOST)
    ratio = motion.mass / motion.gas_mass
    paths = tagged_paths(speeds, times.sample_interval, hits, ratio, GROUPS * size)
    for group in np.split(np.arange(GROUPS * size), GROUPS):
        yield time, paths.displacements[:, group], paths.velocities[:, group]
