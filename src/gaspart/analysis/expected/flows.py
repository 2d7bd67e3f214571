"""Theory of steady states: mean velocity along an axis, and fluxes to walls.

The gas may be at rest, sheared, between sliding plates, or driven along plates by a force.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import reduce

import numpy as np

from gaspart import theory
from gaspart.analysis.expected.equilibrium import Expected, equation_of
from gaspart.analysis.run import Run
from gaspart.scene.boundaries import flow
from gaspart.scene.scene import Scene
from gaspart.scene.surfaces import Thermal
from gaspart.scene.walls import Plate
from gaspart.theory.bulk import BOLTZMANN
from gaspart.theory.heat import INTERPOLATED, TEMPERATURE_JUMP, interpolated_flux
from gaspart.theory.shear import VELOCITY_SLIP, channel_velocity, interpolated_stress

# Heat flux and shear stress of a gas between two thermal plates, from free molecular flow to the continuum.


FREE, FLUID = 100.0, 0.1
"""Knudsen number above which the gas counts as free-molecular, and Knudsen number below which it counts as a
continuum.
"""
_FIRST = 0.3
"""Upper estimate of the relative change of a free-molecular flux due to collisions, multiplied by the Knudsen
number. The sum of the resistances of both limits gives 0.27 for the heat flux of spheres, 0.18 for the heat
flux of discs, and 0.50 for a stress.
"""
_DILUTE = 0.02
"""Maximum packing fraction at which Enskog's coefficients and the equation of state apply to the gas."""
_POINTS = 1e-4
"""Factor by which diameters are scaled to model point particles. The mean free path is unchanged, but the
packing fraction becomes negligible.
"""
_EQUAL = 1e-12
_MOST = 0.25
"""Relative uncertainty above which no velocity in a channel is given: friction heats the gas."""
_PLAIN = {"thermal", "sliding", "accommodation", "centres_to_walls"}
"""Features that a scene of equal smooth elastic particles between plates may have."""


@dataclass(frozen=True)
class Plates:
    """Equal smooth and elastic particles between two thermal plates. A force may act along the plates.

    axis : axis normal to the plates.
    length : width of the gap that is accessible to particle centres.
    density : mean number density in this gap.
    temperatures : temperatures of the low and the high plate.
    slide : (d,), velocity of the high plate relative to the low one.
    components : velocity components that the plates change by drawing them at random.
    accommodation : accommodation coefficients of the low and the high plate.
    knudsen : Knudsen number: mean free path divided by the gap width.
    """

    axis: int
    length: float
    density: float
    dimension: int
    diameter: float
    mass: float
    temperatures: tuple[float, float]
    slide: np.ndarray
    components: str
    accommodation: tuple[float, float]
    knudsen: float

    @property
    def accommodating(self) -> bool:
        """True if both plates draw a new velocity at every hit; the continuum theory assumes this."""
        return min(self.accommodation) == 1.0

    @property
    def freedom(self) -> float:
        """Mean free path divided by the path between two hits at which new velocities are drawn. The plate
        with the smaller accommodation coefficient determines this ratio. If both plates draw a new velocity
        at every hit, the ratio is the Knudsen number.
        """
        return self.knudsen * min(self.accommodation)

    @property
    def equal(self) -> bool:
        """True if both plates have the same temperature."""
        low, high = self.temperatures
        return abs(low - high) <= _EQUAL * high

    @property
    def filled(self) -> float:
        """Packing fraction of the gas in the gap."""
        return float(theory.packing_fraction(self.density, self.dimension, self.diameter))


def heat_flux(run: Run, faces: np.ndarray) -> Expected | None:
    """Compute the steady heat (face,) that flows into the numbered `faces`, per area and time."""
    if _in_equilibrium(run):
        return Expected(np.zeros(len(faces)), 0.0, "equilibrium")
    plates = plates_of(run)
    if plates is None:
        return None
    if plates.slide.any():
        return _friction(plates, run)
    conduction = _heat_between_plates(plates, equation_of(run) == BOLTZMANN)
    if conduction is None:
        return None
    towards_high = 1.0 if plates.temperatures[0] > plates.temperatures[1] else -1.0
    return _times(conduction, np.where(faces % 2 == 1, towards_high, -towards_high))


def wall_shear(run: Run, faces: np.ndarray, axes: np.ndarray) -> Expected | None:
    """Compute the steady momentum (face, component along `axes`) that faces receive, per area and time."""
    if driven := _weight_on_faces(run, faces, axes):
        return driven
    plates = plates_of(run)
    if plates is None or not plates.equal or not plates.slide.any():
        return None
    stress = _stress_between_plates(plates, run)
    if stress is None:
        return None
    direction = plates.slide[axes] / np.hypot.reduce(plates.slide)
    signs = np.where(faces % 2 == 1, -1.0, 1.0)
    return _times(stress, np.multiply.outer(signs, direction))


def _times(expected: Expected, factors: np.ndarray) -> Expected:
    """Return a theory multiplied by factors."""
    share = None if expected.collisional is None else expected.collisional * factors
    return Expected(expected.value * factors, expected.error * np.abs(factors), expected.source, share)


def plates_of(run: Run, driven: bool = False) -> Plates | None:
    """Return the plates of a run, or None; if `driven`, only those along which a force drives the gas."""
    scene, thermal = run.scene, run.scene.faces_of(Thermal)
    numbers = [number for number, _ in thermal]
    if not scene.alike or scene.features - _PLAIN - {"gravity"} or not run.moving.all():
        return None
    pulled = {axis for axis, pull in enumerate(scene.gravity or ()) if pull != 0.0}
    if bool(pulled) != driven or pulled != set(scene.driven_axes):
        return None
    if len(numbers) != 2 or numbers[0] // 2 != numbers[1] // 2 or len(scene.faces) != 2:
        return None
    (_, low), (_, high) = thermal
    if low.components != high.components:
        return None
    axis, sides = numbers[0] // 2, np.subtract(*scene.reach(scene.largest_radius)[::-1])
    density, rest = run.count / float(sides.prod()), (0.0,) * run.dimension
    diameter = 2.0 * scene.largest_radius
    path = _free_path(density, diameter, run)
    return Plates(
        axis=axis,
        length=float(sides[axis]),
        density=density,
        dimension=run.dimension,
        diameter=diameter,
        mass=float(run.masses[0]),
        temperatures=(low.temperatures[0], high.temperatures[0]),
        slide=np.subtract(high.velocity or rest, low.velocity or rest),
        components=low.components,
        accommodation=(low.accommodation or 1.0, high.accommodation or 1.0),
        knudsen=path / float(sides[axis]),
    )


def _free_path(density: float, diameter: float, run: Run) -> float:
    """Return the mean free path of spheres for the equation of the run; 0 beyond the range of the theory."""
    if equation_of(run) == BOLTZMANN:
        scaled = density / _POINTS ** (run.dimension - 1)
        filled = theory.packing_fraction(scaled, run.dimension, diameter * _POINTS)
        return float(theory.mean_free_path(filled, run.dimension, diameter * _POINTS))
    filled = float(theory.packing_fraction(density, run.dimension, diameter))
    if filled > theory.HIGHEST_PACKING_FRACTION[run.dimension]:
        return 0.0
    return float(theory.mean_free_path(filled, run.dimension, diameter))


def _in_equilibrium(run: Run) -> bool:
    """Return True if all faces are at rest and have the same temperature."""
    return run.scene.has_equilibrium and len(run.scene.faces_of(Thermal)) == len(run.scene.faces)


def _heat_between_plates(plates: Plates, points: bool) -> Expected | None:
    """Compute the heat flux from the hot to the cold plate."""
    hot, cold = max(plates.temperatures), min(plates.temperatures)
    fractions = plates.accommodation if plates.temperatures[0] == hot else plates.accommodation[::-1]
    free = theory.free_molecular_flux(
        plates.density, hot, cold, plates.dimension, plates.mass, plates.components, fractions
    )
    at = f"Knudsen number {plates.knudsen:.2g}"
    if plates.freedom > FREE:
        error = float(free) * _FIRST / plates.freedom
        return Expected(float(free), error, f"free flight between plates, {at}", error)
    is_full = plates.components == "all" and plates.accommodating
    if plates.dimension == 2 or not is_full or not plates.knudsen > 0.0:
        return None
    unit, scale = 1.0 / math.sqrt(plates.mass), _POINTS if points else 1.0
    gap = (plates.length, plates.density / scale**2, hot, cold, plates.diameter * scale)
    if plates.knudsen > FLUID:
        flux = unit * scale**2 * interpolated_flux(*gap)
        return Expected(flux, flux * INTERPOLATED, f"{_describe_interpolation('heat')}, {at}")
    try:
        flux = unit * scale**2 * theory.conducting_slab(*gap).flux
    except ValueError:  # the theory's own estimate of the Knudsen number is slightly larger
        return None
    is_known = points or plates.filled < _DILUTE
    thinner = 3.0 * hot / (hot + math.sqrt(hot * cold) + cold)  # mean density over density at the hot plate
    error = flux * (thinner * plates.knudsen) ** 2 if is_known else math.nan
    return Expected(flux, error, f"Fourier's law with Enskog's conductivity and temperature jumps, {at}")


def _stress_between_plates(plates: Plates, run: Run) -> Expected | None:
    """Compute the shear stress on sliding plates that have the same temperature."""
    speed, temperature = float(np.hypot.reduce(plates.slide)), plates.temperatures[0]
    gas = plates.density, speed, temperature, plates.mass, plates.accommodation
    free = float(theory.free_molecular_stress(*gas))
    at = f"Knudsen number {plates.knudsen:.2g}"
    if plates.freedom > FREE:
        error = free * 2.0 * _FIRST / plates.freedom
        return Expected(free, error, f"free flight between plates, {at}", error)
    if plates.dimension == 2 or not plates.accommodating or not dilute(plates, run):
        return None
    unit = math.sqrt(plates.mass * temperature)
    gap = (plates.length, plates.density, speed, plates.diameter)
    if plates.knudsen > FLUID:
        stress = unit * float(interpolated_stress(*gap))
        return Expected(stress, stress * INTERPOLATED, f"{_describe_interpolation('stress')}, {at}")
    stress = unit * float(theory.slip_flow_stress(*gap))
    error = stress * (plates.knudsen**2 + heating_of(plates))
    return Expected(stress, error, f"Enskog's viscosity with slip, {at}")


def dilute(plates: Plates, run: Run) -> bool:
    """Return True if the transport coefficients of a dilute gas apply to the run."""
    return equation_of(run) == BOLTZMANN or plates.filled < _DILUTE


def heating_of(plates: Plates) -> float:
    """Compute the relative rise of the temperature midway between sliding plates by friction. For spheres the
    rise is 2/15 m u^2 in units of k_B T, where u is half of the relative speed of the plates.
    """
    square = float((plates.slide**2).sum())
    return plates.mass * square / (30.0 * max(plates.temperatures))


def _describe_interpolation(quantity: str) -> str:
    limits = {"heat": "free flight and Fourier's law", "stress": "free flight and Newton's law"}[quantity]
    return f"interpolation (Sherman) of {limits}, for Knudsen numbers from {FLUID:g} to {FREE:g}"


def _friction(plates: Plates, run: Run) -> Expected | None:
    """Compute the heat flux into each plate by friction: half of the power of the stress."""
    if not plates.equal or (stress := _stress_between_plates(plates, run)) is None:
        return None
    half = 0.5 * float(np.hypot.reduce(plates.slide))
    work = _times(stress, np.full(2, half))
    return work._replace(source=f"half the work of the stress: {stress.source}")


def _weight_on_faces(run: Run, faces: np.ndarray, axes: np.ndarray) -> Expected | None:
    """Compute the stress on two faces along which a force drives the gas. Each face bears half of the total
    force on the gas. The value is exact if all particles reach the same area of the faces, and if no other
    wall rubs the particles.
    """
    scene, driven = run.scene, run.scene.driven_axes
    equal = len(faces) == 2 and faces[0] // 2 == faces[1] // 2 and len(scene.faces) == 2
    if not driven or not equal or scene.has_obstacles or scene.has_unequal_areas:
        return None
    if scene.rough and len(scene.walled_axes) > 1:
        return None
    low, high = scene.faces.values()
    across = [g for axis, g in enumerate(scene.gravity or ()) if g and not run.periodic[axis]]
    if low != high or across:
        return None
    sides = np.subtract(*scene.reach(scene.largest_radius)[::-1])
    area = float(np.delete(sides, faces[0] // 2).prod())
    pull = np.where(run.periodic, scene.gravity or 0.0, 0.0)[axes] * float(run.masses.sum()) / (2.0 * area)
    return Expected(np.tile(pull, (2, 1)), 0.0, "balance of momentum", 0.0)


_ROUNDING = 1e-6
"""Relative drift that rounding of the frames can cause, as a fraction of the largest velocity."""


def velocity(run: Run, axis: int, positions: np.ndarray) -> Expected | None:
    """Compute the steady velocity (component, position) at positions (P,) along an axis."""
    scene = run.scene
    if scene.shear_rate is not None:
        middle = np.tile(0.5 * np.array(scene.container.lengths), (len(positions), 1))
        middle[:, axis] = positions
        return Expected(flow(scene, middle).T + _drift(run), 0.0, "the flow of sheared images", 0.0)
    if plates := plates_of(run):
        return _between_plates(plates, run, axis, positions)
    if plates := plates_of(run, driven=True):
        return _channel_velocity(plates, run, axis, positions)
    if scene.faces or scene.thermostat or run.dissipates or scene.driven_axes or scene.walls:
        return None
    if not run.moving.all():
        return None
    return Expected(np.repeat(_drift(run), len(positions), axis=1), 0.0, "equilibrium", 0.0)


def _drift(run: Run) -> np.ndarray:
    """Compute the velocity (d, 1) of the centre of mass, relative to a sheared flow; 0 if momentum is not
    conserved.
    """
    momentum, largest = np.zeros(run.dimension), 0.0
    for _, part in run.parts():
        velocities = part.velocities
        if run.scene.shear_rate is not None:
            velocities = velocities - flow(run.scene, part.positions)
        momentum += np.einsum("tnd,n->d", velocities, run.masses) / len(run.time)
        largest = max(largest, float(np.abs(velocities).max()))
    drift = momentum / run.masses.sum()
    seen = np.abs(drift) > _ROUNDING * largest
    return np.where(run.conserved & seen, drift, 0.0)[:, None]


def _between_plates(plates: Plates, run: Run, axis: int, positions: np.ndarray) -> Expected | None:
    """Compute the velocity between plates that have the same temperature or do not slide."""
    velocities = dict(run.scene.sliding_faces)
    ends = [velocities.get(2 * plates.axis + side) for side in (0, 1)]
    rest = (0.0,) * run.dimension
    low, high = (np.array(face.velocity if face else rest) for face in ends)
    mean = np.repeat(0.5 * (low + high)[:, None], len(positions), axis=1)
    if not plates.slide.any():
        return Expected(mean, 0.0, "the gas is at rest between the plates", 0.0)
    if not plates.equal or len(set(plates.accommodation)) > 1:
        return None
    if axis != plates.axis:
        return Expected(mean, 0.0, "the mean of both plates, by symmetry", 0.0)
    if plates.freedom > FREE:
        error = np.abs(plates.slide)[:, None] / plates.freedom
        source = "free flight between plates: half of the particles come from each"
        return Expected(mean, error, source, error)
    fluid = plates.accommodating and plates.knudsen <= FLUID and dilute(plates, run)
    if plates.dimension == 2 or not fluid:
        return None
    path = plates.knudsen * plates.length
    gap = plates.length + 2.0 * VELOCITY_SLIP * path
    middle = 0.5 * run.scene.container.lengths[axis]
    values = mean + np.multiply.outer(plates.slide, (positions - middle) / gap)
    wrong = np.abs(plates.slide)[:, None] * (plates.knudsen**2 + heating_of(plates))
    near = np.abs(positions - middle) > 0.5 * plates.length - 2.0 * path  # beyond is the Knudsen layer
    return Expected(np.where(near, np.nan, values), wrong, "linear flow with slip", values - mean)


def _channel_velocity(plates: Plates, run: Run, axis: int, positions: np.ndarray) -> Expected | None:
    """Compute the velocity of a gas that a force drives along resting, equally hot plates. The uncertainty
    includes the next order of the slip, the packing fraction, and half of the frictional heating of the gas.
    In units of k_B T, the heating in the middle is 4/45 m u^2, where u is the maximum velocity. The heating
    at the plates is 32/45 m u^2 times the temperature jump coefficient times the Knudsen number.
    """
    slow = not plates.slide.any() and plates.equal and axis == plates.axis
    if (
        not (slow and plates.accommodating)
        or plates.dimension == 2
        or not 0.0 < plates.knudsen <= FLUID
        or not dilute(plates, run)
    ):
        return None
    length, temperature = plates.length, plates.temperatures[0]
    from_middle = positions - 0.5 * run.scene.container.lengths[axis]
    near = np.abs(from_middle) > 0.5 * length - 2.0 * plates.knudsen * length
    heights = np.append(np.where(near, 0.0, from_middle), 0.0) + 0.5 * length  # heating in the middle
    speeds = channel_velocity(heights, length, plates.density, 1.0, plates.diameter)
    force = plates.mass * np.array(run.scene.gravity) / math.sqrt(plates.mass * temperature)
    values = np.multiply.outer(force, speeds)
    fastest = values[:, -1]
    warmer = plates.mass * float(fastest @ fastest) / temperature
    warmer *= 4.0 / 45.0 + 32.0 / 45.0 * TEMPERATURE_JUMP * plates.knudsen
    dense = 0.0 if equation_of(run) == BOLTZMANN else plates.filled
    part = 8.0 * plates.knudsen**2 + 0.5 * warmer + dense
    if part > _MOST:
        return None
    wrong = np.abs(fastest)[:, None] * part
    return Expected(np.where(near, np.nan, values[:, :-1]), wrong, "Poiseuille's flow with slip")


def flux(run: Run, axis: int, position: float, members: np.ndarray, beyond: np.ndarray) -> Expected | None:
    """Compute the net number (component,) of particles that cross a plane per time. `members`: (n,), the
    particles that are counted when they cross the plane. `beyond`: (T,), number of these particles beyond the
    plane.
    """
    scene = run.scene
    if not scene.walls:
        return _zero_flux(run)
    masses, radii = run.masses[members], run.radii[members]
    area = opening(scene, axis, position, float(radii.max()))
    moved = scene.thermostat or run.dissipates or run.has_gravity or scene.moving_wall
    plain = not (scene.faces or scene.face_temperatures or moved)
    alike = np.ptp(masses) == 0.0 and np.ptp(radii) == 0.0 and run.moving.all()
    if area is None or not alike or not plain or _path(run) < area ** (1.0 / (run.dimension - 1)):
        return None
    lower, upper = (np.array(ends) for ends in scene.reach(float(radii.max())))
    across = np.delete(upper - lower, axis).prod()
    sides = across * np.array([position - lower[axis], upper[axis] - position])
    numbers = np.array([len(members) - beyond.mean(), beyond.mean()])
    speed = math.sqrt(run.temperature / (2.0 * math.pi * masses[0]))
    rates = numbers / sides * speed * area
    spent = abs(int(beyond[-1]) - int(beyond[0])) / max(1.0, numbers.max())
    source = f"free flight through an opening of {area:.4g}"
    return Expected(np.array([rates[0] - rates[1]]), float(rates.max()) * spent, source)


def _zero_flux(run: Run) -> Expected | None:
    """Return the zero flux of a steady state; None if a part of the container or a piston lets gas flow."""
    scene = run.scene
    if scene.is_open or scene.has_piston or any(kind.region is not None for kind in scene.species):
        return None
    return Expected(np.zeros(1), 0.0, "a steady state between walls")


def _path(run: Run) -> float:
    """Compute the mean free path of the largest particles, averaged over the container."""
    lower, upper = run.scene.reach(run.scene.largest_radius)
    density = run.count / float(np.subtract(upper, lower).prod())
    return _free_path(density, 2.0 * run.scene.largest_radius, run)


def opening(scene: Scene, axis: int, position: float, radius: float) -> float | None:
    """Compute the area of the openings between interior walls through which centres can pass. The walls lie
    in a plane across the axis. In two dimensions the area is a length. Return None if no wall lies in the
    plane, or if a plate is not parallel to the axes.
    """
    across = [k for k in range(scene.dimension) if k != axis]
    near, length = 1e-9 * scene.container.lengths[axis], scene.container.lengths[axis]
    shadows = []
    for wall in scene.walls:
        corners = np.array(list(wall.corners.values()))
        if np.abs(corners[:, axis] - position).max() > near:
            continue
        if isinstance(wall, Plate) and any(np.count_nonzero(edge) > 1 for edge in wall.edges):
            return None
        shadows.append([corners[:, across].min(axis=0) - radius, corners[:, across].max(axis=0) + radius])
    if not shadows or not length > 0.0:
        return None
    lower, upper = (np.array(ends)[across] for ends in scene.reach(radius))
    return _open_area(np.array(shadows), lower, upper)


def _open_area(shadows: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> float:
    """Compute the uncovered area or length of a box, outside all `shadows` (W, 2, k)."""
    edges = [
        np.unique(np.clip(np.append(shadows[:, :, k], [lower[k], upper[k]]), lower[k], upper[k]))
        for k in range(len(lower))
    ]
    is_open = np.ones([len(edge) - 1 for edge in edges], dtype=bool)
    for low, high in shadows:
        covered = [
            (edge[:-1] >= a - 1e-12) & (edge[1:] <= b + 1e-12)
            for edge, a, b in zip(edges, low, high, strict=True)
        ]
        is_open &= ~reduce(np.logical_and.outer, covered)
    widths = reduce(np.multiply.outer, [np.diff(edge) for edge in edges])
    return float((widths * is_open).sum())
