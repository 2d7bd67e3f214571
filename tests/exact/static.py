"""Static observables of sampled configurations, by definitions of their own in plain numpy.

Contact densities are ratios of insertions, without extrapolation: for group a of N_a bodies, with the
ensemble that lacks one of it, w(r) = exp(-u / kT) if a trial body is free at r, else 0, and
n_a(r) = N_a <w(r)> / <integral of w>. Grand canonical: n(r) = z <w(r)>. Groups that cannot be inserted have
fits of gaps.
"""

import math

import numpy as np
from exact.sampler import BLOCKS, Sample, block_mean, inserted, sample
from scipy.spatial import Voronoi
from scipy.special import sph_harm_y

BINS, ORDER = 12, 3
"""Bins of gaps that are extrapolated to contact, and the order of the polynomial."""


def sphere(d, distance):
    """Return the surface of a sphere, or the circumference of a circle."""
    return 2.0 * math.pi * distance if d == 2 else 4.0 * math.pi * distance**2


def room(case, group, trials=400_000, seed=5):
    """Return the volume and the area of each face that centres of a group can reach, shape (1 + 2d,)."""
    fixed, still = len(case.fixed), 20
    empty = Sample(
        np.tile(case.fixed, (still, 1, 1)), np.full(still, fixed),
        np.full(still, case.box.plane[0] if case.box.plane[0] >= 0.0 else case.box.lengths[case.box.axis]),
        case.fixed_radii, np.full(fixed, np.inf), np.full(fixed, -1), np.zeros(fixed, int),
    )  # fmt: skip
    box = case.box._replace(gravity=0.0 * case.box.gravity, wells=0.0 * case.box.wells)
    plain = _with_box(case, box)
    value, error = block_mean(inserted(plain, empty, group, trials // still, seed))
    return value[: 1 + 2 * case.dimension], error[: 1 + 2 * case.dimension]


def _with_box(case, box):
    other = object.__new__(type(case))
    other.__dict__ = {**case.__dict__, "box": box}
    return other


def contacts(case, configurations, every=4, trials=30, seed=0):
    """Return, for each group, force / kT on each face and pairs per distance at contact with each group.

    Shapes (groups, 1 + 2d + groups + 1), values and errors; own pairs count once; the last column is that of
    fixed bodies.
    """
    values, errors = [], []
    for n, group in enumerate(case.groups):
        kept = sample(case, configurations, every, seed + 7 * n, None if case.activity else n)
        found = inserted(case, kept, n, trials, seed + 3)
        own = 1 + 2 * case.dimension + n
        if case.activity:
            value, error = block_mean(case.activity * found)
        else:
            value, error = block_mean(group.count * found, found[:, 0])
            share, scatter = block_mean(found[:, 0])
            if not scatter < 0.05 * share:  # hardly ever free
                value, error = _by_gaps(case, n)
        value[own], error[own] = 0.5 * value[own], 0.5 * error[own]
        values.append(value)
        errors.append(error)
    return np.array(values), np.array(errors)


def _by_gaps(case, group):
    """Return the contacts of a group with faces and with itself, extrapolated; others are unknown."""
    d, kept = case.dimension, sample(case, 20_000, 8, 21)
    value, error = np.full((2, 1 + 2 * d + len(case.groups) + 1), np.nan)
    size = case.groups[group].radius
    for k, s in case.walls.values():
        x = kept.positions[:, kept.groups == group, k]
        gap = (case.box.lengths[k] - x if s else x) - case.box.margin * size
        near = 0.2 * min(size, case.box.lengths.min() / 2.0)
        value[1 + 2 * k + s], error[1 + 2 * k + s] = at_contact(gap, near)
    own = 1 + 2 * d + group
    value[own] = error[own] = 0.0
    if case.groups[group].count > 1:
        members = kept.groups == group
        few = kept._replace(positions=kept.positions[:, members], radii=kept.radii[members])
        pairs, scatter = scaled_pairs(case, few)[1]
        value[own], error[own] = 2.0 * pairs, 2.0 * scatter
    if not len(case.fixed):
        value[-1] = error[-1] = 0.0
    return value, error


def at_contact(gaps, reach, weights=None):
    """Return the number of gaps (S, n) per distance at 0, by a fit of gaps below `reach`, and its error."""
    counts = []
    parts = np.array_split(np.arange(len(gaps)), BLOCKS)
    for part in parts:
        weight = None if weights is None else np.broadcast_to(weights, gaps[part].shape)
        count = np.histogram(gaps[part], BINS, (0.0, reach), weights=weight)[0]
        counts.append(count / len(part) / (reach / BINS))
    h = np.array(counts)
    edges = np.linspace(0.0, 1.0, BINS + 1)
    basis = np.array([np.diff(edges ** (p + 1)) / (p + 1) / np.diff(edges) for p in range(ORDER + 1)]).T
    scale = 1.0 / np.sqrt(h.mean(axis=0) + 1e-12)
    at = np.linalg.lstsq(basis * scale[:, None], (h * scale).T, rcond=None)[0][0]
    return at.mean(), at.std(ddof=1) / math.sqrt(BLOCKS)


def forces_of_many(case, kept):
    """Return, for each face, force / kT and the sum of each body's force over the area it can reach."""
    sides = np.where(
        case.periodic, case.box.lengths, case.box.lengths - 2.0 * case.box.margin * kept.radii[:, None]
    )
    found = {}
    for face, (k, s) in case.walls.items():
        x = kept.positions[:, :, k]
        gap = (case.box.lengths[k] - x if s else x) - case.box.margin * kept.radii
        area = np.delete(sides, k, axis=1).prod(axis=1)
        found[face] = at_contact(gap, kept.radii.min()), at_contact(gap, kept.radii.min(), 1.0 / area)
    return found


def pair_vectors(case, positions):
    """Return the numbers of the bodies of all pairs, and their nearest vectors (S, P, d)."""
    i, j = np.triu_indices(positions.shape[1], 1)
    apart = positions[:, i] - positions[:, j]
    return i, j, apart - np.where(case.periodic, case.box.lengths, 0.0) * np.rint(apart / case.box.lengths)


def scaled_pairs(case, kept):
    """Return Z by scaling the volume, and pairs per distance at contact, extrapolated, with errors.

    Z = 1 + <pairs per unit of s at contact> / (d N), s = distance / (sum of radii), for any sizes.
    """
    n = kept.positions.shape[1]
    i, j, apart = pair_vectors(case, kept.positions)
    distance = np.sqrt((apart**2).sum(axis=-1))
    ratio = distance / (kept.radii[i] + kept.radii[j]) - 1.0
    reach = min(0.5, np.quantile(ratio[: len(ratio) // BLOCKS], min(1.0, 0.6 * n / len(i))))
    pairs, error = at_contact(ratio, reach)
    gaps = distance - kept.radii[i] - kept.radii[j]
    near = at_contact(gaps, reach * 2.0 * kept.radii.min())
    return (1.0 + pairs / (case.dimension * n), error / (case.dimension * n)), near


def profile(case, kept, axis, bins, group=None):
    """Return the number density of moving bodies in bins along an axis, in the container of the moment."""
    fixed = len(case.fixed)
    number = np.arange(kept.positions.shape[1])[None]
    inside = (number >= fixed) & (number < kept.numbers[:, None])
    if group is not None:
        inside = inside & (kept.groups == group)[None]
    cell = np.clip((kept.positions[:, :, axis] / case.box.lengths[axis] * bins).astype(int), 0, bins - 1)
    counted = [np.bincount(c[one], minlength=bins) for c, one in zip(cell, inside, strict=True)]
    edges = np.linspace(0.0, case.box.lengths[axis], bins + 1)
    lengths = np.repeat(case.box.lengths[None], len(cell), axis=0)
    if case.load:
        lengths[:, case.box.axis] = kept.places
    across = np.delete(lengths, axis, axis=1).prod(axis=1)
    width = np.clip(np.minimum(edges[1:], lengths[:, axis, None]) - edges[:-1], 0.0, None)
    return block_mean(np.array(counted, float), width * across[:, None])


def free_share(case, group, axis, bins, points=10_000):
    """Return the fraction of each bin that fixed bodies leave to centres of a group, shape (bins,)."""
    rng = np.random.default_rng(1)
    share = np.ones(bins)
    for b in range(bins):
        u = rng.random((points, case.dimension)) * case.box.lengths
        u[:, axis] = (b + rng.random(points)) * case.box.lengths[axis] / bins
        hit = np.zeros(points, bool)
        for x, radius in zip(case.fixed, case.fixed_radii, strict=True):
            apart = u - x
            apart -= np.where(case.periodic, case.box.lengths, 0.0) * np.rint(apart / case.box.lengths)
            hit |= (apart**2).sum(axis=-1) < (radius + case.groups[group].radius) ** 2
        share[b] -= hit.mean()
    return share


def radial_distribution(case, kept, furthest, bins):
    """Return V <pairs in a shell> / (N (N - 1) / 2 * volume of the shell) in bins up to `furthest`."""
    d, n = case.dimension, kept.positions.shape[1]
    h = []
    for part in np.array_split(kept.positions, BLOCKS):
        apart = pair_vectors(case, part)[2]
        distance = np.sqrt((apart**2).sum(axis=-1))
        h.append(np.histogram(distance, bins, (0.0, furthest))[0] / len(part))
    edges = np.linspace(0.0, furthest, bins + 1)
    shell = (math.pi if d == 2 else 4.0 / 3.0 * math.pi) * np.diff(edges**d)
    g = np.array(h) * case.box.lengths.prod() / (n * (n - 1) / 2.0 * shell)
    return g.mean(axis=0), g.std(axis=0, ddof=1) / math.sqrt(BLOCKS)


def waves(case, highest, bins):
    """Return all wave vectors 2 pi n / L with 0 < |k| <= highest, one of each pair, and the shell of each."""
    most = [int(highest * length / 2.0 / math.pi) for length in case.box.lengths]
    n = np.stack(np.meshgrid(*[np.arange(-m, m + 1) for m in most], indexing="ij"), -1)
    n = n.reshape(-1, case.dimension)
    k = n[[tuple(v) > (0,) * case.dimension for v in n]] * 2.0 * math.pi / case.box.lengths
    size = np.sqrt((k**2).sum(axis=1))
    k, size = k[size <= highest], size[size <= highest]
    return k, np.minimum((size / highest * bins).astype(int), bins - 1), size


def structure_factors(case, kept, highest, bins):
    """Return |k| of the shells, and S of each pair of groups (Ashcroft and Langreth) and of all, with errors.

    The last row is <|sum of all|^2> / N; the others <rho_a rho_b*> / sqrt(N_a N_b).
    """
    k, shell, size = waves(case, highest, bins)
    used, kinds = np.unique(shell), np.unique(kept.groups)
    counts = [(kept.groups == a).sum() for a in kinds]
    found = []
    for part in np.array_split(kept.positions, BLOCKS):
        phase = np.exp(1j * part[:: max(1, len(part) // (40 if case.dimension == 2 else 12))] @ k.T)
        rho = [phase[:, kept.groups == a].sum(axis=1) for a in kinds]
        s = [
            (rho[a] * rho[b].conj()).real.mean(axis=0) / math.sqrt(counts[a] * counts[b])
            for a in range(len(kinds))
            for b in range(a, len(kinds))
        ]
        s.append((abs(sum(rho)) ** 2).mean(axis=0) / len(kept.groups))
        found.append([[one[shell == u].mean() for u in used] for one in s])
    h = np.array(found)
    numbers = np.array([size[shell == u].mean() for u in used])
    return numbers, h.mean(axis=0), h.std(axis=0, ddof=1) / math.sqrt(BLOCKS)


def hexatic_order(case, positions):
    """Return |mean over discs of the mean of exp(6 i theta) over Voronoi neighbours| by configuration."""
    found = []
    for x in positions:
        n = len(x)
        shifts = [np.array([a, b]) * case.box.lengths for a in (0, -1, 1) for b in (0, -1, 1)]
        images = np.concatenate([x + shift for shift in shifts])
        bonds = Voronoi(images).ridge_points
        bonds = np.concatenate([bonds, bonds[:, ::-1]])
        bonds = bonds[bonds[:, 0] < n]
        apart = images[bonds[:, 1]] - images[bonds[:, 0]]
        w = np.exp(6j * np.arctan2(apart[:, 1], apart[:, 0]))
        mean = np.bincount(bonds[:, 0], w.real, n) + 1j * np.bincount(bonds[:, 0], w.imag, n)
        found.append(abs((mean / np.bincount(bonds[:, 0], minlength=n)).mean()))
    return np.array(found)


def steinhardt_order(case, positions):
    """Return Q_6 of the bonds to the 12 nearest neighbours of each sphere, of each configuration."""
    found = []
    for x in positions:
        apart = x[:, None] - x[None]
        apart -= case.box.lengths * np.rint(apart / case.box.lengths)
        distance = np.sqrt((apart**2).sum(axis=-1)) + np.eye(len(x)) * 1e9
        near = np.argsort(distance, axis=1)[:, :12]
        v = np.take_along_axis(apart, near[..., None], axis=1).reshape(-1, 3)
        polar, around = np.arccos(v[:, 2] / np.sqrt((v**2).sum(axis=1))), np.arctan2(v[:, 1], v[:, 0])
        q = [sph_harm_y(6, m, polar, around).mean() for m in range(-6, 7)]
        found.append(math.sqrt(4.0 * math.pi / 13.0 * sum(abs(one) ** 2 for one in q)))
    return np.array(found)
