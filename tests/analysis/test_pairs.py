"""The structure factor and the insertion of particles, against exact cases and brute force."""

import numpy as np
import pytest
from scenes import gas
from scipy.spatial import cKDTree

import gaspart as gp
from gaspart.analysis.insertion import _find_covered_cells, _is_sampled, insertions
from gaspart.analysis.structure_factors import shells_of, wave_vectors

A = gp.analysis
SCENES = {
    2: gp.Scene(gp.Container((12.0, 16.0), "periodic"), [gp.Species(75, 0.5, temperature=1.0)]),
    3: gp.Scene(gp.Container((6.0, 7.0, 8.0), "periodic"), [gp.Species(130, 0.5, temperature=1.0)]),
}


@pytest.fixture(scope="module", params=SCENES)
def fluid(request, tmp_path_factory):
    """Fluids at packing fractions 0.31 and 0.2: 65 and 90 collisions of each particle."""
    path = tmp_path_factory.mktemp("fluids") / "a.nc"
    return gp.run(SCENES[request.param], gp.EventDriven(), 2, 24.0, 0.1, path)


@pytest.mark.parametrize("lengths", [(5.0, 9.0), (4.0, 5.0, 7.0)])
def test_one_of_each_pair_of_admitted_wave_vectors_is_found(lengths):
    waves, size = wave_vectors(lengths, 4.0)
    assert size == pytest.approx(np.linalg.norm(2.0 * np.pi * waves / lengths, axis=1))
    assert (np.diff(size) >= 0.0).all() and 0.0 < size[0] == pytest.approx(2.0 * np.pi / max(lengths))
    both = {*map(tuple, waves), *map(tuple, -waves)}
    around = np.stack(np.meshgrid(*[np.arange(-6, 7)] * len(lengths)), axis=-1).reshape(-1, len(lengths))
    inside = around[np.linalg.norm(2.0 * np.pi * around / lengths, axis=1) <= 4.0]
    assert len(both) == 2 * len(waves) == len(inside) - 1 and both < set(map(tuple, inside))


def test_shells_of_a_large_container_are_admitted_and_few():
    lengths = np.array([300.0, 250.0, 280.0])
    waves, shell, k = shells_of(lengths, 20.0, 40, 8)
    assert np.bincount(shell).tolist() == [8] * 40 == [8] * len(k)
    assert (waves == waves.astype(int)).all() and len(set(map(tuple, waves))) == len(waves)
    assert k == pytest.approx(0.5 * (np.arange(40) + 0.5), abs=0.25)


@pytest.mark.parametrize(
    ("lengths", "number"), [((5.0, 9.0), (7, 40)), ((9.0, 1.3), (30, 9)), ((4.0, 5.0, 3.0), (9, 12, 10))]
)
def test_the_cells_that_particles_cover_are_those_whose_corners_all_are_near_one(lengths, number):
    """Of two groups of particles, between periodic faces, one of which is nearer than twice the distance."""
    size, number = np.array(lengths), np.array(number)
    positions, sides = np.random.default_rng(5).random((8, len(size))) * size, size / number
    groups = [(positions[:3], 1.2), (positions[3:], 0.8)]
    distances = np.repeat([distance for _, distance in groups], [3, 5])
    centres = (np.argwhere(np.ones(number)) + 0.5) * sides
    images = np.stack(np.meshgrid(*[(-1, 0, 1)] * len(size)), axis=-1).reshape(-1, len(size)) * size
    apart = np.abs(centres[:, None, None] - positions[:, None] - images)
    furthest = np.sqrt(((apart + 0.5 * sides) ** 2).sum(axis=-1)).min(axis=2)
    expected = (furthest <= distances).any(axis=1)
    assert 0.1 < expected.mean() < 0.9
    assert np.array_equal(_find_covered_cells(groups, sides, number), expected)


def test_the_chemical_potential_agrees_with_theory(fluid):
    found = A.chemical_potential(fluid, trials=256)
    assert abs(float(found.deviation)) < 4.0
    assert float(found.error) < 0.06 * float(found.estimate)
    assert float(found["probability"]) == pytest.approx(np.exp(-float(found.estimate)))
    assert float(found["resolution"]) < 1e-4 < float(found["probability"])
    assert int(found["frames_with_success"]) <= int(found["successes"])
    assert found.plot(theory=True).get_ylabel()


@pytest.mark.thorough
def test_a_chemical_potential_has_no_error_without_the_frames_that_contribute_most(tmp_path):
    """100 spheres at 0.48, where 15.2 is known: 3 of 193 frames have a free place, and 21.8(7) was stated."""
    scene = gas(3, 100, 0.48, arrangement="compressed", exact_temperature=True)
    path = gp.run(scene, gp.EventDriven(), 3, 34.1, 34.1 / 256.0, tmp_path / "a.nc")
    found = A.chemical_potential(path)
    assert 0 < int(found["frames_with_success"]) < 8
    assert np.isnan(float(found.error)) and np.isnan(float(found["probability_error"]))
    assert "probably too large" in found.attrs["note"] and found.summary


@pytest.mark.parametrize(
    ("deviation", "frames", "sampled"),
    [(0.3, 200, True), (1.0, 200, True), (3.0, 200, False), (2.0, 2000, True), (4.0, 2000, False)],
)
def test_lognormal_probabilities_need_many_frames_or_little_scatter(deviation, frames, sampled):
    values = np.exp(deviation * np.random.default_rng(4).standard_normal(frames))
    error = float(values.std() / values.mean()) / np.sqrt(frames)
    assert _is_sampled(values, error) == sampled


@pytest.mark.parametrize("dimension", [2, 3])
def test_insertion_where_particles_may_fit_is_insertion_everywhere(dimension):
    """One frame: the free part of the container, by 2e5 places everywhere."""
    simulation = gp.Simulation(SCENES[dimension], gp.EventDriven(), 1)
    simulation.advance(duration=2.0)
    lengths, positions = np.array(SCENES[dimension].container.lengths), simulation.state.positions
    found = insertions(positions[None], lengths, [(slice(None), 1.0)], 20_000)
    everywhere = np.random.default_rng(5).random((200_000, dimension)) * lengths
    nearest, _ = cKDTree(positions % lengths, boxsize=lengths).query(everywhere)
    free = float((nearest > 1.0).mean())
    error = np.sqrt(free / 200_000 + free * found.share[0] / 20_000)
    assert abs(float(found.probability[0]) - free) < 4.0 * error < 0.3 * free
    assert found.share[0] < 0.9 and found.resolution == pytest.approx(found.share[0] / 20_000)


def test_a_crystal_has_no_room(tmp_path):
    scene = gp.Scene(
        gp.Container((4.7,) * 3, "periodic"), [gp.Species(108, 0.5, temperature=1.0, arrangement="lattice")]
    )
    path = gp.run(scene, gp.EventDriven(), 1, 1.0, 0.02, tmp_path / "a.nc")
    with pytest.raises(gp.SceneError, match=r"packing_fraction = 0\.544.*: of 8 places in each of"):
        A.chemical_potential(path, trials=8)


def test_a_wave_number_below_the_longest_wave_is_refused(tmp_path):
    periodic = gp.Scene(gp.Container((9.0, 9.0), "periodic"), [gp.Species(20, 0.5, temperature=1.0)])
    path = gp.run(periodic, gp.EventDriven("direct"), 1, 4.0, 0.1, tmp_path / "c.nc")
    with pytest.raises(gp.SceneError, match=r"highest = 0\.5: must be above that of the longest wave"):
        A.structure_factor(path, highest=0.5)
