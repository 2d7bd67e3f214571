"""Limits of the scenes and settings that the time-stepped engine supports."""

from __future__ import annotations

import math
import warnings
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gaspart.errors import SceneError, SimulationError
from gaspart.scene.scene import Scene
from gaspart.scene.sizes import CLOSE_PACKING, ball_volume
from gaspart.state.state import State
from gaspart.theory.discretisation import HIGHEST, MISSED_CONTACTS, ONE_PASS, contact_values

if TYPE_CHECKING:
    from gaspart.engines.step.settings import StepSettings


_OVERSIZED = 16  # maximum number of oversized particles, which are tested against all others
_LARGER = 2.0  # minimum radius of an oversized particle, in radii of the next smaller particle
_SINGLE = 1e9  # largest length or speed in float32, because squares are multiplied with each other
_RESOLVED = 1e5  # diameters in the longest side, at most: float32 then resolves contacts to 1 %
MOST_PARTICLES = 2**28
"""Maximum number of particles. An entry of the neighbour list has two slots and eight marks in 64 bits.

See `kernels.step.neighbour_list`.
"""

NOTABLE = 0.05
"""Relative error of the density at walls above which a run states it."""
MISSED, MISSED_MOST = 0.01, 0.1
"""Fraction of missed contacts above which the engine warns, and above which it rejects the step."""
CONTACTS, CONTACTS_MOST = {True: 2.5, False: 0.5}, {True: 5.0, False: 1.0}
"""Contacts of a particle per step above which the engine warns, and above which it rejects the step.

The keys are True for several passes, and False for a single pass.

Below the first limit the pressure is correct to about 1 % (measured: docs/time-stepped.md).
"""

LATE_MOST, PASSED_MOST, FEW = 0.25, 0.01, 2
"""Largest allowed fractions of contacts that are found a step too late, and of contacts in which particles
are half-way through each other.

A number of FEW such contacts is always allowed. In gases, the fractions are 0.05 and 0.004 at the step above
which the engine warns.
"""

SAFE = 2.0
"""Maximum error of a pressure or a rate, divided by the fraction of missed contacts."""
DISORDER = {True: 0.012, False: 0.22}
"""Maximum error of a rate near close packing due to contacts in a wrong order, divided by the square of the
contacts of a particle in a step. The keys are True for several passes. In one pass it is the same at all
densities; in several it grows as the cube of the packing fraction (measured: docs/time-stepped.md).
"""
FREEZING = 0.49
"""Packing fraction of the most dilute crystal of spheres; discs need more."""
CRYSTAL = {2: 0.9, 3: 1.56}
"""Z - 1 - d / alpha of a crystal near close packing, alpha = V / V_c - 1, by dimension: Alder, Hoover &
Young, J. Chem. Phys. 49, 3688 (1968)."""
LATER = 0.6
"""Largest error of the density at walls, divided by the contacts of a particle in a step.

Half of the contacts in the step of a wall hit precede the hit, but are processed after it. At walls, contacts
are up to 1.2 times as frequent as in a gas of the mean density (measured in
a slit of 1.5 diameters: 0.49).
"""


def oversized_particles(state: State) -> np.ndarray:
    """Return a mask (N,) of the few particles that are much larger than all others."""
    order = np.argsort(state.radii, kind="stable")
    sizes = state.radii[order]
    oversized = np.zeros(state.count, dtype=bool)
    for few in range(1, min(_OVERSIZED, state.count - 1) + 1):
        if sizes[-few] > _LARGER * sizes[-few - 1]:
            oversized[order[-few:]] = True
    return oversized


def check_scene(scene: Scene, state: State, oversized: np.ndarray) -> None:
    """Raise SceneError if there are too many particles, or if the container is too short."""
    if state.count >= MOST_PARTICLES:
        raise SceneError(
            "count", state.count, f"the time-stepped engine takes {MOST_PARTICLES - 1} particles at most"
        )
    reach = 2.0 * state.radii.max(initial=0.0)
    if oversized.any():
        reach = state.radii[oversized].min() + state.radii.max()
    for length, periodic in zip(scene.container.lengths, scene.container.periodic, strict=True):
        if periodic and length < reach:
            rule = "the time-stepped engine needs periodic sides of two largest diameters"
            raise SceneError("lengths", scene.container.lengths, rule)


def check_precision(engine: StepSettings, scene: Scene, state: State) -> None:
    """Raise SceneError if the floating-point precision does not resolve steps or sizes. A step is rejected if
    particles move by less than the rounding error of their positions, or so far that the rounding error is as
    large as the container. In float32, lengths and speeds are rejected if their squares are out of range.
    Particles are rejected if the precision cannot resolve their contacts in the container.
    """
    longest, speeds = max(scene.container.lengths), np.sqrt((state.velocities**2).sum(axis=1))
    typical, fastest = math.sqrt(float((speeds**2).mean())) if state.count else 0.0, speeds.max(initial=0.0)
    moved, rounding = typical * engine.time_step, float(np.finfo(engine.precision).eps)
    if moved * rounding > longest:
        rule = f"moves particles so far that {engine.precision} does not resolve a length of {longest:g}"
        raise SceneError("time_step", engine.time_step, rule)
    if 0.0 < moved < 0.5 * rounding * longest:
        rule = f"moves particles by less than {engine.precision} resolves in a length of {longest:g}"
        raise SceneError("time_step", engine.time_step, rule)
    if engine.precision != "float32" or not state.count:
        return
    sizes = {"lengths": longest, "radius": scene.smallest_radius, "speed": fastest, "speed (rms)": typical}
    for key, value in sizes.items():
        if value and not 1.0 / _SINGLE <= value <= _SINGLE:
            rule = f"float32 needs lengths and speeds of {1 / _SINGLE:g} to {_SINGLE:g}; take float64"
            raise SceneError(key, float(value), rule)
    if 2.0 * scene.smallest_radius * _RESOLVED < longest:
        rule = f"float32 does not resolve contacts of this size in a length of {longest:g}; take float64"
        raise SceneError("radius", scene.smallest_radius, rule)


class Kinds(NamedTuple):
    """Kinds of moving particles: k_B T / m, radius and number of each kind, shape (S,)."""

    square: np.ndarray
    radius: np.ndarray
    number: np.ndarray


def _kinds_of(state: State) -> Kinds:
    """Return the species of a state at their present thermal speeds."""
    species = [state.species == kind for kind in np.unique(state.species)]
    squares = [(state.velocities[members] ** 2).mean() for members in species]
    radii, numbers = [state.radii[members].mean() for members in species], [m.sum() for m in species]
    return Kinds(*(np.array(column, dtype=float) for column in (squares, radii, numbers)))


def missed_contacts(time_step: float, several: bool, state: State) -> float:
    """Return the fraction of contacts that are missed because they begin and end within a step. The fraction
    is computed for a dilute gas (`MISSED_CONTACTS`) at the present thermal speed of each species. It depends
    on whether there are several passes. The result is the mean over all pairs of species, weighted by their
    collision rates.
    """
    return _missed_fraction(time_step, several, state.dimension, _kinds_of(state))


def bias(engine: StepSettings, scene: Scene, kind: str) -> float:
    """Bound the relative error of an observable due to missed contacts and contacts in a wrong order. The
    bound is for the initial temperature, or for the temperature of the hottest face if this is higher.
    Transfers to walls ("walls", "fluxes") have the additional error `at_walls`.
    """
    gas, d, volume = _kinds_in(scene), scene.dimension, scene.container.volume
    error = _rate_error(engine.time_step, engine.passes > 1, d, gas, volume)
    if kind in ("walls", "fluxes"):
        error += at_walls(scene) * _contacts(engine.time_step, d, gas, volume)
    return error


def rate_error(time_step: float, several: bool, state: State) -> float:
    """Bound the relative error of rates for a state; the bound is proportional to the square of the step."""
    return _rate_error(time_step, several, state.dimension, _kinds_of(state), float(state.lengths.prod()))


def _rate_error(time_step: float, several: bool, dimension: int, gas: Kinds, volume: float) -> float:
    missed = _missed_fraction(time_step, several, dimension, gas)
    met = _contacts(time_step, dimension, gas, volume)
    packing = _packing_fraction(dimension, gas, volume) / CLOSE_PACKING[dimension]
    crowding = min(1.0, packing) ** 3 if several else 1.0
    return SAFE * missed + DISORDER[several] * crowding * met**2


def wall_density_error(engine: StepSettings, scene: Scene) -> float:
    """Bound the relative error of the density within a few v dt of a wall; 0 without walls."""
    if not scene.walled_axes:
        return 0.0
    met = _contacts(engine.time_step, scene.dimension, _kinds_in(scene), scene.container.volume)
    return LATER * met


def at_walls(scene: Scene) -> float:
    """Return the error of transfers to walls, divided by the contacts of a particle in a step. Far from
    walls, momentum is balanced for any order of contacts. So the error is proportional to the fraction of the
    particles within a radius of a wall.
    """
    radius = scene.largest_moving_radius
    lower, upper = (np.array(ends) for ends in scene.reach(radius))
    widths = np.maximum(upper - lower, 2.0 * radius * np.finfo(float).eps)[list(scene.walled_axes)]
    return LATER * min(1.0, float((radius / widths).sum())) if radius > 0.0 else 0.0


def _kinds_in(scene: Scene) -> Kinds:
    """Return the moving kinds of a scene, at the temperature of the hottest face at least."""
    kinds, heat = scene.moving_kinds, max(scene.face_temperatures, default=0.0)
    squares = [max(kind.initial_temperature(scene.dimension), heat) / kind.mass for kind in kinds]
    columns = squares, [kind.radius for kind in kinds], [kind.count for kind in kinds]
    return Kinds(*(np.array(column, dtype=float) for column in columns))


def _missed_fraction(time_step: float, several: bool, dimension: int, gas: Kinds) -> float:
    """Return the fraction of missed contacts."""
    square, radius, number = gas
    sigma = radius[:, None] + radius
    relative = 0.5 * (square[:, None] + square)
    pairs = number[:, None] * (number - np.eye(len(number)))
    rate = np.maximum(0.0, pairs) * sigma ** (dimension - 1) * np.sqrt(relative)
    if not rate.sum() > 0.0:
        return 0.0
    missed = relative * (time_step / sigma) ** 2
    factor = MISSED_CONTACTS[dimension] * (1.0 if several else ONE_PASS)
    return float(factor * (rate * missed).sum() / rate.sum())


def check_step(engine: StepSettings, state: State) -> None:
    """Raise SceneError if the step causes large errors, with a better one; warn of a few percent."""
    if state.count < 2:
        return
    several = engine.passes > 1
    missed = missed_contacts(engine.time_step, several, state)
    met = contacts_per_step(engine.time_step, state)
    worst = max(math.sqrt(missed / MISSED), met / CONTACTS[several])
    if worst <= 1.0:
        return
    rule = (
        f"misses {100 * min(missed, 1.0):.2g} % of all contacts (fit is {100 * MISSED:g} %), and a particle "
        f"has {met:.2g} in a step (fit is {CONTACTS[several]:g}); "
        f"a step of {engine.time_step / worst:.2g} would do"
    )
    if missed > MISSED_MOST or met > CONTACTS_MOST[several]:
        raise SceneError("time_step", engine.time_step, rule)
    warnings.warn(f"gaspart: time_step = {engine.time_step:g} {rule}", stacklevel=4)


def check_late(engine: StepSettings, time: float, met: int, late: int, passed: int) -> None:
    """Raise SimulationError if too many contacts are found a step too late. SimulationError is also raised if
    particles pass through each other. In both cases the step is too long, because speeds are high or gaps are
    narrow.
    """
    most = [max(FEW, part * met) for part in (LATE_MOST, PASSED_MOST)]
    if engine.passes > 1 and (late > most[0] or passed > most[1]):
        raise SimulationError(
            f"at time {time:g} {late} of {met} contacts were found a step too late, {passed} of them"
            f" with particles half-way through each other: a step of {engine.time_step:g} is too long"
        )


def contacts_per_step(time_step: float, state: State) -> float:
    """Return the mean number of collisions of a particle in a step; see `_contacts`."""
    square = float((state.velocities**2).mean())
    gas = Kinds(np.full(state.count, square), state.radii, np.ones(state.count))
    return _contacts(time_step, state.dimension, gas, float(state.lengths.prod()))


def _packing_fraction(dimension: int, gas: Kinds, volume: float) -> float:
    return ball_volume(dimension) * float((gas.number * gas.radius**dimension).sum()) / volume


def _contacts(time_step: float, dimension: int, gas: Kinds, volume: float) -> float:
    """Return the mean collisions of a particle in a step, as for one size at the same packing fraction."""
    count = gas.number.sum()
    if count < 2.0:
        return 0.0
    eta = _packing_fraction(dimension, gas, volume)
    diameter = 2.0 * (eta * volume / count / ball_volume(dimension)) ** (1.0 / dimension)
    thermal = math.sqrt(math.pi * float((gas.number * gas.square).sum() / count))
    around = 4.0 * diameter**2 if dimension == 3 else 2.0 * diameter
    return float(count / volume * around * _contact_value(eta, dimension) * thermal * time_step)


def _contact_value(eta: float, dimension: int) -> float:
    """Return the larger contact value of the fluid and of a crystal, for particles of one size. The fluid's
    is by Carnahan & Starling (1969) for spheres, and by Henderson (1975) for discs. Above close packing,
    which needs several sizes or faces that stop centres, it is the fluid's at its highest.
    """
    ball = ball_volume(dimension, 0.5)
    fluid = float(contact_values(np.array([min(eta, HIGHEST) / ball]), np.array([0.5]), dimension)[0, 0])
    if not FREEZING < eta < CLOSE_PACKING[dimension]:
        return fluid
    alpha = CLOSE_PACKING[dimension] / eta - 1.0
    return max(fluid, (dimension / alpha + CRYSTAL[dimension]) / (2.0 ** (dimension - 1) * eta))
