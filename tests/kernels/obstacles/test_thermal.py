"""Thermal walls: the temperature that they give, the heat that they take, and the same bits in any search."""

import math

import numpy as np
import pytest

import gaspart as gp


def between(hot, cold, dimension=3, components="all", count=200, temperature=1.0, side=4.0):
    """A nearly ideal gas between two thermal walls across x, periodic along the others."""
    faces = {"x_low": gp.Thermal(hot, components), "x_high": gp.Thermal(cold, components)}
    container = gp.Container((side,) * dimension, ("wall",) + ("periodic",) * (dimension - 1))
    return gp.Scene(container, [gp.Species(count, 1e-3, temperature=temperature)], faces=faces)


@pytest.mark.thorough
@pytest.mark.parametrize("components", ["all", "normal"])
def test_velocities_after_a_wall(components):
    """Outgoing normal speeds of mean sqrt(pi T/2m) and mean square 2T/m; tangential ones drawn or kept."""
    scene = between(4.0, 4.0, components=components)
    scene = scene.with_species(gp.Species(1, 1e-3, mass=2.0))  # the kernels of the tests above know masses
    sim = gp.Simulation(scene, gp.EventDriven(), seed=2)
    sim.record_events = True
    sim.advance(max_events=30_000)
    hits = (sim.events["particles"][:, 1] < 0) & (sim.events["particles"][:, 0] < 200)
    v = sim.events["velocities"][hits, 0]
    count = len(v)
    assert count > 25_000
    assert (np.sign(v[:, 0]) == np.where(sim.events["particles"][hits, 1] == -1, 1.0, -1.0)).all()
    speed = abs(v[:, 0]) / 2.0
    assert speed.mean() == pytest.approx(math.sqrt(math.pi / 2), abs=3 * math.sqrt((2 - math.pi / 2) / count))
    assert (speed**2).mean() == pytest.approx(2.0, abs=3 * math.sqrt(4.0 / count))
    if components == "all":
        across = v[:, 1:] / 2.0
        assert across.mean() == pytest.approx(0.0, abs=3 * math.sqrt(0.5 / count))
        assert (across**2).mean() == pytest.approx(1.0, abs=3 * math.sqrt(1.0 / count))
        assert (across**4).mean() == pytest.approx(3.0, abs=3 * math.sqrt(48.0 / count))
        assert np.mean(speed * across[:, 0]) == pytest.approx(0.0, abs=3 * math.sqrt(2.0 / count))
    else:  # a particle keeps its tangential velocity but for the few collisions
        first = sim.initial_state.velocities[sim.events["particles"][hits, 0], 1:]
        assert np.mean(v[:, 1:] == first) > 0.9


@pytest.mark.thorough
def test_a_gas_takes_the_temperature_of_its_walls():
    """In each direction, spins included; the energy of a canonical gas has a variance to compare with."""
    scene = gp.Scene(
        gp.Container((8.0, 8.0)),
        [gp.Species(100, 0.05, mass=2.0, temperature=0.3)],
        gravity=(0.0, -0.5),  # without effect on velocities
        restitution=gp.Restitution(1.0, 1.0),
        faces={name: gp.Thermal(2.0) for name in ("x_low", "x_high", "y_low", "y_high")},
    )
    sim = gp.Simulation(scene, gp.EventDriven(), seed=4)
    sim.record_events = True
    sim.advance(duration=100.0)
    found = []
    for _ in range(20):
        sim.advance(duration=40.0)
        state = sim.state
        spins = state.moments_of_inertia * state.spins**2
        found.append([*(2.0 * state.velocities**2).mean(axis=0), spins.mean()])
    sigma = 2.0 * math.sqrt(2.0 / 100 / 20)
    assert np.mean(found, axis=0) == pytest.approx([2.0] * 3, abs=3 * sigma)
    sim.check_invariants()


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"faces": []}, "faces"),
        ({"faces": {"z_low": {"kind": "thermal", "temperature": 1.0}}}, "faces.z_low"),
        ({"faces": {"y_low": {"kind": "thermal", "temperature": 1.0}}}, "faces.y_low"),
        ({"faces": {"x_low": {"kind": "warm", "temperature": 1.0}}}, "faces.x_low.kind"),
        ({"faces": {"x_low": {"temperature": 1.0}}}, "faces.x_low.kind"),
        ({"faces": {"x_low": 1.0}}, "faces.x_low"),
        ({"faces": {"x_low": {"kind": "thermal", "temperature": 0.0}}}, "faces.x_low.temperature"),
        (
            {"faces": {"x_low": {"kind": "thermal", "temperature": 1.0, "components": "tangential"}}},
            "faces.x_low.components",
        ),
        ({"faces": {"x_low": {"kind": "thermal", "temperature": 1.0, "depth": 1.0}}}, "faces.x_low.depth"),
    ],
)
def test_what_is_refused(change, key):
    container = {"lengths": [12.0, 12.0], "boundary": ["wall", "periodic"]}
    with pytest.raises(gp.SceneError) as caught:
        gp.Scene.from_dict({"container": container} | change)
    assert caught.value.key == key


def box_of_discs(count):
    """A few discs between thermal walls of two temperatures."""
    faces = {"x_low": gp.Thermal(1.0), "x_high": gp.Thermal(4.0)}
    return gp.Scene(gp.Container((10.0, 10.0)), [gp.Species(count, 0.5, temperature=1.0)], faces=faces)


@pytest.mark.thorough
@pytest.mark.parametrize("count", [1, 3])
def test_a_correct_run_between_thermal_walls_is_not_aborted(count):
    """The heat that goes through grows for ever, and with it the rounding of a plain sum of it."""
    sim = gp.Simulation(box_of_discs(count), gp.EventDriven(), seed=1)
    for _ in range(15):
        sim.advance(max_events=100_000)
        sim.check_invariants()
    assert sim.tally.wall_energy[1] < -1e5


@pytest.mark.thorough
def test_an_error_of_the_energy_is_still_found():
    sim = gp.Simulation(box_of_discs(3), gp.EventDriven(), seed=1)
    sim.advance(max_events=100_000)
    state = sim.state.copy()
    state.velocities *= 1.0 + 1e-8
    with pytest.raises(gp.SimulationError, match="energy has drifted"):
        sim.check_invariants(state)
