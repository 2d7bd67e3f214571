"""The tally of impulses of the time-stepped engine: what flies through planes by its definition, with the
impulses of a step where and when the flights before and after them meet; that nothing is missing, whatever
the step; its bits."""

from dataclasses import replace

import numpy as np
import pytest
from engines.planes import carried, rows_of
from engines.test_impulses import BOX, MIXTURE, REFUSED, SCENES

import gaspart as gp
from gaspart.state.tally import ImpulseTally

BINS = 7
STEP = 2.0**-8
HALLS = gp.Container((5.0, 4.0, 3.0), ("periodic", "wall", "periodic"))
HOT = gp.Thermal(1.0, accommodation=0.7)
DENSE = gp.Species(50, 0.3, temperature=1.0)
STEPPED = {
    "falling, mixture": (gp.Scene(BOX, MIXTURE, gravity=(0.3, 0.0, -1.5)), "z"),
    "falling sideways": (gp.Scene(BOX, MIXTURE, gravity=(0.3, 0.0, -1.5)), "y"),
    "wells, mixture": SCENES["wells, mixture"],
    "rough, falling": SCENES["rough, falling"],
    "periodic mixture": (gp.Scene(HALLS, MIXTURE), "x"),
    "hot, across": (gp.Scene(HALLS, MIXTURE, faces={"y_low": HOT, "y_high": HOT}), "y"),
    "hot, along": (gp.Scene(HALLS, MIXTURE, faces={"y_low": HOT, "y_high": HOT}), "x"),
    "centres at walls": (gp.Scene(BOX, MIXTURE, centres_to_walls=True), "z"),
}


def started(scene, axis="z", step=STEP, bins=BINS, **settings):
    """A simulation, which keeps its impulses in so many bins."""
    return gp.Simulation(scene, gp.TimeStepped(step, **settings), 3, tallies=[ImpulseTally(axis, bins)])


def pull_of(scene, axis):
    """The acceleration along an axis."""
    return scene.gravity[axis] if scene.gravity else 0.0


def has_met(before, after, scene):
    """Which particles (N,) have changed their velocity otherwise than by gravity."""
    fallen = after.velocities - before.velocities
    if scene.gravity:
        fallen = fallen - np.array(scene.gravity) * STEP
    return (abs(fallen) > 1e-9).any(axis=1)


def flown(scene, axis, before, after):
    """(species, BINS) what flies through planes in one step with one impulse at most for each particle: at
    the time at which its flights from the state before, and back from that after, are at one place."""
    pull, length = pull_of(scene, axis), scene.container.lengths[axis]
    way = after.unwrapped[:, axis] - before.unwrapped[:, axis]
    first, second = before.velocities[:, axis], after.velocities[:, axis]
    kick = second - first - pull * STEP
    meets = abs(kick) > 1e-9
    late = way - second * STEP + 0.5 * pull * STEP**2
    time = np.where(meets, -late / np.where(meets, kick, 1.0), 0.0)
    assert (time > -1e-9).all() and (time < STEP + 1e-9).all()
    place = before.positions[:, axis] + (first + 0.5 * pull * time) * time
    if scene.container.periodic[axis]:
        place %= length
    left = second - pull * (STEP - time)
    rows, masses = rows_of(scene), before.masses
    flights = (before.positions[:, axis], first, time), (place, left, STEP - time)
    return sum(carried(scene, axis, BINS, (rows, masses, x, v), dt, parts=4) for x, v, dt in flights)


@pytest.mark.thorough
@pytest.mark.parametrize("rewind", [True, False])
@pytest.mark.parametrize("name", STEPPED)
def test_the_tally_is_the_momentum_that_particles_carry_through_planes(name, rewind):
    scene, letter = STEPPED[name]
    simulation, axis = started(scene, letter, rewind=rewind), "xyz".index(letter)
    wanted, found, before, impulses = 0.0, 0.0, simulation.state, 0
    for _ in range(1000):
        simulation.reset_tally()
        simulation.advance(until=before.time + STEP)
        after, tally = simulation.state, simulation.tally
        met = has_met(before, after, scene)
        known = 2 * tally.collisions + tally.wall_hits.sum()  # edges of wells are not counted
        assert met.sum() <= known or "wells" in name
        if met.sum() >= known:  # none has met two
            wanted = wanted + flown(scene, axis, before, after)
            found = found + tally.momentum_flux_sum
            impulses += int(met.sum())
        before = after
    assert impulses > 40
    accuracy = 1e-5 if pull_of(scene, axis) else 1e-10
    assert found == pytest.approx(wanted, abs=accuracy * np.abs(wanted).max())


LONG = {
    "rewound": {},
    "as they lie": {"rewind": False},
    "one pass": {"passes": 1, "step": 0.004},
    "single precision": {"precision": "float32"},
    "threads": {"threads": 2},
}


@pytest.mark.thorough
@pytest.mark.parametrize("how", LONG)
@pytest.mark.parametrize("pull", [0.0, -1.5])
def test_nothing_is_missing_however_long_the_step(pull, how):
    """Where no centre comes nothing flows, but what gravity has given to all below: impulses, of particles
    that meet several others and faces in a step, add up to the momentum that there is."""
    scene = gp.Scene(BOX, [DENSE], gravity=(0.0, 0.0, pull) if pull else None)
    simulation = started(scene, bins=40, **{"step": 0.02, **LONG[how]})
    simulation.advance(until=4.0)
    tally = simulation.tally
    assert tally.collisions > 400 and (tally.multiple_contacts > 20 or simulation.engine.passes == 1)
    found, single = tally.momentum_flux_sum[0], "single" in how
    size = np.abs(found).max()
    assert found[0] == pytest.approx(0.0, abs=1e-12 * size)
    assert found[-1] == pytest.approx(-pull * 50 * tally.time, abs=(1e-4 if single else 1e-11) * size)
    if not pull:
        spread = 2.0 * simulation.state.kinetic_energy / 3.0
        assert found.sum() * 0.1 == pytest.approx(spread * tally.time, rel=0.1)


@pytest.mark.interpreted
@pytest.mark.parametrize("reason", ["loses energy", "fixed particles", "heat flows", "sticky", "one mass"])
def test_scenes_without_equilibrium_at_one_temperature_are_refused(reason):
    scene = replace(REFUSED[reason], gravity=None)
    with pytest.raises(gp.SceneError, match=reason):
        gp.Simulation(scene, gp.TimeStepped(0.01), tallies=[ImpulseTally("z", BINS)])
