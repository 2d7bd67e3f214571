"""What the time-stepped engine's kernels work on: particles, model and tally."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gaspart.engines.arrays import (
    contact_law,
    face_energy,
    internal_arrays,
    scaled_masses,
    special_faces,
)
from gaspart.kernels.model import Gravity, Model, Space, empty_tally, flight_dtype
from gaspart.kernels.step.boundaries import Rules
from gaspart.kernels.step.model import StepModel, StepParticles, StepTally
from gaspart.kernels.step.simd import roomy
from gaspart.scene.scene import Scene
from gaspart.state.state import State

if TYPE_CHECKING:
    from gaspart.engines.step.settings import TimeStepped


def empty_particles(engine: TimeStepped, scene: Scene, state: State, ordinary: int) -> StepParticles:
    """Room for the particles, of which so many are `ordinary`, and their masses; with no list made yet."""
    real = np.dtype(engine.precision).type
    _, masses = masses_of(scene, state)
    shape = (state.dimension, state.count)
    return StepParticles(
        positions=roomy(shape, real),
        velocities=np.empty(shape, real),
        images=np.empty(shape, np.int32),
        radii=roomy((state.count,), real),
        index=np.empty(state.count, np.uint32),
        masses=masses.astype(real),
        last_pass=roomy((state.count,), np.uint32),
        bounds=np.array([0.0, np.inf]),
        ordinary=ordinary,
    )


def masses_of(scene: Scene, state: State) -> tuple[float, np.ndarray]:
    """The unit of mass, and the masses (N,) in it."""
    if needs_rules(scene):
        return 1.0, state.masses
    unit, masses = scaled_masses(state.masses)
    return unit, np.ones(state.count) if masses is None else masses


def model_for(
    engine: TimeStepped, scene: Scene, state: State, seed: int | tuple[int, ...], radii: np.ndarray
) -> StepModel:
    """What is simulated. radii: of the ordinary particles; `seed` is that of thermal walls."""
    real = np.dtype(engine.precision).type
    lengths, margin = scene.container.lengths, real(not scene.centres_to_walls)
    space = Space(tuple(real(length) for length in lengths), scene.container.periodic, margin)
    normal = 1.0 if scene.restitution is None else scene.restitution.normal
    rules = rules_for(engine, scene, state, seed, space)
    return StepModel(
        space,
        normal=real(normal),
        impulse_share=real(0.5 * (1.0 + normal)),
        inset=real(margin * real(radii.max(initial=0.0))),
        gravity=None if scene.gravity is None else tuple(real(g) for g in scene.gravity),
        rules=rules,
        law=rules.model.law if rules else None,
    )


def step_tally(faces: int, threads: int, largest: tuple[float, float]) -> StepTally:
    """A tally at zero, for so many faces; largest: see `largest_terms`."""
    return StepTally(
        counts=np.zeros(8, dtype=np.int64),
        sums=np.zeros((2, 2)),
        extremes=np.zeros(2),
        wall_hits=np.zeros((threads, faces), dtype=np.int64),
        wall_impulse=np.zeros((threads, faces, 2), dtype=np.int64),
        wall_loss=np.zeros((threads, 2), dtype=np.int64),
        momentum=largest[0],
        energy=largest[1],
    )


def rules_for(
    engine: TimeStepped, scene: Scene, state: State, seed: int | tuple[int, ...], space: Space
) -> Rules | None:
    """The kernels' `Rules` of a scene with faces or contacts that change more than momenta; None for any
    other. space: that of the step engine's kernels."""
    if not needs_rules(scene):
        return None
    fixed = np.isinf(state.masses)
    faces = special_faces(scene, state, seed, unit_mass=1.0)
    model = Model(
        space=space,
        masses=state.masses.astype(engine.precision),
        gravity=None if scene.gravity is None else Gravity(scene.gravity, fixed, 0.0, None),
        law=contact_law(scene, state),
        faces=faces,
        walls=None,
        oversized=None,
    )
    radius = 0.0 if scene.centres_to_walls else state.radii.max(initial=0.0)
    inset = np.where(np.repeat(scene.container.periodic, 2), 0.0, radius + faces.width).reshape(-1, 2)
    free = np.stack([inset[:, 0], np.array(scene.container.lengths) - inset[:, 1]], axis=1)
    walls = 2 * scene.dimension
    return Rules(
        np.zeros(state.count, flight_dtype(scene.dimension)),
        model,
        empty_tally(walls),
        free.astype(engine.precision),
        holds=any(face.kind != "thermal" for face in scene.faces.values()),
        heat=np.zeros((walls, 2), dtype=np.int64),
    )


def changing(model: StepModel) -> dict[str, np.ndarray]:
    """The arrays of a model's rules and law that a run changes, by name."""
    if model.rules is None:
        return internal_arrays(model.law, None)
    return {**internal_arrays(model.law, model.rules.model.faces), "heat": model.rules.heat}


def needs_rules(scene: Scene) -> bool:
    """Whether faces or contacts of a scene change more than momenta."""
    return bool(scene.faces) or scene.rough or scene.vibrates


def largest_terms(scene: Scene, state: State, unit_mass: float) -> tuple[float, float]:
    """The momentum and the energy that few particles will exceed, each a power of two in units of
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
