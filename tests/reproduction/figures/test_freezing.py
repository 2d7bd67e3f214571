"""Small runs of discs and spheres that stay crystals or melt, and what a drift adds to an uncertainty."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from reproduction.made import simulated

from gaspart.analysis.estimate import Estimate
from gaspart.reproduction.figures import freezing_discs, freezing_spheres
from gaspart.reproduction.figures._freezing import EQUILIBRIUM_LIMIT, disagreement, mean_and_drift, with_drift
from gaspart.reproduction.points.points import points
from gaspart.reproduction.table import entries

DISC_POINT = {
    "dimension": 2, "count": 64, "side": [8, 8 * 0.8660254037844386], "boundary": "periodic",
    "temperature": 1.0, "arrangement": "lattice", "duration": 8, "equilibration": 2, "samples": 32,
}  # fmt: skip
SPHERE_POINT = {
    "dimension": 3, "radius": 0.5, "boundary": "periodic", "temperature": 1.0, "arrangement": "lattice",
    "count": 108, "duration": 8, "equilibration": 4, "samples": 16,
}  # fmt: skip
EDGE = (4.0 / 1.0375) ** (1.0 / 3.0)
SLAB = {"count": 305, "side": [4 * EDGE, 4 * EDGE, 5 * EDGE], "arrangement": "slab"}


def made_of(folder, experiments):
    """The points of made-up experiments, run."""
    configs = {
        name: {"seed": 1, "points": str(folder), "experiments": {name: {"point": point, "grid": grid}}}
        for name, (point, grid) in experiments.items()
    }
    return [simulated(one) for name, config in configs.items() for one in points(config, name)]


def test_discs_melt_and_stay(tmp_path):
    points = made_of(tmp_path, {"discs": (DISC_POINT, {"packing_fraction": [0.74, 0.5]})})
    settings = {"shown": [0.5, 0.74], "furthest": 3, "bins": 30, "highest": 8}
    dataset = freezing_discs.measure(points, settings)
    assert dataset["start"].values.tolist() == ["crystal"]
    assert dataset["packing_fraction"].values == pytest.approx([0.5, 0.74])
    low, high = dataset["order"].values[0]
    assert low < 0.4 and high > 0.7
    assert dataset["density"].values == pytest.approx(np.array([0.5, 0.74]) * 4.0 / np.pi)
    z = (dataset["pressure"] / dataset["density"]).values[0]
    assert z == pytest.approx([4.2, 11.1], rel=0.06)  # Santos and others; Alder, Hoover and Young
    assert np.isnan(dataset["plateau"]).all()  # two points have no loop
    assert dataset["structure_factor"].dims == ("shown", "mode_x", "mode_y")
    bragg = dataset["structure_factor"].max(("mode_x", "mode_y")).values
    assert bragg[1] > 4.0 * bragg[0]


def test_spheres_keep_to_their_branches(tmp_path):
    slab = {**SPHERE_POINT, **SLAB}
    points = made_of(tmp_path, {"bulk": (SPHERE_POINT, {"packing_fraction": [0.4, 0.6]}), "slab": (slab, {})})
    dataset = freezing_spheres.measure(points, {})
    assert dataset["crystalline"].values.tolist() == [[0, 1]]
    assert (dataset["Z"] / dataset["reference"]).values[0] == pytest.approx(1.0, abs=0.02)
    assert dataset["finite_size"].values[0, 1] == pytest.approx(-(15.4 - 1.0) / 108, rel=0.05)
    assert float(dataset["slab_pressure"]) == pytest.approx(11.5, abs=1.0)
    assert dataset["slab_density"].mean() == pytest.approx(305 / (80 * EDGE**3), rel=1e-6)


def test_a_run_that_creeps_is_less_certain():
    noise = np.random.default_rng(1).standard_normal(1000)
    mean, drift = mean_and_drift([noise, noise[::-1]])
    assert drift.value == pytest.approx(0.0, abs=1e-12) and drift.error == pytest.approx(2.0 * mean.error)
    assert with_drift(mean, drift) == mean
    mean, drift = mean_and_drift([noise + np.linspace(0.0, 4.0, 1000)])
    assert drift.value == pytest.approx(2.0, abs=0.2)
    creeping = with_drift(Estimate(10.0, 0.1, 9.0), Estimate(0.8, 0.2))
    assert creeping == Estimate(10.0, np.hypot(0.1, 0.4), 9.0)


def test_an_uncertainty_from_a_short_run_has_few_degrees_of_freedom():
    """Four errors between two starts of a run as short as its memory are no disagreement."""
    walk = np.cumsum(np.random.default_rng(2).standard_normal(32)) / 8.0
    mean, drift = mean_and_drift([walk])
    assert mean.freedom < 6.0 and drift.freedom == mean.freedom

    def worst(freedom):
        row = entries({"pressure": Estimate([9.0, 9.4], 0.07, freedom)})
        row |= {f"{name}{part}": np.zeros(2) for name in ("order",) for part in ("", "_drift")}
        row["pressure_drift"] = np.zeros(2)
        row |= {f"{name}_error": np.ones(2) for name in ("order", "order_drift", "pressure_drift")}
        columns = {name: (("start", "packing_fraction"), values[:, None]) for name, values in row.items()}
        return disagreement(xr.Dataset(columns))

    assert worst(np.inf) == pytest.approx([0.4 / (0.07 * np.sqrt(2.0))])
    assert worst(2.0) < EQUILIBRIUM_LIMIT
