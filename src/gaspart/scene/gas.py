"""The plain gas: the scene of which most formulas of kinetic theory speak."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from gaspart.errors import SceneError

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene


@dataclass(frozen=True)
class Gas:
    """Equal, smooth and elastic particles that only their contacts with each other and hard faces deflect.

    dimension: 2 or 3; packing_fraction: volume (area) of the particles over that of the container; count;
    diameter; temperature: k_B T; mass.
    """

    dimension: int
    packing_fraction: float
    count: int
    diameter: float
    temperature: float
    mass: float = 1.0

    @property
    def thermal_speed(self) -> float:
        """sqrt(k_B T / m)."""
        return math.sqrt(self.temperature / self.mass)

    @property
    def particle(self) -> dict[str, float]:
        """diameter, temperature and mass, as keyword arguments of the functions of `gaspart.theory`."""
        return {"diameter": self.diameter, "temperature": self.temperature, "mass": self.mass}

    @property
    def parameters(self) -> dict[str, Any]:
        """Those of `particle`, with packing_fraction and dimension."""
        return {"packing_fraction": self.packing_fraction, "dimension": self.dimension, **self.particle}


def plain_gas(scene: Scene) -> Gas:
    """`Scene.gas`. Raises SceneError for a scene that is none."""
    if scene.gas is None:
        rule = "must be one, of smooth and elastic particles alone, without gravity or obstacles"
        raise SceneError("species", len(scene.kinds), rule)
    return scene.gas
