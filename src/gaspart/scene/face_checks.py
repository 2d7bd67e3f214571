"""Checks of faces that involve the rest of the scene, and particle numbers for open faces."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gaspart.errors import SceneError, unknown_word
from gaspart.keys.values import finite_vector, size
from gaspart.scene.faces import (
    FACE_KINDS,
    FACES,
    GRADIENT,
    LeesEdwards,
    Open,
    Piston,
    Sticky,
    Thermal,
    Vibrating,
    Well,
)
from gaspart.scene.limits import CLOSE_PACKING, ball_volume, closest_packing

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene
    from gaspart.scene.walls import Plate, Wall


def check_faces(scene: Scene) -> None:
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


def _check_sheared(scene: Scene, name: str, surface: LeesEdwards) -> None:
    """Raise SceneError if a sheared face is not y_high, or the container has walls."""
    if name != FACES[2 * GRADIENT + 1]:
        rule = (
            "must be stated for y_high, which includes y_low; the flow is along x, with its gradient along y"
        )
        raise SceneError(f"faces.{name}", surface.kind, rule)
    if not scene.is_periodic:
        raise SceneError(f"faces.{name}", surface.kind, "needs a container that is periodic along all axes")
    size(f"faces.{name}.shear_rate", surface.shear_rate * scene.container.lengths[GRADIENT])


def _check_velocity(scene: Scene, name: str, velocity: tuple[float, ...]) -> None:
    """Raise SceneError for a velocity that is not parallel to the face."""
    finite_vector(f"faces.{name}.velocity", velocity, scene.dimension)
    if velocity[FACES.index(name) // 2] != 0.0:
        rule = "must have no component across the face, which stays in its place"
        raise SceneError(f"faces.{name}.velocity", velocity, rule)


def _check_ramp(scene: Scene, name: str, surface: Thermal, axis: int) -> None:
    """Raise SceneError if a temperature varies along the face's normal or along a periodic axis."""
    key = f"faces.{name}.temperature"
    if axis == FACES.index(name) // 2:
        raise SceneError(key, surface.temperature, "must vary along the face, not across it")
    if axis >= scene.dimension or scene.container.periodic[axis]:
        raise SceneError(key, surface.temperature, f"needs walls across {'xyz'[axis]}, where it has its ends")


def _check_piston(scene: Scene, name: str, surface: Piston) -> None:
    """Raise SceneError for a second piston, or a piston that moves too fast.

    The speed may be prescribed, or result from the external pressure.
    """
    if len(scene.pistons) > 1:
        raise SceneError("faces", [FACES[n] for n, _ in scene.pistons], "must include at most one piston")
    size(f"faces.{name}.mass", surface.acceleration(scene, FACES.index(name) // 2))
    size(f"faces.{name}.speed", surface.speed or 0.0)


def piston_end(scene: Scene, position: float | None = None) -> float:
    """Return the time at which a piston of prescribed speed compresses the particles to closest packing.

    The result is infinite if the scene has no such piston.

    position : position along the axis of the piston at time 0. Default: the side of the container.
    """
    for number, face in scene.pistons:
        if face.speed is not None:
            axis, length = number // 2, scene.container.lengths[number // 2]
            low, high = scene.reach(scene.largest_radius)
            packed = length * scene.packing_fraction / closest_packing(scene)
            least = max(length - (high[axis] - low[axis]), packed)
            begin = 0.0 if position is None else length - position if number % 2 else position
            return max(0.0, length - begin - least) / face.speed
    return math.inf


def check_piston_end(scene: Scene, key: str, until: float, position: float | None = None) -> None:
    """Raise SceneError if a run would end, at `until`, later than `piston_end`.

    `key` names the setting of this end in the message.
    """
    end = piston_end(scene, position)
    if end < until:
        rule = f"must be before {end:.6g}, when the piston leaves no room for the particles"
        raise SceneError(key, until, rule)


def _check_vibrating(scene: Scene, name: str, surface: Vibrating) -> None:
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


def _check_room(scene: Scene) -> None:
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
    if moving and scene.packing_fraction > fraction * closest_packing(scene):
        rule = "exceeds close packing where the faces have moved inwards"
        raise SceneError("packing_fraction", scene.packing_fraction, rule)


# Open faces, through which particles leave and enter: requirements, and maximum number of particles.


MOST_ATTEMPTS = 1e12
"""Maximum number of attempts to enter in the time in which a particle of the reservoir crosses the container.
"""
_SIGMAS = 10.0  # allowance for the number of an ideal gas, in standard deviations


def check_open_faces(scene: Scene) -> None:
    """Raise SceneError if a scene with open faces has a feature that open faces exclude.

    Only scenes with open faces are checked.
    """
    for number, reservoir in scene.faces_of(Open):
        face = f"faces.{FACES[number]}"
        if reservoir.activity is not None and not scene.centres_to_walls:
            rule = "lets centres of particles enter: needs centres_to_walls: true, or no activity (a vacuum)"
            raise SceneError(f"{face}.activity", reservoir.activity, rule)
        if len(scene.species) != 1 or scene.particles or not scene.count:
            raise SceneError(face, "open", "needs particles of one species, and no single ones")
        _check_attempts(scene, number, reservoir)


def _check_attempts(scene: Scene, number: int, face: Open) -> None:
    """Raise SceneError for a reservoir whose particles attempt too often to enter.

    Above this number of attempts, simulated time would practically not advance.
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


def refuse_open(scene: Scene, rule: str) -> None:
    """Raise SceneError, with `rule` in its message, for a scene with open faces."""
    for number, face in scene.faces_of(Open):
        raise SceneError(f"faces.{FACES[number]}", face.kind, rule)


def number_density(scene: Scene, face: Open) -> float:
    """Return the number density of an ideal gas that would be in equilibrium with a reservoir.

    The density is 0 for a vacuum.
    """
    return (face.activity or 0.0) / ball_volume(scene.dimension, scene.species[0].radius)


def attempt_rate(scene: Scene, number: int, face: Open) -> float:
    """Return the number of particles per time that try to enter through a face.

    The rate through an open face of area A is z A (k_B T / 2 pi m)^(1/2), where z is the number density of
    the reservoir as an ideal gas. The argument `number` is the index of the face.
    """
    area = scene.container.volume / scene.container.lengths[number // 2]
    width = math.sqrt((face.temperature or 0.0) / scene.species[0].mass)
    return number_density(scene, face) * area * width / math.sqrt(2.0 * math.pi)


def mean_count(scene: Scene) -> float:
    """Return an upper bound of the mean number of particles between reservoirs.

    The bound is the mean number for an ideal gas at the same activity, or 0 if there is a vacuum behind every
    open face. Particles that repel each other are fewer than particles of an ideal gas. The pressure in the
    container is at most the pressure of the strongest reservoir. The gas is at least as hot as the coldest
    face or wall.
    """
    reservoirs = [face for _, face in scene.faces_of(Open) if face.temperature is not None]
    if not reservoirs:
        return 0.0
    pressure = max(number_density(scene, face) * (face.temperature or 0.0) for face in reservoirs)
    return pressure / min(scene.face_temperatures) * scene.container.volume


def capacity(scene: Scene) -> int:
    """Return the largest number of particles that the program provides for.

    Without open faces this is the number at the start. With reservoirs it is the mean number in equilibrium
    plus 10 standard deviations; the number of particles of an ideal gas has a Poisson distribution. The
    result never exceeds the number of particles that fit into the container.
    """
    mean = mean_count(scene)
    if mean == 0.0:
        return scene.count
    species, d = scene.species[0], scene.dimension
    most = scene.count + mean + _SIGMAS * math.sqrt(mean) + _SIGMAS
    around = math.prod(length + 2.0 * species.radius for length in scene.container.lengths)
    packed = CLOSE_PACKING[d] * around / ball_volume(d, species.radius)
    return max(scene.count, math.ceil(min(most, packed)))
