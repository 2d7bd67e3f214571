"""Short runs of every feature, to compare compiled kernels with their own source, run as plain Python.

    NUMBA_DISABLE_JIT=1 python tests/kernels/interpreted.py ends.npz periodic granular

writes how these end. Python tests every index, and a coverage tool can record which lines have run.
"""

import sys
import warnings
from dataclasses import replace
from types import SimpleNamespace

import numba
import numpy as np
from scenes import gas

import gaspart as gp
from gaspart.analysis.pairs import pair_counts
from gaspart.analysis.structure_factors import factors, wave_vectors
from gaspart.kernels import insertion, model
from gaspart.kernels.event import boxes as candidates
from gaspart.kernels.event import boxes as search
from gaspart.kernels.event import neighbour_lists as event_list
from gaspart.kernels.event import prediction, prefetch
from gaspart.kernels.obstacles import distance
from gaspart.kernels.physics import flight
from gaspart.kernels.step import neighbour_list as step_list
from gaspart.kernels.step import resolve as step_contacts
from gaspart.trajectory.correlator import Correlator

PYTHON = bool(numba.config.DISABLE_JIT)
VISCOUS = gp.Restitution(0.8, 0.4, reference_speed=1.0)
ROUGH, METAL = gp.Restitution(0.95, 0.4), gp.Restitution(1.0, 0.5)
SPARSE = "rough in steps", "holding in steps", "metal in steps"
FEW = "oversized", "dsmc", "dsmc of a mixture"
"""Runs of which `make test` compares the compiled kernels with Python."""
FINE = {"oversized": (6, 6, 5), "oversized and rough": (12, 10)}  # boxes too narrow for the large particles


def event_scenes():
    """Scenes of the event-driven engine, by name; each with features of its own."""
    box, room = gp.Container((6.0, 5.0)), gp.Container((6.0, 6.0, 5.0), ("wall", "periodic", "wall"))
    around = gp.Container((4.0, 4.0), "periodic")
    two = [gp.Species(6, 0.3, temperature=1.0), gp.Species(3, 0.4, mass=3.0, temperature=1.0)]
    fixed = gp.Species(2, 0.3, fixed=True)
    cross = [gp.Wall((1.0, 1.0), (4.0, 3.0)), gp.Wall((4.0, 1.5), (2.0, 4.0))]
    warm_wall = replace(cross[1], temperature=2.0)
    plates = [gp.Plate((2.5, 2.5, 1.5), ((1.0, 0.5, 0.0), (0.0, 0.0, 2.0)))]
    plates += [gp.Plate((3.0, 2.5, 2.0), ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)))]
    parting = gp.Plate((0.0, 0.0, 2.5), ((6.0, 0.0, 0.0), (0.0, 6.0, 0.0)), mass=5.0)
    warm = {"x_low": gp.Thermal(2.0), "x_high": gp.Thermal(0.5, "normal"), "y_low": gp.Thermal(1.0)}
    ramp = gp.Thermal({"y_low": 2.0, "y_high": 1.0})
    partial = {"x_low": ramp, "x_high": gp.Thermal(0.5, accommodation=0.5)}
    low = {"x_low": gp.Well(1.0, 0.5), "z_low": gp.Well(0.5, 0.3, 1.0)}
    high = {"x_high": gp.Sticky(1.0), "z_high": gp.Thermal(1.5)}
    shaking = {"y_low": gp.Vibrating(0.2, 1.3), "y_high": gp.Vibrating(0.1, 0.5, "sawtooth")}
    electrons = [gp.Species(6, 0.2, mass=0.5, temperature=1.0), gp.Species(2, 0.2, fixed=True)]
    electrons.insert(1, gp.Species(4, 0.3, fixed=True, temperature=2.0))
    small, large = gp.Species(12, 0.1, temperature=1.0), gp.Species(2, 0.6, mass=20.0, temperature=1.0)
    heat = {"x_low": gp.Thermal(3.0), "x_high": gp.Thermal(1.0)}
    down = (0.0, -1.0)
    return {
        "periodic": gas(3, 6, 0.2),
        "two masses": gp.Scene(room, two),
        "falling": gp.Scene(box, two, gravity=(0.2, -1.0)),
        "rough": gp.Scene(box, [*two, fixed], restitution=ROUGH),
        "granular": gp.Scene(box, [*two, fixed], gravity=down, restitution=ROUGH, walls=cross),
        "walls": gp.Scene(box, two[:1], walls=cross),
        "plates": gp.Scene(room, two[:1], gravity=(0.0, 0.0, -1.0), walls=plates),
        "thermal": gp.Scene(box, two, gravity=(0.0, -0.5), restitution=ROUGH, faces=warm),
        "partial": gp.Scene(box, two, restitution=ROUGH, faces=partial),
        "warm walls": gp.Scene(box, two, gravity=down, restitution=ROUGH, walls=[cross[0], warm_wall]),
        "holding": gp.Scene(room, two, faces=low | high),
        "vibrating": gp.Scene(box, two, gravity=down, restitution=ROUGH, faces=shaking),
        "piston": gp.Scene(room, two, faces={"x_low": gp.Piston(5.0, 0.1)}),
        "moving wall": gp.Scene(room, two, walls=[parting]),
        "sheared": gp.Scene(around, two, restitution=ROUGH, faces={"y_high": gp.LeesEdwards(0.7)}),
        "viscoelastic": gp.Scene(box, [*two, fixed], restitution=VISCOUS),
        "metal": gp.Scene(box, electrons, restitution=METAL, faces=heat),
        "oversized": gp.Scene(room, [small, large]),
        "oversized and rough": gp.Scene(box, [small, large], gravity=down, restitution=METAL, walls=cross),
    }


def step_scenes():
    """Scenes of the time-stepped engine, by name, each with its time step."""
    dense = gas(2, 40, 0.5, ("wall", "periodic"))
    container, species = dense.container, dense.species
    thin = [gp.Species(16, 0.1, temperature=1.0), gp.Species(1, 0.8, mass=9.0)]
    return {
        "steps": (dense, 0.05),
        "steps that fall": (gp.Scene(container, species, gravity=(-1.0, 0.0)), 0.02),
        "steps that lose": (gp.Scene(container, species, restitution=gp.Restitution(0.9)), 0.02),
        "steps with an oversized particle": (gp.Scene(container, thin), 0.02),
        **{f"{name} in steps": (event_scenes()[name], 0.01) for name in ("rough", "holding", "metal")},
    }


def dsmc_scenes():
    """Scenes of the DSMC engine with its settings, by name. Particles start on lattices: none is inserted."""
    kind = gp.Species(40, 0.05, temperature=1.0, arrangement="lattice")
    two = [kind, replace(kind, count=20, radius=0.08, mass=3.0)]
    flat, cube = gp.Container((6.0, 5.0), ("periodic", "wall")), gp.Container((3.0,) * 3, "periodic")
    room = gp.Container((3.0, 3.0, 2.0), ("wall", "periodic", "wall"))
    rough, viscous = gp.Restitution(0.8, 0.5), gp.Restitution(0.8, reference_speed=1.0)
    heated = {"y_low": gp.Thermal(2.0)}
    normal = {"x_low": gp.Thermal({"z_low": 2.0, "z_high": 1.0}, "normal", accommodation=0.75)}
    openings = {"x_low": gp.Open(0.002, 2.0), "x_high": gp.Open(), "z_low": gp.Thermal(1.5)}
    falling = gp.Scene(flat, two, gravity=(0.0, -0.3), restitution=rough, faces=heated)
    kicked = gp.Scene(cube, two, restitution=viscous, thermostat=gp.Thermostat(1.0, 0.03))
    dense = {"model": "enskog", "cells_per_side": (3, 4, 2)}
    return {
        "dsmc": (gp.Scene(cube, [kind]), {}),
        "dsmc of a mixture": (gp.Scene(room, two), {}),
        "dsmc, rough and falling": (falling, {}),
        "dsmc, thermal": (gp.Scene(room, two, faces=normal), {}),
        "dsmc, open": (gp.Scene(room, [kind], faces=openings, centres_to_walls=True), {}),
        "dsmc, kicked": (kicked, {}),
        "dsmc, stress": (gp.Scene(cube, two, restitution=rough), {}),
        "enskog": (gp.Scene(room, two), dense),
        "enskog, stress": (gp.Scene(cube, two), dense),
        "enskog, rough": (replace(falling, gravity=None), {"model": "enskog", "cells_per_side": (7, 5)}),
    }


def runs():
    """Name of a run -> its scene, engines of the same bits, only the first compiled too, and its length."""
    found = {}
    for name, scene in event_scenes().items():
        fine = gp.EventDriven(boxes_per_side=FINE.get(name, 2))
        searches = gp.EventDriven(), gp.EventDriven("pairs"), fine
        found[name] = scene, searches, {"max_events": 40, "duration": 50.0}
    for name, (scene, step) in step_scenes().items():
        engines = gp.TimeStepped(step), gp.TimeStepped(step, boxes_per_side=3, near_boxes=name not in SPARSE)
        found[name] = scene, engines, {"duration": 0.8}
    more = (gp.TimeStepped(0.05, boxes_per_side=1), gp.TimeStepped(0.05, threads=2))
    found["steps"] = found["steps"][0], found["steps"][1] + more, found["steps"][2]
    for name, (scene, settings) in dsmc_scenes().items():
        found[name] = scene, (gp.DSMC(time_step=0.05, **settings),), {"duration": 0.8}
    return found


def end_of(name, engine, scene, limits):
    """Positions, velocities and spins after a short run, and what was counted."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="gaspart")  # of cells that are too large
        sim = gp.Simulation(scene, engine, seed=1, stress="stress" in name)
    sim.record_events = engine.records_events
    sim.advance(**limits)
    sim.check_invariants()
    state, tally = sim.state, sim.tally
    parts = [state.unwrapped, state.velocities, state.spins]
    parts += [tally.wall_hits, tally.wall_impulse, tally.wall_energy]
    counted = [tally.collisions, tally.virial_sum, tally.worst_contact, tally.deepest_overlap]
    counted.append(tally.dissipated_energy)
    if tally.stress_sum is not None:
        counted += [*tally.stress_sum.ravel(), *tally.heat_sum]
    return np.concatenate([np.ravel(part) for part in (*parts, counted)])


def ends(names):
    """The ends of these runs and the results of other kernels, by name."""
    chosen = {name: run for name, run in runs().items() if name in names}
    found = {name: end_of(name, run[1][0], run[0], run[2]) for name, run in chosen.items()}
    found["order"] = order_of_contacts()
    found["pairs and waves"] = pairs_and_waves()
    found["correlations"] = np.append(correlations(False), correlations(True))
    packing = gp.compress(gas(2, 12, 0.6), seed=1)
    found["growth"] = np.append(packing.positions.ravel(), packing.pressure)
    for name, dimension in (("picture", 3), ("flat picture", 2)):
        state = gp.Simulation(gas(dimension, 6, 0.2, "wall"), gp.EventDriven(), seed=2).state
        found[name] = gp.render(state, size=(32, 24)).astype(float).ravel()
    return found


def order_of_contacts():
    """300 contacts of a step in their order: by numpy, and in Python by the kernel."""
    rng = np.random.default_rng(1)
    pairs = np.sort(rng.integers(0, 50, (300, 2)), axis=1).astype(np.uint32)
    times = rng.integers(0, 40, 300) / 40.0
    if PYTHON:
        order = step_contacts.in_order(np.arange(50, dtype=np.int32), pairs, times)
    else:
        order = np.lexsort((pairs[:, 1], pairs[:, 0], times))
    return np.column_stack([times, pairs])[order].ravel()


def pairs_and_waves():
    """Counts of pairs and sums over waves of random particles, in two and three dimensions."""
    found = []
    for lengths in ((5.0, 3.0), (3.0, 5.0, 4.0)):
        frames = np.random.default_rng(3).random((2, 70, len(lengths))) * lengths
        waves, _ = wave_vectors(lengths, 5.0)
        found += [pair_counts(frames, lengths, 9, 1.5), factors(frames, lengths, waves)]
    return np.concatenate([np.ravel(values) for values in found])


def correlations(displacements):
    """The sums of 9 samples of random particles, up to a lag of 5."""
    scene, rng = gas(3, 4, 0.1), np.random.default_rng(2)
    correlator = Correlator(gp.Correlations(1.0, 5), scene, np.array([1.0, 2.0, 3.0, 0.1]), displacements)
    for velocities, unwrapped in rng.normal(size=(9, 2, 4, 3)):
        state = SimpleNamespace(velocities=velocities, unwrapped=unwrapped)
        correlator.add(SimpleNamespace(state=state))
    return np.concatenate([np.ravel(values) for values in correlator.sums().values()])


def read_fields():
    """Let Python read the fields of records as the compiled kernels do: flights[i].position."""
    for module, name in ((model, "flight_dtype"), (event_list, "page_dtype")):
        plain = getattr(module, name)
        setattr(module, name, lambda dimension, plain=plain: np.dtype((np.record, plain(dimension))))
    named = (model, "PREDICTION"), (event_list, "LISTED"), (distance, "SEGMENT"), (distance, "PLATE")
    for module, name in named:
        setattr(module, name, np.dtype((np.record, getattr(module, name))))


def earliest(flights, i, span, present, boxes, space, gravity):
    """`simd.earliest` for boxes, one candidate after the other; none remains unknown."""
    best, partner = present
    first, count = (int(part) for part in span)
    for candidate in boxes.candidates[first : first + count]:
        other, offset = candidates.number_of(candidate), candidates.offset_of(candidate, space)
        time = flight.time_of_contact(flights, int(i), other, offset, space, gravity)
        if time < best or (time == best and time < np.inf and other < partner):
            best, partner = time, other
    return best, partner, np.uint64(0)


def list_box(candidates, count, places, box, image):
    """`simd.list_box`."""
    candidates[int(count) : int(count) + places.shape[1]] = places[box].astype(np.uint64) | image


def fetch(array, index):
    """`prefetch.fetch`, which has no effect on results."""


def nearer(positions, radii, space, slot, skin, first):
    """`simd.nearer`, one slot after the other."""
    particles, marks = SimpleNamespace(positions=positions), 0
    for other in range(int(first), min(int(first) + 8, len(radii))):
        reach = radii[slot] + radii[other] + skin
        near = step_contacts.distance_squared(particles, slot, other, space) < reach * reach
        marks |= int(near) << (other - int(first))
    return np.uint64(marks)


def nearer_in_page(pages, page, point, offset, square):
    """`event.simd.nearer`, in single precision too."""
    total = np.zeros(8, np.float32)
    with np.errstate(over="ignore"):  # of entries that are not used
        for k, there in enumerate(pages[int(page)]["centres"]):
            total += ((there - np.float32(point[k])) + np.float32(offset[k])) ** 2
    return np.uint64(sum(int(near) << n for n, near in enumerate(total < np.float32(square))))


def equal(numbers, start, number, mask):
    """`event.simd.equal`."""
    near = numbers[int(start) : int(start) + 16] & np.uint32(mask)
    return np.uint64(sum(int(there == number) << n for n, there in enumerate(near)))


def equals(values, first, value):
    """`simd.equals`."""
    return np.uint64(sum(int(there == value) << n for n, there in enumerate(values[int(first) :][:8])))


def compact_eight(words, first, least, kept, number):
    """`simd.compact_eight`."""
    chosen = [word for word in words[int(first) :][:8] if word >= least]
    kept[int(number) : int(number) + len(chosen)] = chosen
    return np.uint64(len(chosen))


def do_without_vectors():
    """Replace what is written in vector instructions by plain loops."""
    search.earliest, search.list_box = earliest, list_box
    event_list.earliest, event_list.nearer, event_list.equal = earliest, nearer_in_page, equal
    prediction.fetch = prefetch.fetch = insertion.fetch = fetch
    step_contacts.fetch = step_list.fetch = fetch
    step_list.nearer, step_list.equals, step_list.compact_eight = nearer, equals, compact_eight
    step_list.bits = lambda word: np.uint64(int(word).bit_count())
    step_list.lowest = event_list.lowest = lambda word: np.uint64((int(word) & -int(word)).bit_length() - 1)


if __name__ == "__main__":
    read_fields()
    do_without_vectors()
    warnings.simplefilter("ignore", RuntimeWarning)  # words of random numbers overflow by design
    np.savez(sys.argv[1], **ends(sys.argv[2:]))
