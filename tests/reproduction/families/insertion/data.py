"""Made-up fills with known answers."""

import numpy as np

from gaspart.reproduction.families.insertion.measure import Fill


def fill_to(saturation, amplitude, dimension, body=1e-4, last_time=5e3, replicas=6, seed=3):
    """Fills whose packing fraction is saturation - amplitude t^(-1/dimension), to a body, from t = 1 on.

    Each replica's saturation is shifted by a little noise.
    """
    rng = np.random.default_rng(seed)
    ends = saturation + 2e-4 * rng.standard_normal(replicas)
    bodies = int((saturation + 0.01) / body)
    failures = np.full((replicas, bodies), -1)
    for row, end in zip(failures, ends, strict=True):
        eta = body * (np.arange(bodies) + 1.0)
        gap = end - eta
        times = np.where(gap > 0.0, (np.maximum(gap, 1e-30) / amplitude) ** -float(dimension), np.inf)
        placed = np.flatnonzero(times <= last_time)
        attempts = np.maximum.accumulate(np.maximum(np.round(times[placed] / body), placed + 1)).astype(int)
        row[placed] = np.maximum(np.diff(attempts, prepend=0) - 1, 0)
    return Fill(failures, np.full(replicas, int(last_time / body)), body, dimension)
