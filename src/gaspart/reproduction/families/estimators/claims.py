"""Claims about estimators of the density, and of the pressure on walls."""

from __future__ import annotations

import xarray as xr

from gaspart.reproduction.claims import Claim
from gaspart.reproduction.table import Table, each

_DILUTE, _NARROW = 0.1, 0.15


def estimators(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims that counts and impulses agree, and that their mixture is better.

    The mixture has the smaller variance, by far in a dilute gas. Pressures with known means have a smaller
    variance too.
    """
    cases = Table(dataset, "case")
    narrow = cases[cases.width < _NARROW]
    dilute, dense = narrow[narrow.packing_fraction < _DILUTE], narrow[narrow.packing_fraction >= _DILUTE]
    once = narrow[narrow.width == narrow.width.min()]
    return [
        *_densities(cases, dilute, dense),
        *each(
            once,
            "pressure by impulses over that with what is known, less 1, at {packing_fraction:.2g}",
            measured=once.pressures_apart,
            expected=0.0,
            required=0.01,
            source="what is taken off has the mean 0 in equilibrium",
            fails_if="directions have unequal parts of the energy, or coefficients follow from the noise",
        ),
        *each(
            once[once.packing_fraction < _DILUTE],
            "squared error of the pressure over that with what is known, at {packing_fraction:.2g}",
            Claim.at_least,
            measured=once[once.packing_fraction < _DILUTE].pressure,
            bound=8.0,
            required=4.0,
            source="without contacts nothing else fluctuates (requirement)",
            fails_if="the energy along the axis is not what the wall is given",
        ),
    ]


def _densities(cases: Table, dilute: Table, dense: Table) -> list[Claim]:
    """Return the claims on densities."""
    return [
        *each(
            cases,
            "mean square of counts less impulses over errors, at {packing_fraction:.2g} in bins of {width:g}",
            measured=cases.mean_square,
            expected=1.0,
            required=0.4,
            source="both are unbiased; errors by blocks, Student's distribution",
            fails_if="impulses are missed, or the temperature of a particle depends on its place",
        ),
        *each(
            dilute,
            "variance of counts over that of the mixture, at {packing_fraction:.2g} in bins of {width:g}",
            Claim.at_least,
            measured=dilute.mixture,
            bound=20.0,
            required=4.0,
            source="the noise of counting is absent (requirement)",
            fails_if="impulses have noise of their own, or weights are too small",
        ),
        *each(
            dense,
            "variance of counts over that of the mixture, at {packing_fraction:.2g} in bins of {width:g}",
            Claim.at_least,
            measured=dense.mixture,
            bound=1.3,
            required=0.2,
            source="a mixture is never worse than counts (requirement)",
            fails_if="weights are chosen by noise",
        ),
    ]
