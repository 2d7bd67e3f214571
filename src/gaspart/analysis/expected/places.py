"""Theory of positions: pair distributions, structure factor, insertion, and profiles along an axis."""

from __future__ import annotations

from typing import Any

import numpy as np

from gaspart import theory
from gaspart.analysis.expected.equilibrium import (
    Expected,
    contact_of_number,
    equation_of,
    is_mixed,
    is_relaxed,
    scale_of_number,
)
from gaspart.analysis.run import Run
from gaspart.errors import SceneError
from gaspart.scene.sizes import ball_volume
from gaspart.theory.bulk import BOLTZMANN, ENSKOG, EXACT
from gaspart.theory.finite_size import insertion_potential
from gaspart.theory.mixture_properties import mixture_insertion_correction, percus_yevick_partial_factors
from gaspart.trajectory.correlator import pairs_of

_LEAST_UNIFORM = 16
"""Minimum number of hard particles with a uniform density in a run that conserves momentum. Relative to the
fixed centre of mass, the density has waves with N periods in the container. Their amplitude is 95 % for two
discs at a packing fraction of 0.3, 16 % for three discs and 3 % for four discs. It is below 1 % for 16 discs
at 0.65 and for 16 spheres at 0.48.
"""
_LAYERED = 0.05
"""Packing fraction above which layers at a wall change the density, which a local equation of state omits."""


_DEVIATION, _AT_FRACTION, _POWER = 0.05, 0.48, 5.0
"""Largest relative deviation of g(r) of Verlet and Weis from runs of 864 spheres, the packing fraction of
these runs, and the power of the packing fraction with which it decreases (1.7 % at 0.4, below 1 % at 0.3).
"""
_FURTHEST = 4.9
"""Largest distance of g(r) of Verlet and Weis, in diameters."""
_NODES = 6  # nodes of the mean over a bin


def radial_distribution(run: Run, distance: np.ndarray, width: float) -> Expected | None:
    """Compute the mean of g(r) in bins (distance,) of a width: 1 for point particles. For equal spheres it is
    the approximation of Verlet and Weis. Its contact value and compressibility are Carnahan and Starling's.
    For hard discs no theory is given.
    """
    equation, gas = equation_of(run), run.fluid
    if not is_mixed(run, 1.0):  # each pair keeps its relative velocity
        return None
    if equation == BOLTZMANN:
        return _of_points(run, np.ones(len(distance)))
    if equation == ENSKOG or gas is None or gas.dimension == 2:
        return None
    eta = gas.packing_fraction
    if eta > theory.coexistence_packing_fractions(3)[0] or contact_of_number(run, eta, 3) is None:
        return None
    edges = np.array([distance - 0.5 * width, distance + 0.5 * width]) / gas.diameter
    lower, upper = np.clip(edges, 1.0, _FURTHEST)
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    r = lower + 0.5 * np.multiply.outer(nodes + 1.0, upper - lower)
    within = weights @ (r**2 * theory.verlet_weis_rdf(r, eta)) * 0.5 * (upper - lower)
    mean = np.where(edges[1] > _FURTHEST, np.nan, 3.0 * within / (edges[1] ** 3 - edges[0] ** 3))
    error = mean * _DEVIATION * (eta / _AT_FRACTION) ** _POWER + np.minimum(mean, 1.0) / run.count
    return Expected(mean, error, "Verlet and Weis, mean over each bin")


def _of_points(run: Run, values: Any) -> Expected | None:
    """Return the values if positions are independent: smooth elastic point particles without a field."""
    if run.mixture is None and run.scene.gas is None:
        return None
    return Expected(values, 0.0, "Boltzmann equation: independent places", 0.0)


def structure_factor(run: Run, wave_number: np.ndarray) -> Expected | None:
    """Compute the expected S(k) (wave_number,): Verlet and Weis for equal spheres, 1 for points."""
    equation, gas = equation_of(run), run.fluid
    if equation == BOLTZMANN:
        return _of_points(run, np.ones(len(wave_number)))
    if equation == ENSKOG or gas is None or gas.dimension == 2:
        return None
    law = theory.verlet_weis_structure_factor(wave_number * gas.diameter, gas.packing_fraction)
    return Expected(law, np.nan, "Verlet and Weis")


def partial_structure_factors(run: Run, wave_number: np.ndarray) -> Expected | None:
    """Compute the expected partial structure factors (pair, wave_number). The factors are known for spheres
    if each species has a single size. For point particles, the factor of a species with itself is 1 and the
    factor of two different species is 0.
    """
    equation, mixture, species = equation_of(run), run.mixture, run.scene.species
    pairs = pairs_of(run.scene)
    same = np.array([[float(a == b)] for a, b in pairs]) + 0.0 * wave_number
    if equation == BOLTZMANN:
        return _of_points(run, same)
    if equation == ENSKOG or mixture is None or mixture.dimension == 2:
        return None
    if not all(kind.alike and kind.count for kind in species):
        return None
    counts = np.array([kind.count for kind in species])
    if run.scene.alike:
        total = structure_factor(run, wave_number)
        assert total is not None
        parts = np.sqrt(counts / counts.sum())
        factors = np.array([[parts[a] * parts[b]] for a, b in pairs])
        return total._replace(value=same + factors * (total.value - 1.0))
    diameters = [2.0 * kind.radius for kind in species]
    factors = percus_yevick_partial_factors(wave_number, mixture.packing_fraction, diameters, counts)
    return Expected(np.array([factors[:, a, b] for a, b in pairs]), np.nan, "Percus and Yevick, Lebowitz")


def chemical_potential(run: Run) -> Expected | None:
    """Compute the expected chemical potential for insertion into a finite number of particles. For hard
    particles the chemical potential follows from the equation of state. For point particles the result is
    exact, because no particle may be nearer to the inserted position than the sum of the radii. The result is
    a scalar for equal particles; otherwise it has the shape (species,).
    """
    equation, mixture = equation_of(run), run.mixture
    if equation == ENSKOG or mixture is None:
        return None
    eta, d, diameters, counts = mixture.sizes[0], mixture.dimension, mixture.diameters, mixture.counts
    if equation == BOLTZMANN:
        potential = _into_points(run, np.array(diameters), np.array(counts))
        source = "insertion among independent places"
        return None if potential is None else Expected(potential, 0.0, source, 0.0)
    if run.scene.alike:
        side = min(run.scene.container.lengths) / diameters[0]
        try:
            value, error = insertion_potential(eta, d, run.count, side)
        except ValueError:
            return None
        return Expected(value, error, "Gibbs and Duhem, of this number")
    if scale_of_number(run, mixture) is None:
        return None
    sizes, which = np.unique(diameters, return_inverse=True)
    numbers = np.bincount(which, counts)
    try:
        value = theory.mixture_chemical_potentials(eta, d, sizes, numbers)
        value += mixture_insertion_correction(eta, d, sizes, numbers)
    except SceneError:  # the differences need densities above the range of the equation of state
        return None
    source = "equation of state of Santos, Yuste and Lopez de Haro, of these numbers"
    return Expected(value[which], np.nan, source)


def _into_points(run: Run, diameters: np.ndarray, counts: np.ndarray) -> Any | None:
    """Compute the chemical potential among independent positions; None if a particle may overlap two
    images.
    """
    between = 0.5 * np.add.outer(diameters, diameters)
    covered = np.array(
        [theory.particle_volume(run.dimension, 2.0 * diameter) for diameter in between.ravel()]
    )
    chance = 1.0 - covered.reshape(between.shape) / run.scene.container.volume
    if not (chance > 0.0).all() or 2.0 * diameters.max() > min(run.scene.container.lengths):
        return None
    potential = -np.log(chance) @ counts
    return float(potential[0]) if run.scene.alike else potential


def temperature(run: Run) -> Expected | None:
    """Return the equilibrium temperature, which is uniform. The uncertainty is the corresponding difference
    between the lowest and the highest position.
    """
    scene = run.scene
    if scene.faces or scene.face_temperatures or not scene.has_equilibrium or not is_relaxed(run):
        return None
    error = 0.0
    if scene.gravity is not None:
        extent = np.subtract(*scene.reach(scene.smallest_radius)[::-1])
        heaviest = max(kind.mass for kind in scene.moving_kinds)
        error = 2.0 * heaviest * float(np.abs(scene.gravity) @ extent) / run.freedom
    return Expected(run.temperature, error, "equilibrium")


def density(run: Run, axis: int, edges: np.ndarray, species: int | None) -> Expected | None:
    """Compute the expected density (bins,) of all particles, if they are equal. Without gravity along the
    axis the density is uniform. With gravity it is hydrostatic; for point particles it follows the barometric
    law.
    """
    scene = run.scene
    covers_all = species is None or run.count == len(np.flatnonzero(run.species == species))
    if not (covers_all and scene.alike) or scene.has_obstacles or scene.is_open or scene.dissipates:
        return None
    if run.periodic[axis]:
        return Expected(scene.number_density, 0.0, "uniform") if _is_uniform(run, axis) else None
    pulled = [n for n, g in enumerate(scene.gravity or ()) if g and not run.periodic[n]]
    if pulled != [axis] or scene.faces or not scene.has_equilibrium:
        return None
    if run.is_subset or not run.temperature > 0.0:  # of unknown temperature, or at rest
        return None
    assert scene.gravity is not None
    return _barometric_density(run, axis, edges, scene.gravity[axis])


def _is_uniform(run: Run, axis: int) -> bool:
    """Return True if the density of equal particles is uniform along a periodic axis: a fluid, no face and no
    region.
    """
    scene = run.scene
    if scene.moving_axes or scene.ramps:
        return False
    if any(kind.region is not None or kind.arrangement == "slab" for kind in scene.species):
        return False
    if equation_of(run) != EXACT:
        return True
    if scene.packing_fraction > theory.coexistence_packing_fractions(run.dimension)[0]:
        return False
    return not (scene.conserved_axes[axis] and run.count < _LEAST_UNIFORM)


def _barometric_density(run: Run, axis: int, edges: np.ndarray, field: float) -> Expected | None:
    """Compute the density (bins,) of equal particles under gravity along an axis."""
    scene, kind = run.scene, run.scene.kinds[0]
    lower, upper = scene.reach(kind.radius)
    z = np.linspace(lower[axis], upper[axis], 2001)
    area = scene.container.volume / scene.container.lengths[axis]
    weight = kind.mass * abs(field) / run.temperature
    if equation_of(run) == BOLTZMANN:
        profile = run.count / area * theory.ideal_profile(z - z[0], z[-1] - z[0], weight)
        source = "Boltzmann equation, barometric law"
    else:
        try:
            profile = theory.hydrostatic_profiles(
                z, [run.count / area], [weight], run.dimension, 2.0 * kind.radius
            )[0]
        except ValueError:  # above the density range of the theory
            return None
        source = "hydrostatics, local equation of state, two diameters from walls"
        layered = profile * ball_volume(run.dimension, kind.radius) > _LAYERED
        near = np.minimum(z - z[0], z[-1] - z) < 4.0 * kind.radius
        profile = np.where(layered & near, np.nan, profile)
    if field > 0.0:
        profile = profile[::-1]
    known = np.nan_to_num(profile)
    total = np.concatenate([[0.0], np.cumsum(0.5 * (known[1:] + known[:-1]) * np.diff(z))])
    share = np.diff(np.interp(edges, z, total))
    unknown = np.cumsum(np.isnan(profile))
    share[np.diff(np.interp(edges, z, unknown)) > 0.0] = np.nan
    return Expected(share / np.diff(edges), np.nan, source)
