"""Parts of claims that several families share."""

from __future__ import annotations

import numpy as np
import xarray as xr

PARTICLES = {2: "discs", 3: "spheres"}
"""Names of the particles in each dimension."""
MODE_COUPLING = "hydrodynamic modes of the container, transport coefficients Enskog's (gaspart.theory.modes)"


def is_source(experiment: str) -> bool:
    """Whether the experiment, by its name, is source C's own scene."""
    return experiment.endswith("_source")


def rows(dataset: xr.Dataset, dimension: str) -> list[xr.Dataset]:
    """The dataset at each position along `dimension`; an empty list if it has no such dimension."""
    return [dataset.isel({dimension: position}) for position in range(dataset.sizes.get(dimension, 0))]


def deviations(dataset: xr.Dataset, measured: str, expected: str) -> np.ndarray:
    """measured - expected of two variables, in the standard deviations of their difference.

    The uncertainties are the variables of the same names with the suffix _error.
    """
    spread = np.hypot(dataset[f"{measured}_error"], dataset[f"{expected}_error"])
    return ((dataset[measured] - dataset[expected]) / spread).values
