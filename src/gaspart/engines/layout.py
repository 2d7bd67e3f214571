"""What the kernels of the event-driven engine pass to one another."""

from typing import NamedTuple

import numpy as np

COLLISIONS, CROSSINGS, STALE, PAIR_TESTS, BOX_VISITS = range(5)
VIRIAL, LOSS = range(2)
NOTHING = -1
INNER = 6  # face codes: 2 axis + side for the container's faces, INNER more for those between boxes
EDGES = 12  # EDGES more for the edges of the wells at the container's faces
WALLS = 18  # and from here on the pieces of interior walls
HARD, THERMAL, THERMAL_NORMAL, STICKY = range(4)  # kinds of faces
PLACES = 4  # bodies that a box holds in places of its own
STOP, EVENTS, FULL, COLLAPSE = range(4)  # why a run ended: the time, the number of events, the record, a loop


class Space(NamedTuple):
    """lengths (d,), periodic (d,); margin: 1 if walls stop surfaces, 0 if they stop centres."""

    lengths: tuple
    periodic: tuple
    margin: float


class Support(NamedTuple):
    """What bodies rest on or slide along, up to 3 planes each: number (N,) of these; normal (N, 3, 3), the
    unit vectors towards the body; plane (N, 3), where its centre is along them; piece (N, 3), the piece of an
    interior wall, or NOTHING for a face; pull (N, 3), the acceleration that remains. height: the highest
    bounce on an interior wall that is taken for rest."""

    number: np.ndarray
    normal: np.ndarray
    plane: np.ndarray
    piece: np.ndarray
    pull: np.ndarray
    height: float


def no_support(count: int, height: float) -> Support:
    """No body rests on any wall."""
    normal, plane, pull = np.zeros((count, 3, 3)), np.zeros((count, 3)), np.zeros((count, 3))
    return Support(np.zeros(count, np.int64), normal, plane, np.zeros((count, 3), np.int64), pull, height)


class Gravity(NamedTuple):
    """pull (d,), the acceleration; fixed (N,), which bodies it does not move; blink, the longest bounce on a
    floor that is taken for rest; support, None without interior walls."""

    pull: tuple
    fixed: np.ndarray
    blink: float
    support: Support | None


class Law(NamedTuple):
    """normal, tangential: restitution; inverse_mass, inverse_inertia (N,), 0 if fixed; spins (N, 3);
    vibrations (N,), energies of modes, -1 where there is none, or None if no body has one."""

    normal: float
    tangential: float
    inverse_mass: np.ndarray
    inverse_inertia: np.ndarray
    spins: np.ndarray
    vibrations: np.ndarray | None


class Walls(NamedTuple):
    """pieces (M, 5) or (M, 11) and wall (M,), see `segments` and `plates`; listed[first[b] : first[b + 1]]
    are those near box b, for bodies of a radius up to `above`; those for bigger bodies, all, follow the
    last box."""

    pieces: np.ndarray
    wall: np.ndarray
    first: np.ndarray
    listed: np.ndarray
    above: float


class Big(NamedTuple):
    """The bodies (B,) that are too big for the boxes of the partition: those with a radius above `above`."""

    bodies: np.ndarray
    above: float


class Surfaces(NamedTuple):
    """Of the container's faces (2d,): kind; level, the temperature, or the momentum that sticks; depth and
    width of the well, 0 if there is none. Of the bodies: place (N, d), -1 or 1 in the well of an axis' low or
    high face, or stuck to it; held (N, d), the energy kept there as vibration; draws (N,), how often random
    numbers were taken for it, under `key` (2,)."""

    kind: np.ndarray
    level: np.ndarray
    depth: np.ndarray
    width: np.ndarray
    place: np.ndarray
    held: np.ndarray
    draws: np.ndarray
    key: np.ndarray


class Watch(NamedTuple):
    """For each body, how many contacts (N,) it has had since (N,) within `blink`, at most `most`."""

    since: np.ndarray
    contacts: np.ndarray
    blink: float
    most: int


class Partition(NamedTuple):
    """The grid of boxes (see `boxes.Boxes`); how many bodies each holds, filled (boxes,), the first of them,
    places (boxes, PLACES), and of the others the first, head (boxes,), and the next after each body,
    following (N,), see `lists`; near (M,), room for the candidates of a search; still (N,), which bodies
    gravity may not pull, see `flight.note_still`."""

    per_side: np.ndarray
    widths: np.ndarray
    strides: np.ndarray
    neighbour: np.ndarray
    shift: np.ndarray
    filled: np.ndarray
    places: np.ndarray
    head: np.ndarray
    following: np.ndarray
    near: np.ndarray
    still: np.ndarray


class Counters(NamedTuple):
    """counts (5,), sums (2, 2), see the top; worst (1,), the largest |r^2/sigma^2 - 1| at a contact; of the
    faces and interior walls (F,) wall_hits, wall_impulse (F, 2), wall_energy (F, 2). Those with a last axis
    of 2 are sums with their rounding errors (`running_sum.add`)."""

    counts: np.ndarray
    sums: np.ndarray
    worst: np.ndarray
    wall_hits: np.ndarray
    wall_impulse: np.ndarray
    wall_energy: np.ndarray


def zero_counters(faces: int) -> Counters:
    """Counters of a container with this number of faces and interior walls."""
    hits = np.zeros(faces, dtype=np.int64)
    impulse, energy = np.zeros((faces, 2)), np.zeros((faces, 2))
    return Counters(np.zeros(5, dtype=np.int64), np.zeros((2, 2)), np.zeros(1), hits, impulse, energy)


class Record(NamedTuple):
    """Room for events: filled (1,), time (M,), bodies (M, 2), positions and velocities (M, 2, d), spins
    (M, 2, 3), which only a `Law` fills in."""

    filled: np.ndarray
    time: np.ndarray
    bodies: np.ndarray
    positions: np.ndarray
    velocities: np.ndarray
    spins: np.ndarray
