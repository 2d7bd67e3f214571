"""Made-up measurements of the DSMC engine, as theory states them."""

import numpy as np

from gaspart.reproduction.table import from_rows
from gaspart.theory import erpenbeck_wood_ratio
from gaspart.theory.dsmc import cell_factor, step_factor

ERROR = 0.003


def known(names):
    """Entries of these numbers, each with an error and its degrees of freedom."""
    errors = {f"{name}_error": ERROR for name in names} | {f"{name}_freedom": 40.0 for name in names}
    return {**names, **errors}


def measured(seed=1):
    """Every part, each number off by a random error."""
    rng, rows = np.random.default_rng(seed), []

    def noisy(value):
        return float(value) * (1.0 + ERROR * rng.normal())

    for width, step in ((0.25, 0.15), (0.5, 0.15), (2.0, 0.15), (0.25, 0.9), (0.25, 1.8), (0.25, 2.7)):
        both = {
            q: cell_factor(q, width) * step_factor(q, step)
            for q in ("viscosity", "conductivity", "diffusion")
        }
        place = {"engine": "DSMC", "width": width, "step": step}
        fluxes = known({q: noisy(both[q]) for q in ("viscosity", "conductivity")})
        transfer = 0.1132 * width**2 * (1.0 - 0.3 * width)
        moved = {"transfer": transfer, "transfer_error": 0.01 * transfer, "transfer_freedom": 40.0}
        rows.append({"part": "fluxes", **place, **fluxes, **moved})
        rows.append({"part": "paths", **place, **known({"diffusion": noisy(both["diffusion"])})})
    for eta in (0.1, 0.3):
        values = {name: noisy(1.0) for name in ("excess", "rate", "diffusion")}
        rows.append({"part": "dense", "engine": "DSMC", "packing_fraction": eta, **known(values)})
        ratio = float(erpenbeck_wood_ratio(eta))
        row = {"part": "event_paths", "engine": "event-driven", "packing_fraction": eta}
        rows.append({**row, **known({"diffusion": noisy(ratio)})})
    for knudsen, flux, eta in ((2.0, 0.8, 4e-4), (0.3, 0.4, 2e-3), (0.03, 0.06, 0.02)):
        for part, engine in (("plates", "DSMC"), ("event_plates", "event-driven")):
            row = {"part": part, "engine": engine, "knudsen": knudsen, "packing_fraction": eta}
            rows.append({**row, **known({"flux": noisy(flux)})})
    narrow = known({"coefficient": 0.1132, "width_slope": -0.034, "step_slope": -0.03})
    return from_rows("point", rows).assign(narrow)
