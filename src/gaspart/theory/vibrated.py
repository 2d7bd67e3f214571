"""Dilute beds of inelastic discs on a vibrating floor under gravity.

The results follow from the energy balance of a nearly elastic gas. The gas is isothermal and Maxwellian, and
its density is exponential in the height. Vibrations are small, fast, and slow compared with the particles
(Kumaran, Phys. Rev. E 57, 5660 (1998); McNamara and Luding, Phys. Rev. E 58, 813 (1998), who show that losses
at the floor matter). All results are derived from averages over Maxwellian velocities, and tested against
them. Discs have mass 1 and diameter d. `layers` is N d / width. For a finite bed it is (N - 1) d / width,
because a disc does not collide with itself. Contacts with the floor have the same restitution as contacts of
particles. All results are exact to first order in `packing_fraction`, the packing fraction of an ideal gas at
the floor, pi N d^2 g / (4 width T).
"""

import math

from gaspart.theory.geometry import Numbers, Values, checked_range

# Coefficient of first order in the packing fraction: 2/3 of the coefficient of the contact value, b_3 / 2 for
# discs (Rowlinson 1964), minus 4/3, because the volume of the discs raises the bed.
_FIRST_ORDER = (8.0 / 3.0 - 2.0 * math.sqrt(3.0) / math.pi) * 2.0 / 3.0 - 4.0 / 3.0


def bed_loss(layers: Numbers, restitution: Numbers, packing_fraction: Numbers = 0.0) -> Values:
    """Compute the power dissipated by inelastic contacts in the bed, divided by N g sqrt(T).

    Dissipated power, the small parameter of the theory: (1 - e^2) (sqrt(pi) layers / 2 + 1 / sqrt(2 pi)). The
    first term is due to contacts between particles. Their loss per area, (1 - e^2) sqrt(pi) d n^2 T^(3/2)
    with n = N g / (T width) exp(-g z / T), is integrated over z. At a packing fraction eta this term is
    multiplied by 1 - 0.2907 eta. The second term is due to the floor: particles arrive with a mean normal
    energy T at the rate sqrt(T / 2 pi) n(0).

    Parameters
    ----------
    layers : array_like, [1]
        Number of layers N d / width, or (N - 1) d / width for a finite bed; not negative.
    packing_fraction : array_like, default 0.0, [1]
        Packing fraction eta of an ideal gas at the floor, from 0 to 1.
    """
    count = checked_range("layers", layers, 0.0, math.inf, "must be finite and not negative")
    e = checked_range("restitution", restitution, 0.0, 1.0, "must be from 0 to 1")
    eta = checked_range("packing_fraction", packing_fraction, 0.0, 1.0, "must be from 0 to 1")
    pairs = 0.5 * math.sqrt(math.pi) * count * (1.0 + _FIRST_ORDER * eta)
    return (1.0 - e**2) * (pairs + 1.0 / math.sqrt(2.0 * math.pi))


def bed_height(packing_fraction: Numbers) -> Values:
    """Compute the mean height of the bed above the floor, in units of T / g.

    Mean height, 1 + packing_fraction. The result follows from the virial theorem for a bed with the pressure
    n T (1 + 2 eta).

    Parameters
    ----------
    packing_fraction : array_like, [1]
        Packing fraction of an ideal gas at the floor, from 0 to 1.
    """
    return 1.0 + checked_range("packing_fraction", packing_fraction, 0.0, 1.0, "must be from 0 to 1")


def sawtooth_temperature(layers: Numbers, restitution: Numbers, packing_fraction: Numbers = 0.0) -> Values:
    """Compute T / V^2 of a bed on a floor that moves up at speed V.

    Temperature divided by V^2, for a floor that always moves up and discs of mass 1. The inverse square of
    `bed_loss`. The power of the floor is exactly N g V: V times the mean force, which is the weight. The next
    order is V / sqrt(T) = `bed_loss`.

    Parameters
    ----------
    layers : array_like, [1]
        Number of layers N d / width, or (N - 1) d / width for a finite bed; not negative.
    packing_fraction : array_like, default 0.0, [1]
        Packing fraction of an ideal gas at the floor, from 0 to 1.
    """
    return bed_loss(layers, restitution, packing_fraction) ** -2


def sine_temperature(layers: Numbers, restitution: Numbers, packing_fraction: Numbers = 0.0) -> Values:
    """Compute T / <U^2> of a bed on a floor whose velocity U averages to zero.

    Temperature divided by <U^2>, for discs of mass 1: sqrt(8 / pi) / `bed_loss`. To lowest order in U^2 / T
    the power of the floor is N g <U^2> sqrt(8 / (pi T)). Without losses at the floor, the result is 4 sqrt(2)
    / (pi layers (1 - e^2)).

    Parameters
    ----------
    layers : array_like, [1]
        Number of layers N d / width, or (N - 1) d / width for a finite bed; not negative.
    packing_fraction : array_like, default 0.0, [1]
        Packing fraction of an ideal gas at the floor, from 0 to 1.
    """
    return math.sqrt(8.0 / math.pi) / bed_loss(layers, restitution, packing_fraction)
