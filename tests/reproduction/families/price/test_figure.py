import numpy as np
import xarray as xr
from reproduction.families.drawn import Points, draw, shows, varied

from gaspart.reproduction.families.price.figure import price_of_features


def test_times_and_counted_work_are_drawn_for_each_feature():
    ones = np.ones(4)
    columns = dict.fromkeys(("seconds", "ratio", "ratio_error", "pair_tests", "crossings"), ("point", ones))
    ds = varied(xr.Dataset({**columns}))
    ds["engine"] = ("point", ["event", "event", "event", "step"])
    ds["feature"] = ("point", ["plain", "walls", "gravity", "plain"])
    ds["crossings"] = ds["crossings"] * (ds["engine"] == "event")
    times, work = draw(price_of_features, ds).axes
    event, step = ds.isel(point=[0, 1, 2]), ds.isel(point=[3])
    rows, others = np.array([0.0, -1.0, -2.0]) + 0.06, np.array([-0.06])
    labels = [f"{float(one['seconds'][0]) * 1e6:.3g}" for one in (event, step)]
    shows(
        times, "time per event", "",
        Points(f"event: plain {labels[0]}", event["ratio"], rows, x_error=event["ratio_error"]),
        Points(f"step: plain {labels[1]}", step["ratio"], others, x_error=step["ratio_error"]),
    )  # fmt: skip
    shows(
        work, "counted work", "", Points("event: pair tests", event["pair_tests"], rows),
        Points("event: crossings", event["crossings"], rows),
        Points("step: pair tests", step["pair_tests"], others),
    )  # fmt: skip
    assert [label.get_text() for label in times.get_yticklabels()] == ["plain", "walls", "gravity"]
    assert times.get_yticks().tolist() == [0, -1, -2]
