"""The local density and temperature of a steady scene, from which bounds on the errors of DSMC follow.

A gas that is even has its mean values everywhere; one under gravity those of hydrostatics (`column`), where
theory knows them; any other has those that a pilot run of the exact engine shows.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from gaspart import theory
from gaspart.accuracy.column import Column, Pulled, between, pulled
from gaspart.analysis.run import open_run
from gaspart.engines.dsmc.defaults import accessible, contact_values
from gaspart.scene.faces import Thermal
from gaspart.scene.geometry import ball_volume
from gaspart.scene.scene import Scene
from gaspart.state.state import State

_LAYERS = 12
"""Of a measured profile, in each axis, with as many particles in each."""
_CERTAIN = 4.0
"""Standard errors by which two of all layers differ if there is a gradient."""
_HELD = 0.02
"""Part of the particles beyond which a layer counts in the shortest scale."""
_FREE = 0.02
"""The least part of the volume that is free of a pair, where its contact value is evaluated."""


@dataclass(frozen=True)
class Conditions:
    """Layers across an axis, from wall to wall: place (S,) of their middle; share (S,) of all particles in
    each; crowding (S,), the density over that of a gas that fills evenly what centres can reach; temperature
    (S,). axis: None of an even gas; scale: the shortest length along it over which density or temperature
    change by the factor e; columns: under gravity, by theory, of the real gas and of an ideal one."""

    scene: Scene
    place: np.ndarray
    share: np.ndarray
    crowding: np.ndarray
    temperature: np.ndarray
    axis: int | None = None
    scale: float = math.inf
    columns: tuple[Column, Column] | None = None

    @cached_property
    def free(self) -> np.ndarray:
        """(d,) lengths that centres can reach."""
        lower, upper = accessible(self.scene)
        return np.asarray(upper - lower)

    @cached_property
    def _kinds(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(K,) radii, masses and mean number densities of the kinds of particles that move."""
        kinds = self.scene.moving_kinds
        radii = np.array([kind.radius for kind in kinds])
        masses = np.array([kind.mass for kind in kinds])
        return radii, masses, np.array([kind.count for kind in kinds]) / float(self.free.prod())

    @cached_property
    def filled(self) -> np.ndarray:
        """(S,) packing fraction, of what centres can reach."""
        radii, _, numbers = self._kinds
        d = self.scene.dimension
        return self.crowding * ball_volume(d) * float((numbers * radii**d).sum())

    @cached_property
    def contact(self) -> np.ndarray:
        """(S,) contact value of an infinite gas, the largest one of all pairs of kinds."""
        radii, _, numbers = self._kinds
        d = self.scene.dimension
        return np.array([float(contact_values(numbers * one, radii, d).max()) for one in self.crowding])

    @cached_property
    def contact_of_few(self) -> np.ndarray:
        """(S,) that of so many particles, inf where a pair has no room.

        A pair at contact has not to avoid itself: 1 / (1 - v / V), v the volume from which one of the pair
        keeps the centre of the other, which is exact of two particles, times the contact value of the rest.
        To first order in the packing fraction of spheres 1 + (5/2 + 3/N) eta: 4 eta of two, 5/2 eta of many.
        """
        radii, _, numbers = self._kinds
        d, count = self.scene.dimension, self.scene.count
        pair = ball_volume(d) * (2.0 * float(radii.max())) ** d / float(self.free.prod())
        others = max(0.0, count - 2.0) / count
        room = np.maximum(0.0, 1.0 - pair * self.crowding)
        rest = [float(contact_values(others * numbers * one, radii, d).max()) for one in self.crowding]
        return np.where(room > _FREE, np.array(rest) / np.maximum(room, _FREE), math.inf)

    @cached_property
    def virial(self) -> np.ndarray:
        """(S,) Z - 1."""
        return 2.0 ** (self.scene.dimension - 1) * self.filled * self.contact_of_few

    @cached_property
    def path(self) -> np.ndarray:
        """(S,) mean free path of the kind that has the shortest one."""
        radii, _, numbers = self._kinds
        d = self.scene.dimension
        sigma = radii[:, None] + radii
        section = math.pi * sigma**2 if d == 3 else 2.0 * sigma
        most = float((section * numbers).sum(axis=1).max())
        return np.asarray(1.0 / (math.sqrt(2.0) * most * self.crowding * self.contact))

    @cached_property
    def speed(self) -> np.ndarray:
        """(S,) mean speed of the lightest particles."""
        _, masses, _ = self._kinds
        mean = 8.0 / math.pi if self.scene.dimension == 3 else math.pi / 2.0
        return np.sqrt(mean * self.temperature / masses.min())

    @property
    def quickened(self) -> float:
        """How often particles collide over how often they would in an even gas as hot as they start."""
        kinds = self.scene.moving_kinds
        d = self.scene.dimension
        start = sum(kind.count * kind.initial_temperature(d) for kind in kinds) / self.scene.count
        hotter = np.sqrt(self.temperature / (start or math.inf))
        mean = (self.share * self.crowding * self.contact * hotter).sum()
        return float(mean / even_conditions(self.scene, 1.0).contact[0])

    @property
    def contrast(self) -> float:
        """The shortest free path of an even gas over the shortest one here."""
        return float((self.crowding * self.contact).max() / even_conditions(self.scene, 1.0).contact[0])

    @cached_property
    def surfaces(self) -> float:
        """What part of all contacts lack a neighbour beyond a wall, to first order: the sum over axes with
        walls of the largest diameter over the length in which the particles are."""
        sides = np.where(self.scene.container.periodic, math.inf, self.free)
        if self.axis is not None and math.isfinite(sides[self.axis]):
            sides[self.axis] = min(sides[self.axis], self.scale)
        return float((2.0 * self.scene.largest_radius / np.maximum(sides, 1e-300)).sum())

    @cached_property
    def memory(self) -> float:
        """|D / Enskog's - 1| of spheres, by which correlated collisions change transport; of discs, whose
        coefficients grow with the size of the system, the same at this packing fraction, an estimate."""
        densest = min(float(self.filled.max()), theory.ERPENBECK_WOOD_HIGHEST)
        return abs(float(theory.erpenbeck_wood_ratio(densest)) - 1.0) if densest > 0.0 else 0.0

    def of_points(self, observable: str, face: str | None) -> float | None:
        """By how much an observable of points differs from that of particles, relatively; face: of the
        pressure; None where theory does not know the column."""
        return between(*self.columns, observable, self._top(face)) if self.columns else None

    def _top(self, face: str | None) -> bool | None:
        """Whether a face of the container is at the top of a column, None of any that is not across it."""
        scene, axis = self.scene, self.axis
        if face is None or axis is None or face[0] != "xyz"[axis] or scene.gravity is None:
            return None
        return (scene.gravity[axis] < 0.0) == face.endswith("high")


def known_conditions(scene: Scene, start: State) -> Conditions | None:
    """By theory, None where that knows nothing; start: a state of the scene, which has its energy."""
    if column := pulled(scene):
        try:
            return _of_column(scene, column, start)
        except ValueError:  # as of particles that come to rest as a crystal
            return None
    if not _is_even(scene):
        return None
    heat = max(scene.face_temperatures, default=0.0)
    return even_conditions(scene, heat or kinetic_temperature(scene, start))


def _is_even(scene: Scene) -> bool:
    """Whether a scene becomes even, whatever its start."""
    law = scene.restitution
    uneven = [
        scene.gravity is not None,
        law is not None and (law.dissipative or law.rough),
        scene.thermostat is not None,
        len(scene.face_temperatures) > 1,
        any(not isinstance(face, Thermal) or face.slides for face in scene.faces.values()),
        bool(scene.walls),
    ]
    return not any(uneven)


def kinetic_temperature(scene: Scene, start: State) -> float:
    """Of a state, k_B T; 0 of particles at rest."""
    moving = np.isfinite(start.masses)
    freedom = scene.dimension * moving.sum() - sum(scene.conserved_axes)
    return float(2.0 * start.translational_energy / freedom) if freedom > 0 else 0.0


def even_conditions(scene: Scene, temperature: float) -> Conditions:
    """Those of a gas that is the same everywhere."""
    return Conditions(scene, np.zeros(1), np.ones(1), np.ones(1), np.array([temperature]))


def _of_column(scene: Scene, pulled_scene: Pulled, start: State) -> Conditions:
    """Under gravity. Raises ValueError where theory knows nothing."""
    energy, heat = pulled_scene.energy_of(start), max(scene.face_temperatures, default=None)
    real, ideal = (pulled_scene.settled(energy, heat, one) for one in (False, True))
    z, numbers = real.heights, real.numbers.sum(axis=0)
    share = numbers * np.gradient(z)
    share /= share.sum()
    gradient = np.abs(np.gradient(np.log(np.maximum(numbers, 1e-300)), z))
    within = np.cumsum(share) < 1.0 - _HELD
    within[0] = True
    return Conditions(
        scene,
        z,
        share,
        numbers * pulled_scene.height / scene.count,
        np.full(len(z), real.temperature),
        pulled_scene.axis,
        1.0 / max(float(gradient[within].max()), 1e-300),
        (real, ideal),
    )


def measured_conditions(scene: Scene, path: Path) -> Conditions:
    """Those of the measured part of a run, along the axis on which density and temperature change most.
    Raises SceneError for a file without all particles."""
    with open_run(path, None, sheared=True) as run:
        places = run.positions[:, run.moving]
        thermal = (run.masses[run.moving] * (run.peculiar**2).sum(axis=2)) / run.dimension
    found = [_along(scene, k, places[..., k], thermal) for k in range(scene.dimension)]
    return min(found, key=lambda one: one.scale)


def _along(scene: Scene, axis: int, places: np.ndarray, thermal: np.ndarray) -> Conditions:
    """Layers with as many particles in each of frames (T, M)."""
    lower, upper = (float(one[axis]) for one in accessible(scene))
    order = np.argsort(places, axis=None)
    layers = np.array_split(order, _LAYERS)
    sorted_places = places.ravel()[order]
    ends = np.cumsum([len(one) for one in layers])[:-1]
    edges = np.concatenate([[lower], 0.5 * (sorted_places[ends - 1] + sorted_places[ends]), [upper]])
    width = np.maximum(np.diff(edges), 1e-12 * (upper - lower))
    middle, share = 0.5 * (edges[1:] + edges[:-1]), np.full(_LAYERS, 1.0 / _LAYERS)
    crowding = share * (upper - lower) / width
    temperature = np.array([float(thermal.ravel()[one].mean()) for one in layers])
    # Particles of one frame are independent, roughly; frames are taken as not.
    error = math.sqrt(2.0 * _LAYERS / max(1, places.shape[1]) / max(1.0, len(places) / 8.0))
    logarithms = [np.log(np.maximum(of, 1e-300)) for of in (crowding, temperature)]
    one, other = np.triu_indices(_LAYERS, 1)
    change = np.maximum(*(np.abs(of[other] - of[one]) for of in logarithms))
    certain = np.maximum(change - _CERTAIN * error, 0.0) / (middle[other] - middle[one])
    scale = 1.0 / float(certain.max()) if certain.max() > 0.0 else math.inf
    return Conditions(scene, middle, share, crowding, temperature, axis, scale)
