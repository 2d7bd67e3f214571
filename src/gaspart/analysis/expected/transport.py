"""Theory of motion and transport: displacements, diffusion, viscosities and conductivity."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from gaspart import theory
from gaspart.analysis.expected.equilibrium import (
    LEAST_OF_NUMBER,
    OF_NUMBER,
    SOURCES,
    Expected,
    engine_of,
    equation_of,
    is_mixed,
    is_relaxed,
)
from gaspart.analysis.run import Run
from gaspart.engines import Engine
from gaspart.scene.facts import Gas
from gaspart.scene.scene import Scene
from gaspart.theory import bulk
from gaspart.theory.bulk import BOLTZMANN, ENSKOG, EXACT
from gaspart.theory.diffusion import ERPENBECK_WOOD_HIGHEST, VISCOSITY_RATIO_UNCERTAINTY, velocity_decay_rate
from gaspart.theory.discretisation import contact_values
from gaspart.theory.mixture_properties import dilute_mixture_conductivity
from gaspart.theory.modes import diffusion_by_modes

_WINDOW = 12.0, 24.0
"""Default first and last lag of the slope that gives D, in collisions of a particle; see
`analysis.diffusion`.
"""


def mean_squared_displacement(run: Run, time: np.ndarray, axes: bool = False) -> Expected | None:
    """Compute the expected mean-squared displacement (lag,) from the linear Boltzmann equation. If `axes` is
    True, the result is the mean-squared displacement along each axis.
    """
    gas = None if run.is_subset else run.moving_fluid
    if gas is None or not is_relaxed(run):
        return None
    equation = equation_of(run)
    contact = bulk.contact_value(gas, equation)
    curve = theory.enskog_mean_squared_displacement(time, **gas.parameters, contact=contact)
    source = SOURCES[equation]
    curve = curve / (run.dimension if axes else 1)
    return Expected(curve, curve * _memory(gas, equation), f"{source}, linear Boltzmann equation")


def _memory(gas: Gas, equation: str) -> float:
    """Return the relative change of D by correlated collisions; NaN if it is unknown."""
    if equation != EXACT:
        return math.nan
    ratio = bulk.diffusion(gas, EXACT) / bulk.diffusion(gas, ENSKOG)
    return abs(ratio - 1.0)


def velocity_autocorrelation(run: Run, time: np.ndarray) -> Expected | None:
    """Compute the expected velocity autocorrelation (lag,), with the exact initial decay."""
    gas = None if run.is_subset else run.moving_fluid
    if gas is None or not is_relaxed(run):
        return None
    equation = equation_of(run)
    rate = float(velocity_decay_rate(**gas.parameters, contact=bulk.contact_value(gas, equation)))
    source = SOURCES[equation]
    decay = gas.temperature / gas.mass * np.exp(-rate * time)
    return Expected(decay, math.nan, f"{source}, exact initial decay")


def diffusion(
    run: Run, ends: np.ndarray | None = None, window: np.ndarray | tuple[float, float] = _WINDOW
) -> Expected | None:
    """Compute D of spheres in a periodic cube; see `diffusion_in_cube`. `ends`: (2,), lags between which D is
    half of the slope of the mean-squared displacement along an axis. `window`: (2,), first and last lag of
    the slope, in collisions of a particle.
    """
    if ends is not None:
        displacement = mean_squared_displacement(run, ends, axes=True)
        if displacement is None:
            return None
        value, error = (
            0.5 * float(np.diff(np.broadcast_to(part, np.shape(ends)))[0] / np.diff(ends)[0])
            for part in (displacement.value, displacement.error)
        )
        return displacement._replace(value=value, error=abs(error))
    gas, sides = run.moving_fluid, run.scene.container.lengths
    if gas is None or np.ptp(sides) > 1e-6 * sides[0]:
        return None
    return diffusion_in_cube(gas, sides[0], engine_of(run), run.scene, window)


def diffusion_in_cube(
    gas: Gas,
    side: float,
    engine: Engine | None,
    scene: Scene | None,
    window: np.ndarray | tuple[float, float] = _WINDOW,
) -> Expected | None:
    """Compute D of spheres in a periodic cube, for the engine of a scene. Without an engine, the exact
    dynamics is assumed. For the exact dynamics, D is the value of Erpenbeck and Wood minus two corrections:
    the finite-size correction of Yeh and Hummer, and the contribution of the modes of the container after the
    window of the slope. Half of the second correction is uncertain. For a kinetic equation, D is the value of
    this equation plus the contribution of the flow in the container, which the cells of the engine resolve.
    The uncertainty consists of half of both corrections, without the systematic error of the engine. Return
    None for discs, for spheres denser than the fluid, and for a cube so small that the periodic images order
    the fluid.
    """
    if gas.dimension == 2 or gas.packing_fraction > ERPENBECK_WOOD_HIGHEST:
        return None
    if engine is None or scene is None or engine.equation == EXACT:
        try:
            value, error = theory.diffusion_in_cube(gas.packing_fraction, side, **gas.particle)
        except ValueError:  # the periodic images of a particle order the fluid
            return None
        late = _after_window(gas, window)
        error = math.hypot(error, 0.5 * late)
        return Expected(value + late, error, "Erpenbeck and Wood, Yeh and Hummer")
    value = bulk.diffusion(gas, engine.equation)
    density = float(theory.number_density(gas.packing_fraction, 3, gas.diameter))
    spreading = bulk.shear_viscosity(gas, engine.equation) / (gas.mass * density) + value
    path = float(theory.mean_speed(3, gas.temperature, gas.mass)) / bulk.collision_rate(gas, engine.equation)
    added = (
        gas.temperature
        / gas.mass
        * diffusion_by_modes(side, gas.count, 3, engine.cells_along(scene), path, spreading)
    )
    source = f"{SOURCES[engine.equation]}, with the flow that its cells resolve"
    return Expected(value + added, 0.5 * added, source, value)


def _after_window(gas: Gas, window: np.ndarray | tuple[float, float]) -> float:
    """Compute by hydrodynamic modes the difference between the limit of D(t) and its value in a window, in
    collisions.
    """
    unit = gas.diameter / gas.thermal_speed
    times = np.linspace(float(window[0]), float(window[1]), 9) / bulk.collision_rate(gas, EXACT) / unit
    lacking = theory.diffusion_modes(times, gas.packing_fraction, 3, gas.count) - times / gas.count
    return float(lacking.mean()) * gas.diameter**2 / unit


def mutual_diffusion(run: Run) -> Expected | None:
    """Compute the mutual diffusion coefficient in Enskog's first approximation, for the engine's equation."""
    kinds, eta, d = run.scene.species, run.scene.packing_fraction, run.dimension
    if not all(kind.alike for kind in kinds) or eta > theory.HIGHEST_PACKING_FRACTION[d]:
        return None
    equation, contact = equation_of(run), None
    diameters, counts = [2.0 * kind.radius for kind in kinds], [kind.count for kind in kinds]
    if equation == BOLTZMANN:
        contact = np.ones((2, 2))
    elif equation == ENSKOG:
        densities = np.array(counts) / run.scene.container.volume
        contact = contact_values(densities, 0.5 * np.array(diameters), d)
    masses = [kind.mass for kind in kinds]
    value = theory.enskog_mutual_diffusion(
        eta, d, diameters, counts, temperature=run.temperature, masses=masses, contact=contact
    )
    source = SOURCES[equation]
    return Expected(value, math.nan, f"{source}, first approximation")


def _transport(
    run: Run, temperature: float, coefficient: Callable[[Gas, str], float], kind: str = ""
) -> Expected | None:
    """Compute a transport coefficient from fluctuations of N particles at fixed energy. In a dilute gas of N
    particles the coefficients are smaller than in an infinite gas. `theory.transport_finite_size_factor`
    gives this factor to first order in 1/N for some kinds of coefficients. Its square is the uncertainty;
    without a factor, 1/N is. There is no theory for fewer than `LEAST_OF_NUMBER` particles.
    """
    gas, equation = run.fluid, equation_of(run)
    if gas is None or not temperature > 0.0 or gas.count < LEAST_OF_NUMBER or not is_mixed(run):
        return None
    value = coefficient(replace(gas, temperature=temperature), equation)
    if not math.isfinite(value):
        return None
    if equation == EXACT:
        measured = coefficient is bulk.shear_viscosity and gas.dimension == 3
        error = VISCOSITY_RATIO_UNCERTAINTY * value if measured else math.nan
        source = f"Enskog{', and the ratio measured in a dense gas' if measured else ''}"
        return Expected(value, error, source)
    error = value / gas.count
    if kind:
        factor = theory.transport_finite_size_factor(gas.count, gas.dimension, kind)
        value, error = value * factor, value * (1.0 - factor) ** 2
    return Expected(value, error, f"{SOURCES[equation]}, {OF_NUMBER}")


def bulk_viscosity(run: Run, temperature: float) -> Expected | None:
    """Compute the expected bulk viscosity from fluctuations; for the Boltzmann equation that of the cells."""
    expected, engine = _transport(run, temperature, bulk.bulk_viscosity), engine_of(run)
    if expected is None or engine is None or engine.equation != BOLTZMANN:
        return expected
    added = engine.added_bulk_viscosity(run.scene)
    return Expected(expected.value + added, 0.0, f"{expected.source}, transfer within cells")


def thermal_conductivity(run: Run, temperature: float) -> Expected | None:
    """Compute the expected conductivity from fluctuations; Chapman and Enskog's for a mixture of points."""
    mixture = run.mixture
    if run.scene.alike or mixture is None or not temperature > 0.0:
        return _transport(run, temperature, bulk.thermal_conductivity, "conductivity")
    if equation_of(run) != BOLTZMANN or mixture.dimension == 2 or not is_mixed(run):
        return None
    value = dilute_mixture_conductivity(mixture.diameters, mixture.counts, temperature, masses=mixture.masses)
    return Expected(value, math.nan, f"{SOURCES[BOLTZMANN]}, first approximation")


def shear_viscosity(run: Run, temperature: float) -> Expected | None:
    """Compute the expected shear viscosity from fluctuations, or the response of a sheared gas."""
    if run.scene.shear_rate is None:
        return _transport(run, temperature, bulk.shear_viscosity, "viscosity")
    gas, equation = replace(run.scene, faces={}).gas, equation_of(run)
    if gas is None or gas.packing_fraction > theory.HIGHEST_PACKING_FRACTION[gas.dimension]:
        return None
    value = float(bulk.shear_viscosity(replace(gas, temperature=temperature), equation))
    source = SOURCES[equation]
    return Expected(value, math.nan, f"{source}, of a small shear rate")
