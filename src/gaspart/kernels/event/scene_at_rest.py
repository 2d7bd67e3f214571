"""Which particles of a scene under gravity have come to rest."""

from gaspart.kernels.compile.policy import inner_helper, inner_kernel, kernel
from gaspart.kernels.model import LOSS
from gaspart.kernels.physics.flight import acceleration_of, advance, flown
from gaspart.kernels.physics.running_sum import add

TOUCHES, MOVES, RESTS = range(3)  # what `find_resting` marks
_PAUSE = 4.0  # contact durations: the longest time without a contact of a particle that others support


@inner_helper
def _lies(flights, i, space, gravity):
    """Whether a particle is at rest on faces or interior walls, or fixed."""
    found = True
    for k in range(len(space.lengths)):
        found &= flights[i].velocity[k] == 0.0 and acceleration_of(flights, i, k, space, gravity) == 0.0
    return found


@kernel
def find_resting(flights, before, time, most, model, marks):
    """Mark (3, N) which particles touch, by contacts that last; which move: they are further than `most` from
    their places `before` (N, d), which become the places now; and which rest: those that do not move, and
    touch or lie on a wall."""
    space, gravity, duration = model.space, model.gravity, model.law.duration
    for i in range(len(flights)):
        marks[TOUCHES, i] = time - duration.latest[i] < _PAUSE * duration.length
        square = 0.0
        for k in range(len(space.lengths)):
            pull = acceleration_of(flights, i, k, space, gravity)
            late = time - flights[i].clock
            x = flown(flights[i].position[k], flights[i].velocity[k], pull, late)
            square += (x - before[i, k]) * (x - before[i, k])
            before[i, k] = x
        marks[MOVES, i] = square > most * most
        stays = marks[TOUCHES, i] or _lies(flights, i, space, gravity)
        marks[RESTS, i] = stays and not marks[MOVES, i]


@inner_kernel
def stop(flights, i, time, model, tally):
    """Advance a particle to `time` and take its velocity, whose energy is counted as lost."""
    advance(flights, i, time, model.space, model.gravity)
    square = 0.0
    for k in range(len(model.space.lengths)):
        square += flights[i].velocity[k] * flights[i].velocity[k]
        flights[i].velocity[k] = 0.0
    if square > 0.0:
        add(tally.sums, LOSS, 0.5 * square / model.law.inverse_mass[i])


@kernel
def stop_all(flights, time, model, tally):
    """Stop every particle."""
    for i in range(len(flights)):
        stop(flights, i, time, model, tally)
