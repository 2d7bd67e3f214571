"""Self-diffusion beyond Enskog: dense corrections, finite systems, and the long-time tail.

Arguments as in `enskog`: packing fraction (number or array), diameter, temperature (k_B = 1), mass, contact.
"""

import math
from pathlib import Path

import numpy as np

from gaspart.theory._arguments import Numbers, Values, checked, checked_dimension, checked_packing_fraction
from gaspart.theory.brownian import langevin_msd
from gaspart.theory.enskog import collision_rate, enskog_diffusion, enskog_viscosity, mean_free_path
from gaspart.theory.geometry import number_density

ERPENBECK_WOOD_UNCERTAINTY = 0.007
"""Relative uncertainty of `erpenbeck_wood_ratio` up to eta = 0.45: the largest difference from the table of
Pieprzyk and others (2019)."""
ERPENBECK_WOOD_HIGHEST = 0.4915
"""Packing fraction up to which `erpenbeck_wood_ratio` holds: where spheres freeze."""
VISCOSITY_RATIO_UNCERTAINTY = 0.02
"""Relative standard uncertainty of `viscosity_ratio`: the largest of its table."""
_SHIFT = 0.05  # of the shift in a long container, see `diffusion_in_cube`
_DENSE = 0.45, 0.03
# Packing fraction from which on the uncertainty is larger, and which; the difference is 2 % at 0.487.
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
"""Rates, in collisions of a particle, and weights of the velocity autocorrelation by the linear Boltzmann
equation, whose spectrum five Sonine polynomials represent (by `boltzmann`, tested)."""
YEH_HUMMER_CONSTANT = 2.837297
"""Madelung-like constant of a cubic periodic container (Yeh and Hummer 2004, abstract)."""


def erpenbeck_wood_ratio(packing_fraction: Numbers) -> Values:
    """Spheres: D / D_Enskog = 1 + 0.05403 y + 6.3656 y^2 - 10.9425 y^3, y = rho sigma^3 / sqrt 2.

    Erpenbeck and Wood, Phys. Rev. A 43, 4254 (1991). The coefficients were not read in the paper; the values
    differ by 0.7 % at most up to eta = 0.45, and by 2 % at 0.487, from the table of D of Pieprzyk, Bannerman,
    Branka, Chudak and Heyes, Phys. Chem. Chem. Phys. 21, 6886 (2019), as a public script quotes it (tested).
    Range: the fluid, eta <= 0.4915. Infinite system. Dimensionless.
    """
    eta = checked_packing_fraction(packing_fraction, ERPENBECK_WOOD_HIGHEST)
    y = number_density(eta, 3) / math.sqrt(2.0)
    return 1.0 + 0.05403 * y + 6.3656 * y**2 - 10.9425 * y**3


@checked
def erpenbeck_wood_diffusion(
    packing_fraction: Numbers, diameter: float = 1.0, temperature: float = 1.0, mass: float = 1.0
) -> Values:
    """Spheres: D of the infinite system, `erpenbeck_wood_ratio` times Enskog's (length^2 / time)."""
    enskog = enskog_diffusion(packing_fraction, 3, diameter, temperature, mass)
    return erpenbeck_wood_ratio(packing_fraction) * enskog


@checked
def viscosity_ratio(packing_fraction: Numbers) -> Values:
    """Spheres: the shear viscosity over Enskog's, as measured by this program (dimensionless).

    Straight lines between the rows of `data/viscosity_3d.csv`; 1 up to 0.3, where 1.00(1) was measured.
    Uncertain by `VISCOSITY_RATIO_UNCERTAINTY`, and by some 2 % more between the rows. Range: eta <= 0.4915.
    """
    eta = checked_packing_fraction(packing_fraction, ERPENBECK_WOOD_HIGHEST)
    path = Path(__file__).parent / "data" / "viscosity_3d.csv"
    known, ratio, _ = np.loadtxt(path, delimiter=",", skiprows=1, unpack=True)
    return np.interp(eta, known, np.r_[1.0, ratio[1:]])[()]


@checked
def yeh_hummer(length: Numbers, viscosity: Numbers, temperature: float = 1.0) -> Values:
    """Spheres: D_infinity - D_L = 2.837297 k_B T / (6 pi viscosity L): to be added to D_L (length^2 / time).

    Yeh and Hummer, J. Phys. Chem. B 108, 15873 (2004), abstract. `length`: side of the cubic periodic
    container; `viscosity`: shear viscosity, `enskog.enskog_viscosity` times `viscosity_ratio`. Hydrodynamics:
    holds where the mean free path is much smaller than L. Modes of the velocity field that decay with nu + D
    instead of nu, as in a gas, are those of a viscosity larger by rho D.
    """
    return YEH_HUMMER_CONSTANT * temperature / (6.0 * math.pi * viscosity * length)


@checked
def diffusion_in_cube(
    packing_fraction: float,
    length: float,
    diameter: float = 1.0,
    temperature: float = 1.0,
    mass: float = 1.0,
) -> tuple[float, float]:
    """Spheres: D in a periodic cube of side `length`, and its standard uncertainty (length^2 / time).

    `erpenbeck_wood_diffusion` less `yeh_hummer`, of modes that decay with nu + D, with the viscosity of
    `viscosity_ratio`. The shift is uncertain by 5 % of it, and by two mean free paths over the side for
    containers that are not long beside these, at most by half (49 values of 1372 to 530604 spheres by
    another program, tested).
    """
    infinite = float(erpenbeck_wood_diffusion(packing_fraction, diameter, temperature, mass))
    viscosity = float(enskog_viscosity(packing_fraction, 3, diameter, temperature, mass))
    viscosity *= float(viscosity_ratio(packing_fraction))
    carried = mass * float(number_density(packing_fraction, 3, diameter)) * infinite
    shift = float(yeh_hummer(length, viscosity + carried, temperature))
    dense, large = _DENSE
    relative = ERPENBECK_WOOD_UNCERTAINTY if packing_fraction <= dense else large
    paths = float(mean_free_path(packing_fraction, 3, diameter)) / length
    return infinite - shift, math.hypot(relative * infinite, min(0.5, _SHIFT + 2.0 * paths) * shift)


@checked
def velocity_decay_rate(
    packing_fraction: Numbers,
    dimension: int,
    diameter: float = 1.0,
    temperature: float = 1.0,
    mass: float = 1.0,
    contact: Numbers | None = None,
) -> Values:
    """Initial decay rate of the velocity autocorrelation, 2 nu / d (exact in equilibrium; 1 / time).

    nu is `enskog.collision_rate`; k_B T / (m rate) is Enskog's D in the first Sonine approximation.
    """
    rate = collision_rate(packing_fraction, dimension, diameter, temperature, mass, contact)
    return 2.0 / dimension * rate


@checked
def enskog_mean_squared_displacement(
    time: Numbers,
    packing_fraction: Numbers,
    dimension: int,
    diameter: float = 1.0,
    temperature: float = 1.0,
    mass: float = 1.0,
    contact: Numbers | None = None,
) -> Values:
    """Mean-squared displacement 2 d int (t - s) C(s) ds, C(s) = (k_B T / m) sum w exp(-r s) (length^2).

    The velocity autocorrelation is that of the linear Boltzmann equation at Enskog's collision rate, with the
    rates r and weights w of five Sonine polynomials: at long times, where it is 2 d D t, to 6e-5 of Enskog's
    D (2D) or 1e-5 (3D), before that to less. No correlated collisions and no long-time tail. `time`
    broadcasts with eta.
    """
    gas = {"diameter": diameter, "temperature": temperature, "mass": mass, "contact": contact}
    frequency = collision_rate(packing_fraction, dimension, **gas)
    total = 0.0
    for relative, weight in zip(*_VELOCITY_DECAY[checked_dimension(dimension)], strict=True):
        rate = relative * frequency
        total = total + weight * langevin_msd(time, temperature / (mass * rate), rate, dimension)
    return total


def _spreading(
    packing_fraction: Numbers, dimension: int, diameter: float, temperature: float, mass: float
) -> tuple[Values, Values]:
    """Number density, and diffusion coefficient plus kinematic viscosity, both Enskog's."""
    density = number_density(np.asarray(packing_fraction, dtype=float), dimension, diameter)
    diffusion = enskog_diffusion(packing_fraction, dimension, diameter, temperature, mass)
    viscosity = enskog_viscosity(packing_fraction, dimension, diameter, temperature, mass)
    return density, diffusion + viscosity / (mass * density)


@checked
def velocity_autocorrelation_tail(
    time: Numbers,
    packing_fraction: Numbers,
    dimension: int,
    diameter: float = 1.0,
    temperature: float = 1.0,
    mass: float = 1.0,
) -> Values:
    """Long-time tail of <v(0).v(t)> / <v^2>: ((d-1) / (d rho)) [4 pi (D + nu) t]^(-d/2) (dimensionless).

    Mode coupling, Ernst, Hauge and van Leeuwen (1970); the integral over the shear modes of `modes`. D and
    the kinematic viscosity nu are Enskog's. Range: after 15 to 30 mean free times and before sound has
    crossed the container.
    """
    density, spreading = _spreading(packing_fraction, dimension, diameter, temperature, mass)
    amplitude = (dimension - 1) / (dimension * density)
    return amplitude * (4.0 * math.pi * spreading * np.asarray(time)) ** (-0.5 * dimension)


@checked
def logarithmic_slope(
    packing_fraction: Numbers, diameter: float = 1.0, temperature: float = 1.0, mass: float = 1.0
) -> Values:
    """Discs: dD(t) / d ln t = k_B T / (8 pi m rho (D + nu)), D(t) the integral of the tail (length^2 / time).

    In 2D the tail falls as 1/t, so D(t) grows without limit and no diffusion coefficient exists. Range and
    provenance of `velocity_autocorrelation_tail`, of which it is the integral; the very long times, where
    D(t) in turn changes the slope, are out of reach of a simulation.
    """
    density, spreading = _spreading(packing_fraction, 2, diameter, temperature, mass)
    return temperature / (8.0 * math.pi * mass * density * spreading)
