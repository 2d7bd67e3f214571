"""Whether all particles of a scene under gravity have come to rest."""

from gaspart.kernels.compilation import inner_helper, kernel
from gaspart.kernels.flight import acceleration_of, advance, flown
from gaspart.kernels.model import LOSS
from gaspart.kernels.running_sum import add

_PAUSE = 4.0  # contact durations: the longest time without a contact of a particle that others support


@inner_helper
def _lies(flights, i, space, gravity):
    """Whether a particle is at rest on faces or interior walls, or fixed."""
    found = True
    for k in range(len(space.lengths)):
        found &= flights[i].velocity[k] == 0.0 and acceleration_of(flights, i, k, space, gravity) == 0.0
    return found


@kernel
def at_rest(flights, before, time, most, model):
    """Whether every particle lies on a wall, or has contacts that last, and none is further than `most` from
    its place `before` (N, d), which becomes its place now."""
    rest, space, gravity, duration = True, model.space, model.gravity, model.law.duration
    for i in range(len(flights)):
        lasts = time - duration.latest[i] < _PAUSE * duration.length
        rest &= lasts or _lies(flights, i, space, gravity)
        square = 0.0
        for k in range(len(space.lengths)):
            pull = acceleration_of(flights, i, k, space, gravity)
            late = time - flights[i].clock
            x = flown(flights[i].position[k], flights[i].velocity[k], pull, late)
            square += (x - before[i, k]) * (x - before[i, k])
            before[i, k] = x
        rest &= square <= most * most
    return rest


@kernel
def stop_all(flights, time, model, tally):
    """Advance all particles to `time` and take their velocities, whose energy is counted as lost."""
    for i in range(len(flights)):
        advance(flights, i, time, model.space, model.gravity)
        square = 0.0
        for k in range(len(model.space.lengths)):
            square += flights[i].velocity[k] * flights[i].velocity[k]
            flights[i].velocity[k] = 0.0
        if square > 0.0:
            add(tally.sums, LOSS, 0.5 * square / model.law.inverse_mass[i])
