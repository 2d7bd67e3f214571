"""Observables of scenes in which particles rest, and of others that have no fluid's state."""

import warnings

import numpy as np
import pytest

import gaspart as gp

A = gp.analysis
GRAVITY = (0.0, -1.0)


def pile(count=100, **more):
    """Discs that fall into a box 20 wide."""
    species = [gp.Species(count, 0.5, temperature=1.0)]
    law = gp.Restitution(normal=0.8)
    return gp.Scene(gp.Container((20.0, 20.0)), species, gravity=GRAVITY, restitution=law, **more)


@pytest.fixture(scope="module")
def at_rest(tmp_path_factory):
    """At rest from a time of about 40 on."""
    path = tmp_path_factory.mktemp("pile") / "pile.nc"
    return gp.run(pile(), gp.EventDriven(), 1, 80.0, 0.5, path)


@pytest.mark.thorough
@pytest.mark.parametrize(("start", "error"), [(None, 0.01), (40.0, 1e-9)])
def test_a_pile_presses_the_floor_by_its_weight(at_rest, start, error):
    found = A.wall_pressure(at_rest, start=start)
    pressure, errors = found.estimate, found.error
    assert float(pressure.sel(face="y low")) == pytest.approx(100.0 / 19.0, abs=max(5.0 * error, 1e-6))
    assert float(errors.sel(face="y low")) < error
    assert float(pressure.sel(face="y high")) == 0.0
    assert np.isnan(pressure.sel(face=["x low", "x high"])).all()  # a thrust that nothing measures


@pytest.mark.thorough
def test_while_it_falls_the_floor_carries_what_the_balance_of_momentum_says(at_rest):
    found = A.wall_pressure(at_rest, start=0.0)
    with gp.open_trajectory(at_rest) as data:
        momentum = data["velocities"].values[[0, -1], :, 1].astype(float).sum(axis=1)
        weight = 100.0 + (momentum[1] - momentum[0]) / float(data["time"][-1])
    assert float(found.estimate.sel(face="y low")) == pytest.approx(weight / 19.0, rel=1e-5)


def rough(normal, **more):
    """Discs whose friction at the side walls carries part of their weight."""
    law = gp.Restitution(normal=normal, tangential=0.3)
    species = [gp.Species(40, 0.5, temperature=1.0)]
    return gp.Scene(gp.Container((6.0, 20.0)), species, gravity=GRAVITY, restitution=law, **more)


@pytest.mark.thorough
def test_the_floor_of_rough_particles_at_rest_has_no_known_force():
    simulation = gp.Simulation(rough(0.5), seed=1)
    simulation.advance(60.0)
    found = A.wall_force(simulation)
    assert np.isnan(found.estimate.sel(face=["x low", "x high", "y low"])).all()
    assert float(found.estimate.sel(face="y high")) == 0.0


@pytest.mark.interpreted
def test_rest_among_obstacles_is_refused(tmp_path):
    post = gp.Particle((10.0, 3.0), (0.0, 0.0), 1.0, fixed=True)
    path = gp.run(pile(10, particles=[post]), gp.EventDriven(), 1, 60.0, 0.5, tmp_path / "a.nc")
    with pytest.raises(gp.SceneError, match="particles at rest = .*obstacles may carry"):
        A.wall_pressure(path)


def test_what_rests_has_no_rate_of_collisions(at_rest):
    with pytest.raises(gp.SceneError, match="particles at rest = 100"):
        A.collision_rate(at_rest, start=40.0)


@pytest.mark.parametrize("of", ["density", "temperature"])
def test_profiles_of_a_pile_have_no_warnings_and_no_rounding(at_rest, of):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = A.profile(at_rest, of, bins=20, start=40.0)
        A.profile(at_rest, of, bins=20)
    assert found.theory is None
    seen = found.error.values[np.isfinite(found.error.values)]
    assert len(seen) and (seen == 0.0).all()
    if of == "density":
        assert float(found.estimate.sum()) * 20.0 == pytest.approx(100.0)
