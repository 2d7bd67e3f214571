"""Made-up rough and inelastic gases with known answers, in the form that `measure.granular` gives."""

import numpy as np
import xarray as xr

from gaspart import theory


def rough(noise=1.0, rate=1.0, ratio=1.0, steady=1.0, exchange=1.0, mixed=1.0, seed=1):
    """Discs of three moments of inertia; rate, ratio and steady ratio are theirs over theory's; and
    two gases between rough walls, of the exchange and the final ratio over theory's."""
    rng = np.random.default_rng(seed)
    inertia = np.array([0.1, 0.5, 1.0])
    expected = 3.0 * inertia / (1.0 + inertia) ** 2
    s = np.tile(np.linspace(0.0, 4.0, 9), (3, 1))
    error = np.where(s > 0.0, 0.002, 0.0)
    beyond = [np.nan_to_num(theory.rough_start_excess(q, one)) for q, one in zip(inertia, s, strict=True)]
    rotation = 2.0 / 3.0 * (1.0 - np.exp(-rate * expected[:, None] * s) - beyond)
    rotation = rotation + noise * error * rng.standard_normal(s.shape)
    tangential = np.array([-0.5, 0.0, 0.5])
    theoretical = theory.rough_cooling()[:3, 3]
    wall_inertia, crossings = np.array([0.5, 0.4]), np.tile(np.linspace(0.0, 2.0, 11), (2, 1))
    pairs = zip(crossings, wall_inertia, strict=True)
    difference = np.stack([theory.rough_wall_difference(one, q) for one, q in pairs])
    return xr.Dataset({
        "collisions": (("start", "frame"), s),
        "translation": (("start", "frame"), 1.0 - 0.5 * rotation),
        "translation_error": (("start", "frame"), 0.5 * error),
        "rotation": (("start", "frame"), rotation),
        "rotation_error": (("start", "frame"), error),
        "inertia": ("start", inertia),
        "rate": ("start", expected * (rate + 0.004 * noise * rng.standard_normal(3))),
        "rate_error": ("start", 0.004 * expected),
        "equilibrium_inertia": ("equilibrium", inertia),
        "equilibrium_ratio": ("equilibrium", ratio + 0.002 * noise * rng.standard_normal(3)),
        "equilibrium_ratio_error": ("equilibrium", np.full(3, 0.002)),
        "tangential": ("cooling", tangential),
        "cooling_inertia": ("cooling", np.full(3, 0.5)),
        "steady_ratio": ("cooling", steady * theoretical),
        "wall_dimension": ("walls", np.array([2, 3])),
        "wall_inertia": ("walls", wall_inertia),
        "wall_time": (("walls", "moment"), crossings),
        "wall_translation": (("walls", "moment"), 0.5 * (1.0 + difference)),
        "wall_translation_error": (("walls", "moment"), np.full(crossings.shape, 0.002)),
        "wall_rotation": (("walls", "moment"), 0.5 * (1.0 - difference)),
        "wall_rotation_error": (("walls", "moment"), np.full(crossings.shape, 0.002)),
        "exchange": ("walls", exchange + 0.004 * noise * rng.standard_normal(2)),
        "exchange_error": ("walls", np.full(2, 0.004)),
        "exchange_freedom": ("walls", np.full(2, 31)),
        "wall_ratio": ("walls", mixed + 0.004 * noise * rng.standard_normal(2)),
        "wall_ratio_error": ("walls", np.full(2, 0.004)),
        "wall_ratio_freedom": ("walls", np.full(2, 31)),
        "steady_ratio_error": ("cooling", 0.005 * theoretical),
    })  # fmt: skip


def inelastic(rate=1.0, exponent=-2.0, clustered=True, seed=1):
    """Two gases of each dimension, and a clustering and an elastic one; rate over theory's."""
    rng = np.random.default_rng(seed)
    dimension, restitution = np.array([2, 2, 3, 3]), np.array([0.9, 0.7, 0.9, 0.7])
    expected = np.array([theory.cooling_rate(e, d) for e, d in zip(restitution, dimension, strict=True)])
    finite = 1024 * dimension / (1023 * dimension + 1)
    time = np.tile(np.linspace(0.0, 5.0, 11), (4, 1))
    s = np.tile(np.linspace(0.0, 100.0, 21), (2, 1))
    excess = np.exp(0.03 * s) if clustered else np.ones_like(s)
    return xr.Dataset(
        {
            "dimension": ("gas", dimension),
            "restitution": ("gas", restitution),
            "collisions": (("gas", "frame"), 2.0 / expected[:, None] * np.log1p(time)),
            "time": (("gas", "frame"), time),
            "temperature": (("gas", "frame"), (1.0 + time) ** -2.0),
            "temperature_error": (("gas", "frame"), np.full(time.shape, 1e-4)),
            "count": ("gas", np.full(4, 1024)),
            "rate": ("gas", finite * expected * (rate + 1e-4 * rng.standard_normal(4))),
            "rate_error": ("gas", 1e-4 * expected),
            "exponent": ("gas", exponent + 0.005 * rng.standard_normal(4)),
            "exponent_error": ("gas", np.full(4, 0.005)),
            "cluster_restitution": ("clusters", np.array([0.8, 1.0])),
            "cluster_collisions": (("clusters", "step"), s),
            "cluster_excess": (("clusters", "step"), np.stack([excess[0], np.ones(21)])),
            "cluster_excess_error": (("clusters", "step"), 0.05 * excess),
            "variance": (("clusters", "step"), 0.5 * np.stack([excess[0], np.ones(21)])),
            "variance_error": (("clusters", "step"), np.full(s.shape, 0.02)),
            "x": ("particle", rng.uniform(0.0, 20.0, 50)),
            "y": ("particle", rng.uniform(0.0, 20.0, 50)),
        },
        attrs={"side": 20.0, "radius": 0.5},
    )
