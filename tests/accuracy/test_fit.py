"""The model's table from measurements whose answers are known."""

import csv
import io

import numpy as np
import pytest
import xarray as xr

from gaspart.accuracy import fit, table


@pytest.fixture
def folder(tmp_path):
    """What the workflow measured: one gas of spheres, its time steps, and the noise of its observables."""
    both = ("row", "step")
    accuracy = xr.Dataset(
        {
            "dimension": ("row", [3, 3]),
            "packing_fraction": ("row", [0.1, 0.1]),
            "setting": ("row", ["4 passes", "1 pass"]),  # of which the second is none to advise
            "timed_dimension": ("timed", [3, 3]),
            "timed_packing_fraction": ("timed", [0.1, 0.45]),
            "timed_seconds": ("timed", [4e-7, 3e-7]),
            "timed_error": ("timed", [1e-8, 1e-8]),
            "dsmc_model": ("dsmc", ["boltzmann", "enskog", "boltzmann"]),
            "dsmc_dimension": ("dsmc", [3, 3, 2]),
            "dsmc_packing_fraction": ("dsmc", [0.01, 0.01, 0.01]),
            "dsmc_step": (("dsmc", "part"), [[4.0, 1.0, 0.5]] * 3),
            "dsmc_step_seconds": (
                ("dsmc", "part"),
                [[2e-7, 3e-7, 4e-7], [8e-7, 9e-7, 1e-6], [1e-7, 2e-7, 3e-7]],
            ),
            "dsmc_step_seconds_error": (("dsmc", "part"), [[1e-8] * 3] * 3),
            "time_step": (both, [[0.01, 0.02, np.nan]] * 2),
            "seconds": (both, [[8e-6, 4e-6, np.nan]] * 2),
            "seconds_error": (both, [[1e-7, 1e-7, np.nan]] * 2),
            "bias": (("row", "observable", "step"), np.full((2, 2, 3), 0.003)),
            "bias_error": (("row", "observable", "step"), np.full((2, 2, 3), 0.001)),
        },
        coords={"observable": ["Z", "collision_rate"]},
    )
    accuracy["bias"][0, 1, 1] = np.nan  # not measured
    accuracy.to_netcdf(tmp_path / "speed_accuracy.nc")
    names = ("Z", "collision_rate")
    virial = xr.Dataset(
        {name: ("point", [2.0]) for name in names} | {f"{name}_error": ("point", [0.01]) for name in names}
    ).assign(packing_fraction=("point", [0.2]), collisions=("point", [1e6]))
    for name in ("virial_spheres", "virial_discs"):
        virial.to_netcdf(tmp_path / f"{name}.nc")
    xr.Dataset(
        {
            "time": (("point", "lag"), [[0.0, 5.0, 10.0]]),
            "collision_rate": ("point", [2.0]),
            "count": ("point", [100]),
            "replicas": ("point", [4]),
            "diffusion": ("point", [0.5]),
            "diffusion_error": ("point", [0.005]),
        }
    ).to_netcdf(tmp_path / "msd_spheres.nc")
    xr.Dataset(
        {
            "engine": ("point", ["event", "event", "step"]),
            "feature": ("point", ["plain", "two masses", "gravity"]),
            "ratio": ("point", [1.0, 1.02, 1.1]),
            "ratio_error": ("point", [0.01, 0.01, 0.02]),
        }
    ).to_netcdf(tmp_path / "price_of_features.nc")
    return tmp_path


def test_the_table_holds_what_was_measured(folder, capsys):
    fit.main(str(folder))
    output = capsys.readouterr().out
    assert output.startswith("# What accuracy costs")
    rows = list(csv.DictReader(io.StringIO("".join(output.splitlines(keepends=True)[2:]))))
    assert tuple(rows[0]) == table.COLUMNS
    events = [row for row in rows if row["engine"] == "event" and row["quantity"] == "seconds"]
    times = {row["packing_fraction"]: float(row["value"]) for row in events}
    assert times == {"0.1": 4e-7, "0.45": 3e-7}
    found = {(row["engine"], row["time_step"], row["quantity"], row["dimension"]): row for row in rows}
    assert len(found) + 1 == len(rows) == 2 + 3 + 2 + 6 + 4 + 1 + 2
    assert float(found["step", "0.02", "seconds", "3"]["value"]) == 4e-6
    assert float(found["dsmc enskog", "1", "seconds", "3"]["value"]) == 9e-7
    assert [float(found["dsmc", "1", "seconds", d]["value"]) for d in "32"] == [3e-7, 2e-7]
    assert float(found["dsmc", "4", "seconds", "3"]["value"]) == 2e-7
    assert not [key for key in found if key[0] == "dsmc" and key[1] == "0.5"]
    assert float(found["step", "0.02", "bias_Z", "3"]["error"]) == 0.001
    assert ("step", "0.02", "bias_collision_rate", "3") not in found
    assert float(found["event", "0", "price_two_masses", "3"]["value"]) == 1.02
    # (0.01 / 2)^2 of 1e6 contacts; D: (0.01)^2 of 100 / 2 particles x 4 replicas, each of 2 x 10 x 2
    # collisions
    assert float(found["event", "0", "noise_Z", "2"]["value"]) == pytest.approx(25.0)
    assert float(found["event", "0", "noise_D", "3"]["value"]) == pytest.approx(1e-4 * 50 * 4 * 40, rel=1e-3)
