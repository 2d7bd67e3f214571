"""A made-up measurement of walls that hold particles, with known answers."""

import numpy as np
import xarray as xr

from gaspart.theory import adsorption as theory
from gaspart.theory.tables import packing_fraction_at

SPEED = np.linspace(0.1, 3.9, 20)


def _row(kind, **values):
    measured = ["ratio", "log_ratio", "length", "coverage", "gas_density", "activity"]
    measured += ["filling", "filling_by_activity"]
    names = ["temperature", "depth", "width", "momentum", *measured, *(f"{name}_error" for name in measured)]
    row = dict.fromkeys(names, np.nan)
    flux = theory.flux_density(SPEED) * (SPEED > 1.0 if kind == "sticky" else 1.0)
    slow = 0.0 if kind == "sticky" else theory.slow_flux_share(1.0)
    row |= {"kind": kind, "flux": flux, "flux_error": 0.01 + 0.0 * flux, "slow_speed": 1.0, "outside": 2.0}
    row["mass"] = 1.0
    return row | {"slow_share": slow, "slow_share_error": 0.002, "temperature": 1.0} | values


def walls(power=0.0, coverage_power=0.0):
    """What `measure.adsorption` gives if theory is right, its length going as T^power and the coverage of the
    sticky wall as the gas' density to `coverage_power`."""
    rows = []
    for depth in (1.0, 2.0):
        for temperature in (0.4, 0.6, 1.0, 2.0):
            length = 0.2 * temperature**power
            ratio = theory.well_ratio(depth / temperature, length, 2.0)
            rows.append(
                _row(
                    "ideal", temperature=temperature, depth=depth, width=0.2, ratio=ratio,
                    ratio_error=0.002 * ratio, log_ratio=np.log(ratio), log_ratio_error=0.002,
                    length=length, length_error=0.002 * length,
                )
            )  # fmt: skip
    for activity, deviation in ((0.1, 1.0), (1.0, -1.2), (10.0, 0.5)):
        coverage = float(packing_fraction_at(activity, 2))
        rows.append(
            _row(
                "layer", depth=5.0, width=0.1, coverage=coverage, coverage_error=0.01 * coverage,
                activity=activity, activity_error=0.02 * activity, filling=1.0 + 0.004 * deviation,
                filling_error=0.004,
                filling_by_activity=0.985, filling_by_activity_error=0.004,
            )
        )  # fmt: skip
    for density in (0.01, 0.02, 0.05):
        coverage = 0.07 * (density / 0.01) ** coverage_power
        rows.append(
            _row("sticky", momentum=1.0, coverage=coverage, coverage_error=0.001, gas_density=density)
        )
    arrays = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    values = {
        name: (("point", "bin") if array.ndim == 2 else "point", array) for name, array in arrays.items()
    }
    return xr.Dataset(values, coords={"speed": ("bin", SPEED)})
