"""Made-up fills with known answers."""

import numpy as np

from gaspart.reproduction.families.insertion.measure import Fill


def fill_to(saturation, amplitude, dimension, particle=1e-4, last_time=5e3, replicas=6, seed=3):
    """Fills whose packing fraction is saturation - amplitude t^(-1/dimension), to a particle, from t = 1 on.

    Each replica's saturation is shifted by a little noise.
    """
    rng = np.random.default_rng(seed)
    ends = saturation + 2e-4 * rng.standard_normal(replicas)
    particles = int((saturation + 0.01) / particle)
    failures = np.full((replicas, particles), -1)
    for row, end in zip(failures, ends, strict=True):
        eta = particle * (np.arange(particles) + 1.0)
        gap = end - eta
        times = np.where(gap > 0.0, (np.maximum(gap, 1e-30) / amplitude) ** -float(dimension), np.inf)
        placed = np.flatnonzero(times <= last_time)
        attempts = np.maximum.accumulate(np.maximum(np.round(times[placed] / particle), placed + 1)).astype(
            int
        )
        row[placed] = np.maximum(np.diff(attempts, prepend=0) - 1, 0)
    return Fill(failures, np.full(replicas, int(last_time / particle)), particle, dimension)
