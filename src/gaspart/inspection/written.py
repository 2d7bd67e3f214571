"""Judging what people write: scene files, and configs of the workflow."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from gaspart.experiments import config
from gaspart.inspection.checks import Check, judge_places
from gaspart.inspection.frames import Frames
from gaspart.planning import grid
from gaspart.planning.points import points
from gaspart.scene.scene import Scene
from gaspart.state.initial import initial_state


def judge_scene(path: Path, tolerance: float | None = None) -> list[Check]:
    """Can it be, and can its particles be placed? Raises SceneError where it cannot."""
    scene = Scene.from_file(path)
    facts = f"{scene.count} bodies, packing fraction {scene.packing_fraction:.6g}"
    checks = [Check("scene", True, f"{facts}, number density {scene.number_density:.6g}")]
    if scene.count < 2:
        return checks
    state = initial_state(scene, 1)
    periodic = scene.container.periodic
    checks += judge_places(Frames(state.positions[None], state.lengths, state.radii, periodic), tolerance)
    return checks


def judge_config(path: Path) -> list[Check]:
    """Every point of every grid, and every figure. Raises SceneError for what cannot be run.

    A config beside `config.yaml` is laid over that, as the workflow does.
    """
    with config.checked(path) as merged:
        made = [point for name in merged["experiments"] for point in points(merged, name)]
        bodies = np.array([grid.extents(point)[0] for point in made])
    text = f"{len(merged['experiments'])} experiments of {len(made)} points, up to {bodies.max()} bodies; "
    return [Check("config", True, text + f"{len(merged['figures'])} figures")]
