"""Replicas: their mean is that of what each gives, in any order; a run counts once, however it is named."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from battery.kinds_of_runs import FRAMES, SEED, recorded, start_of
from battery.observed import form_of, outcome

import gaspart as gp
from gaspart.analysis.observables import OBSERVABLES
from gaspart.errors import SceneError

KINDS = ("periodic", "walls", "mixture")
LAST = (2, (0, 1))
"""The axis of profiles by default; that of fields is not asked for."""


@cache
def second(name):
    """Form -> the run of another seed."""
    start = start_of("event", name, SEED + 1)
    return {form: start.record(form, FRAMES) for form in start.forms}


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize("observable", [name for name in OBSERVABLES if name not in ("chemical_potential",)])
def test_replicas_have_the_mean_of_each(observable, name):
    form = form_of(observable)
    if form not in recorded("event", name):
        with pytest.raises(SceneError):
            gp.analysis.replicas(
                observable, [data["frames"] for data in (recorded("event", name), second(name))]
            )
        return
    runs = [data[form] for data in (recorded("event", name), second(name))]
    try:
        found = gp.analysis.replicas(observable, runs)
    except SceneError:  # as one of them alone, or curves at places that follow from the run
        each = [outcome(observable, run, LAST) for run in runs]
        assert any(isinstance(one, SceneError) for one in each) or observable in (
            "speeds",
            "structure_factor",
            "partial_structure_factors",
        )
        return
    key = found.attrs["quantity"]
    one, other = (gp.analysis.replicas(observable, runs[::step]) for step in (1, -1))
    assert np.array_equal(one[key], other[key], equal_nan=True)
    assert np.allclose(one[f"{key}_error"], other[f"{key}_error"], rtol=1e-12, equal_nan=True)
    each = one[f"{key}_replicas"].values
    assert np.allclose(one[key], each.mean(axis=0), rtol=1e-12, equal_nan=True)
    half = 0.5 * np.abs(each[0] - each[1])
    errors, scatters = one[f"{key}_error"].values, np.broadcast_to(half > 0.0, half.shape)
    smallest = 1e-12 * np.nanmax(np.abs(each))
    assert np.allclose(errors[scatters], half[scatters], rtol=1e-9, atol=smallest)
    assert np.all(~(errors[~scatters] > smallest))  # unknown where all runs are empty


def test_a_run_is_no_replica_of_itself():
    run = recorded("event", "periodic")["frames"]
    for twice in (run, run.assign_attrs(seed="17")):
        with pytest.raises(SceneError):
            gp.analysis.replicas("Z", [run, twice])


def test_runs_of_one_seed_from_two_states_are_replicas():
    start = start_of("event", "periodic")
    other = gp.Simulation(start.scene, start.engine, SEED + 1).initial_state
    runs = [
        start.record("frames", FRAMES),
        replace(start, initial=other).record("frames", FRAMES),
    ]
    assert float(gp.analysis.replicas("Z", runs).error) > 0.0
