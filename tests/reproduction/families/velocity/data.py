"""A made-up velocity autocorrelation with known answers, in the form that `measure.velocity` gives."""

import numpy as np
import xarray as xr

from gaspart import theory


def correlations(start=1.0, tail=1.0, error=0.01, seed=1):
    """Two finely sampled points and two long ones; start and tail: over theory's."""
    rng = np.random.default_rng(seed)
    nan, rows = np.nan, []
    for dimension, eta, interval in ((2, 0.3, 0.05), (3, 0.3, 0.05), (2, 0.2, 1.0), (3, 0.3, 1.0)):
        long = interval == 1.0
        s = interval * np.arange(41)
        time = s / theory.collision_rate(eta, dimension)
        late = theory.velocity_autocorrelation_tail(np.maximum(time, 0.1), eta, dimension)
        correlation = np.exp(-2.0 / dimension * s) + tail * late * (s > 5.0)
        rows.append({
            "collisions": s,
            "time": time,
            "correlation": correlation,
            "correlation_error": np.full(41, 2e-4),
            "dimension": dimension,
            "packing_fraction": eta,
            "count": 2048,
            "sound": 60.0,
            "start_rate": nan if long else 2.0 / dimension * (start + 0.002 * rng.standard_normal()),
            "start_rate_error": nan if long else 2.0 / dimension * 0.002,
            "tail_from": 16.0 if long else nan,
            "tail_to": 60.0 if long else nan,
            "tail_ratio": tail + error * rng.standard_normal() if long else nan,
            "tail_ratio_error": error if long else nan,
            "tail_correction": 4.0 if long else nan,
        })  # fmt: skip
    return xr.Dataset({
        name: (("point", "lag")[: 1 + np.ndim(rows[0][name])], np.array([row[name] for row in rows]))
        for name in rows[0]
    })  # fmt: skip
