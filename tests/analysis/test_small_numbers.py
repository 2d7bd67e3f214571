"""Distributions of few particles, whose theory is that of their number."""

import math

import numpy as np
import pytest
from scipy.signal import lfilter

import gaspart as gp
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.profiles import ratio

A = gp.analysis


@pytest.fixture(scope="module")
def twenty(tmp_path_factory):
    """20 spheres at a packing fraction of 0.02: 160 collisions of each."""
    scene = gp.Scene(gp.Container((8.0,) * 3, "periodic"), [gp.Species(20, 0.5, temperature=1.0)])
    return gp.run(scene, gp.EventDriven(), 3, 600.0, 0.3, tmp_path_factory.mktemp("few") / "a.nc")


def test_bins_with_few_counts_state_no_error_but_where_hard_particles_would_overlap(twenty):
    speeds = A.speed_distribution(twenty, bins=80, fastest=10.0)
    g = A.rdf(twenty, bins=2000)
    overlap = g["distance"] + 0.5 * (g["distance"][1] - g["distance"][0]) <= 1.0
    assert (g.error[overlap] == 0.0).all() and not g.estimate[overlap].any()
    for found in (speeds, g[{"distance": ~overlap}]):
        value, error = found.estimate.values, found.error.values
        freedom = found[f"{found.attrs['quantity']}_freedom"].values
        once = (value > 0.0) & (value < 1.5 * value[value > 0.0].min())  # counted once or twice, or never
        for few in (value == 0.0, once):
            assert few.any() and np.isnan(error[few]).all() and np.isnan(freedom[few]).all()
        known = np.isfinite(error)
        assert known.any() and (error[known] > 0.0).all()
        assert (freedom[known] >= 2.0).all() and (freedom[known] <= 15.0).all()


def test_an_empty_histogram_has_no_error(tmp_path):
    scene = gp.Scene(gp.Container((20.0,) * 3, "periodic"), [gp.Species(20, 0.05, temperature=1.0)])
    found = A.rdf(gp.run(scene, gp.EventDriven(), 1, 0.2, 0.01, tmp_path / "a.nc"))
    assert not found.estimate.any()
    assert (np.isnan(found.error.values) == (found["distance"] > 0.1)).all()


def test_faces_that_are_hardly_hit_have_no_error(tmp_path):
    scene = gp.Scene(gp.Container((20.0,) * 3), [gp.Species(20, 0.05, temperature=1.0)])
    path = gp.run(scene, gp.EventDriven(), 1, 2.0, 0.1, tmp_path / "a.nc")
    for found in (A.wall_pressure(path), A.wall_force(path)):
        assert (found.estimate == 0.0).any() and (found.estimate > 0.0).any()
        assert np.isnan(found.error[found.estimate == 0.0]).all()
    still = gp.Scene(gp.Container((20.0,) * 3), [gp.Species(20, 0.05, temperature=0.0)])
    found = A.wall_pressure(gp.run(still, gp.EventDriven(), 1, 2.0, 0.1, tmp_path / "b.nc"))
    assert not found.estimate.any() and not found.error.any()


def test_a_cell_that_is_hardly_visited_has_no_error():
    room, visits = np.ones((64, 3)), np.zeros((64, 3))
    visits[7, 0] = visits[::3, 1] = 1.0
    found = ratio(visits, room, counted=True)
    assert np.isnan(found.errors[[0, 2]]).all() and found.errors[1] > 0.0
    assert found.freedoms[1] <= 21.0


@pytest.mark.parametrize("name", ["speeds", "rdf", "structure_factor", "msd", "vacf", "D"])
def test_errors_from_the_scatter_of_groups_state_their_degrees_of_freedom(name, twenty):
    result = gp.measure(twenty, name)
    freedom = result[f"{result.attrs['quantity']}_freedom"]
    assert freedom.dims == result.estimate.dims
    known = np.isfinite(result.error.values)
    assert known.any() and (freedom.values[known] <= 15.0).all() and np.isnan(freedom.values[~known]).all()
    assert (freedom.values == 15.0).any()


def test_cells_state_no_more_degrees_of_freedom_than_their_common_correlation_allows():
    """Series of 193 frames with five independent ones, as of a dense fluid in a short run."""
    generator, deviations, phi = np.random.default_rng(5), [], 0.95
    for _ in range(30):
        series = lfilter([1.0], [1.0, -phi], generator.normal(size=(1193, 40)), axis=0)[1000:]
        means = ratio(series, np.ones_like(series))
        deviations.append(Estimate(means.values, np.nan_to_num(means.errors), means.freedoms).deviation)
    z = np.concatenate(deviations)
    z = z[np.isfinite(z)]
    assert z.size > 800 and abs(z).max() < 3.5 and 0.75 < np.sqrt((z**2).mean()) < 1.15


def about_the_centre_of_mass(side, total, bins):
    """Density in bins of two discs of diameter 1, whose coordinates have a fixed sum: the difference of the
    coordinates has as much room as the other axis leaves."""
    fine = (np.arange(bins * 400) + 0.5) * side / (bins * 400)
    apart = np.abs((2.0 * fine - total + 0.5 * side) % side - 0.5 * side)
    room = side - 2.0 * np.sqrt(np.maximum(1.0 - apart**2, 0.0))
    return 2.0 / side**2 * (room / room.mean()).reshape(bins, -1).mean(axis=1)


@pytest.mark.thorough
def test_the_density_of_two_discs_is_that_about_their_centre_of_mass():
    deviations, uniform, side = [], [], math.sqrt(2.0 * math.pi / 4.0 / 0.3)
    kind = gp.Species(2, 0.5, temperature=1.0, arrangement="compressed", exact_temperature=True)
    scene = gp.Scene(gp.Container((side, side), "periodic"), [kind])
    for seed in range(20):
        simulation = gp.Simulation(scene, gp.EventDriven(), seed)
        total = float(simulation.state.positions[:, 0].sum())
        simulation.advance(1000.0)
        found = A.profile(simulation, axis="x", bins=20)
        assert found.theory is None
        exact = about_the_centre_of_mass(side, total, 20)
        measured = Estimate.of(found, "density")
        deviations.append((measured - exact).deviation)
        uniform.append((measured - 2.0 / side**2).deviation)
    z, without = (np.array(one)[np.isfinite(one)] for one in (deviations, uniform))
    assert z.size > 330 and abs(z).max() < 4.0 and 0.75 < np.sqrt((z**2).mean()) < 1.1
    assert np.sqrt((without**2).mean()) > 1.6


@pytest.mark.parametrize(("count", "stated"), [(3, False), (15, False), (16, True)])
def test_density_has_a_theory_where_the_fixed_centre_of_mass_does_not_matter(count, stated):
    scene = gp.Scene(gp.Container((8.0, 8.0), "periodic"), [gp.Species(count, 0.5, temperature=1.0)])
    for engine, known in ((gp.EventDriven(), stated), (gp.DSMC(), True)):
        simulation = gp.Simulation(scene, engine, 1)
        simulation.advance(100.0)
        assert (A.profile(simulation, axis="x").theory is not None) == known
