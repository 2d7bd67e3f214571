"""Fits of the figures, made from data whose uncertainties come from a few replicas: their deviations scatter
as those of a standard Gaussian number."""

from itertools import islice

import numpy as np
import pytest
import xarray as xr
from reproduction.figures.test_virial import ETA

from gaspart.analysis.estimate import Estimate
from gaspart.reproduction.figures import adsorption, beds
from gaspart.reproduction.figures.msd_spheres import size_series
from gaspart.reproduction.figures.virial import fit_coefficients
from gaspart.reproduction.table import Table
from gaspart.theory import enskog_viscosity, erpenbeck_wood_diffusion, number_density, yeh_hummer
from gaspart.theory.state import compressibility_factor

pytestmark = pytest.mark.thorough

REPEATED = 400
BEDS = xr.Dataset({
    "restitution": ("bed", [0.995, 0.99, 0.98, 0.95, 0.9]),
    **{
        name: ("bed", np.full(5, value))
        for name, value in {"sine": 1, "layers": 2.0, "speed": 0.4, "packing_fraction": 0.008}.items()
    },
})  # fmt: skip
X, UNIT = (of(Table(BEDS, "bed")) for of in (beds.small_parameter, beds.expected_temperature))
BEDS["temperature"] = "bed", (1.0 - 0.5 * X + 0.2 * X**2) * UNIT
BEDS["temperature_error"] = "bed", 0.003 * UNIT
TEMPERATURES = np.array([0.4, 0.6, 1.0, 2.0])
WELL = xr.Dataset({
    name: ("point", np.full(4, value) if np.isscalar(value) else value)
    for name, value in {
        "kind": "ideal", "mass": 1.0, "temperature": TEMPERATURES, "depth": 1.0, "width": 0.2,
        "log_ratio": np.log(adsorption.well_ratio(1.0 / TEMPERATURES, 0.2, 2.0)), "log_ratio_error": 0.002,
        "length": 0.2, "length_error": 0.0004,
    }.items()
})  # fmt: skip
SIDES = (np.array([256, 864, 2048]) / float(number_density(0.3, 3))) ** (1 / 3)
SIZES = xr.Dataset({
    name: ("point", np.broadcast_to(values, 3))
    for name, values in {
        "side": SIDES, "in_series": True, "correction": yeh_hummer(SIDES, enskog_viscosity(0.3, 3)),
    }.items()
})  # fmt: skip
D = float(erpenbeck_wood_diffusion(0.3))
SIZES = SIZES.assign(diffusion=D - SIZES.correction, diffusion_error=("point", np.full(3, 0.002 * D)))


def scattered(rng, ds, freedom, names):
    """The data set as replicas would give it: each number scatters by its error, which has so many degrees
    of freedom itself."""
    ds = ds.copy(deep=True)
    for name in names:
        error = ds[f"{name}_error"]
        ds[name] = ds[name] + error * rng.standard_normal(error.shape)
        ds[f"{name}_error"] = error * np.sqrt(rng.chisquare(freedom, error.shape) / freedom)
        ds[f"{name}_freedom"] = ds[name].dims, np.full(error.shape, freedom)
    return ds


def bed(rng):
    """The sine's limit of elastic discs."""
    return [beds.extrapolation(Table(scattered(rng, BEDS, 7, ["temperature"]), "bed")).estimate(0) - 1.0]


def well(rng):
    """The length in place of the thermal wavelength, the slope in the temperature, the power of it."""
    ds = scattered(rng, WELL, 11, ["log_ratio", "length"])
    return [claim.measured - claim.expected for claim in islice(adsorption.claims(ds), 3)]


def sizes(rng):
    """The slope of D in 1 / L."""
    found = size_series(scattered(rng, SIZES, 5, ["diffusion"]))
    exact = size_series(SIZES.assign(diffusion_freedom=("point", np.full(3, np.inf))))
    return [Estimate.of(found, "size_slope") - exact["size_slope"]]


def state(rng):
    """B2 to B4."""
    z, freedom = compressibility_factor(ETA, 2), 11
    error = (z - 1.0) / 2e3
    seen = z + error * rng.standard_normal(z.size)
    own = error * np.sqrt(rng.chisquare(freedom, z.size) / freedom)
    found, _ = fit_coefficients(ETA, Estimate(seen, own, freedom), 2, 4, True)
    exact, _ = fit_coefficients(ETA, Estimate(z, error), 2, 4, True)
    return [found.estimate(n) - exact.values[n] for n in range(3)]


@pytest.mark.parametrize("figure", [bed, well, sizes, state])
def test_fits_to_a_few_replicas_are_as_certain_as_they_state(figure):
    rng = np.random.default_rng(17)
    found = np.array([[one.deviation for one in figure(rng)] for _ in range(REPEATED)])
    width = np.sqrt(np.mean(found**2, axis=0))
    assert width == pytest.approx(np.ones(width.size), abs=3.5 / np.sqrt(2.0 * REPEATED))
    assert np.all(np.mean(np.abs(found) > 3.0, axis=0) < 0.0125)
