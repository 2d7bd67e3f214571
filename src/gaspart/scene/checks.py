"""Checks of the parts of a scene against each other: features, walls, faces, and drives."""

from __future__ import annotations

import math

from gaspart.errors import SceneError, unknown_word
from gaspart.keys.values import finite_vector, size
from gaspart.scene.boundaries import attempt_rate
from gaspart.scene.container import Container
from gaspart.scene.faces import FACE_KINDS, GRADIENT, LeesEdwards, Open, Piston, Vibrating
from gaspart.scene.facts import Facts
from gaspart.scene.features import EXCLUDED, FEATURES
from gaspart.scene.species import Particle, Species
from gaspart.scene.surfaces import FACES, Sticky, Thermal, Well
from gaspart.scene.walls import WALL_RULE, Plate, Wall, crossed_axis, wall_kind

# maximum length of the longest side, in diameters: contacts are then accurate to a thousandth of a diameter
_RESOLVED = 1e12
_ROOM = 1e-6  # minimum clearance of a particle between two walls, in radii
_SUM = 1e-12  # relative tolerance for rounding of the sum of all volumes


def check_features(scene: Facts) -> None:
    """Raise SceneError if two features of a scene exclude each other."""
    present = scene.features
    for (name, other), reason in EXCLUDED.items():
        if name in present and other in present:
            raise FEATURES[name].refuse(scene, f"excludes {FEATURES[other].meaning}: {reason}")


def check_room(container: Container, centres_to_walls: bool, key: str, particle: Particle | Species) -> None:
    """Raise SceneError, with `key`, if a particle does not fit into the container. SceneError is also raised
    for a particle that is not fixed but has no room to move, and for a particle so small that rounding would
    hide its contacts.
    """
    radius = particle.largest_radius
    shortest, longest = min(container.lengths), max(container.lengths)
    if not centres_to_walls:
        if 2 * radius > shortest:
            rule = f"is too large for the container, whose shortest side is {shortest:g}"
            raise SceneError(key, radius, rule)
        walled = zip(container.lengths, container.periodic, strict=True)
        narrow = any(2 * radius * (1.0 + _ROOM) > length for length, periodic in walled if not periodic)
        if narrow and not particle.fixed:
            rule = "leaves no room between two walls, which it would hit infinitely often in no time"
            raise SceneError(key, radius, rule)
    if 2 * particle.smallest_radius * _RESOLVED < longest:
        radius = particle.smallest_radius
        rule = f"is too small to resolve contacts in a container whose longest side is {longest:g}"
        raise SceneError(key, radius, rule)


def check_region(container: Container, key: str, kind: Species) -> None:
    """Raise SceneError, with `key`, for an invalid region of a species. The region must be a box inside the
    container that is large enough for one of its particles.
    """
    if kind.region is None:
        return
    lower, upper = (
        finite_vector(f"{key}[{n}]", corner, container.dimension) for n, corner in enumerate(kind.region)
    )
    for low, high, length in zip(lower, upper, container.lengths, strict=True):
        if low < 0.0 or high > length:
            raise SceneError(key, kind.region, "must lie inside the container")
        if not high - low > 2.0 * kind.largest_radius:
            raise SceneError(
                key, kind.region, f"has no room for a particle of radius {kind.largest_radius:g}"
            )


def check_packing(scene: Facts) -> None:
    """Raise SceneError for more particles than the container can hold."""
    if not scene.centres_to_walls and scene.packing_fraction > scene.closest_packing * (1.0 + _SUM):
        raise SceneError("packing_fraction", scene.packing_fraction, "exceeds close packing")


# Interior walls.


def check_walls(scene: Facts) -> None:
    """Raise SceneError for an interior wall that does not fit into the scene."""
    for n, wall in enumerate(scene.walls):
        if not isinstance(wall, wall_kind(scene.container)):
            raise SceneError(f"walls[{n}]", wall, WALL_RULE)
        if scene.centres_to_walls:
            raise SceneError(
                "centres_to_walls", True, "excludes interior walls, which stop surfaces of particles"
            )
        for key, point in wall.corners.items():
            inside = zip(point, scene.container.lengths, strict=True)
            if not all(0.0 <= x <= length for x, length in inside):
                raise SceneError(f"walls[{n}].{key}", point, "must lie inside the container")
    check_moving_wall(scene)


def check_moving_wall(scene: Facts) -> None:
    """Raise SceneError unless a moving wall spans the container and is the only wall."""
    for n, wall in enumerate(scene.walls):
        if wall.mass is None:
            continue
        key, lengths = f"walls[{n}].mass", scene.container.lengths
        if len(scene.walls) > 1:
            raise SceneError(key, wall.mass, "must be the only interior wall, since it moves")
        if wall.temperature is not None:
            raise SceneError(
                key, wall.mass, "excludes a temperature; a wall that moves is smooth and elastic"
            )
        axis = crossed_axis(wall, lengths)
        if axis < 0:
            rule = "a wall that moves must reach across the whole container, at right angles to an axis"
            raise SceneError(key, wall.mass, rule)
        if scene.container.periodic[axis]:
            rule = f"a wall that moves needs walls across {'xyz'[axis]}, along which it does"
            raise SceneError(key, wall.mass, rule)


# Faces.


def check_faces(scene: Facts) -> None:
    """Raise SceneError for faces that this scene cannot have."""
    if not isinstance(scene.faces, dict):
        raise SceneError("faces", scene.faces, "must be a mapping of faces to their kinds")
    names = FACES[: 2 * scene.dimension]
    for name, surface in scene.faces.items():
        if name not in names:
            value = getattr(surface, "kind", surface)
            raise SceneError(f"faces.{name}", value, unknown_word(name, names, "face"))
        if type(surface) not in FACE_KINDS.values():
            *others, last = (kind.__name__ for kind in FACE_KINDS.values())
            raise SceneError(f"faces.{name}", surface, f"must be {', '.join(others)} or {last}")
        axis = names.index(name) // 2
        if isinstance(surface, LeesEdwards):
            _check_sheared(scene, name, surface)
            continue
        if scene.container.periodic[axis]:
            raise SceneError(f"faces.{name}", surface.kind, "needs walls; a periodic axis has no faces")
        if isinstance(surface, Thermal) and surface.velocity is not None:
            _check_velocity(scene, name, surface.velocity)
        if isinstance(surface, Thermal) and surface.varies_along is not None:
            _check_ramp(scene, name, surface, surface.varies_along)
        if isinstance(surface, (Well, Sticky)) and scene.gravity is not None and scene.gravity[axis] != 0.0:
            raise SceneError(f"faces.{name}", surface.kind, "needs an axis without gravity")
        if isinstance(surface, Well):
            low, high = scene.reach(scene.largest_radius)
            both = (scene.faces.get(names[2 * axis + side]) for side in (0, 1))
            if sum(face.width for face in both if isinstance(face, Well)) >= high[axis] - low[axis]:
                rule = "leaves no room outside the wells of this axis for the largest particle"
                raise SceneError(f"faces.{name}.width", surface.width, rule)
        if isinstance(surface, Vibrating):
            _check_vibrating(scene, name, surface)
        if isinstance(surface, Piston):
            _check_piston(scene, name, surface)
    _check_room(scene)


def _check_sheared(scene: Facts, name: str, surface: LeesEdwards) -> None:
    """Raise SceneError if a sheared face is not y_high, or the container has walls."""
    if name != FACES[2 * GRADIENT + 1]:
        rule = (
            "must be stated for y_high, which includes y_low; the flow is along x, with its gradient along y"
        )
        raise SceneError(f"faces.{name}", surface.kind, rule)
    if not scene.is_periodic:
        raise SceneError(f"faces.{name}", surface.kind, "needs a container that is periodic along all axes")
    size(f"faces.{name}.shear_rate", surface.shear_rate * scene.container.lengths[GRADIENT])


def _check_velocity(scene: Facts, name: str, velocity: tuple[float, ...]) -> None:
    """Raise SceneError for a velocity that is not parallel to the face."""
    finite_vector(f"faces.{name}.velocity", velocity, scene.dimension)
    if velocity[FACES.index(name) // 2] != 0.0:
        rule = "must have no component across the face, which stays in its place"
        raise SceneError(f"faces.{name}.velocity", velocity, rule)


def _check_ramp(scene: Facts, name: str, surface: Thermal, axis: int) -> None:
    """Raise SceneError if a temperature varies along the face's normal or along a periodic axis."""
    key = f"faces.{name}.temperature"
    if axis == FACES.index(name) // 2:
        raise SceneError(key, surface.temperature, "must vary along the face, not across it")
    if axis >= scene.dimension or scene.container.periodic[axis]:
        raise SceneError(key, surface.temperature, f"needs walls across {'xyz'[axis]}, where it has its ends")


def _check_piston(scene: Facts, name: str, surface: Piston) -> None:
    """Raise SceneError for a second piston, or a piston that moves too fast. The speed may be prescribed, or
    result from the external pressure.
    """
    if len(scene.pistons) > 1:
        raise SceneError("faces", [FACES[n] for n, _ in scene.pistons], "must include at most one piston")
    size(f"faces.{name}.mass", surface.acceleration(scene, FACES.index(name) // 2))
    size(f"faces.{name}.speed", surface.speed or 0.0)


def _check_vibrating(scene: Facts, name: str, surface: Vibrating) -> None:
    """Raise SceneError for obstacles against which a vibrating face would squeeze a particle."""
    axis, upper = FACES.index(name) // 2, FACES.index(name) % 2 == 1
    length = scene.container.lengths[axis]
    clear = 2.0 * (surface.amplitude + scene.largest_radius)
    for n, species in enumerate(scene.species):
        if species.fixed and species.count:
            rule = f"must not be true where {name} vibrates: give fixed particles positions, in `particles`"
            raise SceneError(f"species[{n}].fixed", True, rule)
    for n, particle in enumerate(scene.particles):
        x = finite_vector(f"particles[{n}].position", particle.position, scene.dimension)[axis]
        if particle.fixed and (length - x if upper else x) < clear + particle.radius:
            rule = f"leaves less than a largest diameter between the particle and {name}, which vibrates"
            raise SceneError(f"particles[{n}].position", particle.position, rule)
    for n, wall in enumerate(scene.walls):
        heights = [length - corner[axis] if upper else corner[axis] for corner in wall.corners.values()]
        if min(heights) < clear and not (min(heights) <= 0.0 and _is_upright(wall, axis)):
            rule = f"leaves less than a largest diameter between the wall and {name}, which vibrates"
            raise SceneError(f"walls[{n}]", wall, rule)


def _is_upright(wall: Wall | Plate, axis: int) -> bool:
    """Return True if a wall is perpendicular to the faces across an axis."""
    corners = list(wall.corners.values())
    edges = [[b - a for a, b in zip(corners[0], corner, strict=True)] for corner in corners[1:3]]
    upright = [not any(edge[:axis] + edge[axis + 1 :]) for edge in edges]
    return any(upright) and all(
        stands or edge[axis] == 0.0 for stands, edge in zip(upright, edges, strict=True)
    )


def _check_room(scene: Facts) -> None:
    """Raise SceneError if vibrating faces leave too little space."""
    moving = {name: face for name, face in scene.faces.items() if isinstance(face, Vibrating)}
    low, high = scene.reach(scene.largest_radius)
    fraction = 1.0
    for axis in range(scene.dimension):
        own = {name: face for name, face in moving.items() if FACES.index(name) // 2 == axis}
        stroke = sum(2.0 * face.amplitude for face in own.values())
        if own and stroke >= high[axis] - low[axis]:
            name, face = next(iter(own.items()))
            rule = "leaves no room for the largest particle"
            raise SceneError(f"faces.{name}.amplitude", face.amplitude, rule)
        fraction *= 1.0 - stroke / scene.container.lengths[axis]
    if moving and scene.packing_fraction > fraction * scene.closest_packing:
        rule = "exceeds close packing where the faces have moved inwards"
        raise SceneError("packing_fraction", scene.packing_fraction, rule)


MOST_ATTEMPTS = 1e12
"""Maximum number of attempts to enter in the time in which a particle of the reservoir crosses the container.
"""


def check_open_faces(scene: Facts) -> None:
    """Raise SceneError if a scene with open faces has a feature that open faces exclude. Only scenes with
    open faces are checked.
    """
    for number, reservoir in scene.faces_of(Open):
        face = f"faces.{FACES[number]}"
        if reservoir.activity is not None and not scene.centres_to_walls:
            rule = "lets centres of particles enter: needs centres_to_walls: true, or no activity (a vacuum)"
            raise SceneError(f"{face}.activity", reservoir.activity, rule)
        if len(scene.species) != 1 or scene.particles or not scene.count:
            raise SceneError(face, "open", "needs particles of one species, and no single ones")
        _check_attempts(scene, number, reservoir)


def _check_attempts(scene: Facts, number: int, face: Open) -> None:
    """Raise SceneError for a reservoir whose particles attempt too often to enter. Above this number of
    attempts, simulated time would practically not advance.
    """
    speed = math.sqrt((face.temperature or 0.0) / scene.species[0].mass)
    if speed:
        attempts = attempt_rate(scene, number, face) * scene.container.lengths[number // 2] / speed
        if not attempts <= MOST_ATTEMPTS:
            rule = (
                f"must let at most {MOST_ATTEMPTS:g} particles try to enter "
                f"while one of them crosses the container, not {attempts:.2g}"
            )
            raise SceneError(f"faces.{FACES[number]}.activity", face.activity, rule)


# Forces along periodic axes.


_MOMENTUM = (
    "fixed particles, interior walls across it, rough contacts with walls, or faces or walls at a temperature"
)
_ENERGY = "inelastic contacts, or faces or walls at a temperature"


def check_driven(scene: Facts) -> None:
    """Raise SceneError if a force along a periodic axis would accelerate the gas forever. The scene must have
    a sink for the momentum that the force adds, and a sink for the energy that it adds.
    """
    for axis in scene.driven_axes:
        for has_sink, quantity, by in (
            (_takes_momentum(scene, axis), "momentum", _MOMENTUM),
            (_takes_energy(scene), "energy", _ENERGY),
        ):
            if not has_sink:
                rule = (
                    f"gives energy without limit along {'xyz'[axis]}, a periodic axis, where nothing takes "
                    f"the {quantity}: {by} would"
                )
                raise SceneError("gravity", scene.gravity, rule)


def _takes_momentum(scene: Facts, axis: int) -> bool:
    """Return True if particles exchange momentum along a periodic axis with other objects. The other objects
    are fixed particles, interior walls and faces of the container.
    """
    if scene.has_fixed:
        return True
    length = scene.container.lengths[axis]
    if any(wall.temperature or not _spans(wall, axis, length) for wall in scene.walls):
        return True
    surfaces = bool(scene.walls) or not scene.is_periodic
    return (scene.rough and surfaces) or not all(face.smooth for face in scene.faces.values())


def _takes_energy(scene: Facts) -> bool:
    """Return True if contacts lose energy, or faces or walls at a temperature exchange energy."""
    return scene.dissipates or bool(scene.face_temperatures)


def _spans(wall: Wall | Plate, axis: int, length: float) -> bool:
    """Return True if a wall spans the container along an axis. No particle then hits the ends of the wall
    along this axis.
    """
    first, *others = wall.corners.values()
    edges = ([b - a for a, b in zip(first, corner, strict=True)] for corner in others)
    return any(abs(edge[axis]) >= length and not any(edge[:axis] + edge[axis + 1 :]) for edge in edges)
