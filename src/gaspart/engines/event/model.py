"""The model and the particles of the event-driven engine's kernels, and the parts of a run."""

from __future__ import annotations

import numpy as np

from gaspart.engines.features.contact_duration import DurationPart, contact_duration
from gaspart.engines.features.faces import FacesPart, has_special_faces, special_faces
from gaspart.engines.features.gravity import GravityPart, gravity_of
from gaspart.engines.features.law import LawPart, contact_law
from gaspart.engines.features.masses import scaled_masses
from gaspart.engines.features.moving_wall import MovingWallPart, moving_wall_of
from gaspart.engines.features.open_faces import OpenPart, reservoirs_of
from gaspart.engines.features.part import Part
from gaspart.engines.features.per_area import EventPerAreaPart
from gaspart.engines.features.piston import PistonPart
from gaspart.engines.features.rest import rest_watch
from gaspart.engines.features.shear import ShearPart, shear_of
from gaspart.engines.features.thermostat import kicks
from gaspart.engines.features.vibrating import VibratingPart
from gaspart.engines.features.walls import WarmWallsPart, interior_walls, warm_walls
from gaspart.kernels.memory import aligned
from gaspart.kernels.model import NONE, PREDICTION, Model, Oversized, Particles, Space, flight_dtype
from gaspart.scene.scene import Scene
from gaspart.state.boxes import Boxes
from gaspart.state.state import State


def particles_of(state: State, boxes: Boxes) -> Particles:
    """The particles of a state, with nothing predicted yet."""
    n = state.count
    particles = Particles(
        flights=aligned((n,), flight_dtype(state.dimension)),
        images=state.images.copy(),
        predictions=aligned((n,), PREDICTION),
    )
    flights, predictions = particles.flights, particles.predictions
    flights["position"], flights["velocity"] = state.positions, state.velocities
    flights["radius"] = state.radii
    predictions["partner"], predictions["box"] = NONE, boxes.coordinates(state.positions)
    return particles


def event_model(
    scene: Scene, state: State, seed: int | tuple[int, ...], boxes: Boxes, largest: float
) -> tuple[Model, float]:
    """The model of a scene, and its unit of mass. largest: the largest radius of the particles in boxes."""
    law = contact_law(scene, state)
    law = law._replace(duration=contact_duration(scene, law)) if law else None
    unit_mass, masses = (1.0, None) if law else scaled_masses(state.masses)
    oversized, warm = np.flatnonzero(state.radii > largest), warm_walls(scene, state, seed, unit_mass)
    moving = moving_wall_of(scene, state, unit_mass)
    faces = special_faces(scene, state, seed, unit_mass) if has_special_faces(scene) else None
    model = Model(
        space=Space(scene.container.lengths, scene.container.periodic, float(not scene.centres_to_walls)),
        masses=masses,
        gravity=gravity_of(scene, state),
        law=law,
        faces=faces,
        walls=interior_walls(scene, boxes, largest, warm, moving) if scene.walls else None,
        oversized=Oversized(oversized, largest) if len(oversized) else None,
        shear=shear_of(scene),
        reservoirs=reservoirs_of(scene, seed, faces.open) if faces and faces.open else None,
    )
    return model, unit_mass


def event_parts(
    scene: Scene, state: State, seed: int | tuple[int, ...], model: Model, unit_mass: float
) -> list[Part]:
    """The parts of a run, one for each feature of the scene."""
    gravity, law, faces, walls = model.gravity, model.law, model.faces, model.walls
    lightest = float(state.masses.min(initial=np.inf))
    parts = (
        GravityPart(gravity, scene.container.lengths) if gravity else None,
        FacesPart(scene, faces, unit_mass, lightest) if faces else None,
        WarmWallsPart(scene, walls.warm, lightest) if walls and walls.warm else None,
        MovingWallPart(walls.moving, unit_mass) if walls and walls.moving else None,
        ShearPart(scene, state, model.shear) if model.shear else None,
        VibratingPart(scene, faces.motion) if faces and faces.motion else None,
        PistonPart(faces.piston, scene) if faces and faces.piston else None,
        OpenPart(scene, faces.open, model.reservoirs) if faces and faces.open else None,
        LawPart(law) if law else None,
        DurationPart(law, law.duration, gravity) if law and law.duration else None,
        kicks(scene, seed, unit_mass),
        rest_watch(scene, state),
        EventPerAreaPart(scene, state, unit_mass) if scene.has_unequal_areas else None,
    )
    return [part for part in parts if part]


def wrap(positions: np.ndarray, images: np.ndarray, space: Space) -> None:
    """Put particles back that rounding shows beyond a periodic face, which they reach just now."""
    lengths = np.array(space.lengths)
    outside = ((positions < 0.0) | (positions >= lengths)) & space.periodic
    if not outside.any():
        return
    beyond = np.nonzero(outside)
    there, length = positions[beyond], lengths[beyond[1]]
    crossed = np.where(there < 0.0, -1, 1)
    there = there - crossed * length
    positions[beyond] = np.where(there >= length, 0.0, there)
    images[beyond] += crossed
