"""The deepest overlap of particles of any sizes."""

import tracemalloc

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaspart.state.boxes import deepest_overlap


@given(st.integers(0, 10**6))
def test_the_deepest_overlap_is_that_of_all_pairs(seed):
    rng = np.random.default_rng(seed)
    count, d = rng.integers(1, 40), rng.integers(2, 4)
    lengths, periodic = rng.uniform(1.0, 6.0, d), rng.integers(0, 2, d).astype(bool)
    radii, places = 10.0 ** rng.uniform(-2.0, 0.2, count), rng.random((count, d)) * lengths
    gap = places[:, None] - places
    gap -= np.where(periodic, lengths * np.round(gap / lengths), 0.0)
    depth = 1.0 - np.sqrt((gap**2).sum(axis=2)) / (radii[:, None] + radii)
    np.fill_diagonal(depth, 0.0)
    own = 1.0 - np.where(periodic, lengths, np.inf).min() / (2.0 * radii.max())
    found = deepest_overlap(places, radii, lengths, tuple(periodic))
    assert found == pytest.approx(max(0.0, depth.max(), own), abs=1e-12)


def test_a_large_particle_does_not_make_all_small_ones_neighbours():
    rng = np.random.default_rng(4)
    places = rng.random((4000, 3)) * 30.0
    places = places[((places - 15.0) ** 2).sum(axis=1) > 9.0**2]
    places, radii = np.vstack([[[15.0] * 3], places]), np.append(8.0, np.full(len(places), 0.05))
    reached = []

    class Counted(np.ndarray):
        """Positions that tell how many pairs are looked at."""

        def __getitem__(self, key):
            found = super().__getitem__(key)
            reached.append(len(found))
            return found

    deepest_overlap(places.view(Counted), radii, np.full(3, 30.0), (False,) * 3)
    assert sum(reached) < 10 * len(places)


@pytest.mark.parametrize("periodic", [True, False])
@pytest.mark.parametrize("width", [0.0, 1e-3])
def test_a_heap_of_particles_is_no_list_of_all_pairs(width, periodic):
    """20000 in one place have 2e8 pairs, of 3 GB; those of a file whose positions were never set are such."""
    rng = np.random.default_rng(5)
    positions = 5.0 + width * rng.random((20000, 3))
    tracemalloc.start()
    deepest = deepest_overlap(positions, np.full(20000, 0.5), np.full(3, 10.0), (periodic,) * 3)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 100e6
    assert deepest == 1.0 if width == 0.0 else 1.0 - 1e-4 < deepest < 1.0


@given(st.integers(0, 10**6), st.floats(1e-6, 0.3))
def test_the_deepest_overlap_in_a_heap_is_that_of_all_pairs(seed, width):
    rng = np.random.default_rng(seed)
    positions = 2.0 + width * rng.random((150, 3))
    radii = rng.uniform(0.3, 0.9, 150)
    apart = np.sqrt(((positions[:, None] - positions) ** 2).sum(axis=2))
    depth = 1.0 - apart / (radii[:, None] + radii)
    np.fill_diagonal(depth, 0.0)
    assert deepest_overlap(positions, radii, np.full(3, 4.0), (False,) * 3) == pytest.approx(depth.max())
