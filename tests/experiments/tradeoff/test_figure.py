import numpy as np
import pytest
from experiments.drawn import Points, draw, follows, lines, shows, varied
from experiments.tradeoff.data import SECONDS, speed_accuracy_measurement, time_to_accuracy_measurement

from gaspart.experiments.tradeoff import figure as tradeoff


def errors(row, observable, label):
    """Errors of one setting that exceed two standard errors, and the bounds of the others."""
    at = row.sel(observable=observable)
    size, error = 100.0 * np.abs(at["bias"].values), 100.0 * at["bias_error"].values
    seen = size > 2.0 * error
    unseen = ~seen & np.isfinite(size)
    time_step = row["time_step"].values
    return [
        Points(label, time_step[seen], size[seen], error[seen]),
        Points(None, time_step[unseen], 2.0 * error[unseen]),
    ]


def test_errors_are_drawn_against_the_step_and_costs_against_errors(tmp_path):
    ds = varied(speed_accuracy_measurement(tmp_path), "packing_fraction", "event_seconds")
    rate, z, cost = draw(tradeoff.speed_accuracy, ds, tmp_path).axes
    rows = {row["setting"].item(): row for row in (ds.isel(row=n) for n in range(ds.sizes["row"]))}
    order = [name for name in tradeoff.SETTINGS if name in rows]
    assert len(order) == 2
    for axis, observable, label in ((rate, "collision_rate", "collision rate"), (z, "Z", "$Z$")):
        series = [one for name in order for one in errors(rows[name], observable, name)]
        shows(axis, "time step" if axis is z else "", label, *series)
    costs = []
    for row in (ds.isel(row=n) for n in range(ds.sizes["row"])):
        at = row.sel(observable="Z")
        error = 100.0 * np.maximum(np.abs(at["bias"]), 2.0 * at["bias_error"]).values
        timed = np.isfinite(row["seconds"].values) & np.isfinite(error)
        seconds, bars = (1e6 * row[name].values[timed] for name in ("seconds", "seconds_error"))
        costs.append(Points(None, error[timed], seconds, bars))
    shows(cost, "error of $Z$", "time per collision", *costs)
    assert cost.lines[-1].get_ydata() == pytest.approx(1e6 * SECONDS)


def test_costs_are_drawn_against_the_accuracy_for_each_gas(tmp_path):
    ds = varied(time_to_accuracy_measurement(), "gas_packing_fraction")
    axes = np.reshape(draw(tradeoff.time_to_accuracy, ds, tmp_path).axes, (3, 2))
    assert [axis.get_title() for axis in axes[0]] == [r"spheres, $\eta = 0.05$", r"spheres, $\eta = 0.2$"]
    percent = 100.0 * ds["accuracy"]
    names = {"event": "event-driven", "step": "time-stepped"}
    for g, column in enumerate(axes.T):
        gas = ds.isel(gas=g)
        for axis, observable in zip(column, ("Z", "D"), strict=False):
            each = [
                (f"{name}, $N = {count}$", gas.sel(observable=observable, engine=engine, count=count))
                for engine, name in names.items()
                for count in (1000, 10000)
            ]
            y_label = "" if g else f"time for ${observable}$"
            shows(axis, "", y_label, *(Points(label, percent, at["measured"]) for label, at in each))
            for one, (_, at) in zip(lines(axis), each, strict=True):
                follows(one, percent, at["model"])
        regrets = [
            gas.sel(observable=observable, count=count) for observable in "ZD" for count in (1000, 10000)
        ]
        shows(
            column[2], "accuracy", "" if g else "choice / best",
            *(Points(None, percent, at["regret"], at["regret_error"]) for at in regrets),
        )  # fmt: skip
