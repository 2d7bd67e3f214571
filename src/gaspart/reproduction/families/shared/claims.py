"""Parts of claims that several modules share."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.analysis.statistics import combine, combine_estimates
from gaspart.reproduction.claims import Estimate
from gaspart.reproduction.families.shared.rows import estimates

SOURCE_A, SOURCE_C = "[source A]", "[source C]"
OTHER_MACHINE = "on this machine, and by this program, tests and boxes have other relative costs"
"""Why an optimum that source A reports need not be the one found here."""
PARTICLES = {2: "discs", 3: "spheres"}
"""Names of the particles in each dimension."""
ENSKOG_LIMIT = 0.02
"""Packing fraction up to which a gas counts as dilute."""
MODE_COUPLING = "hydrodynamic modes of the container, transport coefficients Enskog's (gaspart.theory.modes)"


def weighted_mean(estimates: list[Estimate]) -> Estimate:
    """Their mean, weighted by the errors; not a number of none, as in a run of fewer points."""
    return combine_estimates(estimates) if estimates else Estimate(np.nan, np.nan)


def rows(dataset: xr.Dataset, dimension: str) -> list[xr.Dataset]:
    """The dataset at each position along `dimension`; an empty list if it has no such dimension."""
    return [dataset.isel({dimension: position}) for position in range(dataset.sizes.get(dimension, 0))]


def freedoms(dataset: xr.Dataset, name: str) -> np.ndarray:
    """Degrees of freedom of the errors of a variable of one dimension; infinite where none are stated (see
    `Estimate.of`)."""
    return np.array([Estimate.of(at, name).freedom for at in rows(dataset, str(dataset[name].dims[0]))])


def combined(dataset: xr.Dataset, name: str) -> Estimate:
    """Mean of a variable of one dimension, weighted by its errors."""
    values, errors = estimates(dataset, name)
    return combine(values, errors, freedoms(dataset, name)).estimate
