"""A gas in uniform shear, without walls (`scene.faces.LeesEdwards`).

The flow is along the first axis, its gradient along the second; particles have the mass 1. The gas heats.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.run import Run
from gaspart.analysis.series import Blocks
from gaspart.analysis.statistics import jackknife
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.points.point import Point

_AXES = {"y": 0, "x": 1, "z": 2}  # of the container, by name as of walls across x: x is that of the gradient


def uniform(point: Point, blocks: int) -> dict[str, Any]:
    """Measure the numbers of a sheared gas, as in a flow between walls.

    viscosity : response divided by Enskog's viscosity at the temperature of the time. reduced_rate : stress
        over pressure. normal_x, _y, _z : pressure along gradient, flow and vorticity over their mean, minus
        1.

    Errors are by leaving out each block of time, of which each run has `blocks`.
    """
    scene = point.scene
    series = [
        np.concatenate(parts) for parts in zip(*(_blocks(run, blocks) for run in runs(point)), strict=True)
    ]
    estimates = Estimate(*jackknife(_numbers, *series), len(series[0]) - 1)
    names = ("viscosity", "reduced_rate", *(f"normal_{name}" for name in _AXES))
    return {"packing_fraction": scene.packing_fraction, **dict(zip(names, estimates, strict=True))}


def _blocks(run: Run, blocks: int) -> tuple[np.ndarray, np.ndarray]:
    """Compute the pressure tensor in blocks of a run, and the stress by Enskog.

    The shapes are (K, d, d) and (K,).
    """
    parts, scene = Blocks(run, blocks), run.scene
    pressures = parts.growth("stress_sum") / scene.container.volume
    root = np.sqrt(run.temperatures)
    unit = float(theory.enskog_viscosity(scene.packing_fraction, 3, 2.0 * scene.smallest_radius))
    assert scene.shear_rate is not None
    return pressures, scene.shear_rate * parts.means(unit * 0.5 * (root[1:] + root[:-1]))


def _numbers(pressures: np.ndarray, expected: float) -> np.ndarray:
    """Compute the numbers of `uniform`, from averages over stretches."""
    along = np.diag(pressures)
    mean, stress = along.mean(), -pressures[1, 0]
    return np.array([stress / expected, stress / mean, *(along[list(_AXES.values())] / mean - 1.0)])
