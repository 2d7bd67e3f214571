"""Grains that flow down a bottom of fixed ones: what that takes is their weight, along it and across it, and
contacts lose what gravity gives."""

import math

import numpy as np
import pytest

import gaspart as gp
from gaspart.cli.new import templates
from gaspart.yaml_text import parse_yaml

SCENE = gp.Scene.from_dict(parse_yaml(templates()["incline"].text))
PULL = np.array(SCENE.gravity)


class Bottom:
    """What fixed particles and walls give to the others, by the velocities before and after each contact."""

    def __init__(self, sim):
        sim.record_events = True
        self.sim, self.seen = sim, len(sim.events["time"])
        self.velocities, self.true_at = sim.state.velocities.copy(), np.full(sim.state.count, sim.time)
        self.moving = np.isfinite(sim.state.masses)

    def given(self, duration):
        """(d,) the momentum given in the next part of the run."""
        self.sim.advance(duration=duration)
        events, found = self.sim.events, np.zeros(2)
        for n in range(self.seen, len(events["time"])):
            time, pair = events["time"][n], events["particles"][n]
            for i, after in zip(pair, events["velocities"][n], strict=True):
                if i >= 0 and self.moving[i]:
                    change = after - self.velocities[i] - PULL * (time - self.true_at[i])
                    found += change
                    self.velocities[i], self.true_at[i] = after, time
        self.seen = len(events["time"])
        return found


def momentum(sim):
    return sim.state.velocities[np.isfinite(sim.state.masses)].sum(axis=0)


@pytest.mark.thorough
def test_the_bottom_takes_the_weight_and_contacts_lose_its_work():
    """Along the slope to rounding in each part of the run, across it but for a grain that rests on others
    between two parts; and in the steady state with what the flow keeps, whose share falls with time."""
    sim = gp.Simulation(SCENE, gp.EventDriven(), seed=1)
    sim.advance(duration=80.0)
    sim.reset_tally()
    bottom = Bottom(sim)
    weight, energy = bottom.moving.sum() * PULL, sim.state.energy
    taken, speeds = [], []
    for _ in range(20):
        before = momentum(sim)
        taken.append(-bottom.given(10.0))
        kept = momentum(sim) - before
        assert taken[-1][0] == pytest.approx(10.0 * weight[0] - kept[0], rel=1e-9)
        assert taken[-1][1] == pytest.approx(10.0 * weight[1] - kept[1], rel=1e-3)
        speeds.append(sim.state.velocities[bottom.moving, 0].mean())
    assert sim.tally.dissipated_energy == pytest.approx(energy - sim.state.energy, rel=1e-9)
    ratios = np.divide(*np.array(taken).T)
    error = ratios.std(ddof=1) / math.sqrt(len(ratios))
    assert error < 0.003
    assert abs(ratios.mean() - PULL[0] / PULL[1]) < 3.0 * error  # the flow is steady: tan 20 degrees
    work = 10.0 * weight[0] * np.mean(speeds) * len(ratios)
    assert sim.tally.dissipated_energy == pytest.approx(work, rel=0.05)
