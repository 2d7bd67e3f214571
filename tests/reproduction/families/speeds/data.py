"""Made-up trajectories and measurements of speeds, with known answers."""

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.reproduction.points.point import Point


def point(dimension=3, count=200, experiment="speeds", **more):
    """One point of a grid; nothing of it is run."""
    settings = {
        "dimension": dimension,
        "count": count,
        "radius": 0.2,
        "packing_fraction": 0.01,
        "speed": 1.0,
        "engine": "event",
        "duration": 3.0,
        "samples": 3,
        "replicas": 4,
    }
    return Point(experiment, "single", "simulate", settings | more, "results/points", 1)


def trajectory(velocities, collisions):
    """What `open_trajectory` gives of speeds: velocities (T, N, d), collisions per particle (T,)."""
    frames, count, _ = velocities.shape
    return xr.Dataset(
        {
            "velocities": (("frame", "atom", "spatial"), velocities.astype(np.float32)),
            "collisions": ("frame", 0.5 * count * np.asarray(collisions, dtype=float)),
            "kinetic_energy": ("frame", 0.5 * (velocities**2).sum(axis=(1, 2))),
        },
        coords={"time": ("frame", np.arange(float(frames)))},
    )


def directions(rng, count, dimension):
    """(count, dimension) random unit vectors."""
    vectors = rng.standard_normal((count, dimension))
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def equilibrium(rng, frames, count, dimension):
    """(frames, count, dimension) exactly microcanonical velocities, <v^2> = 1."""
    velocities = rng.standard_normal((frames, count, dimension))
    return velocities / np.sqrt((velocities**2).sum(axis=(1, 2), keepdims=True) / count)


def relaxation_measurement(error=0.003, seed=5):
    """What `measure.speed_relaxation` gives if kinetic theory is right, with noise of the errors' size."""
    rng = np.random.default_rng(seed)
    theoretical = theory.relaxation(3)
    s = np.linspace(0.0, 3.6, 16)
    edges = np.linspace(0.0, 2.5, 26)
    shape = (2, s.size)
    density = np.diff(theory.maxwell_cdf(edges, 3, 1 / 3)) / np.diff(edges)

    def noisy(values, error):
        return ("engine", "frame"), values + error * rng.uniform(-1.0, 1.0, shape)

    rate = 3.55 / 150.0
    end = float(theoretical.collisions(rate * 150.0))
    return xr.Dataset(
        {
            "collisions": (("engine", "frame"), np.tile(s * end / 3.6, (2, 1))),
            "collisions_error": (("engine", "frame"), np.full(shape, 0.01)),
            "kurtosis": noisy(theoretical.kurtosis(s * end / 3.6), error),
            "kurtosis_error": (("engine", "frame"), np.full(shape, error)),
            "never_hit": noisy(theoretical.never_hit(s * end / 3.6), 0.3 * error),
            "never_hit_error": (("engine", "frame"), np.full(shape, 0.3 * error)),
            "temperature_drift": (("engine", "frame"), np.full(shape, 1e-16)),
            "temperature_drift_error": (("engine", "frame"), np.full(shape, 1e-17)),
            "density": (("engine", "snapshot", "bin"), np.tile(density, (2, 3, 1))),
            "density_error": (("engine", "snapshot", "bin"), np.full((2, 3, 25), 0.01)),
            "initial_slope": ("engine", np.full(2, 8 / 35)),
            "initial_slope_error": ("engine", np.full(2, 0.004)),
            "replicas": ("engine", np.array([6, 24])),
        },
        coords={
            "engine": ["step", "event"],
            "time": ("frame", 10.0 * np.arange(16)),
            "shown": ("snapshot", [5, 10, 15]),
            "lower": ("bin", edges[:-1]),
            "upper": ("bin", edges[1:]),
        },
        attrs={"dimension": 3, "count": 4000, "packing_fraction": 0.0012, "collision_rate": rate},
    )
