"""Made-up driven gases with known answers, in the form that `measure.driven_gas` gives."""

import numpy as np
import xarray as xr

from gaspart import theory


def driven(temperature=1.0, cumulant=0.0, given=1.0):
    """Two gases of each dimension: temperature and energy over theory's, cumulant minus theory's."""
    dimension, restitution = np.array([2, 2, 3, 3]), np.array([0.9, 0.4, 0.9, 0.4])
    power, count, eta = np.full(4, 0.01), np.full(4, 500), np.full(4, 0.01)
    own = power * (1.0 - 1.0 / count)
    kinds = list(zip(restitution, dimension, power, eta, strict=True))
    steady = np.array([float(theory.driven_temperature(*kind)) for kind in kinds])
    many = np.array([float(theory.driven_cumulant(*kind[:2])) for kind in kinds])
    fourth = np.array([theory.finite_size_cumulant(a, 500, d) for a, d in zip(many, dimension, strict=True)])
    columns = {
        "dimension": dimension,
        "restitution": restitution,
        "packing_fraction": eta,
        "count": count,
        "power": power,
        "temperature": temperature * steady,
        "temperature_error": 0.002 * steady,
        "cumulant": fourth + cumulant,
        "cumulant_error": np.full(4, 0.002),
        "given": given * own,
        "given_error": 0.002 * own,
        "lost": own,
        "lost_error": 0.002 * own,
    }
    return xr.Dataset({key: ("gas", values) for key, values in columns.items()})
