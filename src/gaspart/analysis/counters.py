"""Observables from the counters of a run: force and pressure on walls, and collision rate."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from gaspart.analysis import series
from gaspart.analysis.expected.equilibrium import describe
from gaspart.analysis.flow import accessible_lengths, face_areas
from gaspart.analysis.impulses import (
    engine_class,
    estimator,
    group_count,
    knows_energies,
    subtract_controls,
    usual_tally,
    wall_controls,
)
from gaspart.analysis.observable import Observable, observable, scalar, with_freedom
from gaspart.analysis.observables import name_of, require_defined
from gaspart.analysis.run import Run, Source, open_run, require_collisions
from gaspart.analysis.statistics import KNOWN_FREEDOM, means_of
from gaspart.errors import SceneError
from gaspart.trajectory.amber import face_names

_BLOCKS = 16


def compressibility_factor(source: Source, start: float | None = None) -> Observable:
    """Measure Z = PV/(N k_B T) of a periodic scene by the virial theorem.

    Z = 1 + sum |dr . dp| / (d N k_B T t), summed over the collisions in the time t. In a collision the
    centres are separated by dr, and the momentum dp is exchanged. The temperature is k_B T = 2 E / (d (N -
    1)), with the kinetic energy E relative to the centre of mass.

    Returns
    -------
    Observable
        The compressibility factor Z, dimensionless. The theoretical value is for the fluid phase and includes
        the first-order correction in 1/N. For mixtures the theoretical value is an approximation without an
        uncertainty.

    Raises
    ------
    SceneError
        If the scene has walls, fixed particles or contacts that lose energy; if there are too few frames; or
        if no collision occurs.
    """
    with open_run(source, start) as run:
        require_defined("Z", run.scene)
        require_collisions(run)
        return scalar("compressibility_factor", series.compressibility(run), run.time, **describe("Z", run))


def wall_pressure(source: Source, start: float | None = None) -> Observable:
    """Measure the pressure on each face of the container that is a wall.

    The pressure is a sum over particle sizes a of F_a / A_a. F_a is the force of particles of this size, and
    A_a is the area of the face that their centres can reach. Areas covered by fixed particles and interior
    walls are excluded (`gaspart.scene.accessible`). If faces move, the instantaneous area is used. By the
    contact theorem, this pressure is k_B T times the density at contact, summed over sizes. In an ideal gas
    the pressure is n k_B T, where n is the density in the accessible volume. Particles that never touch the
    face do not contribute. On the faces across the axis of a loaded piston, the force is divided by the
    cross-section of the container, because the load is defined with this area. The mean pressure is then
    equal to the load. The force on a face (`wall_force`) does not depend on the definition of an area.

    A contact of a particle at rest is not an event. Gravity gives such a particle momentum that no event
    removes. If particles are at rest in two successive frames, this momentum is added to the momentum that
    the floor receives. If the run has stored impulses along an axis, their known fluctuations are subtracted
    from the pressures on the faces across this axis (`gaspart.analysis.impulses`). The attribute `estimator`
    then names this method.

    Returns
    -------
    Observable
        Pressure (face,) in [energy / length^d], with standard errors. An error is NaN if the face was hit in
        fewer than three of the 16 blocks of the run. Theory exists for equal particles
        between two hard walls at a fixed distance (`gaspart.theory.wall_pressure`). If particles come to rest
        under gravity, the pressure on side walls is NaN, and so is the pressure on the floor if rough
        particles or thermal side walls exchange momentum along gravity. For particles of several sizes it is
        also NaN on faces whose accessible area changes as other faces move.

    Raises
    ------
    SceneError
        If the scene has no walls; if there are too few frames; if particles rest at positions where obstacles
        may support them; or if there are particles of several sizes and the file does not contain the
        momentum per accessible area.
    """
    with _open_walls(source, start, "pressure") as (run, ends):
        about = describe("pressure", run, accessible_lengths(run, run.time[:1])[0])
        return _of_faces("wall_pressure", run, ends, about)


def wall_force(source: Source, start: float | None = None) -> Observable:
    """Measure the force on each face of the container that is a wall.

    The force is the momentum given to the face divided by the time. Unlike the pressure (`wall_pressure`),
    the force does not depend on an area.

    Returns
    -------
    Observable
        Outward normal force (face,), in [energy / length], with standard errors. If particles come to rest
        under gravity, some forces are NaN (`wall_pressure`).

    Raises
    ------
    SceneError
        If the scene has no walls; if there are too few frames; or if particles rest at positions where
        obstacles may support them.
    """
    with _open_walls(source, start, "force") as (run, ends):
        return _of_faces("wall_force", run, ends, describe("force", run))


@contextmanager
def _open_walls(source: Source, start: float | None, name: str) -> Iterator[tuple[Run, np.ndarray]]:
    """Open a run, and find the frames (K + 1,) that bound its K blocks; SceneError if `name` is undefined."""
    with open_run(source, start, sheared=True, varying=True) as run:
        require_defined(name, run.scene)
        blocks = min(_BLOCKS, len(run.time) - 1)
        if blocks < 4:
            raise SceneError("frames", len(run.time), "an error needs 5 or more")
        yield run, np.linspace(0, len(run.time) - 1, blocks + 1).astype(int)


def _of_faces(function: str, run: Run, ends: np.ndarray, about: dict[str, Any]) -> Observable:
    """Build the result of the function named `function` from blocks of a run."""
    name = name_of(function)
    faces, samples = on_walls(run, ends, name)
    freedoms = np.full(len(faces), len(samples) - 1.0)
    improved, time = controlled_on_walls(run, name), np.diff(run.time)
    for index, (_, regressors, each) in improved.items():
        samples[:, index] = series.over(each * time, ends) / series.over(time, ends)
        freedoms[index] -= regressors
    values, errors = means_of(samples - samples[0])  # no rounding error at rest
    if run.frame("velocities", 0).any():  # few hits scatter by chance as little as many
        hit = (samples != 0.0).sum(axis=0)
        errors = np.where(hit > KNOWN_FREEDOM, errors, np.nan)
    along = {"face": (faces, {"long_name": "face of the container"})}
    result = observable(function, along, values + samples[0], errors, **about)
    serves = knows_energies(engine_class(run), run.scene)
    tally = usual_tally(str(faces[-1])[0]) if serves else None
    of = "wall impulses", "wall impulses, with the known mean of the energy along an axis"
    result.attrs |= estimator(run, *of, bool(improved), tally)
    return with_freedom(result, freedoms) if improved else result


def controlled_on_walls(run: Run, name: str) -> dict[int, tuple[str, int, np.ndarray]]:
    """Compute pressures or forces on walls with control variates from stored impulses."""
    faces, each = on_walls(run, np.arange(len(run.time)), name)
    groups, by_face = group_count(run) if run.has_states else 0, {}
    for index, face in enumerate(map(str, faces)) if groups else ():
        controls = wall_controls(run, "xyz".index(face[0]))
        if controls is not None:
            improved = subtract_controls(each[:, index], controls, groups)
            by_face[index] = face, controls.shape[1], improved
    return by_face


def on_walls(run: Run, ends: np.ndarray, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Compute the mean pressure or force on each wall between given frames."""
    require_defined(name, run.scene)
    time, walls = np.diff(run.time)[:, None], np.repeat(~run.periodic, 2)
    impulses, resting = series.over(series.face_impulses(run), ends), _rest_on_floors(run, ends)
    if name == "force":
        totals = impulses + resting
    elif run.scene.has_unequal_areas:  # the sizes of resting particles are unknown
        totals = series.over(series.face_pressures(run) * time, ends)
        totals += np.where((resting == 0.0).all(axis=0), 0.0, np.nan)
    else:
        totals = series.over(series.face_pressures(run) * time, ends)
        totals += resting * series.over(time / face_areas(run), ends) / series.over(time, ends)
    return np.array(face_names(run.dimension))[walls], (totals / series.over(time, ends))[:, walls]


def _rest_on_floors(run: Run, ends: np.ndarray) -> np.ndarray:
    """Compute the momentum (K, 2d) that particles at rest give to each face. The K intervals lie between the
    frames `ends` (K + 1,). A particle at rest touches without events. If no face exerts a force along itself,
    the momentum of a floor follows from the balance

        change of the momentum = momentum from gravity + impulses of the lower face - impulses of the upper
        face.

    Otherwise it is NaN. For a ceiling the momentum is 0, and for side walls it is NaN. Without particles at
    rest, all values are 0. Raises SceneError if particles rest at positions where something other than a face
    may support them.
    """
    carried, scene = np.zeros((len(ends) - 1, 2 * run.dimension)), run.scene
    if not run.has_gravity or (run.is_subset and not run.dissipates):
        return carried
    if scene.walls or not run.moving.all():
        refuse_rest(run, "obstacles may carry particles at rest, whose contacts give no impulse")
        return carried
    weight = run.masses.sum() * np.where(run.periodic, 0.0, np.array(scene.gravity))
    if not weight.any() or not count_at_rest(run):  # a force along walls exerts no pressure
        return carried
    velocities = run.vectors("velocities")[ends].values.astype(float)
    momentum = np.einsum("tnd,n->td", velocities, run.masses)
    gain = weight * np.diff(run.time[ends])[:, None]
    impulse = series.over(series.face_impulses(run), ends)
    missing = np.diff(momentum, axis=0) - gain - impulse[:, ::2] + impulse[:, 1::2]
    carried[:, np.repeat(weight == 0.0, 2)] = np.nan
    for axis in np.flatnonzero(weight):
        floor = 2 * axis + (weight[axis] > 0.0)
        is_known = not scene.dragged_axes[axis]
        carried[:, floor] = -np.sign(weight[axis]) * missing[:, axis] if is_known else np.nan
    return carried


def count_at_rest(run: Run) -> int:
    """Count the particles whose velocity along gravity is 0 in two successive frames; few frames without
    loss.
    """
    along = np.flatnonzero(run.scene.gravity or ())
    moving = np.flatnonzero(run.moving)
    was = is_at_rest = np.zeros(len(moving), dtype=bool)
    for velocities in run.blocks("velocities", slice(None if run.dissipates else 2)):
        still = (velocities[:, moving][..., along] == 0.0).any(axis=2)
        still = np.concatenate([was[None], still])
        is_at_rest = is_at_rest | (still[1:] & still[:-1]).any(axis=0)
        was = still[-1]
    return int(is_at_rest.sum())


def refuse_rest(run: Run, rule: str) -> None:
    """Raise SceneError if a particle rests under gravity."""
    resting = count_at_rest(run) if run.has_gravity else 0
    if resting:
        raise SceneError("particles at rest", resting, rule)


def collision_rate(source: Source, start: float | None = None) -> Observable:
    """Measure the collision rate: the mean number of collisions of a moving particle per time.

    The rate is (2 M + F) / (N t) for N moving particles in the time t. M is the number of collisions between
    two moving particles, and F is the number of collisions of moving particles with fixed particles.

    Returns
    -------
    Observable
        The rate, in [1/time]. The theoretical rate is exact in equilibrium, apart from the contact value. The
        contact value is computed from the equation of state of the fluid and corrected for the finite number
        of particles.

    Raises
    ------
    SceneError
        If there are too few frames, no collision occurs, or particles come to rest.
    """
    with open_run(source, start, sheared=True) as run:
        require_defined("collision_rate", run.scene)
        refuse_rest(run, "touch others without a collision, so that there is no rate")
        require_collisions(run)
        about = describe("collision_rate", run)
        return scalar("collision_rate", series.collision_rate(run), run.time, **about)
