import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid

from gaspart import theory
from gaspart.theory.boltzmann import relaxing_speeds, tagged_paths
from gaspart.theory.brownian import friction_rate, langevin_msd, langevin_msd_from_rest, tagged_diffusion
from gaspart.theory.diffusion import velocity_decay_rate


def test_friction_of_a_particle_as_large_as_the_gas_is_enskogs():
    """For R = r and M = m it is the velocity decay rate of the gas itself, and D is Enskog's, if dilute."""
    eta = 1e-7
    density = theory.number_density(eta, 3)
    rate = friction_rate(density, 1.0, 1.0)
    assert rate == pytest.approx(velocity_decay_rate(eta, 3), rel=1e-5)
    assert tagged_diffusion(rate, 1.0) == pytest.approx(theory.enskog_diffusion(eta, 3), rel=1e-5)


def test_friction_of_a_heavy_particle_is_the_drag_of_free_molecular_flow():
    """M g V = (4/3) pi a^2 n m <v> V (Epstein's drag of a smooth sphere)."""
    drag = 1e6 * friction_rate(0.01, 3.0, 1e6, 1.0, 2.0)
    assert drag == pytest.approx(4 / 3 * np.pi * 9.0 * 0.01 * theory.mean_speed(3, 2.0), rel=1e-6)


def test_collisions_carry_the_friction():
    """By <(V(0)/V^2).dV> of random kicks of a heavy particle, drawn from a Maxwellian flux."""
    rng = np.random.default_rng(1)
    particle, drift = 50.0, 0.02
    gas = rng.standard_normal((400_000, 3))
    relative = gas - [drift, 0.0, 0.0]
    normal = rng.standard_normal(gas.shape)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    along = (relative * normal).sum(axis=1)
    kick = 2.0 * particle / (1.0 + particle) / particle * np.minimum(along, 0.0) * normal[:, 0]
    chance = 4.0 * np.pi * np.maximum(-along, 0.0)  # per time, at n a^2 = 1
    rate = -(kick * chance).mean() / drift
    scatter = (kick * chance).std() / np.sqrt(len(kick)) / drift
    assert abs(rate - friction_rate(1.0, 1.0, particle)) < 3.5 * scatter


def test_langevin_displacements():
    t = np.array([0.0, 1e-4, 9e-4, 1.1e-3, 0.3, 4.0, 50.0])
    assert langevin_msd(t, 2.0, 0.5)[-1] == pytest.approx(12.0 * (50.0 - 2.0), rel=1e-9)
    assert langevin_msd(1e-4, 2.0, 0.5) == pytest.approx(3.0 * 2.0 * 0.5 * 1e-8, rel=1e-4)
    rest = langevin_msd_from_rest(t, 2.0, 0.5)
    assert rest[-1] == pytest.approx(12.0 * (50.0 - 3.0), rel=1e-9)
    assert langevin_msd_from_rest(0.02, 2.0, 0.5) == pytest.approx(2.0 * 2.0 * 0.25 * 8e-6, rel=0.01)
    assert (np.diff(rest) > 0.0).all() and (rest[1:] < langevin_msd(t[1:], 2.0, 0.5)).all()
    # dr^2/dt = 2 <r.v>, d<r.v>/dt = <v^2> - g <r.v>, <v^2> = 3 D g (1 - e^-2gt)
    fine = np.linspace(0.0, 4.0, 4001)
    energy = 3.0 * 2.0 * 0.5 * (1.0 - np.exp(-fine))
    rv = np.exp(-0.5 * fine) * cumulative_trapezoid(energy * np.exp(0.5 * fine), fine, initial=0.0)
    assert 2.0 * np.trapezoid(rv, fine) == pytest.approx(rest[5], rel=1e-5)


# The linear Boltzmann equation of a tagged sphere, against what is known in closed form.


MAXWELL = np.asarray(theory.maxwell_ppf((np.arange(20_000) + 0.5) / 20_000, 3))


def hits(rate, mass):
    """n pi a^2 of a gas at temperature 1 in which a sphere's velocity decays at `rate` at first."""
    return float(rate * np.pi / friction_rate(1.0, 1.0, mass))


def test_a_light_sphere_in_maxwells_gas_has_equipartition_and_sonines_diffusion():
    """D is 1.01895 k_B T / (M g): the autocorrelation decays at the rate g at first, later more slowly."""
    count, interval = 6000, 0.25
    found = tagged_paths([MAXWELL] * 96, interval, hits(1.0, 1.0), 1.0, count, seed=1)
    v, x = found.velocities[32:], found.displacements[32:]
    energies = (v**2).mean(axis=(0, 2))
    assert energies.mean() == pytest.approx(1.0, abs=4.0 * energies.std() / count**0.5)
    # 6 D t from where the velocity has been forgotten on: the slope of the msd from 6 to 12 friction times
    late = ((x[48:] - x[:-48]) ** 2).sum(axis=2).mean(axis=0)
    early = ((x[24:] - x[:-24]) ** 2).sum(axis=2).mean(axis=0)
    slopes = (late - early) / (6.0 * 6.0)
    assert slopes.mean() == pytest.approx(1.01895, abs=4.0 * slopes.std() / count**0.5)


def test_a_heavy_sphere_feels_the_mean_speed_of_the_gas():
    """M g V = (4/3) pi a^2 n m <c> V whatever the distribution of speeds: of equal speeds it is sqrt(3 pi /
    8) = 1.085 of that in Maxwell's gas of the same energy."""
    mass = 40.0
    found = tagged_paths([np.full(1, 3.0**0.5)] * 40, 0.5, hits(1.0, mass), mass, 4000, seed=3)
    v = found.velocities[12:]
    decay = -np.log((v[2:] * v[:-2]).mean() / (v**2).mean())
    assert decay == pytest.approx((3.0 * np.pi / 8.0) ** 0.5, abs=0.03)


def test_a_gas_of_equal_speeds_relaxes_by_its_own_collisions():
    """As fast as the table of relaxation states, in which time counts collisions: 4/3 n pi d^2 at first."""
    times = np.array([0.02, 0.3, 0.6])
    speeds = relaxing_speeds(40_000, times, 1.0, seed=4)
    squares = speeds**2
    assert squares.mean(axis=1) == pytest.approx(np.ones(3), rel=1e-10)
    kurtosis = (squares**2).mean(axis=1)
    collisions = 4.0 / 3.0 * times  # <g> falls to 0.977 of 4/3, hardly during these
    assert kurtosis == pytest.approx(theory.relaxation(3).kurtosis(collisions), abs=0.012)
