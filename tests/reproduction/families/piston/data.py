"""Made-up gases behind a piston with known answers, in the form that `measure.piston` gives."""

import numpy as np
import xarray as xr

from gaspart import theory

REPLICAS = np.linspace(-1.0, 1.0, 6)
"""Of the scatter of replicas: they add up to nothing."""


def scattered(values, width=0.001):
    """(..., replica) the values, with a relative scatter between replicas."""
    return np.multiply.outer(values, 1.0 + width * REPLICAS)


def gases(exponent=1.0, back=1.0, factor=1.0, fluctuation=1.0, energy=1.0, heat=1.0, speed=1.0, share=0.5):
    """Discs and spheres of each kind, whose numbers are these times those of theory."""
    dimensions = np.array([2, 3])
    volume = np.concatenate([np.linspace(1.0, 0.25, 10), np.linspace(0.3, 0.5, 5)])
    paths = []
    for dimension in dimensions:
        expected = theory.adiabatic_temperature(0.005 / volume, 0.005, dimension)
        power = np.where(np.arange(volume.size) < 10, exponent, back)
        paths.append(np.array([1.01 * expected ** (power * (1.0 + 0.001 * one)) for one in REPLICAS]))
    density = np.array([0.1, 0.3, 0.1, 0.3])
    kinds = np.repeat(dimensions, 2)
    known = [
        (
            theory.compressibility_factor(eta, d) * theory.constant_enthalpy_factor(eta, d, 500),
            theory.speed_of_sound(eta, d) ** -2,
        )
        for eta, d in zip(density, kinds, strict=True)
    ]
    factors, variances = np.array(known).T
    state, gas = ("state", "state_replica"), ("expansion", "expansion_replica")
    return xr.Dataset(
        {
            "path_volume": (("path", "path_replica", "frame"), np.tile(volume, (2, REPLICAS.size, 1))),
            "path_temperature": (("path", "path_replica", "frame"), np.array(paths)),
            "path_heating": (("path", "path_replica", "frame"), np.full_like(paths, np.log(1.01))),
            "path_dimension": ("path", dimensions),
            "path_packing_fraction": ("path", [0.005, 0.005]),
            "state_density": (state, scattered(density, 0.0)),
            "state_factor": (state, scattered(factor * factors)),
            "state_fluctuation": (state, scattered(fluctuation * variances, 0.05)),
            "state_energy": (state, scattered(energy + 0.03 * np.array([1.0, -1.0, 1.0, -1.0]), 0.1)),
            "state_dimension": ("state", kinds),
            "state_count": ("state", np.full(4, 500)),
            "expansion_heat": (gas, np.full((2, REPLICAS.size), heat)),
            "expansion_speed": (gas, scattered(np.full(2, speed))),
            "expansion_share": (gas, scattered(np.full(2, share))),
            "expansion_dimension": ("expansion", dimensions),
        }
    )
