"""A made-up velocity autocorrelation with known answers, in the form that `measure.velocity` gives."""

import numpy as np

from gaspart import theory
from gaspart.reproduction.table import table


def correlations(start=1.0, tail=1.0, error=0.01, seed=1):
    """Two finely sampled points and two long ones; start and tail: over theory's."""
    rng = np.random.default_rng(seed)

    def gas(stated):
        dimension, eta, interval = stated
        s = interval * np.arange(41)
        time = s / theory.collision_rate(eta, dimension)
        late = theory.velocity_autocorrelation_tail(np.maximum(time, 0.1), eta, dimension)
        correlation = np.exp(-2.0 / dimension * s) + tail * late * (s > 5.0)
        row = {"dimension": dimension, "packing_fraction": eta, "count": 2048, "sound": 60.0, "time": time}
        row |= {"collisions": s, "correlation": (correlation, np.full(41, 2e-4))}
        if interval == 1.0:
            ratio = tail + error * rng.standard_normal(), error
            return row | {"tail_from": 16.0, "tail_to": 60.0, "tail_ratio": ratio, "tail_correction": 4.0}
        rate = 2.0 / dimension * (start + 0.002 * rng.standard_normal())
        return row | {"start_rate": (rate, 2.0 / dimension * 0.002)}

    gases = (2, 0.3, 0.05), (3, 0.3, 0.05), (2, 0.2, 1.0), (3, 0.3, 1.0)
    return table("point", gases, gas, inner=("lag",))
