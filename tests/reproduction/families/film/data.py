"""Made-up slits with known answers, in the form that `measure.film` gives."""

import numpy as np
import xarray as xr

from gaspart import theory

BULK = 0.35
WIDTHS = np.array([2.25, 2.5, 3.0, 3.5, 4.0, 5.0, 12.0])


def slits(error=0.003, seed=1):
    """Slits in equilibrium with a bulk; solvation pressure a damped cosine of period 1."""
    rng = np.random.default_rng(seed)
    density = theory.number_density(BULK, 3)
    bulk = density * float(theory.compressibility_factor(BULK, 3))
    solvation = 1.5 * np.exp(2.0 - WIDTHS) * np.cos(2.0 * np.pi * WIDTHS)
    pressure, one = bulk + solvation, np.ones(WIDTHS.size)
    potential = np.log(density) + theory.excess_chemical_potential(BULK, 3)

    def noisy(values, scale):
        return values + scale * rng.standard_normal(values.shape)

    place = np.linspace(0.05, 5.45, 55)
    profile = density * (1.0 + 4.0 * np.exp(-3.0 * place))
    columns = {
        "pressure": noisy(pressure, error * pressure), "pressure_error": error * pressure,
        "contact": noisy(pressure, 2.0 * error * pressure), "contact_error": 2.0 * error * pressure,
        "truncation": 5e-4 * pressure, "functional_pressure": pressure - 0.01,
        "chemical_potential": noisy(potential * one, 0.04), "chemical_potential_error": 0.04 * one,
        "at_bulk": pressure, "at_bulk_error": 0.03 * one,
    }  # fmt: skip
    return xr.Dataset(
        {
            **{name: ("width", values) for name, values in columns.items()},
            "curve": ("theory_width", bulk - 0.01 + np.zeros(20)),
            "place": ("bin", place),
            "density": ("bin", profile),
            "density_error": ("bin", 0.01 * profile),
            "functional": ("bin", profile),
            "middle": float(density * (1.0 + 1e-3 * rng.standard_normal())),
            "middle_error": 1e-3 * density,
        },
        coords={"width": WIDTHS, "theory_width": np.linspace(2.0, 5.5, 20)},
        attrs={
            "bulk_density": density, "bulk_pressure": bulk, "functional_bulk_pressure": bulk - 0.01,
            "bulk_chemical_potential": potential, "period": 1.01, "period_error": 0.01,
            "functional_period": 1.02,
        },
    )  # fmt: skip
