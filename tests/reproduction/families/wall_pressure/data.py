"""Made-up pressures on walls with known answers, in the form that `measure.wall_pressure` gives."""

import numpy as np
import xarray as xr

from gaspart import theory

CONTAINERS = [  # dimension, walled axes, length, other lengths, count, temperature
    *((2, 1, 60.0, 15.0, count, 1.0) for count in (57, 115, 229)),
    *((3, 1, 30.0, 8.0, count, 1.0) for count in (73, 367, 733)),
    (2, 2, 28.025, 0.0, 100, 1.0),
    (3, 3, 8.682, 0.0, 125, 1.0),
    *((2, 1, 60.0, 15.0, 229, temperature) for temperature in (0.25, 4.0)),
]


def pressures(relative_error=5e-4, factor=1.0, seed=1):
    """Pressures with Gaussian scatter about `factor` times theory's."""
    rng = np.random.default_rng(seed)
    rows = []
    for dimension, axes, length, other, count, temperature in CONTAINERS:
        width = other ** (dimension - axes)
        inner = (length - 1.0) ** axes * width
        expected, error = theory.wall_pressure(length, count / inner, count, dimension, axes)
        density = count / (length**axes * width)
        eta = theory.packing_fraction(density, dimension)
        pressure = expected * factor * (1.0 + relative_error * rng.standard_normal())
        rows.append({
            "pressure": pressure + error * rng.standard_normal(),
            "pressure_error": relative_error * expected,
            "whole_pressure": pressure * ((length - 1.0) / length) ** (axes - 1),
            "bulk_pressure": density * float(theory.compressibility_factor(eta, dimension)),
            "expected": expected,
            "expected_error": error,
            "density": density,
            "packing_fraction": eta,
            "temperature": temperature,
            "count": count,
            "dimension": dimension,
            "axes": axes,
            "length": length,
        })  # fmt: skip
    return xr.Dataset({name: ("point", np.array([row[name] for row in rows])) for name in rows[0]})
