"""Contacts that last: dissipation at most once in a contact duration.

Hard particles that lose energy meet infinitely often in a finite time, and a pile at rest has contacts all
the time. In the TC model (Luding & McNamara, Granular Matter 1, 113 (1998)) a contact dissipates only if both
particles have had no other for a time t_c, the duration of a contact of real particles; otherwise it is
elastic. Contacts with walls count as well; a fixed particle is a wall.

Elastic here means: normal restitution 1, and no friction, not even of perfectly rough particles, which would
lose nothing: in a corner those exchange spin and velocity for ever, without leaving it (no-slip billiards).
"""

from gaspart.kernels.compile.policy import inner_helper
from gaspart.kernels.physics.running_sum import add

SHORTEST = 2.0**-7
"""Of the contact duration: the shortest time between contacts of particles that are pressed together."""


@inner_helper
def _elastic(duration):
    """Count an elastic contact. Returns its (normal, tangential) restitution."""
    duration.elastic[0] += 1
    return 1.0, -1.0


@inner_helper
def restitution_of_pair(flights, i, j, normal, law, duration):
    """The (normal, tangential) restitution of a contact of two particles that have been advanced to it.

    normal: what the law alone gives.
    """
    if duration is not None:
        time = flights[i].clock
        lasts = jammed = False
        for particle in (i, j):
            if duration.inverse_mass[particle] > 0.0:
                jammed |= law.inverse_mass[particle] == 0.0
                lasts |= time - duration.latest[particle] < duration.length
                duration.latest[particle] = time
            duration.met[particle] = time
            duration.contacts[particle] += 1
        if lasts and not jammed:
            return _elastic(duration)
    return normal, law.tangential


@inner_helper
def restitution_at_wall(flights, i, normal, law, duration):
    """The same of a particle and a wall."""
    if duration is not None:
        time = flights[i].clock
        lasts = time - duration.latest[i] < duration.length
        duration.latest[i] = time
        duration.contacts[i] += 1
        if lasts:
            return _elastic(duration)
    return normal, law.tangential


@inner_helper
def keep(energy, duration):
    """Add an energy that a contact would have dissipated, if it had not been elastic."""
    if duration is not None:
        add(duration.kept, 0, energy)


@inner_helper
def meet_often(flights, i, j, duration):
    """Whether two particles, advanced to the present time, have both had contacts far more often than any
    that gravity alone presses together."""
    late = flights[i].clock - min(duration.latest[i], duration.latest[j])
    return late < SHORTEST * SHORTEST * duration.length


@inner_helper
def is_alone(flights, i, duration):
    """Whether a particle, advanced to the present time, has met no other for the duration of a contact."""
    return flights[i].clock - duration.met[i] >= duration.length
