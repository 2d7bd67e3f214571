"""Fields in cells: density, flow and temperature."""

import numpy as np
import pytest

import gaspart as gp
from gaspart.errors import SceneError


@pytest.fixture(scope="module")
def sheared(tmp_path_factory):
    """Rare discs between plates that slide against one another, and heat what they hit."""
    faces = {
        "y_low": gp.Thermal(1.0, velocity=(-0.5, 0.0)),
        "y_high": gp.Thermal(3.0, velocity=(0.5, 0.0)),
    }
    container = gp.Container((30.0, 20.0), ("periodic", "wall"))
    scene = gp.Scene(container, [gp.Species(120, 0.5, temperature=1.5)], faces=faces)
    path = tmp_path_factory.mktemp("sheared") / "sheared.nc"
    return gp.run(scene, gp.EventDriven(), 1, 4000.0, 4.0, path)


def test_density_adds_up_and_is_uniform(tmp_path):
    scene = gp.Scene(gp.Container((12.0, 8.0), "periodic"), [gp.Species(40, 0.5, temperature=1.0)])
    path = gp.run(scene, gp.EventDriven(), 1, 800.0, 2.0, tmp_path / "gas.nc")
    found = gp.analysis.field(path, "density", cells=(6, 4))
    assert found.estimate.dims == ("x", "y")
    assert float(found.estimate.mean()) == pytest.approx(40.0 / 96.0, rel=1e-12)
    z = ((found.estimate - 40.0 / 96.0) / found.error).values
    assert 0.5 < z.std() < 1.6


def test_flow_follows_the_plates(sheared):
    found = gp.analysis.field(sheared, "velocity", "y", cells=5)
    along, across = found.estimate.sel(component="x"), found.estimate.sel(component="y")
    assert (np.diff(along) > 0.0).all()
    assert abs(float(along[2])) < 3.0 * float(found.error.sel(component="x")[2])
    assert (abs(across) < 4.0 * found.error.sel(component="y")).all()


def test_temperature_is_about_the_flow(sheared):
    """Against a direct sum over the frames, and between those of the plates."""
    found = gp.analysis.field(sheared, "temperature", "y", cells=4, start=0.0)
    with gp.open_trajectory(sheared) as data:
        places, velocities = data["coordinates"].values[:, :, 1], data["velocities"].values.astype(float)
    for n in range(4):
        inside = velocities[np.clip(places // 5.0, 0, 3) == n]
        about = inside - inside.mean(axis=0)
        expected = 0.5 * (about**2).sum(axis=1).mean()
        assert float(found.estimate[n]) == pytest.approx(expected, rel=0.02)  # a mean of stretches
        assert 1.0 < float(found.estimate[n]) < 3.0
    assert (np.diff(found.estimate) > 0.0).all()


def test_species_apart_and_three_axes():
    kinds = [gp.Species(30, 0.3, temperature=1.0), gp.Species(10, 0.5, temperature=1.0)]
    simulation = gp.Simulation(gp.Scene(gp.Container((6.0,) * 3), kinds), gp.EventDriven(), seed=1)
    simulation.advance(duration=10.0)
    whole = gp.analysis.field(simulation, axes="xyz", cells=2)
    large = gp.analysis.field(simulation, axes="xyz", cells=2, species=1)
    assert float(whole.estimate.sum() * 27.0) == pytest.approx(40.0)
    assert float(large.estimate.sum() * 27.0) == pytest.approx(10.0)
    with pytest.raises(SceneError, match="choose a layer"):
        whole.plot()
    assert whole.isel(z=0).plot().collections
    cells = gp.analysis.field(simulation, axes="xyz", cells=3)  # more than are written out
    assert (
        "<img" not in cells._repr_html_() and "<img" in gp.analysis.field(simulation, cells=4)._repr_html_()
    )


def test_empty_cells_have_no_temperature():
    scene = gp.Scene(gp.Container((40.0, 40.0)), [gp.Species(3, 0.5, temperature=1.0)])
    simulation = gp.Simulation(scene, gp.EventDriven(), seed=1)
    simulation.advance(duration=20.0)
    found = gp.analysis.field(simulation, "temperature", cells=20)
    assert np.isnan(found.estimate).any()


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        ({"of": "pressure"}, "must be one of"),
        ({"axes": "xz"}, "must be some of xy"),
        ({"axes": "xx"}, "each once"),
        ({"cells": (3, 4, 5)}, "must be one number, or 2"),
        ({"cells": 0}, "cells = 0"),
        ({"species": 1}, "species = 1"),
    ],
)
def test_refusals(sheared, arguments, line):
    with pytest.raises(SceneError, match=line):
        gp.analysis.field(sheared, **arguments)


def test_plot_of_a_flow_has_arrows(sheared):
    axis = gp.analysis.field(sheared, "velocity", cells=(6, 4)).plot()
    assert axis.collections
