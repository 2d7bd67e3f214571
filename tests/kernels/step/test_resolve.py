"""The contact of the step kernels is that of `kernels.physics`, bit for bit."""

import numpy as np
import pytest

from gaspart.kernels.compile.policy import kernel
from gaspart.kernels.model import Space, flight_dtype
from gaspart.kernels.physics import collision
from gaspart.kernels.physics.contact import contact_root, exchange
from gaspart.kernels.physics.running_sum import net
from gaspart.kernels.step.model import VIRIAL, StepModel, StepParticles, StepTally
from gaspart.kernels.step.resolve import collide_smooth, entry_time, impulse_factors


@kernel
def step_contact(particles, contact, model, tally):
    return collide_smooth(particles, 0, 1, contact, model, tally)


@kernel
def event_contact(flights, rr, rv, space, masses):
    return collision.collide_smooth(flights, 0, 1, rr, rv, space, masses)


@kernel
def factors(rr, rv, mass1, mass2):
    return exchange(rr, rv, mass1, mass2), impulse_factors(rr, rv, mass1, mass2)


@kernel
def times(rr, rv, vv, ss):
    return contact_root(rr, rv, vv, ss), entry_time(rr, rv, vv, ss)


def pair(seed, real):
    """Positions and velocities (3, 2) of an approaching pair, its masses (2,), and its rr, rv, vv."""
    rng = np.random.default_rng(seed)
    while True:
        positions, velocities = rng.random((3, 2)).astype(real), rng.normal(size=(3, 2)).astype(real)
        r, v = positions[:, 1] - positions[:, 0], velocities[:, 1] - velocities[:, 0]
        rr, rv, vv = (sum_of(a, b) for a, b in ((r, r), (r, v), (v, v)))
        if rv < 0.0:
            return positions, velocities, rng.uniform(0.1, 10.0, 2).astype(real), (rr, rv, vv)


def sum_of(a, b):
    total = a[0] - a[0]
    for x, y in zip(a, b, strict=True):
        total += x * y
    return total


def step_arguments(positions, velocities, masses):
    """The particles, model and tally of the step kernels."""
    real, faces, none = positions.dtype.type, np.zeros((1, 6, 2), np.int64), np.empty(0, positions.dtype)
    particles = StepParticles(
        positions.copy(), velocities.copy(), np.zeros((3, 2), np.int32), none, np.arange(2, dtype=np.uint32),
        masses, np.zeros(2, np.uint32), np.zeros(2), ordinary=2,
    )  # fmt: skip
    space = Space((real(9.0),) * 3, (False,) * 3, real(1.0))
    model = StepModel(space, real(1.0), real(1.0), real(0.0), None, None, None)
    tally = StepTally(
        np.zeros(8, np.int64), np.zeros((2, 2)), np.zeros(2), faces[..., 0], faces, faces[0, :1], 1.0, 1.0
    )
    return particles, model, tally


@pytest.mark.parametrize("seed", range(20))
def test_a_pair_that_has_not_moved_since_its_contact_collides_as_in_the_event_driven_engine(seed):
    positions, velocities, masses, (rr, rv, _) = pair(seed, np.float64)
    particles, model, tally = step_arguments(positions, velocities, masses)
    flights = np.zeros(2, flight_dtype(3))
    flights["position"], flights["velocity"] = positions.T, velocities.T
    virial = event_contact(flights, rr, rv, Space((9.0,) * 3, (False,) * 3, 1.0), masses)
    speeds = step_contact(particles, (0.0, rr, rv), model, tally)
    assert np.array_equal(particles.velocities.T, flights["velocity"])
    assert not np.array_equal(particles.velocities, velocities)
    assert np.array_equal(particles.positions, positions)
    assert speeds == tuple(sum_of(v, v) for v in particles.velocities.T)
    assert net(tally.sums[VIRIAL]) == pytest.approx(virial, rel=1e-14)


@pytest.mark.parametrize("real", [np.float32, np.float64])
@pytest.mark.parametrize("seed", range(20))
def test_impulses_and_times_are_those_of_the_one_contact(seed, real):
    _, _, (mass1, mass2), (rr, rv, vv) = pair(seed, real)
    elastic, found = factors(rr, rv, mass1, mass2)
    assert found[:2] == elastic
    ss = rr * real(1.1)
    root, entered = times(rr, rv, vv, ss)
    assert root == entered < 0.0
    parting = times(rr, -rv, vv, ss)[1]  # the other root: the time since the pair touched
    assert parting < 0.0
    rounding = 1e-4 if real is np.float32 else 1e-12
    assert rr - 2 * rv * parting + vv * parting**2 == pytest.approx(ss, rel=rounding)


def test_a_fixed_particle_takes_no_velocity_and_gives_all_of_the_impulse():
    _, found = factors(1.0, -2.0, np.inf, 3.0)
    assert found == (0.0, -4.0, 12.0)
    _, found = factors(1.0, -2.0, 3.0, np.inf)
    assert found == (-4.0, 0.0, 12.0)
