"""Detection of stalled time: particles in contact on all sides collide without end at one time."""

from __future__ import annotations

from gaspart.errors import SimulationError

MANY = 1 << 18
"""Number of events in which time must advance, by more than a clock resolves for each."""
_RESOLVED = 2.0**-52  # of an epoch


def check_progress(time: float, spent: float, epoch: float) -> None:
    """Raise SimulationError if `MANY` events, up to `time`, have `spent` less than clocks of such an `epoch`
    can resolve: their order would be rounding only."""
    if spent < MANY * _RESOLVED * epoch:
        raise SimulationError(
            f"at time {time:g} there were {MANY} events within a time of {spent:g}: "
            "particles have no room to move"
        )
