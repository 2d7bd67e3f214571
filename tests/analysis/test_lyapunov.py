"""The tangent map against runs that start a little apart, the exponent against an independent program's."""

from dataclasses import replace

import numpy as np
import pytest

import gaspart as gp
from gaspart.analysis.lyapunov import Deviation, follow
from gaspart.errors import SceneError

SPECIES = (gp.Species(12, 0.5, mass=1.0, temperature=1.0), gp.Species(6, 0.3, mass=4.0, temperature=1.0))


@pytest.mark.parametrize(
    "container",
    [
        gp.Container((7.0, 8.0), "wall"),
        gp.Container((7.0, 8.0), "periodic"),
        gp.Container((4.5, 4.0, 5.0), ("wall", "periodic", "wall")),
    ],
    ids=["discs between walls", "periodic discs", "spheres"],
)
def test_a_deviation_is_the_difference_of_two_runs_over_their_first_distance(container):
    """Of two sizes and masses. The difference of runs 2 h apart about the first is right to order h^2."""
    scene = gp.Scene(container, species=SPECIES)
    run = gp.Simulation(scene, gp.EventDriven(), seed=3)
    run.record_events = True
    start = run.state
    run.advance(duration=1.2)
    assert run.tally.collisions > 8
    rng = np.random.default_rng(1)
    shift, push = rng.standard_normal((2, *start.positions.shape))
    deviation = Deviation(shift, push, 0.0)
    follow(deviation, scene, start.masses, run.events)
    for n in range(start.count):
        deviation.advance(n, 1.2)
    h, ends = 1e-7, []
    for sign in (1.0, -1.0):
        moved = replace(
            start,
            positions=start.positions + sign * h * shift,
            velocities=start.velocities + sign * h * push,
        )
        beside = gp.EventDriven().start(scene, moved)
        beside.advance(1.2)
        assert beside.tally.collisions == run.tally.collisions
        ends.append(beside.state)
    lengths = np.array(container.lengths)
    apart = ends[0].positions - ends[1].positions
    apart -= np.where(container.periodic, lengths * np.rint(apart / lengths), 0.0)
    scale = np.abs(deviation.positions).max()
    assert np.array(deviation.positions) == pytest.approx(apart / (2.0 * h), abs=1e-4 * scale)
    faster = (ends[0].velocities - ends[1].velocities) / (2.0 * h)
    assert np.array(deviation.velocities) == pytest.approx(faster, abs=1e-4 * np.abs(faster).max())


def test_the_exponent_of_discs_is_that_of_an_independent_program():
    """2.760(9) per collision of a particle: 100 discs at 0.1 between walls, tangent dynamics of a session."""
    side = np.sqrt(100 * np.pi / 4.0 / 0.1)
    scene = gp.Scene(gp.Container((side, side), "wall"), species=[gp.Species(100, 0.5, temperature=1.0)])
    found = []
    for seed in range(6):
        run = gp.Simulation(scene, gp.EventDriven(), seed=seed)
        run.advance(duration=20.0)
        run.reset_tally()
        run.record_events = True
        run.advance(duration=150.0)
        exponent = gp.analysis.lyapunov_exponent(run)
        rate = 2.0 * run.tally.collisions / (100 * run.tally.time)
        assert 0.0 < float(exponent.error) < 0.1 * float(exponent.estimate)
        found.append(float(exponent.estimate) / rate)
    error = np.std(found, ddof=1) / np.sqrt(6)
    assert error < 0.04
    assert np.mean(found) == pytest.approx(2.760, abs=4.0 * np.hypot(error, 0.009))


def test_a_long_run_of_a_dilute_gas_does_not_overflow():
    """The deviation grows by exp(13) in a collision of each sphere: beyond the range of numbers within 60."""
    side = (60 * np.pi / 6.0 / 0.001) ** (1.0 / 3.0)
    scene = gp.Scene(gp.Container((side,) * 3), species=[gp.Species(60, 0.5, temperature=1.0)])
    run = gp.Simulation(scene, gp.EventDriven(), seed=1)
    run.record_events = True
    run.advance(duration=25_000.0)
    assert run.tally.collisions > 100 * 60
    per_collision = 60 * run.time / (2.0 * run.tally.collisions)
    exponent = gp.analysis.lyapunov_exponent(run, start=0.6 * run.time)
    assert float(exponent.estimate) * per_collision == pytest.approx(13.0, abs=2.5)


def test_what_has_no_exponent_is_refused():
    scene = gp.Scene(gp.Container((9.0, 9.0)), species=[gp.Species(9, 0.5, temperature=1.0)])
    run = gp.Simulation(scene, gp.EventDriven())
    with pytest.raises(SceneError, match="record_events"):
        gp.analysis.lyapunov_exponent(run)
    run.record_events = True
    with pytest.raises(SceneError, match="events = 0: must be at least"):
        gp.analysis.lyapunov_exponent(run)
    inelastic = gp.Simulation(replace(scene, restitution=gp.Restitution(0.9)), gp.EventDriven())
    with pytest.raises(SceneError, match="restitution.*smooth elastic contacts"):
        gp.analysis.lyapunov_exponent(inelastic)
