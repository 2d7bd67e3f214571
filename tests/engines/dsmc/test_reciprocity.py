"""Onsager's reciprocity in a channel: the pressure that a gradient of the temperature makes, and the heat
that a flow carries."""

import math

import numpy as np
import pytest

import gaspart as gp
from gaspart import theory

pytestmark = pytest.mark.thorough

DENSITY, INTERVAL, BLOCKS = 2000.0, 0.3, 16
KNUDSEN = 0.3
"""Mean free path over the width of the channel, which is 1."""
RADIUS = 0.5 * math.sqrt(1.0 / (math.sqrt(2.0) * math.pi * DENSITY * KNUDSEN))


def channel(count, lengths, boundary, faces, temperature, **rest):
    """A channel between z_low and z_high, whose width is that for the centres of spheres."""
    gas = gp.Species(round(count), RADIUS, temperature=temperature)
    container = gp.Container(lengths, boundary)
    return gp.Scene(container, [gas], faces=faces, centres_to_walls=True, **rest)


def means(scene, step, cells, settle, duration, row):
    """(BLOCKS, ...) means over parts of a run of row(state)."""
    sim = gp.Simulation(scene, gp.DSMC(step, cells, "boltzmann"), seed=1)
    sim.advance(until=settle)
    rows = []
    while sim.time < settle + duration:
        sim.advance(duration=INTERVAL)
        rows.append(row(sim.state))
    return np.array([part.mean(axis=0) for part in np.array_split(rows, BLOCKS)])


def jackknife(blocks, value):
    """The value of the mean of all blocks, and its error."""
    whole = blocks.sum(axis=0)
    others = np.array([value((whole - one) / (BLOCKS - 1)) for one in blocks])
    return value(whole / BLOCKS), others.std() * math.sqrt(BLOCKS - 1)


def exponent(mean, inner=slice(2, 8)):
    """d ln p / d ln T from particles and sums of v^2 (2, slices), away from the ends."""
    count, square = mean[:, inner]
    return np.polyfit(np.log(square / count), np.log(square), 1)[0]


def carried(mean):
    """-q / (n u k_B T) from sums (5, slices) of 1, v_x, v^2, v_x^2, v^2 v_x over slices across the channel;
    the heat flux q is that of velocities about u, so that it is of first order in the force."""
    count, along, square, of_x, both = mean
    u = along / count
    heat = 0.5 * (both - u * square - 2.0 * u * of_x + 3.0 * u**2 * along - u**3 * count)
    temperature = (square.sum() - (u * along).sum()) / (3.0 * count.sum())
    return -heat.sum() / (temperature * along.sum())


@pytest.mark.filterwarnings("ignore:gaspart")  # cells as wide as they may be: nothing varies along them
def test_the_pressure_of_a_gradient_is_that_of_the_heat_that_a_flow_carries():
    """Without a net flow, thermal creep along the walls, towards where they are hotter, and Poiseuille's flow
    back balance: p ~ T^gamma. By Onsager's reciprocity gamma is -q / (n u k_B T) of the same channel at one
    temperature, through which a force drives a flow u with a heat flux q against it; 1/2 without collisions
    (Sharipov & Seleznev, J. Phys. Chem. Ref. Data 27, 657 (1998)). States are those after the collisions of a
    step, which take 2/3 p / mu of a heat flux per time: half of what they have taken is added.
    """
    both = {"z_low": gp.Thermal(1.0), "z_high": gp.Thermal(1.0)}
    boundary, pull = ("periodic", "periodic", "wall"), (0.08, 0.0, 0.0)
    pushed = channel(4.0 * DENSITY, (2.0, 2.0, 1.0), boundary, both, 1.0, gravity=pull)

    def flow(state):
        place = np.minimum((state.positions[:, 2] * 10).astype(int), 9)
        v = state.velocities[:, 0]
        square = (state.velocities**2).sum(axis=1)
        return [np.bincount(place, one, 10) for one in (np.ones_like(v), v, square, v**2, square * v)]

    step = 0.015
    heat, heat_error = jackknife(means(pushed, step, (1, 1, 10), 8.0, 3000.0, flow), carried)
    viscosity = float(theory.enskog_viscosity(1e-9, 3, diameter=2.0 * RADIUS))  # of a dilute gas
    kept = 1.0 - 0.5 * step * 2.0 / 3.0 * DENSITY / viscosity
    heat, heat_error = heat / kept, heat_error / kept

    ramp, length = gp.Thermal({"x_low": 1.0, "x_high": 2.0}), 5.0
    ends = {"x_low": gp.Thermal(1.0), "x_high": gp.Thermal(2.0), "z_low": ramp, "z_high": ramp}
    middle = 1.5 * math.log(2.0)  # the density there, over the mean of 1 / T
    count = DENSITY * 0.6 * length * middle
    closed = channel(count, (length, 0.6, 1.0), ("wall", "periodic", "wall"), ends, 1.4)

    def slices(state):
        place = np.minimum((state.positions[:, 0] / length * 10).astype(int), 9)
        square = (state.velocities**2).sum(axis=1)
        return [np.bincount(place, weights, 10) for weights in (np.ones(state.count), square)]

    made, made_error = jackknife(means(closed, 0.03, (50, 1, 10), 40.0, 5000.0, slices), exponent)
    assert max(made_error, heat_error) < 0.03 * made
    assert abs(made - heat) < 3.0 * math.hypot(made_error, heat_error)
