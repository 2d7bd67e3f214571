"""Correlations accumulated during a run: all pairs of samples, whatever the frames, and however it is cut."""

from types import SimpleNamespace

import numpy as np
import pytest
from scenes import centred, gas

import gaspart as gp
from gaspart.analysis.motion import average_correlations, correlate
from gaspart.trajectory.correlator import SUMS, Correlations, Correlator
from gaspart.trajectory.opening import partial_path
from gaspart.trajectory.recipe import read_recipe

ASKED = gp.Correlations(interval=0.25, lags=6, start=2.0)


def settings(**change):
    """A run of 10 discs with 4 samples in an interval of frames."""
    own = {"seed": 1, "duration": 6.0, "sample_interval": 1.0, "displacements": True, "correlations": ASKED}
    return {"scene": gas(2, 10, 0.1), "engine": gp.EventDriven(), **own, **change}


@pytest.mark.parametrize("displacements", [False, True])
@pytest.mark.parametrize("fixed", [False, True])
@pytest.mark.parametrize("alike", [False, True])
@pytest.mark.parametrize("boundary", ["periodic", ("periodic", "wall")], ids=["periodic", "walls"])
def test_sums_are_those_of_all_pairs_of_samples(boundary, alike, fixed, displacements):
    """By their definition, with more samples than lags: mean squares about the centre of mass are (1 - 1 / N)
    times those of free particles, whatever their masses and the axes along which momentum is conserved."""
    rng, samples, lags = np.random.default_rng(1), 9, 3
    discs = [gp.Species(4, 0.5, temperature=1.0), gp.Species(1, 0.5, fixed=fixed)]
    scene = gp.Scene(gp.Container((9.0, 9.0), boundary), discs)
    masses = np.ones(5) if alike else np.arange(1.0, 6.0)
    masses[4] = np.inf if fixed else masses[4]
    v, r = rng.normal(size=(2, samples, 5, 2))
    correlator = Correlator(Correlations(1.0, lags), scene, masses, displacements)
    for velocities, unwrapped in zip(v, r, strict=True):
        correlator.add(SimpleNamespace(state=SimpleNamespace(velocities=velocities, unwrapped=unwrapped)))
    found = correlator.sums()
    assert found.pop("correlated_samples") == samples == correlator.next
    if fixed:  # momentum is not conserved, and the fixed particle does not count
        v, r = v[:, :4], r[:, :4]
    else:
        part = masses / masses.sum()
        for values in (v, r):
            values[...] -= np.where(scene.conserved_axes, np.einsum("n,tnk->tk", part, values), 0.0)[:, None]
            free = np.where(scene.conserved_axes, 1.0 / np.sqrt(1.0 - part)[:, None], 1.0)
            values *= free * np.sqrt(1.0 - 1.0 / len(masses))
    for lag in range(lags + 1):
        late, early, moved = v[lag:], v[: samples - lag], r[lag:] - r[: samples - lag]
        expected = (late * early, moved**2, moved * (late + early))
        for name, terms in zip(SUMS, expected, strict=True):
            if displacements or name == "velocity_product_sum":
                assert found[name][lag] == pytest.approx(terms.sum() / v.shape[1], rel=1e-12, abs=1e-12)
    assert len(found) == (3 if displacements else 1)


@pytest.mark.interpreted
@pytest.mark.parametrize("engine", [gp.EventDriven(), gp.TimeStepped(time_step=0.05)], ids=lambda e: e.name)
def test_a_run_accumulates_what_its_frames_give(tmp_path, engine):
    """To the rounding of the frames' velocities, which are float32."""
    path = gp.run(**settings(engine=engine, sample_interval=0.25), path=tmp_path / "run.nc")
    with gp.open_trajectory(path) as data:
        found = average_correlations(data)
        moved, velocities = (
            centred(data[name].values[8:].astype(float)) for name in ("displacements", "velocities")
        )
        assert data["correlated_samples"].values[[0, 7, 8, 24]].tolist() == [0.0, 0.0, 1.0, 17.0]
        assert data["lag"].values.tolist() == [0.25 * n for n in range(7)]
    expected = correlate(moved, velocities, 0.25, 7)
    assert found.msd == pytest.approx(expected.msd, rel=1e-12, abs=1e-12)
    assert found.correlation == pytest.approx(expected.correlation, rel=1e-6, abs=1e-6)
    assert found.running == pytest.approx(expected.running, rel=1e-6, abs=1e-6)


@pytest.mark.interpreted
def test_frames_and_displacements_change_no_bit(tmp_path):
    files = [gp.run(**settings(), path=tmp_path / "a.nc")]
    files.append(gp.run(**settings(sample_interval=6.0), path=tmp_path / "b.nc"))
    files.append(gp.run(**settings(displacements=False, follow=1), path=tmp_path / "c.nc"))
    files.append(gp.run(**settings(correlations=None), path=tmp_path / "d.nc"))
    last = []
    for path in files:
        with gp.open_trajectory(path) as data:
            last.append(data.isel(frame=-1).load())
    for name in (*SUMS, "correlated_samples"):
        assert np.array_equal(last[0][name], last[1][name])
        assert name not in last[3]
    assert np.array_equal(last[0]["velocity_product_sum"], last[2]["velocity_product_sum"])
    assert "squared_displacement_sum" not in last[2]
    assert np.isnan(average_correlations(last[2].expand_dims("frame")).msd).all()
    for name in ("coordinates", "velocities", "displacements", "collisions"):
        assert np.array_equal(last[0][name], last[1][name])
        assert np.array_equal(last[0][name], last[3][name])


@pytest.mark.interpreted
@pytest.mark.parametrize("samples", [0, 3, 13])
def test_a_run_that_was_cut_short_continues_to_the_same_bytes(tmp_path, monkeypatch, samples):
    """Before the first sample, while the lags fill, and after; within an interval of frames."""
    whole = gp.run(**settings(), path=tmp_path / "whole.nc").read_bytes()
    path, add = tmp_path / "run.nc", Correlator.add

    def cut(self, state):
        if self.next == ASKED.first + samples:
            raise KeyboardInterrupt
        add(self, state)

    monkeypatch.setattr(Correlator, "add", cut)
    with pytest.raises(KeyboardInterrupt):
        gp.run(**settings(), path=path, checkpoint_seconds=0.0)
    monkeypatch.undo()
    assert read_recipe(partial_path(path)).correlations == ASKED
    assert gp.resume(path).read_bytes() == whole


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"interval": 0.0}, "correlations.interval = 0.0: must be positive"),
        ({"lags": 0}, "correlations.lags = 0: must be a whole number"),
        ({"start": -1.0}, "correlations.start = -1.0: must not be negative"),
        ({"start": 0.3}, "correlations.start = 0.3: must be a whole multiple of correlations.interval, 0.25"),
        ({"interval": 0.3}, "sample_interval = 1.0: must be a whole multiple of correlations.interval, 0.3"),
        (
            {"lags": 17},
            "correlations.lags = 17: must be at most 16, the number of intervals of 0.25 from 2 on",
        ),
        ({"start": 9.0}, "correlations.lags = 6: must be at most 0, the number of intervals"),
    ],
)
def test_impossible_correlations_are_refused(tmp_path, change, complaint):
    asked = {"interval": 0.25, "lags": 6, "start": 2.0 if "interval" not in change else 0.0} | change
    with pytest.raises(gp.SceneError, match=complaint):
        gp.run(**settings(correlations=gp.Correlations(**asked)), path=tmp_path / "run.nc")
    assert list(tmp_path.iterdir()) == []


def test_samples_are_whole_time_steps_and_some_particle_moves(tmp_path):
    with pytest.raises(gp.SceneError, match="correlations.interval = 0.25: must be a whole multiple of time"):
        gp.run(**settings(engine=gp.TimeStepped(time_step=0.2)), path=tmp_path / "run.nc")
    still = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(3, 0.5, fixed=True)])
    with pytest.raises(gp.SceneError, match="no particle moves"):
        Correlator(ASKED, still, np.full(3, np.inf), displacements=False)
