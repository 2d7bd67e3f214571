"""Rows of the table of extreme scenes: scenes, durations, exact numbers of contacts."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from gaspart.scene.container import Container
from gaspart.scene.limits import CLOSE_PACKING
from gaspart.scene.restitution import Restitution
from gaspart.scene.scene import Scene
from gaspart.scene.species import Particle, Species

# Scenes of the table: a function for each, mostly in two dimensions.


GRAZE = 2.0**-50
"""Distance of about 1e-15, by which a distance of 1 can be changed exactly."""


def between_walls(lengths: tuple[float, ...], *particles: Particle, **rest: Any) -> Scene:
    """Return a scene of a few particles in a container with walls."""
    return Scene(Container(lengths), particles=particles, **rest)


def galperin(ratio: float) -> Scene:
    """Return the scene of a wall, a light disc at rest, and a heavy disc.

    The light disc is at distance 1 from the wall. The heavy disc is at distance 1 from the light disc, and
    approaches with speed 1.
    """
    light, heavy = Particle((1.5, 2.0), (0.0, 0.0), 0.5), Particle((3.5, 2.0), (-1.0, 0.0), 0.5, mass=ratio)
    return between_walls((20.0, 4.0), light, heavy)


def gas(*species: Species, side: float = 8.0, dimension: int = 2) -> Scene:
    """Return a gas without walls."""
    return Scene(Container((side,) * dimension, "periodic"), species)


def fast_gas(speed: float) -> Scene:
    """Return a gas of twelve discs of equal speed."""
    return gas(Species(12, 0.5, speed=speed))


def slow_beside_fast() -> Scene:
    """Return a gas in which half of the discs are 1e24 times faster than the others."""
    return gas(Species(6, 0.5, speed=1e-12), Species(6, 0.5, speed=1e12))


def unequal_masses() -> Scene:
    """Return equal numbers of discs of mass 1 and mass 1e16, at one temperature."""
    return gas(Species(10, 0.5, mass=1.0, temperature=1.0), Species(10, 0.5, mass=1e16, temperature=1.0))


def unequal_sizes(dimension: int = 2) -> Scene:
    """Return a gas of one particle of radius 1 among 200 particles of radius 1e-4."""
    species = Species(200, 1e-4, temperature=1.0), Species(1, 1.0, temperature=1.0)
    return gas(*species, side=4.0, dimension=dimension)


def grazing(nearer: float) -> Scene:
    """Return two discs of diameter 1 that move on parallel tracks 1 - `nearer` apart."""
    return between_walls(
        (4.0, 4.0),
        Particle((1.0, 1.0), (1.0, 0.0), 0.5),
        Particle((1.0 + 1e-6, 2.0 - nearer), (0.0, 0.0), 0.5),
    )


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
    """Return a particle that moves into a corner, where it hits all faces simultaneously."""
    particle = Particle((2.0,) * dimension, (-1.0,) * dimension, 0.5)
    return between_walls((4.0,) * dimension, particle)


def one_fast() -> Scene:
    """Return a disc that crosses its container a hundred times per unit of time."""
    return between_walls((10.0, 10.0), Particle((5.0, 5.0), (1234.5, 777.0), 0.5))


def crystal(packing_fraction: float, dimension: int) -> Scene:
    """Return discs on a triangular lattice, or spheres on a face-centred cubic lattice.

    The lattice is expanded from close packing.
    """
    shape = (10.0, 10.0 * math.sqrt(0.75)) if dimension == 2 else (3.0 * math.sqrt(2.0),) * 3
    stretch = (CLOSE_PACKING[dimension] / packing_fraction) ** (1.0 / dimension)
    kind = Species(100 if dimension == 2 else 108, 0.5, temperature=1.0, arrangement="lattice")
    return Scene(Container(tuple(stretch * length for length in shape), "periodic"), [kind])


def jam_of_four() -> Scene:
    """Return four discs that touch each other and all walls."""
    moves = {(0.5, 0.5): (1.0, 0.5), (1.5, 0.5): (-1.0, 0.5), (0.5, 1.5): (1.0, 0.5), (1.5, 1.5): (1.0, 0.5)}
    return between_walls(
        (2.0, 2.0), *(Particle(position, move, 0.5 - 1e-6) for position, move in moves.items())
    )


def touching() -> Scene:
    """Return four discs that touch each other without gaps, also through periodic faces."""
    moves = {(0.5, 0.5): (1.0, 0.5), (1.5, 0.5): (-1.0, 0.5), (0.5, 1.5): (1.0, 0.5), (1.5, 1.5): (1.0, 0.5)}
    particles = tuple(Particle(position, move, 0.5) for position, move in moves.items())
    return Scene(Container((2.0, 2.0), "periodic"), particles=particles)


def tight_disc() -> Scene:
    """Return a disc exactly as wide as its container."""
    return between_walls((1.0, 4.0), Particle((0.5, 2.0), (1.0, 0.5), 0.5))


def pair_in(side: float) -> Scene:
    """Return two discs of diameter 1 in a container with sides of length `side`."""
    offset = side / 8.0
    return between_walls(
        (side, side),
        Particle((offset,) * 2, (1.0, 0.0), 0.5),
        Particle((offset + 10.0, offset + 0.3), (0.0, 0.0), 0.5),
    )


LINE_STARTS, LINE_VELOCITIES = (123456.7, 401234.5, 812345.6), (0.7, -0.9, 0.45)


def line() -> Scene:
    """Return three discs on a line, far apart between two walls."""
    positions = ((x + 5.0 + 10.0 * n, 10.0) for n, x in enumerate(LINE_STARTS))
    moves = ((v, 0.0) for v in LINE_VELOCITIES)
    return between_walls(
        (1e6 + 30.0, 20.0), *(Particle(x, v, 5.0) for x, v in zip(positions, moves, strict=True))
    )


def sticking() -> Scene:
    """Return two discs that separate at zero speed after a collision."""
    particles = Particle((2.0, 2.0), (1.0, 0.0), 0.5), Particle((5.0, 2.0), (0.0, 0.0), 0.5)
    return between_walls((10.0, 4.0), *particles, restitution=Restitution(0.0))


def dissipative_gas() -> Scene:
    """Return a gas of sixty discs with restitution 1e-12 at each contact."""
    return Scene(Container((16.0, 16.0)), [Species(60, 0.5, temperature=1.0)], restitution=Restitution(1e-12))


def bouncing(gravity: float) -> Scene:
    """Return a disc that falls from a height of 2 onto a floor, and bounces."""
    return between_walls((4.0, 4.0), Particle((1.0, 2.5), (0.0, 0.0), 0.5), gravity=(0.0, -gravity))


def falling_gas(gravity: float) -> Scene:
    """Return eight discs that fall."""
    return Scene(Container((8.0, 8.0)), [Species(8, 0.5, temperature=1.0)], gravity=(0.0, -gravity))


def few(count: int) -> Scene:
    """Return a gas of `count` discs, with an additional empty species."""
    return gas(Species(count, 0.5, speed=1.0), Species(0, 0.7, temperature=1.0), side=3.0)


# Exact numbers of contacts, which need no simulation.


def galperin_contacts(ratio: float, heavy: float, light: float, time: float) -> int:
    """Compute the contacts, up to `time`, of a wall, a light particle and a heavy particle.

    The light particle is at rest. The heavy particle has `ratio` times its mass, and arrives with speed 1
    (Galperin, Regul. Chaotic Dyn. 8, 375 (2003)). For infinite time, the numbers are the digits of pi.
    `heavy` and `light` are the distances that each particle can move until it touches the wall, or the
    particle pressed against the wall. In the plane of distances times sqrt(mass), the motion is a straight
    line across a fan of mirrors. The angle between successive mirrors is arctan sqrt(1/ratio).
    """
    narrow = math.sqrt(1.0 / ratio)
    return int(math.atan2(narrow * light, heavy - time) / math.atan(narrow))


def hits_in_box(
    starts: Sequence[float], velocities: Sequence[float], rooms: Sequence[float], time: float
) -> int:
    """Count the hits of one particle at the walls of a box.

    The arguments are, for each axis, the initial position, the velocity and the free length.
    """
    total = 0
    for start, velocity, room in zip(starts, velocities, rooms, strict=True):
        ahead = start if velocity > 0.0 else room - start
        total += int((ahead + abs(velocity) * time) / room)
    return total


def contacts_on_line(starts: Sequence[float], velocities: Sequence[float], room: float, time: float) -> int:
    """Count the contacts of identical particles on a line between two walls.

    Contacts with walls and with each other are counted. `starts` are positions minus the diameters on their
    left. `room` is the length minus all diameters. Identical particles exchange velocities, so that they can
    be replaced by points that pass through each other. A point between walls corresponds to a point on a
    circle of twice the free length. Two points meet when the sum or the difference of their phases is a
    multiple of the circle.
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


NOWHERE = "-"
"""Text with which no engine's name begins."""
FLOAT32 = "step, float32"


@dataclass(frozen=True)
class Row:
    """Line of the table.

    name, group : name and group of the row.
    scene : function that makes the scene; it may reject its arguments.
    duration, time_step : in the scene's time.
    contacts : exact number of contacts if known; otherwise the search of all pairs is the reference.
    chaotic : True for a gas, in which engines agree in the number of contacts only on average.
    refused : beginning of the names of engines that must reject the scene; "" for all, NOWHERE for none.

    Contacts are between particles, and with walls. In a gas, runs of engines with different rounding diverge.
    """

    name: str
    group: str
    scene: Callable[[], Scene]
    duration: float
    time_step: float
    contacts: int | None = None
    chaotic: bool = False
    refused: str = NOWHERE


def _galperin(ratio: float, duration: float, time_step: float) -> Row:
    """Return the row of two balls of a mass ratio.

    The light ball becomes sqrt(ratio) times faster than the heavy ball. Above a ratio of 1e4, it is too fast
    for time steps.
    """
    contacts = galperin_contacts(ratio, 2.0, 1.0, duration)
    return Row(
        f"mass ratio 1e{math.log10(ratio):.0f}: {contacts} contacts", "masses",
        partial(galperin, ratio), duration, time_step, contacts,
        refused="step" if ratio > 1e4 else NOWHERE,
    )  # fmt: skip


def _speed(speed: float, text: str) -> Row:
    """Return a row with twenty diameters of flight, in steps of a thousandth of a diameter."""
    moderate = 1e-100 < speed < 1e100
    scale = 1.0 / speed if moderate else 1.0
    return Row(
        f"speeds {text}", "speeds", partial(fast_gas, speed), 20.0 * scale, 1e-3 * scale,
        chaotic=True, refused=FLOAT32 if moderate else "",
    )  # fmt: skip


def _bounce(gravity: float) -> Row:
    """Return a row with 100.25 periods of a ball that falls from a height of 2."""
    period = 2.0 * math.sqrt(4.0 / gravity)
    return Row(
        f"gravity {gravity:g}: 100 bounces", "gravity",
        partial(bouncing, gravity), 100.25 * period, period / 200, 100,
    )  # fmt: skip


_ON_LINE = contacts_on_line(LINE_STARTS, LINE_VELOCITIES, 1e6, 1e9)
_IN_BOX = hits_in_box((4.5, 4.5), (1234.5, 777.0), (9.0, 9.0), 10.0)

ROWS = (
    _galperin(1e2, 14.0, 1e-3),
    _galperin(1e4, 14.0, 1e-5),
    _galperin(1e12, 14.0, 1e-5),
    _galperin(1e16, 2.0 - 1e-4, 1e-5),
    Row("masses 1 and 1e16, a gas", "masses", unequal_masses, 20.0, 1e-3, chaotic=True),
    Row("discs of 1 and 1e-4", "sizes", unequal_sizes, 2.0, 2e-5, chaotic=True),
    Row("spheres of 1 and 1e-4", "sizes", partial(unequal_sizes, 3), 4.0, 2e-5, chaotic=True),
    Row("discs in 1e9 diameters", "sizes", partial(pair_in, 1e9), 20.0, 0.01, 1, refused=FLOAT32),
    Row("discs in 1e15 diameters", "sizes", partial(pair_in, 1e15), 20.0, 0.01, 1, refused=""),
    _speed(1e-300, "1e-300"),
    _speed(1e-50, "1e-50"),
    _speed(1e50, "1e50"),
    _speed(1e300, "1e300"),
    Row(
        "speeds 1e-12 and 1e12",
        "speeds",
        slow_beside_fast,
        2e-11,
        1e-15,
        chaotic=True,
        refused=FLOAT32,
    ),
    Row("grazing by 1e-15", "contacts", partial(grazing, GRAZE), 2e-6, 1e-9, 1, refused=FLOAT32),
    Row(
        "missing by 1e-15",
        "contacts",
        partial(grazing, -2.0 * GRAZE),
        2e-6,
        1e-9,
        0,
        refused=FLOAT32,
    ),
    Row("Newton's cradle", "contacts", cradle, 2.5, 0.01, 4),
    Row("four at one instant", "contacts", four_at_once, 2.0, 0.01),
    Row("corner of two walls", "corners", partial(corner, 2), 3.0, 0.01, 2),
    Row("corner of three walls", "corners", partial(corner, 3), 3.0, 0.01, 3),
    Row("100 walls in a step", "steps", one_fast, 10.0, 1.0, _IN_BOX),
    Row(
        "10 diameters in a step",
        "steps",
        partial(fast_gas, 1.0),
        20.0,
        10.0,
        chaotic=True,
        refused="step",
    ),
    Row("discs at 0.90", "density", partial(crystal, 0.90, 2), 0.15, 2e-4, chaotic=True),
    Row("spheres at 0.72", "density", partial(crystal, 0.72, 3), 0.15, 2e-4, chaotic=True),
    Row("no gap at all", "density", touching, 2.0, 1e-3, refused=""),
    Row("a gap of 1e-6", "density", jam_of_four, 0.2, 1e-3, refused="step"),
    Row("no room between walls", "density", tight_disc, 2.0, 1e-3, refused=""),
    Row("clock to 1e9", "clocks", line, 1e9, 1e3, _ON_LINE, refused="step"),
    Row("restitution 0", "restitution", sticking, 5.0, 0.01, 1),
    Row("restitution 1e-12, a gas", "restitution", dissipative_gas, 1e3, 0.01, chaotic=True, refused=""),
    _bounce(1e-12),
    _bounce(1e12),
    Row("gravity 1e-12, a gas", "gravity", partial(falling_gas, 1e-12), 10.0, 1e-3, chaotic=True),
    Row(
        "gravity 1e12, a gas",
        "gravity",
        partial(falling_gas, 1e12),
        2e-5,
        2e-9,
        chaotic=True,
        refused=FLOAT32,
    ),
    Row("no particles", "few", partial(few, 0), 10.0, 0.01, 0),
    Row("one particle", "few", partial(few, 1), 10.0, 0.01, 0),
    Row("two particles", "few", partial(few, 2), 10.0, 0.01, chaotic=True),
)
