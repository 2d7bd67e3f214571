import numpy as np
import pytest

from gaspart import theory


def test_friction_of_a_particle_as_large_as_the_gas_is_enskogs():
    """For R = r and M = m it is the velocity decay rate of the gas itself, and D is Enskog's, if dilute."""
    eta = 1e-7
    density = theory.number_density(eta, 3)
    rate = theory.friction_rate(density, 1.0, 1.0)
    assert rate == pytest.approx(theory.velocity_decay_rate(eta, 3), rel=1e-5)
    assert theory.tagged_diffusion(rate, 1.0) == pytest.approx(theory.enskog_diffusion(eta, 3), rel=1e-5)


def test_friction_of_a_heavy_particle_is_the_drag_of_free_molecular_flow():
    """M g V = (4/3) pi a^2 n m <v> V (Epstein's drag of a smooth sphere)."""
    drag = 1e6 * theory.friction_rate(0.01, 3.0, 1e6, 1.0, 2.0)
    assert drag == pytest.approx(4 / 3 * np.pi * 9.0 * 0.01 * theory.mean_speed(3, 2.0), rel=1e-6)


def test_collisions_carry_the_friction():
    """Random kicks: <(V(0)/V^2).dV> per collision of a heavy particle, drawn from a Maxwellian flux, give
    g."""
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
    assert abs(rate - theory.friction_rate(1.0, 1.0, particle)) < 3.5 * scatter


def test_langevin_displacements():
    t = np.array([0.0, 1e-4, 9e-4, 1.1e-3, 0.3, 4.0, 50.0])
    assert theory.langevin_msd(t, 2.0, 0.5)[-1] == pytest.approx(12.0 * (50.0 - 2.0), rel=1e-9)
    assert theory.langevin_msd(1e-4, 2.0, 0.5) == pytest.approx(3.0 * 2.0 * 0.5 * 1e-8, rel=1e-4)
    rest = theory.langevin_msd_from_rest(t, 2.0, 0.5)
    assert rest[-1] == pytest.approx(12.0 * (50.0 - 3.0), rel=1e-9)
    assert theory.langevin_msd_from_rest(0.02, 2.0, 0.5) == pytest.approx(2.0 * 2.0 * 0.25 * 8e-6, rel=0.01)
    assert (np.diff(rest) > 0.0).all() and (rest[1:] < theory.langevin_msd(t[1:], 2.0, 0.5)).all()
    fine = np.linspace(
        0.0, 4.0, 4001
    )  # dr^2/dt = 2 <r.v>, d<r.v>/dt = <v^2> - g <r.v>, <v^2> = 3 D g (1 - e^-2gt)
    energy = 3.0 * 2.0 * 0.5 * (1.0 - np.exp(-fine))
    rv = np.exp(-0.5 * fine) * np.concatenate(
        [
            [0.0],
            np.cumsum(
                0.5 * np.diff(fine) * ((energy * np.exp(0.5 * fine))[1:] + (energy * np.exp(0.5 * fine))[:-1])
            ),
        ]
    )
    assert 2.0 * np.trapezoid(rv, fine) == pytest.approx(rest[5], rel=1e-5)
