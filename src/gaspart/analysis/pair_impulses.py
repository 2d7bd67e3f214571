"""g(r) from the momentum that pairs of particles gain along their separation.

In equilibrium this gives k_B T g(r) without the noise of counting, but for what all distances share
(`Tally.contact_impulse_sum`; docs/design-notes.md has the derivation). That follows from the number of pairs
within the furthest distance, which is counted. Counts have less noise in wide shells of a dense fluid, so
both are mixed, as densities are (`gaspart.analysis.impulses`).
"""

from __future__ import annotations

import numpy as np

from gaspart.analysis.impulses import mixture
from gaspart.analysis.run import Run
from gaspart.state.optional_tallies import PairImpulseTally, stored_tally

_ALIKE = 1e-9
"""Relative difference of two thicknesses of shells that is rounding."""


def kept(run: Run) -> PairImpulseTally | None:
    """What a run has kept of impulses of pairs; None if that is nothing, or not all particles are in the
    file, from which the temperature follows."""
    return None if run.is_subset else stored_tally(run.data.attrs.get("tallies", "[]"), PairImpulseTally)


def shell_volumes(bins: int, dimension: int) -> np.ndarray:
    """(bins,) of shells of equal thickness, in that of the first one."""
    return np.diff(np.arange(bins + 1.0) ** dimension)


def g_by_impulses(run: Run, starts: np.ndarray, bins: int, furthest: float) -> np.ndarray | None:
    """(2, S, bins) what the pairs that collide and all others give to g(r), in S stretches of a run that
    begin at the frames `starts` (S,). None if the run has not kept it, or not in parts of these shells, if a
    stretch takes no time, and if no pair has collided: then impulses say nothing of g(r), which is not 0."""
    has = kept(run)
    if has is None or starts[-1] == len(run.time) - 1 or furthest > has.furthest * (1.0 + _ALIKE):
        return None
    each = furthest / bins * has.shells / has.furthest
    merged = round(each)
    if merged < 1 or abs(each - merged) > _ALIKE * each:
        return None
    ends = np.append(starts, len(run.time) - 1)
    sums = np.stack([run.data[name].values[ends] for name in ("contact_impulse_sum", "other_impulse_sum")])
    if not (sums[0, -1] - sums[0, 0]).any():
        return None
    rates = np.diff(sums, axis=1) / (run.temperature * np.diff(run.time[ends])[:, None])
    fine = shell_volumes(bins * merged, run.dimension)
    parts = (rates[..., : len(fine)] * fine).reshape(2, len(starts), bins, merged).sum(axis=3)
    return np.asarray(parts / fine.reshape(bins, merged).sum(axis=1))


def mixed_g(counted: np.ndarray, parts: np.ndarray, volumes: np.ndarray) -> np.ndarray:
    """(S, bins) g(r) in S stretches from counts (S, bins) and impulses (2, S, bins), in shells of these
    volumes (bins,)."""
    contacts, found = parts[0].mean(axis=0), parts.sum(axis=0)
    missing = ((counted - found) @ volumes) / (contacts @ volumes)
    impulses = found + missing[:, None] * contacts
    return counted + mixture(counted, impulses, periodic=False) * (impulses - counted)
