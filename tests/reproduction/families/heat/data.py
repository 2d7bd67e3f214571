"""Runs of heat between walls, and what their measurements give if theory is right."""

from pathlib import Path

import numpy as np
import xarray as xr

import gaspart as gp
from gaspart.reproduction.families.heat.gap import FRAMES
from gaspart.reproduction.families.heat.measure import INNER
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import from_rows
from gaspart.theory.heat import (
    METAL_BEND,
    METAL_GAP,
    TEMPERATURE_JUMP,
    conducting_slab,
    dilute_fourier_flux,
    free_molecular_flux,
    steady_part,
)


def run(tmp_path, scene, **settings):
    """A point of this scene with its runs made."""
    scene.to_file(tmp_path / "scene.yaml")
    settings |= {"scene": str(tmp_path / "scene.yaml")}
    point = Point("heat", "single", "simulate", settings, str(tmp_path / "points"), 1)
    times = point.schedule
    for k, path in enumerate(point.replica_paths):
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        engine = point.engine
        gp.run(point.scene, engine, point.seed(k), times.duration, times.sample_interval, path)
    return point


def gas(count, radius, components="all"):
    """Spheres between walls at 2 and 1."""
    container = gp.Container((10.0 + 2 * radius, 6.0, 6.0), ("wall", "periodic", "periodic"))
    faces = {"x_low": gp.Thermal(2.0, components), "x_high": gp.Thermal(1.0, components)}
    return gp.Scene(container, [gp.Species(count, radius, temperature=1.4)], faces=faces)


def gases(error=0.002):
    """A dense gas, and thin ones between walls of both rules in two and three dimensions."""
    length, bins = 200.0, 10
    position = (np.arange(bins) + 0.5) * length / bins
    rows = []
    for number, knudsen, dimension, rule in (
        (0.04, 0.03, 3, "all"),
        (0.001, 2000.0, 3, "all"),
        (0.001, 2000.0, 3, "normal"),
        (0.001, 2000.0, 2, "all"),
        (0.001, 2000.0, 2, "normal"),
    ):
        free = free_molecular_flux(number, 2.0, 1.0, dimension, components=rule)
        row = {"dimension": dimension, "normal": rule == "normal", "number": number, "knudsen": knudsen}
        row |= {"length": length, "hot": 2.0, "cold": 1.0, "imbalance": 1e-12, "free": free, "flux": free}
        row |= {"full": free_molecular_flux(number, 2.0, 1.0, dimension), "wall_ratio": 1.0}
        row |= {"fourier": dilute_fourier_flux(length, 2.0, 1.0), "half_ratio": 1.0}
        row |= dict.fromkeys(("slab_flux", "profile_ratio", "jump"), np.nan)
        row |= {"position": position, "used": position > 20.0}
        row |= {"temperature": np.full(bins, 1.4), "density": np.full(bins, number)}
        row |= dict.fromkeys(("slab_temperature", "slab_density"), np.full(bins, np.nan))
        row["approach_time"] = 40.0 * np.arange(FRAMES)
        row |= dict.fromkeys(("approach", "approach_error", "expected_approach"), np.full(FRAMES, np.nan))
        if knudsen < 0.1:
            slab = conducting_slab(length, number, 2.0, 1.0)
            row |= {"flux": slab.flux, "slab_flux": slab.flux}
            row |= {"profile_ratio": 1.0, "jump": TEMPERATURE_JUMP}
            row["approach"] = row["expected_approach"] = 0.45 * steady_part(row["approach_time"], length, 7.0)
            row["approach_error"] = np.full(FRAMES, 0.05)
            for name in ("temperature", "density"):
                row[name] = np.interp(position, slab.position, getattr(slab, name))
                row[f"slab_{name}"] = row[name]
        for name in ("flux", "wall_ratio", "half_ratio", "profile_ratio", "jump", "temperature", "density"):
            row[f"{name}_error"] = np.abs(row[name]) * error
        rows.append(row)
    return from_rows("point", rows, INNER)


def metals(error=0.002):
    """A metal between different walls, between walls at 1 and at 2, and its grid between different walls."""
    ones, bins = np.ones(4), 8
    position = (np.arange(bins) + 0.5) / bins
    values = {
        "share": ones,
        "energy_ratio": ones,
        "log_fluctuation": 0.0 * ones,
        "bend": METAL_BEND * ones,
        "mode_ratio": ones,
        "flux": np.array([0.1, 0.1, 0.1, 0.105]),
    }
    ds = xr.Dataset({name: ("point", value) for name, value in values.items()})
    for name in ("electrons", "modes"):
        ds[name] = (("point", "bin"), np.tile(2.0 - position, (4, 1)))
    for name in list(ds):
        ds[f"{name}_error"] = (
            error * ds[name] if name not in ("log_fluctuation", "bend") else ("point", error * ones)
        )
    ds["position"] = (("point", "bin"), np.tile(position, (4, 1)))
    for name, value in {"hot": [2, 1, 2, 2], "cold": [1, 1, 2, 1], "expected": [360] * 4}.items():
        ds[name] = ("point", np.array(value, dtype=float))
    ds["regular"] = ("point", np.array([False, False, False, True]))
    ds = ds.assign(gap_over_path=("point", METAL_GAP * ones), electrons_part=("point", ones * 5 / 9))
    return ds.assign(slope=1.0, slope_error=error)
