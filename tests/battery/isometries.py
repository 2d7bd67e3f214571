"""The same run seen otherwise: shifted, mirrored, with its axes exchanged, its particles renumbered, from a
moving frame. Each is applied to a scene, to a state, to the variables of a file, and to a result."""

import json
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

import gaspart as gp
from gaspart.analysis import declaration
from gaspart.analysis.declaration import Along
from gaspart.yaml_text import dump_yaml, parse_yaml

AXES = "xyz"


@dataclass(frozen=True)
class View:
    """The new component k of a vector is signs[k] times the old one order[k]; shift: of positions, in the
    new axes, in sides of the container; velocity: of the old frame in the new one. renumbered: the order of
    species is the reverse one, and within each the odd numbers come first."""

    order: tuple[int, ...] = (0, 1, 2)
    signs: tuple[float, ...] = (1.0, 1.0, 1.0)
    shift: tuple[float, ...] = (0.0, 0.0, 0.0)
    velocity: tuple[float, ...] = (0.0, 0.0, 0.0)
    renumbered: bool = False

    def vectors(self, values):
        """Vectors (..., 3)."""
        return np.array(self.signs) * np.asarray(values)[..., list(self.order)]

    def axis(self, old):
        """The new number of an old axis."""
        return self.order.index(old)

    def faces(self):
        """(6,) the old numbers of the new faces."""
        return [2 * old + (end if sign > 0.0 else 1 - end)
                for old, sign in zip(self.order, self.signs, strict=True) for end in (0, 1)]  # fmt: skip


def container_seen(scene, view):
    """The container from another view."""
    container = scene.container
    boundary = container.boundary
    if not isinstance(boundary, str):
        boundary = tuple(boundary[k] for k in view.order)
    return gp.Container(tuple(container.lengths[k] for k in view.order), boundary)


def seen(scene, view):
    """The scene from another view."""
    old = [f"{a}_{end}" for a in AXES for end in ("low", "high")]
    faces = {old[new]: _face(scene.faces[old[was]], view) for new, was in enumerate(view.faces())
             if old[was] in scene.faces}  # fmt: skip
    if scene.shear_rate is not None:  # the face and its images are one
        faces = {"y_high": replace(scene.faces["y_high"], shear_rate=_rate(scene, view))}
    gravity = None if scene.gravity is None else tuple(view.vectors(scene.gravity).tolist())
    species = scene.species[::-1] if view.renumbered else scene.species
    return replace(
        scene,
        container=container_seen(scene, view),
        faces=faces,
        gravity=gravity,
        species=species,
        walls=[_wall(scene, view, wall) for wall in scene.walls],
    )


def _face(face, view):
    """A face from another view: one that slides does so at another velocity, and one at rest may slide. A
    temperature that varies does so from one end to the other."""
    velocity = getattr(face, "velocity", None)
    if isinstance(getattr(face, "temperature", None), dict):
        names = [f"{a}_{end}" for a in AXES for end in ("low", "high")]
        ends = {new: names[was] for new, was in zip(names, view.faces(), strict=True)}
        varies = {new: face.temperature[was] for new, was in ends.items() if was in face.temperature}
        face = replace(face, temperature=varies)
    if velocity is None:
        return face
    return replace(face, velocity=tuple((view.vectors(velocity) + view.velocity).tolist()))


def _wall(scene, view, wall):
    """A plate from another view; one that reaches across the container still does."""
    lengths = container_seen(scene, view).lengths
    corner, edges = positions_seen(scene, view, np.array(wall.corner)), view.vectors(wall.edges)
    for edge in edges:
        whole = np.abs(edge) == lengths
        corner[whole], edge[whole] = 0.0, np.abs(edge[whole])
    return replace(wall, corner=tuple(corner.tolist()), edges=tuple(map(tuple, edges.tolist())))


def _rate(scene, view):
    """The shear rate from a view in which the flow is along x still."""
    return scene.shear_rate * view.signs[0] * view.signs[1]


def particles_of(scene, view, count=None):
    """(N,) the old numbers of the particles; of so many of them, where they come and go."""
    ends = np.cumsum([kind.count for kind in scene.species])
    numbers = np.split(np.arange(count or scene.capacity), ends[:-1])
    if view.renumbered:
        numbers = [np.concatenate([part[1::2], part[::2]]) for part in numbers[::-1]]
    return np.concatenate(numbers)


def positions_seen(scene, view, positions, time=0.0):
    """Positions (..., N, 3) inside the container; time: (..., 1, 1)."""
    new = container_seen(scene, view)
    lengths, periodic = np.array(new.lengths), np.array(new.periodic)
    start = np.where(np.array(view.signs) < 0.0, lengths, 0.0) + np.array(view.shift) * lengths
    places = start + view.vectors(positions) + np.array(view.velocity) * time
    return np.where(periodic, np.where(periodic, places, 0.0) % lengths, places)


def state_seen(scene, view, state):
    """A state at time 0 from another view."""
    order, other = particles_of(scene, view, state.count), seen(scene, view)
    faces = {}
    if state.shear_rate is not None:
        faces["shear_rate"] = other.shear_rate
    if state.piston_face is not None:
        parts = zip(("piston_position", "piston_velocity"), state.piston, strict=True)
        faces["piston"] = np.array([_piston(scene, view, *part) for part in parts])
        pistons = [name for name, face in other.faces.items() if face.kind == "piston"]
        faces["piston_face"] = pistons[0] if pistons else state.piston_face
    per_particle = ("radii", "masses", "moments_of_inertia", "spins")
    return replace(
        state,
        positions=positions_seen(scene, view, state.positions[order]),
        velocities=view.vectors(state.velocities[order]) + np.array(view.velocity),
        images=np.zeros_like(state.images),
        lengths=np.array(other.container.lengths),
        **{name: getattr(state, name)[order] for name in per_particle},
        **faces,
    )


_INVARIANT = {(), ("lag",), ("shell",)}
"""What all dimensions but that of frames may be of a number that is the same from every view."""


def data_seen(data, view):
    """A trajectory, in memory, from another view."""
    scene = gp.Scene.from_dict(parse_yaml(data.attrs["scene"]))
    time = data["time"].values[:, None, None]
    order = particles_of(scene, view)
    changed = {}
    for name, variable in data.data_vars.items():
        along = tuple(dim for dim in variable.dims if dim != "frame")
        values = variable.values
        if name == "coordinates":
            values = positions_seen(scene, view, values[:, order], time)
        elif along == ("atom", "spatial"):
            moved = view.vectors(values[:, order])
            drift = {"velocities": 1.0, "displacements": time}[name]
            values = moved + np.array(view.velocity) * drift
        elif along == ("face",):
            values = values[:, _surfaces(view, values)]
        elif along == ("face", "axis"):
            values = view.vectors(values[:, _surfaces(view, values)])
        elif along == ("axis",):
            values = view.vectors(values) + (np.array(view.velocity) if name == "flux_velocity" else 0.0)
        elif along == ("axis", "direction"):
            values = view.vectors(view.vectors(values).swapaxes(1, 2)).swapaxes(1, 2)
        elif along == ("pair",):
            values = values[:, pairs_seen(scene, view)]
        elif along == ("species", "bin"):
            values = _flux_seen(scene, view, values, tallied_axis(data), data["time"].values)
        elif along == ("cell_spatial",):
            values = values[:, list(view.order)]
        elif name.startswith("piston"):
            values = _piston(scene, view, name, values)
        elif along not in _INVARIANT and along != ("cell_angular",):
            raise NotImplementedError(f"{name}: how do dimensions {along} change?")
        changed[name] = (variable.dims, values, variable.attrs)
    new = seen(scene, view)
    result = data.assign(changed).assign_attrs(scene=dump_yaml(new.to_dict()))
    if "momentum_flux_sum" in data:
        tally = json.loads(data.attrs["tallies"])[0] | {"axis": AXES[view.axis(tallied_axis(data))]}
        result = result.assign_attrs(tallies=json.dumps([tally]))
    numbers = data["type"].values
    result = result.assign_coords(
        radius=("atom", data["radius"].values[order], data["radius"].attrs),
        type=("atom", numbers.max() - numbers[order] if view.renumbered else numbers, data["type"].attrs),
    )
    return _energies_seen(result, data, scene, view)


def _surfaces(view, values):
    """The old numbers of the faces and of the interior walls of values (T, surfaces, ...)."""
    return [*view.faces(), *range(2 * len(AXES), values.shape[1])]


def _energies_seen(result, data, scene, view):
    """With what a moving frame adds to energies: of particles, and what slides with the frame takes."""
    if not any(view.velocity):
        return result
    velocity = np.array(view.velocity)
    masses = np.concatenate([np.full(kind.count, kind.mass) for kind in seen(scene, view).species])
    momentum = np.einsum(
        "tnk,n->tk", view.vectors(data["velocities"].values[:, particles_of(scene, view)]), masses
    )
    more = momentum @ velocity + 0.5 * masses.sum() * velocity @ velocity
    added = {"kinetic_energy": (data["kinetic_energy"].dims, data["kinetic_energy"].values + more)}
    if "wall_shear" in data:
        added["wall_energy"] = (
            data["wall_energy"].dims,
            result["wall_energy"].values + result["wall_shear"].values @ velocity,
        )
    return result.assign({name: (dims, values, data[name].attrs) for name, (dims, values) in added.items()})


def tallied_axis(data):
    """The number of the axis along which a trajectory has impulses."""
    return AXES.index(json.loads(data.attrs["tallies"])[0]["axis"])


def _flux_seen(scene, view, values, axis, time):
    """Momentum (T, species, bins) that has flown through planes; along a periodic axis up to a constant.
    What is counted from below has no part of gravity on the particles above, and has it from above."""
    new = view.axis(axis)
    if view.velocity[new]:
        raise NotImplementedError("momentum along the axis of a moving frame")
    if view.signs[new] < 0.0:
        pull = 0.0 if scene.gravity is None else scene.gravity[axis]
        weights = np.array([kind.count * kind.mass * pull for kind in scene.species])
        values = (values + np.multiply.outer(time, weights)[:, :, None])[:, :, ::-1]
    values = np.roll(values, round(view.shift[new] * values.shape[2]), axis=2)
    return values[:, ::-1] if view.renumbered else values


def _piston(scene, view, name, values):
    """The place or the velocity of a piston along its axis."""
    axes = [AXES.index(face[0]) for face, it in scene.faces.items() if it.kind == "piston"]
    axis = axes[0] if axes else scene.moving_wall.axis
    sign = view.signs[view.axis(axis)]
    start = scene.container.lengths[axis] if name == "piston_position" and sign < 0.0 else 0.0
    return start + sign * values


def pairs_seen(scene, view):
    """(pairs,) the old numbers of the pairs of species."""
    kinds = len(scene.species)
    numbers, n = {}, 0
    for first in range(kinds):
        for second in range(first, kinds):
            numbers[first, second] = numbers[second, first] = n
            n += 1
    old = range(kinds)[::-1] if view.renumbered else range(kinds)
    return [numbers[old[first], old[second]] for first in range(kinds) for second in range(first, kinds)]


def result_seen(found, scene, view, cells):
    """A result from another view. cells: dimension -> the old number of the axis of its cells."""
    for dim in list(found.dims):
        along = DIMENSIONS[dim]
        if along.exchanged == "chosen":
            found = _cells_seen(found, dim, view, cells[dim])
        elif along.names:
            found = _names_seen(found, dim, along, scene, view)
    return found


_OF_CELLS = Along("place", "length", exchanged="chosen", mirrored="reversed", shifted="moved")
DIMENSIONS = {
    **declaration.DIMENSIONS,
    **dict.fromkeys(AXES, _OF_CELLS),
    "species": Along("number of a species", names=True, relabelled=True),
    "time": Along("time", "time"),
}
"""The dimensions of results, with those of fields, of the table of species and of the parts of a run."""


def _cells_seen(found, dim, view, old):
    """Values along an axis, of which fields have the name."""
    axis, along, places = view.axis(old), DIMENSIONS[dim], found[dim]
    if along.mirrored == "reversed" and view.signs[axis] < 0.0:
        found = found.isel({dim: slice(None, None, -1)})
    if along.shifted == "moved" and view.shift[axis]:
        found = found.roll({dim: round(view.shift[axis] * found.sizes[dim])})
    found = found.assign_coords({dim: places})
    return found if dim == "position" else found.rename({dim: f"new {AXES[axis]}"})


def _names_seen(found, dim, along, scene, view):
    """Values that have names: of axes, of faces, of components, of species."""
    names = found[dim].values.tolist()
    new = [_name_seen(name, along, scene, view) for name in names]
    if along.mirrored == "signs":
        signs = [np.prod([view.signs[AXES.index(letter)] for letter in name]) for name in new]
        sign = xr.DataArray(np.array(signs), dims=dim)
        kept = {
            name: (values * sign).assign_attrs(values.attrs)
            for name, values in found.data_vars.items()
            if not name.endswith(("_error", "_freedom"))
        }
        found = found.assign(kept)
    return found.assign_coords({dim: (dim, np.array(new), found[dim].attrs)})


def _name_seen(name, along, scene, view):
    """A name, such as "x low", "xy" or "0-1", from another view."""
    if along.relabelled:
        last = len(scene.species) - 1
        numbers = sorted(last - int(one) if view.renumbered else int(one) for one in str(name).split("-"))
        return numbers[0] if len(numbers) == 1 else "-".join(map(str, numbers))
    words = str(name).split()
    letters = [view.axis(AXES.index(letter)) for letter in words[0]]
    if along.mirrored == "ends" and view.signs[letters[0]] < 0.0:
        words[1] = {"low": "high", "high": "low"}[words[1]]
    words[0] = "".join(AXES[k] for k in letters) if along.exchanged == "names" else words[0]
    return " ".join(words)
