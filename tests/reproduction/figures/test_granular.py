"""Inelastic and driven gases: what is read of frames that are known exactly."""

import numpy as np
import pytest
import xarray as xr
from reproduction.made import made

import gaspart as gp
from gaspart.analysis.run import Run
from gaspart.reproduction.figure import runs
from gaspart.reproduction.figures import cooling, driven_gas


def test_number_variance_of_equal_cells_is_zero_and_of_one_cell_is_largest():
    scene = gp.Scene(gp.Container((4.0, 4.0), "periodic"), [gp.Species(8, 0.1)])
    even = np.array([[x + 0.5, y + 0.5] for x in (0, 1) for y in (0, 1)] * 2)
    frames = np.stack([2.0 * even, np.full((8, 2), 4.0)])  # the last on the upper boundary
    positions = xr.Dataset({"coordinates": (("frame", "atom", "spatial"), frames)})
    assert cooling.number_variance(Run(scene, np.arange(2.0), positions), 2) == pytest.approx([0.0, 6.0])


def test_the_cumulant_is_that_of_the_velocities(tmp_path):
    """Of one frame with known speeds: those of the centre of mass are left out."""
    particles = [
        gp.Particle((2.0 + 3.0 * n, 5.0), (v + 7.0, 0.5), 0.1) for n, v in enumerate((1.0, -1.0, 2.0, -2.0))
    ]
    scene = gp.Scene(
        gp.Container((100.0, 10.0), "periodic"), particles=particles, species=[gp.Species(0, 0.1)]
    )
    scene.to_file(tmp_path / "scene.yaml")
    point = made(tmp_path, "still", scene, duration=0.001, samples=1, replicas=1)
    (found,) = [driven_gas.means(run) for run in runs(point)]
    squares = np.array([1.0, 1.0, 4.0, 4.0])
    assert found["temperature"] == pytest.approx(squares.mean() * 4 / (2 * 3), rel=1e-6)
    assert found["cumulant"] == pytest.approx(
        2 * (squares**2).mean() / (4 * squares.mean() ** 2) - 1, rel=1e-6
    )
