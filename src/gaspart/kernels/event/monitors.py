"""What observes events while they happen: the record of events, and the detection of a collapse."""

from typing import NamedTuple

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, inner_kernel


class Record(NamedTuple):
    """Room for events: filled (1,), time (M,), particles (M, 2), their indices, positions and velocities
    (M, 2, d), spins (M, 2, 3), which only a `ContactLaw` fills in."""

    filled: np.ndarray
    time: np.ndarray
    particles: np.ndarray
    positions: np.ndarray
    velocities: np.ndarray
    spins: np.ndarray


class CollapseWatch(NamedTuple):
    """For each particle, how many contacts (N,) it has had since (N,) within `interval`, at most `most`."""

    since: np.ndarray
    contacts: np.ndarray
    interval: float
    most: int


class Monitors(NamedTuple):
    """record, collapse: a `Record` and a `CollapseWatch`, or None."""

    record: Record | None
    collapse: CollapseWatch | None


@inner_helper
def is_full(record):
    """Whether the record has no room for another event."""
    if record is None:
        return False
    return record.filled[0] == len(record.time)


@inner_helper
def record_spins(record, n, i, j, law):
    """Record the spins after event number n."""
    if law is not None:
        for k in range(3):
            record.spins[n, 0, k] = law.spins[i, k]
            record.spins[n, 1, k] = law.spins[j, k] if j >= 0 else np.nan


@inner_helper
def record_event(flights, i, j, time, model, record):
    """Record an event; j is the partner, or -1 - face for a wall."""
    if record is not None:
        n = record.filled[0]
        record.time[n] = time
        record.particles[n, 0] = i
        record.particles[n, 1] = j
        for k in range(len(model.space.lengths)):
            record.positions[n, 0, k] = flights[i].position[k]
            record.velocities[n, 0, k] = flights[i].velocity[k]
            record.positions[n, 1, k] = flights[j].position[k] if j >= 0 else np.nan
            record.velocities[n, 1, k] = flights[j].velocity[k] if j >= 0 else np.nan
        record_spins(record, n, i, j, model.law)
        record.filled[0] = n + 1


@inner_kernel
def has_collapsed(collapse, i, time):
    """Count a contact of a particle. True if it has had too many of them in too short a time."""
    if time - collapse.since[i] > collapse.interval:
        collapse.since[i] = time
        collapse.contacts[i] = 0
    collapse.contacts[i] += 1
    return collapse.contacts[i] > collapse.most


@inner_helper
def collapse_detected(i, j, time, faces, collapse):
    """Whether an event was one contact too many, of particles i and j, or of i with an interior wall; hits of
    the container's `faces` do not count."""
    if collapse is None:
        return False
    if j >= 0 or j < -faces:
        return has_collapsed(collapse, i, time) or (j >= 0 and has_collapsed(collapse, j, time))
    return False
