"""Made-up piles and flows with known answers, in the form that `measure.settling` gives."""

import numpy as np
import xarray as xr

from gaspart.analysis.estimate import Estimate
from gaspart.reproduction.families.settling.measure import _fit

WIDTH = np.array([4.0, 6.0, 9.0, 14.0])


def settled(exponent=1.5, head=1.0, contacts=2.0, displacement=0.0, rise=0.0, residual=0.1, spread=0.01):
    """Six piles, with two durations of contacts, and four flows."""
    time = np.tile(np.linspace(0.0, 20.0, 21), (6, 1))
    kinetic = np.where(time < 15.0, np.exp(-time), 0.0)
    rate = 0.8 * (WIDTH - 1.3) ** exponent * np.exp(spread * np.array([0.6, -0.9, -0.9, 0.6]))
    left = np.maximum(300.0 - rate[:, None] * time[:4], 0.0)
    return xr.Dataset({
        "time": (("pile", "frame"), time),
        "kinetic": (("pile", "frame"), kinetic),
        "contacts": (("pile", "frame"), contacts * (1.0 - np.exp(-time))),
        "duration": ("pile", [0.003, 0.003, 0.003, 0.01, 0.01, 0.01]),
        "rest": ("pile", [15.0, 15.0, 15.0, 15.0, 15.0, np.nan]),
        "final_contacts": ("pile", contacts + np.array([0.01, 0.0, -0.01, 0.01, 0.0, -0.01])),
        "residual": ("pile", [0.0, 0.0, 0.0, 0.0, 0.0, residual]),
        "displacement": ("pile", [0.0, displacement, 0.0, 0.0, 0.0, 0.0]),
        "rise": ("pile", [0.0, rise, 0.0, 0.0, 0.0, 0.0]),
        "width": ("orifice", WIDTH),
        "rate": ("orifice", rate),
        "rate_error": ("orifice", spread * rate),
        "rate_freedom": ("orifice", np.full(4, 8)),
        "head_ratio": ("orifice", np.full(4, head)),
        "head_ratio_error": ("orifice", np.full(4, 0.02)),
        "head_ratio_freedom": ("orifice", np.full(4, 8)),
        "liquid_ratio": ("orifice", np.full(4, 1.2)),
        "flow_time": (("orifice", "flow_frame"), time[:4]),
        "left": (("orifice", "flow_frame"), left),
        **_fit(WIDTH, Estimate(np.log(rate), spread, 8)),
    })  # fmt: skip
