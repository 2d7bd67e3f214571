"""The physics of one contact: when do two particles touch, and what momentum passes.

Both engines use these functions and no others. With r and v the separation and relative velocity of two
particles (second minus first), they work on the invariants rr = r.r, rv = r.v, vv = v.v and ss = sigma^2,
sigma the distance of the centres at contact; so they know no dimension, no container and no engine.
The arithmetic keeps the type of its arguments (float32 stays float32): hence x + x for 2x.
"""

from __future__ import annotations

from math import frexp, inf, ldexp, sqrt

from gaspart.kernels.compile.policy import helper, inner_helper
from gaspart.kernels.physics.running_sum import add


@helper
def contact_root(rr, rv, vv, ss):
    """Time of first touch of an approaching pair (rv < 0) on a collision course.

    The smaller root of vv t^2 + 2 rv t + (rr - ss) = 0, in the form without cancellation
    t = c/(-b + sqrt(b^2 - ac)) (Spencer 2022, Eq. 21). Negative for a pair that overlaps already: the
    touch then lies that long in the past, which is what the time-stepped engine rewinds by.
    """
    c = rr - ss
    return c / (sqrt(rv * rv - vv * c) - rv)


@helper
def time_to_contact(rr, rv, vv, ss):
    """Time until a pair touches; 0 if it touches or overlaps and approaches; inf if it never does.

    Overlap that rounding has left is never allowed to grow: a touching, approaching pair collides now
    (Bannerman, Strobl, Formella & Poeschel, Comput. Part. Mech. 1, 191 (2014)).
    """
    c = rr - ss
    if not ((rv < 0.0) & (rv * rv >= vv * c)):  # one branch, nearly always taken
        return inf
    if c <= 0.0:
        return 0.0
    return contact_root(rr, rv, vv, ss)


@helper
def exchange_equal(rr, rv):
    """The factor k of an elastic contact of equal masses: v1 += k r, v2 -= k r.

    Taken with the true r.r, not sigma^2, so that the energy does not depend on the contact's error.
    """
    return rv / rr


@helper
def exchange(rr, rv, mass1, mass2):
    """The factors k1, k2 of an elastic contact: v1 += k1 r, v2 -= k2 r (Spencer 2022, Eq. 39, smooth).

    Written with 2 m2/(m1 + m2), in which no mass is lost however large the ratio.
    """
    k = rv / rr
    total = mass1 + mass2
    return (mass2 + mass2) / total * k, (mass1 + mass1) / total * k


@inner_helper
def normal_change(approach, restitution, least):
    """By how much a contact changes the normal relative velocity: `approach` becomes -restitution * approach
    (Spencer 2022, Eq. 35), or -least, whichever parts the two faster."""
    return approach + max(restitution * approach, least)


@inner_helper
def tangential_impulse(inverse_mass, lever, restitution):
    """Impulse per tangential relative velocity of the surfaces (Spencer 2022, Eq. 38).

    inverse_mass: 1/m1 + 1/m2; lever: R1^2/I1 + R2^2/I2; 0 for what is fixed.
    """
    return (1.0 + restitution) / (inverse_mass + lever)


@inner_helper
def time_to_plane(x, v, plane):
    """Time at which a coordinate x, moving at v != 0, reaches `plane` (Spencer 2022, Eqs. 10 and 13)."""
    return (plane - x) / v


@helper
def time_to_growing_contact(rr, rv, vv, sigma, rate):
    """Time until a pair touches whose distance at contact grows, sigma + rate t; inf if it never does.

    The first root of a t^2 + 2 b t + c, a = vv - rate^2, in the form that does not cancel (Lubachevsky &
    Stillinger, J. Stat. Phys. 60, 561 (1990)); 0 for a pair that touches or overlaps, and approaches.
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


# Restitution of viscoelastic particles, which falls with the speed of approach.
#
# Elastic and viscous forces of spheres in contact (Brilliantov, Spahn, Hertzsch and Poeschel, Phys. Rev. E
# 53, 5382 (1996)) have one number, the damping b: with lengths and times scaled, x'' + b sqrt(x) x' +
# x^(3/2) = 0 from x = 0, x' = 1 until the force vanishes. It grows as the fifth root of the speed. The
# restitution is the approximant of Mueller and Poeschel, Phys. Rev. E 84, 021302 (2011), whose error is
# below 0.009 (tests).


_ABOVE = 0.501086
_BELOW = (0.501086, 1.15345, 0.577977, 0.532178)
_STEPS = 6  # of Newton's method, after which rounding is left


@helper
def fifth_root(value):
    """The fifth root of a number that is not negative, to 4e-16, by +, -, x and / alone: the same bits on
    every machine."""
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
    """The coefficient of normal restitution, from 1 without damping to 0."""
    w = sqrt(damping)
    below = 1.0 + w * (_BELOW[0] + w * (_BELOW[1] + w * (_BELOW[2] + w * _BELOW[3])))
    return (1.0 + _ABOVE * w) / below


@inner_helper
def normal_restitution(approach, radius, mobility, normal, viscous):
    """The restitution of a contact: `normal`, or that of viscoelastic particles with this speed of approach.

    radius: product over sum of the two radii, or that of a particle at a wall; mobility: the sum of the
    inverse masses.
    """
    if viscous is None:
        return normal
    return restitution_of(viscous * fifth_root(max(approach, 0.0) * radius * mobility * mobility))


# Contacts that last: dissipation at most once in a contact duration.
#
# Hard particles that lose energy meet infinitely often in a finite time, and a pile at rest has contacts
# all the time. In the TC model (Luding & McNamara, Granular Matter 1, 113 (1998)) a contact dissipates
# only if both particles have had no other for a time t_c, the duration of a contact of real particles;
# otherwise it is elastic. Contacts with walls count as well; a fixed particle is a wall.
#
# Elastic here means: normal restitution 1, and no friction, not even of perfectly rough particles, which
# would lose nothing: in a corner those exchange spin and velocity for ever, without leaving it (no-slip
# billiards).


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
