"""A data set of collisions: who met whom, how squarely, and after how long a flight.

What kinetic theory averages over, one row per collision of two bodies: free times and free paths since each
body's last event, the normal at contact, the speeds of approach. Hits of walls end flights but are no rows.
"""

from __future__ import annotations

import json
import math
from itertools import pairwise

import numpy as np
import xarray as xr

from gaspart.analysis.statistics import Estimate, mean_of
from gaspart.engines import EventDriven
from gaspart.errors import SceneError
from gaspart.scene.scene import Scene
from gaspart.scene.validation import count_of, number
from gaspart.simulation.simulation import Simulation
from gaspart.trajectory.provenance import git_revision, versions

_CHUNK = 20_000  # events that are kept at once
_ABOUT = {
    "time": ("time of the collision", "time"),
    "bodies": ("the two bodies, the lower index first", "1"),
    "normal": ("unit vector at contact, from the first body to the second", "1"),
    "approach": ("relative speed along the normal, before", "length / time"),
    "relative_speed": ("relative speed, before", "length / time"),
    "free_time": ("time since the body's last event of any kind", "time"),
    "free_path": ("its flight since then", "length"),
}


def collision_data(
    scene: Scene, collisions: int, seed: int | tuple[int, ...] = 0, equilibration: float = 0.0
) -> xr.Dataset:
    """At least `collisions` collisions of a scene under the event-driven engine, after a time `equilibration`
    that is not recorded.

    Dimensions collision, of (the two bodies), axis; `free_time` and `free_path` are NaN for a body that had
    no event before. Memory is bounded by the data themselves. Attributes: scene, seed, versions, revision.

    Raises SceneError for gravity, under which paths are no lines, and for a count below 1; SimulationError
    where nothing ever happens.
    """
    count_of("collisions", collisions, least=1)
    number("equilibration", equilibration, "must not be negative", least=0.0)
    if scene.gravity is not None:
        raise SceneError("gravity", scene.gravity, "free paths are straight only without gravity")
    simulation = Simulation(scene, EventDriven(), seed)
    simulation.advance(duration=equilibration)
    state = simulation.state
    last = np.full(state.count, np.nan), state.velocities  # time and velocity after each body's last event
    parts, found = [], 0
    while found < collisions:
        simulation.record_events = True  # a new, empty list
        simulation.advance(max_events=min(_CHUNK, max(collisions - found, 1)))
        part, last = _pairs(simulation.events, last, scene)
        parts.append(part)
        found += part.sizes["collision"]
    return xr.concat(parts, "collision").assign_attrs(
        scene=json.dumps(scene.to_dict()),
        seed=json.dumps(seed),
        equilibration=equilibration,
        duration=simulation.time - equilibration,
        gaspart_revision=git_revision(),
        **versions(),
    )


def contact_value(data: xr.Dataset, blocks: int = 20) -> Estimate:
    """g at contact of equal bodies, from how often they collide: chi = 2 M / (N t S rho sigma^(d-1)
    sqrt(kT / (pi m))), S = 2 pi (2D), 4 pi (3D), exact in equilibrium (Chapman & Cowling 1970). The
    temperature is that of the mean approach, sqrt(pi kT / m); the error that of `blocks` stretches.

    Raises SceneError for a scene of several kinds of bodies.
    """
    scene = Scene.from_dict(json.loads(data.attrs["scene"]))
    kinds = {(thing.radius, thing.mass) for thing in scene.kinds}
    if len(kinds) != 1:
        raise SceneError("species", len(kinds), "the contact value is told of equal bodies only")
    diameter = 2.0 * kinds.pop()[0]
    surface = {2: 2.0, 3: 4.0}[scene.dimension] * math.pi
    times, approach = data["time"].values, data["approach"].values
    ends = np.linspace(0, len(times), blocks + 1).astype(int)
    start = data.attrs["equilibration"]
    edges = np.concatenate([[start], times[ends[1:] - 1]])
    spread = np.array([approach[a:b].mean() for a, b in pairwise(ends)]) / math.pi
    rate = 2.0 * np.diff(ends) / (scene.count * np.diff(edges))
    return mean_of(rate / (surface * scene.number_density * diameter ** (scene.dimension - 1) * spread))


def _pairs(events: dict, last: tuple, scene: Scene) -> tuple[xr.Dataset, tuple]:
    """The collisions of two bodies among `events`, and each body's time and velocity after its last one."""
    bodies, times, after = events["bodies"], events["time"], events["velocities"]
    number_of_bodies = len(last[0])
    # what each body did, in order: first what it did before, then its part in every event
    rows = np.arange(len(times))
    inside = bodies >= 0
    who = np.concatenate([np.arange(number_of_bodies), bodies[inside]])
    when = np.concatenate([last[0], np.broadcast_to(times[:, None], bodies.shape)[inside]])
    velocity = np.concatenate([last[1], after[inside]])
    slot = np.full(bodies.shape, -1)
    slot[inside] = number_of_bodies + np.arange(inside.sum())
    order = np.argsort(who, kind="stable")
    before = np.empty(len(who), dtype=int)
    before[order[1:]] = order[:-1]  # wrong only for what a body did first, which nobody asks for
    final = order[np.append(np.flatnonzero(np.diff(who[order])), len(who) - 1)]

    met = rows[inside[:, 1]]
    pair = bodies[met]
    previous = before[slot[met]]
    incoming = velocity[previous]
    free_time = times[met, None] - when[previous]
    apart = events["positions"][met, 1] - events["positions"][met, 0]
    lengths = np.where(scene.container.periodic, scene.container.lengths, np.inf)
    apart -= lengths * np.round(apart / lengths) if np.isfinite(lengths).any() else 0.0
    normal = apart / np.sqrt((apart**2).sum(axis=1))[:, None]
    relative = incoming[:, 1] - incoming[:, 0]
    values = {
        "time": (("collision",), times[met]),
        "bodies": (("collision", "of"), pair),
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
