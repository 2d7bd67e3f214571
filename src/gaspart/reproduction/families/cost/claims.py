"""Claims about the cost of features, and the gain from several cores."""

from __future__ import annotations

import xarray as xr

from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.table import Table, each

LARGEST_RATIO = 1.25
"""Largest allowed time with a feature divided by the time without it; the speed is then 0.8."""
_REORDERED = 1e-3  # fraction of all instructions, since the compiler may order some of them differently


def price_of_features(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on kernels without and with features.

    If a kernel is compiled without a feature, it equals a kernel whose source does not have the feature. A
    kernel with a feature is not much slower.
    """
    kernels, timed = Table(ds, "kernel"), Table(ds, "point")
    plain, present = timed[timed.feature == "plain"], timed[timed.feature != "plain"]
    return [
        *(_absent(kernels) if kernels else []),
        *each(
            plain,
            "time per event of the plain scene over that of itself beside it, {engine} engine",
            measured=plain.ratio,
            expected=1.0,
            required=0.05,
            source="the same work, timed in turn",
            fails_if="what disturbs the machine favours one of two scenes, or the uncertainty is too small",
        ),
        *each(
            present,
            "time per event with {feature} over that without, {engine} engine",
            Claim.at_most,
            measured=present.ratio,
            bound=LARGEST_RATIO,
            required=0.1,
            source="at least 0.8 of the speed without (this project's aim)",
            fails_if="a feature slows the engine down",
        ),
    ]


def _absent(kernels: Table) -> list[Claim]:
    return each(
        kernels,
        "absent features: instructions of the {kernel} engine's kernel over those of one whose source never "
        "had them",
        Claim.within,
        measured=Estimate(kernels.instructions / kernels.stripped),
        expected=1.0,
        half_width=_REORDERED,
        source="branches on None vanish when a kernel is compiled (counted)",
        fails_if="an absent feature leaves code behind",
    )


LARGE = 10**5
"""Number of particles above which threads must be faster; the largest gas of each kind claims this."""
_SMALL = 10**4  # largest number of particles for which two simultaneous runs do not compete for the caches
_IDLE = "the uncertainty has what other programs took of the cores, for which runs at once waited"


def cores(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims that threads change no bit, and that two cores are faster."""
    runs = Table.from_prefixed(dataset, "run")
    two = runs[runs.cores == 2]
    threads = two[(two.copies == 1) & (two.count >= LARGE)]
    copies = two[(two.copies == 2) & (two.count <= _SMALL) & (two.engine == "event-driven")]
    largest = [gas.sorted_by("count")[-1:] for *_, gas in threads.by("engine", "packing_fraction")]
    return [
        *(_bits(engine, same) for engine, same in runs.by("engine")),
        *(
            claim
            for gas in largest
            for claim in each(
                gas,
                "speed with two threads over one, {engine}, {count} spheres at {packing_fraction:g}",
                Claim.at_least,
                measured=gas.speed,
                bound=1.7,
                required=0.1,
                source=f"at least 1.7 on two idle cores (this project's aim); {_IDLE}",
                fails_if="too much of the work is done by one thread, or threads wait for one another",
            )
        ),
        *each(
            copies,
            "speed of two runs at once over one, {engine}, {count} spheres at {packing_fraction:g}",
            Claim.at_least,
            measured=copies.speed,
            bound=1.85,
            required=0.1,
            source=f"at least 1.85 on two idle cores (this project's aim); {_IDLE}",
            fails_if="kernels hold a lock, or write to memory that they share",
        ),
    ]


def _bits(engine: str, runs: Table) -> Claim:
    """Return one claim on equal bits for all runs of an engine."""
    return Claim(
        claim=f"runs on several cores that differ from one core in any bit, {engine}, of {len(runs)}",
        measured=Estimate(float((runs.same == 0).sum())),
        expected=0,
        required=0.0,
        source="digests of positions, velocities and sums over collisions at the end (exact)",
        fails_if="the order of collisions or of sums depends on threads",
    )
