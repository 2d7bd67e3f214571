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
    shows(
        times,
        Points(event["ratio"], rows, x_error=event["ratio_error"]),
        Points(step["ratio"], others, x_error=step["ratio_error"]),
    )
    counted = (event["pair_tests"], rows), (event["crossings"], rows), (step["pair_tests"], others)
    shows(work, *(Points(*one) for one in counted))
    assert [label.get_text() for label in times.get_yticklabels()] == ["plain", "walls", "gravity"]
    assert times.get_yticks().tolist() == [0, -1, -2]
