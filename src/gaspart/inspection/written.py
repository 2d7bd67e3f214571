"""Validation of scene files."""

from __future__ import annotations

from pathlib import Path

from gaspart.errors import SceneError
from gaspart.inspection.checks import Check, judge_places
from gaspart.inspection.frames import Frames
from gaspart.scene.scene import Scene
from gaspart.state.initial import initial_state


def judge_scene(path: Path, tolerance: float | None = None) -> list[Check]:
    """Check a scene, and the placement of its particles; raise SceneError for an invalid scene."""
    scene = Scene.from_file(path)
    facts = f"{scene.count} particles, packing fraction {scene.packing_fraction:.6g}"
    checks = [Check("scene", True, f"{facts}, number density {scene.number_density:.6g}")]
    if scene.count < 2:
        return checks
    try:
        state = initial_state(scene, 1)
    except SceneError as error:
        raise error.inside("", str(path)) from None
    periodic = scene.container.periodic
    checks += judge_places(Frames(state.positions[None], state.lengths, state.radii, periodic), tolerance)
    return checks
