"""The job whose trajectories may end when observables are accurate."""

import pytest

import gaspart as gp
from gaspart.reproduction.config import checked_points
from gaspart.reproduction.jobs.arguments import from_plain
from gaspart.reproduction.jobs.simulate import simulate
from gaspart.reproduction.points.modules import PACKAGE, closure

POINT = {"dimension": 3, "count": 60, "side": 8, "radius": 0.5, "boundary": "periodic", "temperature": 1.0}


def planned(folder="results/points", **settings):
    point = {**POINT, "duration": 4000.0, "until": {"Z": 0.1}, **settings}
    block = {"point": {key: one for key, one in point.items() if one is not None}}
    config = {"experiments": {"accurate": block}, "points": str(folder), "seed": 1}
    (point,) = checked_points(config, "accurate").values()
    return point


def test_a_point_ends_when_it_is_accurate(tmp_path):
    point = planned(tmp_path, replicas=2)
    simulate(tmp_path / "accurate/single", **from_plain(point.parameters))
    for path in point.replica_paths:
        (reached,) = gp.reached_accuracy(path)
        assert reached.met and reached.accuracy <= 0.1
        with gp.open_trajectory(path) as trajectory:
            assert float(trajectory.time[-1]) < 4000.0


def test_the_equilibration_is_not_examined():
    def start(**settings):
        (asked,) = planned(**settings).arguments["until"].accuracies
        return asked.start

    assert start() is None  # a quarter of the run
    assert start(equilibration=10.0, samples=4000) == 10.0
    assert planned(samples=4000).arguments["sample_interval"] == 1.0


def test_only_runs_with_until_depend_on_the_analysis():
    def packages(point):
        return {path.relative_to(PACKAGE).parts[0] for path in closure(*point.modules)}

    assert {"analysis", "accuracy"} <= packages(planned())
    assert {"analysis", "accuracy", "theory"}.isdisjoint(packages(planned(until=None)))


@pytest.mark.parametrize(
    ("settings", "line"),
    [
        ({"until": {"Q": 0.1}}, "until.observable = 'Q': unknown observable"),
        ({"until": {"pressure": 0.1}}, "until = 'pressure': container.boundary: has no walls: measure comp"),
        ({"lags": 10}, "lags = 10: has no meaning with until"),
        ({"duration": None}, "exactly one of collisions_per_particle, duration, steps must be given"),
    ],
)
def test_a_mistake_is_one_line(settings, line):
    with pytest.raises(gp.SceneError, match=line):
        planned(**settings)
