"""Short runs of the DSMC engine, to compare compiled kernels with their own source, run as plain Python.

    NUMBA_DISABLE_JIT=1 python tests/kernels/dsmc/interpreted_dsmc.py ends.npz

writes how they end.
"""

import sys
import warnings
from dataclasses import replace

import numba
import numpy as np

import gaspart as gp
from gaspart.kernels import model


def scenes():
    """Scenes with the engine's settings, by name; each with features of its own. Particles start on lattices,
    which need no random insertion."""
    kind = gp.Species(40, 0.05, temperature=1.0, arrangement="lattice")
    two = [kind, replace(kind, count=20, radius=0.08, mass=3.0)]
    flat, cube = gp.Container((6.0, 5.0), ("periodic", "wall")), gp.Container((3.0,) * 3, "periodic")
    room = gp.Container((3.0, 3.0, 2.0), ("wall", "periodic", "wall"))
    rough, viscous = gp.Restitution(0.8, 0.5), gp.Restitution(0.8, reference_speed=1.0)
    heated, normal = (
        {"y_low": gp.Thermal(2.0)},
        {"x_low": gp.Thermal({"z_low": 2.0, "z_high": 1.0}, "normal", accommodation=0.75)},
    )
    openings = {"x_low": gp.Open(0.002, 2.0), "x_high": gp.Open(), "z_low": gp.Thermal(1.5)}
    falling = gp.Scene(flat, two, gravity=(0.0, -0.3), restitution=rough, faces=heated)
    kicked = gp.Scene(cube, two, restitution=viscous, thermostat=gp.Thermostat(1.0, 0.03))
    dense = {"model": "enskog", "cells_per_side": (3, 4, 2)}
    return {
        "periodic": (gp.Scene(cube, [kind]), {}),
        "mixture": (gp.Scene(room, two), {}),
        "rough and falling": (falling, {}),
        "thermal": (gp.Scene(room, two, faces=normal), {}),
        "open": (gp.Scene(room, [kind], faces=openings, centres_to_walls=True), {}),
        "kicked": (kicked, {}),
        "dense": (gp.Scene(room, two), dense),
        "stress": (gp.Scene(cube, two, restitution=rough), {}),
        "dense stress": (gp.Scene(cube, two), dense),
        "dense and rough": (replace(falling, gravity=None), {"model": "enskog", "cells_per_side": (7, 5)}),
    }


def ends():
    """How each run ends, as an array."""
    if numba.config.DISABLE_JIT:  # let Python read the fields of records as the compiled kernels do
        plain = model.flight_dtype
        model.flight_dtype = lambda dimension: np.dtype((np.record, plain(dimension)))
    found = {}
    for name, (scene, settings) in scenes().items():
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="gaspart")
            sim = gp.Simulation(scene, gp.DSMC(time_step=0.05, **settings), seed=3, stress="stress" in name)
        sim.advance(duration=0.8)
        state, tally = sim.state, sim.tally
        sums = [tally.collisions, tally.virial_sum, tally.dissipated_energy, *tally.wall_impulse]
        if sim.tally.stress_sum is not None:
            sums += [*tally.stress_sum.ravel(), *tally.heat_sum]
        parts = state.unwrapped, state.velocities, state.spins, tally.wall_energy, sums
        found[name] = np.concatenate([np.ravel(part) for part in parts])
    return found


if __name__ == "__main__":
    np.savez(sys.argv[1], **ends())
