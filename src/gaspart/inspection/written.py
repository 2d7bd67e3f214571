"""Judging what people write: scene files, and configs of the workflow."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from gaspart import config, grid
from gaspart.inspection.checks import Check, judge_places
from gaspart.inspection.frames import Frames
from gaspart.scene import Scene


def judge_scene(path: Path, tolerance: float | None = None) -> list[Check]:
    """Can it be, and can its bodies be placed? Raises SceneError where it cannot."""
    from gaspart.initial import initial_state

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
        points = [point for name in merged["experiments"] for point in grid.points(merged, name)]
        bodies = np.array([grid.extents(point)[0] for point in points])
    text = f"{len(merged['experiments'])} experiments of {len(points)} points, up to {bodies.max()} bodies; "
    return [Check("config", True, text + f"{len(merged['figures'])} figures")]
