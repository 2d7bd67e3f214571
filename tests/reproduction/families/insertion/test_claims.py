import numpy as np
import pytest
import xarray as xr
from reproduction.claims.data import judged

from gaspart import theory
from gaspart.reproduction.families.insertion.claims import fill_failures


def dataset(**changes):
    """Four containers, as a long run would measure them."""
    side = np.array([5.65, 14.0, 100.0, 50.0])
    rule = ["centres_to_walls", "periodic", "periodic", "periodic"]
    ends = [
        theory.insertion_saturation(3, 5.65, rule[0]),
        theory.RSA_SATURATION[3],
        theory.RSA_SATURATION[2],
        np.nan,
    ]
    columns = {
        "dimension": np.array([3, 3, 2, 3]),
        "side_over_diameter": side,
        "rule": np.array(rule),
        "final_spread": np.array([0.011, 0.002, 0.001, 0.0]),
        "approach": np.array([np.nan, 0.34, 0.49, np.nan]),
        "approach_error": np.array([np.nan, 0.01, 0.02, np.nan]),
        "dilute_failures": np.array([np.nan, 1.0, 1.0, 1.004]),
        "dilute_failures_error": np.array([np.nan, 0.05, 0.05, 0.006]),
        "saturation": np.array(ends),
        "saturation_error": np.array([0.0025, 0.0008, 0.0005, np.nan]),
    } | changes  # fmt: skip
    made = {
        name: (("container", "window"), values[:, None])
        if name.startswith("saturation")
        else ("container", values)
        for name, values in columns.items()
    }
    return xr.Dataset(made, attrs={"dilute_up_to": 0.04})


def verdicts(found):
    return judged(fill_failures(found))


def test_right_data_agree():
    found = verdicts(dataset())
    assert len(found) == 7
    assert sorted(found.values()) == ["agrees"] * 5 + ["no verdict", "reproduced"]


@pytest.mark.parametrize(
    ("changes", "start"),
    [
        ({"saturation": np.array([0.53, 0.390, 0.547, np.nan])}, "saturation of random insertion, spheres p"),
        ({"saturation": np.array([0.53, 0.3841, 0.544, np.nan])}, "saturation of random insertion, d"),
        ({"saturation": np.array([0.46, 0.3841, 0.547, np.nan])}, "packing fraction at which insertion ends"),
        ({"approach": np.array([np.nan, 0.5, 0.49, np.nan])}, "exponent p"),
        ({"dilute_failures": np.array([np.nan, 1.0, 1.0, 0.95])}, "failed attempts up to"),
    ],
)  # fmt: skip
def test_wrong_data_disagree(changes, start):
    found = verdicts(dataset(**changes))
    assert {"disagrees", "source in error"} & {
        verdict for text, verdict in found.items() if text.startswith(start)
    }
