"""The settings of a point whose runs have a multiple of their length.

An uncertainty falls as the inverse root of the length. So a point of which no claim needs much can be shorter
than the others of its grid: `lengths` of a config has the multiples.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from gaspart.reproduction.points.point_keys import LENGTHS

_LEAST_REPLICAS = 6
"""Number of replicas below which their scatter is no measure of the uncertainty."""
_LEAST_SAMPLES = 32
"""Number of samples below which runs have no fewer: blocks are made of them."""
_LEAST_TIMINGS = 3
_OF_SEEDS = ("echo", "fill", "pack")
"""Jobs whose work is the same for each replica, whatever the length."""


def scale_length(job: str, settings: Mapping[str, Any], multiple: float) -> dict[str, Any]:
    """Return the settings with `multiple` times as many replicas, and for the rest with longer runs.

    Runs keep the interval between samples as long as there are enough of these. The length of a run that does
    not begin with an equilibration is not changed: it describes how something proceeds.
    """
    result = dict(settings)
    replicas = result.get("replicas", 1)
    if replicas > 1 and job in ("simulate", *_OF_SEEDS):
        result["replicas"] = max(math.ceil(replicas * multiple - 1e-9), min(replicas, _LEAST_REPLICAS))
        multiple *= replicas / result["replicas"]
    if job in _OF_SEEDS or (job == "simulate" and not result.get("equilibration")) or "until" in result:
        return result
    if job == "simulate" and "lags" not in result:
        return result | _resample(result, multiple, _LEAST_SAMPLES, even=False)
    return result | _resample(result, multiple, 1 if job == "simulate" else _LEAST_TIMINGS, even=True)


def _resample(settings: Mapping[str, Any], multiple: float, least: int, even: bool) -> dict[str, Any]:
    """Return the length and the samples of a run that is `multiple` times as long.

    If `even`, all intervals between samples stay as they are, for example between lags and in timings.
    """
    changes: dict[str, Any] = {}
    samples = settings.get("samples", 1)
    each = samples // settings["frames"] if "frames" in settings else 1  # samples of a frame
    frames = math.ceil(samples / each * multiple - 1e-9)
    frames = max(frames, min(samples // each, least))
    if "samples" in settings:
        changes["samples"] = frames * each
    if "frames" in settings:
        changes["frames"] = frames
    if even:
        multiple = frames * each / samples
    for unit in LENGTHS.keys() & settings.keys():
        changes[unit] = settings[unit] * multiple
    if "steps" in changes:
        changes["steps"] = max(1, round(changes["steps"]))
    return changes
