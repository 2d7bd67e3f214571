"""Made-up equations of state with known answers, in the form that `measure.virial` gives."""

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.reproduction.families.virial.measure import fit_table

FITS = [
    {"free": 4, "up_to": 0.35, "held": True},
    {"free": 5, "up_to": 0.3, "held": True},
    {"free": 5, "up_to": 0.2, "held": False},
]
ETA = np.array([0.01, 0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4])


def equation_of_state(dimension, collisions=4e6, noise=1.0, seed=1, true=theory.compressibility_factor):
    """Z of the equation `true` with the scatter of `collisions` collisions a point, times `noise`."""
    rng = np.random.default_rng(seed)
    z = true(ETA, dimension)
    error = (z - 1.0) / np.sqrt(collisions)
    columns = {
        "Z": z + noise * error * rng.standard_normal(ETA.size),
        "Z_error": error,
        "reference": theory.compressibility_factor(ETA, dimension),
        "reference_error": theory.compressibility_uncertainty(ETA, dimension),
        "collision_rate": 1.0 + noise * rng.standard_normal(ETA.size) / np.sqrt(collisions),
        "collision_rate_error": np.full(ETA.size, collisions**-0.5),
        "replica_chi_square": rng.chisquare(1, ETA.size),
        "replica_degrees_of_freedom": np.ones(ETA.size, dtype=int),
    }
    dataset = xr.Dataset(
        {name: ("packing_fraction", values) for name, values in columns.items()},
        coords={"packing_fraction": ETA},
        attrs={"dimension": dimension},
    )
    return dataset.merge(fit_table(dataset, FITS))
