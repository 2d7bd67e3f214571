"""Dilute beds of inelastic discs on a vibrating floor, under gravity.

The energy balance of a nearly elastic gas: isothermal and Maxwellian, its density exponential in the height,
with small and fast vibrations, slow compared with the particles (Kumaran, Phys. Rev. E 57, 5660 (1998);
McNamara and Luding, Phys. Rev. E 58, 813 (1998), who show that losses at the floor count). Everything here is
derived from the averages over Maxwellian velocities, and tested against them. Discs of mass 1 and diameter d;
`layers` is N d / width, or (N - 1) d / width for a finite bed, since no disc meets itself; contacts with the
floor are as inelastic as those of particles. packing_fraction, to whose first order everything is exact, is
the one that an ideal gas would have at the floor, pi N d^2 g / (4 width T).
"""

import math

from gaspart.theory._arguments import Numbers, Values, checked_range

# Of the first order in the packing fraction: 2/3 of that of the contact value, b_3 / 2 of discs (Rowlinson
# 1964), less 4/3, since the volume of the discs lifts the bed.
_FIRST_ORDER = (8.0 / 3.0 - 2.0 * math.sqrt(3.0) / math.pi) * 2.0 / 3.0 - 4.0 / 3.0


def bed_loss(layers: Numbers, restitution: Numbers, packing_fraction: Numbers = 0.0) -> Values:
    """(1 - e^2) (sqrt(pi) layers / 2 + 1 / sqrt(2 pi)): power lost by the bed over N g sqrt(T).

    The first term is that of contacts of particles, (1 - e^2) sqrt(pi) d n^2 T^(3/2) per area with n = N g /
    (T width) exp(-g z / T), integrated over z; at a packing fraction eta it is 1 - 0.2907 eta times that. The
    second is that of the floor: a particle arrives with a mean energy T across it, at the rate sqrt(T / 2 pi)
    n(0). It is the small parameter of the theory.
    """
    count = checked_range("layers", layers, 0.0, math.inf, "must be finite and not negative")
    e = checked_range("restitution", restitution, 0.0, 1.0, "must be from 0 to 1")
    eta = checked_range("packing_fraction", packing_fraction, 0.0, 1.0, "must be from 0 to 1")
    pairs = 0.5 * math.sqrt(math.pi) * count * (1.0 + _FIRST_ORDER * eta)
    return (1.0 - e**2) * (pairs + 1.0 / math.sqrt(2.0 * math.pi))


def bed_height(packing_fraction: Numbers) -> Values:
    """Mean height above the floor, in units of T / g: 1 + packing_fraction, from the virial of a bed whose
    pressure is n T (1 + 2 eta)."""
    return 1.0 + checked_range("packing_fraction", packing_fraction, 0.0, 1.0, "must be from 0 to 1")


def sawtooth_temperature(layers: Numbers, restitution: Numbers, packing_fraction: Numbers = 0.0) -> Values:
    """T / V^2 over a floor that always moves up at the speed V: the inverse square of `bed_loss`.

    Its power is N g V exactly, V times the mean force, which is the weight. The next order is V / sqrt(T) =
    `bed_loss`.
    """
    return bed_loss(layers, restitution, packing_fraction) ** -2


def sine_temperature(layers: Numbers, restitution: Numbers, packing_fraction: Numbers = 0.0) -> Values:
    """T / <U^2> over a floor of velocity U that averages to zero: sqrt(8 / pi) / `bed_loss`.

    Its power is N g <U^2> sqrt(8 / (pi T)) to the lowest order in U^2 / T. Without the floor's loss this is
    4 sqrt(2) / (pi layers (1 - e^2)).
    """
    return math.sqrt(8.0 / math.pi) / bed_loss(layers, restitution, packing_fraction)
