"""Data structures of the kernels: particles, model of the scene, and counters.

Arguments have a fixed order: the particles and their indices, the queue, the boxes, the model, the tally, and
finally arguments that may be None. None represents an entry that the model does not have. Such an entry is
passed as a separate argument to the function that uses it, because numba removes a branch on `None` only for
arguments.
"""

from typing import Any, NamedTuple

import numpy as np

COUNTS = ("collisions", "crossings", "outdated", "pair_tests", "box_visits", "fixed_collisions")
SUMS = ("virial_sum", "dissipated_energy")
"""Indices of Tally.counts and Tally.sums, under the names of the fields of `state.tally.Tally`, which has no
outdated predictions.

Sums are in the kernels' unit of mass, and proportional to it.
"""
COLLISIONS, CROSSINGS, OUTDATED, PAIR_TESTS, BOX_VISITS, FIXED_COLLISIONS = range(len(COUNTS))
VIRIAL, LOSS = range(len(SUMS))
NONE = -1  # no particle, no face
BOX_FACES = 6  # face codes: 2 axis + side for the container's faces, plus BOX_FACES between boxes,
WELL_EDGES = 12  # WELL_EDGES for the edges of wells at the faces of the container;
WALLS = 18  # codes from here on are rows of interior walls
NUMBER_BITS = 26  # number of bits for the particle number in a candidate of a search, below its image
IMAGE_BITS = 2  # number of bits for the image along each axis, above the particle number, signed
HARD, THERMAL, THERMAL_NORMAL, STICKY, VIBRATING, PISTON, OPEN = range(7)  # codes of `obstacles.face.RULES`
PISTON_PLACE, PISTON_VELOCITY, PISTON_CLOCK = range(3)  # indices of Piston.motion and MovingWall.motion


def flight_dtype(dimension: int) -> np.dtype:
    """Return the data type of a particle at the time of its clock: one cache line of 64 bytes."""
    vector = (float, (dimension,))
    at = 8 * dimension
    return np.dtype(
        {
            "names": ["position", "velocity", "clock", "radius"],
            "formats": [vector, vector, float, float],
            "offsets": [0, at, 2 * at, 2 * at + 8],
            "itemsize": 64,
        }
    )


PREDICTION = np.dtype(
    [
        ("contact_time", "f8"),  # predicted time of the next contact
        ("face_time", "f8"),  # predicted time at the next face, edge of a well or interior wall
        ("predicted", "i8"),  # event count when the contact was predicted
        ("changed", "i8"),  # event count at the last change of this particle's flight
        ("partner", "i4"),  # partner of the contact
        ("face", "i4"),  # code of the face
        ("box", "i4", 3),  # coordinates of the particle's box
        ("before", "i4"),  # neighbours in its bucket of the queue: before and after
        ("after", "i4"),
        ("bucket", "i4"),  # bucket of the queue, or -1
    ],
    align=True,
)
"""Predicted events of one particle, one cache line. An event reads and writes it in addition to the flight.
"""


class Particles(NamedTuple):
    """Particles: flights, periodic images, predictions."""

    flights: np.ndarray
    images: np.ndarray
    predictions: np.ndarray


class Space(NamedTuple):
    """Container of the particles."""

    lengths: tuple
    periodic: tuple
    margin: float


class Support(NamedTuple):
    """Planes on which particles rest or slide, at most three per particle."""

    number: np.ndarray
    normal: np.ndarray
    plane: np.ndarray
    row: np.ndarray
    pull: np.ndarray
    height: float


def no_support(count: int, height: float) -> Support:
    """Return an empty support: no particle rests on a wall."""
    normal, plane, pull = np.zeros((count, 3, 3)), np.zeros((count, 3)), np.zeros((count, 3))
    return Support(np.zeros(count, np.int64), normal, plane, np.zeros((count, 3), np.int64), pull, height)


class Gravity(NamedTuple):
    """Gravity and its effect on particles at rest."""

    acceleration: tuple
    fixed: np.ndarray
    shortest_bounce: float
    support: Support | None


class ContactDuration(NamedTuple):
    """Contact duration: a contact less than `length` after an earlier contact is elastic."""

    length: float
    latest: np.ndarray
    met: np.ndarray
    island: np.ndarray
    contacts: np.ndarray
    inverse_mass: np.ndarray
    moving: float
    elastic: np.ndarray
    kept: np.ndarray


class ContactLaw(NamedTuple):
    """Collision law of inelastic or rough particles."""

    normal: float
    tangential: float
    viscous: float | None
    inverse_mass: np.ndarray
    inverse_inertia: np.ndarray
    spins: np.ndarray
    vibrations: np.ndarray | None
    duration: ContactDuration | None


class Motion(NamedTuple):
    """Vibrating faces."""

    stroke: np.ndarray
    period: np.ndarray
    sine: np.ndarray
    begun: np.ndarray
    slowest: np.ndarray
    epoch: np.ndarray


class Piston(NamedTuple):
    """Face that is a piston."""

    face: int
    mass: float
    push: float
    motion: np.ndarray
    slowest: np.ndarray


class Sliding(NamedTuple):
    """Thermal faces that slide, or along which a force drives the gas."""

    velocity: np.ndarray
    shear: np.ndarray


class Ramp(NamedTuple):
    """Thermal faces whose temperature varies along them."""

    axis: np.ndarray
    high: np.ndarray


class Open(NamedTuple):
    """Faces through which particles leave and enter."""

    present: np.ndarray
    vacant: np.ndarray
    entries: np.ndarray


class Reservoirs(NamedTuple):
    """Gases behind open faces, whose particles try to enter."""

    key: np.ndarray
    rate: float
    up_to: np.ndarray
    width: np.ndarray
    number: np.ndarray
    time: np.ndarray
    position: np.ndarray
    opened: Open


class Faces(NamedTuple):
    """Special faces."""

    kind: np.ndarray
    level: np.ndarray
    depth: np.ndarray
    width: np.ndarray
    well_side: np.ndarray
    held: np.ndarray
    draws: np.ndarray
    key: np.ndarray
    sticky: np.ndarray | None
    motion: Motion | None
    piston: Piston | None
    sliding: Sliding | None
    accommodation: np.ndarray | None
    ramp: Ramp | None
    open: Open | None


class WarmWalls(NamedTuple):
    """Interior walls at a temperature."""

    level: np.ndarray
    draws: np.ndarray
    key: np.ndarray


class MovingWall(NamedTuple):
    """Interior wall that moves."""

    axis: int
    mass: float
    side: np.ndarray
    motion: np.ndarray


class InteriorWalls(NamedTuple):
    """Interior walls, and lists of walls near each box."""

    rows: np.ndarray
    wall: np.ndarray
    first: np.ndarray
    listed: np.ndarray
    largest_radius: float
    warm: WarmWalls | None
    moving: MovingWall | None


class Oversized(NamedTuple):
    """Particles (B,) with a radius above `largest_radius`, which are too large for the boxes."""

    particles: np.ndarray
    largest_radius: float


class Shear(NamedTuple):
    """Periodic faces whose images slide, see `physics.lees_edwards`."""

    rate: float
    velocity: float
    origin: np.ndarray
    turns: np.ndarray
    kept: np.ndarray


class Model(NamedTuple):
    """Model of the simulated scene; missing parts have the value None."""

    space: Any
    masses: np.ndarray | None
    gravity: Gravity | None
    law: ContactLaw | None
    faces: Faces | None
    walls: InteriorWalls | None
    oversized: Oversized | None
    shear: Shear | None
    reservoirs: Reservoirs | None


class Tally(NamedTuple):
    """Counts and sums of events."""

    counts: np.ndarray
    sums: np.ndarray
    worst: np.ndarray
    wall_hits: np.ndarray
    wall_impulse: np.ndarray
    wall_energy: np.ndarray
    stress: Any = None
    impulses: Any = None
    pair_impulses: Any = None
    per_area: Any = None


def empty_tally(walls: int) -> Tally:
    """Return counters at zero for a number of faces and interior walls."""
    return Tally(
        counts=np.zeros(len(COUNTS), dtype=np.int64),
        sums=np.zeros((len(SUMS), 2)),
        worst=np.zeros(1),
        wall_hits=np.zeros(walls, dtype=np.int64),
        wall_impulse=np.zeros((walls, 2)),
        wall_energy=np.zeros((walls, 2)),
    )
