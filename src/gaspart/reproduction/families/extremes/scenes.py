"""The scenes of the table of extremes, one function each, mostly in two dimensions."""

from __future__ import annotations

import math
from typing import Any

from gaspart.scene.container import Container
from gaspart.scene.geometry import CLOSE_PACKING
from gaspart.scene.restitution import Restitution
from gaspart.scene.scene import Scene
from gaspart.scene.species import Particle, Species

GRAZE = 2.0**-50
"""Nearly 1e-15, and a number by which a distance of 1 can be changed exactly."""


def between_walls(lengths: tuple[float, ...], *particles: Particle, **rest: Any) -> Scene:
    """Return the scene of a few particles in a container with walls."""
    return Scene(Container(lengths), particles=particles, **rest)


def galperin(ratio: float) -> Scene:
    """Return the scene of a wall, a light disc at rest, and a heavy disc.

    The light disc is 1 from the wall, the heavy one 1 from the light one; it approaches with speed 1.
    """
    light, heavy = Particle((1.5, 2.0), (0.0, 0.0), 0.5), Particle((3.5, 2.0), (-1.0, 0.0), 0.5, mass=ratio)
    return between_walls((20.0, 4.0), light, heavy)


def gas(*species: Species, side: float = 8.0, dimension: int = 2) -> Scene:
    """Return a gas without walls."""
    return Scene(Container((side,) * dimension, "periodic"), species)


def fast_gas(speed: float) -> Scene:
    """Return a gas of twelve discs of one speed."""
    return gas(Species(12, 0.5, speed=speed))


def slow_beside_fast() -> Scene:
    """Return a gas in which half of the discs are 1e24 times faster than the others."""
    return gas(Species(6, 0.5, speed=1e-12), Species(6, 0.5, speed=1e12))


def unequal_masses() -> Scene:
    """Return equal numbers of discs of mass 1 and of mass 1e16, at one temperature."""
    return gas(Species(10, 0.5, mass=1.0, temperature=1.0), Species(10, 0.5, mass=1e16, temperature=1.0))


def unequal_sizes(dimension: int = 2) -> Scene:
    """Return a gas of a particle of radius 1 among 200 of 1e-4."""
    species = Species(200, 1e-4, temperature=1.0), Species(1, 1.0, temperature=1.0)
    return gas(*species, side=4.0, dimension=dimension)


def grazing(nearer: float) -> Scene:
    """Return two discs of diameter 1 whose centres' tracks are 1 - `nearer` apart."""
    return between_walls(
        (4.0, 4.0),
        Particle((1.0, 1.0), (1.0, 0.0), 0.5),
        Particle((1.0 + 1e-6, 2.0 - nearer), (0.0, 0.0), 0.5),
    )


def cradle() -> Scene:
    """Return Newton's cradle: a disc hits four that touch."""
    still = (Particle((4.0 + n, 2.0), (0.0, 0.0), 0.5) for n in range(4))
    return between_walls((12.0, 4.0), Particle((2.0, 2.0), (1.0, 0.0), 0.5), *still)


def four_at_once() -> Scene:
    """Return four discs that approach one point from four sides, and touch at one instant."""
    sides = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))
    particles = (Particle((4.0 - 2.0 * x, 4.0 - 2.0 * y), (x, y), 0.5) for x, y in sides)
    return between_walls((8.0, 8.0), *particles)


def corner(dimension: int) -> Scene:
    """Return a particle that moves into a corner, where all faces are hit at once."""
    particle = Particle((2.0,) * dimension, (-1.0,) * dimension, 0.5)
    return between_walls((4.0,) * dimension, particle)


def one_fast() -> Scene:
    """Return a disc that crosses its container a hundred times in a time of 1."""
    return between_walls((10.0, 10.0), Particle((5.0, 5.0), (1234.5, 777.0), 0.5))


def crystal(packing_fraction: float, dimension: int) -> Scene:
    """Return discs on a triangular lattice, or spheres on a face-centred cubic one.

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
    """Return four discs that touch each other through periodic faces too, without any gap."""
    moves = {(0.5, 0.5): (1.0, 0.5), (1.5, 0.5): (-1.0, 0.5), (0.5, 1.5): (1.0, 0.5), (1.5, 1.5): (1.0, 0.5)}
    particles = tuple(Particle(position, move, 0.5) for position, move in moves.items())
    return Scene(Container((2.0, 2.0), "periodic"), particles=particles)


def tight_disc() -> Scene:
    """Return a disc exactly as wide as its container."""
    return between_walls((1.0, 4.0), Particle((0.5, 2.0), (1.0, 0.5), 0.5))


def pair_in(side: float) -> Scene:
    """Return two discs of diameter 1 in a container of any size."""
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
    """Return a disc that hits another, after which they separate at zero speed."""
    particles = Particle((2.0, 2.0), (1.0, 0.0), 0.5), Particle((5.0, 2.0), (0.0, 0.0), 0.5)
    return between_walls((10.0, 4.0), *particles, restitution=Restitution(0.0))


def dissipative_gas() -> Scene:
    """Return sixty discs that retain 1e-12 of their speed of approach at each contact."""
    return Scene(Container((16.0, 16.0)), [Species(60, 0.5, temperature=1.0)], restitution=Restitution(1e-12))


def bouncing(gravity: float) -> Scene:
    """Return a disc that falls from a height of 2 on to a floor, and bounces."""
    return between_walls((4.0, 4.0), Particle((1.0, 2.5), (0.0, 0.0), 0.5), gravity=(0.0, -gravity))


def falling_gas(gravity: float) -> Scene:
    """Return eight discs that fall."""
    return Scene(Container((8.0, 8.0)), [Species(8, 0.5, temperature=1.0)], gravity=(0.0, -gravity))


def few(count: int) -> Scene:
    """Return a gas of this number of discs, and of a species without any."""
    return gas(Species(count, 0.5, speed=1.0), Species(0, 0.7, temperature=1.0), side=3.0)
