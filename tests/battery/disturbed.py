"""Runs whose bits must not depend on how they are made: by which search and how many threads, where they are
split and restored, in which units. A row for each kind of scene; `test_bits` has the columns."""

from dataclasses import dataclass, replace

import numpy as np
from battery.kinds_of_runs import KINDS, SEED, engines, runs
from scenes import gas

import gaspart as gp
from gaspart.engines import Engine
from gaspart.state.tally import ImpulseTally, PairImpulseTally, StressTally

PERIODIC, WALL = "periodic", "wall"
SLIT = (WALL, PERIODIC, PERIODIC)
BOXES, DIRECT, PAIRS, LISTS = (gp.EventDriven(name) for name in ("boxes", "direct", "pairs", "lists"))
SEARCHES, ONE = (BOXES, DIRECT, PAIRS), (BOXES,)
STRESS, IMPULSES, PAIR_IMPULSES = (StressTally(),), (ImpulseTally("z", 7),), (PairImpulseTally(1.6, 6, 0.4),)
PARTITIONS = tuple(gp.EventDriven("boxes", n) for n in (1, 2, 3, (4, 5)))
STEP = 0.02
STEPS = tuple(
    gp.TimeStepped(STEP, **more)
    for more in (
        {},
        {"boxes_per_side": 1},
        {"boxes_per_side": 3, "near_boxes": True},
        {"skin": 0.05},
        {"skin": 2.0},
        {"threads": 2},
        {"threads": 4},
    )
)
FLOAT32 = (gp.TimeStepped(STEP, precision="float32"),)
DENSE_STEPS = tuple(gp.TimeStepped(0.1, threads=n) for n in (1, 2, 4))

DILUTE = tuple(gp.DSMC(threads=n) for n in (1, 2, 3))
IMPULSE_STEPS = tuple(gp.TimeStepped(0.01, **more) for more in ({}, {"boxes_per_side": 2}, {"threads": 2}))


def dsmc(step=0.125, cells=2, model="boltzmann", threads=(1,)):
    """Engines of equal settings with several numbers of threads."""
    return tuple(gp.DSMC(step, cells, model, threads=n) for n in threads)


@dataclass(frozen=True)
class Row:
    """A run and how it is disturbed.

    ends: when it is stopped, tallied anew (the first time) and restored; the last is its end. until: the time
    to which the other columns make it. engines: of the same bits. sees: what is not zero at the end, or the
    row has not its subject. record: with events or without, always; by default where engines are compared.
    Each row says so that fewer kernels are compiled."""

    scene: gp.Scene
    ends: tuple[float, ...]
    until: float = 5.0
    engines: tuple[Engine, ...] = SEARCHES
    seed: int | tuple[int, ...] = 3
    tallies: tuple = ()
    sees: str = "collisions"
    record: bool | None = None

    def simulation(self, engine=None, record=False, **changes):
        """The simulation at its start."""
        row = replace(self, **changes)
        sim = gp.Simulation(row.scene, engine or row.engines[0], row.seed, tallies=list(row.tallies))
        sim.record_events = sim.engine.records_events and (record if row.record is None else row.record)
        return sim


def _scene(lengths, boundary, *species, **rest):
    return gp.Scene(gp.Container(lengths, boundary), list(species), **rest)


def _discs(count, radius=0.5, **more):
    return gp.Species(count, radius, **({"temperature": 1.0} | more))


def _plates(hot=1.0, cold=1.0, across="x", **more):
    """Thermal faces across an axis."""
    return {f"{across}_low": gp.Thermal(hot, **more), f"{across}_high": gp.Thermal(cold, **more)}


DOWN = (0.0, -1.0)
LAW, ROUGH = gp.Restitution(0.9, 0.3), gp.Restitution(0.9, 0.5)
PAIR = [gp.Species(20, 0.3, temperature=1.0), gp.Species(10, 0.2, mass=3.0, temperature=1.0)]
THREE = (
    gp.Particle((2.0, 5.0), (1.0, 0.3), 0.5, mass=2.0, spin=0.3),
    gp.Particle((6.0, 5.4), (-0.5, 0.0), 0.5, mass=3.0),
    gp.Particle((8.0, 2.4), (-0.5, 0.4), 0.8),
)
MIXED = _scene((8.0, 9.0, 7.0), (WALL, PERIODIC, WALL), _discs(40), _discs(10, 0.3, mass=3.0))
CHANNEL = _scene((6.0, 7.0), (WALL, PERIODIC), _discs(16), faces=_plates(), gravity=(0.0, 0.3))
ROUGH_CHANNEL = replace(CHANNEL, restitution=LAW, faces={})
INSIDE = gp.Wall((1.0, 4.0), (5.0, 3.0))
FOUR_FACES = {
    "x_low": gp.Thermal(2.0),
    "x_high": gp.Thermal(1.0, "normal"),
    "y_low": gp.Well(0.7, 0.5, 1.0),
    "y_high": gp.Sticky(1.0),
}
RESERVOIRS = {
    "x_low": gp.Open(0.3, 2.0),
    "x_high": gp.Open(0.1, 1.0),
    "y_low": gp.Thermal(3.0),
    "y_high": gp.Open(),
}
IDEAL = {
    "x_low": gp.Open(0.04, 2.0),
    "x_high": gp.Open(0.01, 1.0),
    "y_low": gp.Thermal(3.0, accommodation=0.5),
    "y_high": gp.Open(),
}
"""Openings that DSMC can have: their reservoirs are dilute."""


def _all_faces(boundary=WALL):
    """Rough discs of two masses among faces of all kinds that a step has."""
    faces = {name: face for name, face in FOUR_FACES.items() if boundary == WALL or name[0] == "y"}
    kinds = _discs(120, 0.2), _discs(10, 0.4, mass=3.0)
    return _scene((12.0, 12.0), boundary, *kinds, restitution=gp.Restitution(1.0, 0.5), faces=faces)


def _sheared(rate, count, packing, dimension=2, **rest):
    """A periodic gas whose images slide."""
    faces = {"y_high": gp.LeesEdwards(rate)}
    return replace(gas(dimension, count, packing), faces=faces, **rest)


def _everything():
    """All that a contact may have: gravity, losses, spins, unlike masses and moments, one fixed, a wall."""
    kinds = [
        _discs(14, 0.4, moment_of_inertia=0.048),
        _discs(9, 0.25, mass=3.0, moment_of_inertia=0.05),
        gp.Species(1, 0.5, fixed=True),
    ]
    spinning = [
        gp.Particle((x, 9.0 - x), (0.0, 0.5), 0.3, spin=spin) for x, spin in ((1.0, -2.0), (8.0, 2.0))
    ]
    rest = {"gravity": (0.05, -0.2), "restitution": gp.Restitution(0.95, 0.4)}
    rest["walls"] = [gp.Wall((3.0, 2.0), (6.5, 5.0))]
    return gp.Scene(gp.Container((11.0, 9.0)), kinds, spinning, **rest)


def _row_and_disc(mass):
    """A row of discs that fills the container's width with a little energy, and a disc that falls on its
    second one at a time of 3: it jams."""
    row = [gp.Particle((0.5 + n, 0.5 + 1e-3 * (n % 2)), (0.01 * (-1) ** n, 0.0), 0.5) for n in range(4)]
    disc = gp.Particle((1.5, 1.5 + 4.5), (0.0, 0.0), 0.5, mass)
    rest = {"gravity": DOWN, "restitution": gp.Restitution(0.8, 0.3)}
    return gp.Scene(gp.Container((4.0, 12.0)), particles=[*row, disc], **rest)


def _column_and_slider():
    """Three discs upon one another that come to rest, and one that hits the lowest at a time of 4."""
    column = [gp.Particle((1.0, (0.5 + 1e-6) + (1.0 + 1e-6) * n), (0.0, 0.0), 0.5) for n in range(3)]
    particles = [*column, gp.Particle((4.0, 0.5), (-0.5, 0.0), 0.5)]
    container = gp.Container((10.0, 6.0))
    return gp.Scene(container, particles=particles, gravity=DOWN, restitution=gp.Restitution(0.5))


def _divided():
    """Two gases and a wall that moves between them."""
    regions = ((0.0, 0.0), (8.0, 6.0)), ((8.0, 0.0), (16.0, 6.0))
    kinds = [_discs(20, 0.4, temperature=t, region=r) for t, r in zip((4.0, 1.0), regions, strict=True)]
    return _scene((16.0, 6.0), (WALL, PERIODIC), *kinds, walls=[gp.Wall((8.0, 0.0), (8.0, 6.0), mass=20.0)])


def _piston(face, lengths=(30.0, 8.0), **more):
    return _scene(lengths, (WALL, PERIODIC), _discs(60), faces={"x_high": face} | more)


def _metal():
    """Points among fixed discs that vibrate."""
    kinds = gp.Species(10, 0.02, temperature=1.0), gp.Species(20, 0.3, fixed=True, temperature=1.0)
    return _scene((10.0, 10.0), PERIODIC, *kinds)


FLYING = [gp.Particle((4e6, 5e6), (1.0, 0.3), 0.5)]
FLIGHT = gp.Scene(gp.Container((1e7, 1e7)), particles=FLYING, restitution=gp.Restitution(0.9))
KICKS = {"restitution": gp.Restitution(0.8), "thermostat": gp.Thermostat(0.3, 0.37)}
FROM_REST = {"restitution": gp.Restitution(0.8), "thermostat": gp.Thermostat(1.0, 10.0)}
MIRRORS = _scene((10.0, 4.0, 4.0), SLIT, _discs(60, 0.3, temperature=1.2), faces={
    "x_low": gp.Thermal(2.0, velocity=(0.0, 0.0, 0.0), accommodation=0.75),
    "x_high": gp.Thermal(1.0, velocity=(0.0, 1.0, 0.0), accommodation=0.375),
})  # fmt: skip
SLIDING = _scene((5.0, 10.0, 10.0), SLIT, _discs(400, 0.2), faces={
    f"x_{side}": gp.Thermal(1.0, velocity=(0.0, speed, 0.0)) for side, speed in (("low", -0.5), ("high", 0.5))
})  # fmt: skip
RAMPS = {f"y_{side}": gp.Thermal({"x_low": 1.0, "x_high": 4.0}) for side in ("low", "high")}
WARM = gp.Wall((3.0, 4.0), (7.0, 6.0), temperature=4.0)
SHAKEN = {"y_low": gp.Vibrating(0.2, 1.3), "y_high": gp.Vibrating(0.15, 0.7, "sawtooth")}
PULLED = _scene(
    (8.0, 9.0), WALL, _discs(25, 0.4), gravity=(0.0, -0.5), restitution=gp.Restitution(0.95, 0.2),
    walls=[gp.Wall((2.0, 4.0), (6.0, 5.0))], faces={"x_low": gp.Thermal(1.5)},
)  # fmt: skip
PILE = _scene((8.0, 8.0), WALL, _discs(12), gravity=DOWN, restitution=gp.Restitution(0.9), walls=[INSIDE])
STILL = [_discs(60, moment_of_inertia=0.1), gp.Species(20, 0.4, fixed=True)]
LISTED_FACES = {"x_low": gp.Thermal(2.0), "x_high": gp.Well(0.5, 0.7), "y_low": gp.Sticky(1.0)}
CASE, FALL = (3.0, 3.0, 4.0), (0.0, 0.0, -1.5)
MIXTURE = _scene((4.0,) * 3, PERIODIC, *PAIR)
ROUGH_PAIR = _scene((9.0, 7.0), PERIODIC, *PAIR, restitution=gp.Restitution(0.9, 0.5, contact_duration=0.0))
SHORT, LONG = (0.3, 1.7, 5.0), (0.1, 0.37, 5.0, 40.0, 300.0)

ROWS = {
    # No feature: boundaries, sizes, densities, searches.
    "discs": Row(gas(2, 20, 0.11), SHORT, 4.0, (*SEARCHES, LISTS, *PARTITIONS), record=False),
    "discs, walls": Row(gas(2, 100, 0.05, WALL), (3.0, 3.1, 9.0, 20.0), 20.0, (BOXES, *PARTITIONS)),
    "discs, periodic": Row(gas(2, 100, 0.05), (3.0, 3.1, 9.0, 20.0), 20.0, (BOXES, *PARTITIONS)),
    "spheres, walls": Row(gas(3, 100, 0.05, WALL), SHORT, 20.0, (BOXES, *PARTITIONS[:3])),
    "spheres": Row(gas(3, 100, 0.05), SHORT, 20.0, (BOXES, *PARTITIONS[:3])),
    "slit": Row(gas(3, 60, 0.1, SLIT), tuple(np.arange(1, 71) / 7.0), 10.0, record=False),
    "two masses": Row(MIXED, SHORT, 4.0, (*SEARCHES, LISTS, *PARTITIONS[:3]), record=False),
    "many spheres": Row(gas(3, 1000, 0.2), tuple(0.25 * np.arange(1, 41)), 0.25, ONE),
    "rounded sums": Row(_scene((10.0, 10.0), WALL, _discs(2), _discs(2, 0.3, mass=0.1)),
        tuple(np.linspace(0.0, 1500.0, 21)[1:]), 50.0, seed=5, engines=ONE),
    **{f"lists, {d}D, {boundary}": Row(gas(d, 400, eta, boundary, arrangement="lattice"), (1.0, 1.5), 4.0,
        (LISTS, BOXES), record=True) for d, eta in ((2, 0.65), (3, 0.45)) for boundary in (PERIODIC, WALL)},
    "lists, slit": Row(gas(3, 120, 0.4, (PERIODIC, PERIODIC, WALL), arrangement="lattice"), (0.1, 0.5, 2.0),
        2.0, (LISTS, BOXES)),
    "lists of all room": Row(gas(3, 500, 0.3), (80.0, 80.5), 1.0, (LISTS, BOXES), (4, 2)),
    "lists, rough": Row(_scene((15.0, 12.0), WALL, *STILL, restitution=gp.Restitution(1.0, 0.5)), SHORT, 20.0,
        (BOXES, LISTS), 1, record=True),
    "lists, faces": Row(_scene((15.0, 12.0), WALL, *STILL, faces=LISTED_FACES), SHORT, 20.0, (BOXES, LISTS),
        1, sees="wall_energy", record=True),
    # Gravity and forces along periodic axes.
    "falling": Row(replace(gas(2, 60, 0.1, (PERIODIC, WALL)), gravity=DOWN), tuple(np.arange(1, 71) / 7.0),
        10.0, seed=2),
    "falling discs, boxes": Row(replace(gas(2, 100, 0.05, WALL), gravity=(0.3, -2.0)), SHORT, 10.0, (BOXES,
        *PARTITIONS), 1),
    "falling spheres, boxes": Row(replace(gas(3, 100, 0.05, WALL), gravity=(0.3, -2.0, 0.1)), SHORT, 10.0,
        (BOXES, *PARTITIONS[:3]), 1, record=True),
    "driven": Row(CHANNEL, LONG, 30.0, sees="collisions wall_shear"),
    "driven downwards": Row(replace(CHANNEL, gravity=(0.0, -0.3)), SHORT, 30.0),
    "driven spheres": Row(_scene((5.0, 6.0, 4.0), SLIT, _discs(20), faces=_plates(), gravity=(0.0, 0.2,
        -0.3)), SHORT, 10.0, record=True),
    "driven, rough": Row(ROUGH_CHANNEL, LONG, 20.0, sees="collisions dissipated_energy"),
    "driven down a slope": Row(replace(ROUGH_CHANNEL, gravity=(0.2, 0.3)), SHORT, 15.0),
    "driven from rest": Row(replace(ROUGH_CHANNEL, species=[gp.Species(16, 0.5)]), (0.3, 5.0, 300.0), 300.0,
        sees=""),
    "driven, fixed": Row(replace(CHANNEL, container=gp.Container((8.0, 7.0), PERIODIC), faces={},
        restitution=gp.Restitution(0.8), particles=[gp.Particle((4.0, 3.5), (0.0, 0.0), 0.5, fixed=True)]),
        SHORT, 20.0, sees="fixed_collisions", record=True),
    "driven, wall": Row(replace(ROUGH_CHANNEL, walls=[gp.Wall((2.0, 3.0), (4.0, 3.5))],
        restitution=gp.Restitution(0.8)), SHORT, 15.0, record=True),
    "driven, one large": Row(_scene((20.0, 20.0), (WALL, PERIODIC), _discs(30, 0.2), _discs(1, 2.0, mass=9.0),
        faces=_plates(), gravity=(0.0, 0.3)), SHORT, 30.0, record=True),
    # Laws of contacts.
    "everything": Row(_everything(), (1.0, 5.0, 16.0), 16.0, ONE, record=False,
        sees="dissipated_energy fixed_collisions wall_hits"),
    "rough spheres": Row(replace(gas(3, 50, 0.1), restitution=ROUGH), (2.0, 3.0, 4.0), 4.0,
        sees="dissipated_energy", engines=ONE),
    "viscoelastic": Row(_scene((40.0, 40.0), WALL, _discs(60), restitution=gp.Restitution(0.8, -0.5,
        reference_speed=2.0)), (0.1, 5.0, 40.0), 10.0, sees="dissipated_energy", engines=ONE),
    "lasting contacts": Row(PILE, (0.3, 5.0, 11.7, 30.0, 200.0), 8.0,
        sees="elastic_contacts retained_energy"),
    "stated duration of contacts": Row(replace(PILE, restitution=gp.Restitution(0.9, -1.0, 0.05)), (0.3, 5.0,
        40.0), 8.0, ONE, sees="elastic_contacts"),
    "pulled": Row(PULLED, SHORT, 4.0, (*SEARCHES, *PARTITIONS[:3]), 2, sees="wall_energy dissipated_energy",
        record=False),
    "sheared discs": Row(_sheared(0.8, 40, 0.25), SHORT, 3.0, (*SEARCHES, *(gp.EventDriven("boxes", n) for n
        in ((5, 1), (2, 5)))), 4, STRESS, record=False),
    "sheared rough spheres": Row(_sheared(0.8, 40, 0.25, 3, restitution=ROUGH), SHORT, 3.0, SEARCHES, 4,
        STRESS, record=False),
    "sheared for epochs": Row(_sheared(0.7, 60, 0.3, restitution=gp.Restitution(0.9)), (1.234, 57.0, 400.5,
        700.0, 900.0), 2.0, (DIRECT, BOXES), 6, STRESS, record=False),
    # At rest, and long after.
    "a column that rests": Row(_column_and_slider(), (0.3, 2.0, 3.9, 4.1, 30.0), 6.0),
    **{f"a jam hit by {mass:g}": Row(_row_and_disc(mass), (0.3, 1.7, 3.05, 3.5, 5.0), record=False) for mass
        in (0.001, 0.05, 1.0)},
    "a long flight": Row(FLIGHT, tuple(np.linspace(0.0, 3e9, 50)[1:]), 3e8, sees="wall_hits", engines=ONE),
    "kicked": Row(replace(gas(2, 20, 0.1), **KICKS), (0.1, 0.37, 5.0, 40.0, 700.0), 20.0,
        sees="thermostat_energy collisions"),
    "kicked spheres": Row(replace(gas(3, 20, 0.1), **KICKS), (0.1, 0.37, 5.0, 40.0, 700.0), 20.0, ONE,
        sees="thermostat_energy"),
    "kicked from rest": Row(_scene((10.0,) * 3, WALL, gp.Species(30, 0.3), **FROM_REST), (5.0, 10.0, 10.5,
        25.0, 41.0), 30.0, seed=1, sees="thermostat_energy", engines=ONE),
    # Faces and walls.
    "hot and cold": Row(_scene((4.0, 4.0, 4.0), SLIT, _discs(200, 0.001), faces=_plates(4.0, 1.0)), (3.3, 5.0,
        9.0), 9.0, seed=7, sees="wall_energy", engines=ONE),
    "mirrors": Row(MIRRORS, (4.0, 5.0, 8.0), 8.0, sees="collisions wall_shear", record=False),
    "ramps": Row(_scene((16.0, 4.0), WALL, _discs(400, 2e-5, temperature=2.0), faces=_plates(1.0, 4.0) |
        RAMPS), (1.0, 3.0, 10.0), 3.0, ONE, sees="wall_energy"),
    "sliding": Row(SLIDING, (1.0, 2.0), 1.0, ONE, 4, sees="wall_shear collisions"),
    "a warm wall": Row(_scene((10.0, 10.0), WALL, _discs(20, 0.2), faces=_plates() | _plates(across="y"),
        walls=[WARM]), (3.3, 5.0, 9.0), 9.0, seed=4, sees="wall_energy"),
    "a moving wall": Row(_divided(), LONG, 10.0, sees="wall_energy wall_hits", engines=ONE),
    "a piston": Row(_piston(gp.Piston(20.0, 0.6)), (0.1, 0.37, 5.0, 40.0, 100.0, 900.0), 10.0),
    "a piston at a speed": Row(_piston(gp.Piston(speed=0.05), (60.0, 8.0)), (0.1, 3.0, 40.0, 300.0), 20.0,
        sees="wall_energy"),
    "vibrating faces": Row(_scene((9.0, 12.0), (PERIODIC, WALL), _discs(20, 0.05), faces=SHAKEN, gravity=DOWN,
        restitution=ROUGH), (0.1, 0.37, 5.0, 40.0, 100.0), 10.0, sees="wall_energy"),
    "vibrating scatterers": Row(_metal(), (3.3, 6.0, 9.0), 9.0, seed=7, sees="fixed_collisions", engines=ONE),
    "open faces": Row(_scene((6.0, 6.0), WALL, _discs(12, mass=2.0), faces=RESERVOIRS, centres_to_walls=True),
        (0.7, 3.0, 40.0), 40.0, seed=8, sees="entries wall_hits", record=False),
    # Tallies.
    "stress, mixture": Row(MIXTURE, (1.2, 2.0, 3.0), 3.0, SEARCHES[:2], seed=4, tallies=STRESS, record=False),
    "stress, rough": Row(ROUGH_PAIR, (1.2, 2.0, 3.0), 3.0, seed=4, tallies=STRESS, record=False),
    "impulses": Row(_scene(CASE, WALL, _discs(12, 0.3), gravity=FALL), (7.3, 9.0, 20.0), 20.0, (BOXES, PAIRS),
        tallies=IMPULSES, record=False),
    "impulses of pairs": Row(_scene((7.0, 6.0, 5.0), PERIODIC, _discs(60)), (2.3, 4.0, 6.0), 6.0, (BOXES,
        LISTS), tallies=PAIR_IMPULSES, record=False),
    # Time steps.
    **{f"steps, dense, {name}": Row(gas(2, 300, 0.5, boundary), (2.0, 4.0), 4.0, DENSE_STEPS,
        sees="multiple_contacts") for name, boundary in (("walls", WALL), ("periodic", PERIODIC), ("slit",
        (WALL, PERIODIC)))},
    "steps, float32": Row(gas(2, 100, 0.2, (WALL, PERIODIC)), (3.0, 6.0, 10.0), 3.0, FLOAT32, 1),
    "steps, two masses": Row(MIXED, (1.5, 2.5, 4.0), 4.0, STEPS, 2),
    "steps, many spheres": Row(gas(3, 1000, 0.2), tuple(0.25 * np.arange(1, 11)), 0.25, STEPS[:1]),
    "steps, all faces": Row(_all_faces(), (0.4, 2.0, 6.0), 1.6, STEPS, 4, sees="wall_energy collisions"),
    "steps, faces across y": Row(_all_faces((PERIODIC, WALL)), (0.4, 0.8, 1.6), 1.6, STEPS, 4,
        sees="wall_energy"),
    "steps, lossy": Row(gp.Scene(gp.Container((10.0, 10.0)), particles=THREE, faces={"y_high": gp.Thermal(3.0,
        "normal")}, restitution=gp.Restitution(0.9, 0.2)), (0.4, 5.0, 15.0), 5.0, STEPS[:1],
        sees="wall_energy"),
    "steps, centres at walls, fixed": Row(_scene((10.0, 10.0), WALL, _discs(40, 0.3), gp.Species(3, 0.3,
        fixed=True), centres_to_walls=True), (0.4, 5.0, 15.0), 5.0, STEPS[:1], sees="fixed_collisions"),
    "steps, impulses": Row(_scene(CASE, WALL, _discs(50, 0.3), _discs(6, 0.2, mass=3.0), gravity=FALL), (0.7,
        1.0, 2.0), 2.0, IMPULSE_STEPS, tallies=IMPULSES),
    # DSMC.
    "dsmc, walls": Row(gas(3, 3000, 0.001, WALL), (1.0, 20.0, 40.0), 40.0, DILUTE),
    "dsmc, open faces": Row(_scene((20.0, 16.0), WALL, _discs(40, 0.25, mass=2.0), faces=IDEAL,
        centres_to_walls=True), (1.3, 7.0, 30.0), 30.0, DILUTE, sees="entries wall_hits collisions"),
    "dsmc": Row(gas(3, 3000, 0.001), (1.0, 20.0, 40.0), 40.0, DILUTE),
    "dsmc, mirrors": Row(MIRRORS, (4.0, 5.0, 8.0), 8.0, dsmc(threads=(1, 2)), sees="collisions wall_shear"),
    "dsmc, sliding": Row(SLIDING, (1.0, 2.0), 1.0, dsmc(0.25, 1), 4, sees="wall_shear collisions"),
    "dsmc, stress, mixture": Row(MIXTURE, (1.2, 2.0, 3.0), 3.0, dsmc(0.02), 4, STRESS),
    "enskog, stress, mixture": Row(MIXTURE, (1.2, 2.0, 3.0), 3.0, dsmc(0.02, 1, "enskog"), 4, STRESS),
    "dsmc, stress, rough": Row(ROUGH_PAIR, (1.2, 2.0, 3.0), 3.0, dsmc(0.02), 4, STRESS),
    "enskog, stress, rough": Row(ROUGH_PAIR, (1.2, 2.0, 3.0), 3.0, dsmc(0.02, 1, "enskog"), 4, STRESS),
    "dsmc, viscoelastic": Row(replace(gas(3, 3000, 0.001), restitution=gp.Restitution(0.8,
        reference_speed=1.0)), (1.0, 20.0, 40.0), 20.0, DILUTE[:1], sees="dissipated_energy"),
    "dsmc, centres at walls": Row(replace(gas(3, 3000, 0.001, WALL), centres_to_walls=True), (1.0, 20.0,
        40.0), 20.0, DILUTE[:1]),
    "dsmc, stress": Row(gas(3, 2000, 0.01), (0.1, 0.3, 0.5), 0.5, dsmc(0.02, 6, threads=(1, 2)), 1, STRESS),
}  # fmt: skip
"""Name -> row. Each stands for a feature, or for something that has gone wrong once."""


def of_battery():
    """Engine and kind -> row of the battery's runs, each of which is a kind of scene under an engine."""
    rows = {}
    for engine, name in runs()[0]:
        kind = KINDS[name]
        ends = tuple(kind.interval * n for n in (3, 11, 32))
        settings = {"engines": (engines(kind.interval)[engine],), "seed": SEED, "sees": ""}
        settings["record"] = not kind.scene.is_open
        rows[f"{engine}: {name}"] = Row(kind.scene, ends, until=0.0, **settings)
    return rows
