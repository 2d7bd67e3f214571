"""Physics of one contact: the time at which two particles touch, and the transferred momentum.

The engines use these functions. The functions use the invariants rr = r.r, rv = r.v, vv = v.v
and ss = sigma^2. r and v are the separation and the relative velocity of two particles (second minus first),
and sigma is the distance of the centres at contact. So they do not depend on the dimension, the container or
the engine. The arithmetic keeps the type of its arguments (float32 remains float32), so 2x is written as x +
x.
"""

from __future__ import annotations

from math import frexp, inf, ldexp, sqrt

from gaspart.kernels.compile.policy import helper, inner_helper
from gaspart.kernels.physics.running_sum import add


@helper
def contact_root(rr, rv, vv, ss):
    """Return the time of first touch for a pair on a collision course (rv < 0). This is the smaller root of
    vv t^2 + 2 rv t + (rr - ss) = 0, in the form without cancellation t = c/(-b + sqrt(b^2 - ac)) (from
    Spencer 2022, Eq. 19; Eq. 21 as printed is half of it). For a pair that already overlaps, the root is
    negative: its absolute value is the time since the pair touched, by which the time-stepped engine moves
    the pair back.
    """
    c = rr - ss
    return c / (sqrt(rv * rv - vv * c) - rv)


@helper
def time_to_contact(rr, rv, vv, ss):
    """Return the time until a pair touches; inf if it never does. For a pair that touches or overlaps, and
    approaches, the result is 0. Such a pair must collide immediately, because overlap due to rounding must
    never grow (Bannerman, Strobl, Formella & Poeschel, Comput. Part. Mech. 1, 191 (2014)).
    """
    c = rr - ss
    if not ((rv < 0.0) & (rv * rv >= vv * c)):  # a single branch, which is nearly always taken
        return inf
    if c <= 0.0:
        return 0.0
    return contact_root(rr, rv, vv, ss)


TINY = 1e-10
"""Squared contact distance, relative to the squared separation, below which rr - ss loses digits of ss."""


@helper
def time_to_tiny_contact(rr, rv, vv, ss, cross):
    """Return the time until an approaching pair that is tiny beside its distance touches; inf if it does not.

    The discriminant rv^2 - vv (rr - ss) would be rounding alone below a contact distance of 1e-8 rr^(1/2), so
    it is computed as ss vv - |r x v|^2. `cross`: |r x v|^2.
    """
    square = ss * vv - cross
    return (rr - ss) / (sqrt(square) - rv) if square >= 0.0 else inf


@helper
def exchange_equal(rr, rv):
    """Return the factor k of an elastic contact of equal masses. The velocities change by v1 += k r, v2 -= k
    r. The factor is computed with the true r.r instead of sigma^2, so that the energy is conserved in spite
    of the error of the contact.
    """
    return rv / rr


@helper
def exchange(rr, rv, mass1, mass2):
    """Return the factors k1, k2 of an elastic contact. The velocities change by v1 += k1 r, v2 -= k2 r. This
    is Spencer 2022, Eq. 39, for smooth particles, written with 2 m2/(m1 + m2), so that no mass is lost for
    any mass ratio.
    """
    k = rv / rr
    total = mass1 + mass2
    return (mass2 + mass2) / total * k, (mass1 + mass1) / total * k


@inner_helper
def normal_change(approach, restitution, least):
    """Return the change of the normal relative velocity in a collision. The collision changes the normal
    velocity from `approach` to -restitution * approach (Spencer 2022, Eq. 35), or to -least if this is a
    higher separation speed.
    """
    return approach + max(restitution * approach, least)


@inner_helper
def tangential_impulse(inverse_mass, lever, restitution):
    """Return the impulse divided by the tangential relative velocity (Spencer 2022, Eq. 38). `inverse_mass`:
    1/m1 + 1/m2, with 0 for a fixed particle or wall. `lever`: R1^2/I1 + R2^2/I2, with 0 for a fixed particle
    or wall.
    """
    return (1.0 + restitution) / (inverse_mass + lever)


@inner_helper
def time_to_plane(x, v, plane):
    """Return the time at which a coordinate x reaches `plane` (Spencer 2022, Eqs. 10 and 13). `v`: velocity,
    not 0.
    """
    return (plane - x) / v


@helper
def time_to_growing_contact(rr, rv, vv, sigma, rate):
    """Return the time until two growing particles touch; inf if they never do. The distance at contact is
    sigma + rate t. The result is the first root of a t^2 + 2 b t + c, a = vv - rate^2, in the form without
    cancellation (Lubachevsky & Stillinger, J. Stat. Phys. 60, 561 (1990)). It is 0 for a pair that touches or
    overlaps, and approaches.
    """
    a = vv - rate * rate
    b = rv - sigma * rate
    c = rr - sigma * sigma
    if c <= 0.0 and b < 0.0:
        return 0.0
    square = b * b - a * c
    if square < 0.0 or (a >= 0.0 and b >= 0.0):
        return inf
    if b < 0.0:
        return c / (sqrt(square) - b)
    return (sqrt(square) + b) / -a


# Restitution of viscoelastic particles, which decreases with the speed of approach.
#
# The elastic and viscous forces of spheres in contact (Brilliantov, Spahn, Hertzsch and Poeschel, Phys. Rev.
# E 53, 5382 (1996)) depend on a single number, the damping b. With scaled lengths and times, x'' + b sqrt(x)
# x' + x^(3/2) = 0 from x = 0, x' = 1 until the force vanishes. The damping is proportional to the fifth root
# of the speed. The restitution is computed with the approximant of Mueller and Poeschel, Phys. Rev. E 84,
# 021302 (2011), whose error is below 0.009 (tested).


_ABOVE = 0.501086
_BELOW = (0.501086, 1.15345, 0.577977, 0.532178)
_STEPS = 6  # number of steps of Newton's method to reach rounding errors


@helper
def fifth_root(value):
    """Compute the fifth root of a number >= 0, to 4e-16, with the same bits on every machine."""
    if not value > 0.0:
        return 0.0
    fraction, exponent = frexp(value)
    tenfold = (exponent + 5000) // 5 - 1000
    rest = ldexp(fraction, exponent - 5 * tenfold)  # from 0.5 to 16
    root = 0.9 + 0.06 * rest
    for _ in range(_STEPS):
        fourth = root * root * root * root
        root += 0.2 * (rest / fourth - root)
    return ldexp(root, tenfold)


@helper
def restitution_of(damping):
    """Return the coefficient of normal restitution; it decreases from 1 (no damping) to 0."""
    w = sqrt(damping)
    below = 1.0 + w * (_BELOW[0] + w * (_BELOW[1] + w * (_BELOW[2] + w * _BELOW[3])))
    return (1.0 + _ABOVE * w) / below


@inner_helper
def normal_restitution(approach, radius, mobility, normal, viscous):
    """Return the normal restitution of a contact, constant or viscoelastic. `normal`: constant restitution,
    which is returned if `viscous` equals None. `radius`: product of the two radii divided by their sum, or
    the radius of a particle at a wall. `mobility`: sum of the inverse masses.
    """
    if viscous is None:
        return normal
    return restitution_of(viscous * fifth_root(max(approach, 0.0) * radius * mobility * mobility))


# Lasting contacts: dissipation occurs at most once per contact duration.
#
# Hard particles that lose energy collide infinitely often in a finite time, and a pile at rest has contacts
# all the time. In the TC model (Luding & McNamara, Granular Matter 1, 113 (1998)) a contact dissipates only
# if neither particle has had another contact for a time t_c, the contact duration of real particles.
# Otherwise the contact is elastic. Contacts with walls also count; a fixed particle counts as a wall.
#
# Elastic means a normal restitution of 1 and no friction, even for perfectly rough particles, which would not
# lose energy. In a corner such particles would exchange spin and velocity forever without leaving it (no-slip
# billiards).


SHORTEST = 2.0**-7
"""Minimum time between contacts of particles that are pressed together, as a fraction of the contact
duration.
"""


@inner_helper
def _elastic(duration):
    """Count an elastic contact; return its (normal, tangential) restitution."""
    duration.elastic[0] += 1
    return 1.0, -1.0


@inner_helper
def restitution_of_pair(flights, i, j, normal, law, duration):
    """Return the (normal, tangential) restitution of a contact of two particles. The particles have been
    advanced to the contact. `normal`: restitution from the law alone.
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
    """Return the (normal, tangential) restitution at a wall; `restitution_of_pair` has the arguments."""
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
    """Add an energy that a contact would have dissipated if it had not been elastic."""
    if duration is not None:
        add(duration.kept, 0, energy)


@inner_helper
def meet_often(flights, i, j, duration):
    """Return True if contacts of both particles are far more frequent than under gravity alone. The particles
    have been advanced to the present time. Gravity alone may press particles together.
    """
    late = flights[i].clock - min(duration.latest[i], duration.latest[j])
    return late < SHORTEST * SHORTEST * duration.length


@inner_helper
def is_alone(flights, i, duration):
    """Return True if a particle, at the present time, touched none for the contact duration."""
    return flights[i].clock - duration.met[i] >= duration.length
