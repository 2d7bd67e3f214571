"""Random scenes whose local density is not the mean one: columns, slits, few particles, strong gradients."""

import math

import numpy as np

import gaspart as gp

OBSERVABLES = {
    "column": ("collision_rate", "temperature", "density", "pressure:floor", "speeds"),
    "falling": ("collision_rate", "temperature", "pressure:floor"),
    "stratified": ("collision_rate", "temperature", "density", "pressure:floor", "msd"),
    "slit": ("pressure", "collision_rate", "density", "vacf"),
    "few": ("collision_rate", "Z"),
    "few in a box": ("collision_rate", "pressure"),
    "gradient": ("collision_rate", "pressure", "temperature", "density"),
    "granular column": ("collision_rate", "temperature", "density"),
}
"""Those of each kind of scene, in turn."""
COARSE = {"density": 4.0, "temperature": 3.0, "vacf": 2.0, "msd": 2.0}


def scene(number):
    """A kind, a random scene of it, an observable and an accuracy."""
    rng = np.random.default_rng([2027, number])
    kind = list(OBSERVABLES)[number % len(OBSERVABLES)]
    choice = OBSERVABLES[kind]
    observable = choice[(number // len(OBSERVABLES)) % len(choice)]
    dimension = int(rng.integers(2, 4))
    made = _MAKERS[kind](rng, dimension)
    observable = observable.replace("floor", f"{'xyz'[dimension - 1]} low")
    name = observable.partition(":")[0]
    accuracy = COARSE.get(name, 1.0) * float(np.exp(rng.uniform(math.log(0.02), math.log(0.1))))
    return kind, made, observable, accuracy


def _log(rng, low, high):
    return float(np.exp(rng.uniform(math.log(low), math.log(high))))


def _pulled(rng, d, count, height, filled, pull, start):
    """Particles of diameter 1 above a floor; filled: their packing fraction at the start, where they are in a
    layer of the height `start`, at a place between the floor and the top."""
    area = count * gp.theory.particle_volume(d) / (filled * start)
    side = max(3.0, area ** (1.0 / (d - 1)))
    low = float(rng.choice([0.0, 0.5, 1.0])) * (height - start)
    region = ((0.0,) * (d - 1) + (low,), (side,) * (d - 1) + (min(low + start, height),))
    species = gp.Species(count, 0.5, temperature=1.0, exact_temperature=True, region=region)
    container = gp.Container((side,) * (d - 1) + (height,), ("periodic",) * (d - 1) + ("wall",))
    return {"container": container, "species": [species], "gravity": (0.0,) * (d - 1) + (-pull,)}


def _column(rng, d):
    """Most of its height is empty; scale heights of 2 to 30 diameters."""
    scale = _log(rng, 2.0, 30.0)
    parts = _pulled(rng, d, int(_log(rng, 30, 500)), 40.0 * scale, _log(rng, 0.003, 0.2), 1.0 / scale, 6.0)
    (species,) = parts["species"]
    (low, high) = species.region
    species = gp.Species(
        species.count, 0.5, temperature=1.0, exact_temperature=True,
        region=((*low[:-1], 0.0), (*high[:-1], 6.0)),
    )  # fmt: skip
    return gp.Scene(**{**parts, "species": [species]})


def _falling(rng, d):
    """It starts at the floor, in the middle or at the top, and falls to where it is hotter."""
    scale = _log(rng, 4.0, 30.0)
    height = scale * float(rng.uniform(4.0, 15.0))
    count = int(_log(rng, 30, 300))
    return gp.Scene(**_pulled(rng, d, count, height, _log(rng, 0.003, 0.1), 1.0 / scale, 0.2 * height))


def _stratified(rng, d):
    """Random places in all of a container of one to five scale heights."""
    scale = _log(rng, 8.0, 60.0)
    height = scale * float(rng.uniform(1.0, 5.0))
    count = int(_log(rng, 100, 1500))
    return gp.Scene(**_pulled(rng, d, count, height, _log(rng, 0.002, 0.1), 1.0 / scale, height))


def _even(rng, d, count, filled, lengths, boundary, **more):
    species = gp.Species(count, 0.5, temperature=1.0, exact_temperature=True)
    return gp.Scene(gp.Container(lengths, boundary), [species], **more)


def _slit(rng, d):
    """Two walls 3 to 20 diameters apart."""
    count, width, filled = int(_log(rng, 60, 500)), _log(rng, 3.0, 20.0), _log(rng, 0.003, 0.2)
    area = count * gp.theory.particle_volume(d) / (filled * width)
    side = max(3.0, area ** (1.0 / (d - 1)))
    boundary = ("periodic",) * (d - 1) + ("wall",)
    return _even(rng, d, count, filled, (side,) * (d - 1) + (width,), boundary)


def _few(rng, d, boundary="periodic"):
    """From two on."""
    count, filled = int(_log(rng, 2, 40)), _log(rng, 0.002, 0.1)
    side = (count * gp.theory.particle_volume(d) / filled) ** (1.0 / d)
    return _even(rng, d, count, filled, (max(side, 2.5),) * d, boundary)


def _few_in_a_box(rng, d):
    return _few(rng, d, "wall")


def _gradient(rng, d):
    """Plates whose temperatures differ by a factor of two to twenty."""
    count, filled = int(_log(rng, 60, 400)), _log(rng, 0.002, 0.15)
    side = (count * gp.theory.particle_volume(d) / filled) ** (1.0 / d)
    last = "xyz"[d - 1]
    faces = {f"{last}_low": gp.Thermal(1.0), f"{last}_high": gp.Thermal(_log(rng, 2.0, 20.0))}
    return _even(
        rng, d, count, filled, (side,) * d, ("periodic",) * (d - 1) + ("wall",), faces=faces
    )  # fmt: skip


def _granular_column(rng, d):
    """Inelastic particles on a hot floor."""
    scale = _log(rng, 5.0, 30.0)
    parts = _pulled(rng, d, int(_log(rng, 30, 250)), 12.0 * scale, _log(rng, 0.003, 0.08), 1.0 / scale, scale)
    law = gp.Restitution(normal=float(rng.uniform(0.9, 0.99)))
    return gp.Scene(**parts, restitution=law, faces={f"{'xyz'[d - 1]}_low": gp.Thermal(1.0)})


_MAKERS = {
    "column": _column,
    "falling": _falling,
    "stratified": _stratified,
    "slit": _slit,
    "few": _few,
    "few in a box": _few_in_a_box,
    "gradient": _gradient,
    "granular column": _granular_column,
}
