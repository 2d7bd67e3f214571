"""Whether time goes on: bodies that touch all around meet for ever in no time."""

from __future__ import annotations

from gaspart.errors import SimulationError

MANY = 1 << 18
"""Events after which time must have gone on, each by more than a clock can tell."""
_TOLD = 2.0**-52  # of a lap


def check_progress(time: float, spent: float, lap: float) -> None:
    """Raise SimulationError if `MANY` events, up to `time`, have `spent` less than clocks of such a `lap` can
    tell: their order would be no more than rounding."""
    if spent < MANY * _TOLD * lap:
        raise SimulationError(
            f"at time {time:g} there were {MANY} events within a time of {spent:g}: "
            "bodies have no room to move"
        )
