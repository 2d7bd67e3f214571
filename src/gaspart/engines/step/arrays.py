"""Arrays of the time-stepped engine's kernels: particles, model and tally."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from gaspart.engines.features.faces import FacesPart, special_faces
from gaspart.engines.features.gravity import gravity_of
from gaspart.engines.features.law import LawPart, contact_law
from gaspart.engines.features.masses import scaled_masses
from gaspart.engines.features.part import Part, TallyPart
from gaspart.kernels.model import Model, Space, empty_tally, flight_dtype
from gaspart.kernels.step import model as layout
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
    """The model of a scene. radii: of the ordinary particles; `seed` is that of thermal walls."""
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


def step_tally(
    faces: int,
    threads: int,
    largest: tuple[float, float],
    asked: Iterable[TallyPart],
    areas: tuple[np.ndarray, np.ndarray] | None,
    fixed: bool,
) -> StepTally:
    """A tally at zero, for so many faces; largest: see `largest_terms`; asked: the parts of optional
    tallies; areas: the `inverse_areas` if they differ; fixed: whether there are fixed particles."""
    tally = StepTally(
        counts=np.zeros(layout.PASSED + 1, dtype=np.int64),
        sums=np.zeros((len(layout.SUMS), 2)),
        extremes=np.zeros(len(layout.EXTREMES)),
        wall_hits=np.zeros((threads, faces), dtype=np.int64),
        wall_impulse=np.zeros((threads, faces, 2), dtype=np.int64),
        wall_loss=np.zeros((threads, 2), dtype=np.int64),
        momentum=largest[0],
        energy=largest[1],
    )
    if fixed:
        tally = tally._replace(fixed=True)
    if areas is not None:
        inverse, size = areas
        per_area = np.zeros((threads, faces, 2, 2), dtype=np.int64)
        tally = tally._replace(per_area=per_area, share=inverse / inverse.max(), size=size)
    for part in asked:
        tally = tally._replace(**part.kernel)
    return tally


def rules_for(
    engine: TimeStepped, scene: Scene, state: State, seed: int | tuple[int, ...], space: Space
) -> Rules | None:
    """The kernels' `Rules` of a scene with faces or contacts that change more than momenta; None for any
    other. space: that of the step engine's kernels."""
    if not needs_rules(scene):
        return None
    special = special_faces(scene, state, seed, unit_mass=1.0)._replace(sliding=None)
    model = Model(
        space=space,
        masses=state.masses.astype(engine.precision),
        gravity=gravity_of(scene, state),
        law=contact_law(scene, state),
        faces=special,
        walls=None,
        oversized=None,
        shear=None,
        reservoirs=None,
    )
    radius = 0.0 if scene.centres_to_walls else state.radii.max(initial=0.0)
    inset = np.where(np.repeat(scene.container.periodic, 2), 0.0, radius + special.width).reshape(-1, 2)
    free = np.stack([inset[:, 0], np.array(scene.container.lengths) - inset[:, 1]], axis=1)
    walls = 2 * scene.dimension
    return Rules(
        np.zeros(state.count, flight_dtype(scene.dimension)),
        model,
        empty_tally(walls),
        free.astype(engine.precision),
        holds=bool(special.depth.any()) or special.sticky is not None,
        heat=np.zeros((walls, 2), dtype=np.int64),
    )


def parts_for(scene: Scene, rules: Rules | None) -> list[Part]:
    """The parts of a run of a scene with such rules; none without."""
    if rules is None:
        return []
    law, faces = rules.model.law, rules.model.faces
    heat = Part({}, sums={"heat": rules.heat[np.newaxis]})  # all threads have one
    parts = LawPart(law) if law else None, FacesPart(scene, faces, 1.0) if faces else None, heat
    return [part for part in parts if part]


def needs_rules(scene: Scene) -> bool:
    """Whether faces or contacts of a scene change more than momenta."""
    return bool(scene.faces) or scene.rough or scene.vibrates
