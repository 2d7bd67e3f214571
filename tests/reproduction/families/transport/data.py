"""Made-up measurements of viscosity and conductivity."""

import numpy as np

from gaspart.reproduction.table import from_rows


def measured(error=0.002, seed=1):
    """Spheres and discs whose coefficients are Enskog's, each off by a random error."""
    rng, rows = np.random.default_rng(seed), []
    for dimension, eta in ((3, 0.01), (3, 0.2), (3, 0.3), (3, 0.45), (2, 0.01), (2, 0.4)):
        finite = 0.99 if eta <= 0.02 else 1.0
        lags = 16 if eta < 0.45 else 31
        known = {"value": finite + error * rng.normal(), "growth": finite + error * rng.normal()}
        known["bulk"] = 1.0 + error * rng.normal()
        known["difference"] = known["growth"] / known["value"] - 1.0
        time = 1.0 * np.arange(lags)
        rows.append(
            {
                "dimension": dimension,
                "packing_fraction": eta,
                "count": 256,
                "finite": finite,
                **known,
                **{f"{name}_error": error for name in known},
                **{f"{name}_freedom": 15.0 for name in known},
                "time": time,
                "running": finite * -np.expm1(-time),
                "running_error": np.full(lags, error),
            }
        )
    return from_rows("point", rows, ("lag",))


def growing(error=0.05, growth=1.0, seed=1):
    """Two containers whose integrals grow `growth` times as much as the modes."""
    rng, rows = np.random.default_rng(seed), []
    time = np.arange(1.0, 40.0, 2.0)
    for count in (256, 1024):
        row = {"count": count, "time": time}
        for name in ("viscosity", "conductivity"):
            modes = np.where(time > 10.0, 1.0 + 0.03 * np.log(time / 40.0) + 1e-4 * count, np.nan)
            row |= {
                f"{name}_growth": growth + error * rng.normal(),
                f"{name}_growth_error": error,
                f"{name}_growth_freedom": 15.0,
                f"{name}_short_waves": 0.15,
                f"{name}_modes": modes,
                name: 1.0 - np.exp(-time) + 1e-5 * count,
                f"{name}_error": np.full(time.size, 0.002),
            }
        rows.append(row)
    return from_rows("point", rows, ("lag",))
