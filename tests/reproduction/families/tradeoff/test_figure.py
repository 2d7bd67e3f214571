import numpy as np
import pytest
from reproduction.families.drawn import Points, draw, shows, varied
from reproduction.families.tradeoff.data import speed_accuracy_measurement, time_to_accuracy_measurement

from gaspart.reproduction.families.tradeoff import figure
from gaspart.reproduction.families.tradeoff import figure as tradeoff


def errors(row, observable):
    """Errors of one setting that exceed two standard errors, and the bounds of the others."""
    at = row.sel(observable=observable)
    size, error = 100.0 * np.abs(at["bias"].values), 100.0 * at["bias_error"].values
    seen = size > 2.0 * error
    unseen = ~seen & np.isfinite(size)
    time_step = row["time_step"].values
    return [Points(time_step[seen], size[seen], error[seen]), Points(time_step[unseen], 2.0 * error[unseen])]


def test_errors_are_drawn_against_the_step_and_costs_against_errors(tmp_path):
    ds = varied(
        speed_accuracy_measurement(tmp_path), "packing_fraction", "event_seconds", "dsmc_packing_fraction"
    )
    *steps, cost = draw(tradeoff.speed_accuracy, ds).axes
    rows = {row["setting"].item(): row for row in (ds.isel(row=n) for n in range(ds.sizes["row"]))}
    assert set(rows) == set(tradeoff.SHOWN)
    for axis, observable in zip(steps, ("collision_rate", "Z", "D"), strict=True):
        shows(axis, *(one for name in tradeoff.SHOWN for one in errors(rows[name], observable)))
    row = rows["4 passes"]
    at = row.sel(observable="Z")
    error = 100.0 * np.maximum(np.abs(at["bias"]), 2.0 * at["bias_error"]).values
    timed = np.isfinite(row["seconds"].values) & np.isfinite(error)
    seconds, bars = (1e6 * row[name].values[timed] for name in ("seconds", "seconds_error"))
    models = [Points(error[timed], seconds, bars)]
    for one in (ds.isel(dsmc=[n]) for n in np.flatnonzero(ds["dsmc_dimension"] == 3)):
        models.append(Points(100.0 * one.dsmc_bias, 1e6 * one.dsmc_seconds, 1e6 * one.dsmc_seconds_error))
    shows(cost, *models)


def test_the_map_has_the_cheapest_engine_of_each_field():
    ds = time_to_accuracy_measurement().sortby("accuracy", ascending=False)
    *fields, _ = draw(tradeoff.time_to_accuracy, ds).axes
    for axis, quantity in zip(fields, figure.TITLES, strict=True):
        at = ds.sel(quantity=quantity)
        colours = axis.collections[0].get_array()
        texts = iter(axis.texts)
        for f, _ in enumerate(ds.fraction):
            for a, _ in enumerate(ds.accuracy):
                costs = at.cost.isel(fraction=f, accuracy=a)
                best = costs.solver.values[int(np.argmin(costs.values))]
                assert tuple(colours[a, f]) == pytest.approx(figure.tint(best))
                assert next(texts).get_text() == figure.duration(float(costs.min()))


def test_bars_are_the_parts_of_the_error():
    ds = time_to_accuracy_measurement()
    errors = draw(tradeoff.time_to_accuracy, ds).axes[-1]
    at = ds.error.sel(quantity="D", fraction=0.01, accuracy=0.01, solver="enskog").values / 0.01
    rows = [bar for bar in errors.patches if bar.get_y() == pytest.approx(-4.4)]
    assert [bar.get_width() for bar in rows] == pytest.approx(list(at))


def test_of_a_small_run_the_nearest_places_are_shown():
    ds = time_to_accuracy_measurement().isel(fraction=[1, 4])
    ds["cost"] = ds.cost.where((ds.fraction != 0.3) | (ds.quantity != "D"))
    (at,) = figure.places(ds)
    assert (at.quantity, at.fraction, at.accuracy) == ("D", 0.001, 0.01)
    assert len(draw(tradeoff.time_to_accuracy, ds).axes[-1].patches) > 0


def test_a_gas_in_which_no_engine_is_accurate_enough_is_left_white():
    ds = time_to_accuracy_measurement()
    ds["cost"] = ds.cost.where(ds.fraction != 0.1, np.inf)
    assert {engine for f, _, engine, _ in figure.cheapest_engine(ds.sel(quantity="Z")) if f == 3} == {""}
    assert "–" in [text.get_text() for text in draw(tradeoff.time_to_accuracy, ds).axes[1].texts]


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(4e-4, "0.4 ms"), (0.0123, "12 ms"), (0.553, "550 ms"), (3.2, "3 s"), (59.0, "59 s"), (150.0, "2 min"),
     (4000.0, "1 h"), (2e5, "2 d"), (4e8, "13 y")],
)  # fmt: skip
def test_durations(seconds, text):
    assert figure.duration(seconds) == text
