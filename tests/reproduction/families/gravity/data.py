"""Made-up points, stretches and measurements of gases under gravity, with known answers."""

import numpy as np
import xarray as xr

from gaspart.reproduction.families.gravity.measure import INNER
from gaspart.reproduction.families.shared.columns import Field, Stretch
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import table
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
    bins, top, strength, masses = 30, 60.0, 0.05, np.array([1.0, 3.0])[:kinds]
    height = (np.arange(bins) + 0.5) * top / bins
    line, of_bin, of_species = -2.0 * strength * height, np.ones(bins), np.ones(kinds)

    def column(stated):
        name, number, range_ratio = stated
        density = gravity.hydrostatic_profiles(height, [number / kinds] * kinds, masses * strength, 2)
        values = {
            "packing_fraction": density.sum(axis=0) * np.pi / 4.0,
            "temperature": 1.0,
            "temperature_gradient": 0.0,
            **dict.fromkeys(("temperature_ratio", "compressibility", "pressure_ratio"), of_bin),
            **dict.fromkeys(("slope_ratio", "mean_height_ratio", "species_temperature_ratio"), of_species),
            "range_ratio": np.full(2, range_ratio),
            "exchange_ratio": 1.0,
            "log_ratio": line,
        }
        facts = {"column": name, "height": height, "used": of_bin > 0.0, "mass": masses, "imbalance": 1e-11}
        facts |= {"strength": strength, "top": top, "count": 1000, "mean_density": 0.2}
        measured = {name: (value, np.full(np.shape(value), error)) for name, value in values.items()}
        expected = {"density": (density, error * density), "hydrostatic": density, "log_ratio_expected": line}
        return facts | measured | expected

    made = table("point", [("dilute", 0.01, np.nan), ("dense", 16.0, 1.0)], column, inner=INNER)
    ranges = {"range_low": ("range", [0.1, 0.2]), "range_high": ("range", [0.2, 0.3])}
    return made.set_coords("column").assign_coords(ranges)


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
