"""Made-up measurements of several cores with known answers."""

import numpy as np
import xarray as xr

from gaspart.reproduction.families.cores.model import speed_up

SERIAL, OVERHEAD = 0.05, 800.0


def measured(**changed):
    """What `measure.cores` gives on a machine of two cores."""
    count = np.array([1e4, 1e6, 1e6, 1e4, 1e5, 1e5, 1e5, 1e5, 1e6])
    cores = np.array([2, 2, 2, 2, 2, 4, 2, 4, 4])
    dsmc, events, steps = "DSMC, Enskog", "event-driven", "time-stepped"
    columns = {
        "engine": [dsmc, dsmc, dsmc, events, events, events, steps, steps, dsmc],
        "packing_fraction": [0.2, 0.2, 0.05] + [0.2] * 6,
        "count": count.astype(int),
        "copies": [1, 1, 1, 2, 2, 4, 1, 1, 1],
        "cores": cores,
        "speed": np.where(cores <= 2, speed_up(cores, count, SERIAL, OVERHEAD), np.nan),
        "same": [1] * 9,
    } | changed
    ds = xr.Dataset({f"run_{name}": ("run", np.array(values)) for name, values in columns.items()})
    ds["run_speed_error"] = 0.02 * ds["run_speed"]
    models = {
        "engine": [dsmc, dsmc, steps],
        "packing_fraction": [0.05, 0.2, 0.2],
        "serial": [SERIAL] * 3,
        "serial_error": [0.01] * 3,
        "overhead": [OVERHEAD] * 3,
        "overhead_error": [10.0] * 3,
    }
    ds = ds.assign({f"model_{name}": ("model", values) for name, values in models.items()})
    return ds.assign_attrs(cores=2, waiting=0.0)
