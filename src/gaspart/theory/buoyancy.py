"""Buoyancy of a large disc in a fluid of small discs, by scaled-particle theory.

The theory gives the work of insertion. In equilibrium the work of inserting a hard disc depends on the height
through the chemical potential of the fluid there, mu(z) = const - m g z. The upward force on the disc is
therefore m g dW/dmu = m g (number of small discs displaced). That is Archimedes's principle: only the missing
fluid counts, adsorption included.
"""

import numpy as np

from gaspart.theory._arguments import Numbers, Values, checked, checked_packing_fraction

_HIGHEST = 0.7


@checked
def insertion_work(packing_fraction: Numbers, size_ratio: Numbers) -> Values:
    """Compute the work of inserting a hard disc into a fluid of smaller discs.

    Parameters
    ----------
    packing_fraction : array_like, [1]
        Packing fraction eta, of the fluid, from 0 to 0.7.
    size_ratio : array_like, [1]
        Radius s of the inserted disc divided by the radius of a disc of the fluid.

    Returns
    -------
    ndarray, [1]
        Work W divided by k_B T.

    Raises
    ------
    SceneError
        If an argument is out of range.

    Notes
    -----
    -ln(1 - eta) + 2 s eta / (1 - eta) + s^2 eta / (1 - eta)^2, scaled-particle theory [1]_ (tested against
    the equation of state at s = 1). The last term is the pressure times the disc's own area, so the second
    term is the line tension of its edge.

    References
    ----------
    .. [1] E. Helfand, H. L. Frisch and J. L. Lebowitz, J. Chem. Phys. 34, 1037 (1961).

    Examples
    --------
    >>> from gaspart import theory
    >>> round(float(theory.insertion_work(0.3, size_ratio=5.0)), 4)
    19.9485
    """
    eta = checked_packing_fraction(packing_fraction, _HIGHEST)
    s = np.asarray(size_ratio, dtype=float)
    return -np.log1p(-eta) + 2.0 * s * eta / (1.0 - eta) + s**2 * eta / (1.0 - eta) ** 2


@checked
def displaced_area(packing_fraction: Numbers, size_ratio: Numbers) -> Values:
    """Compute the area of fluid that a large disc displaces.

    Parameters
    ----------
    packing_fraction : array_like, [1]
        Packing fraction eta, of the fluid, from 0 to 0.7.
    size_ratio : array_like, [1]
        Radius s of the large disc divided by the radius of a disc of the fluid.

    Returns
    -------
    ndarray, [1]
        Area of fluid displaced divided by the area of a small disc, (dW/dmu) / eta.

    Raises
    ------
    SceneError
        If an argument is out of range.

    Notes
    -----
    s^2 + 2 s (1 - eta) / (1 + eta) + (1 - eta)^2 / (1 + eta), scaled-particle theory (see `insertion_work`).
    In a dilute gas it is (s + 1)^2: centres are kept off the radius R + r. In a dense fluid it is less,
    because the fluid is drawn to the disc's edge and fills a part of that margin again.

    Examples
    --------
    >>> from gaspart import theory
    >>> theory.displaced_area([0.0, 0.3], size_ratio=5.0).round(4)
    array([36.    , 30.7615])
    """
    eta = checked_packing_fraction(packing_fraction, _HIGHEST)
    s = np.asarray(size_ratio, dtype=float)
    return s**2 + 2.0 * s * (1.0 - eta) / (1.0 + eta) + (1.0 - eta) ** 2 / (1.0 + eta)
