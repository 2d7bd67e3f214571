"""Initial states: positions and velocities of the particles at time 0."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gaspart.errors import SceneError
from gaspart.scene.boundaries import flow
from gaspart.scene.scene import Scene
from gaspart.scene.species import LATTICES, Species
from gaspart.scene.surfaces import FACES, Well
from gaspart.scene.walls import MOVING_WALL
from gaspart.state.compression import compress_positions
from gaspart.state.insertion import per_particle, random_insertion
from gaspart.state.random import directions, natural_log, normals, stream
from gaspart.state.state import State

# Potential wells at the faces of a container: depths, and particles inside.


def wells_of(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Return the depths and widths of the wells at all faces."""
    faces = (scene.faces.get(name) for name in FACES[: 2 * scene.dimension])
    wells = [(face.depth, face.width) if isinstance(face, Well) else (0.0, 0.0) for face in faces]
    depths, widths = np.array(wells).T
    return depths, widths


def places_in_wells(scene: Scene, positions: np.ndarray, radii: np.ndarray) -> np.ndarray:
    """Return for each particle the wells of faces in which it is."""
    margins = 0.0 if scene.centres_to_walls else radii[:, None]
    _, widths = wells_of(scene)
    low = positions - margins < widths[::2]
    high = np.array(scene.container.lengths) - positions - margins < widths[1::2]
    return high.astype(np.int8) - low.astype(np.int8)


def well_energies(scene: Scene, wells: np.ndarray) -> np.ndarray:
    """Return the potential energy of each particle in wells."""
    depths, _ = wells_of(scene)
    return -(np.where(wells < 0, depths[::2], 0.0) + np.where(wells > 0, depths[1::2], 0.0)).sum(axis=1)


_POSITIONS, _VELOCITIES, _VIBRATIONS = 0, 1, 3  # stream 2 is for velocities drawn at walls


def initial_state(scene: Scene, seed: int | tuple[int, ...]) -> State:
    """Return the state of a scene at time 0."""
    explicit = len(scene.particles)
    spins = np.zeros((scene.count, 3))
    if explicit:
        spins[:explicit] = [particle.spin_vector for particle in scene.particles]
    rng = stream(seed, _POSITIONS)
    arrangements = {kind.arrangement for kind in scene.species if kind.count}
    ordered = arrangements & set(LATTICES)
    if ordered and "random" not in arrangements:
        positions = _on_lattice(scene, rng, min(ordered))
    elif "compressed" in arrangements:
        positions = compress_positions(scene, seed)
    else:
        try:
            positions, _ = random_insertion(scene, rng, given=_sites(scene, rng))
        except SceneError as error:
            rule = f"{error.rule}; {_instead_of_random(scene, seed)}"
            raise SceneError(error.key, error.value, rule) from None
    velocities = drawn_velocities(scene, seed)
    _add_flow(scene, positions, velocities)
    return replace(
        assemble_state(
            scene,
            positions,
            velocities,
            spins[:, 2] if scene.dimension == 2 else spins,
        ),
        vibrations=_vibrations(scene, stream(seed, _VIBRATIONS)) if scene.vibrates else None,
    )


def masses_of(scene: Scene) -> np.ndarray:
    """Return the masses of all particles, infinite for fixed particles."""
    return np.where(
        per_particle(scene, "fixed").astype(bool), np.inf, per_particle(scene, "mass").astype(float)
    )


def assemble_state(scene: Scene, positions: np.ndarray, velocities: np.ndarray, spins: np.ndarray) -> State:
    """Return the state at time 0 from positions, velocities and spins."""
    radii, masses = per_particle(scene, "radius").astype(float), per_particle(scene, "mass").astype(float)
    # moment of inertia divided by m r^2, for uniform density
    shape = 1 / 2 if scene.dimension == 2 else 2 / 5
    inertia = per_particle(scene, "moment_of_inertia").astype(float)  # None becomes NaN
    inertia = np.where(np.isnan(inertia), shape * masses * radii**2, inertia)
    groups = [len(scene.species), *range(len(scene.species))]
    counts = [len(scene.particles), *(kind.count for kind in scene.species)]
    piston_face, piston = _piston(scene)
    return State(
        time=0.0,
        positions=positions,
        velocities=velocities,
        images=np.zeros((scene.count, scene.dimension), dtype=np.int64),
        radii=radii,
        masses=masses_of(scene),
        species=np.repeat(groups, counts).astype(np.int64),
        lengths=np.array(scene.container.lengths),
        spins=spins,
        moments_of_inertia=np.where(per_particle(scene, "fixed").astype(bool), np.inf, inertia),
        gravity=None if scene.gravity is None else np.array(scene.gravity),
        well_energies=well_energies(scene, places_in_wells(scene, positions, radii)) if scene.faces else None,
        piston=piston,
        piston_face=piston_face,
        displaced=None if scene.shear_rate is None else 0.0,
        shear_rate=scene.shear_rate,
    )


def _piston(scene: Scene) -> tuple[str | None, np.ndarray | None]:
    """Return the name of the face or wall that is a piston, and its motion. The motion is an array (2,) of
    position and velocity at time 0. Without a piston, the function returns (None, None).
    """
    for n, face in scene.pistons:
        start = scene.container.lengths[n // 2] if n % 2 else 0.0
        return FACES[n], np.array([start, face.initial_velocity(n)])
    wall = scene.moving_wall
    return (None, None) if wall is None else (MOVING_WALL, np.array([wall.position, 0.0]))


def _on_lattice(scene: Scene, rng: np.random.Generator, arrangement: str) -> np.ndarray:
    """Return the positions (N, d) of the arrangement "lattice" or "slab". Raises SceneError under the same
    conditions as `lattice`, and if a particle would overlap an interior wall.
    """
    positions = lattice(scene, rng, slab=arrangement == "slab")
    radii = per_particle(scene, "radius").astype(float)
    hit = (scene.wall_at(position, radius) for position, radius in zip(positions, radii, strict=True))
    if scene.walls and any(hit):
        raise SceneError("arrangement", arrangement, "a particle would overlap an interior wall; use random")
    return positions


def _sites(scene: Scene, rng: np.random.Generator) -> dict[int, np.ndarray]:
    """Return the positions of species on a lattice that random species fill, by number of the species."""
    numbers = [n for n, kind in enumerate(scene.species) if kind.arrangement == "lattice" and kind.count]
    if not numbers:
        return {}
    listed = [scene.species[n] for n in numbers]
    positions = _on_lattice(replace(scene, species=listed), rng, "lattice")
    parts = np.split(positions, np.cumsum([kind.count for kind in listed])[:-1])
    return dict(zip(numbers, parts, strict=True))


def _instead_of_random(scene: Scene, seed: int | tuple[int, ...]) -> str:
    """Return advice for a scene whose particles cannot be placed by random insertion. The advice names an
    arrangement only if the particles fit into the container in this arrangement.
    """
    try:
        arranged = replace(scene, species=[replace(kind, arrangement="lattice") for kind in scene.species])
        _on_lattice(arranged, stream(seed, _POSITIONS), "lattice")
    except SceneError:
        return "use fewer or smaller particles, or a larger container"
    return "use arrangement: lattice"


def _vibrations(scene: Scene, rng: np.random.Generator) -> np.ndarray:
    """Return the energies (N,) of the vibrations. An energy is the `vibration` of the scene, or is drawn from
    the distribution exp(-E/kT)/kT. It is 0 for particles that do not vibrate.
    """
    parts = [np.array([particle.vibration or 0.0 for particle in scene.particles])]
    for kind in scene.species:
        if kind.vibrates and kind.temperature is not None:
            parts.append(-kind.temperature * natural_log(1.0 - rng.random(kind.count)))
        else:
            parts.append(np.full(kind.count, kind.vibration or 0.0))
    return np.concatenate(parts)


def drawn_velocities(scene: Scene, seed: int | tuple[int, ...]) -> np.ndarray:
    """Return the velocities (N, d) of a run with this seed; those of a sheared gas are about its flow."""
    return _velocities(scene, stream(seed, _VELOCITIES))


def _velocities(scene: Scene, rng: np.random.Generator) -> np.ndarray:
    """Return the initial velocities (N, d), which the scene states or which are random."""
    parts = [
        np.array([particle.velocity for particle in scene.particles], dtype=float).reshape(
            -1, scene.dimension
        )
    ]
    for kind in scene.species:
        if kind.speed is not None:
            parts.append(kind.speed * directions(rng, kind.count, scene.dimension))
        elif kind.temperature is not None and not kind.fixed:
            width = math.sqrt(kind.temperature / kind.mass)
            parts.append(width * normals(rng, kind.count, scene.dimension))
        else:
            parts.append(np.zeros((kind.count, scene.dimension)))
    velocities = np.concatenate(parts)
    if any(kind.exact_temperature for kind in scene.species):
        _make_exact(scene, velocities)
    return velocities


def _add_flow(scene: Scene, positions: np.ndarray, velocities: np.ndarray) -> None:
    """Add the flow of a sheared gas to random velocities (N, d)."""
    drawn = slice(len(scene.particles), None)
    if scene.shear_rate is not None and len(positions[drawn]):
        velocities[drawn] = in_flow(scene, masses_of(scene)[drawn], positions[drawn], velocities[drawn])


def in_flow(scene: Scene, masses: np.ndarray, positions: np.ndarray, velocities: np.ndarray) -> np.ndarray:
    """Add the flow of a sheared gas to velocities, after their mean has been subtracted."""
    peculiar = velocities.copy()
    for k in range(scene.dimension):
        peculiar[:, k] -= math.fsum(masses * velocities[:, k]) / math.fsum(masses)
    return peculiar + flow(scene, positions)


def _make_exact(scene: Scene, velocities: np.ndarray) -> None:
    """Rescale velocities of the species with `exact_temperature`. First, their mean velocity is subtracted
    along axes with conserved momentum. Then a factor for each group of `_apart` makes the mean of m v^2 / kT
    per degree of freedom of the group equal to 1. The sums have the same rounding on every machine. Raises
    SceneError if there is no degree of freedom.
    """
    first, parts = len(scene.particles), []
    for kind in scene.species:
        if kind.exact_temperature and kind.temperature and kind.count:
            parts.append((np.arange(first, first + kind.count), kind))
        first += kind.count
    if not parts:
        return
    masses = np.concatenate([np.full(kind.count, kind.mass) for _, kind in parts])
    chosen = np.concatenate([members for members, _ in parts])
    axes = [k for k, conserved in enumerate(scene.conserved_axes) if conserved]
    moving, total = velocities[chosen], math.fsum(masses)
    for k in axes:
        moving[:, k] -= math.fsum(masses * moving[:, k]) / total
    velocities[chosen] = moving
    for group in _apart([kind for _, kind in parts]):
        members = np.concatenate([parts[n][0] for n in group])
        kinds = [parts[n][1] for n in group]
        own, temperatures = (
            np.concatenate([np.full(kind.count, getattr(kind, key)) for kind in kinds])
            for key in ("mass", "temperature")
        )
        freedom = scene.dimension * len(members) - len(axes) * math.fsum(own) / total
        if freedom < 0.5:
            raise SceneError("exact_temperature", True, "needs two particles or more")
        energies = own / temperatures * (velocities[members] ** 2).T
        velocities[members] *= math.sqrt(freedom / math.fsum(energies.ravel()))


def _apart(kinds: Sequence[Species]) -> list[list[int]]:
    """Divide species into groups, as lists of indices; regions of different groups do not overlap."""
    groups: list[list[int]] = []
    for n, kind in enumerate(kinds):
        near = [group for group in groups if any(_overlap(kinds[m], kind) for m in group)]
        groups = [group for group in groups if group not in near]
        groups.append(sorted(sum(near, [n])))
    return sorted(groups)


def _overlap(one: Species, other: Species) -> bool:
    """Return True if the regions of two species overlap."""
    if one.region is None or other.region is None:
        return True
    sides = zip(*one.region, *other.region, strict=True)
    return all(max(low, begin) < min(high, end) for low, high, begin, end in sides)


def lattice(scene: Scene, rng: np.random.Generator, slab: bool = False) -> np.ndarray:
    """Return positions on a triangular (2D) or face-centred cubic (3D) lattice."""
    margin = np.array(scene.reach(scene.largest_radius)[0])
    walled = ~np.array(scene.container.periodic)
    lengths = np.array(scene.container.lengths) - 2 * margin * walled
    basis = np.array([[0, 0], [0.5, 0.5]]) if scene.dimension == 2 else _FCC
    shape = np.array([1.0, math.sqrt(3.0)]) if scene.dimension == 2 else np.ones(3)
    best = max(
        _cell_counts(lengths, shape, walled, scene.count, len(basis)),
        key=lambda cells: _spacing(lengths, cells, walled, basis),
    )
    spacing = _spacing(lengths, best, walled, basis)
    if spacing < 2 * scene.largest_radius:
        raise SceneError(
            "arrangement", "lattice",
            f"a spacing of {spacing:g} is too small for {scene.count} particles of this radius",
        )  # fmt: skip
    cells = np.stack(np.meshgrid(*(np.arange(n) for n in best), indexing="ij"), axis=-1)
    sites = (cells.reshape(-1, 1, scene.dimension) + basis).reshape(-1, scene.dimension)
    sites = margin * walled + sites * (lengths / _periods(best, walled, basis))
    spare = np.arange(len(sites))
    if slab:
        longest = int(np.argmax(scene.container.lengths))
        spare = np.flatnonzero(sites[:, longest] >= 0.5 * scene.container.lengths[longest])
        if len(spare) < len(sites) - scene.count:
            raise SceneError("arrangement", "slab", f"{scene.count} particles do not fill the crystal's half")
    empty = rng.permutation(spare)[: len(sites) - scene.count]
    chosen = np.setdiff1d(np.arange(len(sites)), empty, assume_unique=True)
    if len(scene.species) > 1 or not all(kind.alike for kind in scene.species):
        chosen = rng.permutation(chosen)
    return sites[chosen]


_FCC = np.array([[0.0, 0, 0], [0, 0.5, 0.5], [0.5, 0, 0.5], [0.5, 0.5, 0]])


def _periods(cells: np.ndarray, walled: np.ndarray, basis: np.ndarray) -> np.ndarray:
    """Return the number of lattice cells (d,) that fill the container. On an axis with walls, the last half
    cell contains no particles and is not counted.
    """
    return np.where(walled, np.maximum(cells - 1 + basis.max(axis=0), 0.5), cells)


def _spacing(lengths: np.ndarray, cells: np.ndarray, walled: np.ndarray, basis: np.ndarray) -> float:
    """Return the shortest distance between two sites."""
    edge = lengths / _periods(np.asarray(cells), walled, basis)
    diagonals = (basis[1:] * edge) if len(basis) > 1 else np.empty((0, len(edge)))
    return float(min(np.sqrt((diagonals**2).sum(axis=1)).min(), edge.min()))


def _cell_counts(
    lengths: np.ndarray, shape: np.ndarray, walled: np.ndarray, count: int, per_cell: int
) -> list[np.ndarray]:
    """Return possible numbers of cells (d,) with nearly ideal shape and at least `count` sites."""
    ideal = (lengths / shape) * (count / per_cell / np.prod(lengths / shape)) ** (1.0 / len(lengths))
    reach = np.stack(np.meshgrid(*([np.arange(-2, 4)] * len(lengths)), indexing="ij"), axis=-1)
    options = np.floor(ideal).astype(int) + reach.reshape(-1, len(lengths))
    options = options[(options > 0).all(axis=1) & (options.prod(axis=1) * per_cell >= count)]
    return list(options)
