"""At every effort each figure of the reproduction has what it is made of."""

from pathlib import Path

import pytest

from gaspart.reproduction.config import merged_with_default
from gaspart.reproduction.figures.brownian import DIFFUSION_AT, Sphere
from gaspart.reproduction.points.points import all_points

FULL, _ = merged_with_default(Path(__file__).parents[3] / "config/config.yaml")
WHOLE = all_points(FULL | {"effort": 1.0})
BLOCKS = {
    experiment: [
        block.get(key, 0)
        for block in FULL["figures"].values()
        for key in ("blocks", "layer_blocks")
        if experiment in block["experiments"]
    ]
    for experiment in FULL["experiments"]
}
PATHS = FULL["figures"]["brownian_msd"]["experiments"]


def span(point):
    """Time of the longest lag of the correlations of a point."""
    correlations = point.arguments["correlations"]
    return correlations and (correlations["interval"], correlations["lags"])


@pytest.mark.parametrize("effort", [0.03, 0.06, 0.125, 0.25, 0.5, 2.0, 8.0])
def test_every_figure_has_its_blocks_lags_and_replicas(effort):
    planned = all_points(FULL | {"effort": effort})
    simulated = [
        name for name, block in FULL["experiments"].items() if block.get("job", "simulate") == "simulate"
    ]
    for experiment in simulated:
        for name, whole in WHOLE[experiment].items():
            point = planned[experiment][name]
            assert point.seeds[: whole.replicas] == whole.seeds[: point.replicas]
            assert point.replicas >= min(whole.replicas, 6)
            assert point.schedule.sample_interval == pytest.approx(whole.schedule.sample_interval, rel=1e-12)
            least = min(whole.schedule.samples, max([32, *BLOCKS[experiment]]))
            assert point.schedule.samples >= least
            assert span(point) == span(whole)
            if span(point):
                assert point.schedule.samples >= min(2 * span(point)[1], whole.schedule.samples)


@pytest.mark.parametrize("effort", [0.03, 0.25, 1.0, 8.0])
def test_paths_are_followed_to_the_time_at_which_diffusion_is_read(effort):
    config = FULL | {"effort": effort, "experiments": {name: FULL["experiments"][name] for name in PATHS}}
    for points in all_points(config).values():
        for point in points.values():
            sphere = Sphere(point)
            rate = sphere.friction / (1.0 - sphere.share)
            assert rate * (point.schedule.duration - point.schedule.equilibration) >= 2.0 * DIFFUSION_AT
