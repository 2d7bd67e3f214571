"""Closed formulas: fixed energy, free-molecular and ideal gases, billiards, two bodies, bodies in reservoirs.

k_B = 1; d dimension, N number of bodies, f degrees of freedom of a gas of fixed energy.
"""

import math

import numpy as np
from scipy import special


def speed_factor(f):
    """Return <|v|> of a component at fixed energy over that of Maxwell; 1 for f None, with thermal faces."""
    if f is None:
        return 1.0
    return math.sqrt(f / 2.0) * math.exp(math.lgamma(f / 2.0) - math.lgamma(f / 2.0 + 0.5))


def santalo_rate(d, speed, surface, volume):
    """Return hits per time of a point of one speed in a billiard (Santalo), v S / (pi A) or v S / (4 V)."""
    return speed * surface / ((math.pi if d == 2 else 4.0) * volume)


def two_body_z(d, diameter, volume):
    """Return Z of two bodies of one size in a periodic container that is wider than two diameters."""
    excluded = math.pi * diameter**2 if d == 2 else 4.0 / 3.0 * math.pi * diameter**3
    return 1.0 + 0.5 * excluded / (volume - excluded)


def crystal_z(count, diameter, lengths):
    """Return Z of a crystal of spheres near close packing, and its error.

    Z = 3 / alpha + 2.56, alpha = V / V_0 - 1 (Alder, Hoover and Young, J. Chem. Phys. 49, 3688 (1968)), of
    3 (N - 1) degrees of freedom. The error is above the unknown order 1 / N of the constant, 2.56 / 32.
    """
    packed = count * diameter**3 / math.sqrt(2.0)
    alpha = float(np.prod(lengths)) / packed - 1.0
    return (1.0 - 1.0 / count) * 3.0 / alpha + 2.56, 0.2


def dilute_transport(density, diameter, temperature, mass=1.0):
    """Return D, the viscosity and the conductivity of dilute spheres: Chapman and Cowling's first
    approximations times the factors of Pekeris and Alterman, Proc. Natl. Acad. Sci. 43, 998 (1957).
    """
    speed = math.sqrt(temperature / math.pi / mass)
    diffusion = 1.018954 * 0.375 * speed / (density * diameter**2)
    viscosity = 1.016034 * 5.0 / 16.0 * mass * speed / diameter**2
    return diffusion, viscosity, 1.025218 * 75.0 / 64.0 * speed / diameter**2


def one_place_number(activity, room):
    """Return the mean number between open faces where there is room for one body at most."""
    return activity * room / (1.0 + activity * room)


def speed_density(d, speeds, mass, temperature, f):
    """Return the density of speeds, v^(d-1) (1 - m v^2 / (f kT))^((f-d)/2 - 1), Maxwell's for f None."""
    if f is None:
        norm = 2.0 ** (d / 2.0 - 1.0) * math.gamma(d / 2.0) * (temperature / mass) ** (d / 2.0)
        return speeds ** (d - 1) * np.exp(-mass * speeds**2 / 2.0 / temperature) / norm
    top, half = math.sqrt(f * temperature / mass), (f - d) / 2.0
    norm = top**d / 2.0 * math.exp(math.lgamma(d / 2.0) + math.lgamma(half) - math.lgamma(d / 2.0 + half))
    return speeds ** (d - 1) * np.maximum(0.0, 1.0 - (speeds / top) ** 2) ** (half - 1.0) / norm


def enskog_contact(d, fractions, first, second):
    """Return the contact value of bodies of radii `first` and `second` in the Enskog equation: spheres of
    Boublik and of Mansoori and others, discs of Jenkins and Mancini.

    fractions: (packing fraction, sum of n pi R (discs) or 4/3 pi R^2 (spheres), the second moment of sizes)
    """
    filled, surface = fractions
    free, between = 1.0 - filled, 2.0 * first * second / (first + second)
    if d == 2:
        return 1.0 / free + 9.0 / 16.0 * surface * between / free**2
    return 1.0 / free + 1.5 * surface * between / free**2 + 0.5 * (surface * between) ** 2 / free**3


class FreeMolecular:
    """Gas without collisions between two plates with Maxwell's accommodation, at distance L (of centres).

    temperatures, velocities, accommodations: of the low and the high plate; n: mean number density.
    """

    def __init__(self, d, n, mass, temperatures, velocities=(0.0, 0.0), accommodations=(1.0, 1.0)):
        (a, b), (t, s) = accommodations, temperatures
        # share[i][j]: part of the flux that leaves plate i that was drawn at plate j
        low = a / (1.0 - (1.0 - a) * (1.0 - b))
        high = b / (1.0 - (1.0 - a) * (1.0 - b))
        share = np.array([[low, 1.0 - low], [1.0 - high, high]])
        self.share, self.mass, self.n, self.d = share, mass, n, d
        self.temperatures, self.velocities = np.array([t, s]), np.array(velocities)
        stay = np.sqrt(math.pi * mass / 2.0 / self.temperatures)  # mean of 1 / v of a flux
        self.rate = n / float((share @ stay).sum())
        self.stay = stay

    @property
    def heat_flux(self):
        """Energy that passes from the low to the high plate per time and area."""
        energy = (self.d + 1.0) / 2.0 * self.temperatures + self.mass / 2.0 * self.velocities**2
        leaving = self.share @ energy
        return self.rate * float(leaving[0] - leaving[1])

    @property
    def stress(self):
        """Momentum along the plates that passes from the low to the high one per time and area."""
        leaving = self.share @ self.velocities
        return self.rate * self.mass * float(leaving[0] - leaving[1])

    @property
    def pressure(self):
        """Momentum that each plate is given along its normal per time and area."""
        speed = np.sqrt(math.pi * self.temperatures / (2.0 * self.mass))  # mean v of a flux
        return self.rate * self.mass * float((self.share @ speed).sum())

    @property
    def mean_velocity(self):
        """Mean velocity along the plates."""
        return float((self.share @ (self.stay * self.velocities)).sum() / (self.share @ self.stay).sum())

    @property
    def temperature_along(self):
        """Mean of m v^2 of a component along the plates in which they do not slide."""
        return float((self.share @ (self.stay * self.temperatures)).sum() / (self.share @ self.stay).sum())

    @property
    def temperature_of_slide(self):
        """Mean of m v^2 of the component in which the plates slide, about its mean velocity."""
        squares = self.temperatures + self.mass * self.velocities**2
        mean = (self.share @ (self.stay * squares)).sum() / (self.share @ self.stay).sum()
        return float(mean - self.mass * self.mean_velocity**2)

    @property
    def temperature_across(self):
        """Mean of m v^2 of the component across the plates."""
        return self.pressure / self.n


def effusion(area, activities, mass, temperatures):
    """Return the net flux between reservoirs of points, A (z1 sqrt(T1 / 2 pi m) - z2 sqrt(T2 / 2 pi m))."""
    low, high = (
        z * math.sqrt(t / 2.0 / math.pi / mass) for z, t in zip(activities, temperatures, strict=True)
    )
    return area * (low - high)


def free_correlation(lags, length, mass, temperature, f, terms=199):
    """Return <x(0) x(t)> - <x>^2 and <v(0) v(t)> of points between hard walls, by the series of images.

    x = L/2 - sum over odd n of 4 L / (n pi)^2 cos(n pi q / L), q the position continued over 2 L, so that
    <cos(a v)> of a component at fixed energy (a Bessel function) or Maxwell's gives both.
    """
    n = np.arange(1, terms + 1, 2)[:, None]
    a = n * math.pi / length * np.asarray(lags)[None]
    places = (8.0 * length**2 / (n * math.pi) ** 4 * _mean_cosine(a, mass, temperature, f)).sum(axis=0)
    # v(t) = v sign(sin(pi q / L)): <v(0) v(t)> = sum over odd n of 8 / (n pi)^2 <v^2 cos(n pi v t / L)>
    speeds = 8.0 / (n * math.pi) ** 2 * _mean_square_cosine(a, mass, temperature, f)
    return places, speeds.sum(axis=0)


def _mean_cosine(a, mass, temperature, f):
    """Return <cos(a v)> of a component."""
    if f is None:
        return np.exp(-(a**2) * temperature / mass / 2.0)
    z = a * math.sqrt(f * temperature / mass)
    order = f / 2.0 - 1.0
    with np.errstate(all="ignore"):
        value = np.exp(math.lgamma(f / 2.0) + order * np.log(2.0 / z)) * special.jv(order, z)
    return np.where(z < 1e-6, 1.0, value)


def _mean_square_cosine(a, mass, temperature, f):
    """Return <v^2 cos(a v)> of a component, minus the second derivative of <cos(a v)>."""
    if f is None:
        u = temperature / mass
        return u * (1.0 - a**2 * u) * np.exp(-(a**2) * u / 2.0)
    step = 1e-3 / math.sqrt(f * temperature / mass) * f**0.5
    above, at, below = (_mean_cosine(np.abs(a + s), mass, temperature, f) for s in (step, 0.0, -step))
    return -(above - 2.0 * at + below) / step**2
