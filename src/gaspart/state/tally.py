"""Declarations of all counters and sums of engines, and of the optional tallies.

Planning a workflow imports this module. To keep planning fast, functions import numpy only when they run.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

from gaspart.errors import SceneError
from gaspart.keys.values import count_of, number, one_of
from gaspart.scene.features import FEATURES
from gaspart.state.optional_tallies import OptionalTally

if TYPE_CHECKING:
    import numpy as np

    from gaspart.scene.scene import Scene

ENERGY, IMPULSE = "mass length^2/time^2", "mass length/time"
ACTION, HEAT = "mass length^2/time", "mass length^3/time^2"
SPEED, PRESSED, HEATED = "length/time", "mass length^(2-d)/time", "mass length^(3-d)/time^2"
"""Units of sums: of the velocity that belongs to a sum, and of momentum and heat per area."""


@dataclass
class Tally:
    """Counters and sums of a simulation since the last reset.

    In the shapes, F is the number of faces: the 2 d faces of the container (x low, x high, y low, ...), then
    the interior walls.

    Literature: E. Helfand, Phys. Rev. 119, 1 (1960).

    Parameters
    ----------
    time : float, [time]
        Simulated time.
    collisions : int
        Collisions of pairs.
    wall_hits : ndarray of int, shape (F,)
        Number of hits of particles on each face. If faces are open: number of particles that have left
        through each face.
    wall_impulse : ndarray, shape (F,), [mass length/time]
        Momentum given to each face. If faces are open: normal momentum of the particles that leave and enter.
    wall_energy : ndarray, shape (F,), [energy]
        Heat given to each face by particles whose velocities the face draws. If there is a `wall_shear`, this
        value includes the work of the face. If faces are open: energy of the particles that have left minus
        the energy of the particles that have entered.
    virial_sum : float, [mass length^2/time]
        Sum of abs(dr.dp) over collisions.
    pair_tests : int
        Pairs examined.
    box_visits : int
        Boxes searched.
    fixed_collisions : int, default 0
        Collisions with fixed particles; `collisions` includes them.
    crossings : int, default 0
        Crossings of box boundaries.
    worst_contact : float, default 0.0, [1]
        Largest abs(r^2/sigma^2 - 1) at a contact.
    dissipated_energy : float, default 0.0, [energy]
        Energy lost in inelastic contacts.
    elastic_contacts : int, default 0
        Contacts of pairs and with walls that were elastic because an earlier contact of the same particle had
        not ended (`Restitution.contact_duration`).
    retained_energy : float, default 0.0, [energy]
        Energy that these elastic contacts would have dissipated.
    thermostat_energy : float, default 0.0, [energy]
        Energy added by kicks.
    steps : int, default 0
        Steps of the engine, if it has time steps.
    overlaps_left : int, default 0
        Pairs that still overlap and approach when a step ends: an error of the time-stepped engine.
    deepest_overlap : float, default 0.0, [1]
        Deepest overlap that occurred, as a fraction of the contact distance: an error of the time-stepped
        engine.
    multiple_contacts : int, default 0
        Particles that met more than one other particle in a step: an error of the time-stepped engine.
    rebuilds : int, default 0
        Rebuilds of the neighbour list of the time-stepped engine.
    wall_shear : ndarray, shape (F, d), optional, [mass length/time]
        Momentum along each axis given to each thermal face that draws all velocity components. None unless
        such a face slides, or a force drives the gas along such a face.
    entries : ndarray of int, shape (F,), optional
        Particles that have entered through each face. None unless faces are open.
    momentum_per_area : ndarray, shape (F, d), optional, [mass length^(2-d)/time]
        Momentum along each axis given to each face, positive along the outward normal. The momentum of each
        particle is divided by the area of the face that is accessible to centres of particles of this size
        (`scene.accessible`). The area is computed for the initial container. The value is 0 for interior
        walls and for faces that an engine does not tally. None unless particles of different sizes can reach
        different areas of faces.
    heat_per_area : ndarray, shape (F,), optional, [mass length^(3-d)/time^2]
        Energy as in `wall_energy`, divided by the area in the same way as `momentum_per_area`, and 0 for the
        same faces. None if there is no `momentum_per_area`.
    stress_sum : ndarray, shape (d, d), optional, [mass length^2/time]
        Time integral of the stress tensor times the volume: the integral of m v v over all particles, plus r
        dp for each collision. Here r is the vector from the second particle to the first, and dp is the
        momentum that the first particle gains. None unless requested.
    collisional_stress_sum : ndarray, shape (d, d), optional, [mass length^2/time]
        Collisional part of `stress_sum`.
    heat_sum : ndarray, shape (d,), optional, [mass length^3/time^2]
        Time integral of the heat flux times the volume: the integral of E v over all particles, plus r
        dE for each collision, where dE is the energy that the first particle gains.
    flux_velocity : ndarray, shape (d,), optional, [length/time]
        Velocity of the centre of mass, from which all velocities in `stress_sum` and `heat_sum` are measured.
        In a sheared gas these velocities are relative to the flow, and `flux_velocity` is the value at time
        0.
    momentum_flux_sum : ndarray, shape (species, bins), optional, [mass length/time]
        Momentum along an axis that particles of each species (single particles last) carry through planes
        perpendicular to this axis. Each value is the mean over the planes in a bin. Under gravity, the
        momentum that gravity has given to the particles below the plane is subtracted (`analysis.impulses`).
        None unless requested.
    contact_impulse_sum : ndarray, shape (shells,), optional, [mass length^2/time]
        Contribution of colliding pairs to the mean of k_B T g(r) over each shell, times the time
        (`analysis.pairs`). None unless requested.
    other_impulse_sum : ndarray, shape (shells,), optional, [mass length^2/time]
        Contribution of all other pairs to the same mean.

    See Also
    --------
    Simulation : Simulation that has a tally.

    Examples
    --------
    >>> import gaspart as gp
    >>> import numpy as np
    >>> hits, impulse = np.array([0, 2, 1, 0]), np.array([0.0, 4.0, 2.0, 0.0])
    >>> tally = gp.Tally(10.0, 3, hits, impulse, np.zeros(4), virial_sum=5.0, pair_tests=9, box_visits=0)
    >>> tally.wall_impulse / tally.time
    array([0. , 0.4, 0.2, 0. ])
    """

    time: float
    collisions: int
    wall_hits: np.ndarray = field(metadata={"along": ("face",)})
    wall_impulse: np.ndarray = field(metadata={"along": ("face",), "units": IMPULSE})
    wall_energy: np.ndarray = field(metadata={"along": ("face",), "units": ENERGY})
    virial_sum: float = field(metadata={"units": ACTION})
    pair_tests: int
    box_visits: int
    fixed_collisions: int = field(default=0, metadata={"only": "fixed_collisions"})
    crossings: int = 0
    worst_contact: float = 0.0
    dissipated_energy: float = field(default=0.0, metadata={"units": ENERGY})
    elastic_contacts: int = 0
    retained_energy: float = field(default=0.0, metadata={"units": ENERGY})
    thermostat_energy: float = field(default=0.0, metadata={"units": ENERGY})
    steps: int = 0
    overlaps_left: int = 0
    deepest_overlap: float = 0.0
    multiple_contacts: int = 0
    rebuilds: int = 0
    wall_shear: np.ndarray | None = field(
        default=None, metadata={"along": ("face", "axis"), "units": IMPULSE, "only": "wall_shear"}
    )
    entries: np.ndarray | None = field(default=None, metadata={"along": ("face",), "only": "entries"})
    momentum_per_area: np.ndarray | None = field(
        default=None, metadata={"along": ("face", "axis"), "units": PRESSED, "only": "per_area"}
    )
    heat_per_area: np.ndarray | None = field(
        default=None, metadata={"along": ("face",), "units": HEATED, "only": "per_area"}
    )
    stress_sum: np.ndarray | None = field(
        default=None, metadata={"along": ("axis", "direction"), "units": ACTION, "only": "stress"}
    )
    collisional_stress_sum: np.ndarray | None = field(
        default=None, metadata={"along": ("axis", "direction"), "units": ACTION, "only": "stress"}
    )
    heat_sum: np.ndarray | None = field(
        default=None, metadata={"along": ("axis",), "units": HEAT, "only": "stress"}
    )
    flux_velocity: np.ndarray | None = field(
        default=None, metadata={"along": ("axis",), "units": SPEED, "only": "stress"}
    )
    momentum_flux_sum: np.ndarray | None = field(
        default=None, metadata={"along": ("species", "bin"), "units": IMPULSE, "only": "impulses"}
    )
    contact_impulse_sum: np.ndarray | None = field(
        default=None, metadata={"along": ("shell",), "units": ACTION, "only": "pair_impulses"}
    )
    other_impulse_sum: np.ndarray | None = field(
        default=None, metadata={"along": ("shell",), "units": ACTION, "only": "pair_impulses"}
    )


def compressibility_factor(
    virial: np.ndarray | float, count: int, dimension: int, temperature: float, time: np.ndarray | float
) -> np.ndarray:
    """Compute the compressibility factor of a gas without walls from its virial sum."""
    import numpy as np

    return np.asarray(1.0 + virial / (dimension * count * temperature * time))


# Optional tallies that a run can request.


_WITH_STRESS = frozenset(
    ("restitution", "roughness", "viscoelasticity", "contact_duration", "polydispersity", "lees_edwards")
)
"""Features that a scene with this tally may have: velocities still change only at contacts."""


@dataclass(frozen=True)
class StressTally(OptionalTally):
    """Tally of the stress tensor and the heat flux, in a periodic container without gravity.

    Examples
    --------
    >>> import gaspart as gp
    >>> box = gp.Container((9.0, 9.0), boundary="periodic")
    >>> scene = gp.Scene(box, [gp.Species(20, 0.2, temperature=1.0)])
    >>> simulation = gp.Simulation(scene, seed=1, tallies=[gp.StressTally()])
    >>> simulation.advance(duration=2.0)
    >>> simulation.tally.stress_sum.shape
    (2, 2)
    """

    name: ClassVar[str] = "stress"

    def _require(self, scene: Scene) -> None:
        """Raise SceneError unless velocities change only at contacts, in a periodic container."""
        if not scene.is_periodic:
            rule = "the stress, viscosity and conductivity need a periodic container; set boundary: periodic"
            raise SceneError("container.boundary", scene.container.boundary, rule)
        for name in sorted(scene.features - _WITH_STRESS):
            raise SceneError("stress", True, f"cannot be tallied in a scene with {FEATURES[name].meaning}")


_DISTURBING = (
    "fixed",
    "thermostat",
    "sticky",
    "vibrating",
    "piston",
    "moving_wall",
    "lees_edwards",
    "sliding",
    "open",
)
"""Features that prevent equilibrium at one temperature, or add fixed particles."""
_MOST = 100_000
"""Largest number of bins or shells."""
FURTHEST = 0.499
"""Largest allowed distance of a pair, divided by the shortest side of a periodic container."""


@dataclass(frozen=True)
class ImpulseTally(OptionalTally):
    """Tally of the momentum that particles transport along an axis through planes across this axis.

    The density along the axis is computed from this momentum (`analysis.impulses`).

    Parameters
    ----------
    axis : {"x", "y", "z"}
        Axis.
    bins : int
        Number of bins of equal width along the container, from 2 to 100000.

    Raises
    ------
    SceneError
        If the axis or the number of bins is invalid.

    Examples
    --------
    >>> import gaspart as gp
    >>> scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.2, temperature=1.0)])
    >>> simulation = gp.Simulation(scene, seed=1, tallies=[gp.ImpulseTally("y", 30)])
    >>> simulation.advance(duration=2.0)
    >>> simulation.tally.momentum_flux_sum.shape
    (1, 30)
    """

    axis: str
    bins: int

    name: ClassVar[str] = "impulses"
    meaning: ClassVar[str] = (
        "keep impulses along an axis in so many bins, such as `z:200`: in equilibrium `density` along the "
        "axis and `pressure` across it are then several times as accurate"
    )
    form: ClassVar[str] = "AXIS:BINS"

    def __post_init__(self) -> None:
        one_of("impulses.axis", self.axis, ("x", "y", "z"))
        count_of("impulses.bins", self.bins, least=2, most=_MOST)

    def _require(self, scene: Scene) -> None:
        """Raise SceneError unless a scene has this axis and is in equilibrium at one temperature."""
        one_of("impulses.axis", self.axis, tuple("xyz"[: scene.dimension]))
        _require_equilibrium(scene)


def _require_equilibrium(scene: Scene) -> None:
    """Raise SceneError if the tallied momentum does not determine the density in a scene. The message states
    the reason. The velocities of particles must be independent of their positions, which holds only in
    equilibrium at one temperature.
    """
    if len({particle.mass for particle in scene.particles}) > 1:
        rule = "must have one mass for an impulse tally, which sums over all single particles"
        raise SceneError("particles.mass", len(scene.particles), rule)
    if scene.restitution is not None:
        scene.restitution.refuse_loss("excludes impulses, which require equilibrium; this gas loses energy")
    for name in _DISTURBING:
        if FEATURES[name].value(scene) is not None:
            rule = f"excludes impulses, which require equilibrium at rest, not {FEATURES[name].meaning}"
            raise FEATURES[name].refuse(scene, rule)
    if scene.driven_axes:
        raise SceneError(
            "gravity", scene.gravity, "excludes impulses, which require equilibrium; this gas flows"
        )
    temperatures = sorted(scene.face_temperatures)
    if len(temperatures) > 1:
        rule = "excludes impulses, which require equilibrium; heat flows between faces"
        raise SceneError("faces.temperature", temperatures, rule)


@dataclass(frozen=True)
class PairImpulseTally(OptionalTally):
    """Tally of the momentum that pairs gain along their separation, in shells of equal thickness.

    The pair distribution g(r) is computed from this tally (`analysis.pairs`).

    Parameters
    ----------
    furthest : float, [length]
        Largest distance of a pair; a positive number.
    shells : int
        Number of shells, from 2 to 100000.
    share : float, default 1.0, [1]
        Fraction of contacts, in (0, 1], at which pairs with all other particles are searched and tallied,
        too.

    Raises
    ------
    SceneError
        If a value is out of range.

    Examples
    --------
    >>> import gaspart as gp
    >>> box = gp.Container((9.0, 9.0), boundary="periodic")
    >>> scene = gp.Scene(box, [gp.Species(20, 0.2, temperature=1.0)])
    >>> simulation = gp.Simulation(scene, seed=1, tallies=[gp.PairImpulseTally(3.0, 50, 0.5)])
    >>> simulation.advance(duration=2.0)
    >>> simulation.tally.contact_impulse_sum.shape
    (50,)
    """

    furthest: float
    shells: int
    share: float = 1.0

    name: ClassVar[str] = "pair_impulses"
    meaning: ClassVar[str] = (
        "keep impulses of pairs up to a distance in so many shells, at a fraction of contacts (default: 1), "
        "such as `3:300:0.5`: in equilibrium `rdf` is then more accurate"
    )
    form: ClassVar[str] = "DISTANCE:SHELLS[:FRACTION]"

    def __post_init__(self) -> None:
        number("pair_impulses.furthest", self.furthest, "must be positive", above=0.0)
        count_of("pair_impulses.shells", self.shells, least=2, most=_MOST)
        number("pair_impulses.share", self.share, "must be above 0 and at most 1", above=0.0, most=1.0)

    def _require(self, scene: Scene) -> None:
        """Raise SceneError unless a scene is periodic, large enough, and in equilibrium. Equilibrium requires
        a single temperature.
        """
        if not scene.is_periodic:
            rule = "needs a periodic container; set boundary: periodic"
            raise SceneError("pair_impulses", self.furthest, rule)
        diameter, half = 2.0 * scene.largest_radius, FURTHEST * min(scene.container.lengths)
        if not diameter < self.furthest <= half:
            rule = f"must be from the largest diameter, {diameter:g}, to half of the shortest side, "
            rule += f"{half:.4g}"
            raise SceneError("pair_impulses.furthest", self.furthest, rule)
        if scene.count < 2:
            raise SceneError("count", scene.count, "must be at least 2 for pair_impulses")
        _require_equilibrium(scene)


# Optional tallies that every run of some scenes has, if the engine can make them.


@dataclass(frozen=True)
class WallShearTally(OptionalTally):
    """Tangential momentum given to faces."""

    name: ClassVar[str] = "wall_shear"
    fact: ClassVar[str] = "drags_faces"


@dataclass(frozen=True)
class EntryTally(OptionalTally):
    """Particles that have entered through open faces."""

    name: ClassVar[str] = "entries"
    fact: ClassVar[str] = "is_open"


@dataclass(frozen=True)
class FixedCollisionTally(OptionalTally):
    """Collisions with fixed particles."""

    name: ClassVar[str] = "fixed_collisions"
    fact: ClassVar[str] = "has_fixed"


@dataclass(frozen=True)
class PerAreaTally(OptionalTally):
    """Momentum and heat transferred to faces, per area accessible to centres of each particle size."""

    name: ClassVar[str] = "per_area"
    fact: ClassVar[str] = "has_unequal_areas"


TALLIES: dict[str, type[OptionalTally]] = {
    tally.name: tally
    for tally in (
        StressTally,
        ImpulseTally,
        PairImpulseTally,
        WallShearTally,
        EntryTally,
        FixedCollisionTally,
        PerAreaTally,
    )
}
"""All optional tallies, by name."""
