"""A simulation by DSMC for a number of steps."""

import gaspart as gp


def advanced(scene, steps, settle=0, seed=1, **settings):
    """A simulation that has made so many steps, counted from after `settle` others."""
    sim = gp.Simulation(scene, gp.DSMC(**settings), seed)
    make(sim, settle)
    sim.reset_tally()
    make(sim, steps)
    return sim


def make(sim, steps):
    """Make so many more steps."""
    step = sim._dynamics.time_step
    sim.advance(until=sim.time + (steps + 0.5) * step)
