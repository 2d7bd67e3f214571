"""Arrays of the kernels of the time-stepped engine: particles, model and counters."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from gaspart.engines.features.faces import FacesPart, face_energy, special_faces
from gaspart.engines.features.law import LawPart, contact_law, scaled_masses
from gaspart.engines.features.part import Part, TallyPart, gravity_of
from gaspart.engines.features.tallies import rows_of
from gaspart.kernels.model import Model, Space, empty_tally, flight_dtype
from gaspart.kernels.physics.running_sum import whole_parts
from gaspart.kernels.step import model as layout
from gaspart.kernels.step.boundaries import Rules
from gaspart.kernels.step.box_search import StepBoxes
from gaspart.kernels.step.model import Cells, Search, StepModel, StepParticles, StepTally
from gaspart.kernels.step.neighbour_list import roomy
from gaspart.scene.features import row_count
from gaspart.scene.scene import Scene
from gaspart.scene.sizes import ball_volume
from gaspart.state.boxes import cube_side, make_boxes
from gaspart.state.optional_tallies import OptionalTally
from gaspart.state.state import State
from gaspart.state.tally import ImpulseTally

if TYPE_CHECKING:
    from gaspart.engines.step.settings import StepSettings


def empty_particles(engine: StepSettings, scene: Scene, state: State, ordinary: int) -> StepParticles:
    """Return empty arrays for particles with masses, `ordinary` ones not oversized, without a list."""
    real = np.dtype(engine.precision).type
    _, masses = masses_of(scene, state)
    shape = (state.dimension, state.count)
    return StepParticles(
        positions=roomy(shape, real),
        velocities=np.empty(shape, real),
        images=np.empty(shape, np.int32),
        radii=roomy((state.count,), real),
        index=np.empty(state.count, np.uint32),
        masses=masses.astype(real),
        last_pass=roomy((state.count,), np.uint32),
        bounds=np.array([0.0, np.inf]),
        ordinary=ordinary,
    )


def masses_of(scene: Scene, state: State) -> tuple[float, np.ndarray]:
    """Return the unit of mass, and the masses (N,) in this unit."""
    if needs_rules(scene):
        return 1.0, state.masses
    unit, masses = scaled_masses(state.masses)
    return unit, np.ones(state.count) if masses is None else masses


def model_for(
    engine: StepSettings, scene: Scene, state: State, seed: int | tuple[int, ...], radii: np.ndarray
) -> StepModel:
    """Return the kernel model of a scene, for `radii` that are not oversized and a `seed` of walls."""
    real = np.dtype(engine.precision).type
    lengths, margin = scene.container.lengths, real(not scene.centres_to_walls)
    space = Space(tuple(real(length) for length in lengths), scene.container.periodic, margin)
    normal = 1.0 if scene.restitution is None else scene.restitution.normal
    rules = rules_for(engine, scene, state, seed, space)
    return StepModel(
        space,
        normal=real(normal),
        impulse_share=real(0.5 * (1.0 + normal)),
        inset=real(margin * real(radii.max(initial=0.0))),
        gravity=None if scene.gravity is None else tuple(real(g) for g in scene.gravity),
        rules=rules,
        law=rules.model.law if rules else None,
    )


def step_tally(
    faces: int,
    threads: int,
    largest: tuple[float, float],
    parts: Iterable[TallyPart],
    areas: tuple[np.ndarray, np.ndarray] | None,
    fixed: bool,
) -> StepTally:
    """Return a tally for a number of faces, with all counters at zero. `largest`: see `largest_terms`.
    `parts`: parts for optional tallies. `areas`: result of `inverse_areas` if the areas differ between
    particle sizes, otherwise None. `fixed`: True if there are fixed particles.
    """
    tally = StepTally(
        counts=np.zeros(layout.PASSED + 1, dtype=np.int64),
        sums=np.zeros((len(layout.SUMS), 2)),
        extremes=np.zeros(len(layout.EXTREMES)),
        wall_hits=np.zeros((threads, faces), dtype=np.int64),
        wall_impulse=np.zeros((threads, faces, 2), dtype=np.int64),
        wall_loss=np.zeros((threads, 2), dtype=np.int64),
        momentum=largest[0],
        energy=largest[1],
    )
    if fixed:
        tally = tally._replace(fixed=True)
    if areas is not None:
        inverse, size = areas
        per_area = np.zeros((threads, faces, 2, 2), dtype=np.int64)
        tally = tally._replace(per_area=per_area, share=inverse / inverse.max(), size=size)
    for part in parts:
        tally = tally._replace(**part.kernel)
    return tally


def rules_for(
    engine: StepSettings, scene: Scene, state: State, seed: int | tuple[int, ...], space: Space
) -> Rules | None:
    """Return the kernels' `Rules` for special faces or collision laws, or None. These faces and laws change
    more than the momenta of particles, for example spins. `space`: space in the form of the kernels of this
    engine.
    """
    if not needs_rules(scene):
        return None
    special = special_faces(scene, state, seed, unit_mass=1.0)._replace(sliding=None)
    model = Model(
        space=space,
        masses=state.masses.astype(engine.precision),
        gravity=gravity_of(scene, state),
        law=contact_law(scene, state),
        faces=special,
        walls=None,
        oversized=None,
        shear=None,
        reservoirs=None,
    )
    radius = 0.0 if scene.centres_to_walls else state.radii.max(initial=0.0)
    inset = np.where(np.repeat(scene.container.periodic, 2), 0.0, radius + special.width).reshape(-1, 2)
    free = np.stack([inset[:, 0], np.array(scene.container.lengths) - inset[:, 1]], axis=1)
    walls = 2 * scene.dimension
    return Rules(
        np.zeros(state.count, flight_dtype(scene.dimension)),
        model,
        empty_tally(walls),
        free.astype(engine.precision),
        holds=bool(special.depth.any()) or special.sticky is not None,
        heat=np.zeros((walls, 2), dtype=np.int64),
    )


def parts_for(scene: Scene, rules: Rules | None) -> list[Part]:
    """Return the parts of a run that these rules need; () without rules."""
    if rules is None:
        return []
    law, faces = rules.model.law, rules.model.faces
    heat = Part({}, sums={"heat": rules.heat[np.newaxis]})  # shared by all threads
    parts = LawPart(law) if law else None, FacesPart(scene, faces, 1.0) if faces else None, heat
    return [part for part in parts if part]


def needs_rules(scene: Scene) -> bool:
    """Return True if faces or collisions of a scene change more than momenta, for example spins."""
    return bool(scene.faces) or scene.rough or scene.vibrates


# Optional tallies of the time-stepped engine. Threads add to them without rounding errors.


class ImpulsesPart(TallyPart):
    """Momentum that particles transport through planes across an axis. The transported momentum is the
    momentum below each plane at the last reset (`momenta`), plus all impulses since then, minus the present
    momentum below the plane. `kernel` contains the fields of a `StepTally`, by name.

    particles : particles of the kernels
    units : unit of mass, and the bound of a particle's momentum in this unit
    """

    kernel: dict[str, Any]

    def __init__(
        self,
        tally: OptionalTally,
        particles: StepParticles,
        model: StepModel,
        scene: Scene,
        threads: int,
        units: tuple[float, float],
    ) -> None:
        assert isinstance(tally, ImpulseTally)
        self._particles, (self._unit_mass, self._largest) = particles, units
        self._axis, self._rows = "xyz".index(tally.axis), rows_of(scene)
        self._per_length = tally.bins / scene.container.lengths[self._axis]
        rows = row_count(scene)
        momenta = np.zeros((rows, tally.bins + 1))
        sums = np.zeros((threads, *momenta.shape, 2), np.int64)
        kernel = {
            "impulses": sums,
            "axis": self._axis,
            "pull": 0.0 if model.gravity is None else float(model.gravity[self._axis]),
            "per_length": self._per_length,
            "turns": 1.0 / tally.bins if scene.container.periodic[self._axis] else 0.0,
            "row": self._rows if rows > 1 else None,
        }
        super().__init__("impulses", kernel, {"momenta": momenta}, {"impulses": sums})
        self.reset(0.0)

    def _momenta(self) -> np.ndarray:
        """Return the momenta (rows, bins + 1) in bins, summed by particle number so that rounding is
        fixed.
        """
        particles = self._particles
        order = np.argsort(particles.index)
        coordinates = particles.positions[self._axis][order].astype(float) * self._per_length
        momenta = particles.masses.astype(float) * particles.velocities[self._axis][order]
        binned = np.zeros_like(self.arrays["momenta"])
        bins = np.clip(coordinates.astype(np.int64), 0, binned.shape[1] - 2)
        upper = momenta * (coordinates - bins)
        np.add.at(binned, (self._rows, bins), momenta - upper)
        np.add.at(binned, (self._rows, bins + 1), upper)
        return binned

    def reset(self, clock: float) -> None:
        super().reset(clock)
        self.arrays["momenta"][...] = self._momenta()

    def read(self, clock: float) -> np.ndarray:
        """Return the transported momentum (species, bins) up to the present time."""
        impulses = whole_parts(self.sums["impulses"].sum(axis=0), self._largest).sum(axis=-1)
        below = np.cumsum(impulses + (self.arrays["momenta"] - self._momenta()), axis=1)
        return np.asarray(self._unit_mass * below[:, :-1])

    def counts(self, clock: float) -> dict[str, Any]:
        return {"momentum_flux_sum": self.read(clock)}


PARTS = {"impulses": ImpulsesPart}
"""Classes of the parts for optional tallies, by name."""


def tally_parts(
    tallies: Iterable[OptionalTally],
    particles: StepParticles,
    model: StepModel,
    scene: Scene,
    threads: int,
    units: tuple[float, float],
) -> list[TallyPart]:
    """Return the parts for optional tallies, from the particles in their slots and `ImpulsesPart`'s units."""
    return [PARTS[tally.name](tally, particles, model, scene, threads, units) for tally in tallies]


# Search of the time-stepped engine: boxes, or the cells and the skin of a neighbour list.


_CELLS_PER_PARTICLE = 6.0
_REBUILD, _TEST, _PAIR = 25.0, 2.0, 6.0  # ns per particle, candidate and listed pair; only ratios matter
_LEAST = 1.6  # minimum skin, in distances by which the fastest two particles approach in a step


def search_for(engine: StepSettings, scene: Scene, state: State, radii: np.ndarray) -> Search:
    """Return boxes, or cells and an empty neighbour list, for particles with these radii."""
    pairs = np.empty((engine.threads, state.count // engine.threads + 16), np.uint64)
    if engine.boxes_per_side is None:
        return Search(None, cells_for(engine, scene, state, radii), pairs)
    reach = 2.0 * radii.max(initial=0.0)
    grid = make_boxes(scene, engine.boxes_per_side, images=False, narrowest=reach)
    real = np.dtype(engine.precision).type
    boxes = StepBoxes(
        grid.per_side, grid.widths.astype(real), grid.strides, grid.neighbour,
        at=np.zeros((state.count, 3), dtype=np.int64),
        head=np.empty(grid.count, dtype=np.int32),
        following=np.empty(state.count, dtype=np.int32),
        near=engine.near_boxes,
        reach=real(reach * (1.0 + 1e-5)),
    )  # fmt: skip
    return Search(boxes, None, pairs)


def cells_for(engine: StepSettings, scene: Scene, state: State, radii: np.ndarray) -> Cells:
    """Return the cells of the neighbour list."""
    real = np.dtype(engine.precision).type
    lengths, periodic = scene.container.lengths, scene.container.periodic
    contact = 2.0 * radii.max(initial=0.0)
    skin = engine.skin or _skin(engine, scene, state, contact)
    width = max((contact + skin) * (1.0 + 1e-4), _width(scene, state.count))
    sides = [max(1, int(length / width)) for length in lengths]
    # two cells would be neighbours twice; one cell suffices because the nearest images are used
    sides = [1 if p and side < 3 else side for side, p in zip(sides, periodic, strict=True)]
    rest = [1] * (3 - scene.dimension)
    per_side = np.array(sides + rest, dtype=np.int64)
    inverse = per_side / np.array([*lengths, *rest])
    rows = int(per_side[0]) + 3
    strides = np.array([1, rows, rows * (per_side[1] + 2)], dtype=np.int64)
    layers = int(strides[2]) * (int(per_side[2]) + 2 if scene.dimension == 3 else 1)
    return Cells(
        per_side,
        inverse.astype(real),
        strides,
        wraps=np.array(
            [p and side > 1 for side, p in zip(sides, periodic, strict=True)] + [False] * len(rest)
        ),
        ends=np.empty(layers, np.uint32),
        cell=np.zeros(state.count, np.uint32),
        order=np.empty(len(radii), np.uint32),
        skin=real(skin),
        origin=np.empty((scene.dimension, state.count), real),
        held=np.zeros(state.count if engine.threads > 1 else 0, bool),
        listed=np.zeros(engine.threads, int),
    )


def _width(scene: Scene, count: int) -> float:
    return cube_side(scene.container.lengths, _CELLS_PER_PARTICLE * count)


def _skin(engine: StepSettings, scene: Scene, state: State, contact: float) -> float:
    """Return the skin thickness with the lowest cost of making and searching lists."""
    dimension, density = scene.dimension, state.count / scene.container.volume
    squares = (state.velocities**2).sum(axis=1)
    fastest = np.sqrt(squares.max(initial=0.0))
    if state.count > 1:  # final speeds, for any present speeds
        square = max(squares.mean(), face_energy(scene) / float(state.masses.min())) / dimension
        fastest = max(fastest, np.sqrt(square * (2.0 * np.log(state.count) + 2.0)))
    gravity = 0.0 if scene.gravity is None else float(np.abs(scene.gravity).max())
    way = 2.0 * (fastest * engine.time_step + gravity * engine.time_step**2)
    skins = contact * np.geomspace(0.02, 30.0, 60)
    steps = np.maximum(skins / way, 1.0) if way > 0.0 else np.full(60, np.inf)
    pairs = 0.5 * ball_volume(dimension) * density * (contact + skins) ** dimension
    stretches = 4.5 if dimension == 2 else 13.5  # cells in which neighbours are searched
    tests = stretches * density * np.maximum(contact + skins, _width(scene, state.count)) ** dimension
    cost = (_REBUILD + _TEST * tests) / steps + _PAIR * pairs
    cost[skins < _LEAST * way] = np.inf  # particles would use up the skin in one step
    return float(skins[np.argmin(cost)]) if np.isfinite(cost).any() else _LEAST * way
