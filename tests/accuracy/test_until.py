"""Runs that end when they are accurate."""

import math
from dataclasses import astuple

import numpy as np
import pytest
from scenes import gas
from scipy.signal import lfilter

import gaspart as gp
from gaspart.accuracy import reached
from gaspart.accuracy.reached import AccuracyStatus, Examiner, combine_replicas, confirm_estimate
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import correlated_mean
from gaspart.analysis.statistics.blocks import ORDER
from gaspart.cli.options import accuracy_lines
from gaspart.trajectory import recording
from gaspart.trajectory.opening import partial_path
from gaspart.trajectory.recipe import read_recipe
from gaspart.trajectory.run_options import examined_before, examined_frames, is_examined

RUNS = 2000
COUNTS = [64, 96, 128, 192, 256, 384, 512, 768, 1024, 1536]


def autoregressions(found):
    """`gaspart.analysis.statistics.blocks._autoregression` of many series at once, (runs, lags)."""
    known, error, rest, inverse = np.zeros((len(found), 0)), found[:, 0], 1.0, 0.0
    for order in range(1, found.shape[1]):
        inverse = inverse + rest**2 / error
        partial = (found[:, order] - (known * found[:, order - 1 : 0 : -1]).sum(axis=1)) / error
        known = np.column_stack([known - partial[:, None] * known[:, ::-1], partial])
        error, rest = error * (1.0 - partial**2), rest * (1.0 - partial)
    return error / rest**2, error * inverse / rest**2


def estimates(series):
    """`correlated_mean` of many series at once, (runs, samples): values, errors, degrees of freedom."""
    number = series.shape[1]
    centred = series - series.mean(axis=1, keepdims=True)
    lags = range(round(ORDER * number ** (1.0 / 3.0)) + 1)
    found = [np.einsum("ij,ij->i", centred[:, : number - lag], centred[:, lag:]) for lag in lags]
    found = np.stack(found, axis=1) / number
    first, _ = autoregressions(found)
    total, variance = autoregressions(found + first[:, None] / number)
    return series.mean(axis=1), np.sqrt(total / number), number / (1.0 + 2.0 * variance)


def autoregressive(correlation):
    """Series about 1 (RUNS, samples), the standard error of the mean of n samples times sqrt(n), and
    estimates at each examination, (examinations, RUNS, 3)."""
    noise = np.random.default_rng(7).standard_normal((RUNS, COUNTS[-1] + 64))
    series = 1.0 + 0.1 * lfilter([1.0], [1.0, -correlation], noise)[:, 64:]
    known = [np.stack(estimates(series[:, count // 4 : count]), axis=1) for count in COUNTS]
    return series, 0.1 / (1.0 - correlation), np.array(known)


def ended(known, accuracy):
    """(value, interval, samples) when the rule ends a run, or None; known: estimates at each examination."""
    before, length, asked = None, 0, gp.Accuracy("Z", accuracy)
    for row, count in zip(known, COUNTS, strict=True):
        now, samples = Estimate(*row), count - count // 4
        one = confirm_estimate(now, before, length / samples)
        values = one.value, abs(one.value), one.error, one.freedom
        reached = AccuracyStatus(asked, "", *values, before is not None)
        if reached.met:
            return one.value, reached.interval, samples
        before, length = now, samples
    return None


@pytest.mark.parametrize(
    "correlation", [0.5, *(pytest.param(x, marks=pytest.mark.thorough) for x in (-0.3, 0.0, 0.8))]
)
def test_the_interval_at_the_end_covers_the_true_value_in_95_of_100_runs(correlation):
    """Autoregressive series of a known mean. The accuracies are such that runs end at many examinations."""
    series, scale, known = autoregressive(correlation)
    for run in range(3):
        mine = correlated_mean(series[run, COUNTS[3] // 4 : COUNTS[3]]).estimate
        assert known[3, run] == pytest.approx([mine.value, mine.error, mine.freedom], rel=1e-9)
    rows = known.swapaxes(0, 1)
    check_coverage(rows, scale)
    if correlation == 0.5:
        check_coverage(means(rows, 3), scale / math.sqrt(3.0))


def means(rows, replicas):
    """Estimates, as `rows` of `check_coverage`, of the means of so many runs."""
    groups = rows[: RUNS // replicas * replicas].reshape(-1, replicas, *rows.shape[1:]).swapaxes(1, 2)
    return np.array(
        [[astuple(combine_replicas([Estimate(*one) for one in each])) for each in group] for group in groups]
    )


def check_coverage(rows, scale):
    """That of runs that end. rows: estimates of each at each examination; scale: as of `autoregressive`."""
    wanted = np.exp(np.random.default_rng(8).uniform(math.log(96), math.log(384), len(rows)))
    ends = [
        (accuracy, end)
        for row, accuracy in zip(rows, scale / np.sqrt(wanted), strict=True)
        if (end := ended(row, accuracy))
    ]
    assert len(ends) > 0.98 * len(rows) and len({end[2] for _, end in ends}) > 4
    covered = np.mean([low <= 1.0 <= high for _, (_, (low, high), _) in ends])
    kept = np.mean([scale / math.sqrt(samples) <= accuracy for accuracy, (_, _, samples) in ends])
    assert 0.93 < covered < 0.97
    assert kept > 0.96


@pytest.mark.parametrize("form", ["square", "sine"])
@pytest.mark.parametrize("period", [10, 20, 50, 100, 150, 200, 300, 500, 1000, 2000])
def test_a_periodic_series_ends_no_run_before_it_is_known(form, period):
    """Series of an even period, whose mean is 1; of long periods less than one is seen, at any phase."""
    ends = 0
    for phase in np.random.default_rng(9).random(10):
        wave = np.sin(2.0 * math.pi * ((np.arange(COUNTS[-1]) + 0.01) / period + phase))
        series = 1.0 + 0.5 * (np.sign(wave) if form == "square" else wave)
        known = [astuple(correlated_mean(series[count // 4 : count]).estimate) for count in COUNTS]
        if end := ended(known, 0.02):
            low, high = end[1]
            assert low <= 1.0 <= high
            ends += 1
    assert ends == (10 if period <= 20 else ends if period <= 100 else 0)


@pytest.mark.interpreted
def test_a_series_that_never_changes_is_given_up(tmp_path, monkeypatch):
    """A particle that hits a wall once in each interval between frames: the next one may differ."""
    monkeypatch.setattr(reached, "IDLE", 128)
    scene = gp.Scene(gp.Container((8.0, 8.0)), [], [gp.Particle((1.0, 1.0), (1.0, 0.0), 0.5)])
    run = {"engine": gp.EventDriven(), "seed": 1, "sample_interval": 14.0}
    path = tmp_path / "run.nc"
    gp.run(scene, path=path, until=gp.Accuracy("pressure", 0.1, face="x low"), **run)
    (one,) = gp.reached_accuracy(path)
    assert one.value == pytest.approx(1.0 / 7.0**2, rel=1e-9) and not one.met
    assert "all are the same so far" in accuracy_lines(path)[0]
    with gp.open_trajectory(path) as data:
        assert data.sizes["frame"] == 128


GAS = gas(3, 32, 0.2)
FROM_REST = gp.Scene(
    gp.Container((8.0, 8.0, 8.0), boundary="periodic"),
    gp.Species(20, 0.5),
    restitution=gp.Restitution(0.9),
    thermostat=gp.Thermostat(1.0, 0.1),
)
ASKED = gp.Accuracy("Z", 0.02), gp.Accuracy("collision_rate", 0.03)
SETTINGS = {"scene": GAS, "engine": gp.EventDriven("direct"), "seed": 3, "sample_interval": 0.4}


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A run until ASKED."""
    return gp.run(**SETTINGS, until=ASKED, path=tmp_path_factory.mktemp("whole") / "run.nc")


def test_a_gas_is_run_until_it_is_accurate(whole):
    reached = gp.reached_accuracy(whole)
    measured = gp.analysis.compressibility_factor(whole), gp.analysis.collision_rate(whole)
    with gp.open_trajectory(whole) as data:
        frames = data.sizes["frame"]
    assert is_examined(frames) and frames > 64
    for one, asked, observable in zip(reached, ASKED, measured, strict=True):
        assert one.request == asked and one.met and one.accuracy <= asked.accuracy
        assert one.value == float(observable.estimate) and one.error >= float(observable.error)
        low, high = one.interval
        assert abs(one.value - float(observable.theory)) < high - low
    before = gp.analysis.compressibility_factor  # one examination earlier it was not accurate
    with gp.open_trajectory(whole) as data:
        earlier = Examiner().examine([data], ASKED, examined_before(frames))
        assert before(data.isel(frame=slice(examined_before(frames)))).estimate == earlier[0].value
    assert not all(one.met for one in earlier)


@pytest.mark.parametrize(
    "frames", [64, 200, *(pytest.param(n, marks=pytest.mark.thorough) for n in (1, 63, 65))]
)
def test_a_run_that_was_cut_short_ends_at_the_same_frame(tmp_path, monkeypatch, whole, frames):
    """Just before an examination, at it and after it, and anywhere."""
    path, reach = tmp_path / "run.nc", recording.Recording._finish_frame

    def cut(self, signals):
        if self._frames.count == frames:
            self._save()
            raise KeyboardInterrupt
        reach(self, signals)

    monkeypatch.setattr(recording.Recording, "_finish_frame", cut)
    with pytest.raises(KeyboardInterrupt):
        gp.run(**SETTINGS, until=ASKED, path=path)
    monkeypatch.undo()
    assert read_recipe(partial_path(path)).until.accuracies == ASKED
    assert gp.resume(path).read_bytes() == whole.read_bytes()


def test_a_complete_run_is_kept_and_not_resumed(whole):
    stamp = whole.stat().st_mtime_ns
    gp.run(**SETTINGS, until=ASKED, path=whole)
    assert whole.stat().st_mtime_ns == stamp
    with pytest.raises(gp.SceneError, match="is already complete"):
        gp.resume(whole)
    with pytest.raises(gp.SceneError, match="of another run"):
        gp.run(**SETTINGS, until=gp.Accuracy("Z", 0.01), path=whole)


def test_the_longest_duration_ends_a_run(tmp_path):
    path = gp.run(**SETTINGS, until=gp.Accuracy("Z", 1e-4), at_most=30.1, path=tmp_path / "run.nc")
    with gp.open_trajectory(path) as data:
        assert data["time"].values[-1] == pytest.approx(30.0)
    (one,) = gp.reached_accuracy(path)
    assert not one.met and 1e-4 < one.accuracy < 0.1
    with pytest.raises(gp.SceneError, match="is already complete"):
        gp.resume(path)


def test_progress_estimates_the_duration(tmp_path, monkeypatch, whole):
    monkeypatch.setattr(recording, "_PROGRESS", 0.0)
    seen, examined = [], []
    again = {"progress": lambda *x: seen.append(x), "examined": examined.append}
    gp.run(**SETTINGS, until=ASKED, path=tmp_path / "run.nc", **again)
    with gp.open_trajectory(whole) as data:
        last = float(data["time"][-1])
    assert seen[0][1] == pytest.approx(63 * 0.4) and seen[-1][1] == pytest.approx(last)
    assert all(time <= duration * (1.0 + 1e-12) for time, duration, _ in seen)
    assert examined[-1] == gp.reached_accuracy(whole)


WALLS = gas(3, 32, 0.1, boundary="wall")
STRESS = gp.Correlations(interval=0.1, lags=8, stress=True)


@pytest.mark.parametrize(
    ("asked", "more"),
    [
        (gp.Accuracy("D", 0.1), {"scene": gas(3, 64, 0.1)}),
        (gp.Accuracy("pressure", 0.1), {"scene": WALLS}),
        (gp.Accuracy("pressure", 0.1, face="y low"), {"scene": WALLS}),
        (gp.Accuracy("shear_viscosity", 0.2), {"correlations": STRESS, "pairs": True}),
        (gp.Accuracy("Z", 0.03, start=10.0), {}),
    ],
    ids=lambda value: value.name if isinstance(value, gp.Accuracy) else "",
)
def test_other_observables(tmp_path, asked, more):
    path = gp.run(**SETTINGS | more, until=asked, at_most=2000.0, path=tmp_path / "run.nc")
    (one,) = gp.reached_accuracy(path)
    assert one.met and one.accuracy <= asked.accuracy
    functions = {
        "D": "diffusion_coefficient",
        "pressure": "wall_pressure",
        "shear_viscosity": "shear_viscosity",
    }
    function = getattr(gp.analysis, functions.get(asked.observable, "compressibility_factor"))
    value = function(path, start=asked.start).estimate
    value = value.sel(face=one.component) if asked.observable == "pressure" else value
    assert one.value == pytest.approx(float(value), rel=0.01)
    assert asked.face in (None, one.component)


def test_until_d_is_accurate_paths_are_kept(tmp_path):
    """Particles may cross the container between frames."""
    asked = gp.Accuracy("D", 0.2)
    dilute = gp.Scene(gp.Container((20.0, 20.0, 20.0), "periodic"), [gp.Species(64, 0.5, temperature=1.0)])
    path = gp.run(dilute, gp.EventDriven(), 1, sample_interval=16.0, until=asked, path=tmp_path / "run.nc")
    assert gp.reached_accuracy(path)[0].met


@pytest.mark.thorough
def test_what_no_longer_run_can_measure_ends_it_with_one_line(tmp_path):
    """The thrust of particles at rest, which an obstacle may carry. What is measured later, as D from 48
    collisions on, is waited for."""
    path, asked = tmp_path / "run.nc", gp.Accuracy("pressure", 0.1, face="y low")
    scene = gp.Scene(
        gp.Container((4.0, 4.0), ("periodic", "wall")),
        particles=[gp.Particle((2.0, 0.5), (0.0, 0.0), radius=0.5)],
        walls=[gp.Wall((1.0, 2.0), (2.0, 2.0))],
        gravity=(0.0, -1.0),
        restitution=gp.Restitution(normal=0.5),
    )
    with pytest.raises(gp.SceneError, match="until = 'pressure:y low': particles at rest"):
        gp.run(scene, gp.EventDriven(), 1, sample_interval=0.1, until=asked, at_most=99.0, path=path)
    assert not path.exists() and partial_path(path).exists()


def test_the_default_interval_is_the_time_between_collisions(tmp_path):
    rate = float(gp.theory.collision_rate(**GAS.gas.parameters))
    path = gp.run(GAS, gp.EventDriven("direct"), 1, until=ASKED[0], at_most=3.0, path=tmp_path / "a.nc")
    assert read_recipe(path).sample_interval == pytest.approx(1.0 / rate, rel=0.05)
    engine = gp.TimeStepped(time_step=0.03)
    path = gp.run(GAS, engine, 1, until=ASKED[0], at_most=3.0, path=tmp_path / "b.nc")
    assert read_recipe(path).sample_interval == pytest.approx(0.03 * round(1.0 / rate / 0.03))


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"duration": 8.0}, "duration = 8.0: excludes until"),
        ({"until": ()}, r"until = \(\): must be a gaspart.Accuracy"),
        ({"until": (ASKED[0], ASKED[0])}, "until = 'Z': must be requested only once"),
        ({"at_most": 0.3}, "at_most = 0.3: must be at least the sample_interval, 0.4"),
        ({"at_most": -1.0}, "at_most = -1.0: must be positive"),
        ({"until": None, "at_most": 8.0}, "at_most = 8.0: needs until"),
        ({"until": None}, "duration = None: must be given, or until"),
        ({"until": None, "duration": 8.0, "sample_interval": None}, "sample_interval = None: must be given"),
        ({"path": None}, "path = None: must be given"),
        ({"follow": 8}, "until = 'Z': follow: needs all"),
        (
            {"scene": WALLS, "until": gp.Accuracy("pressure", 0.1, face="x_lo")},
            "until = 'pressure:x lo': must be one of the walls, x low, x high, y low",
        ),
        (
            {"until": gp.Accuracy("shear_viscosity", 0.1)},
            "until = 'shear_viscosity': correlations: needs correlations",
        ),
        (
            {"engine": gp.DSMC()},
            "until = 'Z': observable: is 1 of particles without extent, whatever happens",
        ),
        ({"scene": gas(3, 8, 0.1, fixed=True)}, "until = 'Z': species.fixed: carry a part of the pressure"),
        (
            {"scene": FROM_REST, "until": gp.Accuracy("collision_rate", 0.1), "sample_interval": None},
            "sample_interval = None: must be given: nothing moves at the start",
        ),
    ],
)
def test_what_cannot_be_reached_is_refused_before_anything_is_written(tmp_path, change, complaint):
    settings = {**SETTINGS, "until": ASKED, "path": tmp_path / "run.nc"} | change
    with pytest.raises(gp.SceneError, match=complaint):
        gp.run(**settings)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (("pressures", 0.1), "until.observable = 'pressures': unknown observable; did you mean pressure?"),
        (("Z", 0.0), "until.accuracy = 0.0: must be from 1e-08 to 1"),
        (("Z", 0.1, -1.0), "until.start = -1.0: must not be negative"),
        (("Z", 0.1, None, "x low"), "until.face = 'x low': has no meaning for Z"),
    ],
)
def test_accuracies_that_have_no_meaning(arguments, complaint):
    with pytest.raises(gp.SceneError, match=complaint):
        gp.Accuracy(*arguments)


def test_examinations_are_at_geometrically_spaced_numbers_of_frames():
    counts = [count for count, _ in zip(examined_frames(), range(7), strict=False)]
    assert counts == [64, 96, 128, 192, 256, 384, 512]
    assert [count for count in range(1000) if is_examined(count)] == [*counts, 768]
    assert [examined_before(count) for count in (10, 64, 65, 96, 500)] == [None, None, 64, 64, 384]


PERIODIC = gp.Container((8.0, 8.0, 8.0), boundary="periodic")
SIDE_BY_SIDE = gp.Scene(
    PERIODIC, [], [gp.Particle((1.0, y, 1.0), (1.0, 0.0, 0.0), 0.5) for y in (1.0, 4.0)]
)  # fmt: skip
ALONE = gp.Scene(PERIODIC, [gp.Species(1, 0.5, temperature=1.0)])


@pytest.mark.parametrize(
    ("scene", "name", "rule"),
    [
        (ALONE, "Z", "too few moving particles for a temperature"),
        (ALONE, "collision_rate", "a single particle meets no other"),
        (gp.Scene(PERIODIC, [gp.Species(60, 0.5)]), "Z", "nothing moves"),
        (gp.Scene(gp.Container((8.0, 8.0)), [gp.Species(9, 0.5)]), "pressure", "nothing moves"),
        (gp.Scene(PERIODIC, [gp.Species(60, 0.5, fixed=True)]), "collision_rate", "fixed particles do not"),
        (gp.Scene(PERIODIC, [gp.Species(8, 0.5, temperature=1.0)]), "D", "needs 16 moving particles"),
        (
            gp.Scene(PERIODIC, [gp.Species(60, 0.5, temperature=1.0)], restitution=gp.Restitution(0.8)),
            "collision_rate",
            "there is no steady state to measure; give a duration, or a longest one",
        ),
    ],
)
def test_what_never_becomes_known_is_refused_before_it_is_run(tmp_path, scene, name, rule):
    asked = gp.Accuracy(name, 0.1)
    with pytest.raises(gp.SceneError, match=f"until = '{name}': .*{rule}"):
        gp.run(scene, gp.EventDriven(), 1, sample_interval=1.0, until=asked, path=tmp_path / "run.nc")
    assert not list(tmp_path.iterdir())


def test_a_run_without_a_contact_is_given_up(tmp_path, monkeypatch):
    """Particles side by side, which a longest duration would end."""
    monkeypatch.setattr(reached, "IDLE", 128)
    path, asked = tmp_path / "run.nc", gp.Accuracy("collision_rate", 0.1)
    run = {"engine": gp.EventDriven(), "seed": 1, "until": asked, "sample_interval": 1.0}
    gp.run(SIDE_BY_SIDE, path=path, **run)
    with gp.open_trajectory(path) as data:
        assert data.sizes["frame"] == 128
    (one,) = gp.reached_accuracy(path)
    assert not one.met and "none happened" in one.rule
    assert accuracy_lines(path)[-1].startswith("the run was given up: nothing that could be measured")
    before = path.stat().st_mtime_ns
    gp.run(SIDE_BY_SIDE, path=path, **run)  # which is complete
    assert path.stat().st_mtime_ns == before
    gp.run(SIDE_BY_SIDE, path=tmp_path / "longer.nc", at_most=200.0, **run)
    with gp.open_trajectory(tmp_path / "longer.nc") as data:
        assert data.sizes["frame"] == 201


@pytest.mark.interpreted
def test_the_pressure_of_walls_that_nothing_hits_is_given_up(tmp_path, monkeypatch):
    monkeypatch.setattr(reached, "IDLE", 64)
    scene = gp.Scene(gp.Container((8.0, 8.0)), [], [gp.Particle((1.0, 1.0), (1.0, 0.0), 0.5)])
    run = {"engine": gp.EventDriven(), "seed": 1, "sample_interval": 20.0}
    gp.run(scene, path=tmp_path / "y.nc", until=gp.Accuracy("pressure", 0.1, face="y low"), **run)
    gp.run(scene, path=tmp_path / "x.nc", until=gp.Accuracy("pressure", 0.5, face="x low"), **run)
    ((y,), (x,)) = (gp.reached_accuracy(tmp_path / f"{axis}.nc") for axis in "yx")
    assert y.value == 0.0 and not y.met
    assert x.value == pytest.approx(1.0 / 7.0**2, rel=0.05) and x.met
    # All impulses follow from the momentum of the particle, so that their error is known soon.
    with gp.open_trajectory(tmp_path / "x.nc") as data:
        assert data.sizes["frame"] <= 129
