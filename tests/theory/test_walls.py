"""Pressure on walls against the exact second order, on both kinds of container, and where it is refused."""

import math
from pathlib import Path

import numpy as np
import pytest
from theory.clusters import cluster_integrals

from gaspart import theory
from gaspart.theory import walls


def surface_tension(eta, dimension):
    return walls._element(eta, dimension, 0)


def surface_tension_uncertainty(eta, dimension):
    further = walls._estimate_neglected(dimension, 0)
    return np.abs(walls._element(eta, dimension, 0, further) - surface_tension(eta, dimension))


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_tension_starts_with_its_exact_second_order(dimension):
    first = {2: 1.0 / 3.0, 3: math.pi / 8.0}[dimension] * theory.number_density(1e-5, dimension) ** 2
    assert surface_tension(1e-5, dimension) == pytest.approx(-first, rel=1e-3)
    eta = np.array([0.01, 0.1, 0.3, 0.45])
    assert np.all(surface_tension_uncertainty(eta, dimension) > 0.0)


def test_the_tension_of_spheres_is_white_bears_within_its_uncertainty():
    """Hansen-Goos and Roth 2006; its uncertainty: the distance from scaled particle theory, or 1 %."""
    table = Path(__file__).parent / "data" / "white_bear_tension.csv"
    for eta, tension, uncertainty in np.loadtxt(table, delimiter=",", skiprows=1):
        unsure = np.hypot(uncertainty, surface_tension_uncertainty(eta, 3))
        assert surface_tension(eta, 3) == pytest.approx(tension, abs=2.0 * unsure)


def expansion(dimension, highest, seeds, samples):
    """gamma, tau (and kappa) to the order `highest`: their polynomials in eta, see `walls`, and their errors,
    (kinds, highest - 1) each, by the cluster integrals and the virial coefficients (exact)."""
    d, unit = dimension, float(theory.packing_fraction(1.0, dimension))
    virial = theory.virial_coefficients(d, highest)[0] * unit ** np.arange(highest)
    logarithm = np.array([0.0, *((n + 1) / n * virial[n] for n in range(1, highest))])

    def product(*factors):
        found = np.eye(highest)[0]
        for factor in factors:
            found = np.convolve(found, factor)[:highest]
        return found

    excess = sum(product(*[logarithm] * k) / math.factorial(k) for k in range(highest))  # z / rho
    rows = []
    for seed in seeds:
        kinds = np.zeros((d, highest - 1))
        for n in range(2, highest + 1):
            found = cluster_integrals(n, d, samples, seed)
            power = product(*[excess] * n)[: highest + 1 - n]
            kinds[:, n - 2 :] += np.multiply.outer(found[1:], power)
        rows.append(-(kinds.T * (-0.5) ** np.arange(1, d + 1)).T)
    away = [math.comb(d, k) * (-1.0) ** k for k in range(d + 1)]  # (1 - eta)^d
    scaled = np.array(rows) / unit ** np.arange(highest - 1)
    exact = np.array(walls._SECOND_ORDER[d])[:, None]
    shapes = np.array([[np.convolve(kind, away)[: highest - 1] for kind in row] for row in scaled / exact])
    return shapes.mean(axis=0), shapes.std(axis=0, ddof=1) / math.sqrt(len(rows))


@pytest.mark.parametrize("dimension", [2, 3])
def test_surfaces_edges_and_corners_are_those_of_the_cluster_integrals(dimension):
    found, errors = expansion(dimension, 4, range(10), 20_000)
    stated = np.array(walls._SHAPES[dimension])[:, :3]
    assert (errors[:, 0] < 0.01).all() and (errors[:, 1] < 0.05 * np.abs(stated[:, 1]) + 0.02).all()
    assert np.all(np.abs(found - stated) < 4.5 * errors)  # Student's t with 9 degrees of freedom


@pytest.mark.parametrize(
    ("count", "eta", "pressure", "error"),
    [(125, 0.2, 1.6397, 0.0006), (125, 0.1, 0.44311, 0.00025), (1000, 0.2, 1.22338, 0.00096)],
)
def test_few_spheres_in_a_cube_press_as_measured(count, eta, pressure, error):
    """Event-driven runs of 1 to 3 million collisions; edges to second order only gave 1.705 for the first."""
    length = (count / float(theory.number_density(eta, 3))) ** (1.0 / 3.0)
    expected, uncertainty = theory.wall_pressure(length, count / (length - 1.0) ** 3, count, 3, 3)
    assert uncertainty < 0.004 * expected
    assert pressure == pytest.approx(expected, abs=3.0 * np.hypot(error, uncertainty))
    assert pressure == pytest.approx(expected, rel=0.003)


def second_order(length, density, dimension, axes):
    """Z of one container to second order in the density, exact, from its free energy per particle

    -ln V + (N / 2 V^2) times the volume of pairs of centres closer than sigma, N large.
    """
    inner, width = length - 1.0, 100.0
    moments = {2: (math.pi, 4.0 / 3.0, 0.5), 3: (4.0 * math.pi / 3.0, math.pi / 2.0, 8.0 / 15.0, 1.0 / 6.0)}
    particles = density * inner**axes * width ** (dimension - axes)

    def logarithm(stretched):
        sides = [stretched] + [inner] * (axes - 1) + [width] * (dimension - axes)
        close = 0.0
        for chosen_walls in range(2**axes):  # each walled axis gives its length, or minus |x|
            chosen = [k for k in range(axes) if chosen_walls >> k & 1]
            lengths = math.prod(side for k, side in enumerate(sides) if k not in chosen)
            close += (-1) ** len(chosen) * moments[dimension][len(chosen)] * lengths
        volume = math.prod(sides)
        return math.log(volume) - 0.5 * particles * close / volume**2

    step = 1e-4 * inner
    return inner * (logarithm(inner + step) - logarithm(inner - step)) / (2.0 * step)


@pytest.mark.parametrize(("dimension", "axes"), [(2, 1), (2, 2), (3, 1), (3, 2), (3, 3)])
def test_a_dilute_gas_in_any_container_is_exact_to_second_order(dimension, axes):
    length, density = 12.0, 1e-3
    value, error = theory.wall_pressure(length, density, 10**9, dimension, axes)
    eta = theory.packing_fraction(density, dimension)
    bulk = {2: 2.0, 3: 4.0}[dimension] * eta
    # What walls take off; third orders are half a per cent of it.
    found = value / density - theory.compressibility_factor(eta, dimension)
    assert found == pytest.approx(second_order(length, density, dimension, axes) - 1.0 - bulk, rel=0.01)
    assert 0.0 < error < 1e-3 * abs(found) * density


def test_a_wide_slit_holds_the_bulk():
    z = theory.compressibility_factor(0.3, 3)
    density = theory.number_density(0.3, 3)
    value, _ = theory.wall_pressure(1e5, density, 10**9, 3, 1)
    assert value == pytest.approx(density * z, rel=1e-4)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [((1.0, 0.1, 10, 2, 1), "length"), ((9.0, 0.1, 10, 2, 3), "axes"), ((9.0, 1.3, 99, 3, 1), "density")],
)
def test_invalid_containers_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        theory.wall_pressure(*arguments)


def two_spheres_in_a_cube(length):
    """The pressure of two spheres on the walls of a cube of at least two diameters: exact."""
    moments = 4.0 * math.pi / 3.0, math.pi / 2.0, 8.0 / 15.0, 1.0 / 6.0

    def logarithm(sides):
        close = 0.0
        for cut in range(8):
            left = [side for axis, side in enumerate(sides) if not cut >> axis & 1]
            close += (-1) ** (3 - len(left)) * moments[3 - len(left)] * math.prod(left)
        return math.log(math.prod(sides) ** 2 - close)

    inner, step = length - 1.0, 1e-5
    change = logarithm((inner + step, inner, inner)) - logarithm((inner - step, inner, inner))
    return change / (2.0 * step) / inner**2


@pytest.mark.parametrize("length", [2.5, 3.0, 4.0, 6.0])
def test_two_spheres_press_as_stated(length):
    value, error = theory.wall_pressure(length, 2.0 / (length - 1.0) ** 3, 2, 3, 3)
    assert abs(value - two_spheres_in_a_cube(length)) < 3.0 * error and error < 0.05 * value


def test_opposite_walls_of_a_narrow_slit_are_in_the_uncertainty():
    """24 spheres in 6 x 6 x L: 1.403(10) at L = 2 by an independent sampler; no fluid at 1.5."""
    value, error = theory.wall_pressure(2.0, 24.0 / 36.0, 24, 3, 1)
    assert abs(value - 1.403) < 3.0 * math.hypot(error, 0.010) and abs(value - 1.403) > 0.1
    with pytest.raises(ValueError, match="length = 1.5: must be at least 2 diameters"):
        theory.wall_pressure(1.5, 24.0 / 18.0, 24, 3, 1)


def test_a_slit_is_that_of_the_density_functional_within_the_uncertainty():
    for width in (3.0, 3.5, 4.0):
        place, density = theory.white_bear_slit(0.573, width, 0.02)
        mean = float(np.trapezoid(density, place)) / (width - 1.0)
        value, error = theory.wall_pressure(width, mean, 10**9, 3, 1)
        assert abs(value - density[0]) < 3.0 * error


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_pressure_of_a_rare_gas_is_that_of_points(dimension):
    """P / (n k_B T) - 1 is 2^(d-1) eta (1 - 1/N) to first order, for any number of walls."""
    volume = math.pi / 4.0 if dimension == 2 else math.pi / 6.0
    for eta in (1e-9, 1e-6, 1e-4):
        for axes in range(1, dimension + 1):
            density = eta / volume
            side = (50.0 / density) ** (1.0 / dimension)
            value, error = theory.wall_pressure(side + 1.0, density, 50, dimension, axes)
            first = 2.0 ** (dimension - 1) * eta * 0.98
            assert value / density - 1.0 == pytest.approx(first, rel=0.04)
            assert error < 1e-4 * first * density
