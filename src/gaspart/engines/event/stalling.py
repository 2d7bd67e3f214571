"""Detection of runs that stall: particles that collide without end at one time, or never."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gaspart.engines.event.clock_epochs import QUIET
from gaspart.errors import SimulationError

if TYPE_CHECKING:
    from gaspart.kernels.event.monitors import CollapseWatch

MANY = 1 << 18
"""Number of events in which time must advance, by more than a clock resolves for each."""
# A run without an end is given up after so many epochs without an event, and as many flights through the
# container; or, where particles move so evenly together that these take longer, after more epochs.
_QUIET, _FLIGHTS, _QUIET_TOGETHER = QUIET + 2000, 1000, 1 << 17
_RESOLVED = 2.0**-52  # of an epoch
MOST_OF_STACK = MANY >> 3
"""Contacts of an elastic particle at one time that are taken for a stack at rest."""
_REST = "a stack at rest"
_COLLAPSE = "an inelastic collapse, or a stack at rest, which a contact_duration allows"


def check_progress(time: float, spent: float, epoch: float) -> None:
    """Raise SimulationError if `MANY` events, up to `time`, have `spent` less than clocks of such an `epoch`
    can resolve: their order would be rounding only."""
    if spent < MANY * _RESOLVED * epoch:
        raise SimulationError(
            f"at time {time:g} there were {MANY} events within a time of {spent:g}: "
            "particles have no room to move"
        )


def check_events(time: float, quiet: int, flights: float) -> None:
    """Raise SimulationError after too many `quiet` epochs in a row, up to `time`, without an event. flights:
    those through the container in each of them, see `Epochs.flights`."""
    if quiet <= _QUIET or (0.0 < quiet * flights < _FLIGHTS and quiet <= _QUIET_TOGETHER):
        return
    why = "particles move together" if 0.0 < quiet * flights < _FLIGHTS else "particles miss one another"
    raise SimulationError(f"no event up to time {time:g} in {quiet} epochs of the clocks: {why}")


def collapsed(time: float, watch: CollapseWatch) -> SimulationError:
    """The error of a scene in which a particle has too many contacts in too short a time."""
    return SimulationError(
        f"at time {time:g} particle {watch.contacts.argmax()} has had "
        f"{watch.most} contacts within a time of {watch.interval:g}: "
        f"{_REST if watch.most == MOST_OF_STACK else _COLLAPSE}; the state is that of the present time"
    )
