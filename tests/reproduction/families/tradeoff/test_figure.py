import numpy as np
from reproduction.families.drawn import Points, draw, follows, lines, shows, varied
from reproduction.families.tradeoff.data import (
    SECONDS,
    speed_accuracy_measurement,
    time_to_accuracy_measurement,
)

from gaspart.reproduction.families.tradeoff import figure as tradeoff


def errors(row, observable):
    """Errors of one setting that exceed two standard errors, and the bounds of the others."""
    at = row.sel(observable=observable)
    size, error = 100.0 * np.abs(at["bias"].values), 100.0 * at["bias_error"].values
    seen = size > 2.0 * error
    unseen = ~seen & np.isfinite(size)
    time_step = row["time_step"].values
    return [
        Points(None, time_step[seen], size[seen], error[seen]),
        Points(None, time_step[unseen], 2.0 * error[unseen]),
    ]


def test_errors_are_drawn_against_the_step_and_costs_against_errors(tmp_path):
    ds = varied(speed_accuracy_measurement(tmp_path), "packing_fraction", "event_seconds")
    *panels, cost = draw(tradeoff.speed_accuracy, ds).axes
    rows = {row["setting"].item(): row for row in (ds.isel(row=n) for n in range(ds.sizes["row"]))}
    assert set(rows) == set(tradeoff.SHOWN)
    for axis, (observable, label) in zip(
        panels, {"collision_rate": "collision rate", "Z": "$Z$", "D": "$D$"}.items(), strict=True
    ):
        series = [one for name in tradeoff.SHOWN for one in errors(rows[name], observable)]
        shows(axis, "time step", label, *series)
    row = rows["4 passes"]
    at = row.sel(observable="Z")
    error = 100.0 * np.maximum(np.abs(at["bias"]), 2.0 * at["bias_error"]).values
    timed = np.isfinite(row["seconds"].values) & np.isfinite(error)
    seconds, bars = (1e6 * row[name].values[timed] for name in ("seconds", "seconds_error"))
    shows(cost, "error of $Z$", "time per collision", Points("0.01", error[timed], seconds, bars))
    assert [1e6 * SECONDS] * 2 in [list(one.get_ydata()) for one in cost.lines]


def test_costs_are_drawn_against_the_accuracy_for_each_gas():
    ds = varied(time_to_accuracy_measurement(), "gas_packing_fraction")
    axes = np.reshape(draw(tradeoff.time_to_accuracy, ds).axes, (2, 2))
    titles = [axis.get_title(loc="left") for axis in axes[:, 0]]
    assert titles == [r"(a) spheres, $\eta = 0.05$", r"(b) spheres, $\eta = 0.2$"]
    percent = 100.0 * ds["accuracy"]
    names = {"event": "event-driven", "step": "time-stepped"}
    for g, column in enumerate(axes):
        gas = ds.isel(gas=g)
        for axis, observable in zip(column, ("Z", "D"), strict=True):
            each = [
                (f"{name}, $N = {count}$", gas.sel(observable=observable, engine=engine, count=count))
                for engine, name in names.items()
                for count in (1000, 10000)
            ]
            x_label = "accuracy" if observable == "D" else ""
            series = (Points(label, percent, at["measured"]) for label, at in each)
            shows(axis, x_label, f"time for ${observable}$", *series)
            for one, (_, at) in zip(lines(axis), each, strict=True):
                follows(one, percent, at["model"])
