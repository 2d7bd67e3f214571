"""Numbers of collisions of each pair of species, counted from recorded events."""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np

from gaspart.errors import SceneError
from gaspart.scene.scene import Scene
from gaspart.simulation import Simulation

_NAME = "pair collisions"  # name of the array in a checkpoint


def pairs_of(scene: Scene) -> list[tuple[int, int]]:
    """Return the pairs of species by their indices, the lower index first. Raises SceneError for single
    particles.
    """
    if scene.particles:
        raise SceneError(
            "particles", len(scene.particles), "excludes pairs, which are counted for species only"
        )
    return list(combinations_with_replacement(range(len(scene.species)), 2))


def pair_names(scene: Scene) -> list[str]:
    """Return the names of the pairs of species, such as "0-1"."""
    return [f"{first}-{second}" for first, second in pairs_of(scene)]


class PairCounter:
    """Numbers of collisions of each pair of species since time 0, from recorded events.

    counts : (pairs,), in the order of `pairs_of`.
    """

    def __init__(self, simulation: Simulation) -> None:
        scene = simulation.scene
        pairs, kinds = pairs_of(scene), len(scene.species)
        self._number = np.zeros((kinds, kinds), dtype=np.int64)
        for n, (first, second) in enumerate(pairs):
            self._number[first, second] = self._number[second, first] = n
        self._species = np.repeat(np.arange(kinds), [kind.count for kind in scene.species])
        self.counts = np.zeros(len(pairs))
        self._simulation = simulation
        simulation.record_events = True

    def take(self) -> None:
        """Count the events since the last call, and discard them."""
        particles = self._simulation.events["particles"]
        # only pairs, without hits of faces and walls
        species = self._species[particles[particles[:, 1] >= 0]]
        numbers = self._number[species[:, 0], species[:, 1]]
        self.counts += np.bincount(numbers, minlength=len(self.counts))
        self._simulation.record_events = True  # start a new, empty list

    def checkpoint(self) -> dict[str, np.ndarray]:
        """Return arrays from which `restore` continues."""
        return {_NAME: self.counts}

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        """Continue from a checkpoint."""
        self.counts = arrays[_NAME].copy()
