"""Made-up runs and measurements of a large disc in a fluid under gravity, with known answers."""

import numpy as np
import xarray as xr

from gaspart.reproduction.families.shared.columns import Stretch
from gaspart.theory import gravity
from gaspart.theory.brownian import displaced_area

WIDTH, HEIGHT, STRENGTH, RADIUS, SMALL = 24.0, 60.0, 0.05, 3.0, 0.5


def dilute_fluid(rng, frames, count, large):
    """Frames (T, 1 + count, 2) of an ideal gas at temperature 1 around the large disc's places (T, 2)."""
    positions = np.empty((frames, 1 + count, 2))
    for frame, place in enumerate(large):
        chance = rng.random(4 * count) * -np.expm1(-STRENGTH * HEIGHT)
        points = np.stack([WIDTH * rng.random(4 * count), -np.log1p(-chance) / STRENGTH], axis=-1)
        across = np.abs(points[:, 0] - place[0])
        across = np.minimum(across, WIDTH - across)
        outside = across**2 + (points[:, 1] - place[1]) ** 2 > (RADIUS + SMALL) ** 2
        positions[frame] = [place, *points[outside][:count]]
    return positions


def stretch(positions, displaced):
    """The stretch of such frames at temperature 1, whose fluid bears the weight of so many small discs."""
    frames, particles, _ = positions.shape
    energies = np.ones((frames, particles))
    energies[:, 0] = 0.0
    weight = STRENGTH * (particles - 1)
    return Stretch(positions, energies, weight + 2.0 + displaced * STRENGTH, 2.0, 0.0, 1.0)


def measurement(error=0.03):
    """What `measure.buoyancy` gives if theory is right."""
    ratio = RADIUS / SMALL
    eta = np.array([0.4, 0.3, 0.2, 0.1])
    displaced = eta * displaced_area(eta, ratio)
    beyond = np.sqrt(displaced_area(eta, ratio)) - ratio
    height = np.linspace(0.0, HEIGHT, 50)
    (density,) = gravity.hydrostatic_profiles(height, [18.0], [0.08], 2)
    fluid = density * np.pi / 4.0
    fixed = {
        "force": displaced,
        "force_error": 0.02 * displaced,
        "missing": displaced,
        "missing_error": 0.01 * displaced,
        "packing_fraction": eta,
        "packing_fraction_error": 0.001 * eta,
        "force_radius": beyond,
        "force_radius_error": np.full(4, 2.0 * error),
        "count_radius": beyond,
        "count_radius_error": np.full(4, error),
        "radius_expected": beyond,
        "height": np.array([10.0, 20.0, 35.0, 50.0]),
    }
    free = {
        "mass": np.array([5.0, 40.0]),
        "height": np.array([45.0, 2.9]),
        "height_error": np.array([10.0, 1.0]) * error,
        "spread": np.array([6.0, 0.4]),
        "spread_error": np.array([1.0, 0.1]) * error,
        "expected": np.array([45.1, 3.0]),
        "expected_spread": np.array([6.0, 0.4]),
        "lowest": np.full(2, RADIUS - SMALL),
    }
    return xr.Dataset(
        {f"fixed_{name}": ("fixed", value) for name, value in fixed.items()}
        | {f"free_{name}": ("free", value) for name, value in free.items()}
        | {"displaced": ("height", fluid * displaced_area(fluid, ratio))},
        coords={"height": height},
        attrs={"size_ratio": ratio, "strength": STRENGTH, "top": HEIGHT},
    )


def with_source(ds):
    """The same, and ten of the source's discs if theory is right: the first two at the ceiling, the last at
    the floor, the one before too near to it for a claim, the others afloat, at the source's density in the
    middle."""
    expected = np.array([59.9, 59.0, 55.0, 47.0, 39.0, 31.0, 23.0, 15.0, 5.0, 3.1])
    low, high = np.full(10, 2.5), np.full(10, 60.5)
    density = 0.2 + 0.005 * (31.5 - expected) / 8.0
    source = {"mass": 300.0 * density, "density": density, "height": expected, "expected": expected.copy()}
    source |= {"height_error": np.full(10, 0.3), "lowest": low, "highest": high}
    made = ds.assign({f"source_{name}": ("source", value) for name, value in source.items()})
    return made.assign_attrs(source_density=0.2)
