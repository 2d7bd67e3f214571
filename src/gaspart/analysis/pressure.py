"""Observables from the counters of a run: pressure and collision rate."""

from __future__ import annotations

import numpy as np

from gaspart.analysis import series
from gaspart.analysis.controls import controlled, group_count, wall_controls
from gaspart.analysis.estimators import engine_class, estimator, knows_energies
from gaspart.analysis.expected.described import described
from gaspart.analysis.impulses import USUAL_BINS
from gaspart.analysis.observable import Observable, observable, scalar
from gaspart.analysis.observables import require_defined
from gaspart.analysis.profiles import Means, with_freedom
from gaspart.analysis.room import mean_areas, touched
from gaspart.analysis.run import Run, Source, open_run, require_collisions
from gaspart.analysis.statistics import means_of
from gaspart.errors import SceneError
from gaspart.state.optional_tallies import ImpulseTally
from gaspart.trajectory.amber import face_names

_BLOCKS = 16
_SLIGHT = 1e-6  # of the weight: rounding of the momentum of single-precision velocities


def compressibility_factor(source: Source, start: float | None = None) -> Observable:
    """Z = P V / (N k_B T) of a periodic scene, dimensionless, by the virial theorem:

    Z = 1 + sum |dr . dp| / (d N k_B T t), with k_B T = 2 E / (d (N - 1)) about the centre of mass. source: a
    trajectory, by its path or open, or a simulation; start: the time from which frames count (by default a
    quarter of the run). Theory is that of the fluid, with the correction of first order in 1/N; of mixtures
    an approximation, without an uncertainty.

    Raises SceneError for walls, fixed particles, contacts that lose energy, too few frames, and no collision.
    """
    with open_run(source, start) as run:
        require_defined("Z", run.scene)
        require_collisions(run)
        return scalar("compressibility_factor", series.compressibility(run), run.time, **described("Z", run))


def wall_pressure(source: Source, start: float | None = None) -> Observable:
    """Pressure on each face of the container that is a wall, (face,): the momentum given to it per time and
    per area that centres can touch at that time, between faces where they are: beside a piston or a vibrating
    floor the area changes.

    Contacts of particles at rest are no events: they press a floor with what gravity gives the particles and
    no event takes (`_rest_on_floors`). Their thrust on side walls is not known: NaN while particles rest.

    With impulses that the run has kept along an axis, the pressures across it are freed from what fluctuates
    with them and is known exactly (`gaspart.analysis.controls`); the attribute `estimator` says so.

    source, start: as in `compressibility_factor`. Theory: that of equal particles between hard walls of one
    distance (`gaspart.theory.wall_pressure`). Raises SceneError without walls, for too few frames, and where
    particles rest in a scene with obstacles, which may carry them.
    """
    with open_run(source, start, sheared=True, varying=True) as run:
        require_defined("pressure", run.scene)
        blocks = min(_BLOCKS, len(run.time) - 1)
        if blocks < 4:
            raise SceneError("frames", len(run.time), "an error needs 5 or more")
        ends = np.linspace(0, len(run.time) - 1, blocks + 1).astype(int)
        faces, found = pressures_on_walls(run, ends)
        freedoms = np.full(len(faces), blocks - 1.0)
        improved = controlled_pressures(run)
        for place, (_, regressors, each) in improved.items():
            time = np.diff(run.time)
            found[:, place] = series.over(each * time, ends) / series.over(time, ends)
            freedoms[place] -= regressors
        values, errors = means_of(found - found[0])  # no error of rounding at rest
        result = observable(
            "wall_pressure",
            {"face": (faces, {"long_name": "face of the container"})},
            values + found[0],
            errors,
            **described("pressure", run, touched(run, run.time[:1])[0]),
        )
        serves = knows_energies(engine_class(run), run.scene)
        asked = ImpulseTally(str(faces[-1])[0], USUAL_BINS) if serves else None
        of = "wall impulses", "wall impulses, with the known mean of the energy along an axis"
        result.attrs |= estimator(run, *of, bool(improved), asked)
        return with_freedom(result, Means(values, errors, freedoms)) if improved else result


def controlled_pressures(run: Run) -> dict[int, tuple[str, int, np.ndarray]]:
    """The pressures on the walls of which the run has kept enough, by their place among all walls: the name
    of each, the number of controls, and the pressure in each interval (T - 1,)."""
    faces, each = pressures_on_walls(run, np.arange(len(run.time)))
    groups, found = group_count(run) if run.has_states else 0, {}
    for place, face in enumerate(map(str, faces)) if groups else ():
        controls = wall_controls(run, "xyz".index(face[0]))
        if controls is not None:
            improved = controlled(each[:, place], controls, groups)
            found[place] = face, controls.shape[1], improved
    return found


def pressures_on_walls(run: Run, ends: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Names (W,) of the faces that are walls, and the pressures on them (K, W) between the frames `ends`
    (K + 1,). Raises SceneError as `wall_pressure`."""
    require_defined("pressure", run.scene)
    d, time = run.dimension, np.diff(run.time)[:, None]
    pressed = np.abs(series.over(series.face_pressures(run) * time, ends))
    areas = np.repeat(mean_areas(run), 2, axis=1)
    resting = _rest_on_floors(run, ends) * series.over(time / areas, ends) / series.over(time, ends)
    chosen = np.repeat(~run.periodic, 2)
    pressures = (pressed + resting) / series.over(time, ends)
    return np.array(face_names(d))[chosen], pressures[:, chosen]


def _rest_on_floors(run: Run, ends: np.ndarray) -> np.ndarray:
    """(K, 2d) momentum that contacts at rest give each face between the frames `ends` (K + 1,).

    On a floor it is the difference of both sides in the balance

        change of the momentum = its gain by gravity + impulses of the lower face - those of the upper one.

    On a ceiling it is 0; on side walls 0, or NaN if that of a floor is more than a millionth of the weight.
    Raises SceneError if particles rest where something else than faces may carry them.
    """
    carried = np.zeros((len(ends) - 1, 2 * run.dimension))
    if not run.has_gravity or (run.is_subset and not run.dissipates):
        return carried
    if run.scene.walls or not run.moving.all():
        refuse_rest(run, "obstacles may carry particles at rest, whose contacts give no impulse")
        return carried
    momentum = np.einsum("tnd,n->td", run.velocities[ends], run.masses)
    weight = run.masses.sum() * np.where(run.periodic, 0.0, np.array(run.scene.gravity))
    if not weight.any():  # it drives a flow along walls, and presses nothing
        return carried
    gain = weight * np.diff(run.time[ends])[:, None]
    impulse = np.abs(np.diff(run.data["wall_impulse"].values[ends, : 2 * run.dimension], axis=0))
    missing = np.diff(momentum, axis=0) - gain - impulse[:, ::2] + impulse[:, 1::2]
    floors = [2 * axis + (weight[axis] > 0.0) for axis in np.flatnonzero(weight)]
    carried[:, floors] = (-np.sign(weight) * missing)[:, weight != 0.0]
    if np.abs(carried[:, floors]).max() > _SLIGHT * np.abs(gain).max():
        carried[:, np.repeat(weight == 0.0, 2)] = np.nan
    return carried


def refuse_rest(run: Run, rule: str) -> None:
    """Raise SceneError, with a rule, if a particle rests under gravity in a frame after the first."""
    if run.has_gravity:
        along = np.flatnonzero(run.scene.gravity or ())
        resting = (run.velocities[1:, run.moving][..., along] == 0.0).any(axis=2).any(axis=0).sum()
        if resting:
            raise SceneError("particles at rest", int(resting), rule)


def collision_rate(source: Source, start: float | None = None) -> Observable:
    """Collisions of one particle per time, 2 M / (N t) for M collisions of pairs; fixed particles do not
    count in N.

    source, start: as in `compressibility_factor`. Theory: exact in equilibrium, with the contact value of
    the fluid's equation of state, corrected for the number of particles. Raises SceneError for too few
    frames, without a collision, and if particles come to rest.
    """
    with open_run(source, start, sheared=True) as run:
        require_defined("collision_rate", run.scene)
        refuse_rest(run, "touch others without a collision, so that there is no rate")
        require_collisions(run)
        about = described("collision_rate", run)
        return scalar("collision_rate", series.collision_rate(run), run.time, **about)
