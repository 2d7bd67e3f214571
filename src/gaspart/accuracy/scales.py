"""Characteristic scales of a scene, from which a duration and an interval are suggested.

The scales are a speed, a length and two times in the initial state. They assume a homogeneous gas. Its
temperature is the initial temperature or the temperature of the faces, whichever is higher.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from gaspart import theory
from gaspart.scene.boundaries import attempt_rate, piston_end
from gaspart.scene.faces import Open
from gaspart.scene.scene import Scene
from gaspart.scene.species import Particle, Species
from gaspart.theory.rates import MEAN_SQUARE, rate_at_scatterers, rates, square_of

_COLLISIONS, _CROSSINGS = 200.0, 10.0
"""Minimum numbers of collisions and of container crossings per particle in the suggested duration."""
_FRAMES = 1000  # largest suggested number of frames
KNUDSEN = 10.0
"""Mean free path, in lengths of the shortest side, beyond which a gas is free-molecular."""
_DILUTE = 0.02
"""Packing fraction below which particles are points in a column under gravity."""
_KINDS = 200
"""Maximum number of kinds whose pairs are evaluated; each single particle is a kind."""
_REDUCED = 1e5
"""Speed above which, or below whose inverse, the units do not suit the particles."""


@dataclass(frozen=True)
class Scales:
    """Characteristic scales of a scene.

    thermal_speed : sqrt(k_B T / m), 0 if nothing moves at the start.
    mean_free_path, collision_time : length and time between two collisions of a particle, infinite without
        collisions.
    crossing_time : time in which a particle crosses the shortest side of the container, with its speed or by
        falling.
    packing_fraction : packing fraction.
    end : maximum suggested duration, if a piston moves at a prescribed speed.
    walled : True if any side is not periodic.
    attempts : particles of reservoirs that try to enter, per time.
    fallen : temperatures at the start and after particles have fallen from random heights, if they differ.
    """

    thermal_speed: float
    mean_free_path: float
    collision_time: float
    crossing_time: float
    packing_fraction: float
    end: float = math.inf
    walled: bool = False
    attempts: float = 0.0
    fallen: tuple[float, float] | None = None

    @property
    def free_molecular(self) -> bool:
        """True if particles meet walls far more often than one another."""
        is_comparable = self.walled and math.isfinite(self.mean_free_path)
        return is_comparable and self.collision_time > KNUDSEN * self.crossing_time

    @property
    def event_time(self) -> float:
        """Time between collisions, or to cross the container without any or in a `free_molecular` gas; or
        inf.
        """
        collides = math.isfinite(self.collision_time) and not self.free_molecular
        return self.collision_time if collides else self.crossing_time

    @property
    def interval(self) -> float | None:
        """Suggested time between frames, two digits, at most 1000 frames; None if nothing moves."""
        if not math.isfinite(self.event_time):
            return None
        return two_digits(min(max(self.event_time, self._longest / _FRAMES), 0.1 * self.end))

    @property
    def duration(self) -> float | None:
        """Suggested duration in intervals: 200 collisions and ten crossings, or 200 crossings if
        `free_molecular`.
        """
        if self.interval is None:
            return None
        number = min(
            math.ceil(self._longest / self.interval), math.floor(min(self.end / self.interval, 1e15))
        )
        return float(f"{max(1, number) * self.interval:.12g}")

    @property
    def _longest(self) -> float:
        collisions = _COLLISIONS * self.event_time if math.isfinite(self.collision_time) else 0.0
        return max(collisions, _CROSSINGS * self.crossing_time)

    @property
    def proposal(self) -> str:
        """The suggestion as options of `gaspart run`; "" if nothing moves."""
        return f"--duration {self.duration:.12g} --sample-interval {self.interval:g}" if self.interval else ""

    @property
    def lines(self) -> list[str]:
        """Lines of text with the scales and the suggestion, for the command line."""
        if self.interval is None:
            return ["scales: nothing moves at the start, and nothing falls"]
        quantities = {
            "thermal speed": self.thermal_speed,
            "mean free path": self.mean_free_path,
            "time between collisions": self.collision_time,
            "to cross the container": self.crossing_time,
        }
        words = [f"{name} {value:.3g}" for name, value in quantities.items() if 0.0 < value < math.inf]
        lines = [f"scales: {', '.join(words)}; packing fraction {self.packing_fraction:.3g}"]
        if self.attempts:
            lines += [f"reservoirs: {self.attempts:.3g} particles try to enter per time"]
        if self.fallen:
            rule = "heats a dilute gas from the temperature {:.3g} to about {:.3g}".format(*self.fallen)
            lines += [f"gravity: the fall from random heights {rule}"]
        lines += [f"suggested: {self.proposal}"]
        if self.thermal_speed and not 1.0 / _REDUCED < self.thermal_speed < _REDUCED:
            rule = "k_B is 1: a temperature is an energy, of one system of units with the masses and lengths"
            lines += [f"units: {rule} (docs/conventions.md)"]
        return lines


def _fallen(scene: Scene) -> tuple[float, float] | None:
    """Return the temperatures at the start and in equilibrium of a dilute gas under gravity. The energy of a
    particle is conserved: d / 2 T + m g <z>. <z> is T / (m g) - h / (exp(m g h / T) - 1) in equilibrium
    between walls at the distance h, and h / 2 at the start. None for a dense gas, if energy is exchanged, or
    if particles differ or do not start at random positions everywhere.
    """
    pulls = [(axis, abs(pull)) for axis, pull in enumerate(scene.gravity or ()) if pull != 0.0]
    kinds = scene.species
    random = all(kind.arrangement == "random" and kind.region is None and not kind.fixed for kind in kinds)
    kept = not (scene.dissipates or scene.faces or scene.walls or scene.thermostat or scene.particles)
    if (
        len(pulls) != 1
        or pulls[0][0] not in scene.walled_axes
        or not (kinds and random and kept and scene.alike)
    ):
        return None
    (axis, pull), d = pulls[0], scene.dimension
    lower, upper = scene.reach(scene.smallest_radius)
    weight = kinds[0].mass * pull * (upper[axis] - lower[axis])
    start = sum(kind.count * kind.initial_temperature(d) for kind in kinds) / max(1, scene.count)
    energy, low, high = 0.5 * (d * start + weight), 0.0, start + weight
    for _ in range(60):
        middle = 0.5 * (low + high)
        height = middle - weight / math.expm1(min(weight / middle, 700.0))
        low, high = (middle, high) if 0.5 * d * middle + height < energy else (low, middle)
    return (start, low) if low > 1.05 * start else None


def scales(scene: Scene) -> Scales:
    """Compute the scales of a scene, with rates by theory for a plain gas, else by pairs of kinds."""
    d, gas_rates = scene.dimension, rates(scene, True, _few_kinds(scene))
    thermal = gas_rates.speed / math.sqrt(MEAN_SQUARE[d])
    side = min(scene.container.lengths)
    fall = math.sqrt(math.hypot(*scene.gravity) * side) if scene.gravity else 0.0
    fastest = max(thermal, fall)
    frequency = (collision_frequency(scene) or gas_rates.frequency) + rate_at_scatterers(scene)
    return Scales(
        thermal_speed=thermal,
        mean_free_path=gas_rates.speed / frequency if frequency else math.inf,
        collision_time=1.0 / frequency if frequency else math.inf,
        crossing_time=side / fastest if fastest else math.inf,
        packing_fraction=scene.packing_fraction,
        end=0.5 * piston_end(scene),  # at this density no free volume remains
        walled=not all(scene.container.periodic),
        attempts=sum(attempt_rate(scene, number, face) for number, face in scene.faces_of(Open)),
        fallen=_fallen(scene),
    )


def _few_kinds(scene: Scene) -> list[Species | Particle]:
    """Return the moving kinds; if many, representatives of their mean volume, mass and energy."""
    kinds, d = list(scene.moving_kinds), scene.dimension
    if len(kinds) <= _KINDS:
        return kinds
    count = sum(kind.count for kind in kinds)
    volume = sum(kind.count * kind.radius**d for kind in kinds) / count
    mass = sum(kind.count * kind.mass for kind in kinds) / count
    energy = sum(kind.count * kind.mass * square_of(kind, d) for kind in kinds) / count
    return [Species(count, volume ** (1.0 / d), mass=mass, temperature=energy)]


def collision_frequency(scene: Scene) -> float:
    """Compute the collision rate of a plain gas from theory; 0 if theory does not cover it."""
    gas = scene.gas
    if gas is None or gas.count < 2 or not gas.temperature > 0.0:
        return 0.0
    try:
        return float(theory.collision_rate(**gas.parameters))
    except ValueError:  # above the density range of the theory
        return 0.0


def two_digits(value: float) -> float:
    """Round a number to two digits."""
    return float(f"{value:.2g}")
