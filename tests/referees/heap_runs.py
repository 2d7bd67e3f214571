"""Discs of two sizes that fall into a box and come to rest there, for LAMMPS to repeat with soft contacts."""

import gaspart as gp

LENGTHS = 10.0, 16.0
RADII = 0.45, 0.55
EACH = 40
"""Discs of each size."""
RESTITUTION = 0.8
CONTACT = 0.003
"""Duration of a contact, in units of sqrt(d / g). It is short enough: heaps with a third of it are higher by
0.1(3) %, those with three times as much lower by 0.3(2) %."""
DURATION = 60.0
HEAPS = 80
FIRST = 1
"""Seed of the first."""


def heaps():
    """What LAMMPS has to know, all starts, and the mean height of the centres at the end of each run."""
    species = [gp.Species(EACH, radius, temperature=1.0) for radius in RADII]
    law = gp.Restitution(normal=RESTITUTION, contact_duration=CONTACT)
    container = gp.Container(lengths=LENGTHS)
    scene = gp.Scene(container, species, gravity=(0.0, -1.0), restitution=law)
    starts, heights = [], []
    for seed in range(FIRST, FIRST + HEAPS):
        sim = gp.Simulation(scene, gp.EventDriven(), seed)
        start = sim.state
        starts.append({"positions": start.positions.tolist(), "velocities": start.velocities.tolist()})
        sim.advance(DURATION)
        heights.append(float(sim.state.positions[:, 1].mean()))
    stated = {"width": LENGTHS[0], "height": LENGTHS[1], "restitution": RESTITUTION, "duration": DURATION}
    return stated | {"radii": start.radii.tolist(), "starts": starts, "heights": heights}
