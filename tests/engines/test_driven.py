"""A force along a periodic axis: exact flights, bits of all searches, balances, the flow of Poiseuille."""

import math

import numpy as np
import pytest
from scipy.special import erf, exp1

import gaspart as gp
from gaspart import theory

PLATES = {name: gp.Thermal(1.0) for name in ("x_low", "x_high")}
PERIODIC = gp.Container((8.0, 7.0), "periodic")
FIXED = [gp.Particle((4.0, 3.5), (0.0, 0.0), 0.5, fixed=True)]
CHANNEL = gp.Container((6.0, 7.0), ("wall", "periodic"))
LAW = gp.Restitution(normal=0.9, tangential=0.3)


def channel(force=(0.0, 0.3), **rest):
    """Discs in a channel between plates at a temperature, or what the `rest` of a scene says."""
    parts = {"container": CHANNEL, "species": [gp.Species(16, 0.5, temperature=1.0)], "faces": PLATES}
    return gp.Scene(**{**parts, "gravity": force, **rest})


@pytest.mark.interpreted
@pytest.mark.parametrize(
    "engine",
    [gp.EventDriven(), gp.EventDriven(boxes_per_side=(1, 5)), gp.TimeStepped(0.125), gp.DSMC(0.125, 1)],
    ids=["event", "boxes", "step", "dsmc"],
)
@pytest.mark.parametrize("speed", [-4.0, 0.0, 2.0])
def test_a_particle_falls_from_image_to_image(engine, speed):
    """Against the force first, through periodic faces, and back; at rest, from a periodic face."""
    start = 0.0 if speed == 0.0 else 1.0
    disc = gp.Particle((3.0, start), (0.0, speed), 0.5)
    sim = gp.Simulation(channel((0.0, 0.5), species=(), particles=[disc]), engine, seed=1)
    for time in (0.5, 8.0, 16.0, 40.0):
        sim.advance(until=time)
        assert sim.state.unwrapped[0, 1] == pytest.approx(start + speed * time + 0.25 * time**2, rel=1e-12)
        assert sim.state.velocities[0, 1] == pytest.approx(speed + 0.5 * time, rel=1e-12)
        sim.check_invariants()


def free_flight_drift(time, length):
    """Mean velocity along two walls, under a unit force since `time`, of particles that meet walls alone:
    the mean time since a wall, for which a particle of speed v stays free by 1 - abs(v) t / length."""
    s = time / length
    w = 0.5 / s**2
    rest = (0.5 * exp1(w) + s**2 * math.expm1(-w)) / math.sqrt(2.0 * math.pi)
    return length * (s * erf(math.sqrt(w)) + rest)


@pytest.mark.thorough
@pytest.mark.parametrize("engine", [gp.EventDriven(), gp.DSMC(0.125, 2)], ids=["event", "dsmc"])
def test_in_free_flight_particles_drift_as_their_time_since_a_plate(engine):
    """Contacts are 1 in 500 crossings, and however large the drift: at last 2.2 thermal speeds."""
    points = [gp.Species(4000, 1e-5, temperature=1.0)]
    scene = channel((0.0, 1.0), container=gp.Container((3.0, 3.0), ("wall", "periodic")), species=points)
    sims = [gp.Simulation(scene, engine, seed) for seed in (1, 2)]
    for time in (0.5, 2.0, 4.0):
        for sim in sims:
            sim.advance(until=time)
        along = np.concatenate([sim.state.velocities[:, 1] for sim in sims])
        error = along.std() / math.sqrt(len(along))
        assert error < 0.03
        assert abs(along.mean() - free_flight_drift(time, 3.0)) < 3.0 * error


def flow_in_blocks(sim, edges, blocks, samples, interval):
    """Of discs in a channel (blocks, bins): number, mean velocity along it, and temperature about it."""
    found = []
    for _ in range(blocks):
        sums = np.zeros((3, len(edges) - 1))
        for _ in range(samples):
            sim.advance(duration=interval)
            state = sim.state
            for n, weights in enumerate((None, state.velocities[:, 1], (state.velocities**2).sum(axis=1))):
                sums[n] += np.histogram(state.positions[:, 0], edges, weights=weights)[0]
        count, mean = sums[0], sums[1] / sums[0]
        found.append((count / samples, mean, 0.5 * (sums[2] / count - mean**2)))
    return (np.array(values) for values in zip(*found, strict=True))


@pytest.mark.thorough
def test_the_flow_is_a_parabola_with_the_viscosity_of_enskog():
    """Discs at a packing fraction of 0.27, a mean free path of 0.7 between plates 30 apart: the curvature
    away from the plates is density times force over viscosity, known to 7 %."""
    side, force = 30.0, 0.01
    container = gp.Container((side, side), ("wall", "periodic"))
    scene = channel((0.0, force), container=container, species=[gp.Species(300, 0.5, temperature=1.0)])
    sim = gp.Simulation(scene, gp.EventDriven(), seed=1)
    sim.advance(until=300.0)
    edges = np.linspace(0.5, side - 0.5, 13)
    count, flow, temperature = (part[:, 2:-2] for part in flow_in_blocks(sim, edges, 16, 85, 2.0))
    middle = 0.5 * (edges[3:-2] + edges[2:-3]) - 0.5 * side
    bends = np.array([np.polyfit(middle, one, 2)[0] for one in flow])
    mean, error = bends.mean(), bends.std(ddof=1) / 4.0
    density = count.mean() / ((edges[1] - edges[0]) * side)
    viscosity = -0.5 * density * force / mean
    fraction = 0.25 * math.pi * density
    expected = float(theory.enskog_viscosity(fraction, 2, temperature=temperature.mean()))
    assert error < 0.08 * abs(mean)
    assert abs(viscosity - expected) < 3.0 * viscosity * error / abs(mean)
    rest = flow.mean(axis=0) - np.polyval(np.polyfit(middle, flow.mean(axis=0), 2), middle)
    assert (abs(rest) < 3.0 * flow.std(axis=0, ddof=1) / 4.0).all()


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("parts", "lacks"),
    [
        ({"faces": {}}, "momentum"),
        ({"faces": {}, "restitution": gp.Restitution(0.9)}, "momentum"),
        ({"faces": {"x_low": gp.Thermal(1.0, "normal")}}, "momentum"),
        ({"faces": {}, "container": PERIODIC, "restitution": LAW}, "momentum"),
        ({"faces": {}, "walls": [gp.Wall((3.0, 0.0), (3.0, 7.0))]}, "momentum"),
        ({"faces": {}, "restitution": gp.Restitution(tangential=1.0)}, "energy"),
        ({"faces": {}, "walls": [gp.Wall((3.0, 0.0), (3.0, 6.0))]}, "energy"),
        ({"faces": {}, "container": PERIODIC, "particles": FIXED}, "energy"),
    ],
)
def test_what_gains_energy_without_limit_is_refused(parts, lacks):
    with pytest.raises(gp.SceneError, match=f"gives energy without limit along y.* takes the {lacks}"):
        channel(**parts)
