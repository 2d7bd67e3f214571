"""Arrays of the kernels' model, made from a scene and a state for both engines."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from gaspart.engines.features.piston import piston_of
from gaspart.engines.features.vibrating import motion_of
from gaspart.errors import SceneError
from gaspart.kernels.model import (
    HARD,
    NONE,
    PISTON,
    STICKY,
    THERMAL,
    THERMAL_NORMAL,
    VIBRATING,
    ContactDuration,
    ContactLaw,
    Faces,
    InteriorWalls,
)
from gaspart.scene.faces import FACES, Piston, Sticky, Thermal, Vibrating, Well
from gaspart.scene.restitution import Restitution
from gaspart.scene.scene import Scene
from gaspart.state.insertion import per_body
from gaspart.state.interior_walls import wall_rows, walls_near
from gaspart.state.random import key_of
from gaspart.state.state import State
from gaspart.state.wells import places_in_wells, well_energies, wells_of

if TYPE_CHECKING:
    from gaspart.state.boxes import Boxes

_BISECTIONS = 100  # until neighbouring numbers enclose the damping of viscoelastic particles
_ROOM = 4096  # capacity of the record, in events
_WALL_DRAWS = 2  # the purpose of the random numbers of thermal walls, after those of the initial state


def check_parts(parts: Mapping[str, np.ndarray], wanted: Mapping[str, np.ndarray]) -> None:
    """Raise SceneError unless a checkpoint has all `wanted` arrays, each of its shape and kind of number."""
    for key, array in wanted.items():
        found = parts.get(key)
        alike = isinstance(found, np.ndarray) and found.shape == np.shape(array)
        if not alike or found.dtype.kind != np.asarray(array).dtype.kind:  # type: ignore[union-attr]
            raise SceneError("checkpoint", key, "is missing or of another form: the checkpoint is damaged")


def scaled_masses(masses: np.ndarray) -> tuple[float, np.ndarray | None]:
    """(unit, array): equal masses are not part of the kernel's model, and their sums scaled by `unit`."""
    if len(masses) == 0:
        return 1.0, None
    return (float(masses[0]), None) if (masses == masses[0]).all() else (1.0, masses)


def contact_law(scene: Scene, state: State) -> ContactLaw | None:
    """The law of contacts, or None if all are elastic, smooth and between particles that can move."""
    rule = scene.restitution or Restitution()
    if rule.smooth_and_elastic and not np.isinf(state.masses).any():
        return None
    spins = np.zeros((state.count, 3))
    if scene.dimension == 2:
        spins[:, 2] = state.spins
    else:
        spins[:] = state.spins
    vibrations = None
    modes = per_body(scene, "vibrates")
    if modes.any() and state.vibrations is not None:
        vibrations = np.where(modes, state.vibrations, -1.0)
    inverses = 1 / state.masses, 1 / state.moments_of_inertia
    return ContactLaw(rule.normal, rule.tangential, _viscous(scene), *inverses, spins, vibrations, None)


def _viscous(scene: Scene) -> float | None:
    """The constant of viscoelastic particles, from the restitution of two of the first species, or else of
    the first body; None if the restitution is constant."""
    rule = scene.restitution
    if rule is None or rule.reference_speed is None:
        return None
    from gaspart.kernels.physics.viscoelastic import fifth_root, restitution_of

    first = (scene.species or scene.bodies)[0]
    least, most = 0.0, 1.0
    while restitution_of(most) > rule.normal:
        most *= 2.0
    for _ in range(_BISECTIONS):
        middle = 0.5 * (least + most)
        least, most = (middle, most) if restitution_of(middle) > rule.normal else (least, middle)
    return most / fifth_root(rule.reference_speed * 0.5 * first.radius * (2.0 / first.mass) ** 2)


def contact_duration(scene: Scene) -> ContactDuration | None:
    """The rule of contacts that last, before the first contact; None if there is none."""
    if not scene.contact_duration > 0.0:
        return None
    never = np.full(scene.count, -np.inf)
    return ContactDuration(
        length=scene.contact_duration,
        latest=never,
        met=never.copy(),
        island=np.full(scene.count, NONE),
        elastic=np.zeros(1, dtype=np.int64),
        kept=np.zeros((1, 2)),
    )


def special_faces(scene: Scene, state: State, seed: int | tuple[int, ...], unit_mass: float) -> Faces:
    """The kinds of the container's faces as the kernels' `Faces`, in units of `unit_mass`."""
    kinds, levels = [], []
    for name in FACES[: 2 * scene.dimension]:
        match scene.faces.get(name):
            case Thermal(temperature, "normal"):
                kind, level = THERMAL_NORMAL, temperature
            case Thermal(temperature) | Well(temperature=float(temperature)):
                kind, level = THERMAL, temperature
            case Sticky(momentum):
                kind, level = STICKY, momentum
            case Vibrating():
                kind, level = VIBRATING, 0.0
            case Piston():
                kind, level = PISTON, 0.0
            case _:
                kind, level = HARD, 0.0
        kinds.append(kind)
        levels.append(level)
    depths, widths = wells_of(scene)
    kind = np.array(kinds, dtype=np.int64)
    return Faces(
        kind=kind,
        level=np.array(levels) / unit_mass,
        depth=depths / unit_mass,
        width=widths,
        place=places_in_wells(scene, state.positions, state.radii),
        held=np.zeros(state.positions.shape),
        draws=np.zeros(state.count, dtype=np.int64),
        key=key_of(seed, _WALL_DRAWS),
        sticky=kind == STICKY if STICKY in kinds else None,
        motion=motion_of(scene),
        piston=piston_of(scene, state, unit_mass),
    )


def interior_walls(scene: Scene, boxes: Boxes, largest_radius: float) -> InteriorWalls:
    """The interior walls as the kernels' `InteriorWalls`, with those near each box for radii up to
    `largest_radius`."""
    rows, wall = wall_rows(scene)
    return InteriorWalls(rows, wall, *walls_near(rows, boxes, largest_radius), largest_radius)


def face_energy(scene: Scene) -> float:
    """Upper estimate of the energy that a thermal face or a well gives a particle."""
    hottest = max((getattr(face, "temperature", None) or 0.0 for face in scene.faces.values()), default=0.0)
    deepest = max((getattr(face, "depth", 0.0) for face in scene.faces.values()), default=0.0)
    return scene.dimension * hottest + 2.0 * deepest


def internal_arrays(law: ContactLaw | None, faces: Faces | None) -> dict[str, np.ndarray]:
    """What particles keep inside or at faces during a run, and how often faces have drawn, by name."""
    arrays = {key: getattr(faces, key) for key in ("place", "held", "draws")} if faces else {}
    if law:
        arrays["spins"] = law.spins
        if law.vibrations is not None:
            arrays["vibrations"] = law.vibrations
    return arrays


def write_internal(
    state: State, scene: Scene, law: ContactLaw | None, faces: Faces | None, unit_mass: float
) -> None:
    """Write the internal variables of a law and of faces (or None) into a state: spins, and the energies in
    wells and in the vibrations of fixed particles and of those stuck to a face."""
    if law:
        state.spins = (law.spins[:, 2] if state.dimension == 2 else law.spins).copy()
    if faces:
        state.well_energies = well_energies(scene, faces.place)
    if state.vibrations is not None:
        state.vibrations = np.zeros(state.count)
        if faces:
            state.vibrations += faces.held.sum(axis=1) * unit_mass
        if law and law.vibrations is not None:
            state.vibrations += np.maximum(law.vibrations, 0.0)


class EventLog:
    """Events as they happened: particles, and their positions, velocities and, if wanted, spins just
    after."""

    def __init__(self, dimension: int, spins: bool = False) -> None:
        from gaspart.kernels.event.monitors import Record

        self._keys = ("time", "bodies", "positions", "velocities", *(("spins",) if spins else ()))
        self._dimension = dimension
        self._parts: list[tuple[np.ndarray, ...]] = []
        self.room = Record(
            filled=np.zeros(1, dtype=np.int64),
            time=np.empty(_ROOM),
            bodies=np.empty((_ROOM, 2), dtype=np.int64),
            positions=np.empty((_ROOM, 2, dimension)),
            velocities=np.empty((_ROOM, 2, dimension)),
            spins=np.empty((_ROOM, 2, 3)),
        )

    def _copy(self, count: int) -> tuple[np.ndarray, ...]:
        """The first events in the kernel's record; of spins in 2D the component normal to the plane."""
        found = {key: getattr(self.room, key)[:count] for key in self._keys}
        if "spins" in found and self._dimension == 2:
            found["spins"] = found["spins"][..., 2]
        return tuple(array.copy() for array in found.values())

    def take(self, start: float) -> None:
        """Empty the kernel's record, whose times count from `start`."""
        n = int(self.room.filled[0])
        self.room.filled[0] = 0
        if n:
            time, *others = self._copy(n)
            self._parts.append((start + time, *others))

    @property
    def events(self) -> dict[str, np.ndarray]:
        """time (M,), bodies (M, 2), positions and velocities (M, 2, d), and spins (M, 2) or (M, 2, 3).

        The second of `bodies` is -1 - face for a hit at a wall, and the values of the second are NaN.
        """
        parts = zip(*(self._parts or [self._copy(0)]), strict=True)
        return dict(zip(self._keys, map(np.concatenate, parts), strict=True))
