r"""Hard particles between hard walls: effect of a finite container on the pressure on its walls.

The container has walls on w of its d axes. Centres move only within l_k = L_k - sigma on each of these axes.
The thermodynamics of the fluid applies to the volume V that centres can reach. The surface tension gamma
refers to the plane that the centres can reach. The free energy tau belongs to an edge in 3D and to a corner
in 2D. The free energy kappa belongs to a corner in 3D. With these the grand potential is

.. math:: \Omega / V = -P + \gamma s_1 + \tau s_2 + \kappa s_3, \quad
          s_1 = \sum_i 2 / l_i, \quad s_2 = \sum_{i<j} 4 / l_i l_j, \quad s_3 = 8 / l_1 l_2 l_3 .

Its derivative with respect to the chemical potential is the number of particles. Its derivative with respect
to one of the lengths is the force on a wall:

.. math:: N / V = \rho + \Gamma s_1 + \Gamma_\tau s_2 + \Gamma_\kappa s_3, \qquad
          F / A = P - 2 (w-1) \gamma / l - 2 (w-1)(w-2) \tau / l^2 ,

this is the force for equal lengths; otherwise the derivative is computed by differences. Gamma = - rho (d
gamma / d rho) / (dP / d rho), and the other adsorptions follow by the same rule. rho is the density of a bulk
fluid with the same chemical potential. Between two walls (w = 1) there are no edges, and the pressure on the
walls is P. gamma, tau and kappa are exact to fifth order in the density, from cluster integrals (`clusters`).
All quantities are in units of the diameter and k_B T.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np

from gaspart.errors import SceneError
from gaspart.theory.geometry import (
    Numbers,
    Values,
    check_ranges,
    checked_dimension,
    number_density,
)
from gaspart.theory.state import compressibility_factor, compressibility_uncertainty

_DENSEST = 0.49
"""Maximum packing fraction of the polynomials below."""
_SECOND_ORDER = {2: (-1.0 / 3.0, 1.0 / 16.0), 3: (-math.pi / 8.0, 1.0 / 15.0, -1.0 / 96.0)}
"""Coefficients of rho^2 in gamma, tau and kappa, from the overlap of two centres in a box (exact)."""
_SHAPES: dict[int, tuple[tuple[float, ...], ...]] = {
    2: ((1.0, 0.3564, 0.0695, -0.0916), (1.0, -4.5011, -1.1219, -0.004)),
    3: (
        (1.0, 1.2577, -0.195, -1.171),
        (1.0, -8.425, -3.54, 11.05),
        (1.0, -27.49, 137.6, -114.7),
    ),
}
"""Polynomials in eta: gamma, tau and kappa times (1 - eta)^d divided by their second order. They follow from
the virial coefficients and the cluster integrals of three to five centres (`tests/theory/clusters.py`, 6 to
12 million samples each; the known bulk integral is a control variate). The last digit is accurate to one or
two units. In 3D the last coefficients of the rows are accurate to 0.1, 0.6 and 4.
"""
_OPPOSITE = np.array(
    [[0.1, 0.2, 0.3, 0.4, 0.49], [-6.7, -5.05, -3.15, -2.6, -2.2], [3.0, 1.9, 1.75, 1.35, 1.0]]
)
"""Relative change of the pressure due to the opposite wall at the distance L: packing fractions, a and b of
exp(a - b (L - 3)). This is the envelope of the differences between the equations of this module and
`film.white_bear_slit`, for spheres with L from 2 to 5 and eta from 0.1 to 0.4, extrapolated to 0.49.
"""
_FREEZING = {2: 0.70, 3: 0.49}
"""Packing fractions at which discs and spheres are treated as equivalent in `_opposite`."""
SHORTEST = 2.0
"""Minimum distance between walls, in diameters, for `wall_pressure`."""
LARGEST_UNCERTAINTY = 0.1
"""Maximum relative uncertainty for `wall_pressure`; above it an error is raised."""
_STEP, _RELATIVE_STEP = 1e-4, 1e-2
"""Steps of central differences in the packing fraction: the first, or this fraction of a small one."""
_STRETCH = 1e-3  # relative step in length


def _element(packing_fraction: Numbers, dimension: int, kind: int, further: float = 0.0) -> Values:
    """Return gamma, tau or kappa (kind 0, 1, 2); `further` is the coefficient of eta^4 in its polynomial."""
    eta = np.asarray(packing_fraction, dtype=float)
    shape = np.polynomial.polynomial.polyval(eta, (*_SHAPES[dimension][kind], further))
    scale = _SECOND_ORDER[dimension][kind] * number_density(eta, dimension) ** 2
    return scale / (1.0 - eta) ** dimension * shape


def _estimate_neglected(dimension: int, kind: int) -> float:
    """Estimate the first neglected coefficient by the larger of the last two known coefficients."""
    return max(map(abs, _SHAPES[dimension][kind][-2:]))


@check_ranges
def wall_pressure(
    length: float | Sequence[float], density: float, count: int, dimension: int, axes: int
) -> tuple[float, float]:
    """Compute the mean pressure of N particles on the walls of a container, and its uncertainty.

    The result is for the canonical ensemble: the equations of the module `walls` with the canonical
    correction of first order in 1/N, including surfaces. The uncertainty has four contributions. The first is
    the equation of state. The second is surfaces, edges and corners, estimated as in
    `surface_tension_uncertainty`. The third is the effect of opposite walls on each other, which decreases
    exponentially with their distance (beyond four diameters it begins at sixth order in the density). The
    fourth is the square of the relative correction in 1/N, for the next order.

    Parameters
    ----------
    length : float or sequence of float, [1]
        Side of the container along each walled axis, in diameters, at least 2. If the sides differ, a
        sequence (axes,), first the distance between the walls on which the pressure acts.
    density : float, [1/length^d]
        Number of particles per volume accessible to centres, in units of the diameter.
    axes : int
        Number of axes along which the container has walls, from 1 to `dimension`.

    Returns
    -------
    pressure : float, [1]
        Force on a wall divided by the area accessible to centres, in k_B T / sigma^d.
    uncertainty : float, [1]
        Standard uncertainty of the pressure, in k_B T / sigma^d.

    Examples
    --------
    >>> from gaspart import theory
    >>> pressure, uncertainty = theory.wall_pressure(10.0, density=0.3, count=200, dimension=3, axes=3)
    >>> round(pressure, 4), uncertainty < 0.01
    (0.5134, True)
    """
    if not 1 <= axes <= checked_dimension(dimension):
        raise ValueError(f"axes: {axes} (from 1 to {dimension} have walls)")
    walled = int(axes)
    lengths = np.broadcast_to(np.asarray(length, dtype=float), walled)
    if not (lengths >= SHORTEST).all():
        rule = f"must be at least {SHORTEST:g} diameters: closer walls are no walls of one fluid"
        raise SceneError("length", length, rule)
    sides = tuple((lengths - 1.0).tolist())
    none = (0.0,) * walled
    eta, value, shift = (float(each) for each in _in_container(sides, density, count, dimension, none))
    errors = [number_density(eta, dimension) * float(compressibility_uncertainty(eta, dimension))]
    errors += [_opposite(eta, dimension, float(side)) * value for side in lengths]
    errors.append(shift**2 / value)
    for kind in range(walled):
        further = [0.0] * walled
        further[kind] = _estimate_neglected(dimension, kind)
        errors.append(_in_container(sides, density, count, dimension, further)[1] - value)
    error = math.hypot(*errors)
    if not error <= LARGEST_UNCERTAINTY * value:
        raise SceneError(
            "length", length, f"the pressure would be uncertain by {100.0 * error / value:.2g} %"
        )
    return value, error


def _opposite(eta: float, dimension: int, length: float) -> float:
    """Return the relative change of the pressure on a wall due to the opposite wall; discs as spheres equally
    far from freezing.
    """
    fractions, amplitudes, decays = _OPPOSITE
    dense = eta * _FREEZING[3] / _FREEZING[dimension]
    amplitude, decay = (float(np.interp(dense, fractions, values)) for values in (amplitudes, decays))
    return math.exp(amplitude - decay * (length - 3.0))


class _Container:
    """Fluid in a container with walls, as a function of the bulk packing fraction.

    sides : distances between the walls for centres
    further : coefficients for `_element`

    All quantities are per volume.
    """

    def __init__(self, sides: Sequence[float], dimension: int, further: Sequence[float]) -> None:
        self.dimension, self.further = dimension, further
        inverse = [2.0 / side for side in sides]
        sums = [
            sum(inverse),
            0.5 * (sum(inverse) ** 2 - sum(value**2 for value in inverse)),
            math.prod(inverse),
        ]
        self.elements = sums[: len(sides)]

    def surplus(self, eta: float) -> float:
        """Return the grand potential without the bulk contribution."""
        parts = zip(self.elements, range(self.dimension), self.further, strict=False)
        return sum(float(_element(eta, self.dimension, kind, more)) * size for size, kind, more in parts)

    def rise(self, eta: float) -> float:
        """Return d eta / d mu times the volume of a particle, rho / (dP / d rho)."""
        slope = _slope(lambda x: x * compressibility_factor(x, self.dimension), eta)
        return float(number_density(eta, self.dimension)) / slope

    def particles(self, eta: float) -> float:
        """Return the number of particles: bulk density plus adsorption."""
        unit = float(number_density(1.0, self.dimension))
        return eta * unit - self.rise(eta) * _slope(self.surplus, eta) / unit

    def fluctuation(self, eta: float) -> float:
        """Return dN / d mu."""
        return self.rise(eta) * _slope(self.particles, eta) / float(number_density(1.0, self.dimension))

    def bulk(self, particles: float) -> float:
        """Return the bulk packing fraction that gives this number of particles, by bisection."""
        low, high = 0.0, _DENSEST - 3.0 * _STEP
        if self.particles(high) < particles:
            raise ValueError(f"density: {particles} (the fluid would be denser than {_DENSEST})")
        while high - low > 1e-13 * high:
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.particles(middle) < particles else (low, middle)
        return high


def _in_container(
    sides: Sequence[float], density: float, count: int, dimension: int, further: Sequence[float]
) -> tuple[float, float, float]:
    """Return bulk packing fraction, pressure across the first axis, and its term of order 1/N."""
    here = _Container(sides, dimension, further)
    eta = here.bulk(density)
    bulk = float(number_density(eta, dimension) * compressibility_factor(eta, dimension))

    def stretch(factor: float) -> _Container:
        return _Container((sides[0] * factor, *sides[1:]), dimension, further)

    wide, narrow = 1.0 + _STRETCH, 1.0 - _STRETCH
    surplus = (wide * stretch(wide).surplus(eta) - narrow * stretch(narrow).surplus(eta)) / (2.0 * _STRETCH)
    shift = _canonical(stretch, density, count)
    return eta, bulk - surplus + shift, shift


def _canonical(stretch: Callable[[float], _Container], density: float, count: int) -> float:
    """Return the canonical minus the grand canonical pressure of `count` particles. The saddle point gives
    the term of N particles in the grand partition function: ln Q_N = -Omega - N mu - ln(2 pi dN/dmu) / 2. The
    result is the derivative of the last term with respect to the length of the first axis at fixed N,
    including surfaces.
    """
    logarithms = []
    for factor in (1.0 + _STRETCH, 1.0 - _STRETCH):
        container = stretch(factor)
        eta = container.bulk(density / factor)
        logarithms.append(math.log(factor * container.fluctuation(eta)))
    return -0.5 * density / count * (logarithms[0] - logarithms[1]) / (2.0 * _STRETCH)


def _slope(function: Callable[[float], Values], eta: float) -> float:
    """Return d function / d eta by a central difference."""
    step = min(_STEP, _RELATIVE_STEP * eta)
    return float(function(eta + step) - function(eta - step)) / (2.0 * step)
