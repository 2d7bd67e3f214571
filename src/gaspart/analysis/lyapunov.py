"""Largest Lyapunov exponent, the rate at which neighbouring runs separate, from the events of one run.

The linearised dynamics (in tangent space) propagates an infinitesimal deviation of the initial state. So the
deviation never saturates, and no second run is needed. In free flight, the velocity deviation times the time
is added to the position deviation. At a contact, the deviations of positions and velocities are mapped
linearly (Dellago, Posch & Hoover, Phys. Rev. E 53, 1485 (1996)).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from gaspart.analysis.observable import LEAST_INTERVALS, Observable, scalar
from gaspart.errors import SceneError
from gaspart.keys.values import number
from gaspart.scene.scene import Scene
from gaspart.simulation import Simulation

ALIGNMENT = 0.25
"""Fraction of the record that is discarded at the start, while the deviation aligns with the direction of
fastest growth.
"""


class Deviation:
    """Infinitesimal deviation of a state. The deviations of positions and of velocities are lists of N
    vectors. The object also stores a time for each particle, because a particle is advanced only at its own
    events.
    """

    def __init__(self, positions: np.ndarray, velocities: np.ndarray, time: float) -> None:
        self.positions, self.velocities = positions.tolist(), velocities.tolist()
        self.times = [time] * len(self.positions)

    def advance(self, n: int, time: float) -> None:
        """Move the deviation of particle n through free flight until `time`."""
        passed, position = time - self.times[n], self.positions[n]
        for axis, change in enumerate(self.velocities[n]):
            position[axis] += change * passed
        self.times[n] = time

    def reflect(self, n: int, axis: int) -> None:
        """Reflect the deviation of particle n at a face of the container across `axis`."""
        self.positions[n][axis] = -self.positions[n][axis]
        self.velocities[n][axis] = -self.velocities[n][axis]

    def collide(self, i: int, j: int, away: list[float], parting: list[float], share: float) -> None:
        """Map the deviations of particles i and j at a smooth elastic contact. Both deviations must be
        advanced to the time of the contact. The arguments are `away` = x_i - x_j, `parting` = v_i - v_j just
        after the contact, and `share` = m_j / (m_i + m_j). With n = away / sigma and the relative velocity g
        before the contact, a relative deviation (r, u) becomes r - 2 (r.n) n and u - 2 (u.n) n - 2 (g.m) n -
        2 (g.n) m. Here m = (r + g t) / sigma is the deviation of n, and t = -(r.n) / (g.n) the deviation of
        the time of contact.
        """
        axes = range(len(away))
        sigma = math.sqrt(sum([x * x for x in away]))
        normal = [x / sigma for x in away]
        approach = -sum([parting[a] * normal[a] for a in axes])  # g.n
        before = [parting[a] + 2.0 * approach * normal[a] for a in axes]
        (xi, xj), (vi, vj) = (self.positions[i], self.positions[j]), (self.velocities[i], self.velocities[j])
        along = sum([(xi[a] - xj[a]) * normal[a] for a in axes])
        late = -along / approach
        turned = [(xi[a] - xj[a] + before[a] * late) / sigma for a in axes]
        faster = sum([(vi[a] - vj[a]) * normal[a] + before[a] * turned[a] for a in axes])
        for a in axes:
            moved = -2.0 * along * normal[a]
            pushed = -2.0 * (faster * normal[a] + approach * turned[a])
            xi[a] += share * moved
            xj[a] -= (1.0 - share) * moved
            vi[a] += share * pushed
            vj[a] -= (1.0 - share) * pushed

    def rescale(self, time: float) -> float:
        """Advance all particles to `time`, normalize the deviation, and return its previous length."""
        for n in range(len(self.times)):
            self.advance(n, time)
        both = np.array(self.positions), np.array(self.velocities)
        length = math.sqrt(sum(float((part**2).sum()) for part in both))
        self.positions, self.velocities = ((part / length).tolist() for part in both)
        return length


def follow(deviation: Deviation, scene: Scene, masses: np.ndarray, events: Mapping[str, np.ndarray]) -> None:
    """Propagate a deviation through the events of a run, in their order (see `Simulation.events`)."""
    _require_plain(scene)
    lengths, weights = np.array(scene.container.lengths), masses.tolist()
    away = events["positions"][:, 0] - events["positions"][:, 1]
    away -= np.where(scene.container.periodic, lengths * np.rint(away / lengths), 0.0)
    parting = events["velocities"][:, 0] - events["velocities"][:, 1]
    rows = events["time"].tolist(), events["particles"].tolist(), away.tolist(), parting.tolist()
    for time, (i, j), apart, velocity in zip(*rows, strict=True):
        deviation.advance(i, time)
        if j < 0:
            deviation.reflect(i, (-1 - j) // 2)
        else:
            deviation.advance(j, time)
            deviation.collide(i, j, apart, velocity, weights[j] / (weights[i] + weights[j]))


def lyapunov_exponent(simulation: Simulation, start: float | None = None, seed: int = 0) -> Observable:
    """Measure the largest Lyapunov exponent from the recorded events of an event-driven run.

    The growth rates in equal intervals form a correlated series. The uncertainty is the error of the mean of
    this series. The computation takes about 10 microseconds per event.

    Parameters
    ----------
    simulation : Simulation
        A simulation for which `record_events` was True while it advanced.
    start : float, [time], optional
        Time from which growth is measured. Default: the first quarter of the record is discarded. In this
        time the deviation aligns with the direction of fastest growth.
    seed : int, default 0
        Seed of the random initial deviation.

    Returns
    -------
    Observable
        The exponent, in [1/time].

    Raises
    ------
    SceneError
        If there is no record, if it has too few events, or if the scene has anything other than moving
        particles with smooth elastic contacts and hard faces.

    Examples
    --------
    >>> import gaspart as gp
    >>> box = gp.Container((10.0, 10.0), boundary="periodic")
    >>> scene = gp.Scene(box, [gp.Species(32, 0.5, temperature=1.0)])
    >>> simulation = gp.Simulation(scene, seed=1)
    >>> simulation.record_events = True
    >>> simulation.advance(20.0)
    >>> gp.analysis.lyapunov_exponent(simulation).estimate.attrs["units"]
    '1 / time'
    """
    _require_plain(simulation.scene)
    events, state = simulation.events, simulation.state
    number_of_events = len(events["time"])
    if number_of_events < LEAST_INTERVALS:
        raise SceneError("events", number_of_events, f"must be at least {LEAST_INTERVALS}: a longer run")
    first, last = float(events["time"][0]), simulation.time
    begin = first + ALIGNMENT * (last - first) if start is None else number("start", start, "a time")
    if not first <= begin < last:
        raise SceneError(
            "start", start, f"must be from {first:g} to below {last:g}, where events are recorded"
        )
    # The deviation is rescaled often enough to avoid overflow, about once in N events, also during alignment.
    intervals = max(2 * LEAST_INTERVALS, number_of_events // state.count)
    turning = math.ceil(intervals * (begin - first) / (last - begin))
    edges = np.concatenate(
        [np.linspace(first, begin, turning, endpoint=False), np.linspace(begin, last, intervals + 1)]
    )
    splits = np.searchsorted(events["time"], edges, side="right")
    splits[0] = 0
    rng = np.random.default_rng(seed)
    shape = state.positions.shape
    deviation = Deviation(rng.standard_normal(shape), rng.standard_normal(shape), first)
    growth = []
    for low, high, end in zip(splits[:-1], splits[1:], edges[1:], strict=True):
        part = {name: values[low:high] for name, values in events.items()}
        follow(deviation, simulation.scene, state.masses, part)
        growth.append(math.log(deviation.rescale(float(end))))
    measured = edges[turning:]
    rates = np.array(growth[turning:]) / np.diff(measured)
    about: dict[str, Any] = {"units": "1 / time", "long_name": "largest Lyapunov exponent"}
    return scalar("lyapunov_exponent", rates, measured, **about)


def _require_plain(scene: Scene) -> None:
    """Raise SceneError if the scene has features for which `Deviation` has no linear map."""
    law = scene.restitution
    present = {
        "gravity": scene.gravity is not None and any(scene.gravity),
        "walls": bool(scene.walls),
        "faces": bool(scene.faces),
        "restitution": law is not None and not law.smooth_and_elastic,
        "thermostat": scene.thermostat is not None,
    }
    rule = "the exponent is that of smooth elastic contacts and hard faces only: remove it"
    for key, there in present.items():
        if there:
            raise SceneError(key, getattr(scene, key), rule)
    if any(kind.fixed for kind in scene.kinds):
        raise SceneError("fixed", True, rule)
