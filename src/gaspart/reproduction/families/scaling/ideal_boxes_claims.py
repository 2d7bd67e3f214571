"""Claims about the ideal number of boxes."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared.claims import (
    OTHER_MACHINE,
    SOURCE_A,
    exponent,
    rows,
)

_INTERVAL = 2.0 * 1.96  # a 95 % interval in standard errors


def ideal_boxes(ds: xr.Dataset) -> list[Claim]:
    """The source's numbers of boxes per particle, and how much they matter."""
    worst = ds.isel(gas=int(np.nanargmax(ds.penalty.values)))
    ratio = np.log(ds.model / ds.ideal).values
    ratio = ratio[ds.ideal_interior.values.astype(bool) & np.isfinite(ratio)]
    model = Estimate(math.nan, math.nan)
    if ratio.size > 1:
        model = Estimate(ratio.mean(), ratio.std(ddof=1) / math.sqrt(ratio.size))
    claims = [
        Claim.at_most(
            claim=f"time with {float(ds.rule):g} boxes per particle over the least, the worst of all gases",
            measured=Estimate.of(worst, "penalty"),
            bound=1.25,
            required=0.1,
            source=f"{SOURCE_A}, section 3.5: ideal is roughly ten",
            fails_if="the source's rule is far from the minimum on this machine",
        ),
        Claim.within(
            claim="ln of the ideal number by counted work over that by time, mean of the gases",
            measured=model,
            expected=0.0,
            half_width=0.3,
            source="(3^d c_test / 2 c_box)^(1/2), gaspart.theory.partition",
            fails_if="something other than pair tests and boxes determines the optimum",
        ),
    ]
    claims += [
        exponent(
            f"ideal number of boxes in N, r = {float(series.series_radius):g}",
            series,
            kind="reproduction",
            expected=1.0,
            half_width=0.4,
            source=f"{SOURCE_A}, figures 5 to 7: linear",
            why=OTHER_MACHINE,
            fails_if="the ideal number per particle depends on N, as when caches overflow",
        )
        for series in rows(ds, "series")
    ]
    for number, source in enumerate(rows(ds, "source"), start=5):
        claims += _source_numbers(source, f"{SOURCE_A}, figure {number}")
    claims += [
        Claim.at_most(
            claim=f"time with {int(part.plateau_boxes)} boxes over the least, the worst N from "
            f"{int(part.plateau_low)} to {int(part.plateau_high)}, r = {float(part.plateau_radius):g}",
            kind="reproduction",
            measured=Estimate.of(part, "plateau_penalty"),
            bound=1.05,
            required=0.05,
            source=f"{SOURCE_A}, section 3.4: so many are ideal in all of this range",
            why=OTHER_MACHINE,
            fails_if="the ideal number follows N, or is another",
        )
        for part in rows(ds, "plateau")
    ]
    return claims


def _source_numbers(source: xr.Dataset, origin: str) -> list[Claim]:
    """Whether the source's number for one gas is the ideal one, and how much slower it is.

    If no minimum lies between the timed partitions, its interval is infinite and the claim inconclusive."""
    number = float(source.source_number)
    gas = f"N = {int(source.source_count)}, r = {float(source.source_radius):g}"
    interval = float(source.source_ideal_high - source.source_ideal_low)
    return [
        Claim(
            claim=f"ideal number of boxes per particle, {gas}",
            kind="reproduction",
            measured=Estimate(source.source_ideal, interval / _INTERVAL),
            expected=Estimate(number, 0.1 * number),
            required=0.3 * float(source.source_ideal),
            source=origin,
            allowance_source="read from the source's figure to 10 %",
            why=OTHER_MACHINE,
            fails_if="another machine or program has other relative costs of tests and boxes",
        ),
        Claim.at_most(
            claim=f"time with {number:g} boxes per particle over the least, {gas}",
            kind="reproduction",
            measured=Estimate.of(source, "source_penalty"),
            bound=1.1,
            required=0.05,
            source=origin,
            why=OTHER_MACHINE,
            fails_if="the source's number is far from the minimum on this machine",
        ),
    ]
