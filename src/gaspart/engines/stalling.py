"""Whether time advances: particles that touch all around meet for ever in no time."""

from __future__ import annotations

from gaspart.errors import SimulationError

MANY = 1 << 18
"""Events after which time must have gone on, each by more than a clock can resolve."""
_RESOLVED = 2.0**-52  # of an epoch


def check_progress(time: float, spent: float, epoch: float) -> None:
    """Raise SimulationError if `MANY` events, up to `time`, have `spent` less than clocks of such an `epoch`
    can resolve: their order would be rounding only."""
    if spent < MANY * _RESOLVED * epoch:
        raise SimulationError(
            f"at time {time:g} there were {MANY} events within a time of {spent:g}: "
            "bodies have no room to move"
        )
