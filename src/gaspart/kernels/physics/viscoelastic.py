"""Restitution of viscoelastic particles, which falls with the speed of approach.

Elastic and viscous forces of spheres in contact (Brilliantov, Spahn, Hertzsch and Poeschel, Phys. Rev. E 53,
5382 (1996)) have one number, the damping b: with lengths and times scaled, x'' + b sqrt(x) x' + x^(3/2) = 0
from x = 0, x' = 1 until the force vanishes. It grows as the fifth root of the speed. The restitution is the
approximant of Mueller and Poeschel, Phys. Rev. E 84, 021302 (2011), whose error is below 0.009 (tests).
"""

from math import frexp, ldexp, sqrt

from gaspart.kernels.compile.policy import helper, inner_helper

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
