"""Writer of the table `data/accuracy.csv` from measurements of the workflow.

    python tools/accuracy_table.py results/measurements > src/gaspart/accuracy/data/accuracy.csv

The writer reads the following files from a folder: speed_accuracy.nc (errors and times of the engines),
virial_spheres.nc and virial_discs.nc (noise of Z and of the collision rate), msd_spheres.nc (noise of D) and
price_of_features.nc.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import xarray as xr

from gaspart.accuracy.advisers import timed_as
from gaspart.accuracy.table import COLUMNS, PRECISIONS
from gaspart.engines import DSMC
from gaspart.engines.dsmc.settings import MODELS
from gaspart.trajectory import provenance


def rows(folder: Path) -> list[dict]:
    """Return all rows of the table; `gaspart.accuracy.table` describes the columns."""
    accuracy = xr.load_dataset(folder / "speed_accuracy.nc")
    entries = [
        *_events(accuracy),
        *_steps(accuracy),
        *_models(accuracy),
        *_noise(xr.load_dataset(folder / "virial_spheres.nc"), 3),
        *_noise(xr.load_dataset(folder / "virial_discs.nc"), 2),
        *_diffusion(xr.load_dataset(folder / "msd_spheres.nc")),
        *_prices(xr.load_dataset(folder / "price_of_features.nc")),
    ]
    return [{**row, "value": f"{row['value']:.4g}", "error": f"{row['error']:.2g}"} for row in entries]


def _row(
    dimension: int,
    fraction: float,
    engine: str,
    precision: str,
    step: float,
    quantity: str,
    value: float,
    error: float,
) -> dict:
    values = (int(dimension), f"{float(fraction):g}", engine, precision, f"{step:g}", quantity, float(value))
    return dict(zip(COLUMNS, (*values, float(error)), strict=True))


def _events(accuracy: xr.Dataset) -> Iterator[dict]:
    """Yield CPU times of the event-driven engine, also in gases too dense for the time-stepped engine."""
    for n in range(accuracy.sizes["timed"]):
        run = accuracy.isel(timed=n)
        gas = run.timed_dimension, run.timed_packing_fraction
        yield _row(*gas, "event", "float64", 0.0, "seconds", run.timed_seconds, run.timed_error)


def _steps(accuracy: xr.Dataset) -> Iterator[dict]:
    """Yield errors and CPU times of the time-stepped engine."""
    for n in range(accuracy.sizes["row"]):
        row = accuracy.isel(row=n)
        gas = row.dimension, row.packing_fraction
        setting = str(row.setting.values)
        if setting not in PRECISIONS:
            continue
        for k in np.flatnonzero(np.isfinite(row.time_step.values)):
            step = float(row.time_step[k])
            of = (*gas, "step", PRECISIONS[setting], step)
            for observable in row.observable.values:
                at = row.sel(observable=observable).isel(step=k)
                if np.isfinite(at.bias):
                    yield _row(*of, f"bias_{observable}", at.bias, at.bias_error)
            if np.isfinite(row.seconds[k]):
                yield _row(*of, "seconds", row.seconds[k], row.seconds_error[k])


def _models(accuracy: xr.Dataset) -> Iterator[dict]:
    """Yield CPU times of both models of DSMC, with the default step and longer steps."""
    names = {model: timed_as(DSMC(model=model)) for model in MODELS}
    for n in range(accuracy.sizes["dsmc"]):
        run = accuracy.isel(dsmc=n)
        gas = run.dsmc_dimension, run.dsmc_packing_fraction
        model = names[str(run.dsmc_model.values)]
        for k in np.flatnonzero(run.dsmc_step.values >= 1.0):
            step, of = float(run.dsmc_step[k]), run.isel(part=k)
            seconds = of.dsmc_step_seconds, of.dsmc_step_seconds_error
            yield _row(*gas, model, "float64", step, "seconds", *seconds)


def _noise(virial: xr.Dataset, dimension: int) -> Iterator[dict]:
    """Yield relative variances of Z and of the collision rate, multiplied by the numbers of contacts."""
    for n, fraction in enumerate(virial.packing_fraction.values):
        contacts = float(virial.collisions[n])
        for name, quantity in (("Z", "Z"), ("collision_rate", "collision_rate")):
            relative = float(virial[f"{name}_error"][n] / virial[name][n])
            value = relative**2 * contacts
            yield _row(dimension, fraction, "event", "float64", 0.0, f"noise_{quantity}", value, 0.3 * value)


def _diffusion(msd: xr.Dataset) -> Iterator[dict]:
    """Yield the relative variance of D of spheres times contacts: the median over gases of few replicas."""
    length = msd.time.max("lag") * 2.0 * msd.collision_rate  # lags extend to half of the run
    contacts = 0.5 * msd["count"] * length * msd.replicas
    values = ((msd.diffusion_error / msd.diffusion) ** 2 * contacts).values
    values = values[np.isfinite(values)]
    yield _row(
        3, 0.1, "event", "float64", 0.0, "noise_D", np.median(values), values.std() / len(values) ** 0.5
    )


def _prices(price: xr.Dataset) -> Iterator[dict]:
    """Yield the cost of each feature for 4000 spheres at a packing fraction of 0.2."""
    for n in np.flatnonzero(price.feature.values != "plain"):
        at = price.isel(point=n)
        name = f"price_{str(at.feature.values).replace(' ', '_')}"
        yield _row(3, 0.2, str(at.engine.values), "float64", 0.0, name, at.ratio, at.ratio_error)


def main(folder: str) -> None:
    """Write the table to standard output."""
    revision = provenance.git_revision()
    print(
        "# What accuracy costs; columns in gaspart/accuracy/table.py. Made by python tools/accuracy_table.py"
    )
    print(f"# from the full reproduction, revision {revision}. Times are of the machine that it ran on.")
    writer = csv.DictWriter(sys.stdout, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows(Path(folder)))


if __name__ == "__main__":
    main(sys.argv[1])
