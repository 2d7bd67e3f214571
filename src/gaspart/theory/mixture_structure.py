"""Structure of mixtures of additive hard spheres, by Percus and Yevick's equation."""

import numpy as np

from gaspart.theory._arguments import Numbers, checked
from gaspart.theory.geometry import particle_volume
from gaspart.theory.mixtures import Sizes, checked_mixture

_NODES = 80  # of Gauss and Legendre, per species: exact to rounding up to k = 100 in the largest diameter


@checked
def percus_yevick_partial_factors(
    wave_number: Numbers, packing_fraction: float, diameters: Sizes, fractions: Sizes | None = None
) -> np.ndarray:
    """Compute the partial structure factors of a mixture of spheres, by Percus and Yevick's equation.

    Parameters
    ----------
    wave_number : array_like, [1/length]
        Wave numbers k, in the inverse of the unit of the diameters.
    packing_fraction : float, [1]
        Packing fraction eta, from 0 to 0.539.
    diameters : array_like, shape (S,), [length]
        Diameters of the species.
    fractions : array_like, shape (S,), optional, [1]
        Number fractions, all positive. Default: equal.

    Returns
    -------
    ndarray, shape (..., S, S), [1]
        S_ab(k) = <rho_a(k) rho_b(-k)> / sqrt(N_a N_b) of each pair of species. In an ideal gas it is 1 for
        equal indices and 0 for others.

    Raises
    ------
    SceneError
        If an argument is out of range.

    Notes
    -----
    Lebowitz's solution [1]_ as factorised by Baxter [2]_. The inverse matrix is Q^H Q with

        Q_ab = delta_ab - 2 pi sqrt(rho_a rho_b) int q_ab(r) e^{ikr} dr from (sigma_a - sigma_b) / 2 to
        sigma_ab,

        q_ab = a_a (r^2 - sigma_ab^2) / 2 + b_a (r - sigma_ab),

        a_a = (1 - xi_3 + 3 xi_2 sigma_a) / (1 - xi_3)^2,    b_a = -(3/2) xi_2 sigma_a^2 / (1 - xi_3)^2,

    and xi_n = (pi / 6) sum rho sigma^n. The sum of sqrt(x_a x_b) S_ab is S(k) of all particles. Tested: equal
    spheres have S(k) of `percus_yevick_structure_factor`, and k = 0 gives Percus and Yevick's
    compressibility.

    References
    ----------
    .. [1] J. L. Lebowitz, Phys. Rev. 133, A895 (1964).
    .. [2] R. J. Baxter, J. Chem. Phys. 52, 4559 (1970).

    Examples
    --------
    >>> from gaspart import theory
    >>> theory.percus_yevick_partial_factors(0.0, 0.3, [1.0, 2.0]).round(4)
    array([[ 1.0234, -0.2561],
           [-0.2561,  0.1557]])
    """
    eta, sizes, parts = checked_mixture("santos", packing_fraction, 3, diameters, fractions)
    k = np.asarray(wave_number, dtype=float)[..., None, None, None]
    density = eta * parts / (particle_volume(3) * float(parts @ sizes**3))
    second, rest = np.pi / 6.0 * float(density @ sizes**2), 1.0 - eta
    square = ((rest + 3.0 * second * sizes) / rest**2)[:, None, None]
    slope = (-1.5 * second * sizes**2 / rest**2)[:, None, None]
    between = (0.5 * np.add.outer(sizes, sizes))[..., None]
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    r = between - sizes[None, :, None] * 0.5 * (1.0 - nodes)  # from the difference of the radii, b wide
    inside = 0.5 * square * (r**2 - between**2) + slope * (r - between)
    integral = (inside * np.exp(1j * k * r)) @ weights * 0.5 * sizes[None, :]
    factor = np.eye(len(sizes)) - 2.0 * np.pi * np.sqrt(np.outer(density, density)) * integral
    return np.linalg.inv((factor.conj().swapaxes(-1, -2) @ factor).real)
