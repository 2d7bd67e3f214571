"""Simulation that continues in changed scenes, with gauges."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from gaspart import theory
from gaspart.accuracy.scales import scales
from gaspart.analysis.frames import measure_single
from gaspart.analysis.run import frame_of, with_frames
from gaspart.analysis.statistics.blocks import correlated_mean
from gaspart.engines import Engine
from gaspart.errors import SceneError
from gaspart.rendering.films import pieces
from gaspart.rendering.frames import Picture, draw_labelled, particles_of
from gaspart.rendering.particles import FASTEST
from gaspart.scene.faces import Open, Piston, Thermal
from gaspart.scene.restitution import Restitution
from gaspart.scene.scene import Scene, require_scene
from gaspart.simulation import Simulation

_PICTURES = 100
"""Number of pictures in the time in which a particle crosses the container."""
_DENSEST = {2: 0.45, 3: 0.28}
"""Largest packing fraction at which particles are placed at random."""
_WEIGHTS = 8.0
"""Largest gravity of the slider: energy of a fall through the container, in units of m v^2 of a particle."""
_HOTTEST = 4.0
"""Largest temperature of the walls, divided by the initial temperature of the gas."""
_RICHEST = 4.0
"""Largest activity of reservoirs, divided by the initial activity."""
_SMALLEST = 0.4
"""Smallest distance of the piston from the opposite side, as a fraction of the length."""
_SPEED = 0.25
"""Speed of the piston, divided by the thermal speed."""
_KEPT, _TRAIL, _BINS = 256, 400, 24
"""Maximum number of frames for the gauges, points of the tracer's path, and bins of speeds."""
LEAST_FRAMES = 33
"""Minimum number of frames for gauges with errors."""
LIVE_SIZE = (600, 450)


class LiveGas:
    """Simulation that advances from picture to picture; its scene may change.

    interval : time between two pictures.
    size : (W, H) in pixels.
    collisions : number of collisions since the start.
    traced : True if the path of the first moving particle is drawn.

    Other arguments are the arguments of `Simulation`. `colour` is explained in `render`. Raises SceneError
    like `Simulation`, and for a scene in which no particle moves or falls.
    """

    def __init__(
        self,
        scene: Scene,
        engine: Engine | str | None = None,
        seed: int | tuple[int, ...] = 0,
        size: tuple[int, int] = LIVE_SIZE,
        colour: str = "speed",
    ) -> None:
        require_scene(scene)
        self.interval = scales(scene).crossing_time / _PICTURES
        if self.interval == float("inf"):
            raise SceneError("scene", scene, "nothing moves at the start, and nothing falls")
        self.size, self.colour, self._engine, self._seed, self._first = size, colour, engine, seed, scene
        self.traced = False
        self._thermal_speed = scales(scene).thermal_speed
        self._begin(scene)

    def _begin(self, scene: Scene) -> None:
        """Start a scene from time 0."""
        self.simulation = Simulation(scene, self._engine, self._seed)
        self._before = self._clock = 0.0
        self.collisions, self._counted = 0, 0
        self._target: float | None = None
        self._path: list[np.ndarray] = []
        self._moving = int(np.argmax(np.isfinite(self.simulation.state.masses))) if self.traceable else None
        self.observe()

    def _go_on(self, scene: Scene, **state: Any) -> None:
        """Continue in another scene from the present state; values of the state may be replaced."""
        present = replace(self.simulation.state, **state)
        if scene.is_open:
            if not present.count:
                raise SceneError(
                    "scene", "empty", "all particles have left: change it after some have entered"
                )
            scene = replace(scene, species=[replace(scene.species[0], count=present.count)])
        simulation = Simulation(scene, self._engine, self._seed, initial=present)
        self._clock += self.simulation.time
        self.simulation, self._counted = simulation, 0
        self.observe()

    def observe(self) -> None:
        """Restart the measurements of the gauges, as after each change."""
        self._rows, self._stride, self._skipped = [frame_of(self.simulation)], 1, 0

    @property
    def time(self) -> float:
        """Time since the start."""
        return self._clock + self.simulation.time

    @property
    def picture(self) -> Picture:
        """Picture of the particles at the present time, with the parameters of the scene."""
        particles = particles_of(self.simulation)
        paths = pieces(self._path, particles.lengths) if self.traced and self.traceable else ()
        fastest = FASTEST * np.sqrt(self._first.dimension) * self._thermal_speed or None
        return draw_labelled(particles, self.time, self.size, self.colour, fastest, paths=paths)

    def advance(self) -> Picture:
        """Advance by an interval, and return the picture."""
        self.step()
        return self.picture

    def step(self) -> None:
        """Advance by an interval, or until the piston reaches its goal."""
        duration, piston = self.interval, self.simulation.state.piston
        arrives = False
        if self._target is not None and piston is not None:
            rest = (piston[0] - self._target) / abs(piston[1])
            arrives = rest <= duration
            duration = max(min(rest, duration), 1e-9 * duration)
        self.simulation.advance(duration=duration)
        tally = self.simulation.tally
        self.collisions += tally.collisions - self._counted
        self._counted = tally.collisions
        if self._moving is not None:
            self._path = [*self._path[1 - _TRAIL :], self.simulation.state.positions[self._moving]]
        self._record()
        if arrives:
            self._settle()

    def _record(self) -> None:
        """Store a frame for the gauges; if there are too many, every second frame is removed."""
        self._skipped += 1
        if self._skipped < self._stride:
            return
        self._rows.append(frame_of(self.simulation))
        self._skipped = 0
        if len(self._rows) > _KEPT:
            self._rows, self._stride = self._rows[::2], 2 * self._stride

    def fill(self, packing_fraction: float) -> None:
        """Start again with the number of particles for approximately this packing fraction.

        The moving species keep the proportions of the first scene.

        Parameters
        ----------
        packing_fraction : float, [1]
            Packing fraction.

        Raises
        ------
        SceneError
            If the particles do not fit.
        """
        now = self.simulation.scene
        smaller = np.prod(now.container.lengths) / np.prod(self._first.container.lengths)
        factor = (packing_fraction - self.emptiest) / (self._first.packing_fraction - self.emptiest) * smaller
        species = [
            item if item.fixed else replace(item, count=max(1, round(factor * item.count)))
            for item in self._first.species
        ]
        self._begin(replace(now, species=species))

    def pull(self, acceleration: float) -> None:
        """Continue from the present state with another gravity, down the last axis.

        Parameters
        ----------
        acceleration : float, [length/time^2]
            Acceleration.
        """
        down = (*[0.0] * (self._first.dimension - 1), -acceleration)
        self._go_on(replace(self.simulation.scene, gravity=down))

    def heat(self, temperature: float) -> None:
        """Continue between walls at another temperature.

        Thermal faces and reservoirs of the first scene keep the ratios of their temperatures. If there are no
        such faces, all reflecting faces become thermal.

        Parameters
        ----------
        temperature : float, [energy]
            Temperature k_B T of the hottest wall; 0: the walls of the first scene.
        """
        first, faces = self._first.faces, dict(self.simulation.scene.faces)
        warm = self._warm
        scale = temperature / self.temperature if warm and temperature > 0.0 else 1.0
        for name in warm or self._hard:
            face = faces.get(name)
            if isinstance(face, Piston):  # the piston is moving
                continue
            if warm:
                assert isinstance(face, Open | Thermal)
                faces[name] = replace(face, temperature=scale * warm[name].temperatures[0])
            elif temperature <= 0.0:
                faces.pop(name, None)
                faces |= {name: first[name]} if name in first else {}
            else:
                faces[name] = Thermal(temperature)
        self._go_on(replace(self.simulation.scene, faces=faces))

    def supply(self, activity: float) -> None:
        """Continue with other activities of reservoirs, in the same ratios.

        Parameters
        ----------
        activity : float, [1]
            Activity of the richest reservoir.
        """
        faces = dict(self.simulation.scene.faces)
        for name, reservoir in self._reservoirs.items():
            face, share = faces[name], (reservoir.activity or 0.0) / self.activity
            assert isinstance(face, Open)
            faces[name] = replace(face, activity=activity * share)
        self._go_on(replace(self.simulation.scene, faces=faces))

    def damp(self, normal: float) -> None:
        """Continue with another coefficient of restitution.

        Parameters
        ----------
        normal : float, [1]
            Normal restitution; 1 is elastic.
        """
        law = self._first.restitution
        law = replace(law, normal=normal) if law else Restitution(normal=normal) if normal < 1.0 else None
        self._go_on(replace(self.simulation.scene, restitution=law))

    def push(self, coordinate: float) -> None:
        """Move the side x high: inwards as a piston, outwards instantaneously into a vacuum.

        Parameters
        ----------
        coordinate : float, [length]
            New coordinate of the side.
        """
        if self._target is not None:
            self._settle()
        scene = self.simulation.scene
        length = scene.container.lengths[0]
        if coordinate < length:
            self._target = coordinate
            speed = _SPEED * max(scales(scene).thermal_speed, self._thermal_speed)
            faces = {**scene.faces, "x_high": Piston(speed=speed)}
            self._go_on(replace(scene, faces=faces))
        elif coordinate > length:
            self._resize(scene, coordinate)

    def _settle(self) -> None:
        """Stop the piston at its present position."""
        scene, piston = self.simulation.scene, self.simulation.state.piston
        assert piston is not None
        faces = {name: face for name, face in scene.faces.items() if name != "x_high"}
        faces |= {name: face for name, face in self._first.faces.items() if name == "x_high"}
        self._target = None
        self._resize(replace(scene, faces=faces), float(piston[0]))

    def _resize(self, scene: Scene, length: float) -> None:
        """Continue in a container of another length along x."""
        lengths = (length, *scene.container.lengths[1:])
        container = replace(scene.container, lengths=lengths)
        self._go_on(replace(scene, container=container), lengths=np.array(lengths), piston=None)

    def open_walls(self) -> None:
        """Remove interior walls, so that the separated gases mix."""
        self._go_on(replace(self.simulation.scene, walls=()))

    def gauges(self) -> list[tuple[str, float, float, float | None]]:
        """Name, mean since the last change, standard error and theory of each gauge.

        The gauges are the temperature, and the pressure on each wall, or Z of a gas without walls. With open
        faces there is also the number of particles. The list is empty until there are enough frames. If there
        is no theory for this container, the equation of state of a gas without walls is used.
        """
        if len(self._rows) < LEAST_FRAMES:
            return []
        data, scene = with_frames(self.simulation, self._rows), self.simulation.scene
        energies = 2.0 * np.array([row["kinetic_energy"] for row in self._rows])
        counts = np.isfinite(self._flights).all(axis=2).sum(axis=1) - scene.is_periodic
        temperatures = energies / np.maximum(self._first.dimension * counts, 1)
        walls = {face.temperatures for face in scene.faces.values() if isinstance(face, Open | Thermal)}
        bath = walls.pop() if len(walls) == 1 and scene.restitution is None else ()
        mean = correlated_mean(temperatures).estimate
        readings = [("temperature", mean.value, mean.error, bath[0] if len(set(bath)) == 1 else None)]
        if self._target is not None:  # the volume changes
            return readings
        if scene.is_open:
            mean = correlated_mean(counts.astype(float)).estimate
            readings.append(("particles", mean.value, mean.error, None))
        try:
            result = measure_single(data, "Z" if scene.is_periodic else "pressure")
        except SceneError:  # not defined in this scene
            return readings
        names = (
            ["Z"] if scene.is_periodic else [f"pressure, {face}" for face in result.estimate["face"].values]
        )
        theories = (
            [self._bulk(mean.value)] * len(names)
            if result.theory is None
            else np.atleast_1d(result.theory.values)
        )
        values, errors = (np.atleast_1d(item.values) for item in (result.estimate, result.error))
        return readings + list(zip(names, values, errors, theories, strict=True))

    def _bulk(self, temperature: float) -> float | None:
        """Return Z of a periodic gas, or the bulk pressure between walls; None if unknown."""
        scene = self.simulation.scene
        gas = None if scene.is_open else replace(scene, faces={}).gas
        try:
            z = float(theory.compressibility_factor(gas.packing_fraction, gas.dimension)) if gas else None
        except ValueError:  # denser than the fluid
            return None
        if z is None or scene.is_periodic:
            return z
        return z * self.simulation.state.count * temperature / float(np.prod(scene.container.lengths))

    def speeds(self) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
        """Return the histogram of speeds since the last change, with Maxwell's density.

        The histogram has edges and a density. Maxwell's density is for the mean energy and for particles of
        equal mass. For other particles, None is returned for this density.
        """
        masses, d = self.simulation.state.masses, self._first.dimension
        masses = masses[np.isfinite(masses)]
        speeds = np.sqrt((self._flights**2).sum(axis=2)).ravel()
        speeds = speeds[np.isfinite(speeds)]
        fastest = 2.5 * float(np.sqrt((speeds**2).sum() / max(speeds.size, 1)))
        edges = np.linspace(0.0, max(fastest, 1e-30), _BINS + 1)
        density = np.histogram(speeds, edges)[0] / (max(speeds.size, 1) * np.diff(edges))
        if len(set(masses.tolist())) != 1 or not speeds.any():
            return edges, density, None
        mass = float(masses[0])
        temperature = mass * float((speeds**2).mean()) / d
        middles = 0.5 * (edges[1:] + edges[:-1])
        return edges, density, np.asarray(theory.maxwell_pdf(middles, d, temperature, mass))

    @property
    def _flights(self) -> np.ndarray:
        """Velocities (T, N, d) of moving particles since the last change; NaN for vacant numbers."""
        velocities = np.array([row["velocities"] for row in self._rows])
        if self._first.is_open:
            return velocities
        return velocities[:, np.isfinite(self.simulation.state.masses)]

    @property
    def traceable(self) -> bool:
        """True if a path can be drawn: two dimensions, and no open faces."""
        return self._first.dimension == 2 and not self._first.is_open

    @property
    def emptiest(self) -> float:
        """Packing fraction without the moving species."""
        fixed = [item for item in self._first.species if item.fixed]
        return replace(self._first, species=fixed).packing_fraction

    @property
    def densest(self) -> float:
        """Largest packing fraction of the slider."""
        return max(_DENSEST[self._first.dimension], self._first.packing_fraction)

    @property
    def strongest(self) -> float | None:
        """Largest gravity of the slider; None if the scene has no floor, or has reservoirs.

        Gravity does not act on reservoirs.
        """
        if self._first.container.periodic[-1] or self._first.is_open:
            return None
        height = self._first.container.lengths[-1]
        return max(_WEIGHTS * scales(self._first).thermal_speed ** 2 / height, 2.0 * self.gravity)

    @property
    def gravity(self) -> float:
        """Acceleration down the last axis."""
        pull = self.simulation.scene.gravity
        return -pull[-1] if pull else 0.0

    @property
    def temperature(self) -> float:
        """Highest temperature of walls and reservoirs of the first scene; 0 if none has one."""
        faces = self._first.faces.values()
        warm = [item.temperatures for item in faces if isinstance(item, Open | Thermal)]
        return max((max(item) for item in warm if item), default=0.0)

    @property
    def activity(self) -> float:
        """Highest activity of the reservoirs of the first scene; 0 if it has no reservoir."""
        return max((item.activity or 0.0 for item in self._reservoirs.values()), default=0.0)

    @property
    def richest(self) -> float:
        """Largest activity of the slider; 0 if the scene has no reservoir."""
        return _RICHEST * self.activity

    @property
    def hottest(self) -> float | None:
        """Largest temperature of the slider; None if no wall can be thermal."""
        if not self._warm and not self._hard:
            return None
        gas = scales(self._first).thermal_speed ** 2 * float(np.min(self.simulation.state.masses))
        return _HOTTEST * max(self.temperature, gas) or None

    @property
    def shortest(self) -> float | None:
        """Smallest coordinate of the side x high on the slider; None if the side cannot move."""
        first = self._first
        if first.is_open:
            return None
        fixed = bool(self.emptiest) or any(item.fixed for item in first.particles)
        bound = first.walls or first.pistons or (first.gravity and first.gravity[0])
        if bound or fixed or "x_high" not in (*self._hard, *self._warm):
            return None
        return first.container.lengths[0] * max(_SMALLEST, first.packing_fraction / self.densest)

    @property
    def _warm(self) -> dict[str, Thermal | Open]:
        """Reservoirs and thermal faces of the first scene; each face has a single temperature."""
        faces = self._first.faces.items()
        walls = {
            name: item for name, item in faces if isinstance(item, Thermal) and item.varies_along is None
        }
        return walls | self._reservoirs

    @property
    def _reservoirs(self) -> dict[str, Open]:
        """Open faces of the first scene through which particles enter."""
        faces = self._first.faces.items()
        return {name: item for name, item in faces if isinstance(item, Open) and item.activity is not None}

    @property
    def _hard(self) -> list[str]:
        """Reflecting faces of the container."""
        axes = range(self._first.dimension)
        names = [f"{'xyz'[axis]}_{end}" for axis in axes for end in ("low", "high")]
        walls = np.repeat([not item for item in self._first.container.periodic], 2)
        return [
            name for name, wall in zip(names, walls, strict=True) if wall and name not in self._first.faces
        ]
