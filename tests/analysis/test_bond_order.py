import numpy as np
import pytest
from scenes import gas
from scipy.spatial import Delaunay

from gaspart.analysis import bond_order as structure
from gaspart.state.initial import initial_state

HEXAGONAL = np.array([16.0, 8.0 * np.sqrt(3.0)])


def triangular():
    """256 sites of spacing 1, in rows of 16 along x."""
    n, m = np.meshgrid(np.arange(16), np.arange(16), indexing="ij")
    return np.stack([(n + 0.5 * (m % 2)).ravel(), (m * np.sqrt(0.75)).ravel()], axis=1)


def fluid(dimension, seed=1):
    lengths = np.array([16.0, 8.0 * np.sqrt(3.0), 9.0])[:dimension]
    return np.random.default_rng(seed).random((600, dimension)) * lengths, lengths


def test_hexatic_order_of_a_crystal_and_its_direction():
    psi = structure.hexatic(triangular() + 0.3, HEXAGONAL)
    assert abs(psi.mean()) == pytest.approx(1.0, abs=1e-5)
    assert np.angle(psi.mean()) == pytest.approx(0.0, abs=1e-4)
    turned = structure.hexatic(triangular()[:, ::-1], HEXAGONAL[::-1])
    assert abs(np.angle(turned.mean())) == pytest.approx(
        np.pi, abs=1e-4
    )  # rows along y: turned by 30 degrees


def voronoi_order(positions, lengths):
    """psi_6 of discs by the edges of a Delaunay triangulation of their 9 periodic images."""
    shifts = np.array([(i, j) for i in (0, -1, 1) for j in (0, -1, 1)]) * lengths
    images = (positions + shifts[:, None]).reshape(-1, 2)
    indptr, indices = Delaunay(images).vertex_neighbor_vertices
    values = []
    for n in range(len(positions)):
        bonds = images[indices[indptr[n] : indptr[n + 1]]] - images[n]
        values.append(np.exp(6j * np.arctan2(bonds[:, 1], bonds[:, 0])).mean())
    return np.array(values)


def test_hexatic_order_of_disordered_discs_is_about_voronoi_neighbours():
    positions, lengths = fluid(2)
    found = structure.hexatic(positions, lengths)
    # single precision of coordinates turns the shortest bonds; the six nearest are off by 0.8
    assert np.abs(found - voronoi_order(positions, lengths)).max() < 1e-3
    assert abs(found).mean() == pytest.approx(0.366, abs=0.02)  # six nearest: below


def test_steinhardt_order_of_a_crystal_and_a_fluid():
    state = initial_state(gas(3, 256, 0.5, "periodic", arrangement="lattice"), seed=1)
    assert structure.global_steinhardt(state.positions, state.lengths) == pytest.approx(0.57452, abs=1e-4)
    assert structure.local_steinhardt(state.positions, state.lengths) == pytest.approx(0.57452, abs=1e-3)
    positions, lengths = fluid(3)
    assert structure.global_steinhardt(positions, lengths) < 0.05
    assert structure.local_steinhardt(positions, lengths).mean() < 0.25


def test_structure_factor_of_a_crystal_is_its_reciprocal_lattice():
    x, y, factor = structure.structure_factor([triangular()], HEXAGONAL, 8.0)
    peaks = np.argwhere(factor > 1.0)
    found = {(round(x[i] / (2 * np.pi), 3), round(y[j] / (2 * np.pi), 3)) for i, j in peaks}
    row, half = round(2 / np.sqrt(3.0), 3), round(1 / np.sqrt(3.0), 3)
    assert found == {(0, row), (0, -row), (1, half), (1, -half), (-1, half), (-1, -half)}
    assert factor[tuple(peaks[0])] == pytest.approx(256.0)


@pytest.mark.parametrize("side", [1e-6, 40.0, 1.12e5, 1e7])
def test_the_unit_of_length_does_not_matter(side):
    places = np.random.default_rng(1).random((16, 2))
    found = [structure.hexatic(places * each, (each, each)) for each in (side, 8.0)]
    assert np.allclose(*found, atol=1e-4)
