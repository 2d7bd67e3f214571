"""Detection of runs that stall: particles that collide without end at one time, or never."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gaspart.engines.event.clock_epochs import QUIET
from gaspart.errors import SimulationError

if TYPE_CHECKING:
    from gaspart.kernels.event.monitors import CollapseWatch

MANY = 1 << 18
"""Number of events in which time must advance, by more than a clock resolves for each."""
_QUIET = QUIET + 2000  # epochs without an event after which a run without an end is given up
_RESOLVED = 2.0**-52  # of an epoch


def check_progress(time: float, spent: float, epoch: float) -> None:
    """Raise SimulationError if `MANY` events, up to `time`, have `spent` less than clocks of such an `epoch`
    can resolve: their order would be rounding only."""
    if spent < MANY * _RESOLVED * epoch:
        raise SimulationError(
            f"at time {time:g} there were {MANY} events within a time of {spent:g}: "
            "particles have no room to move"
        )


def check_events(time: float, quiet: int) -> None:
    """Raise SimulationError after too many `quiet` epochs in a row, up to `time`, without an event."""
    if quiet > _QUIET:
        raise SimulationError(
            f"no event up to time {time:g} in {quiet} epochs of the clocks: particles miss one another"
        )


def collapsed(time: float, watch: CollapseWatch) -> SimulationError:
    """The error of a scene in which a particle has too many contacts in too short a time."""
    return SimulationError(
        f"at time {time:g} particle {watch.contacts.argmax()} has had "
        f"{watch.most} contacts within a time of {watch.interval:g}: "
        "an inelastic collapse, or a stack at rest; the state is that of the present time"
    )
