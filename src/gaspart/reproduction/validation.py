"""Validation of configs of the workflow."""

from __future__ import annotations

from pathlib import Path

from gaspart.inspection.checks import Check
from gaspart.reproduction import config


def judge_config(path: Path) -> list[Check]:
    """Every point of every grid, and every figure. Raises SceneError for a config that cannot be run.

    A config next to `config.yaml` is merged over it, as in the workflow.
    """
    with config.checked(path) as (merged, planned):
        counts = [point.extents.particles for points in planned.values() for point in points.values()]
    text = f"{len(planned)} experiments of {len(counts)} points, up to {max(counts)} particles; "
    return [Check("config", True, text + f"{len(merged['figures'])} figures")]
