"""Fields in cells: density, flow and temperature."""

import numpy as np
import pytest

import gaspart as gp
from gaspart.analysis.flow import Grid
from gaspart.analysis.profiles import ratio
from gaspart.analysis.run import open_run
from gaspart.analysis.series import Blocks, over
from gaspart.errors import SceneError


@pytest.fixture(scope="module")
def sheared(tmp_path_factory):
    """Rare discs between plates that slide against one another, and heat what they hit."""
    faces = {"y_low": gp.Thermal(1.0, velocity=(-0.5, 0.0)), "y_high": gp.Thermal(3.0, velocity=(0.5, 0.0))}
    container = gp.Container((30.0, 20.0), ("periodic", "wall"))
    scene = gp.Scene(container, [gp.Species(120, 0.5, temperature=1.5)], faces=faces)
    path = tmp_path_factory.mktemp("sheared") / "sheared.nc"
    return gp.run(scene, gp.EventDriven(), 1, 4000.0, 4.0, path)


@pytest.mark.thorough
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


@pytest.mark.thorough
def test_species_apart_and_three_axes():
    kinds = [gp.Species(30, 0.3, temperature=1.0), gp.Species(10, 0.5, temperature=1.0)]
    simulation = gp.Simulation(gp.Scene(gp.Container((6.0,) * 3), kinds), gp.EventDriven(), seed=1)
    simulation.advance(duration=2.0)
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


# Sums in cells, and the errors of means of what is correlated in them.


def correlated(rng, time, blocks=256, cells=400):
    """(blocks, cells) series of variance 1 whose correlation falls by e in this time."""
    kept = np.exp(-1.0 / time)
    found = rng.normal(size=(blocks, cells))
    for k in range(1, blocks):
        found[k] = kept * found[k - 1] + np.sqrt(1.0 - kept**2) * found[k]
    return found


def test_sums_are_those_of_a_histogram():
    rng = np.random.default_rng(1)
    places, weights = rng.random((6, 50, 2)) * [4.0, 9.0], rng.random((6, 50))
    grid = Grid((0.0, 1.0), (4.0, 7.0), (5, 3))
    cells, blocks = grid.cells(places), np.array([0, 0, 1, 1, 2, 2])
    whole = np.histogramdd(places.reshape(-1, 2), grid.edges, weights=weights.ravel())[0]
    assert grid.sums(cells, weights) == pytest.approx(whole)
    apart = grid.sums(cells, blocks=blocks)
    for n in range(3):
        part = places[2 * n : 2 * n + 2].reshape(-1, 2)
        assert np.array_equal(apart[n], np.histogramdd(part, grid.edges)[0])
    assert (cells < 0).any() and (grid.cells(places, inside=True) >= 0).all()
    line = Grid.line(0.0, 1.0, 4)
    assert line.cells(np.array([[0.0], [0.25], [1.0], [1.0001], [-1e-9]])).tolist() == [0, 1, 3, -1, -1]
    assert line.middles[0].tolist() == [0.125, 0.375, 0.625, 0.875] and line.volume == 0.25


@pytest.mark.parametrize("time", [0.2, 4.0, 16.0])
def test_errors_are_those_of_correlated_series(time):
    """Of 400 cells: their values scatter as stated. Sixteen blocks of the slowest are too short: the scatter
    of their means is 1.25 times too small."""
    series = correlated(np.random.default_rng(2), time)
    found = ratio(10.0 + series, np.ones_like(series))
    known = np.isfinite(found.errors)
    scatter = found.values.std(ddof=1)
    stated = np.sqrt(np.mean(found.errors[known] ** 2))
    if time < 10.0:
        assert known.all()
        assert stated / scatter == pytest.approx(1.0, abs=0.12)
    else:
        assert known.mean() > 0.85
        few = series.reshape(16, 16, -1).mean(axis=1).std(axis=0, ddof=1) / 4.0
        assert np.sqrt(np.mean(few**2)) < 0.85 * scatter
        assert stated > 0.9 * scatter
    assert (found.freedoms[known] >= 2.0).all()


def test_too_short_a_run_has_no_error_and_says_so():
    """The correlation lasts as long as the run."""
    series = correlated(np.random.default_rng(3), 256.0)
    found = ratio(10.0 + series, np.ones_like(series))
    assert np.isnan(found.errors).mean() > 0.6
    assert np.isfinite(found.values).all() and (found.freedoms < 2.0).mean() > 0.6


def test_what_does_not_change_has_no_error_and_what_is_empty_no_value():
    above, below = np.ones((20, 2)), np.ones((20, 2)) * [3.0, 0.0]
    found = ratio(above, below)
    assert found.values[0] == pytest.approx(1.0 / 3.0) and found.errors[0] == 0.0
    assert np.isnan([found.values[1], found.errors[1]]).all()


def test_a_cell_that_was_filled_once_has_a_value_without_an_error():
    above, below = np.zeros((20, 1)), np.zeros((20, 1))
    above[7], below[7] = 3.0, 2.0
    found = ratio(above, below)
    assert found.values[0] == 1.5 and np.isnan(found.errors[0]) and found.freedoms[0] == 0.0


def test_blocks_cover_the_intervals_of_a_run():
    scene = gp.Scene(gp.Container((8.0, 8.0)), [gp.Species(20, 0.5, temperature=1.0)])
    sim = gp.Simulation(scene, gp.EventDriven(), 1)
    sim.advance(duration=20.0)
    with open_run(sim, 0.0) as run:
        blocks = Blocks(run, 5)
        hits = run.data["wall_hits"].values
        rates = np.diff(hits[:: blocks.length][:6], axis=0) / np.diff(run.time[:: blocks.length][:6])[:, None]
        assert blocks.growth("wall_hits") == pytest.approx(rates)
        assert blocks.means(run.increments("wall_hits")) == pytest.approx(rates * run.interval)
        grid = Grid.line(0.0, 8.0, 4)
        counts = blocks.sums(grid, grid.cells(run.positions[..., :1], inside=True))
        assert counts.shape == (5, 4) and (counts.sum(axis=1) == 20 * blocks.length).all()
        assert over(np.arange(10.0), np.array([0, 4, 10])).tolist() == [6.0, 39.0]
        with pytest.raises(ValueError, match="blocks: 1000"):
            Blocks(run, 1000).durations.sum()
