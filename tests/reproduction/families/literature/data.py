"""Made-up values beside those of others with known answers, in the form that `measure.literature` gives."""

import numpy as np
import xarray as xr

from gaspart import theory

ROWS = [
    ("Z", 3, 0.1, 1000, 2e-4, 0),
    ("Z", 3, 0.157079633, 1372, 2e-4, 1),
    ("Z", 3, 0.261799388, 1372, 2e-4, 1),
    ("Z_crystal", 3, 0.544647059, 1372, 2e-4, 1),
    ("pressure", 2, 0.68, 870, 2e-4, 0),
    ("diffusion", 3, 0.157079633, 1372, 4e-3, 1),
    ("diffusion", 3, 0.366519143, 1372, 4e-3, 1),
    ("viscosity", 3, 0.261799388, 1372, 0.03, 1),
    ("conductivity", 3, 0.261799388, 1372, 0.03, 1),
]
"""quantity, dimension, packing fraction, count, relative error of ours, whether it has a claim of its own."""


def beside_others(factor=1.0, noise=1.0, seed=1):
    """Published values, ours `factor` times as large with `noise` times the scatter that their errors say."""
    rng = np.random.default_rng(seed)
    columns = {name: [] for name in ("value", "error", "source")}
    for quantity, dimension, eta, *_ in ROWS:
        known = theory.literature(quantity, dimension)
        one = known[np.abs(known.packing_fraction - eta) < 1e-8][0]
        for name, values in columns.items():
            values.append(one[name])
    theirs, error = np.array(columns["value"]), np.array(columns["error"])
    quantity, dimension, eta, count, relative, judged = (
        np.array(column) for column in zip(*ROWS, strict=True)
    )
    own = relative * theirs
    ours = factor * theirs + noise * np.hypot(own, error) * rng.standard_normal(len(ROWS))
    found = {
        "quantity": quantity, "dimension": dimension, "packing_fraction": eta, "count": count,
        "ours": ours, "ours_error": own, "theirs": theirs, "theirs_error": error,
        "source": np.array(columns["source"], dtype=str), "judged": judged,
    }  # fmt: skip
    return xr.Dataset({name: ("value", values) for name, values in found.items()})
