"""What the kernels of the event-driven engine are compiled for and work with: the model of a scene, and what
watches for a collapse."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaspart.engines.arrays import (
    contact_duration,
    contact_law,
    interior_walls,
    internal_arrays,
    scaled_masses,
    special_faces,
)
from gaspart.engines.event.stalling import MOST_OF_STACK
from gaspart.scene.scene import Scene
from gaspart.state.boxes import Boxes
from gaspart.state.state import State

if TYPE_CHECKING:
    from gaspart.kernels.event.monitors import Monitors
    from gaspart.kernels.model import Model

_OF_DURATION = ("latest", "met", "island", "elastic", "kept")  # the arrays of a contact duration
_LOWEST = 2.0**-44  # of the container: the highest bounce on an interior wall that is taken for rest
# More contacts of one particle than these, within so much of an epoch, are taken for a collapse. Where the
# restitution is constant, intervals between contacts shrink geometrically until rounding lets the particles
# part, so few of them can be seen. Slow contacts of viscoelastic particles are nearly elastic.
_MOST, _INTERVAL = 1000, 2.0**-44
_INELASTIC_MOST, _INELASTIC_INTERVAL = 12, 2.0**-34
# Elastic particles do not collapse: between two surfaces that meet at an angle a, one of them has pi/a
# contacts at one time. Gravity lets them touch for ever in a stack.
_UNLIMITED = np.iinfo(np.int64).max


def event_model(
    scene: Scene, state: State, seed: int | tuple[int, ...], boxes: Boxes, largest: float
) -> tuple[Model, float]:
    """The model of a scene, and its unit of mass. largest: the largest radius of the particles in boxes."""
    from gaspart.kernels import model

    law = contact_law(scene, state)
    law = law._replace(duration=contact_duration(scene)) if law else None
    unit_mass, masses = (1.0, None) if law else scaled_masses(state.masses)
    gravity = None
    if scene.gravity is not None:
        support = (
            model.no_support(state.count, _LOWEST * max(scene.container.lengths)) if scene.walls else None
        )
        gravity = model.Gravity(scene.gravity, np.isinf(state.masses), 0.0, support)
    oversized = np.flatnonzero(state.radii > largest)
    found = model.Model(
        space=model.Space(
            scene.container.lengths, scene.container.periodic, float(not scene.centres_to_walls)
        ),
        masses=masses,
        gravity=gravity,
        law=law,
        faces=special_faces(scene, state, seed, unit_mass) if scene.faces else None,
        walls=interior_walls(scene, boxes, largest) if scene.walls else None,
        oversized=model.Oversized(oversized, largest) if len(oversized) else None,
    )
    return found, unit_mass


def monitors(model: Model, count: int) -> tuple[Monitors, float]:
    """What detects a collapse, if one is possible, and its interval as a part of an epoch."""
    from gaspart.kernels.event.monitors import CollapseWatch, Monitors

    law = model.law
    if not (law or model.gravity):
        return Monitors(None, None), 0.0
    most, interval = _MOST, _INTERVAL
    if law and law.normal < 1.0 and law.viscous is None and not law.duration:
        most, interval = _INELASTIC_MOST, _INELASTIC_INTERVAL
    elif law is None or (law.normal == 1.0 and abs(law.tangential) == 1.0 and law.vibrations is None):
        most = MOST_OF_STACK if model.gravity else _UNLIMITED
    watch = CollapseWatch(np.full(count, -np.inf), np.zeros(count, dtype=np.int64), 0.0, most)
    return Monitors(None, watch), interval


def changing(model: Model) -> dict[str, np.ndarray]:
    """The arrays of a model that a run changes, by name."""
    law, faces, gravity = model.law, model.faces, model.gravity
    arrays = internal_arrays(law, faces)
    if law and law.duration:
        arrays |= {f"contact_{key}": getattr(law.duration, key) for key in _OF_DURATION}
        if gravity:
            arrays["gravity_fixed"] = gravity.fixed
    if gravity and gravity.support:
        support = gravity.support._asdict()
        arrays |= {f"support_{key}": support[key] for key in support if key != "height"}
    if faces and faces.piston:
        arrays["piston"] = faces.piston.motion
    return arrays
