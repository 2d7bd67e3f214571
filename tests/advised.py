"""Random scenes with an observable and an accuracy, and whether advice on them keeps its promise.

    python tests/advised.py FOLDER FIRST LAST [uneven]

judges the scenes from FIRST to before LAST: each result is kept in FOLDER, and none that is there is judged
again, so that several processes can share the scenes. Without FIRST and LAST it summarises what is there.
With `uneven` they are those of `uneven`: columns, slits, few particles. The reference of one that keeps the
energy of its start begins with the same start: by how much others differ, advice states apart.
"""

import json
import math
import sys
import time
import warnings
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import uneven

import gaspart as gp
from gaspart.accuracy.conditions import keeps_energy
from gaspart.accuracy.pilot import speed_of
from gaspart.accuracy.plan import plan
from gaspart.accuracy.target import Target
from gaspart.analysis import observables
from gaspart.analysis.measuring import measure
from gaspart.errors import SceneError
from gaspart.state.initial import initial_state

ANYWHERE = ("collision_rate", "speeds", "density", "temperature", "vacf", "msd")
OF_ONE_FLUID = ("Z", "D", "rdf", "structure_factor", "chemical_potential", "order", "shear_viscosity")
OF_ONE_FLUID += ("bulk_viscosity", "thermal_conductivity", "pressure_tensor")
OF_TWO_FLUIDS = ("Z", "D", "pair_rates", "contact_values", "mutual_diffusion", "shear_viscosity")
OBSERVABLES = {
    "walls": ("pressure", *ANYWHERE),
    "thermal": ("pressure", *ANYWHERE),
    "gravity": ("pressure", *ANYWHERE),
    "mixture": (*OF_TWO_FLUIDS, "collision_rate"),
    "driven": ("rdf", "structure_factor", *ANYWHERE),
    "fluid": (*OF_ONE_FLUID, *ANYWHERE),
    "plate": ("pressure", *ANYWHERE),
    "piston": ("collision_rate", "speeds", "vacf"),
    "vibrated": ("collision_rate", "density", "temperature"),
    "sliding": ("pressure", *ANYWHERE),
    "sheared": ("shear_viscosity", "pressure_tensor", "collision_rate"),
}
"""Those of each kind of scene, in turn."""
COARSE = {"D": 2.0, "mutual_diffusion": 3.0, "shear_viscosity": 4.0, "bulk_viscosity": 5.0}
COARSE |= {"thermal_conductivity": 4.0, "density": 4.0, "temperature": 3.0, "structure_factor": 4.0}
COARSE |= {"contact_values": 2.0, "vacf": 2.0, "msd": 2.0, "chemical_potential": 2.0, "rdf": 4.0}
"""By how much the accuracies of those that take longer are coarser."""
PILOT_SECONDS = 1.0
LONGER = 10
MOST_SECONDS = 20.0
"""How many times as long as the advised run the one that judges it is, and its processor time, above which it
is shorter, down to three times as long."""
MOST_FRAMES = 2560
"""Of the run that judges, where its frames need not be those of the other one."""
LEAST_REACHED, COSTS_MORE = 0.93, 1.5
"""The part of the scenes whose accuracy is reached, at least, and the cost over the best one's, at most."""


def scene(number):
    """A random scene, an observable and an accuracy."""
    rng = np.random.default_rng([2026, number])
    kind = list(OBSERVABLES)[number % len(OBSERVABLES)]
    choice = OBSERVABLES[kind]
    observable = choice[(number // len(OBSERVABLES)) % len(choice)]
    flat = kind in ("plate", "piston") or (observable not in ("D", "mutual_diffusion") and rng.random() < 0.5)
    dimension = 2 if flat else 3
    fraction = float(np.exp(rng.uniform(math.log(1e-3), math.log(0.3))))
    count = int(rng.integers(50, 400))
    side = (count * gp.theory.particle_volume(dimension) / fraction) ** (1.0 / dimension)
    species = [gp.Species(count, 0.5, temperature=1.0, exact_temperature=True)]
    boundary, last = "wall", "xyz"[dimension - 1]
    options = {}
    if kind == "thermal":
        options["faces"] = {"x_low": gp.Thermal(1.0), "x_high": gp.Thermal(float(rng.uniform(1.0, 3.0)))}
    if kind == "gravity":
        options["gravity"] = (0.0,) * (dimension - 1) + (-float(rng.uniform(0.2, 2.0)) / side,)
    if kind in ("mixture", "driven", "fluid", "sheared"):
        boundary = "periodic"
    if kind == "mixture":
        small = float(rng.uniform(0.2, 0.5))
        species.append(replace(species[0], count=max(20, count // 2), radius=small, mass=0.5))
    if kind == "driven":
        options["restitution"] = gp.Restitution(normal=float(rng.uniform(0.8, 0.95)))
        options["thermostat"] = gp.Thermostat(power=1.0, interval=0.1)
    if kind == "plate":
        options["walls"] = [gp.Wall((0.4 * side, 0.5 * side), (0.6 * side, 0.5 * side))]
    if kind == "piston":
        options["faces"] = {"y_high": gp.Piston(mass=50.0, pressure=count / side**2)}
    if kind == "vibrated":
        options["gravity"] = (0.0,) * (dimension - 1) + (-2.0 / side,)
        options["restitution"] = gp.Restitution(normal=float(rng.uniform(0.8, 0.95)))
        options["faces"] = {f"{last}_low": gp.Vibrating(amplitude=0.5, period=1.0)}
    if kind == "sliding":
        boundary = ("periodic",) * (dimension - 1) + ("wall",)
        along = (float(rng.uniform(0.2, 1.0)),) + (0.0,) * (dimension - 1)
        options["faces"] = {f"{last}_low": gp.Thermal(1.0), f"{last}_high": gp.Thermal(1.0, velocity=along)}
    if kind == "sheared":
        options["restitution"] = gp.Restitution(normal=float(rng.uniform(0.8, 0.95)))
        rate = float(gp.theory.collision_rate(fraction, dimension)) * float(rng.uniform(0.1, 0.5))
        options["faces"] = {"y_high": gp.LeesEdwards(rate)}
    made = gp.Scene(gp.Container((side,) * dimension, boundary=boundary), species, **options)
    accuracy = COARSE.get(observable, 1.0) * float(np.exp(rng.uniform(math.log(0.02), math.log(0.1))))
    return kind, made, observable, min(accuracy, 0.5)


def difference(found, truth, face="", places=True):
    """Relative difference, as the accuracy of a pilot is defined: of a face, of the worst face or component
    by its error, or of the norms of a curve, at the places that both have, and the pilot."""
    along = found.estimate.dims[-1] if found.estimate.ndim else None
    if face:
        mine, exact = (one.estimate.sel({along: face}) for one in (found, truth))
        return float(abs(mine / exact - 1.0))
    if along == "lag":
        mine, its = found["lag"].values, truth["lag"].values
        near = np.clip(np.searchsorted(its, mine - 1e-6 * its[1]), 0, its.size - 1)
        shared = np.abs(its[near] - mine) < 1e-3 * its[1]
        value, exact = found.estimate.values[shared], truth.estimate.values[near[shared]]
    elif along is not None and found[along].dtype.kind not in "US":
        value = found.estimate.values
        exact = np.interp(found[along].values, truth[along].values, truth.estimate.values)
    else:
        value, exact = np.asarray(found.estimate, float), np.asarray(truth.estimate, float)
    if not value.ndim:
        return float(abs(value / exact - 1.0))
    if "component" in found.coords:  # those of shear vanish: relative to the others, the worst of all
        return float(np.abs(value - exact).max() / np.sqrt(np.mean(exact**2)))
    if found[along].dtype.kind in "US":
        worst = int(np.argmax(np.asarray(found.error) / np.abs(value)))
        return float(abs(value.flat[worst] / exact.flat[worst] - 1.0))
    known = np.isfinite(value) & np.isfinite(exact) & places
    if value.shape == truth.error.shape:  # bins that hardly any particle visits have no error
        known &= np.isfinite(found.error.values) & np.isfinite(truth.error.values)
    return float(np.sqrt(np.mean((value - exact)[known] ** 2) / np.mean(exact[known] ** 2)))


def judged(number, folder, make=scene):
    """What advice promised for a scene and what its run kept, or why there is no advice."""
    kind, gas, observable, accuracy = make(number)
    result = {"number": number, "kind": kind, "dimension": gas.dimension, "observable": observable}
    result["accuracy"] = accuracy
    start = time.process_time()
    try:
        made = _advice(gas, observable, accuracy)
    except SceneError as error:
        return result | {"refused": str(error)}
    try:
        return (
            result
            | _kept(number, gas, observable, accuracy, made, folder)
            | {"seconds": time.process_time() - start}
        )
    except SceneError as error:
        return result | {"reached": False, "cost": made[1]["ratio"], "failed": str(error)}


def _kept(number, gas, observable, accuracy, made, folder):
    """What the advised run kept, with its replicas, by one that is longer."""
    recipe, costs = made
    observable, _, face = observable.partition(":")
    result = {"stated": costs["stated"], "promised": costs["promised"]}
    asked = {"duration": recipe.duration}
    if recipe.until:
        asked = {"until": recipe.until.accuracies, "at_most": recipe.until.at_most}
    more = {"correlations": recipe.correlations, "pairs": recipe.pairs}
    same = {"initial": initial_state(gas, (7, number, 0))} if gas.gravity and keeps_energy(gas) else {}
    interval = recipe.sample_interval
    more |= {"displacements": recipe.displacements, "replicas": costs["replicas"]}
    run = gp.run(
        gas, recipe.engine, (7, number), sample_interval=interval, path=folder / "advised.nc", **asked, **more
    )
    paths = gp.replica_paths(run, more.pop("replicas"))
    with gp.open_trajectory(paths[0]) as data:
        duration, frames = len(paths) * float(data["time"][-1]), len(paths) * (data.sizes["frame"] - 1)
        found = measure(data, observable)
    if len(paths) > 1:
        found = gp.analysis.replicas(observable, paths)
    if "lag" not in found.coords and not _of_structure(observable) and not recipe.correlations:
        interval *= math.ceil(costs["longer"] * frames / MOST_FRAMES)
    path = folder / "longer.nc"
    longest = round(costs["longer"] * duration / interval) * interval
    kept = {"displacements": True, **more, **same}
    gp.run(gas, gp.EventDriven(), (8, number), longest, interval, path=path, **kept)
    with gp.open_trajectory(path) as data:
        truth = _of_longer(observable, data)
    off = difference(found, truth, face, costs.get("places", True))
    if recipe.until and costs["predicted"]:
        result["longer"] = duration / costs["predicted"]
    return result | {
        "engine": recipe.engine.name,
        "off": off,
        "reached": bool(off <= 1.96 * accuracy),
        "cost": costs["ratio"],
    }


def _of_structure(observable):
    """Whether it is of the positions of particles relative to each other, in frames of a limited number."""
    return observables.OBSERVABLES[observable].samples == "structure"


def _of_longer(observable, data):
    """An observable of the longer run; what is of a limited number of frames, from ten parts of them."""
    if not _of_structure(observable):
        return measure(data, observable)
    parts = np.array_split(np.arange(data.sizes["frame"] // 4, data.sizes["frame"]), LONGER)
    found = [
        measure(data.isel(frame=slice(part[0], part[-1] + 1)), observable, start=float(data["time"][part[0]]))
        for part in parts
    ]
    whole = found[0].copy()
    whole[whole.attrs["quantity"]] = sum(one.estimate for one in found) / len(found)
    return whole


def _advice(gas, observable, accuracy):
    """The advised run, and its cost by speeds measured again over that of the cheapest candidate."""
    made = plan(gas, observable, accuracy, pilot_seconds=PILOT_SECONDS)
    near = [one for one in made.options if one.error <= accuracy * 1.001]
    near = [one for one in near if one.seconds < 4.0 * made.best.seconds] or [made.best]
    again = [_cost(gas, one.engine, observable, one.duration) if len(near) > 1 else 1.0 for one in near]
    ratio = again[near.index(made.best)] / min(again)
    stated = {"stated": made.best.error, "promised": made.affordable}
    longer = float(np.clip(MOST_SECONDS / made.best.seconds, 3.0, LONGER))
    costs = {"ratio": ratio, "predicted": made.best.duration, "replicas": made.replicas, "longer": longer}
    if observable == "temperature" and made.points[0] < made.points[1]:
        pilot = max((one for one in made.pilots if one.measured), key=lambda one: one.component.points)
        costs["places"] = np.isfinite(measure(pilot.path, observable).estimate.values)
    return made.recipe, costs | stated


def _cost(gas, engine, observable, duration):
    """Processor seconds of a run, by the faster of two measurements of the speed."""
    return duration * min(speed_of(Target.from_name(gas, observable), engine) for _ in range(2))


def results(folder, numbers, make=scene):
    """Those of some scenes, kept in a folder or judged now."""
    found = []
    folder.mkdir(parents=True, exist_ok=True)
    for number in numbers:
        path = folder / f"{number:03}.json"
        if not path.exists():
            with TemporaryDirectory() as place, warnings.catch_warnings():
                warnings.simplefilter("ignore")
                found_now = judged(number, Path(place), make)
            path.write_text(json.dumps(found_now), encoding="utf-8")
        found.append(json.loads(path.read_text(encoding="utf-8")))
        print(found[-1], flush=True)
    return found


def interval(successes, trials):
    """Clopper and Pearson's 95 % interval of a probability."""
    from scipy.stats import binomtest

    return tuple(binomtest(successes, trials).proportion_ci(0.95, "exact"))


if __name__ == "__main__":
    place = Path(sys.argv[1])
    if len(sys.argv) > 2:
        results(place, range(int(sys.argv[2]), int(sys.argv[3])), uneven.scene if sys.argv[4:] else scene)
    else:
        found = [json.loads(one.read_text(encoding="utf-8")) for one in sorted(place.glob("*.json"))]
        made = [one for one in found if "reached" in one]
        kept = sum(one["reached"] for one in made)
        print(len(found), "scenes", len(made), "advised", kept, "reached", interval(kept, len(made)))
        print("cost ratios", sorted(round(one["cost"], 2) for one in made))
        print("lengths over predicted", sorted(round(one["longer"], 2) for one in made if "longer" in one))
