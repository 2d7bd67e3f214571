"""What kernels pass to one another: the particles, the model of the scene, the tally.

Arguments come in one order: the particles and which of them, the queue, the boxes, the model, the tally, and
last whatever may be absent. An absent entry of the model is None. It is passed on to the function that uses
it as an argument of its own, because numba removes a branch on `None` only for arguments.
"""

from typing import Any, NamedTuple

import numpy as np

COUNTS = ("collisions", "crossings", "outdated", "pair_tests", "box_visits", "fixed_collisions")
SUMS = ("virial_sum", "dissipated_energy")
"""What Tally.counts and Tally.sums hold, by the fields of `state.tally.Tally`, which has no outdated
predictions. Sums are in the kernels' unit of mass, and proportional to it."""
COLLISIONS, CROSSINGS, OUTDATED, PAIR_TESTS, BOX_VISITS, FIXED_COLLISIONS = range(len(COUNTS))
VIRIAL, LOSS = range(len(SUMS))
NONE = -1  # no particle, no face
BOX_FACES = 6  # face codes: 2 axis + side for the container's faces, BOX_FACES more for those between boxes,
WELL_EDGES = 12  # WELL_EDGES more for the edges of the wells at the container's faces,
WALLS = 18  # and from here on the rows of interior walls
NUMBER_BITS = 26  # of a particle's number where a search lists it beside its image
IMAGE_BITS = 2  # above them, for each axis: the image, signed
HARD, THERMAL, THERMAL_NORMAL, STICKY, VIBRATING, PISTON, OPEN = range(7)  # of `obstacles.face.RULES`
PISTON_PLACE, PISTON_VELOCITY, PISTON_CLOCK = range(3)  # of Piston.motion and MovingWall.motion


def flight_dtype(dimension: int) -> np.dtype:
    """One particle between its events, one cache line of 64 bytes: all is true at the time of its clock."""
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
        ("contact_time", "f8"),  # time of the next contact predicted, with
        ("face_time", "f8"),  # time of the next face, edge of a well or interior wall, and
        ("predicted", "i8"),  # the event count at which the contact was predicted,
        ("changed", "i8"),  # and that at which this particle's flight last changed
        ("partner", "i4"),  # the particle met,
        ("face", "i4"),  # the code of the face
        ("box", "i4", 3),  # coordinates of the particle's box
        ("before", "i4"),  # its neighbours in its bucket of the queue,
        ("after", "i4"),
        ("bucket", "i4"),  # which is this one, or -1
    ],
    align=True,
)
"""What is predicted of one particle, one cache line: what an event reads and writes beside the flight."""


class Particles(NamedTuple):
    """flights (N,), see `flight_dtype`; images (N, d), how often each has crossed the container on periodic
    axes; predictions (N,), see `PREDICTION`."""

    flights: np.ndarray
    images: np.ndarray
    predictions: np.ndarray


class Space(NamedTuple):
    """lengths (d,), periodic (d,); margin: 1 if walls stop surfaces, 0 if they stop centres."""

    lengths: tuple
    periodic: tuple
    margin: float


class Support(NamedTuple):
    """What particles rest on or slide along, up to 3 planes each: number (N,) of these; normal (N, 3, 3), the
    unit vectors towards the particle; plane (N, 3), where its centre is along them; row (N, 3), that of an
    interior wall, or NONE for a face; pull (N, 3), the acceleration that remains. height: the highest bounce
    on an interior wall that is taken for rest."""

    number: np.ndarray
    normal: np.ndarray
    plane: np.ndarray
    row: np.ndarray
    pull: np.ndarray
    height: float


def no_support(count: int, height: float) -> Support:
    """No particle rests on any wall."""
    normal, plane, pull = np.zeros((count, 3, 3)), np.zeros((count, 3)), np.zeros((count, 3))
    return Support(np.zeros(count, np.int64), normal, plane, np.zeros((count, 3), np.int64), pull, height)


class Gravity(NamedTuple):
    """acceleration (d,); fixed (N,), which particles it does not move, now or ever; shortest_bounce, the
    longest bounce on a floor that is taken for rest; support, None without interior walls."""

    acceleration: tuple
    fixed: np.ndarray
    shortest_bounce: float
    support: Support | None


class ContactDuration(NamedTuple):
    """Contacts less than `length` after an earlier one are elastic. Of the particles: latest (N,), the time
    of the latest contact; met (N,), that with another particle; island (N,), see `event.jams`, or NONE;
    contacts (N,), their number since the last look at what rests; inverse_mass (N,), those that the law has
    of them when no jam holds them. moving: the speed that frees a particle from a jam (`event.jams`). elastic
    (1,): the number of contacts that last; kept (1, 2): the energy that they have not dissipated, see
    `running_sum.add`."""

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
    """normal, tangential: restitution; viscous: None, or of viscoelastic particles the damping over the fifth
    root of speed, radius and squared inverse mass (`viscoelastic.normal_restitution`); inverse_mass (N,), 0
    if fixed or in a jam, inverse_inertia (N,), 0 if fixed; spins (N, 3); vibrations (N,), energies of modes,
    -1 where there is none, or None if no particle has one; duration, None if every contact dissipates."""

    normal: float
    tangential: float
    viscous: float | None
    inverse_mass: np.ndarray
    inverse_inertia: np.ndarray
    spins: np.ndarray
    vibrations: np.ndarray | None
    duration: ContactDuration | None


class Motion(NamedTuple):
    """Vibrating faces. Of the container's faces (2d,): stroke, how far each moves inwards, 0 if it does not;
    period; sine, or else a sawtooth; begun, the time of its period at which the clocks are at zero; slowest,
    the speed at which particles part from it at least. epoch (1,): the length of the clocks' epoch."""

    stroke: np.ndarray
    period: np.ndarray
    sine: np.ndarray
    begun: np.ndarray
    slowest: np.ndarray
    epoch: np.ndarray


class Piston(NamedTuple):
    """The face that is a piston: its number; mass, in the kernel's unit; push, its acceleration inwards by
    its load; motion (3,), how far inwards it is and how fast it moves inwards at the time of its clock;
    slowest (1,), the speed at which particles part from it at least."""

    face: int
    mass: float
    push: float
    motion: np.ndarray
    slowest: np.ndarray


class Sliding(NamedTuple):
    """Thermal faces that move along themselves, or along which a force drives the gas. velocity (2d, d), of
    the container's faces; shear (2d^2, 2): the momentum along each axis that particles have given to each
    face, see `running_sum.add`."""

    velocity: np.ndarray
    shear: np.ndarray


class Ramp(NamedTuple):
    """Thermal faces whose temperature varies along them. Of the container's faces (2d,): axis, that along
    which it does, NONE if it does not; high, the temperature at its high end."""

    axis: np.ndarray
    high: np.ndarray


class Open(NamedTuple):
    """Faces through which particles leave and enter. present (N,), 1 of particles that are inside, and 0 of
    the others, which are at no place (NaN), at rest and in no box; vacant (blocks,), the number of the others
    in each block of numbers, see `obstacles.face`; entries (2d,), how many have entered through each of
    the container's faces."""

    present: np.ndarray
    vacant: np.ndarray
    entries: np.ndarray


class Reservoirs(NamedTuple):
    """Gases outside of open faces, whose particles try to enter.

    key (2,), of the random numbers; rate: attempts per time at all faces; up_to (2d,): the fraction of the
    attempts at a face and at those before it; width (2d,): (k_B T / m)^(1/2) of each gas. The next attempt:
    number (1,); time (1,), on the clocks of the epoch; place (3,), room for where it happens. opened: the
    `Open` of the faces.
    """

    key: np.ndarray
    rate: float
    up_to: np.ndarray
    width: np.ndarray
    number: np.ndarray
    time: np.ndarray
    place: np.ndarray
    opened: Open


class Faces(NamedTuple):
    """Faces with a kind. Of the container's faces (2d,): kind; level, the temperature, of one that varies
    that at the low end, or the momentum that sticks; depth and width of the well, 0 if there is none. Of the
    particles: place (N, d), -1 or 1 in the well of an axis' low or high face, or stuck to it; held (N, d),
    the energy kept there as vibration; draws (N,), how often random numbers were taken for it, under `key`
    (2,). sticky (2d,), which faces are, motion, piston, sliding, accommodation (2d,), the fraction of hits
    after which velocities are drawn, ramp, open: None if no face is sticky, none vibrates, none is a piston,
    none slides, all draw after every hit, none varies along itself, and none is open."""

    kind: np.ndarray
    level: np.ndarray
    depth: np.ndarray
    width: np.ndarray
    place: np.ndarray
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
    """Interior walls at a temperature: level (walls,), 0 of hard ones; draws (N,), how often random numbers
    were taken for a particle, under `key` (2,)."""

    level: np.ndarray
    draws: np.ndarray
    key: np.ndarray


class MovingWall(NamedTuple):
    """The interior wall that moves: axis, along which it does; mass, in the kernel's unit; side (N,), 1.0 of
    particles above it and -1.0 of those below; motion (3,), where it is along its axis and how fast it moves
    at the time of its clock."""

    axis: int
    mass: float
    side: np.ndarray
    motion: np.ndarray


class InteriorWalls(NamedTuple):
    """rows (M, 5) or (M, 11) and wall (M,), see `obstacles.interior_wall`; listed[first[b] :
    first[b + 1]] are those near box b, for particles of a radius up to `largest_radius`; those for larger
    ones, all, follow the last box. warm: None if no wall is at a temperature; moving: None if none moves,
    which has no row."""

    rows: np.ndarray
    wall: np.ndarray
    first: np.ndarray
    listed: np.ndarray
    largest_radius: float
    warm: WarmWalls | None
    moving: MovingWall | None


class Oversized(NamedTuple):
    """The particles (B,) that are too large for the boxes: those with a radius above `largest_radius`."""

    particles: np.ndarray
    largest_radius: float


class Shear(NamedTuple):
    """Periodic faces whose images slide, see `physics.lees_edwards`: rate, of the shear; velocity, of the
    images above. origin (1,): their displacement where the clocks are at zero, but for so many lengths of the
    container, turns (1,). kept (3,), room for where a particle was before a contact, and its velocity."""

    rate: float
    velocity: float
    origin: np.ndarray
    turns: np.ndarray
    kept: np.ndarray


class Model(NamedTuple):
    """What is simulated. space: a `Space`, of either engine; masses (N,), or None if all are 1 or the law
    knows them; whatever else may be absent is None."""

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
    """counts (of `COUNTS`,); sums (of `SUMS`, 2) and by face and interior wall wall_impulse, wall_energy
    (faces + walls, 2), see `running_sum.add`; wall_hits (faces + walls,); worst (1,): the largest
    |r^2/sigma^2 - 1| at a contact; stress: an `event.stress.Stress`, impulses: an `event.impulses.Impulses`,
    pair_impulses: an `event.impulses.PairImpulses`, None if they are not wanted; per_area: a
    `physics.per_area.PerArea`, None unless particles of several sizes reach other areas of faces."""

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
    """A tally at zero, for so many faces and interior walls."""
    return Tally(
        counts=np.zeros(len(COUNTS), dtype=np.int64),
        sums=np.zeros((len(SUMS), 2)),
        worst=np.zeros(1),
        wall_hits=np.zeros(walls, dtype=np.int64),
        wall_impulse=np.zeros((walls, 2)),
        wall_energy=np.zeros((walls, 2)),
    )
