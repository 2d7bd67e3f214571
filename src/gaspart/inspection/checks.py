"""Checks of a trajectory of hard particles. The result of each check is a single line."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.counters import compressibility_factor
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.fluxes import particle_numbers
from gaspart.analysis.pairs import pair_counts
from gaspart.analysis.statistics import correlated_mean
from gaspart.errors import SceneError
from gaspart.inspection.conserved import judge_conserved, judge_flights
from gaspart.inspection.energy import conserved_energy
from gaspart.inspection.frames import Frames, Rows, map_frames, read_in_blocks
from gaspart.inspection.statistics import (
    FIT_ERROR,
    SPEEDS,
    WIDTH,
    contact_values,
    decorrelated_frames,
    describe_motion,
    diffusion,
    expected_diffusion,
    first_relaxed_frame,
    groups_of,
    has_too_few_contacts,
    is_uneven,
    judge_speeds,
    why_not,
    why_not_speeds,
)
from gaspart.inspection.verdict import Check, compare_with_theory
from gaspart.scene.scene import Scene
from gaspart.state.boxes import deepest_overlap
from gaspart.state.initial import initial_state
from gaspart.trajectory.reading import open_trajectory
from gaspart.trajectory.recipe import Recipe, read_recipe

__all__ = ["Check", "judge", "judge_places"]

TOUCH = 1e-7
"""Maximum overlap, divided by the diameter, that is attributed to rounding. The limit is larger if the
numbers in the file have a coarser resolution.
"""
COARSEST = 0.1
"""Overlap, divided by the diameter, above which an overlap is never attributed to rounding, even in a file
with a coarse resolution.
"""
MOST_FRAMES = 200
"""Maximum number of evenly spaced frames that are tested for overlaps and contact values."""
_MANY = 100_000  # number of particles in these frames above which importing numba to count pairs saves time
_BINS = 2**20  # maximum bin width for counting pairs, as a fraction of the contact distance
_MARGIN = 1e-9  # possible rounding error of a distance between images, in diameters
_LEAST_FRAMES = 16
_PRESSURE, _DIFFUSION = "pressure Z", "diffusion coefficient D"


def judge(frames: Frames, tolerance: float | None = None, driven: bool = False) -> list[Check]:
    """Perform all checks, with a `tolerance` of overlaps in diameters; `driven`: energy may be exchanged."""
    checks = [*judge_places(frames, tolerance), *judge_conserved(frames, driven)]
    reason, acting = frames.no_identity, [check.name for check in checks if check.acts]
    if acting and not reason:  # more than elastic contacts: the equilibrium is unknown
        reason = f"something acts on the particles (see {' and '.join(acting)})"
    if reason:
        return [*checks, *(Check(name, None, reason) for name in (*SPEEDS, _PRESSURE, _DIFFUSION))]
    return [*checks, *judge_speeds(frames), _pressure(frames), _diffusion(frames)]


def judge_places(frames: Frames, tolerance: float | None = None) -> list[Check]:
    """Check positions for overlaps and for particles outside the container."""
    seen = np.unique(np.linspace(0, len(frames.positions) - 1, MOST_FRAMES).astype(int))
    return [_overlaps(frames, seen, tolerance), _inside(frames, tolerance)]


def _allowed_overlap(frames: Frames, tolerance: float | None) -> float:
    """Return the allowed overlap as a fraction of the smallest diameter."""
    diameter = 2.0 * float(frames.radii.min())
    coarse = min(max(TOUCH, 4.0 * frames.resolution / diameter), COARSEST)
    step = frames.engine.quantum if frames.engine else None
    if step and frames.velocities is not None:  # a pair that a step pushed together separates in later ones
        coarse = max(coarse, 2.0 * math.sqrt(float(frames.squares.largest.max())) * step / diameter)
    return coarse if tolerance is None else tolerance


def _overlaps(frames: Frames, seen: np.ndarray, tolerance: float | None) -> Check:
    """Check the deepest overlap of two particles, as a fraction of their contact distance."""
    if frames.sampled:
        return Check("overlaps", None, "contacts are sampled, so that particles may overlap")
    if frames.no_identity and frames.diameter is None and frames.radii_by_frame is None:
        return Check("overlaps", None, frames.no_identity)
    allowed = _allowed_overlap(frames, tolerance)
    if len(seen) * frames.count > _MANY:
        bounds = np.array([_overlap_bounds(frames.at(n)) for n in seen])
        if 0.0 < bounds[:, 1].max() <= allowed:
            text = f"the deepest is {bounds[:, 1].max():.2g} of a contact distance at most"
            return Check("overlaps", True, f"{text} (up to {allowed:.1g} allowed)")
        seen = seen[(bounds[:, 1] > 0.0) & (bounds[:, 1] >= bounds[:, 0].max())]
    deepest, where = 0.0, 0
    for n in seen:
        frame = frames.at(n)
        overlap = deepest_overlap(frame.positions[0], frame.radii, frame.lengths, frame.periodic)
        if overlap > deepest:
            deepest, where = overlap, int(n)
    text = (
        f"the deepest is {deepest:.2g} of a contact distance, in frame {where} (up to {allowed:.1g} allowed)"
    )
    return Check("overlaps", deepest <= allowed, text)


def _overlap_bounds(frame: Frames) -> tuple[float, float]:
    """Return bounds on the deepest overlap of equal particles, as a fraction of the contact distance. If
    there are no bounds, return (0, inf).
    """
    if frame.diameter is None or not np.isfinite(frame.positions).all():
        return 0.0, math.inf
    reach = frame.diameter * (1.0 + _MARGIN)
    sides = frame.lengths.copy()
    for k in np.flatnonzero(~np.array(frame.periodic)):
        x = frame.positions[..., k]
        if x.min(initial=0.0) < 0.0 or x.max(initial=0.0) > sides[k]:
            return 0.0, math.inf
        sides[k] += 2.0 * reach  # no pair is near across a wall
    if reach > 0.5 * float(sides.min()):
        return 0.0, math.inf
    bins = min(8 * frame.count, _BINS)
    counts = pair_counts(np.asarray(frame.positions), sides, bins, reach)
    if not counts.any():
        return 0.0, 0.0
    nearest = int(np.argmax(counts > 0))
    low, high = (1.0 - n * (1.0 + _MARGIN) / bins for n in (nearest + 1, nearest))
    return max(low - _MARGIN, 0.0), high + _MARGIN


def _inside(frames: Frames, tolerance: float | None) -> Check:
    """Check the largest distance of a centre outside the walls; periodic axes have no walls."""
    walls = ~np.array(frames.periodic)
    if not walls.any():
        return Check("container", None, "periodic, so that nothing can leave it")
    sides = frames.lengths[None] if frames.lengths_by_frame is None else frames.lengths_by_frame
    out, halfway = 0.0, True
    for n, frame in enumerate(frames.positions):
        positions, lengths = frame[:, walls], sides[n % len(sides), walls]
        beyond = np.maximum(-positions, positions - lengths)
        out = max(out, float(beyond.max(where=np.isfinite(positions), initial=0.0)))
        halfway = halfway and bool((np.abs(positions) <= 0.5 * lengths).all())
    out /= 2.0 * float(frames.radii.min())
    text = "all centres are inside" if out <= 0.0 else f"a centre is {out:.2g} diameters outside"
    if out > 0.0 and halfway:
        text += "; all are inside if 0 is the centre of the container: give --origin centre"
    return Check("container", out <= _allowed_overlap(frames, tolerance), text)


def _pressure(frames: Frames) -> Check:
    """Check Z against the equation of state, with a correction for the finite number of particles. Z is
    computed from collisions if the file counts them, otherwise from the pair distribution at contact. Two
    conditions select the frames that are used. Since the start, particles must have moved by the distance
    between neighbours, so that no lattice order remains (this order decays as exp(-k^2 <r^2> / 2d)). Between
    two frames, particles must have moved across the shells in which pairs are counted.
    """
    name = _PRESSURE
    if reason := _no_pressure(frames):
        return Check(name, None, reason)
    gas = frames.gas
    assert gas is not None, "see `_no_pressure`"
    eta, d = gas.packing_fraction, gas.dimension
    first = first_relaxed_frame(frames)
    if first is None:
        return Check(name, None, describe_motion(frames))
    chosen = np.array(decorrelated_frames(frames.paths(), WIDTH * gas.diameter, first))
    if len(chosen) < _LEAST_FRAMES:
        text = f"{len(chosen)} independent samples are too few for an error: it needs {_LEAST_FRAMES}"
        return Check(name, None, text)
    if is_uneven(frames, chosen):
        return Check(name, None, "the density is not uniform: not relaxed")
    if frames.counted is not None and frames.time is not None:
        return _by_collisions(frames.counted, float(frames.time[first]))
    chosen = chosen[np.unique(np.linspace(0, len(chosen) - 1, MOST_FRAMES).astype(int))]
    used = frames.parts(chosen)
    if has_too_few_contacts(used):
        return Check(name, None, f"pairs near contact are too few in {len(chosen)} independent samples")
    contact_value = correlated_mean(contact_values(used)).estimate
    first_order = 2.0 ** (d - 1) * eta
    try:
        side = float(np.min(frames.lengths)) / gas.diameter
        contact, error = theory.finite_contact_value(eta, d, gas.count, side)
    except ValueError as refusal:
        return Check(name, None, str(refusal))
    scale = first_order * (1.0 - 1.0 / gas.count)
    expected = 1.0 + scale * contact
    unsure = math.hypot(scale * error, first_order * FIT_ERROR * contact_value.value)
    basis = f"fluid, eta = {eta:.4g}; {len(chosen)} independent samples"
    return compare_with_theory(name, contact_value * first_order + 1.0, Estimate(expected, unsure), basis)


def _by_collisions(path: Path, start: float) -> Check:
    """Compare Z with theory, from the collisions of a gaspart run after the time `start`."""
    factor = compressibility_factor(path, start=start)
    if factor.theory is None:
        return Check(_PRESSURE, None, "there is no theory of it for this scene")
    unsure = float(factor[f"{factor.estimate.name}_theory_error"])
    measured = Estimate(float(factor.estimate), float(factor.error), float(factor.attrs["freedom"]))
    basis = f"{factor.attrs['source']}; by collisions"
    return compare_with_theory(_PRESSURE, measured, Estimate(float(factor.theory), unsure), basis)


def _no_pressure(frames: Frames) -> str | None:
    """Return the reason why the pressure cannot be checked, or None."""
    gas = frames.gas
    if not all(frames.periodic) or gas is None:
        return "needs equal particles in a periodic container, moved by elastic contacts alone"
    if frames.part:
        return "the file has some of the particles only"
    if frames.sampled:
        return "contacts are sampled: positions say nothing of it"
    if gas.packing_fraction > theory.HIGHEST_PACKING_FRACTION[gas.dimension]:
        return f"packing fraction {gas.packing_fraction:.3g} is beyond the fluid's equation of state"
    if frames.lengths.min() <= 4.0 * gas.diameter:
        return "the container is narrower than four diameters"
    if frames.count < _LEAST_FRAMES:
        return f"{frames.count} particles are too few"
    return None


def _diffusion(frames: Frames) -> Check:
    """Check D of spheres from their mean-squared displacement against theory."""
    name = _DIFFUSION
    if reason := why_not_speeds(frames) or why_not(frames):
        return Check(name, None, reason)
    first = first_relaxed_frame(frames)
    if first is None:
        return Check(name, None, describe_motion(frames))
    used = frames.parts(slice(first, None))
    relaxed = range(first, len(frames.positions))
    if is_uneven(frames, relaxed) or is_uneven(frames, relaxed, energy=True):
        return Check(name, None, "density or temperature is not uniform: not relaxed")
    if reason := why_not(used):
        return Check(name, None, reason)
    try:
        coefficient, window = diffusion(used)
    except SceneError as unsettled:
        return Check(name, None, unsettled.rule)
    value, error, source = expected_diffusion(used, window)
    basis = f"{source}; {groups_of(used)} groups of particles, {window[0]:.3g} to {window[1]:.3g} collisions"
    return compare_with_theory(name, coefficient, Estimate(value, error), basis)


# Checks of a gaspart run with open faces, in which the number of particles changes.


ENERGY_DRIFT = 1e-9
"""Maximum drift of the energy, divided by the greatest sum of the kinetic energy and the energy that
particles carried through faces.
"""
_CHANGING = "particles come and go: its theory is of those that stay"


def judge_open(path: Path, tolerance: float | None = None) -> tuple[str, list[Check]]:
    """Check a trajectory with open faces. Returns a line that states the numbers of particles, and the checks
    of positions, of the balances of particles and energy, and of flights. `tolerance` is the allowed overlap,
    as a fraction of a diameter.
    """
    recipe = read_recipe(path)
    scene = recipe.scene
    with open_trajectory(path) as data:
        counts = particle_numbers(scene, data)
        kind = "discs" if scene.dimension == 2 else "spheres"
        title = f"{path}: {counts.min()} to {counts.max()} {kind} in {len(counts)} frames"
        checks = [_particles(data, counts), _energy(scene, data)]
        if "keep" not in data.attrs:
            frames = _frames(recipe, data)
            checks = [*judge_places(frames, tolerance), *checks, judge_flights(frames)]
    unknown = SPEEDS[0], _PRESSURE, _DIFFUSION
    return title, [*checks, *(Check(name, None, _CHANGING) for name in unknown)]


def _frames(recipe: Recipe, data: xr.Dataset) -> Frames:
    """Return the frames of a run. Absent particles have NaN positions and zero velocities."""
    scene = recipe.scene
    lengths = np.array(scene.container.lengths)
    velocities = map_frames(_vectors(data, "velocities"), lambda frame, n: np.nan_to_num(frame))
    return Frames(
        positions=_vectors(data, "coordinates"),
        lengths=lengths,
        radii=data["radius"].values.astype(float),
        periodic=scene.container.periodic,
        velocities=velocities,
        time=data["time"].values,
        resolution=float(np.finfo(np.float32).eps * lengths.max()),
        sampled=not recipe.engine.forbids_overlap,
        engine=recipe.engine,
        scene=scene,
    )


def _vectors(data: xr.Dataset, name: str) -> Rows:
    """Return the vectors of all frames, NaN for absent particles; they are read when they are used."""
    values = data[name]
    length, count, dimension = values.shape
    return read_in_blocks((length, count, dimension), lambda frames: values[frames].values.astype(float))


def _particles(data: xr.Dataset, counts: np.ndarray) -> Check:
    """Compare the number of particles in each frame with the counted entries and exits."""
    stored = _vectors(data, "coordinates" if "coordinates" in data else "velocities")
    there = np.array([np.isfinite(frame[:, 0]).sum() for frame in stored])
    wrong = int(np.abs(there - counts).argmax())
    text = f"{counts[0]} at the start, with those that have entered less those that have left"
    if there[wrong] == counts[wrong]:
        return Check("particles", True, f"{text}, are in all frames")
    text += f", are {counts[wrong]} in frame {wrong}, which has {there[wrong]}"
    return Check("particles", False, text)


def _energy(scene: Scene, data: xr.Dataset) -> Check:
    """Compare the energy in each frame with the energy exchanged by particles and faces."""
    total = conserved_energy(scene, data)
    carried = np.abs(data["wall_energy"].values).sum(axis=1)
    scale = max(float((data["kinetic_energy"].values + carried).max()), np.finfo(float).tiny)
    drift = float(np.abs(total - total[0]).max()) / scale
    text = f"changes by {drift:.1e} of itself at most, less what particles and faces have brought and taken"
    return Check("energy", drift <= ENERGY_DRIFT, text)


# Validation of scene files.


def judge_scene(path: Path, tolerance: float | None = None) -> list[Check]:
    """Check a scene and the placement of its particles; raise SceneError for an invalid scene."""
    scene = Scene.from_file(path)
    facts = f"{scene.count} particles, packing fraction {scene.packing_fraction:.6g}"
    checks = [Check("scene", True, f"{facts}, number density {scene.number_density:.6g}")]
    if scene.count < 2:
        return checks
    try:
        state = initial_state(scene, 1)
    except SceneError as error:
        raise error.inside("", str(path)) from None
    periodic = scene.container.periodic
    checks += judge_places(Frames(state.positions[None], state.lengths, state.radii, periodic), tolerance)
    return checks
