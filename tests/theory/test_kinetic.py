"""Numbers of kinetic theory that gaspart.theory has from the literature, derived again."""

import numpy as np
import pytest
from theory.half_space import temperature_jump, velocity_slip

from gaspart import theory
from gaspart.theory import heat, shear
from gaspart.theory.boltzmann import brackets, collisions


@pytest.mark.parametrize(("dimension", "orders", "nodes"), [(2, 5, 12), (3, 4, 8)])
def test_chapman_and_enskogs_transport_coefficients_of_a_dilute_gas(dimension, orders, nodes):
    """The first approximations exactly; the fifth in two dimensions, the fourth in three, are below the last
    digits by what the sequence still gains."""
    d, eta = dimension, 1e-9
    met = collisions(d, nodes)
    density = theory.number_density(eta, d)
    flux = np.eye(orders)[0]

    def inverse(rank, first, tagged, size):
        """Entry (0, 0) of the inverse, by the number of polynomials."""
        matrix = brackets(rank, range(first, first + orders), met, tagged)
        return [size**2 * np.linalg.solve(matrix[:n, :n], flux[:n])[0] for n in (1, orders - 1, orders)]

    approximations = {
        "diffusion": np.array(inverse(1, 0, True, d)) / d,
        "viscosity": np.array(inverse(2, 0, False, d * (d + 2))) * (d - 1) / (d * (d - 1) * (d + 2)),
        "conductivity": np.array(inverse(1, 1, False, 0.5 * d * (d + 2))) / d,
    }
    tabulated = {
        "diffusion": theory.enskog_diffusion(eta, d) * density,
        "viscosity": theory.enskog_viscosity(eta, d),
        "conductivity": theory.enskog_conductivity(eta, d),
    }
    exact_first = {2: (0.5, 0.5, 2.0), 3: (3 / 8, 5 / 16, 75 / 64)}[d]
    for (name, found), factor in zip(approximations.items(), exact_first, strict=True):
        assert found[0] == pytest.approx(factor / np.sqrt(np.pi), rel=1e-9), name
        gained = found[2] - found[1]
        assert 0.0 < gained < 1e-3 * found[2], name
        assert found[2] <= tabulated[name] * (1.0 + 1e-5) <= found[2] + gained + 4e-5 * found[2], name


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("restitution", [0.2, 0.6, 0.9])
def test_the_cumulants_of_inelastic_gases_follow_from_the_moments(dimension, restitution):
    """To first order in a2, f = M (1 + a2 S2): the losses mu_2 and mu_4 of <c^2> and <c^4>, c^2 = v^2/2."""
    d = dimension
    weights, velocities = collisions(d, 8, restitution)
    first, second, *after = (0.5 * (v**2).sum(axis=0) for v in velocities)

    def sonine(x):
        return 0.5 * x**2 - 0.5 * (d + 2) * x + 0.125 * d * (d + 2)

    change = sonine(first) + sonine(second)
    losses = [first**p + second**p - after[0] ** p - after[1] ** p for p in (1, 2)]
    (m2, more2), (m4, more4) = ((weights @ lost, (weights * change) @ lost) for lost in losses)
    cooling = (m4 - (d + 2) * m2) / ((d + 2) * (m2 + more2) - more4)
    driven = (m4 - (d + 2) * m2) / ((d + 2) * more2 - more4)
    assert theory.fourth_cumulant(restitution, d) == pytest.approx(cooling, rel=1e-9)
    assert theory.driven_cumulant(restitution, d) == pytest.approx(driven, rel=1e-9)
    # energy lost per time, and collisions per time, over those of Maxwell's gas: 1 + 3 a2 / 16, 1 - a2 / 16
    assert more2 / m2 == pytest.approx(3.0 / 16.0, rel=1e-9)
    assert (weights @ change) / weights.sum() == pytest.approx(-1.0 / 16.0, rel=1e-9)


def test_the_temperature_jump_is_that_of_the_linearised_boltzmann_equation():
    """Moments up to degree 3, 5, 7 (9, 11) give 1.879, 2.075, 2.103 (2.111, 2.116): the errors fall with
    about the third power of the degree. Maxwell's elementary value is far off."""
    less, more = (temperature_jump(highest, highest + 1) for highest in (5, 7))
    limit = more + (more - less) / ((7.0 / 5.0) ** 3 - 1.0)
    assert less < more < limit
    assert abs(limit - heat.TEMPERATURE_JUMP) < more - less
    assert limit - heat.ELEMENTARY_JUMP > 8.0 * (more - less)


def test_the_velocity_slip_is_that_of_the_linearised_boltzmann_equation():
    """Moments up to degree 4, 6, 8 give 1.084, 1.098, 1.103. Maxwell's elementary value is far off."""
    less, more = (velocity_slip(highest, highest) for highest in (4, 6))
    limit = more + (more - less) / ((6.0 / 4.0) ** 3 - 1.0)
    assert less < more < limit
    assert abs(limit - theory.VELOCITY_SLIP) < more - less
    assert more - shear.ELEMENTARY_SLIP > 6.0 * (more - less)
