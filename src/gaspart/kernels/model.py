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
    """Return the data type of a particle between its events, at the time of its clock.

    It is one cache line of 64 bytes.
    """
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
    """Particles: flights, periodic images, predictions.

    Attributes
    ----------
    flights : (N,), see `flight_dtype`
    images : (N, d), number of crossings of the container on periodic axes
    predictions : (N,), see `PREDICTION`
    """

    flights: np.ndarray
    images: np.ndarray
    predictions: np.ndarray


class Space(NamedTuple):
    """Container of the particles.

    Attributes
    ----------
    lengths, periodic : (d,)
    margin : 1 if walls stop surfaces, 0 if they stop centres
    """

    lengths: tuple
    periodic: tuple
    margin: float


class Support(NamedTuple):
    """Planes on which particles rest or slide, at most three per particle.

    Attributes
    ----------
    number : (N,), number of planes of each particle
    normal : (N, 3, 3), unit vectors from the planes towards the particle
    plane : (N, 3), coordinates of its centre along these vectors
    row : (N, 3), row of an interior wall, or NONE for a face
    pull : (N, 3), acceleration that the planes do not support
    height : highest bounce on an interior wall that counts as rest
    """

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
    """Gravity and its effect on particles at rest.

    Attributes
    ----------
    acceleration : (d,)
    fixed : (N,), True for particles that gravity does not move, now or ever
    shortest_bounce : longest bounce on a floor that counts as rest
    support : None without interior walls
    """

    acceleration: tuple
    fixed: np.ndarray
    shortest_bounce: float
    support: Support | None


class ContactDuration(NamedTuple):
    """Contact duration: a contact less than `length` after an earlier contact is elastic.

    Attributes
    ----------
    length : contact duration
    latest : (N,), time of the latest contact of each particle
    met : (N,), time of the latest contact of each particle with another particle
    island : (N,), island or jam of each particle, see `event.jams`, or NONE
    contacts : (N,), number of contacts since the last search for particles at rest
    inverse_mass : (N,), inverse masses of the particles while no jam fixes them
    moving : speed that frees a particle from a jam (`event.jams`)
    elastic : (1,), number of lasting contacts
    kept : (1, 2), energy that these contacts did not dissipate, see `physics.running_sum.add`
    """

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
    """Collision law of inelastic or rough particles.

    Attributes
    ----------
    normal, tangential : coefficients of restitution
    viscous : None, or for viscoelastic particles the damping divided by the fifth root of speed, radius and
        squared inverse mass (`physics.contact.normal_restitution`)
    inverse_mass : (N,), inverse masses; 0 if fixed or in a jam
    inverse_inertia : (N,), 0 if fixed
    spins : (N, 3)
    vibrations : (N,), energies of vibrational modes, -1 for particles without a mode; None if no particle has
        a mode
    duration : None if every contact dissipates
    """

    normal: float
    tangential: float
    viscous: float | None
    inverse_mass: np.ndarray
    inverse_inertia: np.ndarray
    spins: np.ndarray
    vibrations: np.ndarray | None
    duration: ContactDuration | None


class Motion(NamedTuple):
    """Vibrating faces.

    Attributes
    ----------
    stroke : (2d,), distance by which each face of the container moves inwards; 0 if it does not move
    period : (2d,)
    sine : (2d,), True for a sine, False for a sawtooth
    begun : (2d,), time within the period at which the clocks are at zero
    slowest : (2d,), minimum separation speed of particles
    epoch : (1,), length of the epoch of the clocks
    """

    stroke: np.ndarray
    period: np.ndarray
    sine: np.ndarray
    begun: np.ndarray
    slowest: np.ndarray
    epoch: np.ndarray


class Piston(NamedTuple):
    """Face that is a piston.

    Attributes
    ----------
    face : number of the face
    mass : in the kernel's unit
    push : inward acceleration due to its load
    motion : (3,), inward position and velocity, and the time of its clock
    slowest : (1,), minimum separation speed of particles
    """

    face: int
    mass: float
    push: float
    motion: np.ndarray
    slowest: np.ndarray


class Sliding(NamedTuple):
    """Thermal faces that slide, or along which a force drives the gas.

    Attributes
    ----------
    velocity : (2d, d), velocities of the faces
    shear : (2d^2, 2), momentum along each axis that particles give to each face, see
        `physics.running_sum.add`
    """

    velocity: np.ndarray
    shear: np.ndarray


class Ramp(NamedTuple):
    """Thermal faces whose temperature varies along them.

    Attributes
    ----------
    axis : (2d,), axis along which the temperature of each face varies, or NONE
    high : (2d,), temperature at the upper end
    """

    axis: np.ndarray
    high: np.ndarray


class Open(NamedTuple):
    """Faces through which particles leave and enter.

    Attributes
    ----------
    present : (N,), 1 for particles inside; 0 for the others, which have no position (NaN), are at rest and in
        no box
    vacant : (blocks,), number of absent particles in each block of numbers, see `obstacles.face`
    entries : (2d,), number of particles that have entered through each face
    """

    present: np.ndarray
    vacant: np.ndarray
    entries: np.ndarray


class Reservoirs(NamedTuple):
    """Gases behind open faces, whose particles try to enter.

    Attributes
    ----------
    key : (2,), key of the random numbers
    rate : rate of attempts, summed over all faces
    up_to : (2d,), cumulative fraction of the attempts up to each face
    width : (2d,), (k_B T / m)^(1/2) of each gas
    number : (1,), number of the next attempt
    time : (1,), time of this attempt on the clocks of the epoch
    position : (3,), workspace for the position of an attempt
    opened : `Open` of the faces
    """

    key: np.ndarray
    rate: float
    up_to: np.ndarray
    width: np.ndarray
    number: np.ndarray
    time: np.ndarray
    position: np.ndarray
    opened: Open


class Faces(NamedTuple):
    """Special faces.

    Attributes
    ----------
    kind : (2d,)
    level : (2d,), temperature (at the lower end if it varies), or momentum below which particles stick
    depth, width : (2d,), depth and width of the well, 0 without a well
    well_side : (N, d), -1 or 1 for a particle in the well of the low or high face of an axis, or stuck to
        this face
    held : (N, d), energy stored there as vibration
    draws : (N,), number of random draws of each particle
    key : (2,), key of these random numbers
    sticky : (2d,), sticky faces, or None if no face is sticky
    motion : None if no face vibrates
    piston : None if no face is a piston
    sliding : None if no face slides
    accommodation : (2d,), fraction of hits that draw new velocities, or None if all hits do
    ramp : None if no temperature varies along a face
    open : None if no face is open
    """

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
    """Interior walls at a temperature.

    Attributes
    ----------
    level : (walls,), temperature, 0 for hard walls
    draws : (N,), number of random draws of each particle
    key : (2,), key of these random numbers
    """

    level: np.ndarray
    draws: np.ndarray
    key: np.ndarray


class MovingWall(NamedTuple):
    """Interior wall that moves.

    Attributes
    ----------
    axis : axis along which the wall moves
    mass : in the kernel's unit
    side : (N,), 1.0 for particles above the wall, -1.0 for particles below
    motion : (3,), position along the axis and velocity, and the time of its clock
    """

    axis: int
    mass: float
    side: np.ndarray
    motion: np.ndarray


class InteriorWalls(NamedTuple):
    """Interior walls, and lists of walls near each box.

    Attributes
    ----------
    rows : (M, 5) or (M, 11), see `obstacles.distance`
    wall : (M,), see `obstacles.distance`
    first, listed : listed[first[b] : first[b + 1]] are the rows near box b, for particles of a radius up to
        `largest_radius`. After the last box, `listed` contains all rows, for larger particles
    largest_radius : see `listed`
    warm : None if no wall has a temperature
    moving : None if no wall moves; a moving wall is not in the rows
    """

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
    """Periodic faces whose images slide, see `physics.lees_edwards`.

    Attributes
    ----------
    rate : shear rate
    velocity : velocity of the images above
    origin : (1,), their displacement at clock time zero, modulo the length of the container
    turns : (1,), number of whole lengths of the container in the displacement
    kept : (3,), workspace for the position of a particle before a contact, and its velocity
    """

    rate: float
    velocity: float
    origin: np.ndarray
    turns: np.ndarray
    kept: np.ndarray


class Model(NamedTuple):
    """Model of the simulated scene; missing parts have the value None.

    Attributes
    ----------
    space : `Space`, for either engine
    masses : (N,), or None if all masses are 1 or the law contains the masses
    """

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
    """Counts and sums of events.

    Attributes
    ----------
    counts : (of `COUNTS`,)
    sums : (of `SUMS`, 2), see `physics.running_sum.add`
    worst : (1,), largest value of |r^2/sigma^2 - 1| at a contact
    wall_hits : (faces + walls,)
    wall_impulse, wall_energy : (faces + walls, 2), momentum given to each face and interior wall, see
        `physics.running_sum.add`
    stress : `event.stress.Stress`, or None
    impulses : `event.impulses.Impulses`, or None
    pair_impulses : `event.impulses.PairImpulses`, or None
    per_area : `physics.per_area.PerArea`, or None unless particles of different sizes reach different areas
        of faces
    """

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
