"""Conditions on a scene under which an observable is defined.

Each function raises SceneError if its condition is not satisfied. The conditions are tested before a run and
again at the measurement, so both reject the same scenes. `selection` contains keyword arguments of the
observable's function: `species`, `particles`, `axis`, `at`, `lag`, `per_axis`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from gaspart.errors import SceneError
from gaspart.keys.values import count_of, number, one_of
from gaspart.scene.boundaries import refuse_sheared
from gaspart.scene.faces import Open
from gaspart.scene.facts import plain_mixture
from gaspart.scene.scene import Scene
from gaspart.scene.surfaces import FACES
from gaspart.scene.walls import MOVING_WALL
from gaspart.state.tally import StressTally

Selection = Mapping[str, Any]
GROUPS = 16
"""Number of groups of particles. The scatter between groups gives an uncertainty."""
SLIDING = "this observable is not defined where images of the particles slide"
VARYING = (
    "lets particles enter and leave, and this observable follows particles that stay; defined here are "
    "number, flux, density, velocity, temperature, pressure, force and heat_flux"
)
DISCS = "discs have no diffusion coefficient: their squared displacement grows like t ln t"
_NEIGHBOURHOOD = {2: 7, 3: 13}  # a particle and its nearest neighbours in a crystal


def refuse_shear(scene: Scene, selection: Selection) -> None:
    """Raise SceneError if faces of the container are sheared."""
    refuse_sheared(scene, SLIDING)


def steady_flow(scene: Scene, selection: Selection) -> None:
    """Require a steady flow, unless motion is measured relative to the resting container."""
    if scene.flow_changes and selection.get("about") != "rest":
        faces = [name for name, face in scene.faces.items() if face.moves] or MOVING_WALL
        rule = 'move the gas: motion about a flow that changes is not known from frames; pass about="rest"'
        raise SceneError("faces", faces, rule)


def require_open_faces(scene: Scene, selection: Selection) -> None:
    """Raise SceneError unless at least one face is open."""
    if not scene.is_open:
        raise SceneError(
            "faces", list(scene.faces), f"none is open: there are always {scene.count} particles"
        )


def open_across(scene: Scene, selection: Selection) -> None:
    """Require that the faces across all axes except the selected one are closed.

    Otherwise particles would enter and leave on both sides of a plane across the selected axis.
    """
    axis = walled_axis_of(scene, selection.get("axis"))
    for face, _ in scene.faces_of(Open):
        if face // 2 != axis:
            rule = f"is open: particles come and go on either side of a plane across {'xyz'[axis]}"
            raise SceneError(f"faces.{FACES[face]}", "open", rule)


def periodic(scene: Scene, selection: Selection) -> None:
    """Require a container without walls."""
    _periodic(scene, "this observable needs a periodic container; set boundary: periodic")


def periodic_virial(scene: Scene, selection: Selection) -> None:
    """Require a container without walls.

    With walls the pressure on the walls is measured instead.
    """
    _periodic(scene, "Z needs a periodic container; between walls measure pressure (wall_pressure)")


def _periodic(scene: Scene, rule: str) -> None:
    if not scene.is_periodic:
        raise SceneError("container.boundary", scene.container.boundary, rule)


def require_walls(scene: Scene, selection: Selection) -> None:
    """Raise SceneError unless the container has a wall."""
    if not scene.container.walls:
        rule = "has no walls: measure compressibility_factor (Z)"
        raise SceneError("container.boundary", scene.container.boundary, rule)


def thermal_walls(scene: Scene, selection: Selection) -> None:
    """Raise SceneError unless at least one face has a temperature."""
    if not scene.thermal_numbers:
        raise SceneError("faces", list(scene.faces), "none is at a temperature, and takes heat")


def dragged_walls(scene: Scene, selection: Selection) -> None:
    """Require thermal faces that slide, or a force that drives the gas along thermal faces."""
    if not scene.drags_faces:
        rule = "none is at a temperature and slides, or has a force along it: nothing drags them"
        raise SceneError("faces", list(scene.faces), rule)


def walled_axis(scene: Scene, selection: Selection) -> None:
    """Raise SceneError unless the selected axis has walls at both ends.

    If no axis is selected, at least one axis must have walls at both ends. If a plane across the axis is
    selected, it must lie in the container.
    """
    axis = walled_axis_of(scene, selection.get("axis"))
    at = selection.get("at")
    if at is not None:
        length = scene.container.lengths[axis]
        rule = f"must be within the container, from 0 to {length:g}"
        number("at", at, rule, above=0.0)
        if not at < length:
            raise SceneError("at", at, rule)


def walled_axis_of(scene: Scene, name: str | None) -> int:
    """Return the index of an axis from its name.

    Without a name, return the last axis with open faces or, if no face is open, the last axis with walls.

    Raises SceneError for an axis without walls and for an unknown name.
    """
    has_axis(scene, {"axis": name})
    walled = [axis for axis, periodic in enumerate(scene.container.periodic) if not periodic]
    axis = "xyz".index(name) if name is not None else max(scene.open_axes or walled, default=0)
    if axis not in walled:
        rule = "images pass a plane across a periodic axis; the velocity times the density is the flux"
        raise SceneError("axis", "xyz"[axis], rule)
    return axis


def elastic(scene: Scene, selection: Selection) -> None:
    """Require contacts that conserve energy."""
    if scene.restitution is not None:
        scene.restitution.refuse_loss("a gas that loses energy is in no equilibrium")


def fluctuates_or_shears(scene: Scene, selection: Selection) -> None:
    """Require a sheared gas, or contacts that conserve energy.

    Transport coefficients follow from fluctuations only in equilibrium.
    """
    if scene.shear_rate is None:
        elastic(scene, selection)


def homogeneous(scene: Scene, selection: Selection) -> None:
    """Require that all positions are equivalent: no walls, no interior walls, no fixed particles."""
    _periodic(scene, "this observable needs a periodic container; set boundary: periodic")
    _without_obstacles(
        scene,
        "make places unlike each other: g(r), contact values, S(k) and order are those of a homogeneous gas",
    )


def without_obstacles(scene: Scene, selection: Selection) -> None:
    """Require a scene without interior walls and without fixed particles.

    Interior walls and fixed particles would bear a part of the pressure.
    """
    _without_obstacles(scene, "carry a part of the pressure, which the virial of the particles does not have")


def _without_obstacles(scene: Scene, rule: str) -> None:
    if scene.walls:
        raise SceneError("walls", len(scene.walls), rule)
    if scene.has_fixed:
        raise SceneError("species.fixed", True, rule)


def some_move(scene: Scene, selection: Selection) -> None:
    """Raise SceneError if all particles are fixed."""
    if not _moving(scene):
        raise SceneError("species.fixed", True, "fixed particles do not collide")


def _moving(scene: Scene) -> int:
    """Return the number of particles that are not fixed."""
    return scene.moving_count


def thermal(scene: Scene, selection: Selection) -> None:
    """Require more than one particle, in a periodic container that conserves momentum."""
    if scene.dimension * _moving(scene) - sum(scene.conserved_axes) < 1:
        raise SceneError("count", _moving(scene), "too few moving particles for a temperature")


def of_species(scene: Scene, selection: Selection) -> None:
    """Require that every particle belongs to a species (no single particles)."""
    if scene.particles:
        rule = "pairs are those of species: there are single particles"
        raise SceneError("particles", len(scene.particles), rule)


def one_size_each(scene: Scene, selection: Selection) -> None:
    """Require that each species has a single size and that all species move."""
    for n, kind in enumerate(scene.species):
        if not kind.alike:
            rule = "a contact value is that of two sizes; measure pair_collision_rates"
            raise SceneError(f"species[{n}].polydispersity", kind.polydispersity, rule)
        if kind.fixed:
            rule = "contact values follow from the rates of free flight"
            raise SceneError(f"species[{n}].fixed", True, rule)


def require_particles(scene: Scene, selection: Selection) -> None:
    """Raise SceneError if too few particles are free to move.

    Without a selection, at least 16 particles must move. If a species is selected, at least one particle of
    the species must move. If particle numbers are selected, these particles must exist. A species and
    particles cannot be selected together.
    """
    chosen = {key: selection.get(key) for key in ("species", "particles")}
    if all(value is None for value in chosen.values()):
        _enough(scene)
        return
    if chosen["particles"] is not None:
        if chosen["species"] is not None:
            raise SceneError("species", chosen["species"], "excludes particles")
        numbers = [count_of("particles", index) for index in chosen["particles"]]
        if any(index >= scene.count for index in numbers):
            raise SceneError("particles", max(numbers), f"there are {scene.count}, numbered from 0")
        return
    if not _in_species(scene, chosen["species"]):
        raise SceneError("species", chosen["species"], "none of them moves")


def _enough(scene: Scene) -> None:
    if _moving(scene) < GROUPS:
        raise SceneError("count", _moving(scene), f"an error needs {GROUPS} moving particles or more")


def _in_species(scene: Scene, species: Any) -> int:
    """Count the moving particles of a species, identified by its number.

    All single particles have the number that follows the number of the last species.
    """
    kinds = len(scene.species) + bool(scene.particles)
    if count_of("species", species) >= kinds:
        raise SceneError("species", species, f"there are {kinds}, numbered from 0")
    members = scene.particles if species == len(scene.species) else (scene.species[species],)
    return sum(member.count for member in members if not member.fixed)


def has_species(scene: Scene, selection: Selection) -> None:
    """Raise SceneError if all particles, or all particles of the selected species, are fixed."""
    some_move(scene, selection)
    species = selection.get("species")
    if species is not None and not _in_species(scene, species):
        raise SceneError("species", species, "none of them moves")


def free_axis(scene: Scene, selection: Selection) -> None:
    """Raise SceneError unless at least one axis is periodic, or the user passes a lag."""
    if selection.get("lag") is None and not any(scene.container.periodic):
        rule = "has no periodic axis: displacements between walls are bounded, and there is no D but at a lag"
        raise SceneError("container.boundary", scene.container.boundary, rule)


def no_lasting_discs(scene: Scene, selection: Selection) -> None:
    """Require spheres, or discs whose momentum decays fast, unless the user passes a lag."""
    if selection.get("lag") is None and scene.dimension == 2 and any(scene.conserved_axes):
        raise SceneError("container.lengths", scene.container.lengths, DISCS)


def two_species(scene: Scene, selection: Selection) -> None:
    """Require exactly two species, both of which move."""
    if len(scene.species) != 2 or scene.particles:
        raise SceneError("species", len(scene.kinds), "mutual diffusion is that of two species")
    if any(kind.fixed for kind in scene.species):
        raise SceneError("species", "fixed", "mutual diffusion is that of two species that move")


def a_pair(scene: Scene, selection: Selection) -> None:
    """Require at least two particles."""
    if scene.count < 2:
        raise SceneError("count", scene.count, "a pair needs two particles")


def a_neighbourhood(scene: Scene, selection: Selection) -> None:
    """Require at least 7 discs or 13 spheres, so that each particle has enough neighbours."""
    least = _NEIGHBOURHOOD[scene.dimension]
    if scene.count < least:
        raise SceneError("count", scene.count, f"needs {least} particles or more")


def smooth_sizes(scene: Scene, selection: Selection) -> None:
    """Require smooth elastic particles, and a single size for each species of a mixture."""
    plain_mixture(scene)
    in_species(scene, selection)


def in_species(scene: Scene, selection: Selection) -> None:
    """Require equal particles, or species that each have a single size."""
    if scene.alike:
        return
    if scene.particles:
        rule = "are of no species: this observable of a mixture is that of its species"
        raise SceneError("particles", len(scene.particles), rule)
    for n, kind in enumerate(scene.species):
        if not kind.alike:
            rule = "has many sizes: this observable of a mixture is that of species of one size"
            raise SceneError(f"species[{n}].polydispersity", kind.polydispersity, rule)


def has_axis(scene: Scene, selection: Selection) -> None:
    """Raise SceneError if the selected axis does not exist."""
    if selection.get("axis") is not None:
        one_of("axis", selection["axis"], tuple("xyz"[: scene.dimension]))


def require_stress(scene: Scene, selection: Selection) -> None:
    """Raise SceneError unless the container is periodic and only collisions change velocities."""
    StressTally().check(scene)


def shears(scene: Scene, selection: Selection) -> None:
    """Raise SceneError if the shear rate is 0."""
    if scene.shear_rate == 0.0:
        raise SceneError("shear_rate", scene.shear_rate, "gives no response")


def heat_flows(scene: Scene, selection: Selection) -> None:
    """Raise SceneError unless the scene has a cause of a heat flux.

    Causes of a heat flux are temperature differences, moving faces, and sources or sinks of energy.
    """
    heated = scene.dissipates or scene.thermostat is not None or _flows(scene)
    if (
        len(scene.face_temperatures) < 2
        and not heated
        and not any(face.moves for face in scene.faces.values())
    ):
        raise SceneError("faces", list(scene.faces), "have one temperature: the heat flux is 0 on average")


def velocity_flows(scene: Scene, selection: Selection) -> None:
    """Require a cause of flow.

    Causes of flow are sliding faces, sheared images, a force along faces, and open faces with different
    states.
    """
    if not _flows(scene) and not _streams(scene):
        raise SceneError("faces", list(scene.faces), "nothing drives a flow: the mean velocity is 0")


def _flows(scene: Scene) -> bool:
    periodic = scene.container.periodic
    along = any(g and around for g, around in zip(scene.gravity or (), periodic, strict=False))
    return bool(along or scene.shear_rate or scene.sliding_faces)


def streams(scene: Scene, selection: Selection) -> None:
    """Require open faces with different states, so that particles flow between them.

    Otherwise the mean flux of particles is zero.
    """
    if not _streams(scene):
        rule = "the net flux between walls is 0 in a steady state"
        raise SceneError("container.boundary", scene.container.boundary, rule)


def _streams(scene: Scene) -> bool:
    return len({(face.activity, face.temperature) for _, face in scene.faces_of(Open)}) > 1
