"""Free flights from the recorded events of a run: times and paths between the collisions of a particle."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from gaspart import theory
from gaspart.analysis.bins import Grid
from gaspart.analysis.collisions import pair_rows
from gaspart.analysis.observable import Observable, observable
from gaspart.analysis.statistics import means_of
from gaspart.errors import SceneError
from gaspart.keys.values import count_of
from gaspart.scene.shear import refuse_sheared
from gaspart.simulation import Simulation
from gaspart.theory.speeds import mean_speed, mean_speed_factor

GROUPS = 16
"""Groups of particles, whose scatter gives the uncertainty."""
COMPLETE = 16.0
"""Mean free times before the end of the record: flights that begin later are left out, since the longest of
these would be missing. Of slow particles exp(-11) are longer."""
_LONGEST = 5.0  # mean free times that the bins cover


def free_flight_times(simulation: Simulation, bins: int = 40) -> Observable:
    """Measure the probability density of the time between two collisions of a particle.

    Parameters
    ----------
    simulation : Simulation
        Event-driven and periodic; `record_events` was True while it advanced, for at least 32 collisions of a
        particle.
    bins : int, default 40
        Number of bins, up to five times the mean time.

    Returns
    -------
    Observable
        Density (free_time,) in [1/time]. The mean time and path of a flight are the variables
        `mean_free_time` and `mean_free_path`, each with _error and, if there is a theory, _theory.

    Raises
    ------
    SceneError
        If there is no record or it is too short, and for gravity, walls, and fewer than 16 moving particles.

    Notes
    -----
    Uncertainties are the scatter of 16 groups of particles. Theory, for equal particles:
    `theory.free_time_pdf`, for independent collisions; means exact in equilibrium, to the accuracy of the
    contact value, and corrected for the number of particles.

    Examples
    --------
    >>> import gaspart as gp
    >>> box = gp.Container((10.0, 10.0), boundary="periodic")
    >>> scene = gp.Scene(box, [gp.Species(32, 0.5, temperature=1.0)])
    >>> simulation = gp.Simulation(scene, seed=1)
    >>> simulation.record_events = True
    >>> simulation.advance(40.0)
    >>> gp.analysis.free_flight_times(simulation).sizes["free_time"]
    40
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
    found = [grid.sums(grid.cells(time[:, None])) / grid.volume / len(time) for time, _ in members]
    values, errors = means_of(found, sizes)
    means, scatter = means_of([(time.mean(), path.mean()) for time, path in members], sizes)
    about: dict[str, Any] = {"units": "1 / time", "long_name": "probability density of free times"}
    along = {"free_time": (middle, {"units": "time", "long_name": "time between collisions"})}
    expected = _theory(simulation, edges)
    if expected:
        about |= {"theory": (expected[0], math.nan), "source": "independent collisions, Enskog's rate"}
    result = observable("free_flight_times", along, values, errors, **about)
    for n, (name, units) in enumerate((("mean_free_time", "time"), ("mean_free_path", "length"))):
        result[name] = ((), means[n], {"units": units})
        result[f"{name}_error"] = ((), scatter[n], {"units": units, "long_name": "standard uncertainty"})
        if expected:
            result[f"{name}_theory"] = ((), expected[1][n], {"units": units, "long_name": "theory: Enskog"})
    return result


def _theory(simulation: Simulation, edges: np.ndarray) -> tuple[np.ndarray, tuple[float, float]] | None:
    """(bins,) the mean density in each bin, and the mean time and path; None where there is no theory."""
    gas, state = simulation.scene.gas, simulation.state
    if gas is None or gas.packing_fraction > theory.HIGHEST_PACKING_FRACTION[gas.dimension]:
        return None
    temperature = state.temperature
    settings = {**gas.parameters, "temperature": temperature}
    inner = np.linspace(edges[:-1], edges[1:], 5)  # Boole's rule
    weights = np.array([7.0, 32.0, 12.0, 32.0, 7.0]) / 90.0
    density = weights @ theory.free_time_pdf(inner, **settings)
    # `collision_rate_finite_size_factor` is relative to a temperature of d N degrees of freedom
    fewer = math.sqrt((gas.count - 1) / gas.count)
    shape = gas.packing_fraction, gas.dimension
    rate = float(theory.collision_rate(**settings))
    rate *= fewer * float(theory.collision_rate_finite_size_factor(*shape, gas.count))
    speed = float(mean_speed(gas.dimension, temperature, gas.mass))
    speed *= fewer * mean_speed_factor(gas.dimension * (gas.count - 1))
    return density, (1.0 / rate, speed / rate)
