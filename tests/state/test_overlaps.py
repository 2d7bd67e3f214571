"""The deepest overlap of particles of any sizes."""

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
