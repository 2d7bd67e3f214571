"""Deepest overlap of particles of any sizes, in time and memory that grow as their number."""

from __future__ import annotations

from itertools import chain, combinations_with_replacement

import numpy as np


def deepest_overlap(
    positions: np.ndarray, radii: np.ndarray, lengths: np.ndarray, periodic: tuple[bool, ...]
) -> float:
    """Return the relative overlap of the pair of particles that overlaps most, by nearest images.

    Parameters
    ----------
    positions : ndarray, shape (N, d), [length]
        Positions, on periodic axes in [0, L].
    radii : ndarray, shape (N,), [length]
        Radii.
    lengths : ndarray, shape (d,), [length]
        Lengths of the container.
    periodic : tuple of bool, shape (d,)
        True for periodic axes.

    Returns
    -------
    float, [1]
        1 - distance / contact distance, or 0 without an overlap. A particle wider than a periodic side
        overlaps its own image.

    Notes
    -----
    Particles are sorted into classes of sizes within a factor of two, with a tree for each class. So a search
    reaches no farther than its pair of classes may touch.
    """
    from scipy.spatial import cKDTree  # which few runs need

    if not len(positions):
        return 0.0
    sides = np.where(periodic, lengths, 0.0)
    on_itself = 1.0 - np.where(periodic, lengths, np.inf) / (2.0 * radii.max())
    deepest = max(0.0, float(on_itself.max()))
    octave = np.floor(np.log2(radii / radii.min())).astype(int)
    members = [np.flatnonzero(octave == k) for k in np.unique(octave)]
    trees = [cKDTree(positions[indices], boxsize=sides) for indices in members]
    for a, b in combinations_with_replacement(range(len(members)), 2):
        reach = float(radii[members[a]].max() + radii[members[b]].max())
        if a == b:
            pairs = trees[a].query_pairs(reach, output_type="ndarray")
        else:  # the larger ones ask: they are fewer where sizes differ much
            near = trees[b].query_ball_tree(trees[a], reach)
            asked = np.repeat(np.arange(len(near)), [len(neighbours) for neighbours in near])
            pairs = np.stack([np.fromiter(chain.from_iterable(near), dtype=int), asked], axis=1)
        if len(pairs):
            first, second = members[a][pairs[:, 0]], members[b][pairs[:, 1]]
            gap = positions[first] - positions[second]
            gap -= np.where(sides > 0.0, lengths * np.round(gap / lengths), 0.0)
            depth = 1.0 - np.sqrt((gap**2).sum(axis=1)) / (radii[first] + radii[second])
            deepest = max(deepest, float(depth.max()))
    return deepest
