"""Claims about the ideal number of boxes."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from gaspart.analysis.statistics import mean_of
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared.claims import OTHER_MACHINE, SOURCE_A
from gaspart.reproduction.table import Row, Table, each

_INTERVAL = 2.0 * 1.96  # a 95 % interval in standard errors


def ideal_boxes(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on the source's numbers of boxes per particle, and how much they matter."""
    gases, sources = Table(ds, "gas"), Table(ds, "source")
    return [
        Claim.at_most(
            claim=f"time with {gases.rule:g} boxes per particle over the least, the worst of all gases",
            measured=gases.penalty[int(np.nanargmax(gases.penalty.value))],
            bound=1.25,
            required=0.1,
            source=f"{SOURCE_A}, section 3.5: ideal is roughly ten",
            fails_if="the source's rule is far from the minimum on this machine",
        ),
        Claim.within(
            claim="ln of the ideal number by counted work over that by time, mean of the gases",
            measured=_work_over_time(gases),
            expected=0.0,
            half_width=0.3,
            source="(3^d c_test / 2 c_box)^(1/2), gaspart.theory.dsmc",
            fails_if="something other than pair tests and boxes determines the optimum",
        ),
        *_exponents(Table(ds, "series")),
        *(
            claim
            for number, source in enumerate(sources, start=5)
            for claim in _source_numbers(source, f"{SOURCE_A}, figure {number}")
        ),
        *_plateaus(Table(ds, "plateau")),
    ]


def _work_over_time(gases: Table) -> Estimate:
    """Compute the mean and scatter of ln(model / ideal) of the gases with a minimum."""
    ratio = np.log(gases.model / gases.ideal)
    ratio = ratio[gases.ideal_interior.astype(bool) & np.isfinite(ratio)]
    if ratio.size < 2:
        return Estimate(math.nan, math.nan)
    mean = mean_of(ratio)
    return Estimate(mean.value, mean.error)


def _exponents(series: Table) -> list[Claim]:
    return each(
        series,
        "exponent of the ideal number of boxes in N, r = {series_radius:g}",
        Claim.within,
        kind="reproduction",
        measured=series.exponent,
        expected=1.0,
        half_width=0.4,
        source=f"{SOURCE_A}, figures 5 to 7: linear",
        source_error=OTHER_MACHINE,
        fails_if="the ideal number per particle depends on N, as when caches overflow",
    )


def _plateaus(plateaus: Table) -> list[Claim]:
    return each(
        plateaus,
        "time with {plateau_boxes} boxes over the least, the worst N from {plateau_low} to {plateau_high}, "
        "r = {plateau_radius:g}",
        Claim.at_most,
        kind="reproduction",
        measured=plateaus.plateau_penalty,
        bound=1.05,
        required=0.05,
        source=f"{SOURCE_A}, section 3.4: so many are ideal in all of this range",
        source_error=OTHER_MACHINE,
        fails_if="the ideal number follows N, or is another",
    )


def _source_numbers(source: Row, origin: str) -> list[Claim]:
    """Return the claims on the source's number for one gas: ideality, and slowdown.

    If no minimum lies between the timed partitions, its interval is infinite and the claim inconclusive.
    """
    number, gas = source.source_number, f"N = {source.source_count}, r = {source.source_radius:g}"
    interval = source.source_ideal_high - source.source_ideal_low
    return [
        Claim(
            claim=f"ideal number of boxes per particle, {gas}",
            kind="reproduction",
            measured=Estimate(source.source_ideal, interval / _INTERVAL),
            expected=Estimate(number, 0.1 * number),
            required=0.3 * source.source_ideal,
            source=origin,
            allowance_source="read from the source's figure to 10 %",
            source_error=OTHER_MACHINE,
            fails_if="another machine or program has other relative costs of tests and boxes",
        ),
        Claim.at_most(
            claim=f"time with {number:g} boxes per particle over the least, {gas}",
            kind="reproduction",
            measured=source.source_penalty,
            bound=1.1,
            required=0.05,
            source=origin,
            source_error=OTHER_MACHINE,
            fails_if="the source's number is far from the minimum on this machine",
        ),
    ]
