"""Impulses by the place where a particle receives them, along one axis (`kernels.physics.planes`): what makes
densities accurate."""

from typing import NamedTuple

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, kernel
from gaspart.kernels.physics.flight import acceleration_of
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.physics.planes import bin_at, row_of


class Impulses(NamedTuple):
    """sums (rows, bins + 1), as in `planes`, in the kernels' unit of mass; axis; per_length: bins in a unit
    of length; row (N,), that of each particle, or None if there is one."""

    sums: np.ndarray
    axis: int
    per_length: float
    row: np.ndarray | None


@inner_helper
def add_at(sums, row, place, impulse):
    """Add an impulse at a place, in bins."""
    bin_, part = bin_at(place, sums.shape[1] - 1)
    upper = impulse * part
    sums[row, bin_] += impulse - upper
    sums[row, bin_ + 1] += upper


@inner_helper
def speed_before(flights, i, impulses):
    """The velocity of a particle along the axis, before an impulse; 0 if none are tallied."""
    if impulses is not None:
        return flights[i].velocity[impulses.axis]
    return 0.0


@inner_helper
def speed_on_arrival(flights, i, time, model, gravity, impulses):
    """The velocity at a later time of a particle that has not been advanced to it."""
    if impulses is not None:
        axis = impulses.axis
        if gravity is None:
            return flights[i].velocity[axis]
        pull = acceleration_of(flights, i, axis, model.space, gravity)
        return flights[i].velocity[axis] + pull * (time - flights[i].clock)
    return 0.0


@inner_helper
def tally_impulse(flights, i, before, model, impulses):
    """Add the impulse that has changed the velocity of a particle from `before`."""
    if impulses is not None:
        change = flights[i].velocity[impulses.axis] - before
        if change != 0.0:  # one of infinite mass keeps its velocity
            place = flights[i].position[impulses.axis] * impulses.per_length
            impulse = mass_of(i, model.masses, model.law) * change
            add_at(impulses.sums, row_of(i, impulses.row), place, impulse)


@kernel
def add_momenta(flights, sign, model, impulses):
    """Add `sign` times the momentum that each particle now has, at its place."""
    for i in range(len(flights)):
        velocity = flights[i].velocity[impulses.axis]
        if velocity != 0.0:
            place = flights[i].position[impulses.axis] * impulses.per_length
            momentum = sign * mass_of(i, model.masses, model.law) * velocity
            add_at(impulses.sums, row_of(i, impulses.row), place, momentum)
