"""The rule of motion: what velocities, displacements and temperatures are relative to.

Temperature, speeds, msd, vacf, D and all of `by_species` are about the same local flow, by default; with
about="rest", about the container at rest, whatever flows.

Of a group of particles in local equilibrium, u = sum m v / M their mean velocity, M their mass, a particle's
component has <m (v - u)^2> = (1 - m / M) k_B T, exactly, whatever u is: the part m / M of a degree of freedom
is spent on u. What is taken as a group depends on how the gas can move:

- as a whole: all particles of a frame, along axes on which their momentum is conserved;
- between faces that slide, under a force along a periodic axis, or in a `wind`: the particles of a cell in
  all frames, a steady flow;
- before faces that move along their normal, and between open ones: those of a cell in one frame, since the
  flow changes.

A flow that is known, between sheared faces (`LeesEdwards`), is taken off before.

A displacement about a steady flow is that of the particle less the time integral of the flow where it is, by
the trapezoidal rule over frames: <|dr|^2> is then twice the integral of the velocity autocorrelation about
the flow, without what a gradient of the flow adds (Taylor's dispersion). About a flow that changes it is not
known from frames.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaspart.analysis.bins import Grid
from gaspart.scene.shear import flow

if TYPE_CHECKING:
    from gaspart.analysis.run import Run

ABOUT = FLOW, REST = "flow", "rest"
"""Frames of reference of motion: the local flow, or rest."""
_SAMPLES = 500  # particles in frames, in each cell, from which a steady flow is known well enough
_CELLS = 20  # along an axis, by default
_CROWD = 8  # particles in a cell whose flow changes, by default
_BLOWS = 3.0  # standard deviations of equilibrium from which on a mean momentum is a wind


@dataclass(frozen=True)
class Peculiar:
    """Velocities (T, M, d) of the M moving particles about the mean motion, and the degrees of freedom of
    their components, of a shape that extends to this: 1, less what is spent on the mean motion."""

    velocities: np.ndarray
    freedom: np.ndarray

    def energies(self, masses: np.ndarray) -> np.ndarray:
        """(T, M) twice the kinetic energy of each particle of masses (M,)."""
        return np.asarray(masses * (self.velocities**2).sum(axis=2))

    def freedoms(self) -> np.ndarray:
        """(T, M) degrees of freedom of each particle."""
        whole = np.broadcast_to(self.freedom, self.velocities.shape)
        return np.asarray(whole.sum(axis=2))


def about_the_whole(run: Run) -> Peculiar:
    """Velocities about that of the centre of mass in each frame, along the axes on which the total momentum
    is conserved, and about the flow of a sheared gas."""
    return about_the_mean(_about_known(run), run.masses[run.moving], run.conserved)


def about_the_mean(velocities: np.ndarray, masses: np.ndarray, axes: np.ndarray) -> Peculiar:
    """Velocities (T, M, d) of particles of masses (M,) about that of their centre of mass in each frame,
    along axes (d,)."""
    total = masses.sum() or 1.0  # of none: nothing
    drift = np.einsum("tnd,n->td", velocities, masses) / total
    apart = velocities - np.where(axes, drift, 0.0)[:, None]
    return Peculiar(apart, np.where(axes, 1.0 - masses[:, None] / total, 1.0)[None])


def _about_known(run: Run) -> np.ndarray:
    """(T, M, d) velocities of the moving particles, of a sheared gas about its flow."""
    velocities = run.velocities[:, run.moving]
    if run.scene.shear_rate is None:
        return velocities
    return velocities - flow(run.scene, run.positions[:, run.moving])


def flow_axes(run: Run) -> list[int]:
    """The axes along which the velocity of the gas may vary: those of the scene (`Facts.flow_axes`), or those
    of a wind; none if it moves as a whole only."""
    scene = run.scene
    return list(scene.flow_axes or (scene.resolved_axes() if wind(run).any() else ()))


def wind(run: Run) -> np.ndarray:
    """(d,) whether the gas moves along an axis without an end, although its momentum is not conserved there:
    the mean over the run is more than three times what it scatters by in equilibrium, sqrt(M k_B T). A wind
    that is weaker adds at most 9 / (d N) to the temperature. One particle has no scatter to compare with."""
    found = np.zeros(run.dimension, dtype=bool)
    masses = run.masses[run.moving]
    for axis in np.flatnonzero(run.periodic & ~run.conserved & (len(masses) > 1)):
        velocities = run.velocities[:, run.moving, axis]
        momentum = velocities @ masses
        square = (velocities**2 @ masses - momentum**2 / masses.sum()).mean() / len(masses)
        found[axis] = momentum.mean() ** 2 > _BLOWS**2 * max(square, 0.0) * masses.sum()
    return found


def about_the_flow(run: Run, along: Mapping[int, int] | None = None) -> Peculiar:
    """Velocities about rest, if the run is about it; about the local flow of mass, if the gas can have one,
    in cells along `flow_axes`; otherwise those `about_the_whole`. along: axis -> number of cells, where
    these are not the default ones; further axes are resolved too, unless the flow changes or there is
    none."""
    if run.about == REST:
        velocities = run.velocities[:, run.moving]
        return Peculiar(velocities, np.ones((1, velocities.shape[1], 1)))
    across = run.flow_axes
    if not across:
        return about_the_whole(run)
    changes = run.scene.flow_changes
    stated = dict(along or {})
    axes = across if changes else sorted({*across, *stated})
    return about_cells(run, {axis: stated.get(axis, _number(run, axes, changes)) for axis in axes}, changes)


def _number(run: Run, axes: list[int], changes: bool) -> int:
    """Of cells along each of these axes."""
    particles = int(run.moving.sum())
    samples = particles / _CROWD if changes else particles * len(run.time) / _SAMPLES
    return int(np.clip(samples ** (1.0 / len(axes)), 1, _CELLS))


def about_cells(run: Run, numbers: Mapping[int, int], changes: bool) -> Peculiar:
    """Velocities about the mean of mass in cells, as many as `numbers` states along each axis: in each frame
    if the flow `changes`, otherwise in all frames."""
    axes = list(numbers)
    lengths = np.array(run.scene.container.lengths)[axes]
    grid = Grid((0.0,) * len(axes), tuple(lengths.tolist()), tuple(numbers.values()))
    cells = grid.cells(run.positions[:, run.moving][..., axes], inside=True)
    blocks = np.arange(len(cells)) if changes else None
    groups = cells + grid.size * np.arange(len(cells))[:, None] if changes else cells
    velocities, masses = _about_known(run), run.masses[run.moving]
    weight = grid.sums(cells, masses, blocks).ravel()
    means = np.empty_like(velocities)
    for k in range(run.dimension):
        momentum = grid.sums(cells, masses * velocities[..., k], blocks).ravel()
        means[..., k] = np.divide(momentum, weight, out=np.zeros(weight.size), where=weight > 0.0)[groups]
    shares = np.divide(masses, weight[groups], out=np.ones(cells.shape), where=cells >= 0)
    return Peculiar(velocities - means, (1.0 - shares)[..., None])
