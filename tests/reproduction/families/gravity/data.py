"""Made-up points, stretches and measurements of gases under gravity, with known answers."""

import numpy as np
import xarray as xr

from gaspart.reproduction.families.shared.columns import Field, Stretch
from gaspart.reproduction.points.point import Point
from gaspart.theory import gravity


def point(scene_file, **settings):
    """One point of a grid that has a scene file; nothing of it is run."""
    settings = {"scene": str(scene_file), "duration": 40.0, "samples": 20, "equilibration": 10.0} | settings
    return Point("column", "single", "simulate", settings, "results/points", 1)


def ideal_column(rng, frames, masses, height=4.0, width=3.0, strength=1.0, temperature=1.0):
    """An ideal gas: its field, and a stretch of independent frames of it."""
    masses = np.asarray(masses, dtype=float)
    weights = masses * strength / temperature
    chance = rng.random((frames, masses.size)) * -np.expm1(-weights * height)
    heights = -np.log1p(-chance) / weights
    across = width * rng.random(heights.shape)
    energies = temperature * rng.exponential(size=heights.shape)
    ceiling = temperature * sum(
        gravity.ideal_profile(height, height, weight) for weight in weights
    )  # the pressure there times the width
    place = Field(strength, width, height, 0.01, masses, (masses > masses.min()).astype(int), False)
    floor = float(ceiling + place.weight)
    return place, Stretch(
        np.stack([across, heights], axis=-1), energies, floor, float(ceiling), 0.0, temperature
    )


def columns(kinds=1, error=0.002):
    """What `measure.gravity.profiles` gives of a dilute and a dense column if theory is right."""
    bins, top, strength, temperature = 30, 60.0, 0.05, 1.0
    masses = np.array([1.0, 3.0])[:kinds]
    height = (np.arange(bins) + 0.5) * top / bins
    shape = (2, kinds, bins)
    density = np.empty(shape)
    for n, number in enumerate((0.01, 16.0)):
        density[n] = gravity.hydrostatic_profiles(
            height, [number / kinds] * kinds, masses * strength / temperature, 2
        )
    ones = np.ones((2, bins))
    eta = density.sum(axis=1) * np.pi / 4.0
    lines = np.tile(-2.0 * strength * height, (2, 1))
    ranges = np.array([[np.nan] * 2, [1.0] * 2])
    by_bin, by_species = ("point", "bin"), ("point", "species")
    values = {
        "density": (("point", "species", "bin"), density),
        "packing_fraction": (by_bin, eta),
        "temperature": ("point", np.full(2, temperature)),
        "temperature_ratio": (by_bin, ones),
        "temperature_gradient": ("point", np.zeros(2)),
        "compressibility": (by_bin, ones),
        "pressure_ratio": (by_bin, ones),
        "range_ratio": (("point", "range"), ranges),
        "slope_ratio": (by_species, np.ones((2, kinds))),
        "exchange_ratio": ("point", np.ones(2)),
        "log_ratio": (by_bin, lines),
        "mean_height_ratio": (by_species, np.ones((2, kinds))),
        "species_temperature_ratio": (by_species, np.ones((2, kinds))),
    }
    values |= {f"{name}_error": (axes, np.full(value.shape, error)) for name, (axes, value) in values.items()}
    values["density_error"] = (("point", "species", "bin"), error * density)
    values |= {
        "height": (by_bin, np.tile(height, (2, 1))),
        "used": (by_bin, ones.astype(bool)),
        "hydrostatic": (("point", "species", "bin"), density),
        "log_ratio_expected": (by_bin, lines),
        "mass": (by_species, np.tile(masses, (2, 1))),
        "imbalance": ("point", np.full(2, 1e-11)),
    }
    for name, value in {"strength": strength, "top": top, "count": 1000, "mean_density": 0.2}.items():
        values[name] = ("point", np.full(2, value))
    return xr.Dataset(
        values,
        coords={
            "column": ("point", ["dilute", "dense"]),
            "range_low": ("range", [0.1, 0.2]),
            "range_high": ("range", [0.2, 0.3]),
        },
    )


def with_source(ds):
    """These columns and the source's: in its sample and later, both as the dense one."""
    more = [ds.isel(point=1).assign_coords(column=name) for name in ("source", "later")]
    made = xr.concat([ds, *more], "point")
    reported = np.linspace(0.2, 0.9, 10)
    share = reported + 0.01 * np.sqrt(2.0) * np.tile([1.0, -1.0], 5)  # each one standard deviation off
    only = np.array([np.nan, np.nan, 1.0, np.nan])
    numbers = {"collisions": 1e7, "ringing": 0.002, "ringing_error": 0.001}
    return made.assign(
        {name: ("point", value * only) for name, value in numbers.items()}
        | {
            "share": (("point", "layer"), np.outer(only, share)),
            "share_error": (("point", "layer"), np.outer(only, np.full(10, 0.01))),
        }
    ).assign_attrs(source_collisions=1e7, source_temperature=1.0, source_shares=reported.tolist())


def capacities():
    """What `measure.gravity.heat_capacity` gives if theory is right, without and with gravity."""
    x = np.array([0.0, 2.0])
    slope = gravity.ideal_heat_capacity(x, 2)
    both = np.repeat(slope, 2).reshape(2, 2)
    error = np.array([0.0, 0.01])
    return xr.Dataset(
        {
            "x": ("pair", x),
            "gravity": ("pair", [0.0, 0.02]),
            "run_x": (("pair", "run"), np.array([[0.0, 0.0], [1.9, 2.1]])),
            "slope": ("pair", slope),
            "slope_error": ("pair", error),
            "slope_expected": ("pair", slope),
            "fluctuation": (("pair", "run"), both),
            "fluctuation_error": (("pair", "run"), np.repeat(error, 2).reshape(2, 2)),
            "fluctuation_expected": (("pair", "run"), both),
        },
        attrs={"count": 100},
    )
