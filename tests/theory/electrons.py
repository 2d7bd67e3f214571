"""Boltzmann equation of electrons and scatterers with modes, between two walls, by direct simulation.

Electrons in two dimensions do not collide with each other. A scatterer has a mode with an energy. An electron
that hits a scatterer along a normal n exchanges its energy along n with the energy of the mode. Its velocity
perpendicular to n does not change. Electrons hit scatterers at random after a mean free path, which is the
unit of length. This is molecular chaos, which requires scatterers that are far from each other. Electrons
that leave a wall have the temperature of the wall.

This program computes `heat.METAL_BEND`, the deviation of the temperature profile of the electrons from a
straight line. For scatterers that only deflect, n sqrt(T) is uniform, and T is linear far from the walls.
Here a fast electron loses its energy at a hit, not only its direction. n T^0.65 is uniform (from correlations
in equilibrium), so T^0.85 is linear, except if mean free paths are not short compared with the gap.
"""

import numpy as np

_CELLS = 100
"""Number of cells in the gap; electrons in one cell hit the same modes."""
_PER_CELL = 1.0
"""Number of modes divided by the number of electrons; the steady state does not depend on it."""
_STEP = 0.2
"""Time step of all electrons, in mean free paths divided by sqrt(cold). Flights are exact, but hits of
different electrons within a step have no order.
"""


class MetalSlab:
    """Electrons between a hot and a cold wall."""

    def __init__(self, hot: float, gap: float, count: int, seed: int = 0) -> None:
        self.hot, self.gap, self.rng = hot, gap, np.random.default_rng(seed)
        mean = 0.5 * (hot + 1.0)
        self.positions = self.rng.uniform(0.0, gap, count)
        self.velocity = np.sqrt(mean) * self.rng.standard_normal((count, 2))
        self.modes = self.rng.exponential(mean, (_CELLS, round(_PER_CELL * count / _CELLS)))

    def profile(self, duration: float, bins: int) -> np.ndarray:
        """Advance the electrons, and sum their energies and numbers in bins over time."""
        sums = np.zeros((2, bins))
        for _ in range(round(duration / _STEP)):
            self._advance()
            where = np.minimum((self.positions * (bins / self.gap)).astype(int), bins - 1)
            energy = 0.5 * (self.velocity**2).sum(axis=1)
            sums += [np.bincount(where, weights, bins) for weights in (energy, None)]
        return sums

    def _advance(self) -> None:
        """Advance all electrons by a step."""
        moving, remaining = np.arange(len(self.positions)), np.full(len(self.positions), _STEP)
        while moving.size:
            across = self.velocity[moving, 0]
            ahead = np.where(across > 0.0, self.gap - self.positions[moving], self.positions[moving])
            to_wall = ahead / np.maximum(np.abs(across), 1e-300)
            speed = np.linalg.norm(self.velocity[moving], axis=1)
            to_hit = self.rng.exponential(size=moving.size) / speed
            flight = np.minimum(np.minimum(to_wall, to_hit), remaining[moving])
            self.positions[moving] = np.clip(self.positions[moving] + across * flight, 0.0, self.gap)
            stopped = flight < remaining[moving]
            remaining[moving] -= flight
            self._leave_wall(moving[stopped & (to_wall <= to_hit)])
            self._swap(moving[stopped & (to_hit < to_wall)])
            moving = moving[stopped]

    def _leave_wall(self, which: np.ndarray) -> None:
        """Draw new velocities at the wall, diffusely at its temperature.

        Normal velocities have the distribution of a flux.
        """
        at_cold = self.velocity[which, 0] > 0.0
        thermal = np.sqrt(np.where(at_cold, 1.0, self.hot))
        normal = np.sqrt(2.0 * self.rng.exponential(size=which.size))
        self.velocity[which, 0] = np.where(at_cold, -thermal, thermal) * normal
        self.velocity[which, 1] = thermal * self.rng.standard_normal(which.size)

    def _swap(self, which: np.ndarray) -> None:
        """Exchange the energy along the normal of each particle with one mode of the cell.

        No mode is used twice.
        """
        cell = np.minimum((self.positions[which] * (_CELLS / self.gap)).astype(int), _CELLS - 1)
        order = np.argsort(cell, kind="stable")
        which, cell = which[order], cell[order]
        rank = np.arange(which.size) - np.searchsorted(cell, cell)
        mode = (rank + self.rng.integers(self.modes.shape[1])) % self.modes.shape[1]
        velocity = self.velocity[which]
        speed = np.linalg.norm(velocity, axis=1)
        sine = self.rng.uniform(-1.0, 1.0, which.size)  # impact parameter instead of the angle of incidence
        cosine = np.sqrt(1.0 - sine**2)
        ahead = velocity / speed[:, None]
        aside = np.stack([-ahead[:, 1], ahead[:, 0]], axis=1)
        normal = sine[:, None] * aside - cosine[:, None] * ahead
        along = -speed * cosine
        mode_speed = np.sqrt(2.0 * self.modes[cell, mode])
        self.modes[cell, mode] = 0.5 * along**2
        self.velocity[which] = velocity + (mode_speed - along)[:, None] * normal
