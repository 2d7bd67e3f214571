"""Made-up measurements of mixtures, as the smoke run's points are."""

import math

import numpy as np

from gaspart.reproduction.families.mixtures.measure import theories
from gaspart.reproduction.table import from_rows
from gaspart.scene.gas import Mixture
from gaspart.scene.sizes import relative_radii

POINTS = [
    *((3, ratio, small, 0.4) for ratio in (0.5, 0.9) for small in (0.5, 0.9)),
    (3, 0.5, 0.5, 0.1),
    (2, 0.5, 0.5, 0.5),
    (2, 0.9, 0.9, 0.5),
    (3, None, 0.1, 0.4),
    (3, None, 0.3, 0.4),
    (2, None, 0.1, 0.5),
]
"""dimension; size ratio and small fraction, or None and polydispersity; packing fraction."""


def measured(error=2e-4, seed=1):
    """Z is that of "santos", off by a random error; so are contact values and rates."""
    rng, rows = np.random.default_rng(seed), []
    for dimension, ratio, other, eta in POINTS:
        if ratio is None:
            sizes, counts = tuple(relative_radii(100, other, "lognormal")), (1,) * 100
        else:
            sizes, counts = (1.0, ratio), (round(1000 * (1.0 - other)), round(1000 * other))
        gas = Mixture(dimension, eta, counts, sizes, (1.0,) * len(sizes), 1.0)
        row = {
            "dimension": dimension,
            "packing_fraction": eta,
            "count": 4000,
            "size_ratio": math.nan if ratio is None else ratio,
            "small_fraction": math.nan if ratio is None else other,
            "polydispersity": other if ratio is None else math.nan,
            "distribution": "lognormal" if ratio is None else "",
            "correction": 1e-5,
            "reference_error": 1e-5,
            **theories(gas),
        }
        z = row["santos"]
        row |= {"Z": z * (1.0 + error * rng.normal()), "Z_error": error * z, "Z_freedom": 20.0}
        if ratio is not None:
            row |= {"virial": error * rng.normal(), "virial_error": error, "virial_freedom": 20.0}
            for name in ("contact", "rate"):
                value = np.array(row[f"{name}_santos"])
                row[name] = value * (1.0 + error * rng.normal(size=3))
                row[f"{name}_error"] = error * value
                row[f"{name}_freedom"] = np.full(3, 20.0)
        rows.append(row)
    pairs = ["large-large", "large-small", "small-small"]
    return from_rows("point", rows, ("pair",)).assign_coords(pair=pairs)
