"""Plain gas, to which most formulas of kinetic theory apply."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from gaspart.scene.composition import Composition


@dataclass(frozen=True)
class Gas:
    """Identical, smooth and elastic particles that collide only with each other and with hard faces."""

    dimension: int
    packing_fraction: float
    count: int
    diameter: float
    temperature: float
    mass: float = 1.0

    @property
    def thermal_speed(self) -> float:
        """Thermal speed sqrt(k_B T / m)."""
        return math.sqrt(self.temperature / self.mass)

    @property
    def particle(self) -> dict[str, float]:
        """Diameter, temperature and mass, as keyword arguments for functions of `gaspart.theory`."""
        return {"diameter": self.diameter, "temperature": self.temperature, "mass": self.mass}

    @property
    def parameters(self) -> dict[str, Any]:
        """Entries of `particle`, with packing_fraction and dimension."""
        return {"packing_fraction": self.packing_fraction, "dimension": self.dimension, **self.particle}


@dataclass(frozen=True)
class Mixture:
    """Smooth, elastic particles of any sizes and masses that hit each other and hard faces only."""

    dimension: int
    packing_fraction: float
    counts: tuple[int, ...]
    diameters: tuple[float, ...]
    masses: tuple[float, ...]
    temperature: float

    @property
    def sizes(self) -> tuple[float, int, tuple[float, ...], tuple[int, ...]]:
        """Packing fraction, dimension, diameters and counts as arguments of `gaspart.theory`."""
        return self.packing_fraction, self.dimension, self.diameters, self.counts

    def thin(self, most: int) -> Mixture:
        """Return a mixture with every k-th size only, so that at most `most` sizes remain. This approximation
        is valid for the sizes of one species.
        """
        step = -(-len(self.counts) // most)
        kept = slice(step // 2, None, step)
        sizes = self.counts[kept], self.diameters[kept], self.masses[kept]
        return Mixture(self.dimension, self.packing_fraction, *sizes, self.temperature)


def mixture_of(scene: Composition) -> Mixture | None:
    """Return the mixture of a scene; see `Scene.mixture`."""
    counts, diameters, masses = [], [], []
    kinds = [kind for kind in scene.kinds if kind.count]
    for kind in kinds:
        sizes = [kind.radius] if kind.alike else kind.radii.tolist()
        counts += [kind.count // len(sizes)] * len(sizes)
        diameters += [2.0 * radius for radius in sizes]
        masses += [kind.mass] * len(sizes)
    if not kinds:
        return None
    energies = (kind.count * kind.initial_temperature(scene.dimension) for kind in kinds)
    parts = tuple(counts), tuple(diameters), tuple(masses)
    return Mixture(scene.dimension, scene.packing_fraction, *parts, sum(energies) / scene.count)
