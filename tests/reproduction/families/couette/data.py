"""Made-up measurements of gases between sliding walls, as theory states them."""

import numpy as np

from gaspart import theory
from gaspart.reproduction.families.couette.measure import NUMBERS
from gaspart.reproduction.table import from_rows
from gaspart.theory.shear import NORMAL_STRESSES, VELOCITY_SLIP

FLOWS = (  # engine, packing fraction, Knudsen number, speed, stress over pressure
    ("DSMC", 0.0, 0.05, 1.0, 0.036),
    ("DSMC", 0.0, 0.05, 2.5, 0.084),
    ("DSMC", 0.0, 50.0, 1.0, 0.392),
    ("event-driven", 0.023, 0.047, 1.0, 0.033),
    ("event-driven", 0.3, 0.01, 1.0, 0.02),
)


def measured(error=1.0, seed=1):
    """Each number off by a random error; error: that of most claims, over what they need."""
    rng, rows = np.random.default_rng(seed), []
    sizes = {"slip": 0.02, "pressure": 2e-4, "reduced_rate": 1e-5, "heating": 0.002}
    sizes |= dict.fromkeys(("normal_x", "normal_y", "normal_z"), 4e-4)
    place = np.linspace(-0.45, 0.45, 10)
    for engine, eta, knudsen, speed, rate in FLOWS:
        normal = [slope * rate**2 for slope in NORMAL_STRESSES]
        pressure = 1.0 + (normal[0] if eta < 0.1 else 0.0)
        values = (1.0, VELOCITY_SLIP, float(theory.viscous_heating(eta, 3)), *normal, pressure, rate)
        numbers = dict(zip(NUMBERS, values, strict=True)) | {"stress": min(1.0, 1.7 * knudsen)}
        if knudsen > 1.0:
            numbers["stress"] = 0.99
        for name, value in list(numbers.items()):
            size = error * sizes.get(name, 0.003)
            numbers |= {name: value + size * rng.normal(), f"{name}_error": size, f"{name}_freedom": 19.0}
        flow = place / (1.0 + 2.0 * knudsen)
        shown = {"place": place, "flow": flow, "temperature": 1.1 - 0.13 * (speed * flow) ** 2}
        shown |= {"flow_error": np.full(10, 0.001), "temperature_error": np.full(10, 0.001)}
        at = {"engine": engine, "packing_fraction": eta, "knudsen": knudsen, "speed": speed}
        rows.append({"part": "flows", **at, **numbers, **shown})
    for eta, off in ((0.1, 0.002), (0.3, -0.002)):
        ratio = {"viscosity": 1.0 + off * error, "viscosity_error": 0.006 * error, "viscosity_freedom": 79.0}
        rows.append({"part": "sheared", "engine": "event-driven", "packing_fraction": eta, **ratio})
    still = {"viscosity": 1.0, "viscosity_error": 0.004 * error, "viscosity_freedom": 7.0}
    rows.append({"part": "equilibrium", "engine": "event-driven", "packing_fraction": 0.3, **still})
    return from_rows("point", rows, ("bin",))
