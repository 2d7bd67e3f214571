"""What a large disc displaces in a fluid of small ones: scaled-particle theory of the work of insertion.

In equilibrium the work of inserting a hard disc depends on where it is through the chemical potential of the
fluid there, mu(z) = const - m g z; so the upward force on it is m g dW/dmu = m g (number of small discs
displaced). That is Archimedes's principle: nothing but the fluid that is missing counts, adsorption included.
"""

import numpy as np

from gaspart.theory._arguments import Numbers, Values, checked, checked_packing_fraction

_HIGHEST = 0.7


@checked
def insertion_work(packing_fraction: Numbers, size_ratio: Numbers) -> Values:
    """W / (k_B T) of a hard disc in a fluid of discs 1 / size_ratio as large (scaled-particle theory).

    -ln(1 - eta) + 2 s eta / (1 - eta) + s^2 eta / (1 - eta)^2: Helfand, Frisch and Lebowitz, J. Chem. Phys.
    34, 1037 (1961) (tested against the equation of state at s = 1). Its last term is the pressure
    times the disc's own area, so the second is the line tension of its edge.
    """
    eta = checked_packing_fraction(packing_fraction, _HIGHEST)
    s = np.asarray(size_ratio, dtype=float)
    return -np.log1p(-eta) + 2.0 * s * eta / (1.0 - eta) + s**2 * eta / (1.0 - eta) ** 2


@checked
def displaced_area(packing_fraction: Numbers, size_ratio: Numbers) -> Values:
    """Area of fluid displaced over the area of a small disc, (dW/dmu) / eta (scaled-particle theory).

    s^2 + 2 s (1 - eta) / (1 + eta) + (1 - eta)^2 / (1 + eta): (s + 1)^2 in a dilute gas, whose centres are
    kept off the radius R + r; less in a dense fluid, which is drawn to the disc's edge and fills part of
    that margin again.
    """
    eta = checked_packing_fraction(packing_fraction, _HIGHEST)
    s = np.asarray(size_ratio, dtype=float)
    return s**2 + 2.0 * s * (1.0 - eta) / (1.0 + eta) + (1.0 - eta) ** 2 / (1.0 + eta)
