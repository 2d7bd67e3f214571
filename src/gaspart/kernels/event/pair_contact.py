"""The contact of two particles in the event-driven engine."""

from gaspart.kernels.compile.policy import inner_helper
from gaspart.kernels.event.impulses import speed_before, tally_impulse
from gaspart.kernels.event.jams import free_if_moved, join_jam, squeezed
from gaspart.kernels.event.pressed_contact import least_parting, part, release_pair
from gaspart.kernels.event.sheared_contact import fold, unfold
from gaspart.kernels.event.sheared_stress import end_flight, tally_contact
from gaspart.kernels.event.stress import note_pair
from gaspart.kernels.model import COLLISIONS, FIXED_COLLISIONS, VIRIAL
from gaspart.kernels.physics.collision import exchange_momentum, gap_along, meets_fixed
from gaspart.kernels.physics.flight import advance
from gaspart.kernels.physics.running_sum import add


@inner_helper
def collide(flights, i, j, time, model, tally):
    """Advance two particles to their contact and exchange momentum."""
    space = model.space
    end_flight(flights, i, time, model, tally.stress, model.shear)
    end_flight(flights, j, time, model, tally.stress, model.shear)
    advance(flights, i, time, space, model.gravity)
    advance(flights, j, time, space, model.gravity)
    image = unfold(flights, i, j, time, space, model.shear)
    rr = 0.0
    rv = 0.0
    for k in range(len(space.lengths)):
        gap = gap_along(flights, i, j, k, space)
        rr += gap * gap
        rv += gap * (flights[j].velocity[k] - flights[i].velocity[k])
    free_if_moved(i, j, rr, rv, model.gravity, model.law)
    joins = squeezed(flights, i, j, model.law)
    note_pair(flights, i, j, space, model.masses, model.law, tally.stress)
    before_i = speed_before(flights, i, tally.impulses)
    before_j = speed_before(flights, j, tally.impulses)
    least = least_parting(flights, i, j, space, model.gravity, model.law)
    add(tally.sums, VIRIAL, exchange_momentum(flights, i, j, rr, rv, model, tally, model.law))
    part(flights, i, j, least, model, tally, model.law)
    release_pair(flights, i, j, model, tally, model.gravity, model.law)
    join_jam(flights, joins, i + j - joins, model, tally, model.gravity, model.law)
    tally_contact(flights, i, j, time, model, tally.stress, model.shear)
    tally_impulse(flights, i, before_i, model, tally.impulses)
    tally_impulse(flights, j, before_j, model, tally.impulses)
    fold(flights, j, image, model, tally, model.shear)
    sigma = flights[i].radius + flights[j].radius
    tally.worst[0] = max(tally.worst[0], abs(rr / (sigma * sigma) - 1.0))
    tally.counts[COLLISIONS] += 1
    tally.counts[FIXED_COLLISIONS] += meets_fixed(i, j, model.law)
