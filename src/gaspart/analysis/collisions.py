"""Data set of collisions: the colliding particles, the contact geometry, and the preceding free flights.

Kinetic theory predicts averages of these quantities. The data set has one row for each collision of two
particles. The row contains the normal at contact, the speed of approach, and, for both particles, the time
and the path since the previous event of the particle. A wall hit also ends a free flight, but it has no row.
"""

from __future__ import annotations

import json
import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.flow import Grid
from gaspart.analysis.observable import Observable, observable, with_freedom
from gaspart.analysis.statistics import histogram_means, mean_of, means_of
from gaspart.engines import EventDriven
from gaspart.errors import SceneError, SimulationError
from gaspart.files import FileKind, begins_with, open_regular, writing
from gaspart.keys.values import count_of, number
from gaspart.scene.boundaries import refuse_sheared
from gaspart.scene.scene import Scene
from gaspart.simulation import Simulation
from gaspart.system import descriptor_path, memory
from gaspart.theory.enskog import free_time_pdf
from gaspart.theory.geometry import unit_sphere_surface
from gaspart.theory.speeds import mean_speed, mean_speed_factor
from gaspart.trajectory.provenance import git_revision, versions

_CHUNK = 20_000  # maximum number of events in memory
_PATIENCE = 1_000_000  # maximum number of consecutive events without a collision of two particles
_ABOUT = {
    "time": ("time of the collision", "time"),
    "particles": ("the two particles, the lower index first", "1"),
    "normal": ("unit vector at contact, from the first particle to the second", "1"),
    "approach": ("relative speed along the normal, before", "length / time"),
    "relative_speed": ("relative speed, before", "length / time"),
    "free_time": ("time since the last event of the particle of any kind", "time"),
    "free_path": ("its flight since then", "length"),
}


def collision_data(
    scene: Scene, collisions: int, seed: int | tuple[int, ...] = 0, equilibration: float = 0.0
) -> xr.Dataset:
    """Record the collisions of a scene under the event-driven engine.

    The required memory is proportional to the number of recorded collisions.

    Parameters
    ----------
    scene : Scene
        The scene.
    collisions : int
        Minimum number of collisions.
    seed : int or tuple of int, default 0
        Seed of the run.
    equilibration : float, default 0.0, [time]
        Simulated time before the recording begins.

    Returns
    -------
    Dataset
        Dimensions: collision, of (the two particles), and axis. `free_time` and `free_path` are NaN for the
        first event of a particle. Attributes: scene, seed, versions, revision, and `mean_free_path`, the path
        of all particles in the record divided by the number of flights that collisions ended. The mean of
        `free_path` in a short record is smaller, because long flights do not end in it.

    Raises
    ------
    SceneError
        If the scene has gravity (paths are then not straight) or fewer than two particles, if `collisions` is
        below 1, or if the data would exceed the memory of this machine.
    SimulationError
        If no collision occurs.

    Examples
    --------
    >>> import gaspart as gp
    >>> box = gp.Container((10.0, 10.0), boundary="periodic")
    >>> scene = gp.Scene(box, [gp.Species(32, 0.5, temperature=1.0)])
    >>> data = gp.collision_data(scene, collisions=500, seed=1)
    >>> bool((data["approach"] > 0.0).all())
    True
    """
    _check_memory(count_of("collisions", collisions, least=1), scene)
    number("equilibration", equilibration, "must not be negative", least=0.0)
    if scene.gravity is not None:
        raise SceneError("gravity", scene.gravity, "free paths are straight only without gravity")
    refuse_sheared(scene, "distances at contacts are not defined where images of the particles slide")
    if scene.count < 2:
        raise SceneError("count", scene.count, "a collision needs two particles")
    simulation = Simulation(scene, EventDriven(), seed)
    simulation.advance(duration=equilibration)
    state = simulation.state
    last = (
        np.full(state.count, np.nan),
        state.velocities,
    )  # time and velocity after each particle's last event
    parts, progress, alone, flown, ended = [], 0, 0, 0.0, 0
    while progress < collisions:
        simulation.record_events = True  # starts a new, empty list
        events, begun = min(_CHUNK, max(collisions - progress, 1)), simulation.time
        simulation.advance(max_events=events)
        flown += _path_flown(simulation.events, last[1], begun, simulation.time)
        part, last = pair_rows(simulation.events, last, scene)
        ended += int(np.isfinite(state.masses[part["particles"].values]).sum())
        parts.append(part)
        progress += part.sizes["collision"]
        alone = 0 if part.sizes["collision"] else alone + events
        if alone > _PATIENCE:
            raise SimulationError(f"none of the last {_PATIENCE} events was a collision of two particles")
    return xr.concat(parts, "collision", join="exact", compat="equals").assign_attrs(
        scene=json.dumps(scene.to_dict()),
        seed=json.dumps(seed),
        equilibration=equilibration,
        duration=simulation.time - equilibration,
        mean_free_path=flown / ended,
        gaspart_revision=git_revision(),
        **versions(),
    )


def _path_flown(events: dict, velocities: np.ndarray, begun: float, end: float) -> float:
    """Return the total path of all particles between two times, from the velocities (N, d) at the first."""
    inside, every = events["particles"] >= 0, np.arange(len(velocities))
    times = np.broadcast_to(events["time"][:, None], inside.shape)[inside]
    index = np.concatenate([every, events["particles"][inside], every])
    when = np.concatenate([np.full(len(every), begun), times, np.full(len(every), end)])
    speed = np.sqrt((np.concatenate([velocities, events["velocities"][inside], velocities]) ** 2).sum(axis=1))
    order = np.argsort(index, kind="stable")
    flights = np.diff(when[order]) * speed[order][:-1]
    return float(flights[np.diff(index[order]) == 0].sum())


def record_collisions(
    scene: Scene,
    path: str | Path,
    collisions: int,
    seed: int | tuple[int, ...] = 0,
    equilibration: float = 0.0,
    overwrite: bool = False,
) -> xr.Dataset:
    """Write `collision_data` to a netCDF-3 file."""
    with writing(path, COLLISIONS, overwrite) as scratch:
        data = collision_data(scene, collisions, seed, equilibration)
        # The file is made in memory first, because the library does not report why it cannot write a file.
        # NetCDF-4 files made in memory contain their creation time, so their bytes would differ between runs.
        scratch.write_bytes(data.to_netcdf(None, engine="scipy", format="NETCDF3_64BIT"))
    return data


def _is_collision_data(path: Path) -> bool:
    """Return True if `record_collisions` wrote the file."""
    import netCDF4

    if not begins_with(b"CDF\x02", b"\x89HDF")(path):  # older versions wrote netCDF-4
        return False
    try:
        with open_regular(path) as opened, netCDF4.Dataset(descriptor_path(opened)) as file:
            return set(_ABOUT) <= set(file.variables) and "gaspart_revision" in file.ncattrs()
    except (OSError, RuntimeError):
        return False


COLLISIONS = FileKind("a data set of collisions written by gaspart", _is_collision_data)


def _check_memory(collisions: int, scene: Scene) -> None:
    """Raise SceneError if the memory is smaller than twice the size of the collision data."""
    required = 16.0 * collisions * (9 + scene.dimension)
    there = memory()
    if there is not None and required > there:
        rule = f"needs {required / 1e9:.3g} GB of memory; this machine has {there / 1e9:.3g} GB"
        raise SceneError("collisions", collisions, rule)


def contact_value(data: xr.Dataset, blocks: int = 20) -> Estimate:
    """Measure the contact value of g(r) for equal particles from their collision rate.

    For M collisions of N particles in the time t, chi = 2 M / (N t S rho sigma^(d-1) sqrt(kT / (pi m))), with
    S = 2 pi (2D) or 4 pi (3D). This formula is exact in equilibrium (S. Chapman and T. G. Cowling (1970)).
    The temperature is computed from the mean speed of approach, which is sqrt(pi kT / m).

    Parameters
    ----------
    data : Dataset
        Collisions, from `collision_data`.
    blocks : int, default 20
        Number of blocks; the scatter between blocks gives the error.

    Returns
    -------
    Estimate
        The contact value chi, dimensionless, with its standard error.

    Raises
    ------
    SceneError
        If the particles of the scene are not all equal.
    """
    scene = Scene.from_dict(json.loads(data.attrs["scene"]))
    if not scene.alike:
        raise SceneError("species", len(scene.kinds), "the contact value is defined for equal particles only")
    diameter = 2.0 * scene.largest_radius
    surface = unit_sphere_surface(scene.dimension)
    times, approach = data["time"].values, data["approach"].values
    ends = np.linspace(0, len(times), blocks + 1).astype(int)
    start = data.attrs["equilibration"]
    edges = np.concatenate([[start], times[ends[1:] - 1]])
    spread = np.array([approach[a:b].mean() for a, b in pairwise(ends)]) / math.pi
    rate = 2.0 * np.diff(ends) / (scene.count * np.diff(edges))
    return mean_of(rate / (surface * scene.number_density * diameter ** (scene.dimension - 1) * spread))


def pair_rows(events: dict, last: tuple, scene: Scene) -> tuple[xr.Dataset, tuple]:
    """Select the collisions of two particles from events, as rows of `collision_data`."""
    particles, times, after = events["particles"], events["time"], events["velocities"]
    number_of_particles = len(last[0])
    # history of each particle in order: its initial state, then its state after each event
    rows = np.arange(len(times))
    inside = particles >= 0
    index = np.concatenate([np.arange(number_of_particles), particles[inside]])
    when = np.concatenate([last[0], np.broadcast_to(times[:, None], particles.shape)[inside]])
    velocity = np.concatenate([last[1], after[inside]])
    slot = np.full(particles.shape, -1)
    slot[inside] = number_of_particles + np.arange(inside.sum())
    order = np.argsort(index, kind="stable")
    before = np.empty(len(index), dtype=int)
    before[order[1:]] = order[:-1]  # invalid for the first entry of a particle, which is not used
    final = order[np.append(np.flatnonzero(np.diff(index[order])), len(index) - 1)]

    collided = rows[inside[:, 1]]
    pair = particles[collided]
    previous = before[slot[collided]]
    incoming = velocity[previous]
    free_time = times[collided, None] - when[previous]
    apart = events["positions"][collided, 1] - events["positions"][collided, 0]
    lengths = np.where(scene.container.periodic, scene.container.lengths, np.inf)
    apart -= lengths * np.round(apart / lengths) if np.isfinite(lengths).any() else 0.0
    normal = apart / np.sqrt((apart**2).sum(axis=1))[:, None]
    relative = incoming[:, 1] - incoming[:, 0]
    values = {
        "time": (("collision",), times[collided]),
        "particles": (("collision", "of"), pair),
        "normal": (("collision", "axis"), normal),
        "approach": (("collision",), -(relative * normal).sum(axis=1)),
        "relative_speed": (("collision",), np.sqrt((relative**2).sum(axis=1))),
        "free_time": (("collision", "of"), free_time),
        "free_path": (("collision", "of"), free_time * np.sqrt((incoming**2).sum(axis=2))),
    }
    data = xr.Dataset(values)
    for name, (long_name, units) in _ABOUT.items():
        data[name].attrs.update(long_name=long_name, units=units)
    return data, (when[final], velocity[final])


# Free times and free paths between the collisions of a particle, from the recorded events of a run.


GROUPS = 16
"""Number of groups of particles. The scatter between groups gives the uncertainty."""
COMPLETE = 16.0
"""Duration of the last part of the record, in mean free times. Flights that begin in this part are discarded,
because the longest of them would not end within the record. Only a fraction exp(-11) of the flights of slow
particles is longer than this part.
"""
_LONGEST = 5.0  # upper end of the bins in mean free times


def free_flight_times(simulation: Simulation, bins: int = 40) -> Observable:
    """Measure the probability density of the time between two collisions of a particle.

    Uncertainties come from the scatter of 16 groups of particles. The uncertainty of an empty bin is NaN.
    Theory exists for equal particles. The theoretical density is `enskog.free_time_pdf`, which assumes
    independent collisions. The theoretical mean free time and path are exact in equilibrium, apart from the
    uncertainty of the contact value. They include the correction for the finite number of particles.

    Parameters
    ----------
    simulation : Simulation
        An event-driven simulation of a periodic scene. It must have advanced with `record_events` = True for
        at least 32 collisions per particle.
    bins : int, default 40
        Number of bins between 0 and five mean free times.

    Returns
    -------
    Observable
        Probability density (free_time,) in [1/time]. The variables `mean_free_time` and `mean_free_path` are
        the mean duration and the mean path of a free flight. The error of each variable has the suffix
        _error. Its theoretical value, if theory exists, has the suffix _theory.

    Raises
    ------
    SceneError
        If the record is missing or too short, or if the scene has gravity, walls or fewer than 16 moving
        particles.
    """
    scene, state = simulation.scene, simulation.state
    refuse_sheared(scene, "free flights are those of a gas at rest")
    if not scene.is_periodic or scene.walls:
        rule = "has walls, which end flights: only the flights of a periodic gas are between collisions"
        raise SceneError("container.boundary", scene.container.boundary, rule)
    events, count = simulation.events, int(np.isfinite(state.masses).sum())
    if count < GROUPS:
        raise SceneError("count", count, f"an error needs {GROUPS} moving particles or more")
    number_of_events = len(events["time"])
    if number_of_events < COMPLETE * count:
        rule = f"must be {2.0 * COMPLETE:g} collisions of a particle or more: a longer run"
        raise SceneError("events", number_of_events, rule)
    unknown = np.full(state.count, np.nan), np.full(state.positions.shape, np.nan)
    flights, _ = pair_rows(events, unknown, scene)
    mean = (simulation.time - float(events["time"][0])) * count / (2.0 * number_of_events)
    times, paths = flights["free_time"].values, flights["free_path"].values
    begun = flights["time"].values[:, None] - times
    chosen = (begun < simulation.time - COMPLETE * mean) & np.isfinite(state.masses)[
        flights["particles"].values
    ]
    group = (flights["particles"].values % GROUPS)[chosen]
    members = [(times[chosen][group == n], paths[chosen][group == n]) for n in range(GROUPS)]
    sizes = [len(time) for time, _ in members]
    grid = Grid.line(0.0, _LONGEST * mean, count_of("bins", bins, least=2))
    (edges,), (middle,) = grid.edges, grid.middles
    densities = [grid.sums(grid.cells(time[:, None])) / grid.volume / len(time) for time, _ in members]
    values, errors, freedoms = histogram_means(densities, sizes)
    means, scatter = means_of([(time.mean(), path.mean()) for time, path in members], sizes)
    about: dict[str, Any] = {"units": "1 / time", "long_name": "probability density of free times"}
    along = {"free_time": (middle, {"units": "time", "long_name": "time between collisions"})}
    expected = _theory(simulation, edges)
    if expected:
        about |= {"theory": (expected[0], math.nan), "source": "independent collisions, Enskog's rate"}
    result = with_freedom(observable("free_flight_times", along, values, errors, **about), freedoms)
    for n, (name, units) in enumerate((("mean_free_time", "time"), ("mean_free_path", "length"))):
        result[name] = ((), means[n], {"units": units})
        result[f"{name}_error"] = ((), scatter[n], {"units": units, "long_name": "standard uncertainty"})
        if expected:
            result[f"{name}_theory"] = ((), expected[1][n], {"units": units, "long_name": "theory: Enskog"})
    return result


def _theory(simulation: Simulation, edges: np.ndarray) -> tuple[np.ndarray, tuple[float, float]] | None:
    """Compute the theoretical density (bins,) of free times, and their mean time and path; None without
    theory.
    """
    gas, state = simulation.scene.gas, simulation.state
    if gas is None or gas.packing_fraction > theory.HIGHEST_PACKING_FRACTION[gas.dimension]:
        return None
    temperature = state.temperature
    settings = {**gas.parameters, "temperature": temperature}
    inner = np.linspace(edges[:-1], edges[1:], 5)  # Boole's rule
    weights = np.array([7.0, 32.0, 12.0, 32.0, 7.0]) / 90.0
    density = weights @ free_time_pdf(inner, **settings)
    # `collision_rate_finite_size_factor` refers to a temperature defined with d N degrees of freedom
    fewer = math.sqrt((gas.count - 1) / gas.count)
    shape = gas.packing_fraction, gas.dimension
    rate = float(theory.collision_rate(**settings))
    rate *= fewer * float(theory.collision_rate_finite_size_factor(*shape, gas.count))
    speed = float(mean_speed(gas.dimension, temperature, gas.mass))
    speed *= fewer * mean_speed_factor(gas.dimension * (gas.count - 1))
    return density, (1.0 / rate, speed / rate)
