"""The tally of impulses along an axis: what flows through planes by its definition, flight by flight."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from engines.planes import carried, rows_of

import gaspart as gp
from gaspart.state.tally import ImpulseTally

BINS = 7
MIXTURE = [gp.Species(12, 0.3, temperature=1.0), gp.Species(6, 0.2, mass=3.0, temperature=1.0)]
BOX, FLAT = gp.Container((3.0, 3.0, 4.0)), gp.Container((7.0, 5.0), ("wall", "periodic"))
ROUGH = gp.Species(15, 0.25, temperature=1.0, polydispersity=0.3)
LAW = gp.Restitution(1.0, 1.0)
FALLING = gp.Scene(BOX, MIXTURE[:1], gravity=(0.0, 0.0, -1.5))
SCENES = {
    "wells, mixture": (gp.Scene(FLAT, MIXTURE, faces={"x_low": gp.Well(0.7, 0.9)}), "x"),
    "periodic, an interior wall": (gp.Scene(FLAT, MIXTURE, walls=[gp.Wall((2.0, 1.0), (3.0, 4.0))]), "y"),
    "rough, falling": (gp.Scene(BOX, [ROUGH], restitution=LAW, gravity=(0.0, 0.0, 1.5)), "z"),
}


def flown(scene, axis, states):
    """(species, BINS) what flies through planes between the first and the last of the states."""
    total = 0.0
    for one, after in itertools.pairwise(states):
        particles = rows_of(scene), one.masses, one.positions[:, axis], one.velocities[:, axis]
        total = total + carried(scene, axis, BINS, particles, after.time - one.time)
    return total


@pytest.mark.thorough
@pytest.mark.parametrize("name", SCENES)
def test_the_tally_is_the_momentum_that_particles_carry_through_planes(name):
    scene, axis = SCENES[name]
    simulation = gp.Simulation(scene, gp.EventDriven("pairs"), seed=3, tallies=[ImpulseTally(axis, BINS)])
    simulation.advance(max_events=80)
    wanted = flown(scene, "xyz".index(axis), list(simulation.replay(by="event")))
    found = simulation.tally.momentum_flux_sum
    assert found == pytest.approx(wanted, abs=(5e-3 if scene.gravity else 1e-10) * np.abs(wanted).max())


FIXED = gp.Particle((1.5, 1.5, 2.0), (0.0,) * 3, 0.3, fixed=True)
HOT = {"z_low": gp.Thermal(1.0), "z_high": gp.Thermal(2.0)}
REFUSED = {
    "loses energy": replace(FALLING, restitution=gp.Restitution(0.9)),
    "fixed particles": replace(FALLING, particles=(FIXED,)),
    "heat flows": replace(FALLING, gravity=None, faces=HOT),
    "sticky": replace(FALLING, gravity=None, faces={"z_low": gp.Sticky(1.0)}),
    "vibrating": replace(FALLING, faces={"z_low": gp.Vibrating(0.1, 1.0)}),
    "one mass": replace(
        FALLING, particles=[replace(FIXED, fixed=False, mass=m, position=(1.5, 1.5, m)) for m in (1.0, 3.0)]
    ),
}


@pytest.mark.interpreted
@pytest.mark.parametrize("reason", REFUSED)
def test_scenes_without_equilibrium_at_one_temperature_are_refused(reason):
    with pytest.raises(gp.SceneError, match=reason):
        gp.Simulation(REFUSED[reason], gp.EventDriven(), tallies=[ImpulseTally("z", BINS)])


@pytest.mark.interpreted
def test_other_engines_axes_and_numbers_of_bins_are_refused():
    asked = [ImpulseTally("z", BINS)]
    with pytest.raises(gp.SceneError, match='needs the "event" or "step" engine'):
        gp.Simulation(replace(FALLING, gravity=None), gp.DSMC(0.01), tallies=asked)
    with pytest.raises(gp.SceneError, match="impulses.axis"):
        gp.Simulation(SCENES["wells, mixture"][0], gp.EventDriven(), tallies=asked)
    for text in ("z", "z:", "z:1", "z:1000000", "w:10", "z:1.5"):
        with pytest.raises(gp.SceneError, match="impulses"):
            ImpulseTally.from_text(text)
