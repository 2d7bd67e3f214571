"""Numbers that are known exactly, of gases that are not uniform: against walls, in a field, behind a shock,
through an opening."""

import math

import numpy as np
import pytest

import gaspart as gp
from gaspart.trajectory.reading import open_trajectory

pytestmark = pytest.mark.thorough

PERIODIC = "periodic"


def test_the_density_at_a_hard_wall_is_the_pressure(tmp_path):
    """The contact theorem, P = n k_B T with n the density of centres where they touch a flat wall."""
    scene = gp.Scene(
        gp.Container((4.0, 4.0, 6.0), (PERIODIC, PERIODIC, "wall")),
        [gp.Species(24, 0.5, temperature=1.0, exact_temperature=True)],
    )
    path = gp.run(scene, gp.EventDriven(), 1, 1500.0, 0.5, tmp_path / "a.nc")
    pressure = gp.analysis.wall_pressure(path)
    with open_trajectory(path) as data:
        kept = data.isel(frame=slice(data.sizes["frame"] // 4, None))
        height = kept["coordinates"].isel(spatial=2).values.astype(float)
        velocities = kept["velocities"].values.astype(float)
    drift = velocities.mean(axis=1, keepdims=True) * (1.0, 1.0, 0.0)
    temperature = ((velocities - drift) ** 2).sum(axis=(1, 2)).mean() / (3 * 24 - 2)
    gap = np.minimum(height, 6.0 - height) - 0.5
    counts = np.array([np.histogram(part, np.linspace(0.0, 0.4, 9))[0] for part in np.array_split(gap, 32)])
    density = counts / (len(gap) / 32 * 2 * 0.05 * 16.0)
    middle = 0.025 + 0.05 * np.arange(8)
    contact = np.array([np.polyfit(middle, one, 2)[-1] for one in density])
    value, error = contact.mean(), contact.std(ddof=1) / math.sqrt(len(contact))
    assert error < 0.03 * value
    for face in ("z low", "z high"):
        one = pressure.sel(face=face)
        assert float(one.estimate) == pytest.approx(
            value * temperature, abs=3.0 * math.hypot(error * temperature, float(one.error))
        )


@pytest.mark.parametrize(
    "engine", [gp.EventDriven(), gp.DSMC(0.0625, (2, 2, 4), "enskog")], ids=["event", "dsmc"]
)
def test_the_floor_carries_the_weight_that_the_ceiling_does_not(engine, tmp_path):
    """The momentum that the faces have been given less the weight over the time is what the gas has lost."""
    scene = gp.Scene(
        gp.Container((4.0, 4.0, 8.0), (PERIODIC, PERIODIC, "wall")),
        [gp.Species(24, 0.5, temperature=1.0)],
        gravity=(0.0, 0.0, -0.25),
    )
    path = gp.run(scene, engine, 1, 64.0, 0.5, tmp_path / "a.nc")
    pressure = gp.analysis.wall_pressure(path)
    with open_trajectory(path) as data:
        start = data.sizes["frame"] // 4
        momentum = data["velocities"].values[[start, -1], :, 2].astype(float).sum(axis=1)
        duration = float(data["time"][-1] - data["time"][start])
    carried = float(pressure.estimate.sel(face="z low") - pressure.estimate.sel(face="z high")) * 16.0
    assert carried == pytest.approx(24 * 0.25 + np.diff(momentum)[0] / duration, rel=1e-6)


def test_a_shock_has_the_jump_of_the_conservation_laws():
    """A wall that moves in at the speed 2 (a sawtooth within its first period), in spheres of packing
    fraction 0.1 at T = 1: mass, momentum and energy across the front, with the equation of state of
    Carnahan and Starling, give P = 2.07 and n = 0.342 (and T = 2.78: tests/analysis/test_flow.py)."""
    side, length, speed, front = 8.0, 100.0, 2.0, 4.59
    scene = gp.Scene(
        gp.Container((side, side, length), (PERIODIC, PERIODIC, "wall")),
        [gp.Species(1222, 0.5, temperature=1.0, exact_temperature=True)],
        faces={"z_low": gp.Vibrating(40.0, 40.0, "sawtooth")},
    )
    pressures, densities = [], []
    for seed in range(10):
        sim = gp.Simulation(scene, gp.EventDriven(), seed)
        sim.advance(until=5.0)
        before = sim.tally.wall_impulse[4]
        sim.advance(until=15.0)
        pressures.append((sim.tally.wall_impulse[4] - before) / (10.0 * side**2))
        height = sim.state.positions[:, 2]
        lower, upper = speed * sim.time + 4.0, front * sim.time - 6.0
        densities.append(((height > lower) & (height < upper)).sum() / ((upper - lower) * side**2))
    for found, value in ((densities, 0.342), (pressures, 2.07)):
        mean, error = np.mean(found), np.std(found, ddof=1) / math.sqrt(len(found))
        assert error < 0.02 * value
        assert mean == pytest.approx(value, abs=3.0 * error + 0.005 * value)


def test_a_gas_without_collisions_leaves_through_an_opening():
    """n sqrt(T / 2 pi m) per time and length of the opening that centres can use; in this time hardly any
    has come back."""
    radius, count, until = 1e-4, 20_000, 6.0
    walls = [gp.Wall((20.0, 0.0), (20.0, 9.0)), gp.Wall((20.0, 11.0), (20.0, 20.0))]
    species = [gp.Species(count, radius, temperature=1.0, region=((0.0, 0.0), (20.0, 20.0)))]
    sim = gp.Simulation(gp.Scene(gp.Container((40.0, 20.0)), species, walls=walls), gp.EventDriven(), 1)
    sim.advance(until=until)
    found = int((sim.state.positions[:, 0] > 20.0).sum())
    flux = count / 400.0 * math.sqrt(1.0 / (2.0 * math.pi)) * (2.0 - 2.0 * radius) * until
    assert found == pytest.approx(flux, abs=3.0 * math.sqrt(flux))


def test_both_ends_of_two_chambers_without_collisions_are_hit_equally_often():
    """Thermal transpiration: at temperatures 4 and 1 the fluxes through the opening are equal, and with them
    those at the ends, whatever part passes."""
    walls = [gp.Wall((10.0, 0.0), (10.0, 4.5)), gp.Wall((10.0, 5.5), (10.0, 10.0))]
    faces = {"x_low": gp.Thermal(4.0), "x_high": gp.Thermal(1.0)}
    species = [gp.Species(300, 1e-4, temperature=2.0)]
    scene = gp.Scene(gp.Container((20.0, 10.0)), species, walls=walls, faces=faces)
    sim = gp.Simulation(scene, gp.EventDriven(), 1)
    sim.advance(until=400.0)
    hits = []
    for _ in range(32):
        sim.reset_tally()
        sim.advance(duration=50.0)
        hits.append(sim.tally.wall_hits[:2])
    difference = np.diff(hits, axis=1)[:, 0]
    error = difference.std(ddof=1) / math.sqrt(len(difference))
    assert error < 0.05 * np.mean(hits)
    assert abs(difference.mean()) < 3.0 * error
