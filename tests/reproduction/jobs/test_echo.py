"""There and back."""

import numpy as np
import pytest
import xarray as xr

from gaspart.engines import EventDriven, TimeStepped
from gaspart.reproduction.jobs.echo import DISPLACEMENT, echo
from gaspart.scene.scene import Container, Scene, Species

GAS = Scene(Container((8.0,) * 3), species=(Species(40, 0.5, temperature=1.0),))


@pytest.mark.parametrize("engine", [EventDriven(), TimeStepped(0.01)], ids=["event", "step"])
def test_a_short_way_leads_back_to_the_start_and_a_long_one_does_not(engine):
    run = xr.Dataset(*echo(GAS, engine, [(1,), (2,)], 1.0, 10.0, 5))
    assert (run.echo[:, -1] > 0.1).all()
    assert np.isfinite(run.exponent).all() == (engine.name == "event")
    short = xr.Dataset(*echo(GAS, engine, [(1,), (2,)], 1.0, 0.5, 2))
    assert (short.echo < 1e-11).all()
    assert (np.diff(short.collisions, axis=1) > 0.0).all()
    assert (short.divergence > 0.5 * DISPLACEMENT).all() and (short.divergence < 1e-6).all()


def test_the_exponent_is_the_growth_of_neighbouring_runs():
    """Of spheres at 0.04, over distances from 1e-9 to 1e-2 diameters, which is some 6 collisions of each."""
    run = xr.Dataset(*echo(GAS, EventDriven(), [(n,) for n in range(8)], 1.0, 0.7, 24))
    grown = []
    for s, apart in zip(run.collisions.values, run.divergence.values, strict=True):
        inside = (apart > 1e-9) & (apart < 1e-2)
        grown.append(np.polyfit(s[inside], np.log(apart[inside]), 1)[0])
    error = np.hypot(np.std(grown, ddof=1), np.std(run.exponent, ddof=1)) / np.sqrt(8)
    assert error < 0.1 * run.exponent.mean()
    assert np.mean(grown) == pytest.approx(float(run.exponent.mean()), abs=3.5 * float(error))
