"""Characteristic scales of a scene, which suggest a duration and an interval.

The scales are a speed, a length and two times, at the start. They are for a homogeneous gas, with the speeds
of its initial velocities or of its faces, whichever is hotter.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from gaspart import theory
from gaspart.engines.dsmc.defaults import rates, square_of
from gaspart.scene.face_checks import attempt_rate, piston_end
from gaspart.scene.faces import Open
from gaspart.scene.scene import Scene
from gaspart.scene.species import Particle, Species

_COLLISIONS, _CROSSINGS = 200.0, 10.0
"""Numbers of collisions and of crossings of a particle in the suggested duration; both hold."""
_FRAMES = 1000  # the most that are suggested
_KNUDSEN = 10.0
"""Mean free path, in lengths of the shortest side, beyond which a gas is free-molecular."""
_KINDS = 200
"""Maximum number of kinds whose pairs are evaluated; each single particle is a kind."""
_REDUCED = 1e5
"""Speed beyond which, or below its inverse, the units hardly suit the particles."""


@dataclass(frozen=True)
class Scales:
    """Characteristic scales of a scene.

    thermal_speed : sqrt(k_B T / m), 0 if nothing moves at the start.
    mean_free_path, collision_time : length and time between two collisions of a particle, infinite without
        collisions.
    crossing_time : time in which a particle crosses the shortest side of the container, with its speed or by
        falling.
    packing_fraction : packing fraction.
    end : longest run that is suggested, where a piston moves at a prescribed speed.
    walled : True if any side is not periodic.
    attempts : particles of reservoirs that try to enter per time.
    """

    thermal_speed: float
    mean_free_path: float
    collision_time: float
    crossing_time: float
    packing_fraction: float
    end: float = math.inf
    walled: bool = False
    attempts: float = 0.0

    @property
    def free_molecular(self) -> bool:
        """True if particles meet walls far more often than one another."""
        is_comparable = self.walled and math.isfinite(self.mean_free_path)
        return is_comparable and self.collision_time > _KNUDSEN * self.crossing_time

    @property
    def event_time(self) -> float:
        """Time between collisions, or the time to cross the container; infinite if nothing moves.

        The time to cross the container is used without collisions, and for a `free_molecular` gas with walls.
        """
        collides = math.isfinite(self.collision_time) and not self.free_molecular
        return self.collision_time if collides else self.crossing_time

    @property
    def interval(self) -> float | None:
        """Suggested time between frames, to two digits; None if nothing moves.

        It is the `event_time`, or a longer time, so that the suggested duration has at most 1000 frames.
        """
        if not math.isfinite(self.event_time):
            return None
        return two_digits(min(max(self.event_time, self._longest / _FRAMES), 0.1 * self.end))

    @property
    def duration(self) -> float | None:
        """Suggested duration, a multiple of the interval.

        The duration is 200 collisions of a particle and ten crossings, or 200 crossings of a `free_molecular`
        gas.
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
        """The scales and the suggestion, for the command line."""
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
        lines += [f"suggested: {self.proposal}"]
        if self.thermal_speed and not 1.0 / _REDUCED < self.thermal_speed < _REDUCED:
            rule = "k_B is 1: a temperature is an energy, of one system of units with the masses and lengths"
            lines += [f"units: {rule} (docs/conventions.md)"]
        return lines


def scales(scene: Scene) -> Scales:
    """Compute the scales of a scene.

    Collisions of a plain gas follow from theory, otherwise from the rates of all kinds.
    """
    d, gas_rates = scene.dimension, rates(scene, True, _few_kinds(scene))
    thermal = gas_rates.speed / math.sqrt(8.0 / math.pi if d == 3 else math.pi / 2.0)
    side = min(scene.container.lengths)
    fall = math.sqrt(math.hypot(*scene.gravity) * side) if scene.gravity else 0.0
    fastest = max(thermal, fall)
    frequency = collision_frequency(scene) or gas_rates.frequency
    return Scales(
        thermal_speed=thermal,
        mean_free_path=gas_rates.speed / frequency if frequency else math.inf,
        collision_time=1.0 / frequency if frequency else math.inf,
        crossing_time=side / fastest if fastest else math.inf,
        packing_fraction=scene.packing_fraction,
        end=0.5 * piston_end(scene),  # at which there is no room left
        walled=not all(scene.container.periodic),
        attempts=sum(attempt_rate(scene, number, face) for number, face in scene.faces_of(Open)),
    )


def _few_kinds(scene: Scene) -> list[Species | Particle]:
    """Return the kinds of particles that move; a few representatives if there are many.

    The representative has their mean volume, mass and energy.
    """
    kinds, d = list(scene.moving_kinds), scene.dimension
    if len(kinds) <= _KINDS:
        return kinds
    count = sum(kind.count for kind in kinds)
    volume = sum(kind.count * kind.radius**d for kind in kinds) / count
    mass = sum(kind.count * kind.mass for kind in kinds) / count
    energy = sum(kind.count * kind.mass * square_of(kind, d) for kind in kinds) / count
    return [Species(count, volume ** (1.0 / d), mass=mass, temperature=energy)]


def collision_frequency(scene: Scene) -> float:
    """Compute the collisions of a particle of a plain gas per time, by theory.

    The frequency is 0 if there is no theory.
    """
    gas = scene.gas
    if gas is None or gas.count < 2 or not gas.temperature > 0.0:
        return 0.0
    try:
        return float(theory.collision_rate(**gas.parameters))
    except ValueError:  # denser than theory goes
        return 0.0


def two_digits(value: float) -> float:
    """Round a number to two digits."""
    return float(f"{value:.2g}")
