"""Validation of configs of the workflow."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from gaspart.inspection.checks import Check
from gaspart.reproduction import config
from gaspart.reproduction.points import grid
from gaspart.reproduction.points.points import points


def judge_config(path: Path) -> list[Check]:
    """Every point of every grid, and every figure. Raises SceneError for a config that cannot be run.

    A config next to `config.yaml` is merged over it, as in the workflow.
    """
    with config.checked(path) as merged:
        made = [point for name in merged["experiments"] for point in points(merged, name)]
        counts = np.array([grid.extents(point)[0] for point in made])
    text = f"{len(merged['experiments'])} experiments of {len(made)} points, up to {counts.max()} particles; "
    return [Check("config", True, text + f"{len(merged['figures'])} figures")]
