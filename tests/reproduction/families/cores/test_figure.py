import numpy as np
from reproduction.families.cores.data import OVERHEAD, SERIAL, measured
from reproduction.families.drawn import Points, draw, follows, lines, shows

from gaspart.reproduction.families.cores.figure import cores
from gaspart.reproduction.families.cores.model import SLABS, speed_up


def of(ds, *rows, x="run_count"):
    part = ds.isel(run=list(rows))
    return Points(part[x], part["run_speed"], part["run_speed_error"])


def test_speeds_are_drawn_against_particles_and_cores_with_the_model():
    ds = measured()
    dsmc, steps, events, wide = draw(cores, ds).axes
    shows(dsmc, of(ds, 2), of(ds, 0, 1))
    shows(steps, of(ds, 6))
    shows(events, of(ds, 3, 4))
    ways = (6, 7), (1, 8), (4, 5)
    shows(wide, *(of(ds, *rows, x="run_cores") for rows in ways))
    (model,) = [one for one in lines(dsmc) if len(one.get_xdata()) == 100 and np.ptp(one.get_xdata())]
    count = np.geomspace(SLABS["DSMC, Enskog"], 1e6, 100)
    follows(model, count, speed_up(2, count, SERIAL, OVERHEAD))
    ideal, within, beyond = lines(wide)
    assert np.max(within.get_xdata()) <= 2.0 <= np.min(beyond.get_xdata())
    assert (within.get_linestyle(), beyond.get_linestyle()) == ("-", ":")
    follows(ideal, ideal.get_xdata(), ideal.get_xdata())
    for one in (within, beyond):
        follows(one, one.get_xdata(), speed_up(one.get_xdata(), 1e5, SERIAL, OVERHEAD))


def test_what_a_machine_with_one_core_cannot_time_is_said():
    ds = measured(speed=[np.nan] * 9).assign_attrs(cores=1)
    assert all("not timed" in axis.texts[0].get_text() for axis in draw(cores, ds).axes[:3])
