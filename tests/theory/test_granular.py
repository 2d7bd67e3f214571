"""Rough and inelastic gases against averages over Maxwellian pairs of the contact law itself."""

import numpy as np
import pytest

import gaspart as gp
from gaspart import theory


def drawn_matrix(q, tangential, normal, pairs=400_000):
    """rough_matrix by Monte Carlo: the mean changes of energy of one contact of equal discs, weighted by the
    chance of the contact, the approach speed. Spencer 2022, Eqs. 26, 35 and 38, unit mass and radius."""
    rng = np.random.default_rng(3)
    columns = []
    for spin in (0.0, 1.0):  # linear in T_rot at T_tr = 1
        v = rng.standard_normal((2, pairs, 2))  # normal, tangential component of both particles
        w = np.sqrt(spin / q) * rng.standard_normal((2, pairs))
        gn, gt = v[0, :, 0] - v[1, :, 0], v[0, :, 1] - v[1, :, 1] + w[0] + w[1]
        weight = np.where(gn > 0.0, gn, 0.0)
        jn = -(1.0 + normal) * gn / 2.0
        jt = -(1.0 + tangential) * gt / (2.0 + 2.0 / q)
        translation = jn * gn + jn**2 + jt * (v[0, :, 1] - v[1, :, 1]) + jt**2
        rotation = 0.5 * q * ((w[0] + jt / q) ** 2 - w[0] ** 2 + (w[1] + jt / q) ** 2 - w[1] ** 2)
        # a contact is one collision of two particles: per ds, N/2 ds contacts; T_tr = E / N, T_rot = 2 E / N
        columns.append([0.5 * np.average(translation, weights=weight), np.average(rotation, weights=weight)])
    smooth, both = np.array(columns)
    return np.stack([smooth, both - smooth], axis=1)


@pytest.mark.parametrize(("q", "tangential", "normal"), [(0.5, 1.0, 1.0), (0.5, 0.0, 0.8), (0.2, -0.5, 1.0)])
def test_the_matrix_is_the_mean_of_the_contact_law(q, tangential, normal):
    found = drawn_matrix(q, tangential, normal)
    assert found == pytest.approx(theory.rough_matrix(q, tangential, normal), abs=0.003)


def test_perfectly_rough_discs_share_equally_at_the_known_rate():
    for q in (0.1, 0.5, 1.0):
        s = np.linspace(0.0, 3.0, 7)
        translation, rotation = theory.rough_temperatures(s, q, 1.0)
        assert translation - rotation == pytest.approx(np.exp(-3.0 * q / (1.0 + q) ** 2 * s), rel=1e-12)
        assert 2.0 * translation + rotation == pytest.approx(2.0, rel=1e-12)
        assert theory.rough_ratio(q, 1.0) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("q", [0.1, 0.5, 1.0])
def test_between_rough_walls_every_hit_follows_the_contact_law(q, particles=200_000):
    """Spencer 2022, Eqs. 26 and 40, unit mass, radius and distance, at one wall after the other."""
    rng = np.random.default_rng(4)
    v, w = rng.standard_normal(particles), np.zeros(particles)
    normal, upwards = np.abs(rng.standard_normal(particles)), rng.random(particles) < 0.5
    next_hit = rng.random(particles) / normal
    start = np.mean(v**2)
    for time in (0.2, 0.6, 1.0, 2.5):
        while (next_hit < time).any():
            hits = next_hit < time
            side = np.where(upwards, 1.0, -1.0)  # of the wall; the surface moves at v - side w along x
            impulse = np.where(hits, -2.0 / (1.0 + 1.0 / q) * (v - side * w), 0.0)
            v, w = v + impulse, w - side * impulse / q
            upwards = upwards ^ hits
            next_hit = np.where(hits, next_hit + 1.0 / normal, next_hit)
        found = np.mean(v**2 - q * w**2) / start
        assert found == pytest.approx(
            theory.rough_wall_difference(time, q), abs=4.0 * 1.7 / np.sqrt(particles)
        )
    assert theory.rough_wall_difference(0.0, q) == pytest.approx(1.0, abs=2.1e-4)
    lost = 1.0 - theory.rough_wall_difference(0.01, q)  # of 4q/(1+q)^2, twice, at each of |v| t / h hits
    assert lost == pytest.approx(8.0 * q / (1.0 + q) ** 2 * 0.01 * np.sqrt(2.0 / np.pi), rel=1e-6)


def test_the_ratio_is_where_the_temperatures_tend():
    translation, rotation = theory.rough_temperatures(200.0, 0.5, 0.2, 0.9)
    assert rotation / translation == pytest.approx(theory.rough_ratio(0.5, 0.2, 0.9), rel=1e-9)


def test_smooth_discs_cool_by_haffs_law():
    assert theory.rough_matrix(0.5, -1.0, 0.9)[0, 0] == pytest.approx(-(1.0 - 0.81) / 2.0)
    assert theory.fourth_cumulant(0.9, 3) == pytest.approx(-0.01456, abs=1e-5)
    assert theory.fourth_cumulant(np.sqrt(0.5), 2) == pytest.approx(0.0, abs=1e-15)
    assert theory.cooling_rate(0.9, 2) == pytest.approx(0.095 * (1.0 - 0.02686 / 4.0), rel=1e-4)
    # T(t) of Haff's law falls at first by the cooling rate times the collision rate
    slowed = 1.0 - theory.fourth_cumulant(0.9, 2) / 16.0
    assert 2.0 / theory.haff_time(0.9, 2, 0.3) == pytest.approx(theory.cooling_rate(0.9, 2) * slowed * 0.3)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("e", [0.0, 0.4, 0.8, 0.99])
def test_the_moments_of_the_cooling_gas_are_those_of_the_driven_one(dimension, e):
    """From mu_4 = (d + 2) (1 + a2) mu_2 and mu_4 = (d + 2) mu_2, with the same moments to first order."""
    fourth = dimension + 1.5 + e**2
    slope = 3.0 * (10.0 * dimension + 39.0 + 10.0 * e**2) / 32.0 + (dimension - 1.0) / (1.0 - e)
    for own, found in ((1.0, theory.fourth_cumulant), (0.0, theory.driven_cumulant)):
        expected = (dimension + 2 - fourth) / (slope - (dimension + 2) * (own + 3.0 / 16.0))
        assert found(e, dimension) == pytest.approx(expected, rel=1e-12)


def test_the_driven_gas_loses_what_it_is_given():
    """In its steady state -dT/dt of the cooling gas is 2 power/d, but for the cumulant, which is another."""
    for e, dimension in ((0.999, 2), (0.999, 3)):
        temperature = theory.driven_temperature(e, dimension, 0.02, 0.1)
        rate = theory.collision_rate(0.1, dimension, temperature=float(temperature))
        lost = theory.cooling_rate(e, dimension) * rate * temperature
        assert lost == pytest.approx(2.0 * 0.02 / dimension, rel=1e-3)


@pytest.mark.parametrize(("count", "dimension"), [(4, 2), (30, 3)])
def test_the_cumulant_of_few_maxwellian_particles_is_not_zero(count, dimension):
    velocities = np.random.default_rng(9).standard_normal((200_000, count, dimension))
    velocities -= velocities.mean(axis=1, keepdims=True)
    squares = (velocities**2).sum(axis=2)
    second = (squares.mean(axis=1) ** 2).mean()
    found = dimension * (squares**2).mean() / ((dimension + 2) * second) - 1.0
    expected = theory.finite_size_cumulant(0.0, count, dimension)
    assert found == pytest.approx(expected, abs=0.02 * abs(expected) + 1e-3)


def test_few_driven_particles_are_as_warm_as_many():
    """Of 12 spheres: 6 % more than if their power alone were that without the centre of mass's share."""
    count, eta, e, ratios = 12, 0.002, 0.7, []
    side = float(count / theory.number_density(eta, 3)) ** (1.0 / 3.0)
    power = 0.5 * (1.0 - e**2) * theory.collision_rate(eta, 3)
    power *= 1.0 + 0.1875 * theory.driven_cumulant(e, 3)
    assert theory.driven_temperature(e, 3, power, eta) == pytest.approx(1.0)
    time = 1.0 / float(theory.collision_rate(eta, 3))
    scene = gp.Scene(
        gp.Container((side,) * 3, "periodic"),
        species=[gp.Species(count, 0.5, temperature=1.0)],
        restitution=gp.Restitution(e),
        thermostat=gp.Thermostat(float(power), 0.031 * time),
    )
    for seed in range(6):
        run = gp.Simulation(scene, gp.EventDriven(), seed=seed)
        run.advance(duration=20.0 * time)
        sums = []
        for _ in range(200):
            run.advance(duration=4.0 * time)
            moved = run.state.velocities - run.state.velocities.mean(axis=0)
            sums.append((moved**2).sum() / (3.0 * (count - 1)))
        ratios.append(np.mean(sums))
    error = np.std(ratios, ddof=1) / np.sqrt(6)
    assert error < 0.015
    assert np.mean(ratios) == pytest.approx(1.0, abs=3.5 * error)


@pytest.mark.parametrize(("count", "dimension"), [(3, 2), (4, 3), (20, 2)])
def test_few_particles_of_one_energy_lose_more_or_less_of_it(count, dimension):
    """By the mean square of the approach speed at contacts, of velocities uniform on their sphere: 4 T of
    Maxwellian ones."""
    velocities = np.random.default_rng(8).standard_normal((400_000, count, dimension))
    velocities -= velocities.mean(axis=1, keepdims=True)
    velocities *= np.sqrt(count * dimension / (velocities**2).sum(axis=(1, 2)))[:, None, None]
    approach = np.maximum(velocities[:, 0, 0] - velocities[:, 1, 0], 0.0)
    factor = theory.cooling_rate_finite_size_factor(count, dimension)
    assert (approach**3).mean() / approach.mean() / 4.0 == pytest.approx(factor, rel=0.01)
    assert theory.cooling_rate_finite_size_factor(1e9, dimension) == pytest.approx(1.0, abs=1e-8)


@pytest.mark.parametrize(
    ("function", "arguments"),
    [
        (theory.fourth_cumulant, (1.1, 2)),
        (theory.driven_cumulant, (1.1, 2)),
        (theory.rough_matrix, (0.0, 1.0)),
        (theory.rough_matrix, (0.5, 1.5)),
        (theory.rough_ratio, (0.5, -1.0)),
        (theory.rough_wall_difference, (1.0, 0.0)),
        (theory.rough_wall_difference, (-1.0, 0.5)),
    ],
)
def test_invalid_arguments_are_refused(function, arguments):
    with pytest.raises(ValueError):
        function(*arguments)
