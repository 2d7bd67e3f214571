"""What the time-stepped engine can model, and with what settings."""

from __future__ import annotations

import math
import warnings
from typing import TYPE_CHECKING

import numpy as np

from gaspart.engines.common import face_energy, law_for_kernel, surfaces_for_kernel
from gaspart.errors import SceneError, SimulationError
from gaspart.scene import Scene
from gaspart.state import State

if TYPE_CHECKING:
    from gaspart.engines.layout import Law
    from gaspart.engines.step_rules import Rules
    from gaspart.engines.time_stepped import TimeStepped

_GIANTS = 16  # at most so many bodies are tested against all others
_GIANT = 2.0  # radii of the next smaller body that make one of them
_SINGLE = 1e9  # the largest length or speed in float32, whose squares are multiplied with each other
_RESOLVED = 1e5  # diameters in the longest side, at most: float32 then tells contacts to a hundredth
MOST_BODIES = 2**28
"""An entry of the neighbour list tells two slots and eight marks in 64 bits (`step_list`)."""

MISSED, MISSED_MOST = 0.01, 0.1
"""The part of all contacts that a step may overlook before the engine warns, and refuses."""
CROWDED, CROWDED_MOST = {True: 2.5, False: 0.5}, {True: 5.0, False: 1.0}
"""Contacts of a body in a step, with several passes or with one, before the engine warns, and refuses. Up to
the first the pressure is right to about 1 % (measured: docs/time-stepped.md)."""

LATE_MOST, PASSED_MOST, FEW = 0.25, 0.01, 2
"""The part of all contacts that may be found a step too late; and with bodies half-way through each other by
then; so few are not judged. In gases, up to a step of which the engine warns, they are 0.05 and 0.004."""


def giants_of(state: State) -> np.ndarray:
    """(N,) which bodies are too large for the partition: a few, much larger than all the others."""
    order = np.argsort(state.radii, kind="stable")
    sizes = state.radii[order]
    giants = np.zeros(state.count, dtype=bool)
    for few in range(1, min(_GIANTS, state.count - 1) + 1):
        if sizes[-few] > _GIANT * sizes[-few - 1]:
            giants[order[-few:]] = True
    return giants


def check_scene(scene: Scene, state: State, giants: np.ndarray) -> None:
    """Raise SceneError for what this engine does not model."""
    if state.count >= MOST_BODIES:
        raise SceneError(
            "count", state.count, f"the time-stepped engine knows {MOST_BODIES - 1} bodies at most"
        )
    law, fixed = scene.restitution, np.isinf(state.masses).any()
    falls, none = scene.gravity is not None, "this one knows none"
    for key, value, what in (
        ("restitution", law if law and law.normal < 1.0 and falls else None, "with gravity, " + none),
        ("walls", scene.walls or None, none),
        ("fixed", True if fixed and falls else None, "this one knows no fixed bodies under gravity"),
    ):
        if value is not None:
            raise SceneError(key, value, f'needs the "event" engine; {what}')
    reach = 2.0 * state.radii.max(initial=0.0)
    if giants.any():
        reach = state.radii[giants].min() + state.radii.max()
    for length, periodic in zip(scene.container.lengths, scene.container.periodic, strict=True):
        if periodic and length < reach:
            rule = "the time-stepped engine needs periodic sides of two largest diameters"
            raise SceneError("lengths", scene.container.lengths, rule)


def rules_for(
    engine: TimeStepped, scene: Scene, state: State, seed: int | tuple[int, ...], unit_mass: float
) -> tuple[Rules | None, Law | None]:
    """The kernels' `Rules` and `Law` of a scene whose faces or bodies know more than momenta, in units of
    `unit_mass`; None, None of any other."""
    if not needs_rules(scene):
        return None, None
    from gaspart.engines import layout, step_rules

    surfaces = surfaces_for_kernel(scene, state, seed, unit_mass)
    radius = 0.0 if scene.centres_to_walls else state.radii.max(initial=0.0)
    inset = np.where(np.repeat(scene.container.periodic, 2), 0.0, radius + surfaces.width).reshape(-1, 2)
    free = np.stack([inset[:, 0], np.array(scene.container.lengths) - inset[:, 1]], axis=1)
    gravity = None
    if scene.gravity is not None:
        gravity = layout.Gravity(scene.gravity, np.isinf(state.masses), 0.0, None)
    faces = 2 * scene.dimension
    rules = step_rules.Rules(
        np.zeros((state.count, 8)), surfaces, gravity,
        layout.zero_counters(faces),
        free.astype(engine.precision),
        holds=any(face.kind != "thermal" for face in scene.faces.values()),
        heat=np.zeros((faces, 2), dtype=np.int64),
    )  # fmt: skip
    return rules, law_for_kernel(scene, state)


def changing(rules: Rules | None, law: Law | None) -> dict[str, np.ndarray]:
    """The arrays of rules and law that a run changes, by name."""
    arrays = {}
    if rules:
        arrays = {key: getattr(rules.surfaces, key) for key in ("place", "held", "draws")}
        arrays["heat"] = rules.heat
    if law:
        arrays["spins"] = law.spins
        if law.vibrations is not None:
            arrays["vibrations"] = law.vibrations
    return arrays


def needs_rules(scene: Scene) -> bool:
    """Whether faces or bodies of a scene know more than momenta."""
    return bool(scene.faces) or scene.rough or scene.vibrates


def check_precision(engine: TimeStepped, scene: Scene, state: State) -> None:
    """Raise SceneError for steps in which bodies move by less than their places are rounded by; and, in
    float32, for lengths and speeds whose squares it cannot hold, and bodies so small in their container that
    it cannot tell where they touch."""
    longest, speeds = max(scene.container.lengths), np.sqrt((state.velocities**2).sum(axis=1))
    typical, fastest = math.sqrt(float((speeds**2).mean())) if state.count else 0.0, speeds.max(initial=0.0)
    if 0.0 < typical * engine.time_step < 0.5 * np.finfo(engine.precision).eps * longest:
        rule = f"moves bodies by less than {engine.precision} can tell in a length of {longest:g}"
        raise SceneError("time_step", engine.time_step, rule)
    if engine.precision != "float32" or not state.count:
        return
    sizes = {"lengths": longest, "radius": scene.smallest_radius, "speed": fastest, "speed (rms)": typical}
    for key, value in sizes.items():
        if value and not 1.0 / _SINGLE <= value <= _SINGLE:
            rule = f"float32 needs lengths and speeds of {1 / _SINGLE:g} to {_SINGLE:g}; take float64"
            raise SceneError(key, float(value), rule)
    if 2.0 * scene.smallest_radius * _RESOLVED < longest:
        rule = f"float32 cannot tell where bodies of this size touch in a length of {longest:g}; take float64"
        raise SceneError("radius", scene.smallest_radius, rule)


def missed_contacts(time_step: float, several: bool, state: State) -> float:
    """The part of all contacts that a step overlooks: pairs that touch and part again within it.

    (2/3) (v_th dt / sigma)^2 of a dilute gas of spheres, 1/4 instead of 2/3 for discs, v_th = sqrt(kT/m);
    four times that if only growing overlaps are resolved (not `several` passes). From the flux of pairs
    through chords that they cross within a step. v_th is that of each species now; the mean over the pairs
    that collide.
    """
    square, radius, number = [], [], []
    for kind in np.unique(state.species):
        of = state.species == kind
        square.append((state.velocities[of] ** 2).mean())
        radius.append(state.radii[of].mean())
        number.append(of.sum())
    square, radius, number = (np.array(values, dtype=float) for values in (square, radius, number))
    sigma = radius[:, None] + radius
    relative = 0.5 * (square[:, None] + square)
    pairs = number[:, None] * (number - np.eye(len(number)))
    rate = np.maximum(0.0, pairs) * sigma ** (state.dimension - 1) * np.sqrt(relative)
    if not rate.sum() > 0.0:
        return 0.0
    missed = relative * (time_step / sigma) ** 2
    factor = {2: 1.0 / 4.0, 3: 2.0 / 3.0}[state.dimension] * (1.0 if several else 4.0)
    return float(factor * (rate * missed).sum() / rate.sum())


def check_step(engine: TimeStepped, state: State) -> None:
    """Raise SceneError for a step with which the engine would be wrong by much, warn of one that costs
    percents, and name the step that would do."""
    if state.count < 2:
        return
    several = engine.passes > 1
    missed = missed_contacts(engine.time_step, several, state)
    met = contacts_per_step(engine.time_step, state)
    worst = max(math.sqrt(missed / MISSED), met / CROWDED[several])
    if worst <= 1.0:
        return
    rule = (
        f"misses {100 * missed:.2g} % of all contacts (fit is {100 * MISSED:g} %), and a body has {met:.2g} "
        f"in a step (fit is {CROWDED[several]:g}); a step of {engine.time_step / worst:.2g} would do"
    )
    if missed > MISSED_MOST or met > CROWDED_MOST[several]:
        raise SceneError("time_step", engine.time_step, rule)
    warnings.warn(f"gaspart: time_step = {engine.time_step:g} {rule}", stacklevel=4)


def check_late(engine: TimeStepped, time: float, met: int, late: int, passed: int) -> None:
    """Raise SimulationError if contacts are found a step too late, or bodies pass through each other: speeds
    have come up, or gaps are so narrow, that the step is too long."""
    most = [max(FEW, part * met) for part in (LATE_MOST, PASSED_MOST)]
    if engine.passes > 1 and (late > most[0] or passed > most[1]):
        raise SimulationError(
            f"at time {time:g} {late} of {met} contacts were found a step too late, {passed} of them"
            f" with bodies half-way through each other: a step of {engine.time_step:g} is too long"
        )


def contacts_per_step(time_step: float, state: State) -> float:
    """How often a body meets another in a step: Enskog's rate for equal bodies of the same packing fraction,
    with the contact value of Carnahan & Starling (1969), of Henderson (1975) for discs."""
    spheres = state.dimension == 3
    ball = (4.0 / 3.0 * math.pi if spheres else math.pi) * float((state.radii**state.dimension).mean())
    density = state.count / float(state.lengths.prod())
    eta = min(density * ball, 0.7)  # higher only where a face stops centres
    contact = (1.0 - 0.5 * eta) / (1.0 - eta) ** 3 if spheres else (1.0 - 0.4375 * eta) / (1.0 - eta) ** 2
    diameter = 2.0 * (ball / (4.0 / 3.0 * math.pi if spheres else math.pi)) ** (1.0 / state.dimension)
    thermal = math.sqrt(math.pi * float((state.velocities**2).mean()))
    around = 4.0 * diameter**2 if spheres else 2.0 * diameter
    return density * around * contact * thermal * time_step


def largest_terms(scene: Scene, state: State, unit_mass: float) -> tuple[float, float]:
    """The momentum and the energy that few bodies will exceed, each a power of two in units of
    `unit_mass`: what walls take is summed in parts of these."""
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
