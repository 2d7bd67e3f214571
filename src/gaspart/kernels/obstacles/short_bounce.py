"""Bounces that are shorter than the duration of a contact: the particle comes to rest.

The contact of a single particle with a floor then never ends. A particle that others press against it rests
only after much shorter bounces: otherwise it would take the energy of contacts that are elastic.
"""

from gaspart.kernels.compile.policy import inner_helper
from gaspart.kernels.model import LOSS
from gaspart.kernels.physics.contact_duration import SHORTEST, is_alone
from gaspart.kernels.physics.running_sum import add


@inner_helper
def longest_rest(flights, i, gravity, law):
    """Of a particle at a wall, the longest bounce, as half its time, that is taken for rest."""
    if law is not None:
        return _longest_rest(flights, i, gravity, law.duration)
    return gravity.shortest_bounce


@inner_helper
def _longest_rest(flights, i, gravity, duration):
    if duration is not None:
        part = 1.0 if is_alone(flights, i, duration) else SHORTEST
        return max(gravity.shortest_bounce, 0.5 * part * duration.length)
    return gravity.shortest_bounce


@inner_helper
def rest_on_floor(flights, i, face, tally, gravity, law):
    """Let a particle that has bounced on a face which is a floor rest there, if the bounce is so short."""
    if law is not None:
        _rest_on_floor(flights, i, face, tally, gravity, law, law.duration)


@inner_helper
def _rest_on_floor(flights, i, face, tally, gravity, law, duration):
    if duration is not None:
        axis = face // 2
        pull = gravity.acceleration[axis]
        toward = pull if face % 2 else -pull
        speed = flights[i].velocity[axis]
        if toward > 0.0 and abs(speed) < toward * _longest_rest(flights, i, gravity, duration):
            add(tally.sums, LOSS, 0.5 * speed * speed / law.inverse_mass[i])
            flights[i].velocity[axis] = 0.0
