"""Polydisperse species: their radii, and what follows from these."""

import hashlib

import numpy as np
import pytest
from scipy.special import ndtri

import gaspart as gp
from gaspart.scene import sizes
from gaspart.state.initial import initial_state
from gaspart.state.insertion import per_particle


def scene(boundary="periodic", side=12.0, **properties):
    species = {"count": 300, "radius": 0.5, "temperature": 1.0, "polydispersity": 0.2} | properties
    return gp.Scene(gp.Container((side,) * 3, boundary), [gp.Species(**species)])


def test_quantiles_and_elementary_functions():
    p = np.concatenate([np.linspace(1e-9, 1.0 - 1e-9, 10_001), 10.0 ** -np.arange(1.0, 300.0, 7.0)])
    assert np.allclose(sizes.normal_quantile(p), ndtri(p), rtol=4e-15, atol=1e-15)
    x = np.linspace(-30.0, 30.0, 1001)
    assert np.allclose(sizes._exp(x), np.exp(x), rtol=1e-14)
    y = 10.0 ** np.linspace(-300.0, 300.0, 1001)
    assert np.allclose(sizes._log(y), np.log(y), rtol=1e-15, atol=1e-15)


@pytest.mark.parametrize("distribution", sizes.DISTRIBUTIONS)
@pytest.mark.parametrize("spread", [1e-9, 0.1, 0.5])
def test_mean_and_standard_deviation_are_those_asked_for(distribution, spread):
    radii = sizes.relative_radii(10_000, spread, distribution)
    assert radii.mean() == pytest.approx(1.0, abs=1e-12)
    assert radii.std() == pytest.approx(spread, rel=5e-3)
    assert np.all(np.diff(radii) <= 0.0) and radii[-1] > 0.0


def test_a_lognormal_distribution_is_one():
    logs = np.log(sizes.relative_radii(10_001, 0.3, "lognormal"))
    assert logs[5000] == pytest.approx(-0.5 * np.log(1.09), abs=1e-3)  # the median
    assert np.allclose(logs + logs[::-1], 2.0 * logs[5000])


@pytest.mark.parametrize(
    ("distribution", "digest"), [("lognormal", "4387c60f461d6106"), ("uniform", "5000905e02e4a037")]
)
def test_radii_are_these_bits(distribution, digest):
    radii = sizes.relative_radii(1000, 0.15, distribution)
    assert hashlib.sha256(radii.tobytes()).hexdigest()[:16] == digest


def test_what_a_scene_has_follows_from_the_radii():
    gas = scene()
    (kind,) = gas.species
    assert gas.largest_radius == kind.radii[0] and gas.smallest_radius == kind.radii[-1]
    assert gas.packing_fraction == pytest.approx(4.0 / 3.0 * np.pi * (kind.radii**3).sum() / 12.0**3)
    assert gas.gas is None and not gas.alike and gas.closest_packing == 1.0
    assert np.array_equal(per_particle(gas, "radius"), kind.radii)
    mixture = gas.mixture
    assert len(mixture.diameters) == 300 and sum(mixture.counts) == 300
    assert len(mixture.thin(64).diameters) <= 64
    assert gp.Scene.from_dict(gas.to_dict()) == gas
    assert scene(polydispersity=0.0) == scene(polydispersity=None)
    assert "radius_distribution" not in scene(polydispersity=None).to_dict()["species"][0]


@pytest.mark.parametrize("arrangement", ["random", "lattice", "compressed"])
@pytest.mark.parametrize("boundary", ["periodic", "wall"])
def test_initial_states_have_the_radii_and_no_overlap(arrangement, boundary):
    gas = scene(boundary, side=14.0, arrangement=arrangement)
    states = [initial_state(gas, seed) for seed in (1, 2)]
    for state in states:
        assert np.array_equal(state.radii, gas.species[0].radii)
        apart = state.positions[:, None] - state.positions
        if boundary == "periodic":
            apart -= 14.0 * np.round(apart / 14.0)
        else:
            assert np.all(state.positions >= state.radii[:, None])
            assert np.all(state.positions <= 14.0 - state.radii[:, None])
        distance = np.sqrt((apart**2).sum(axis=2)) + 1e9 * np.eye(300)
        assert (distance - np.add.outer(state.radii, state.radii)).min() > -1e-12
        # large ones are not gathered anywhere
        assert abs(np.corrcoef(state.radii, state.positions[:, 0])[0, 1]) < 0.25
    assert not np.array_equal(states[0].positions, states[1].positions)


def test_engines_run_it_or_refuse_it_in_one_line():
    gas = scene()
    for engine in (gp.EventDriven(), gp.EventDriven(search="direct")):
        simulation = gp.Simulation(gas, engine, seed=1)
        simulation.advance(duration=0.5)
        assert simulation.tally.collisions >= 100
    with pytest.raises(gp.SceneError, match=r'^species.polydispersity = 0.2: needs the "event" or "step"'):
        gp.Simulation(gas, gp.DSMC())
    steps = gp.TimeStepped(time_step=0.01)
    steps.check_features(gas)


@pytest.mark.parametrize(
    ("key", "properties"),
    [
        ("polydispersity", {"polydispersity": 1.5}),
        ("polydispersity", {"polydispersity": 0.6, "radius_distribution": "uniform"}),
        ("radius_distribution", {"polydispersity": None, "radius_distribution": "uniform"}),
        ("moment_of_inertia", {"moment_of_inertia": 0.1}),
        (
            r"species\[0\].radius",
            {"radius": 5.9, "count": 2, "polydispersity": 0.05},
        ),  # the largest does not fit
    ],
)
def test_other_values_are_refused(key, properties):
    with pytest.raises(gp.SceneError, match=f"^{key} = ") as caught:
        scene(**properties)
    assert "\n" not in str(caught.value)


def test_a_trajectory_has_the_radii(tmp_path):
    path = gp.run(scene(), gp.EventDriven(), 1, 1.0, 0.5, tmp_path / "run.nc")
    with gp.open_trajectory(path) as data:
        assert np.array_equal(data["radius"], scene().species[0].radii)
        assert data.attrs["packing_fraction"] == scene().packing_fraction
