"""What passes between two bodies that touch, or a body and a wall.

Smooth elastic bodies know only their momenta. A `Law` brings restitution, spins and fixed bodies (Spencer
2022, section 2.2); it reckons with three components, of which 2D leaves the unneeded ones 0.
"""

from math import sqrt

from gaspart.contact import exchange, exchange_equal, normal_change, tangential_impulse
from gaspart.coordinates import nearest
from gaspart.engines.flight import advance_row
from gaspart.engines.layout import COLLISIONS, LOSS, VIRIAL
from gaspart.engines.resting import release
from gaspart.engines.running_sum import add
from gaspart.kernel import inner_helper, inner_kernel

LEAST = 2.0**-48  # of the bodies' speed: they part at least so fast, or rounding would let them meet for ever


@inner_helper
def pass_momentum(rows, i, j, rr, rv, space, masses):
    """An elastic contact of smooth bodies. Returns |r . dp|."""
    d = len(space.lengths)
    if masses is None:
        to_i = to_j = exchange_equal(rr, rv)
        virial = abs(rv)
    else:
        to_i, to_j = exchange(rr, rv, masses[i], masses[j])
        virial = masses[i] * abs(to_i) * rr
    for k in range(d):
        gap = nearest(rows[j, k] - rows[i, k], space.lengths[k], space.periodic[k])
        rows[i, d + k] += to_i * gap
        rows[j, d + k] -= to_j * gap
    return virial


@inner_kernel
def gap_along(rows, i, j, axis, space):
    """The separation of two bodies along an axis, 0 along a third one that is not there."""
    if axis >= len(space.lengths):
        return 0.0
    return nearest(rows[j, axis] - rows[i, axis], space.lengths[axis], space.periodic[axis])


@inner_kernel
def speed_along(rows, body, axis, space):
    """The velocity of a body along an axis, 0 along a third one that is not there."""
    return rows[body, len(space.lengths) + axis] if axis < len(space.lengths) else 0.0


@inner_helper
def push(rows, body, x, y, z, space):
    """Add to the velocity of a body."""
    d = len(space.lengths)
    rows[body, d] += x
    rows[body, d + 1] += y
    if d == 3:
        rows[body, d + 2] += z


@inner_helper
def sliding(rows, i, j, x, y, z, space, law):
    """The tangential relative velocity of the surfaces of two bodies (j < 0: of a body and a wall), with
    (x, y, z) the unit vector from the first to the second; Spencer 2022, Eq. 30."""
    d = len(space.lengths)
    radius = rows[i, 2 * d + 1]
    sx, sy, sz = radius * law.spins[i, 0], radius * law.spins[i, 1], radius * law.spins[i, 2]
    gx, gy, gz = (
        speed_along(rows, i, 0, space),
        speed_along(rows, i, 1, space),
        speed_along(rows, i, 2, space),
    )
    if j >= 0:
        radius = rows[j, 2 * d + 1]
        sx += radius * law.spins[j, 0]
        sy += radius * law.spins[j, 1]
        sz += radius * law.spins[j, 2]
        gx -= speed_along(rows, j, 0, space)
        gy -= speed_along(rows, j, 1, space)
        gz -= speed_along(rows, j, 2, space)
    gx += sy * z - sz * y
    gy += sz * x - sx * z
    gz += sx * y - sy * x
    normal = gx * x + gy * y + gz * z
    return gx - normal * x, gy - normal * y, gz - normal * z


@inner_helper
def turn(rows, body, x, y, z, qx, qy, qz, space, law):
    """The spin that an impulse q gives at the surface point in direction (x, y, z); Spencer 2022, Eq. 26."""
    factor = rows[body, 2 * len(space.lengths) + 1] * law.inverse_inertia[body]
    law.spins[body, 0] += factor * (y * qz - z * qy)
    law.spins[body, 1] += factor * (z * qx - x * qz)
    law.spins[body, 2] += factor * (x * qy - y * qx)


@inner_kernel
def swap_with_vibration(i, j, approach, mobility, vibrations):
    """Let the normal energy of two bodies and that of the mode that one of them has change places.

    This keeps the measure v dv dE and is its own inverse in time. Returns the speed at which they part, or -1
    if neither has a mode.
    """
    if vibrations is None:
        return -1.0
    for body in (i, j):
        energy = vibrations[body]
        if energy >= 0.0:
            vibrations[body] = 0.5 * approach * approach / mobility
            return sqrt(2.0 * energy * mobility)
    return -1.0


@inner_kernel
def strike(rows, i, j, rr, rv, space, counters, law):
    """A contact under a law (Spencer 2022, Eq. 39). Returns |r . dp|."""
    d = len(space.lengths)
    mobility_i, mobility_j = law.inverse_mass[i], law.inverse_mass[j]
    mobility = mobility_i + mobility_j
    length = sqrt(rr)
    x = gap_along(rows, i, j, 0, space) / length
    y = gap_along(rows, i, j, 1, space) / length
    z = gap_along(rows, i, j, 2, space) / length
    fastest = 0.0
    for k in range(d):
        fastest = max(fastest, abs(rows[i, d + k]), abs(rows[j, d + k]))
    approach = -rv / length
    parting = swap_with_vibration(i, j, approach, mobility, law.vibrations)
    if parting >= 0.0:
        impulse = (approach + max(parting, LEAST * fastest)) / mobility
    else:
        impulse = normal_change(approach, law.normal, LEAST * fastest) / mobility
    add(counters.sums, LOSS, 0.5 * (1.0 - law.normal * law.normal) * approach * approach / mobility)
    if law.tangential > -1.0:
        gx, gy, gz = sliding(rows, i, j, x, y, z, space, law)
        radius_i, radius_j = rows[i, 2 * d + 1], rows[j, 2 * d + 1]
        lever = radius_i * radius_i * law.inverse_inertia[i] + radius_j * radius_j * law.inverse_inertia[j]
        factor = tangential_impulse(mobility, lever, law.tangential)
        square = gx * gx + gy * gy + gz * gz
        add(counters.sums, LOSS, 0.5 * (1.0 - law.tangential) * factor * square)
        qx, qy, qz = -factor * gx, -factor * gy, -factor * gz
        push(rows, i, mobility_i * qx, mobility_i * qy, mobility_i * qz, space)
        push(rows, j, -mobility_j * qx, -mobility_j * qy, -mobility_j * qz, space)
        turn(rows, i, x, y, z, qx, qy, qz, space, law)
        turn(rows, j, x, y, z, qx, qy, qz, space, law)
    to_i, to_j = -impulse * mobility_i, impulse * mobility_j
    push(rows, i, to_i * x, to_i * y, to_i * z, space)
    push(rows, j, to_j * x, to_j * y, to_j * z, space)
    return impulse * length


@inner_kernel
def strike_wall(rows, body, x, y, z, least, space, counters, law):
    """A contact with a wall in the direction of the unit vector (x, y, z) (Spencer 2022, Eq. 40); the body
    parts from it at `least` so fast. Returns the momentum given to the wall along that direction."""
    d = len(space.lengths)
    mobility = law.inverse_mass[body]
    approach = (
        x * speed_along(rows, body, 0, space)
        + y * speed_along(rows, body, 1, space)
        + z * speed_along(rows, body, 2, space)
    )
    change = normal_change(approach, law.normal, least)
    add(counters.sums, LOSS, 0.5 * (1.0 - law.normal * law.normal) * approach * approach / mobility)
    if law.tangential > -1.0:
        gx, gy, gz = sliding(rows, body, -1, x, y, z, space, law)
        radius = rows[body, 2 * d + 1]
        lever = radius * radius * law.inverse_inertia[body]
        factor = tangential_impulse(mobility, lever, law.tangential)
        square = gx * gx + gy * gy + gz * gz
        add(counters.sums, LOSS, 0.5 * (1.0 - law.tangential) * factor * square)
        qx, qy, qz = -factor * gx, -factor * gy, -factor * gz
        push(rows, body, mobility * qx, mobility * qy, mobility * qz, space)
        turn(rows, body, x, y, z, qx, qy, qz, space, law)
    push(rows, body, -change * x, -change * y, -change * z, space)
    return change / mobility


@inner_kernel
def crowded(watch, body, time):
    """Note a contact of a body with another. True if it has had too many of them in no time."""
    if time - watch.since[body] > watch.blink:
        watch.since[body] = time
        watch.contacts[body] = 0
    watch.contacts[body] += 1
    return watch.contacts[body] > watch.most


@inner_helper
def collide(rows, i, j, time, space, masses, counters, gravity, law):
    """Advance two bodies to their contact and pass the momentum."""
    d = len(space.lengths)
    advance_row(rows, i, time, space, gravity)
    advance_row(rows, j, time, space, gravity)
    rr = 0.0
    rv = 0.0
    for k in range(d):
        gap = nearest(rows[j, k] - rows[i, k], space.lengths[k], space.periodic[k])
        rr += gap * gap
        rv += gap * (rows[j, d + k] - rows[i, d + k])
    if law is not None:
        add(counters.sums, VIRIAL, strike(rows, i, j, rr, rv, space, counters, law))
    else:
        add(counters.sums, VIRIAL, pass_momentum(rows, i, j, rr, rv, space, masses))
    if gravity is not None:
        release(rows, i, space, gravity.support)
        release(rows, j, space, gravity.support)
    sigma = rows[i, 2 * d + 1] + rows[j, 2 * d + 1]
    counters.worst[0] = max(counters.worst[0], abs(rr / (sigma * sigma) - 1.0))
    counters.counts[COLLISIONS] += 1
