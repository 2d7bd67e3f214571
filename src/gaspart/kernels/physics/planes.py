"""Planes across an axis, those of equal bins: which of them an impulse acts below.

An impulse dp on a particle at z changes the momentum below every plane above z. Of the planes of one bin that
is the part 1 - f, where f is how far up in the bin the particle is: the bin is given dp (1 - f), the next one
dp f, and the mean over the planes of a bin is the sum of all up to it (docs/design-notes.md). Impulses of any
origin count, of contacts, walls and edges of wells: all that changes a velocity between two flights.
"""

import numpy as np

from gaspart.kernels.compile.policy import inner_helper


@inner_helper
def row_of(i, row):
    """The row of sums that a particle adds to, of `row` (N,), or None if there is one."""
    if row is None:
        return 0
    return np.int64(row[i])


@inner_helper
def bin_at(place, bins):
    """In which of so many bins a place is, counted in bins, and how far up in it. What is outside counts as
    in the last bin on that side, by the same line."""
    bin_ = min(max(np.int64(place), 0), bins - 1)
    return bin_, place - bin_
