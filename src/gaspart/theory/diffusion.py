"""Self-diffusion beyond Enskog: dense corrections, finite systems, and the long-time tail.

The arguments are the same as in `enskog`: packing fraction (number or array), diameter, temperature (k_B =
1), mass, and contact value.
"""

import math
from pathlib import Path

import numpy as np

from gaspart.errors import SceneError
from gaspart.theory.brownian import langevin_msd
from gaspart.theory.enskog import collision_rate, enskog_diffusion, enskog_viscosity, mean_free_path
from gaspart.theory.finite_size import LARGEST_REMAINDER, finite_size_remainder
from gaspart.theory.geometry import (
    Numbers,
    Values,
    check_ranges,
    checked_dimension,
    checked_packing_fraction,
    number_density,
)

ERPENBECK_WOOD_UNCERTAINTY = 0.007
"""Relative uncertainty of `erpenbeck_wood_ratio` up to eta = 0.45: the greatest difference from the table of
Pieprzyk and others (2019).
"""
ERPENBECK_WOOD_HIGHEST = 0.4915
"""Maximum packing fraction of `erpenbeck_wood_ratio`; spheres freeze at this packing fraction."""
VISCOSITY_RATIO_UNCERTAINTY = 0.02
"""Relative standard uncertainty of `viscosity_ratio`: the largest uncertainty in its table."""
_SHIFT = 0.05  # relative uncertainty of the shift in a long container, see `diffusion_in_cube`
_DENSE = 0.45, 0.03
# Packing fraction above which the uncertainty is larger, and this uncertainty; the difference is 2 % at
# 0.487.
_ORDERED = 2.0
"""Relative change of D in a small cube that the known corrections do not include, divided by the same
relative change of the contact value; from the rows of `data/small_systems.csv` (tested).
"""
_VELOCITY_DECAY = {
    2: (
        (0.846023, 1.076378, 1.483431, 2.029232, 2.713878),
        (0.4579645, 0.4737591, 0.0658662, 0.0023976, 0.0000127),
    ),
    3: (
        (0.6175907, 0.8096178, 1.1017965, 1.4991710, 2.0148242),
        (0.7870072, 0.1861966, 0.0259296, 0.0008627, 0.0000038),
    ),
}
"""Rates, per collision of a particle, and weights of the velocity autocorrelation from the linear Boltzmann
equation. Five Sonine polynomials represent its spectrum (by `boltzmann`, tested).
"""
YEH_HUMMER_CONSTANT = 2.837297
"""Madelung-like constant of a cubic periodic container (Yeh and Hummer 2004, abstract)."""


def erpenbeck_wood_ratio(packing_fraction: Numbers) -> Values:
    """Compute the self-diffusion coefficient of spheres divided by Enskog's coefficient.

    D / D_Enskog of the infinite system. The ratio is 1 + 0.05403 y + 6.3656 y^2 - 10.9425 y^3 with y = rho
    sigma^3 / sqrt 2 (J. J. Erpenbeck and W. W. Wood, Phys. Rev. A 43, 4254 (1991)). The coefficients were not
    checked against the paper. The values differ from the table of D in (S. Pieprzyk, M. N. Bannerman, A. C.
    Branka, M. Chudak and D. M. Heyes, Phys. Chem. Chem. Phys. 21, 6886 (2019)), as quoted by a public script,
    by at most 0.7 % up to eta = 0.45, and by 2 % at 0.487 (tested).

    Parameters
    ----------
    packing_fraction : array_like, [1]
        Packing fraction eta, from 0 to 0.4915 (the range of the fluid).
    """
    eta = checked_packing_fraction(packing_fraction, ERPENBECK_WOOD_HIGHEST)
    y = number_density(eta, 3) / math.sqrt(2.0)
    return 1.0 + 0.05403 * y + 6.3656 * y**2 - 10.9425 * y**3


@check_ranges
def erpenbeck_wood_diffusion(
    packing_fraction: Numbers, diameter: float = 1.0, temperature: float = 1.0, mass: float = 1.0
) -> Values:
    """Compute the self-diffusion coefficient of spheres in the infinite system [length^2/time].

    D is the product of `erpenbeck_wood_ratio` and `enskog_diffusion`.

    Parameters
    ----------
    packing_fraction : array_like, [1]
        Packing fraction eta, from 0 to 0.4915 (the range of the fluid).
    """
    enskog = enskog_diffusion(packing_fraction, 3, diameter, temperature, mass)
    return erpenbeck_wood_ratio(packing_fraction) * enskog


@check_ranges
def viscosity_ratio(packing_fraction: Numbers) -> Values:
    """Compute the shear viscosity of spheres divided by Enskog's viscosity. The ratio was measured by this
    program (`data/viscosity_3d.csv`) and is interpolated linearly. It is 1 up to eta = 0.3, where 1.00(1) was
    measured. The uncertainty is `VISCOSITY_RATIO_UNCERTAINTY`, plus about 2 % between the rows.
    """
    eta = checked_packing_fraction(packing_fraction, ERPENBECK_WOOD_HIGHEST)
    path = Path(__file__).parent / "data" / "viscosity_3d.csv"
    fractions, ratio, _ = np.loadtxt(path, delimiter=",", skiprows=1, unpack=True)
    return np.interp(eta, fractions, np.r_[1.0, ratio[1:]])[()]


@check_ranges
def yeh_hummer(length: Numbers, viscosity: Numbers, temperature: float = 1.0) -> Values:
    """Compute the finite-size correction of the self-diffusion coefficient in a periodic cube
    [length^2/time].

    D_infinity - D_L, to be added to D_L. The correction is 2.837297 k_B T / (6 pi viscosity L) (I.-C. Yeh and
    G. Hummer, J. Phys. Chem. B 108, 15873 (2004), abstract). It is hydrodynamic, so it holds only if the mean
    free path is much shorter than L. In a gas, the relevant modes decay with nu + D instead of nu. This is
    equivalent to a viscosity that is larger by rho D.

    Parameters
    ----------
    length : float or ndarray, [length]
        Side L of the cubic periodic container.
    viscosity : float or ndarray, [mass/(length time)]
        Shear viscosity: `enskog_viscosity` times `viscosity_ratio`.
    """
    return YEH_HUMMER_CONSTANT * temperature / (6.0 * math.pi * viscosity * length)


@check_ranges
def diffusion_in_cube(
    packing_fraction: float,
    length: float,
    diameter: float = 1.0,
    temperature: float = 1.0,
    mass: float = 1.0,
) -> tuple[float, float]:
    """Compute the self-diffusion coefficient of spheres in a periodic cube, and its uncertainty.

    D is `erpenbeck_wood_diffusion` minus the shift `yeh_hummer`. The shift is computed for modes that decay
    with nu + D, and with the viscosity from `viscosity_ratio`. The relative uncertainty of the shift is 5 %
    plus two mean free paths divided by the side, but at most a half. The second term matters if the container
    is not much longer than a mean free path. (Tested with 49 values of 1372 to 530604 spheres from another
    program.) In a small cube, the periodic images of a particle order the surrounding fluid. The relative
    change of D by this order is twice `finite_size_remainder`. This was tested with the 44 rows of the table
    `small_systems` that are for larger cubes. In this table D is relative to the centre of mass.

    Parameters
    ----------
    packing_fraction : float, [1]
        Packing fraction eta, from 0 to 0.4915 (the range of the fluid).
    length : float, [length]
        Side of the cube.

    Returns
    -------
    value : float, [length^2/time]
        Self-diffusion coefficient D.
    uncertainty : float, [length^2/time]
        Standard uncertainty of D.

    Examples
    --------
    >>> from gaspart import theory
    >>> value, uncertainty = theory.diffusion_in_cube(0.3, length=12.0)
    >>> round(value, 4), round(uncertainty, 4)
    (0.1878, 0.0018)
    """
    infinite = float(erpenbeck_wood_diffusion(packing_fraction, diameter, temperature, mass))
    remainder = float(finite_size_remainder(packing_fraction, 3, length / diameter))
    if remainder > LARGEST_REMAINDER:
        rule = (
            f"images of a particle, {length / diameter:.3g} diameters away, order the fluid about it: nothing"
            f" is stated where they change the contact value by more than {100.0 * LARGEST_REMAINDER:g} %"
        )
        raise SceneError("length", length, rule)
    viscosity = float(enskog_viscosity(packing_fraction, 3, diameter, temperature, mass))
    viscosity *= float(viscosity_ratio(packing_fraction))
    carried = mass * float(number_density(packing_fraction, 3, diameter)) * infinite
    shift = float(yeh_hummer(length, viscosity + carried, temperature))
    dense, large = _DENSE
    relative = ERPENBECK_WOOD_UNCERTAINTY if packing_fraction <= dense else large
    paths = float(mean_free_path(packing_fraction, 3, diameter)) / length
    of_shift = min(0.5, _SHIFT + 2.0 * paths) * shift
    return infinite - shift, math.hypot(math.hypot(relative, _ORDERED * remainder) * infinite, of_shift)


@check_ranges
def velocity_decay_rate(
    packing_fraction: Numbers,
    dimension: int,
    diameter: float = 1.0,
    temperature: float = 1.0,
    mass: float = 1.0,
    contact: Numbers | None = None,
) -> Values:
    """Compute the initial decay rate of the velocity autocorrelation [1/time]. The rate is 2 nu / d, with the
    collision rate nu from `collision_rate` (exact in equilibrium). In the first Sonine approximation of
    Enskog theory, D = k_B T / (m rate).
    """
    rate = collision_rate(packing_fraction, dimension, diameter, temperature, mass, contact)
    return 2.0 / dimension * rate


@check_ranges
def enskog_mean_squared_displacement(
    time: Numbers,
    packing_fraction: Numbers,
    dimension: int,
    diameter: float = 1.0,
    temperature: float = 1.0,
    mass: float = 1.0,
    contact: Numbers | None = None,
) -> Values:
    """Compute the mean-squared displacement of Enskog theory [length^2].

    2 d int (t - s) C(s) ds with C(s) = (k_B T / m) sum w exp(-r s). The velocity autocorrelation C is the
    solution of the linear Boltzmann equation at Enskog's collision rate, with the rates r and weights w of
    five Sonine polynomials. At long times, where the result is 2 d D t, the accuracy is 6e-5 (2D) or 1e-5
    (3D) of Enskog's D. At short times the error is smaller. Correlated collisions and the long-time tail are
    neglected.

    Parameters
    ----------
    time : array_like, [time]
        Time t; it broadcasts with `packing_fraction`.
    """
    frequency = collision_rate(packing_fraction, dimension, diameter, temperature, mass, contact)
    total: Values = 0.0
    for relative, weight in zip(*_VELOCITY_DECAY[checked_dimension(dimension)], strict=True):
        rate = relative * frequency
        total = total + weight * langevin_msd(time, temperature / (mass * rate), rate, dimension)
    return total


def _spreading(
    packing_fraction: Numbers, dimension: int, diameter: float, temperature: float, mass: float
) -> tuple[Values, Values]:
    """Return the number density, and the sum of Enskog's diffusion coefficient and kinematic viscosity."""
    density = number_density(np.asarray(packing_fraction, dtype=float), dimension, diameter)
    diffusion = enskog_diffusion(packing_fraction, dimension, diameter, temperature, mass)
    viscosity = enskog_viscosity(packing_fraction, dimension, diameter, temperature, mass)
    return density, diffusion + viscosity / (mass * density)


@check_ranges
def velocity_autocorrelation_tail(
    time: Numbers,
    packing_fraction: Numbers,
    dimension: int,
    diameter: float = 1.0,
    temperature: float = 1.0,
    mass: float = 1.0,
) -> Values:
    """Compute the long-time tail of the velocity autocorrelation. The mean of v(0).v(t) divided by the mean
    of v^2: ((d-1) / (d rho)) [4 pi (D + nu) t]^(-d/2), by mode coupling (M. H. Ernst, E. H. Hauge and J. M.
    J. van Leeuwen (1970)): the integral over the shear modes of `modes`. D and the kinematic viscosity nu are
    Enskog's. Range: after 15 to 30 mean free times, and before sound has crossed the container.
    """
    density, spreading = _spreading(packing_fraction, dimension, diameter, temperature, mass)
    amplitude = (dimension - 1) / (dimension * density)
    return amplitude * (4.0 * math.pi * spreading * np.asarray(time)) ** (-0.5 * dimension)


@check_ranges
def logarithmic_slope(
    packing_fraction: Numbers, diameter: float = 1.0, temperature: float = 1.0, mass: float = 1.0
) -> Values:
    """Compute the slope of the integrated velocity autocorrelation of discs against ln t [length^2/time].

    Slope dD(t) / d ln t, with D(t) the integral of the tail: k_B T / (8 pi m rho (D + nu)), the integral of
    `velocity_autocorrelation_tail`. See there for the range and the source. In 2D the tail falls as 1/t, so
    D(t) grows without limit and no diffusion coefficient exists. At very long times, D(t) itself changes the
    slope. Simulations do not reach such times.

    Parameters
    ----------
    packing_fraction : array_like, [1]
        Packing fraction eta, from 0 to 0.70.
    """
    density, spreading = _spreading(packing_fraction, 2, diameter, temperature, mass)
    return temperature / (8.0 * math.pi * mass * density * spreading)
