"""Detection of runs that stall: particles that collide without end at one time, or never."""

from __future__ import annotations

import numpy as np

from gaspart.engines.event.clock_epochs import QUIET
from gaspart.engines.features.part import Part
from gaspart.errors import SimulationError
from gaspart.kernels.event.monitors import CollapseWatch
from gaspart.kernels.model import Model

MANY = 1 << 18
"""Number of events in which time must advance, by more than a clock resolves for each."""
# A run without an end is given up after so many epochs without an event, and as many flights through the
# container; or, where particles move so evenly together that these take longer, after more epochs.
_QUIET, _FLIGHTS, _QUIET_TOGETHER = QUIET + 2000, 1000, 1 << 17
_RESOLVED = 2.0**-52  # of an epoch
# More contacts of one particle than these, within so much of an epoch, are taken for a collapse. Where the
# restitution is constant, intervals between contacts shrink geometrically until rounding lets the particles
# part, so few of them can be seen. Slow contacts of viscoelastic particles are nearly elastic.
_MOST, _INTERVAL = 1000, 2.0**-44
_INELASTIC_MOST, _INELASTIC_INTERVAL = 12, 2.0**-34
_MOST_OF_STACK = MANY >> 3  # contacts of an elastic particle at one time that are taken for a stack at rest
# Elastic particles do not collapse: between two surfaces that meet at an angle a, one of them has pi/a
# contacts at one time. Gravity lets them touch for ever in a stack.
_UNLIMITED = np.iinfo(np.int64).max
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


def check_clocks(start: float, epoch: float) -> None:
    """Raise SimulationError if an `epoch` is so short that the time `start` does not resolve it."""
    if start + epoch == start:
        raise SimulationError(
            f"at time {start:g} particles are so fast that {epoch:g} of time holds a thousand flights over a "
            "diameter: less than such a time resolves"
        )


def check_events(time: float, quiet: int, flights: float) -> None:
    """Raise SimulationError after too many `quiet` epochs in a row, up to `time`, without an event. flights:
    those through the container in each of them, see `Epochs.flights`."""
    if quiet <= _QUIET or (0.0 < quiet * flights < _FLIGHTS and quiet <= _QUIET_TOGETHER):
        return
    why = "particles move together" if 0.0 < quiet * flights < _FLIGHTS else "particles miss one another"
    raise SimulationError(f"no event up to time {time:g} in {quiet} epochs of the clocks: {why}")


class CollapsePart(Part):
    """Detection of a collapse of `count` particles. watch: what the kernels count; None where none is
    possible."""

    def __init__(self, model: Model, count: int) -> None:
        law = model.law
        most, self._interval = _MOST, _INTERVAL
        if law and law.normal < 1.0 and law.viscous is None and not law.duration:
            most, self._interval = _INELASTIC_MOST, _INELASTIC_INTERVAL
        elif law is None or (law.normal == 1.0 and abs(law.tangential) == 1.0 and law.vibrations is None):
            most = _MOST_OF_STACK if model.gravity else _UNLIMITED
        self.watch: CollapseWatch | None = None
        if not (law or model.gravity):
            super().__init__({})
            return
        since, contacts = np.full(count, -np.inf), np.zeros(count, dtype=np.int64)
        super().__init__({"contacts_since": since, "contacts": contacts}, times=(since,))
        self.watch = CollapseWatch(since, contacts, 0.0, most)

    def begin_epoch(self, length: float, start: float, model: Model) -> Model:
        """Set the time in which so many contacts are a collapse."""
        self.watch = self.watch and self.watch._replace(interval=self._interval * length)
        return model

    def error(self, time: float) -> SimulationError:
        """The error of a scene in which a particle has had too many contacts, up to `time`."""
        watch = self.watch
        assert watch is not None  # or the kernels would have seen none
        return SimulationError(
            f"at time {time:g} particle {watch.contacts.argmax()} has had "
            f"{watch.most} contacts within a time of {watch.interval:g}: "
            f"{_REST if watch.most == _MOST_OF_STACK else _COLLAPSE}; the state is that of the present time"
        )
