"""Extreme scenes: functions that make them, exact numbers of contacts, and their table."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from gaspart.scene.container import Container
from gaspart.scene.restitution import Restitution
from gaspart.scene.scene import Scene
from gaspart.scene.sizes import CLOSE_PACKING
from gaspart.scene.species import Particle, Species

GRAZE = 2.0**-50  # about 1e-15, by which a distance of 1 can be changed exactly
NOWHERE, FLOAT32 = "-", "step, float32"  # beginnings of the names of no engine, and of one


def between_walls(lengths: tuple[float, ...], *particles: Particle, **rest: Any) -> Scene:
    return Scene(Container(lengths), particles=particles, **rest)


def gas(*species: Species, side: float = 8.0, dimension: int = 2) -> Scene:
    return Scene(Container((side,) * dimension, "periodic"), species)


def galperin(ratio: float) -> Scene:
    """Return a wall, a light disc at rest at distance 1, and a heavy one that approaches from distance 1."""
    light, heavy = Particle((1.5, 2.0), (0.0, 0.0), 0.5), Particle((3.5, 2.0), (-1.0, 0.0), 0.5, mass=ratio)
    return between_walls((20.0, 4.0), light, heavy)


def fast_gas(speed: float) -> Scene:
    return gas(Species(12, 0.5, speed=speed))


def slow_beside_fast() -> Scene:
    return gas(Species(6, 0.5, speed=1e-12), Species(6, 0.5, speed=1e12))


def unequal_masses() -> Scene:
    return gas(Species(10, 0.5, mass=1.0, temperature=1.0), Species(10, 0.5, mass=1e16, temperature=1.0))


def unequal_sizes(dimension: int = 2) -> Scene:
    species = Species(200, 1e-4, temperature=1.0), Species(1, 1.0, temperature=1.0)
    return gas(*species, side=4.0, dimension=dimension)


def grazing(nearer: float) -> Scene:
    """Return two discs of diameter 1 on parallel tracks, 1 - `nearer` apart."""
    still = Particle((1.0 + 1e-6, 2.0 - nearer), (0.0, 0.0), 0.5)
    return between_walls((4.0, 4.0), Particle((1.0, 1.0), (1.0, 0.0), 0.5), still)


def cradle() -> Scene:
    """Return Newton's cradle: a disc hits four discs that touch."""
    still = (Particle((4.0 + n, 2.0), (0.0, 0.0), 0.5) for n in range(4))
    return between_walls((12.0, 4.0), Particle((2.0, 2.0), (1.0, 0.0), 0.5), *still)


def four_at_once() -> Scene:
    """Return four discs that approach a point from four sides, and touch simultaneously."""
    sides = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))
    particles = (Particle((4.0 - 2.0 * x, 4.0 - 2.0 * y), (x, y), 0.5) for x, y in sides)
    return between_walls((8.0, 8.0), *particles)


def corner(dimension: int) -> Scene:
    """Return a particle that hits all faces of a corner simultaneously."""
    particle = Particle((2.0,) * dimension, (-1.0,) * dimension, 0.5)
    return between_walls((4.0,) * dimension, particle)


def one_fast() -> Scene:
    return between_walls((10.0, 10.0), Particle((5.0, 5.0), (1234.5, 777.0), 0.5))


def crystal(packing_fraction: float, dimension: int) -> Scene:
    """Return a triangular or face-centred cubic lattice, expanded from close packing."""
    shape = (10.0, 10.0 * math.sqrt(0.75)) if dimension == 2 else (3.0 * math.sqrt(2.0),) * 3
    stretch = (CLOSE_PACKING[dimension] / packing_fraction) ** (1.0 / dimension)
    kind = Species(100 if dimension == 2 else 108, 0.5, temperature=1.0, arrangement="lattice")
    return Scene(Container(tuple(stretch * length for length in shape), "periodic"), [kind])


def four_in_contact(boundary: str, gap: float) -> Scene:
    """Return four discs that touch each other and all walls, or each other through periodic faces."""
    moves = {(0.5, 0.5): (1.0, 0.5), (1.5, 0.5): (-1.0, 0.5), (0.5, 1.5): (1.0, 0.5), (1.5, 1.5): (1.0, 0.5)}
    particles = tuple(Particle(position, move, 0.5 - gap) for position, move in moves.items())
    return Scene(Container((2.0, 2.0), boundary), particles=particles)


def tight_disc() -> Scene:
    return between_walls((1.0, 4.0), Particle((0.5, 2.0), (1.0, 0.5), 0.5))


def pair_in(side: float) -> Scene:
    offset = side / 8.0
    still = Particle((offset + 10.0, offset + 0.3), (0.0, 0.0), 0.5)
    return between_walls((side, side), Particle((offset,) * 2, (1.0, 0.0), 0.5), still)


LINE_STARTS, LINE_VELOCITIES = (123456.7, 401234.5, 812345.6), (0.7, -0.9, 0.45)


def line() -> Scene:
    """Return three discs on a line, far apart between two walls."""
    positions = ((x + 5.0 + 10.0 * n, 10.0) for n, x in enumerate(LINE_STARTS))
    moves = ((v, 0.0) for v in LINE_VELOCITIES)
    discs = (Particle(x, v, 5.0) for x, v in zip(positions, moves, strict=True))
    return between_walls((1e6 + 30.0, 20.0), *discs)


def sticking() -> Scene:
    """Return two discs that separate at zero speed after a collision."""
    particles = Particle((2.0, 2.0), (1.0, 0.0), 0.5), Particle((5.0, 2.0), (0.0, 0.0), 0.5)
    return between_walls((10.0, 4.0), *particles, restitution=Restitution(0.0))


def dissipative_gas() -> Scene:
    return Scene(Container((16.0, 16.0)), [Species(60, 0.5, temperature=1.0)], restitution=Restitution(1e-12))


def bouncing(gravity: float) -> Scene:
    """Return a disc that falls from a height of 2 onto a floor, and bounces."""
    return between_walls((4.0, 4.0), Particle((1.0, 2.5), (0.0, 0.0), 0.5), gravity=(0.0, -gravity))


def falling_gas(gravity: float) -> Scene:
    return Scene(Container((8.0, 8.0)), [Species(8, 0.5, temperature=1.0)], gravity=(0.0, -gravity))


def few(count: int) -> Scene:
    """Return a gas of `count` discs, with an additional empty species."""
    return gas(Species(count, 0.5, speed=1.0), Species(0, 0.7, temperature=1.0), side=3.0)


# Exact numbers of contacts, which need no simulation.


def galperin_contacts(ratio: float, heavy: float, light: float, time: float) -> int:
    """Compute the contacts, up to `time`, of a wall, a light particle at rest and one `ratio` times as heavy.
    The heavy one arrives with speed 1; for infinite time the numbers are the digits of pi (Galperin, Regul.
    Chaotic Dyn. 8, 375 (2003)). `heavy` and `light` are the distances that each can move until it touches the
    wall, or the particle pressed against it. In the plane of distances times sqrt(mass) the motion is a
    straight line across a fan of mirrors, with the angle arctan sqrt(1/ratio) between them.
    """
    narrow = math.sqrt(1.0 / ratio)
    return int(math.atan2(narrow * light, heavy - time) / math.atan(narrow))


def hits_in_box(
    starts: Sequence[float], velocities: Sequence[float], rooms: Sequence[float], time: float
) -> int:
    """Count the hits of one particle at the walls of a box, from start, velocity and free length by axis."""
    total = 0
    for start, velocity, room in zip(starts, velocities, rooms, strict=True):
        ahead = start if velocity > 0.0 else room - start
        total += int((ahead + abs(velocity) * time) / room)
    return total


def contacts_on_line(starts: Sequence[float], velocities: Sequence[float], room: float, time: float) -> int:
    """Count the contacts of identical particles on a line with each other and with two walls. `starts` are
    positions less the diameters on their left, `room` the length less all diameters. Identical particles
    exchange velocities: they are points that pass through each other, and a point between walls is on a
    circle of twice the room. Two meet when sum or difference of their phases is a multiple of it.
    """
    phases = [(x if v > 0.0 else 2.0 * room - x, abs(v)) for x, v in zip(starts, velocities, strict=True)]
    count = 0
    for n, (phase, fast) in enumerate(phases):
        count += math.floor((phase + fast * time) / room) - math.floor(phase / room)
        for other, slow in phases[:n]:
            for sign in (1.0, -1.0):
                first, rate = phase + sign * other, fast + sign * slow
                turns = math.floor((first + rate * time) / (2.0 * room)) - math.floor(first / (2.0 * room))
                count += abs(turns)
    return count


@dataclass(frozen=True)
class Row:
    """Line of the table; durations and steps are in the scene's time. `contacts` is the exact number, with
    particles and walls, or None if the search of all pairs is the reference. In a gas (`chaotic`) engines of
    different rounding agree on average only. `refused` is the beginning of the names of engines that must
    reject the scene; "" for all.
    """

    name: str
    group: str
    scene: Callable[[], Scene]  # may reject its arguments
    duration: float
    time_step: float
    contacts: int | None = None
    chaotic: bool = False
    refused: str = NOWHERE


def _galperin(ratio: float, duration: float, time_step: float) -> Row:
    """Return a row of two balls; the light one becomes sqrt(ratio) times as fast, too fast for steps."""
    contacts = galperin_contacts(ratio, 2.0, 1.0, duration)
    name = f"mass ratio 1e{math.log10(ratio):.0f}: {contacts} contacts"
    refused = "step" if ratio > 1e4 else NOWHERE
    return Row(name, "masses", partial(galperin, ratio), duration, time_step, contacts, refused=refused)


def _speed(speed: float, text: str) -> Row:
    """Return a row with twenty diameters of flight, in steps of a thousandth of a diameter."""
    moderate = 1e-100 < speed < 1e100
    scale, refused = (1.0 / speed, FLOAT32) if moderate else (1.0, "")
    name, scene = f"speeds {text}", partial(fast_gas, speed)
    return Row(name, "speeds", scene, 20.0 * scale, 1e-3 * scale, chaotic=True, refused=refused)


def _bounce(gravity: float) -> Row:
    """Return a row with 100.25 periods of a ball that falls from a height of 2."""
    period, name = 2.0 * math.sqrt(4.0 / gravity), f"gravity {gravity:g}: 100 bounces"
    return Row(name, "gravity", partial(bouncing, gravity), 100.25 * period, period / 200, 100)


_gas = partial(Row, chaotic=True)


_ON_LINE = contacts_on_line(LINE_STARTS, LINE_VELOCITIES, 1e6, 1e9)
_IN_BOX = hits_in_box((4.5, 4.5), (1234.5, 777.0), (9.0, 9.0), 10.0)

ROWS = (
    _galperin(1e2, 14.0, 1e-3),
    _galperin(1e4, 14.0, 1e-5),
    _galperin(1e12, 14.0, 1e-5),
    _galperin(1e16, 2.0 - 1e-4, 1e-5),
    _gas("masses 1 and 1e16, a gas", "masses", unequal_masses, 20.0, 1e-3),
    _gas("discs of 1 and 1e-4", "sizes", unequal_sizes, 2.0, 2e-5),
    _gas("spheres of 1 and 1e-4", "sizes", partial(unequal_sizes, 3), 4.0, 2e-5),
    Row("discs in 1e9 diameters", "sizes", partial(pair_in, 1e9), 20.0, 0.01, 1, refused=FLOAT32),
    Row("discs in 1e15 diameters", "sizes", partial(pair_in, 1e15), 20.0, 0.01, 1, refused=""),
    _speed(1e-300, "1e-300"),
    _speed(1e-50, "1e-50"),
    _speed(1e50, "1e50"),
    _speed(1e300, "1e300"),
    _gas("speeds 1e-12 and 1e12", "speeds", slow_beside_fast, 2e-11, 1e-15, refused=FLOAT32),
    Row("grazing by 1e-15", "contacts", partial(grazing, GRAZE), 2e-6, 1e-9, 1, refused=FLOAT32),
    Row("missing by 1e-15", "contacts", partial(grazing, -2.0 * GRAZE), 2e-6, 1e-9, 0, refused=FLOAT32),
    Row("Newton's cradle", "contacts", cradle, 2.5, 0.01, 4),
    Row("four at one instant", "contacts", four_at_once, 2.0, 0.01),
    Row("corner of two walls", "corners", partial(corner, 2), 3.0, 0.01, 2),
    Row("corner of three walls", "corners", partial(corner, 3), 3.0, 0.01, 3),
    Row("100 walls in a step", "steps", one_fast, 10.0, 1.0, _IN_BOX),
    _gas("10 diameters in a step", "steps", partial(fast_gas, 1.0), 20.0, 10.0, refused="step"),
    _gas("discs at 0.90", "density", partial(crystal, 0.90, 2), 0.15, 2e-4),
    _gas("spheres at 0.72", "density", partial(crystal, 0.72, 3), 0.15, 2e-4),
    Row("no gap at all", "density", partial(four_in_contact, "periodic", 0.0), 2.0, 1e-3, refused=""),
    Row("a gap of 1e-6", "density", partial(four_in_contact, "wall", 1e-6), 0.2, 1e-3, refused="step"),
    Row("no room between walls", "density", tight_disc, 2.0, 1e-3, refused=""),
    Row("clock to 1e9", "clocks", line, 1e9, 1e3, _ON_LINE, refused="step"),
    Row("restitution 0", "restitution", sticking, 5.0, 0.01, 1),
    _gas("restitution 1e-12, a gas", "restitution", dissipative_gas, 1e3, 0.01, refused=""),
    _bounce(1e-12),
    _bounce(1e12),
    _gas("gravity 1e-12, a gas", "gravity", partial(falling_gas, 1e-12), 10.0, 1e-3),
    _gas("gravity 1e12, a gas", "gravity", partial(falling_gas, 1e12), 2e-5, 2e-9, refused=FLOAT32),
    Row("no particles", "few", partial(few, 0), 10.0, 0.01, 0),
    Row("one particle", "few", partial(few, 1), 10.0, 0.01, 0),
    _gas("two particles", "few", partial(few, 2), 10.0, 0.01),
)
