"""Transfer of momentum between two touching particles, or between a particle and a wall.

Smooth elastic particles exchange only momentum. A `ContactLaw` adds restitution, spins and fixed particles
(Spencer 2022, section 2.2). Its vectors have three components. In two dimensions the third component of a
velocity and the first two components of a spin are 0.
"""

from math import sqrt

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.model import LOSS
from gaspart.kernels.physics.contact import (
    exchange,
    exchange_equal,
    keep,
    normal_change,
    normal_restitution,
    restitution_at_wall,
    restitution_of_pair,
    tangential_impulse,
)
from gaspart.kernels.physics.periodic import nearest
from gaspart.kernels.physics.running_sum import add

LEAST = 2.0**-48  # minimum separation speed / speed: less would let rounding repeat the collision forever


@inner_helper
def gap_along(flights, i, j, axis, space):
    """Return the separation along an axis, for the nearest image; 0 along a third axis in 2D."""
    if axis >= len(space.lengths):
        return 0.0
    gap = flights[j].position[axis] - flights[i].position[axis]
    return nearest(gap, space.lengths[axis], space.periodic[axis])


@inner_helper
def speed_along(flights, i, axis, space):
    """Return a particle's velocity along an axis; 0 along a third axis in two dimensions."""
    return flights[i].velocity[axis] if axis < len(space.lengths) else 0.0


@inner_helper
def velocity_of(flights, i, space):
    """Return the velocity (3,) of a particle."""
    return (
        speed_along(flights, i, 0, space),
        speed_along(flights, i, 1, space),
        speed_along(flights, i, 2, space),
    )


@inner_helper
def push(flights, i, factor, vector, space):
    """Add factor * vector (3,) to the velocity of a particle."""
    for k in range(len(space.lengths)):
        flights[i].velocity[k] += factor * vector[k]


@inner_helper
def fastest_component(flights, i, space):
    """Return the largest component of a particle's velocity."""
    fastest = 0.0
    for k in range(len(space.lengths)):
        fastest = max(fastest, abs(flights[i].velocity[k]))
    return fastest


@inner_helper
def least_speed(flights, i, space):
    """Return the minimum separation speed of a particle from a wall. This speed is the speed of the particle
    multiplied by the rounding error of the direction to the wall. The error of the direction is the rounding
    error of positions divided by the radius. With a lower separation speed the particle would hit the wall
    forever.
    """
    longest = flights[i].radius
    for k in range(len(space.lengths)):
        longest = max(longest, space.lengths[k])
    return LEAST * fastest_component(flights, i, space) * (longest / flights[i].radius)


@inner_helper
def collide_smooth(flights, i, j, rr, rv, space, masses):
    """Apply an elastic collision to two smooth particles; return |r . dp|."""
    if masses is None:
        to_i = to_j = exchange_equal(rr, rv)
        virial = abs(rv)
    else:
        to_i, to_j = exchange(rr, rv, masses[i], masses[j])
        virial = masses[i] * abs(to_i) * rr
    for k in range(len(space.lengths)):
        gap = gap_along(flights, i, j, k, space)
        flights[i].velocity[k] += to_i * gap
        flights[j].velocity[k] -= to_j * gap
    return virial


@inner_helper
def spin_of(flights, i, law):
    """Return the spin (3,) of a particle multiplied by its radius."""
    radius = flights[i].radius
    return radius * law.spins[i, 0], radius * law.spins[i, 1], radius * law.spins[i, 2]


@inner_helper
def slip(velocity, spin, normal):
    """Return the tangential relative velocity (3,) of two surfaces (Spencer 2022, Eq. 30). `velocity`:
    relative velocity of the centres. `spin`: sum of the spins multiplied by the radii. `normal`: unit vector
    from the first to the second.
    """
    x, y, z = normal
    gx = velocity[0] + (spin[1] * z - spin[2] * y)
    gy = velocity[1] + (spin[2] * x - spin[0] * z)
    gz = velocity[2] + (spin[0] * y - spin[1] * x)
    along = gx * x + gy * y + gz * z
    return gx - along * x, gy - along * y, gz - along * z


@inner_helper
def lose(approach, mobility, normal, usual, law, tally):
    """Count the energy dissipated by the normal part of a collision with this restitution. The additional
    energy that the `usual` restitution would have dissipated is counted separately.
    """
    add(tally.sums, LOSS, 0.5 * (1.0 - normal * normal) * approach * approach / mobility)
    keep(0.5 * (normal * normal - usual * usual) * approach * approach / mobility, law.duration)


@inner_helper
def rub(velocity, mobility, lever, tangential, law, tally):
    """Return the tangential impulse (3,) on the first of two surfaces, and count its energy. `velocity`:
    (3,), tangential relative velocity. `mobility` and `lever` and `tangential`: see
    `contact.tangential_impulse`.
    """
    factor = tangential_impulse(mobility, lever, tangential)
    gx, gy, gz = velocity
    square = gx * gx + gy * gy + gz * gz
    lost = 0.5 * (1.0 - tangential) * factor * square
    add(tally.sums, LOSS, lost)
    usual = 0.5 * (1.0 - law.tangential) * tangential_impulse(mobility, lever, law.tangential) * square
    keep(usual - lost, law.duration)
    return -factor * gx, -factor * gy, -factor * gz


@inner_helper
def add_spin(flights, i, normal, impulse, law):
    """Add the spin due to an impulse (3,) at a surface point (Spencer 2022, Eq. 26). `normal`: unit vector
    towards the surface point.
    """
    factor = flights[i].radius * law.inverse_inertia[i]
    law.spins[i, 0] += factor * (normal[1] * impulse[2] - normal[2] * impulse[1])
    law.spins[i, 1] += factor * (normal[2] * impulse[0] - normal[0] * impulse[2])
    law.spins[i, 2] += factor * (normal[0] * impulse[1] - normal[1] * impulse[0])


@inner_kernel
def exchange_with_vibration(i, j, approach, mobility, vibrations):
    """Exchange the normal energy of two particles with the energy of a vibrational mode. The mode belongs to
    one of the particles. The exchange conserves the measure v dv dE, where v is the normal speed and E the
    vibrational energy, and is reversible in time. Returns the separation speed, or -1 if neither particle has
    a mode.
    """
    if vibrations is None:
        return -1.0
    for particle in (i, j):
        energy = vibrations[particle]
        if energy >= 0.0:
            vibrations[particle] = 0.5 * approach * approach / mobility
            return sqrt(2.0 * energy * mobility)
    return -1.0


@inner_kernel
def collide_by_law(flights, i, j, rr, rv, space, tally, law):
    """Apply the law of rough or inelastic particles (Spencer 2022, Eq. 39); return |r . dp|."""
    mobility_i, mobility_j = law.inverse_mass[i], law.inverse_mass[j]
    mobility = mobility_i + mobility_j
    length = sqrt(rr)
    normal = (
        gap_along(flights, i, j, 0, space) / length,
        gap_along(flights, i, j, 1, space) / length,
        gap_along(flights, i, j, 2, space) / length,
    )
    least = LEAST * max(fastest_component(flights, i, space), fastest_component(flights, j, space))
    approach = -rv / length
    radius_i, radius_j = flights[i].radius, flights[j].radius
    radius = radius_i * radius_j / (radius_i + radius_j)
    usual = normal_restitution(approach, radius, mobility, law.normal, law.viscous)
    normal_part, tangential_part = restitution_of_pair(flights, i, j, usual, law, law.duration)
    parting = exchange_with_vibration(i, j, approach, mobility, law.vibrations)
    if parting >= 0.0:
        impulse = (approach + max(parting, least)) / mobility
    else:
        impulse = normal_change(approach, normal_part, least) / mobility
    lose(approach, mobility, normal_part, usual, law, tally)
    if law.tangential > -1.0:
        a, b = velocity_of(flights, i, space), velocity_of(flights, j, space)
        s, t = spin_of(flights, i, law), spin_of(flights, j, law)
        velocity = (a[0] - b[0], a[1] - b[1], a[2] - b[2])
        sliding = slip(velocity, (s[0] + t[0], s[1] + t[1], s[2] + t[2]), normal)
        lever = radius_i * radius_i * law.inverse_inertia[i] + radius_j * radius_j * law.inverse_inertia[j]
        friction = rub(sliding, mobility, lever, tangential_part, law, tally)
        push(flights, i, mobility_i, friction, space)
        push(flights, j, -mobility_j, friction, space)
        add_spin(flights, i, normal, friction, law)
        add_spin(flights, j, normal, friction, law)
    push(flights, i, -impulse * mobility_i, normal, space)
    push(flights, j, impulse * mobility_j, normal, space)
    return impulse * length


@inner_kernel
def collide_wall_by_law(flights, i, normal, least, space, tally, law):
    """Apply the collision law to a particle at a wall (Spencer 2022, Eq. 40). Returns the momentum given to
    the wall along the normal. `normal`: (3,), unit vector towards the wall. `least`: minimum separation
    speed.
    """
    mobility = law.inverse_mass[i]
    velocity = velocity_of(flights, i, space)
    approach = normal[0] * velocity[0] + normal[1] * velocity[1] + normal[2] * velocity[2]
    radius = flights[i].radius
    usual = normal_restitution(approach, radius, mobility, law.normal, law.viscous)
    normal_part, tangential_part = restitution_at_wall(flights, i, usual, law, law.duration)
    change = normal_change(approach, normal_part, least)
    lose(approach, mobility, normal_part, usual, law, tally)
    if law.tangential > -1.0:
        lever = radius * radius * law.inverse_inertia[i]
        sliding = slip(velocity, spin_of(flights, i, law), normal)
        friction = rub(sliding, mobility, lever, tangential_part, law, tally)
        push(flights, i, mobility, friction, space)
        add_spin(flights, i, normal, friction, law)
    push(flights, i, -change, normal, space)
    return change / mobility


@inner_helper
def is_fixed(i, law, duration):
    """Return True if a particle is fixed, not by a jam alone."""
    if duration is not None:
        return duration.inverse_mass[i] == 0.0
    return law.inverse_mass[i] == 0.0


@inner_helper
def meets_fixed(i, j, law):
    """Return 1 if one of two particles is fixed, otherwise 0."""
    if law is None:
        return 0
    return 1 if is_fixed(i, law, law.duration) or is_fixed(j, law, law.duration) else 0


@inner_helper
def exchange_momentum(flights, i, j, rr, rv, model, tally, law):
    """Apply the collision law, or an elastic collision, to a pair in contact; return |r . dp|."""
    if law is None:
        return collide_smooth(flights, i, j, rr, rv, model.space, model.masses)
    return collide_by_law(flights, i, j, rr, rv, model.space, tally, law)
