"""Scenes that several tests use, and how to draw random ones."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import strategies as st

import gaspart as gp


def gas(dimension, count, packing_fraction, boundary="periodic", **properties):
    """A gas of particles of diameter 1 at temperature 1 in a cube or square of the right size."""
    properties = {"radius": 0.5, "temperature": 1.0} | properties
    unit = math.pi if dimension == 2 else 4 / 3 * math.pi
    side = (count * unit * properties["radius"] ** dimension / packing_fraction) ** (1 / dimension)
    return gp.Scene(gp.Container((side,) * dimension, boundary), [gp.Species(count, **properties)])


def sent(position, velocity, walls, radius=0.5, boxes_per_side=None, side=12.0, boundary="wall", **rest):
    """One particle among walls."""
    particle = gp.Particle(position, velocity, radius)
    scene = gp.Scene(gp.Container((side, side), boundary), particles=[particle], walls=walls, **rest)
    return gp.Simulation(scene, gp.EventDriven(boxes_per_side=boxes_per_side))


@st.composite
def mixtures(draw, most=12):
    """Small scenes of one or two species, any boundary, uneven sides, moderate density."""
    dimension = draw(st.sampled_from([2, 3]))
    boundary = draw(st.lists(st.sampled_from(["wall", "periodic"]), min_size=dimension, max_size=dimension))
    lengths = draw(st.lists(st.floats(4.5, 9.0), min_size=dimension, max_size=dimension))
    kinds = [
        {
            "count": draw(st.integers(1, most // 2)),
            "radius": draw(st.floats(0.1, 0.8)),
            "mass": draw(st.sampled_from([1.0, 1.0, 0.1, 30.0])),
            "temperature": draw(st.floats(0.1, 10.0)),
        }
        for _ in range(draw(st.integers(1, 2)))
    ]
    filled = sum(4 * kind["count"] * kind["radius"] ** dimension for kind in kinds) / math.prod(lengths)
    for kind in kinds:  # thin enough for random insertion
        kind["radius"] *= min(1.0, 0.25 / filled) ** (1 / dimension)
    species = [gp.Species(**kind) for kind in kinds]
    return gp.Scene(gp.Container(lengths, boundary), species, centres_to_walls=draw(st.booleans()))


@st.composite
def falling(draw, most=12):
    """The same under gravity of any direction that the boundary allows, weak to strong; spheres have one
    mass, so that fewer kernels are compiled."""
    scene = draw(mixtures(most))
    if scene.dimension == 3:
        mass = scene.species[0].mass
        scene = replace(scene, species=tuple(replace(kind, mass=mass) for kind in scene.species))
    strengths = st.sampled_from([-3.0, -1.0, -0.1, 0.0, 0.3, 1.0, 1e-9, -40.0])
    gravity = tuple(0.0 if periodic else draw(strengths) for periodic in scene.container.periodic)
    return replace(scene, gravity=gravity)


@st.composite
def granular(draw, most=12):
    """The same with restitution, moments of inertia, fixed particles and perhaps gravity."""
    scene = draw(st.one_of(mixtures(most), falling(most)))
    law = gp.Restitution(
        draw(st.sampled_from([1.0, 0.95, 0.7])), draw(st.sampled_from([-1.0, 1.0, 0.4, -0.5]))
    )
    if scene.centres_to_walls:
        law = gp.Restitution(law.normal)
    species = [
        replace(kind, moment_of_inertia=draw(st.sampled_from([None, 0.3, 5.0]))) for kind in scene.species
    ]
    if draw(st.booleans()):
        still = gp.Species(draw(st.integers(1, 2)), 0.3, fixed=True)
        species.append(still)
    return replace(scene, species=tuple(species), restitution=law)


@st.composite
def walled(draw, most=12):
    """Scenes of two dimensions with interior walls, which may cross, and now and then all the rest."""
    lengths = draw(st.lists(st.floats(6.0, 9.0), min_size=2, max_size=2))
    boundary = draw(st.lists(st.sampled_from(["wall", "periodic"]), min_size=2, max_size=2))
    point = st.tuples(*(st.floats(0.0, length) for length in lengths))
    ends = draw(st.lists(st.tuples(point, point), min_size=1, max_size=4))
    walls = [gp.Wall(a, b) for a, b in ends if abs(a[0] - b[0]) + abs(a[1] - b[1]) > 1e-3]
    gravity = tuple(0.0 if b == "periodic" else draw(st.sampled_from([0.0, -1.0, 0.3])) for b in boundary)
    law = draw(st.sampled_from([None, None, gp.Restitution(0.9, 0.5), gp.Restitution(1.0, 1.0)]))
    species = [gp.Species(draw(st.integers(1, most)), draw(st.floats(0.1, 0.3)), temperature=1.0)]
    if law and draw(st.booleans()):
        species.append(gp.Species(2, 0.3, mass=2.0, temperature=1.0))
    return gp.Scene(
        gp.Container(lengths, boundary),
        species,
        gravity=draw(st.sampled_from([None, gravity])),
        restitution=law,
        walls=walls,
    )


@st.composite
def surfaced(draw, most=12):
    """Scenes whose faces are thermal, sticky or attract: rough discs that fall, or spheres of two masses."""
    dimension = draw(st.sampled_from([2, 3]))
    lengths = draw(st.lists(st.floats(4.5, 9.0), min_size=dimension, max_size=dimension))
    boundary = draw(st.lists(st.sampled_from(["wall", "periodic"]), min_size=dimension, max_size=dimension))
    boundary[1] = "wall"
    kinds = {
        "thermal": st.builds(gp.Thermal, st.floats(0.2, 5.0), st.sampled_from(["all", "normal"])),
        "well": st.builds(gp.Well, st.floats(0.1, 3.0), st.floats(0.01, 1.2), st.sampled_from([None, 1.0])),
        "sticky": st.builds(gp.Sticky, st.floats(0.1, 2.0)),
    }
    faces = {}
    for axis in range(dimension):
        for side in ("low", "high"):
            falls = dimension == 2 and axis == 1
            kind = draw(st.sampled_from(["thermal", *(() if falls else ("well", "sticky", "hard"))]))
            if boundary[axis] == "wall" and kind != "hard":
                faces[f"{'xyz'[axis]}_{side}"] = draw(kinds[kind])
    count, radius = st.integers(1, most // 2), st.floats(0.1, 0.4)
    species = [gp.Species(draw(count), draw(radius), mass=mass, temperature=1.0) for mass in (1.0, 2.0)]
    elastic = any(isinstance(face, gp.Sticky) for face in faces.values())  # stuck particles vibrate
    law = gp.Restitution(1.0 if elastic else draw(st.sampled_from([1.0, 0.9])), 0.5)
    discs = {"gravity": (0.0, -0.5), "restitution": law}
    container = gp.Container(lengths, boundary)
    return gp.Scene(container, species, faces=faces, **(discs if dimension == 2 else {}))


@st.composite
def metals(draw, most=12):
    """Discs among fixed ones that vibrate, and perhaps rigid ones, between thermal walls across x."""
    lengths = draw(st.lists(st.floats(4.5, 9.0), min_size=2, max_size=2))
    boundary = ("wall", draw(st.sampled_from(["wall", "periodic"])))
    species = [
        gp.Species(draw(st.integers(1, most // 2)), draw(st.floats(0.02, 0.3)), mass=0.5, temperature=1.0),
        gp.Species(draw(st.integers(1, most // 2)), 0.3, fixed=True, temperature=draw(st.floats(0.1, 3.0))),
        gp.Species(draw(st.integers(0, 2)), 0.2, fixed=True),
    ]
    particles = [
        gp.Particle((0.5, 0.5), (0.0, 0.0), 0.25, fixed=True, vibration=draw(st.sampled_from([0.0, 2.0])))
    ]
    faces = {"x_low": gp.Thermal(draw(st.floats(0.5, 4.0))), "x_high": gp.Thermal(1.0)}
    law = gp.Restitution(1.0, draw(st.sampled_from([-1.0, 0.5])))
    return gp.Scene(gp.Container(lengths, boundary), species, particles, restitution=law, faces=faces)


@st.composite
def uneven(draw, most=16):
    """Small particles among one to three large ones: alone in 3D; in 2D rough, falling, with a wall inside,
    the large ones perhaps fixed (two kinds of scene, so that few kernels are compiled)."""
    dimension = draw(st.sampled_from([2, 3]))
    boundary = draw(st.lists(st.sampled_from(["wall", "periodic"]), min_size=dimension, max_size=dimension))
    lengths = draw(st.lists(st.floats(5.0, 8.0), min_size=dimension, max_size=dimension))
    small = gp.Species(draw(st.integers(4, most)), draw(st.floats(0.001, 0.15)), temperature=1.0)
    size, mass = draw(st.floats(0.4, 1.2)), draw(st.sampled_from([0.5, 20.0]))
    large = gp.Species(draw(st.integers(1, 3)), size, mass=mass, temperature=1.0)
    if dimension == 3:
        return gp.Scene(gp.Container(lengths, boundary), [small, large])
    if draw(st.booleans()):
        large = replace(large, temperature=None, fixed=True)
    return gp.Scene(
        gp.Container(lengths, (boundary[0], "wall")),
        [small, large],
        gravity=(0.0, -1.0),
        restitution=gp.Restitution(1.0, 0.5),
        walls=[gp.Wall((1.0, 1.0), (4.5, draw(st.floats(0.0, 2.0))))],
    )


@st.composite
def partitioned(draw, most=10):
    """Spheres that fall among plates, which may cross, lie askew, and be met across periodic faces."""
    lengths = draw(st.lists(st.floats(5.0, 8.0), min_size=3, max_size=3))
    kinds = st.sampled_from(["wall", "periodic"])
    boundary = (draw(kinds), draw(kinds), "wall")
    walls = []
    for _ in range(draw(st.integers(1, 3))):
        angle, size = draw(st.floats(0.0, 3.1)), draw(st.floats(0.5, 2.0))
        one = (size * math.cos(angle), size * math.sin(angle), 0.0)
        tilt, height = draw(st.floats(0.0, 3.1)), draw(st.floats(0.5, 2.0))
        across = (-height * math.sin(angle) * math.cos(tilt), height * math.cos(angle) * math.cos(tilt))
        corner = tuple(draw(st.floats(2.0 if k == 2 else 2.3, lengths[k] - 2.3)) for k in range(3))
        plate = gp.Plate(corner, (one, (*across, height * math.sin(tilt))))
        ends = plate.corners.values()
        inside = all(0.0 <= x <= size for end in ends for x, size in zip(end, lengths, strict=True))
        walls += [plate] if inside else []
    species = [gp.Species(draw(st.integers(1, most)), draw(st.floats(0.1, 0.4)), temperature=1.0)]
    gravity = (0.0, 0.0, draw(st.sampled_from([-0.5, -2.0])))
    return gp.Scene(gp.Container(lengths, boundary), species, gravity=gravity, walls=walls)


@st.composite
def opened(draw, most=1e4):
    """Discs between open faces: dense, dilute or empty, one or more reservoirs or a vacuum.

    most: greatest activity
    """
    activities = st.one_of(st.none(), st.floats(-8.0, math.log10(most)).map(lambda power: 10.0**power))
    kinds = {}
    for name in draw(st.sets(st.sampled_from(["x_low", "x_high", "y_low", "y_high"]), min_size=1)):
        activity = draw(activities)
        kinds[name] = gp.Open() if activity is None else gp.Open(activity, draw(st.sampled_from([0.5, 2.0])))
    if "y_low" not in kinds and draw(st.booleans()):
        kinds["y_low"] = gp.Thermal(1.0, accommodation=draw(st.sampled_from([None, 0.5])))
    lengths = draw(st.tuples(*[st.floats(3.0, 9.0)] * 2))
    species = [gp.Species(draw(st.integers(1, 4)), 0.5, temperature=1.0)]
    return gp.Scene(gp.Container(lengths), species, faces=kinds, centres_to_walls=True)


@st.composite
def pressed(draw):
    """Some discs or spheres of one or two kinds behind a piston on one of the walls; spheres have one mass,
    so that fewer kernels are compiled."""
    dimension = draw(st.sampled_from([2, 3]))
    lengths = draw(st.lists(st.floats(4.5, 9.0), min_size=dimension, max_size=dimension))
    boundary = ["wall", *draw(st.lists(st.sampled_from(["wall", "periodic"]), min_size=1, max_size=2))]
    species = [gp.Species(draw(st.integers(1, 12)), draw(st.floats(0.1, 0.4)), temperature=1.0)]
    if draw(st.booleans()):
        mass = draw(st.floats(0.01, 100.0)) if dimension == 2 else 1.0
        species.append(gp.Species(3, 0.3, mass=mass, temperature=1.0))
    piston = gp.Piston(draw(st.floats(1e-3, 1e4)), draw(st.sampled_from([0.0, 0.01, 0.5, 20.0])))
    boundary = (boundary * 2)[:dimension] if dimension == 3 else boundary[:2]
    return gp.Scene(
        gp.Container(lengths, boundary), species, faces={draw(st.sampled_from(["x_low", "x_high"])): piston}
    )


@st.composite
def parted(draw):
    """Some discs of one or two sizes and masses, and a light or a heavy wall across x or y."""
    axis = draw(st.sampled_from([0, 1]))
    lengths, boundary = [6.0, 6.0], [draw(st.sampled_from(["wall", "periodic"]))] * 2
    lengths[axis], boundary[axis] = 10.0, "wall"
    place, low, high = draw(st.floats(3.0, 7.0)), [0.0, 0.0], list(lengths)
    low[axis] = high[axis] = place
    regions = ((0.0, 0.0), tuple(high)), (tuple(low), tuple(lengths))
    species = [
        gp.Species(
            draw(st.integers(1, 8)),
            draw(st.floats(0.1, 0.4)),
            mass=draw(st.sampled_from([1.0, 0.01, 50.0])),
            temperature=draw(st.sampled_from([1.0, 9.0])),
            region=region,
        )
        for region in regions
    ]
    wall = gp.Wall(tuple(low), tuple(high), mass=draw(st.floats(1e-3, 1e4)))
    return gp.Scene(gp.Container(lengths, boundary), species, walls=[wall])


@st.composite
def shaken(draw, most=10):
    """Rough inelastic discs that fall, or elastic spheres, between faces that vibrate."""
    dimension = draw(st.sampled_from([2, 3]))
    lengths = draw(st.lists(st.floats(4.5, 9.0), min_size=dimension, max_size=dimension))
    face = st.builds(
        gp.Vibrating, st.floats(1e-4, 0.5), st.floats(0.05, 8.0), st.sampled_from(["sine", "sawtooth"])
    )
    faces = draw(st.dictionaries(st.sampled_from(["x_high", "y_low", "y_high"]), face, min_size=1))
    species = [gp.Species(draw(st.integers(1, most)), draw(st.floats(0.1, 0.4)), temperature=1.0)]
    container = gp.Container(lengths, ("wall",) * dimension)
    if dimension == 3:
        return gp.Scene(container, species, faces=faces)
    law = gp.Restitution(draw(st.sampled_from([0.0, 0.7, 0.95])), draw(st.sampled_from([-1.0, 0.5])))
    gravity = (0.0, draw(st.sampled_from([-1.0, 0.3])))
    return gp.Scene(container, species, faces=faces, gravity=gravity, restitution=law)


@st.composite
def lossy(draw):
    """Discs of two sizes, rough and viscoelastic, between walls."""
    species = [
        gp.Species(draw(st.integers(1, 12)), radius, mass=mass, temperature=1.0)
        for radius, mass in ((0.4, 1.0), (draw(st.floats(0.1, 0.5)), draw(st.floats(0.1, 10.0))))
    ]
    normal, speed = draw(st.floats(0.5, 0.99)), draw(st.sampled_from([1.0, 30.0, 1e3]))
    law = gp.Restitution(normal, draw(st.sampled_from([-0.5, 0.5])), reference_speed=speed)
    return gp.Scene(gp.Container((8.0, 9.0)), species, restitution=law)


@st.composite
def cornered(draw):
    """A disc that sticks in a corner, one that sticks beside it on the floor, and one that comes to them."""
    angle, turned = draw(st.floats(0.05, 1.5)), draw(st.floats(-0.05, 0.05))
    radius, mass = draw(st.floats(0.2, 3.0)), draw(st.floats(0.1, 20.0))
    place = [max(0.5 + 6.0 * component, radius) for component in (math.cos(angle), math.sin(angle))]
    angle = math.atan2(place[1] - 0.5, place[0] - 0.5) + turned
    particles = [
        gp.Particle((0.5, 0.5), (-0.01, -0.01), 0.5),
        gp.Particle(tuple(place), (-math.cos(angle), -math.sin(angle)), radius, mass),
    ]
    if draw(st.booleans()):
        particles.append(gp.Particle((1.5, 0.5), (0.0, -0.01), 0.5))
    faces = dict.fromkeys(("x_low", "x_high", "y_low", "y_high"), gp.Sticky(3.0))
    return gp.Scene(gp.Container((20.0, 20.0)), particles=particles, faces=faces)


@st.composite
def pushed(draw):
    """Some discs or spheres in front of a piston at a low or a high speed."""
    lengths = tuple(draw(st.floats(5.0, 9.0)) for _ in range(draw(st.sampled_from([2, 3]))))
    species = [gp.Species(draw(st.integers(1, 12)), draw(st.floats(0.1, 0.4)), temperature=1.0)]
    container = gp.Container(lengths, ("wall", "periodic", "periodic")[: len(lengths)])
    piston = gp.Piston(speed=draw(st.sampled_from([0.01, 0.3, 3.0])))
    return gp.Scene(container, species, faces={draw(st.sampled_from(["x_low", "x_high"])): piston})


@st.composite
def piled(draw):
    """Discs that fall onto a wall in a box, with contacts that last."""
    law = gp.Restitution(
        draw(st.sampled_from([0.0, 0.5, 0.95])),
        draw(st.sampled_from([-1.0, 0.5])),
        draw(st.sampled_from([1e-3, 0.05, 0.5])),
    )
    species = [gp.Species(draw(st.integers(2, 12)), 0.5, temperature=1.0)]
    rest = {"gravity": (0.0, -1.0), "walls": [gp.Wall((1.0, 4.0), (5.0, 3.0))]}
    return gp.Scene(gp.Container((8.0, 8.0)), species, restitution=law, **rest)


@st.composite
def kicked(draw):
    """A periodic gas of discs that random kicks drive, from rest or from a temperature."""
    law = draw(st.sampled_from([None, gp.Restitution(0.5)]))
    kicks = gp.Thermostat(0.3, draw(st.floats(0.05, 2.0)))
    scene = gas(2, draw(st.integers(2, 12)), 0.3, temperature=draw(st.sampled_from([None, 1e-24, 1.0])))
    return replace(scene, restitution=law, thermostat=kicks)


@st.composite
def dense(draw):
    """Two to twelve particles in a periodic container at the densities of a fluid."""
    dimension = draw(st.sampled_from([2, 3]))
    fraction = draw(st.floats(0.3, {2: 0.65, 3: 0.48}[dimension]))
    return gas(dimension, draw(st.integers(2, 12)), fraction, arrangement="compressed")


def place(face, time):
    """How far a face has moved inwards, by the library's cosine."""
    turns = time / face.period % 1.0
    if face.waveform == "sawtooth":
        return 2.0 * face.amplitude * turns
    return face.amplitude * (1.0 - math.cos(2.0 * math.pi * turns))


def check_inside(scene, state, tolerance):
    """All particles are as far inside the container, and its moving faces, as the scene states."""
    moved = np.zeros((state.dimension, 2))
    for name, face in scene.faces.items():
        axis, high = "xyz".index(name[0]), name.endswith("high")
        if face.kind == "vibrating":
            moved[axis, int(high)] = place(face, state.time)
        elif face.kind == "piston":
            moved[axis, int(high)] = abs(state.piston[0] - (state.lengths[axis] if high else 0.0))
    for position, radius in zip(state.positions, state.radii, strict=True):
        low, high = scene.reach(radius)
        assert (position >= np.array(low) + moved[:, 0] - tolerance).all()
        assert (position <= np.array(high) - moved[:, 1] + tolerance).all()


def check_outside_walls(scene, state, tolerance):
    """No particle overlaps an interior wall by more than a fraction of its radius."""
    for position, radius in zip(state.positions, state.radii, strict=True):
        assert scene.wall_at(tuple(position), radius * (1 - tolerance)) is None


def measured_compressibility(sim, blocks, **duration):
    """Z = 1 + virial / (d N k_B T t) of a periodic gas, and its standard error, from `blocks` runs in turn.

    duration: of each, as of `Simulation.advance`.
    """
    velocities = sim.state.velocities
    twice_energy = ((velocities - velocities.mean(axis=0)) ** 2).sum()
    found = []
    for _ in range(blocks):
        sim.reset_tally()
        sim.advance(**duration)
        found.append(1 + sim.tally.virial_sum / (twice_energy * sim.tally.time))
    return np.mean(found), np.std(found, ddof=1) / math.sqrt(blocks)


def measured_heat(sim, duration, blocks=20):
    """Heat that flows from the low to the high face of the first axis in `duration`, the mean of what the
    two transfer, and its standard error; no other face transfers any, and the gas keeps the rest."""
    found = []
    for _ in range(blocks):
        before = sim.state.energy
        sim.reset_tally()
        sim.advance(duration=duration)
        heat = sim.tally.wall_energy
        assert sim.state.energy - before == pytest.approx(-heat.sum(), rel=1e-9, abs=1e-7)
        assert (heat[2:] == 0.0).all()
        found.append((heat[1] - heat[0]) / 2)
    return np.mean(found), np.std(found, ddof=1) / math.sqrt(blocks)


def centred(values):
    """(T, N, d) about the mean over the N particles of each frame."""
    return values - values.mean(axis=1, keepdims=True)


def closest(scene, state):
    """The smallest gap between two surfaces, by all pairs and the nearest image."""
    gaps = []
    for i in range(state.count):
        r = np.abs(state.positions[i] - state.positions[i + 1 :])
        r = np.where(scene.container.periodic, np.minimum(r, state.lengths - r), r)
        gaps.append(np.sqrt((r**2).sum(axis=1)) - state.radii[i] - state.radii[i + 1 :])
    return np.concatenate(gaps).min(initial=math.inf)
