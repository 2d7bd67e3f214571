"""Collisions counted by pairs of species, in trajectories and by what measures them."""

import math

import numpy as np
import pytest
from scenes import gas

import gaspart as gp
from gaspart import theory
from gaspart.trajectory import recording

PAIRS = ["0-0", "0-1", "1-1"]


def mixture(ratio=0.6, boundary="periodic"):
    """100 spheres of which 60 are smaller and heavier, packing fraction 0.2."""
    volume = math.pi / 6.0 * (40 + 60 * ratio**3)
    kinds = [
        gp.Species(40, 0.5, temperature=1.0, exact_temperature=True),
        gp.Species(60, 0.5 * ratio, mass=2.0, temperature=1.0, exact_temperature=True),
    ]
    return gp.Scene(gp.Container(((volume / 0.2) ** (1 / 3),) * 3, boundary), kinds)


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    target = tmp_path_factory.mktemp("pairs") / "run.nc"
    return gp.run(mixture(), gp.EventDriven(), 1, 128.0, 2.0, target, pairs=True)


def test_the_pairs_are_all_collisions(path):
    with gp.open_trajectory(path) as data:
        assert data["pair"].values.tolist() == PAIRS
        assert np.array_equal(data["pair_collisions"].sum("pair"), data["collisions"])
        assert (np.diff(data["pair_collisions"], axis=0) > 0).all()


def test_counting_changes_nothing_else(path, tmp_path):
    plain = gp.run(mixture(), gp.EventDriven(), 1, 4.0, 2.0, tmp_path / "plain.nc")
    with gp.open_trajectory(plain) as one, gp.open_trajectory(path) as other:
        assert "pair_collisions" not in one
        assert np.array_equal(one["coordinates"], other["coordinates"][:3])
        assert np.array_equal(one["virial_sum"], other["virial_sum"][:3])


def test_a_run_cut_short_counts_on(path, tmp_path, monkeypatch):
    """Stopped after a checkpoint between two frames, and continued: the same bytes."""
    target, calls = tmp_path / "run.nc", []

    def interrupt(*_):
        calls.append(None)
        if len(calls) == 3:
            raise KeyboardInterrupt

    monkeypatch.setattr(recording, "_PROGRESS", 0.0)
    recipe = mixture(), gp.EventDriven(), 1, 128.0, 2.0, target
    with pytest.raises(KeyboardInterrupt):
        gp.run(*recipe, pairs=True, checkpoint_seconds=0.0, progress=interrupt)
    assert gp.resume(target).read_bytes() == path.read_bytes()


def test_what_cannot_be_counted_is_refused(tmp_path, path):
    target = tmp_path / "run.nc"
    with pytest.raises(gp.SceneError, match='^pairs = True: .*"event" engine'):
        gp.run(mixture(), gp.TimeStepped(time_step=0.01), 1, 1.0, 0.5, target, pairs=True)
    particle = gas(3, 10, 0.1).with_particles(gp.Particle((0.5, 0.5, 0.5), (0.0, 0.0, 0.0), 0.01))
    with pytest.raises(gp.SceneError, match="^particles = 1: "):
        gp.run(particle, gp.EventDriven(), 1, 1.0, 0.5, target, pairs=True)
    uncounted = gp.run(mixture(), gp.EventDriven(), 1, 4.0, 0.125, target)
    with pytest.raises(gp.SceneError, match="^pairs = False: .*--pairs"):
        gp.analysis.contact_values(uncounted)
    many = gp.Scene(
        gp.Container((9.0,) * 3, "periodic"), [gp.Species(60, 0.5, polydispersity=0.1, speed=1.0)]
    )
    simulation = gp.Simulation(many, gp.EventDriven(), seed=1)
    simulation.advance(duration=20.0)
    with pytest.raises(gp.SceneError, match=r"^species\[0\].polydispersity = 0.1: "):
        gp.analysis.contact_values(simulation)
    rates = gp.analysis.pair_collision_rates(simulation)
    z = gp.analysis.compressibility_factor(simulation)
    assert rates["pair"].values.tolist() == ["0-0"] and rates.theory is None
    exact = theory.mixture_compressibility_factor(*many.mixture.sizes)
    assert float(z.theory) == pytest.approx(exact, rel=5e-3)  # and a finite number


def test_rates_of_few_particles_are_those_of_their_number(tmp_path):
    """Each of ten spheres has nine partners of its kind: the rate of an infinite mixture is 11 % higher."""
    kinds = [gp.Species(10, 0.5, temperature=1.0), gp.Species(10, 0.25, mass=4.0, temperature=1.0)]
    scene = gp.Scene(gp.Container((12.0,) * 3, "periodic"), kinds)
    path = gp.run(scene, gp.EventDriven(), 1, 60000.0, 200.0, tmp_path / "run.nc", pairs=True)
    rates = gp.analysis.pair_collision_rates(path)
    like, unlike, other = rates.theory.values  # at the temperature of the seed
    infinite = theory.mixture_collision_rates(*scene.mixture.sizes, masses=scene.mixture.masses)
    assert like / unlike == pytest.approx(0.9 * infinite[0, 0] / infinite[0, 1], rel=1e-12)
    assert other / unlike == pytest.approx(0.9 * infinite[1, 1] / infinite[0, 1], rel=1e-12)
    assert (rates.error / rates.estimate < 0.03).all()
    assert (abs(rates.estimate - rates.theory) < 3.0 * rates.error).all()
