"""Masses of the particles in the kernels' unit; power-of-two bounds of momenta and energies, for fixed-point
sums."""

from __future__ import annotations

import math

import numpy as np

from gaspart.engines.features.faces import face_energy
from gaspart.scene.scene import Scene
from gaspart.state.state import State


def scaled_masses(masses: np.ndarray) -> tuple[float, np.ndarray | None]:
    """(unit, array): equal masses are not part of the kernel's model, and their sums scaled by `unit`."""
    if len(masses) == 0:
        return 1.0, None
    return (float(masses[0]), None) if (masses == masses[0]).all() else (1.0, masses)


def largest_terms(scene: Scene, state: State, unit_mass: float) -> tuple[float, float]:
    """The momentum and the energy that few particles will exceed, each a power of two in units of
    `unit_mass`: sums that several threads make are in parts of these."""
    moving = np.isfinite(state.masses)
    if not moving.any():
        return 1.0, 1.0
    masses = state.masses[moving] / unit_mass
    given = face_energy(scene) + state.vibrational_energy
    energies = (state.kinetic_energies[moving] + given) / unit_mass
    if scene.gravity is not None:
        energies += masses * sum(
            abs(g) * length for g, length in zip(scene.gravity, state.lengths, strict=True)
        )
    momentum = float(np.sqrt(2.0 * masses * energies).max())
    energy = float(energies.max())
    return 2.0 ** math.frexp(momentum or 1.0)[1], 2.0 ** math.frexp(energy or 1.0)[1]
