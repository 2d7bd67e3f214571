"""Made-up runs through freezing with known answers, in the form that `measure.freezing` gives."""

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.reproduction.families.freezing.measure import STARTS, _disagreement

DISCS = np.array([0.68, 0.69, 0.70, 0.71, 0.72, theory.CRYSTAL_OF_1024_DISCS[0]])
SPHERES = np.array([0.4, 0.45, 0.5, 0.56, 0.6])


def _table(eta, pressure, order, error, seed):
    """Both starts with Gaussian scatter and no drift."""
    rng = np.random.default_rng(seed)
    shape = (2, eta.size)
    table = {}
    for name, values, scale in (("pressure", pressure, error), ("order", order, 0.002)):
        noise = 0.5 * scale * rng.standard_normal((2, *shape))
        table |= {
            name: values + noise[0],
            f"{name}_error": np.full(shape, scale),
            f"{name}_drift": noise[1],
            f"{name}_drift_error": np.full(shape, 2.0 * scale),
        }
    dataset = xr.Dataset(
        {
            name: (("start", "packing_fraction"), np.broadcast_to(v, shape).copy())
            for name, v in table.items()
        },
        coords={"start": list(STARTS.values()), "packing_fraction": eta},
    )
    dataset["count"] = "packing_fraction", np.full(eta.size, 1024)
    return dataset


def discs(error=0.005, seed=1):
    """A loop about 9.1 with both branches as the literature has them."""
    area = np.pi / 4.0
    crystal = theory.CRYSTAL_OF_1024_DISCS[1]
    pressure = np.array([8.514, 8.98, 9.13, 9.06, 9.1, crystal])
    dataset = _table(DISCS, pressure, np.array([0.08, 0.2, 0.4, 0.65, 0.76, 0.8]), error, seed)
    dataset["density"] = "packing_fraction", DISCS / area
    for name, value in (
        ("plateau", 9.1),
        ("plateau_error", 0.02),
        ("plateau_low", 0.698),
        ("plateau_high", 0.72),
    ):
        dataset[name] = "start", np.full(2, value)
    rng = np.random.default_rng(seed)
    shown, particles = 3, 64
    waves = np.linspace(-12.0, 12.0, 9)
    pictures = xr.Dataset(
        {
            "x": (("shown", "particle"), 10.0 * rng.random((shown, particles))),
            "y": (("shown", "particle"), 9.0 * rng.random((shown, particles))),
            "angle": (("shown", "particle"), rng.uniform(-np.pi, np.pi, (shown, particles))),
            "g": (("shown", "distance"), np.ones((shown, 20))),
            "wave_x": (("shown", "mode_x"), np.tile(waves, (shown, 1))),
            "wave_y": (("shown", "mode_y"), np.tile(waves, (shown, 1))),
            "structure_factor": (("shown", "mode_x", "mode_y"), rng.exponential(1.0, (shown, 9, 9))),
        },
        coords={"shown": DISCS[[0, 2, 5]], "distance": np.linspace(0.2, 8.0, 20)},
    )
    return dataset.assign(disagreement=_disagreement(dataset)).merge(pictures).merge(_compared(seed))


def _compared(seed):
    """The pressures of 870 discs, as published."""
    known = theory.literature("pressure", 2)
    known = known[(known.container == "29 x 30") & np.isin(known.packing_fraction, [0.68, 0.7])]
    eta, pressure = known.packing_fraction, known.value
    dataset = _table(eta, pressure, np.full(eta.size, 0.1), 0.0015, seed + 1)
    names = [f"pressure{name}" for name in ("", "_error", "_drift", "_drift_error")]
    renamed = {name: f"compared_{name}" for name in (*names, "packing_fraction")}
    return dataset[names].rename(renamed)


def spheres(error=0.005, seed=1):
    """The crystal melts below 0.5; a fluid start stays fluid to 0.5."""
    volume = np.pi / 6.0
    fluid = theory.compressibility_factor(np.minimum(SPHERES, 0.5), 3)
    crystal = np.where(SPHERES >= 0.5, theory.etomica_crystal(np.maximum(SPHERES, 0.5)), fluid)
    z = np.stack([crystal, fluid])
    order = np.array([[0.02, 0.02, 0.4, 0.5, 0.52], [0.02, 0.02, 0.02, np.nan, np.nan]])
    dataset = _table(SPHERES, z * SPHERES / volume, order, error, seed)
    dataset["density"] = "packing_fraction", SPHERES / volume
    dataset["crystalline"] = (dataset["order"] > 0.3).astype(int)
    both = "start", "packing_fraction"
    dataset["Z"] = dataset["pressure"] / dataset["density"]
    dataset["Z_error"] = dataset["pressure_error"] / dataset["density"]
    dataset["reference"] = both, np.where(np.isfinite(order), z, np.nan)
    position = np.linspace(0.5, 30.5, 31)
    solid = (position < 15.0).astype(float)
    profiles = xr.Dataset(
        {
            "slab_pressure": 11.55,
            "slab_error": 0.03,
            "slab_drift": 0.02,
            "slab_drift_error": 0.06,
            "slab_length": 31.0,
            "slab_count": 2743,
            "crystal_fraction": ("half", [0.52, 0.5]),
            "slab_order": (("half", "position"), np.tile(0.15 + 0.33 * solid, (2, 1))),
            "slab_density": (("half", "position"), np.tile(0.939 + 0.1 * solid, (2, 1))),
        },
        coords={"position": position},
        attrs={"slab_packing_fraction": 0.517},
    )
    merged = dataset.assign(disagreement=_disagreement(dataset)).merge(profiles)
    return merged.assign_attrs(profiles.attrs)
