"""Compile the kernels of the canonical runs, as many processes as there are cores, before tests share them.

    PYTHONPATH=tests python -m battery.compile_kernels

Otherwise two processes that need a kernel at the same time would both compile it. `pytest --canonical`
refuses unmarked tests that use other loops of the engines.
"""

import os
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace

from battery.disturbed import ROWS
from battery.kinds_of_runs import CANONICAL, KINDS, kernels_of, repeated_simulation, start_of
from battery.loops import LIST, loops_in_use
from battery.test_bits import CANONICAL as CANONICAL_ROWS
from battery.test_bits import COMPARED
from scenes import gas

import gaspart as gp


def different(chosen):
    """Return the runs that differ in their kernels."""
    found = {}
    for engine, name in chosen:
        start = start_of(engine, name)
        found.setdefault((*kernels_of(start.engine, start.scene), *start.forms), (engine, name))
    return list(found.values())


def compile_run(engine, name):
    """Record two intervals of a run in each form that the battery looks at."""
    start = start_of(engine, name)
    for form in start.forms:
        start.record(form, 2)
        repeated_simulation(engine, name, form, 2)
    return loops_in_use()


def compile_row(name):
    """Begin a run under each of its engines, and with events if it records them somewhere."""
    row = ROWS[name]
    for engine in row.engines if name in COMPARED else row.engines[:1]:
        for record in {False, len(row.engines) > 1 or bool(row.record)}:
            simulation = row.simulation(engine, record=record)
            if row.record:  # a restored run records none
                simulation.record_events = record
            first = engine == row.engines[0]
            simulation.advance(until=row.until if first else simulation.engine.quantum or 1e-3 * row.until)
    return loops_in_use()


DISCS = gas(2, 100, 0.1)
OBSTACLES = replace(
    gas(2, 100, 0.1, "wall"), particles=[gp.Particle((4.0, 4.0), (0.0, 0.0), 0.5, fixed=True)]
)
PLATES = {"x_low": gp.Thermal(1.0, velocity=(0.0, -0.5)), "x_high": gp.Thermal(1.0, velocity=(0.0, 0.5))}
GRAINS = gp.Restitution(0.9, contact_duration=0.01)
PLAIN = [
    *((DISCS, engine) for engine in (gp.EventDriven(), gp.TimeStepped(2.0**-6), gp.DSMC(2.0**-4))),
    (OBSTACLES, gp.EventDriven()),
    (replace(OBSTACLES, restitution=GRAINS, faces={"x_low": gp.Thermal(1.0)}), gp.EventDriven()),
    *((KINDS[name].scene, gp.EventDriven()) for name in ("periodic", "mixture", "gravity", "piston")),
    (replace(gas(2, 100, 0.1, ("wall", "periodic")), faces=PLATES), gp.EventDriven()),
    (replace(KINDS["slit"].scene, faces={"z_low": gp.Thermal(1.0, velocity=(0.5, 0.0, 0.0))}), gp.DSMC(0.1)),
    (KINDS["walls"].scene, gp.TimeStepped(2.0**-6, boxes_per_side=2)),
    (KINDS["periodic"].scene, gp.EventDriven(), gp.StressTally()),
    (gas(3, 100, 0.3), gp.EventDriven()),
    (gas(3, 20, 0.55, arrangement="compressed"), gp.EventDriven()),
]
"""Scenes, engines and tallies that many tests have: nothing records their events, but of discs."""


def compile_plain(scene, engine, *tallies):
    """Begin a run."""
    simulation = gp.Simulation(scene, engine, 1, tallies=list(tallies))
    simulation.record_events = engine.records_events and scene is DISCS
    simulation.advance(until=0.25)
    return loops_in_use()


def main():
    """Compile all."""
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        done = [pool.submit(compile_run, *run) for run in different(CANONICAL)]
        done += [pool.submit(compile_row, name) for name in ROWS if name in CANONICAL_ROWS | COMPARED]
        done += [pool.submit(compile_plain, *run) for run in PLAIN]
        loops = set().union(*(future.result() for future in done))
    LIST.parent.mkdir(exist_ok=True)
    LIST.write_text("\n".join(sorted(loops)))


if __name__ == "__main__":
    main()
