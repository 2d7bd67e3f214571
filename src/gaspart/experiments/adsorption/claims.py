"""What the figure of walls that hold bodies claims."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.analysis.statistics import combine, fit_polynomial, fit_power_law
from gaspart.claims import Claim
from gaspart.theory.adsorption import planck_constant, slow_flux_share

LANGMUIR = "Boltzmann factor of the well (exact for an ideal gas; Langmuir's formula, source A section 4.5)"
OWN_LENGTH = "equilibrium of an ideal gas with a step well: the length is its width (exact)"


def adsorption(ds: xr.Dataset) -> list[Claim]:
    """Slope, prefactor, hard layer, and the balance that the source's own rule breaks."""
    kinds = {kind: ds.isel(point=np.flatnonzero(ds["kind"] == kind)) for kind in ("ideal", "layer", "sticky")}
    return [*_ideal(kinds["ideal"]), *_layer(kinds["layer"]), *_sticky(kinds["sticky"], kinds["ideal"])]


def _ideal(ds: xr.Dataset) -> list[Claim]:
    claims = []
    for width in np.unique(ds["width"]):
        same = ds.isel(point=np.flatnonzero(ds["width"] == width))
        length = combine(same["length"].values, same["length_error"].values)
        claims.append(
            Claim(
                f"length in the place of the thermal wavelength over the width of the well, width {width:g}",
                "test",
                length.value / width,
                length.error / width,
                0.01,
                1.0,
                OWN_LENGTH,
                fails_if="a prefactor of its own: bodies let in or out against the Boltzmann factor",
            )
        )
        for depth in np.unique(same["depth"]):
            line = same.isel(point=np.flatnonzero(same["depth"] == depth))
            if line.sizes["point"] > 1:
                claims += _slopes(line, float(depth))
    return claims


def _slopes(ds: xr.Dataset, depth: float) -> list[Claim]:
    """Of temperatures of one well."""
    slope = fit_polynomial(
        1.0 / ds["temperature"].values, ds["log_ratio"].values, ds["log_ratio_error"].values
    )
    per_length = planck_constant(1.0, ds["mass"].values, ds["temperature"].values)
    planck, error = (per_length * ds[name].values for name in ("length", "length_error"))
    power = fit_power_law(ds["temperature"].values, planck, error)
    return [
        Claim(
            f"slope of ln(N_ads/N_gas) against 1/kT over the depth, depth {depth:g}",
            "test",
            slope.values[1] / depth,
            slope.errors[1] / depth,
            0.005,
            1.0,
            LANGMUIR,
            fails_if="bodies that leave the well with less, or more, than its depth",
        ),
        Claim(
            f"power of T in h = lambda sqrt(2 pi m k T), lambda the length in that place, depth {depth:g}",
            "test",
            power.exponent,
            power.exponent_error,
            0.02,
            0.5,
            f"{OWN_LENGTH}; Planck's constant would be constant, the power 0",
            fails_if="a length that depends on T: a thermal wavelength, and so Planck's constant, at -1/2",
        ),
    ]


def _layer(ds: xr.Dataset) -> list[Claim]:
    return [
        Claim(
            f"coverage over that of hard discs at the gas' pressure, depth {float(row['depth']):g}, "
            f"coverage {float(row['coverage']):.2f}",
            "test",
            row["filling"],
            row["filling_error"],
            0.04,
            1.0,
            "spheres of a layer much thinner than they are, as hard discs (virial series to B10); uncertain "
            "by what the gas before the layer does",
            expected_uncertainty=float(row["layer_uncertainty"]),
            fails_if="spheres that adsorb as if they did not meet, or as if each had a place of its own",
        )
        for row in (ds.isel(point=n) for n in range(ds.sizes["point"]))
    ]


def _sticky(ds: xr.Dataset, wells: xr.Dataset) -> list[Claim]:
    power = fit_power_law(ds["gas_density"].values, ds["coverage"].values, ds["coverage_error"].values)
    slow = float(slow_flux_share(ds["slow_speed"].values[0]))
    stuck = combine(ds["slow_share"].values, ds["slow_share_error"].values)
    well = combine(wells["slow_share"].values, wells["slow_share_error"].values)
    return [
        Claim.at_most(
            "sticky rule: power of the gas' density in the coverage of a wall that is hardly covered",
            "test",
            power.exponent,
            power.exponent_error,
            0.1,
            0.2,
            "the gas both brings bodies and frees them, both as its density; Henry's law asks for 1",
            "a coverage that follows the pressure, as it does if detailed balance holds",
        ),
        Claim.at_most(
            "sticky rule: slow bodies that leave the wall, over those that would in equilibrium",
            "test",
            stuck.value / slow,
            stuck.error / slow,
            0.1,
            0.5,
            "slow ones stick, and none is sent back so slowly: only those that lose speed when freed remain",
            "a wall that sends back as many slow bodies as it takes",
        ),
        Claim(
            "wells: share of the bodies that leave below sqrt(kT/m)",
            "test",
            well.value,
            well.error,
            0.005,
            float(slow_flux_share(1.0)),
            "flux of a Maxwellian, 1 - e^(-1/2) (exact)",
            fails_if="a well that sorts bodies by their speed",
        ),
    ]
