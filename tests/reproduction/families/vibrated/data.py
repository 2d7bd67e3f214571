"""Made-up vibrated beds with known answers, in the form that `measure.vibrated_bed` gives."""

import numpy as np
import xarray as xr

from gaspart.reproduction.families.vibrated.claims import expected_temperature, small_parameter
from gaspart.reproduction.table import Table


def beds(limit=1.0, given=1.0, lost=1.0, height=1.0, restitutions=(0.99, 0.98, 0.95, 0.9)):
    """Beds of both kinds whose temperature over theory's is `limit` - 0.5 x + 0.2 x^2; energies and height
    over theory's."""
    e = np.array([*restitutions] * 2)
    sine = np.repeat([0, 1], len(restitutions))
    place = np.arange(0.25, 4.0, 0.5)
    known = {"sine": sine, "restitution": e, "layers": np.full(e.size, 2.0), "speed": 0.3 + 0.1 * sine}
    known["packing_fraction"] = np.full(e.size, 0.008)
    ds = xr.Dataset({key: ("bed", values) for key, values in known.items()}, {"place": ("bin", place)})
    x, unit = small_parameter(Table(ds, "bed")), expected_temperature(Table(ds, "bed"))
    columns = {
        "temperature": (limit - 0.5 * x + 0.2 * x**2) * unit,
        "temperature_error": 0.003 * unit,
        "given": given * known["speed"],
        "given_error": 0.001 * known["speed"],
        "lost": lost * given * known["speed"],
        "lost_error": 0.002 * known["speed"],
        "height": np.full(e.size, 1.008 * height),
        "height_error": np.full(e.size, 0.004),
    }
    density = np.tile(np.exp(-place), (e.size, 1))
    profile = {"density": density, "density_error": 0.05 * density}
    return ds.assign(
        {key: ("bed", values) for key, values in columns.items()}
        | {key: (("bed", "bin"), values) for key, values in profile.items()}
    )
