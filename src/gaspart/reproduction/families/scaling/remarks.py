"""Source A's remarks on the cost of a step, tested by alternate timings.

Jobs time a gas with and without something.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis.statistics import means_of
from gaspart.reproduction.families.shared.timings import log_ratios, per_particle, ratio_of_jobs
from gaspart.reproduction.table import entries
from gaspart.theory.dsmc import boxes_in_reach, share_of_contacts_in_a_box


def near_boxes(runs: list[xr.Dataset]) -> xr.Dataset:
    """Compare the search of boxes within reach of a contact with that over all neighbours.

    `runs` are jobs of one gas, each with the same partitions. Over ``near`` (the partitions):
    ``near_boxes_per_side``; with only the boxes within reach the ``near_seconds`` per particle and step, with
    the error from the scatter of the jobs, and ``near_box_visits``; ``near_expected_visits``, the visits in a
    uniform gas far from walls. Scalars: ``near_least``, the least time of all partitions over the least with
    all neighbouring boxes, with error and ``_freedom``; ``near_missed``, the largest difference of the
    contacts found; ``own_first``, the share of searches that could end in the own box if that is searched
    first and the boxes are the widest: there must be a contact (counted) and its partner in the box
    (`share_of_contacts_in_a_box`); with error.
    """
    first, partitions = runs[0], runs[0].sizes["partition"] // 2
    width = first.side / first.boxes_per_side.values[:partitions]
    costs = [per_particle(run) for run in runs]
    timed = np.array([cost.seconds.values for cost in costs])
    seconds, error = means_of(timed[:, :partitions])
    least = ratio_of_jobs(np.log(timed[:, :partitions].min(axis=1) / timed[:, partitions:].min(axis=1)))
    visits = np.mean([cost.box_visits.values[:partitions] for cost in costs], axis=0)
    reached = boxes_in_reach(width, 2.0 * first.radius, first.dimension)
    contacts = np.array([run.collisions.values for run in runs])
    colliding = [2.0 * run.collisions.values[0] / (run.attrs["count"] * run.steps.values[0]) for run in runs]
    within = share_of_contacts_in_a_box(width.max(), 2.0 * first.radius, first.dimension)
    return xr.Dataset(
        {
            "near_boxes_per_side": ("near", first.boxes_per_side.values[:partitions]),
            "near_seconds": ("near", seconds, {"units": "s"}),
            "near_seconds_error": ("near", error, {"units": "s"}),
            "near_box_visits": ("near", visits),
            "near_expected_visits": ("near", 0.5 + 0.5 * reached),
            "near_missed": int(np.ptp(contacts, axis=1).max()),
            **entries({"near_least": least, "own_first": means_of(np.array(colliding) * within)}),
        }
    )


def huge_sphere(runs: list[xr.Dataset]) -> dict[str, Any]:
    """Compute the cost of a sphere that is too large for the boxes.

    It follows from jobs without and with the sphere.

    ``huge_ratio`` is the time of a step with it over the time without, with error and ``_freedom`` from the
    scatter of the jobs; ``huge_tests`` is the number of further pairs tested per particle and step, with
    error.
    """
    ratio = ratio_of_jobs([-log_ratios(run, run.steps.values)[0] for run in runs])
    tests = [np.diff(run.pair_tests.values / run.steps.values)[0] / run.attrs["count"] for run in runs]
    return entries({"huge_ratio": ratio, "huge_tests": means_of(tests)})
