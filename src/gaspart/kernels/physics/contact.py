"""The physics of one contact: when do two particles touch, and what momentum passes.

Both engines use these functions and no others. With r and v the separation and relative velocity of two
particles (second minus first), they work on the invariants rr = r.r, rv = r.v, vv = v.v and ss = sigma^2,
sigma the distance of the centres at contact; so they know no dimension, no container and no engine.
The arithmetic keeps the type of its arguments (float32 stays float32): hence x + x for 2x.
"""

from math import inf, sqrt

from gaspart.kernels.compile.policy import helper, inner_helper


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
