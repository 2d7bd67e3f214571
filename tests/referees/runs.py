"""The runs that the referees judge, and what gaspart says of them: files in a folder, two runs at a time.

`thermal.nc`, `rough.nc`, `piston_low.nc`, `piston_high.nc`: gases in contact with thermal faces;
`series_*.nc`: long series of a small one; `gas.nc`, `gas.gsd`, `gas.data`: a periodic gas in every format
that is written; `reader_*`: scenes whose files readers can take for others, and `readers.npz` what gaspart
reads in them. `stated.json` has what the scenes state and gaspart's numbers, `gas.npz` what gaspart reads
and measures in `gas.nc`, `dilute.json` gases of the DSMC engine, `heaps.json` discs at rest, `published.json`
the comparison with published numbers.
"""

import json
import shutil
import sys
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

import dilute_runs
import numpy as np
from heap_runs import heaps
from published_runs import PUBLISHED, compared

import gaspart as gp
from gaspart.analysis.statistics import correlated_mean

SERIES = 16
"""Number of long series: their scatter gives the uncertainty of a ratio of standard errors, some 0.6 %."""
DROPPED = 200
"""Frames at the start of a run that no referee reads: a hundred collisions of each particle and more."""
SIDE = 8.0
PRESSURES = {"piston_low": 0.5, "piston_high": 0.57}
"""Of the piston. Their difference is near 2 k_B T over the scatter of the volume, as the referee advises."""


def between_thermal_faces(species, length=SIDE, restitution=None, **faces):
    """A scene, periodic along y and z, with thermal faces of temperature 1 unless `faces` has others."""
    faces = {"x_low": gp.Thermal(1.0), "x_high": gp.Thermal(1.0)} | faces
    lengths, boundary = (length, SIDE, SIDE), ("wall", "periodic", "periodic")
    container = gp.Container(lengths=lengths, boundary=boundary)
    return gp.Scene(container=container, species=species, faces=faces, restitution=restitution)


def spheres(count, radius=0.5, mass=1.0):
    return gp.Species(count=count, radius=radius, mass=mass, temperature=1.0)


def scenes():
    """Scene, seed, duration, interval and options of each run, by name."""
    rough = gp.Restitution(normal=1.0, tangential=1.0)
    small = between_thermal_faces([spheres(24)], 5.0)
    box = gp.Container(lengths=(12.0,) * 3, boundary="periodic")
    runs = {
        "thermal": (between_thermal_faces([spheres(80), spheres(80, 0.35, 0.25)]), 1, 8000.0, 2.0),
        "rough": (between_thermal_faces([spheres(64)], restitution=rough), 2, 6000.0, 2.5),
        "gas": (gp.Scene(container=box, species=[spheres(500)]), 5, 75.0, 0.25),
    }
    for seed, (name, pressure) in enumerate(PRESSURES.items(), 3):
        piston = gp.Piston(mass=10.0, pressure=pressure)
        runs[name] = (between_thermal_faces([spheres(160)], 60.0, x_high=piston), seed, 30000.0, 5.0)
    for number in range(SERIES):
        runs[f"series_{number:02}"] = (small, 100 + number, 40000.0, 0.4, {"follow": 1})
    return runs


def simulate(folder, name, scene, seed, duration, interval, options=None):
    """Write one run; returns its path."""
    path = folder / f"{name}.nc"
    return gp.run(scene, gp.EventDriven(), seed, duration, interval, path, **(options or {}))


def stated():
    """What the scenes of the runs between thermal faces state: the referees read it from no file."""
    runs = {name: scene for name, (scene, *_) in scenes().items()}
    found = {"temperature": 1.0, "dropped": DROPPED, "area": SIDE * SIDE, "pressures": PRESSURES}
    found["masses"] = [kind.mass for kind in runs["thermal"].species for _ in range(kind.count)]
    radius = runs["rough"].species[0].radius
    return found | {"moment_of_inertia": 0.4 * radius**2}  # of a uniform sphere of mass 1, gaspart's default


def standard_error(path):
    """That of the mean kinetic energy of a run."""
    with gp.open_trajectory(path) as data:
        return correlated_mean(data["kinetic_energy"].values[DROPPED:]).estimate.error


def reader_scenes():
    """A scene of each kind in which readers of files can go wrong, by name."""
    box = gp.Container(lengths=(16.0, 8.0, 8.0), boundary=("wall", "periodic", "periodic"))
    cube = gp.Container(lengths=(12.0,) * 3, boundary="periodic")
    walled = gp.Container(lengths=(12.0,) * 3, boundary="wall")
    plane = gp.Container(lengths=(20.0, 16.0), boundary="periodic")
    reservoirs = {face: gp.Open(activity=0.01, temperature=1.0) for face in ("x_low", "x_high")}
    return {
        "periodic": gp.Scene(container=cube, species=[spheres(200)]),
        "walls": gp.Scene(container=walled, species=[spheres(200)]),
        "discs": gp.Scene(container=plane, species=[spheres(100)]),
        "species": gp.Scene(container=cube, species=[spheres(100), spheres(80, 0.35, 0.25)]),
        "open": gp.Scene(container=box, species=[spheres(40, 0.25)], faces=reservoirs, centres_to_walls=True),
        "piston": gp.Scene(
            container=box, species=[spheres(100)], faces={"x_low": gp.Piston(mass=10.0, pressure=0.3)}
        ),
    }


def write_for_readers(folder):
    """The file of each of `reader_scenes` in every format, and readers.npz with what gaspart reads in it.

    pairs: number of those nearer than 1.5, by all pairs, with images along periodic axes only."""
    found = {}
    for name, scene in reader_scenes().items():
        path = simulate(folder, f"reader_{name}", scene, 7, 4.0, 0.5)
        for suffix in (".gsd", ".xyz"):
            gp.export(path, path.with_suffix(suffix), frame="all")
        gp.export(path, path.with_suffix(".data"), frame=-1)
        with gp.open_trajectory(path) as data:
            d = scene.dimension
            lengths = data["cell_lengths"].values
            values = {
                "energy": data["kinetic_energy"].values,
                "time": data["time"].values,
                "lengths": lengths,
            }
            values["origin"] = data["cell_origin"].values if "cell_origin" in data else 0.0 * lengths
            for key, variable in (("positions", "coordinates"), ("velocities", "velocities")):
                values[key] = np.pad(data[variable].values, [(0, 0), (0, 0), (0, 3 - d)])
        periodic = np.array([*scene.container.periodic, True][:3])
        counted = zip(values["positions"], lengths, strict=True)
        values["pairs"] = np.array([near_pairs(places, sides, periodic) for places, sides in counted])
        found |= {f"{name}_{key}": value for key, value in values.items()}
    np.savez(folder / "readers.npz", **found)


def near_pairs(positions, lengths, periodic):
    """Number of pairs nearer than 1.5."""
    places = positions[np.isfinite(positions).all(axis=1)].astype(float)
    apart = places[:, None] - places
    apart -= np.where(periodic, lengths * np.round(apart / lengths), 0.0)
    return int(np.triu((apart**2).sum(axis=2) < 1.5**2, 1).sum())


def measure_gas(folder):
    """gas.npz: what gaspart reads in gas.nc, and its g(r) and mean-squared displacement of all frames."""
    path = folder / "gas.nc"
    for suffix in (".gsd", ".data"):
        gp.export(path, folder / f"gas{suffix}", frame=-1)
    with gp.open_trajectory(path) as data:
        read = {
            "positions": data["coordinates"].values,
            "times": data["time"].values,
            "lengths": np.array(scenes()["gas"][0].container.lengths),
        }
    g = gp.analysis.rdf(path, bins=100, furthest=5.0, start=0.0)
    msd = gp.analysis.mean_squared_displacement(path, lags=60, start=0.0)
    np.savez(
        folder / "gas.npz",
        **read,
        distance=g["distance"].values,
        rdf=g["rdf"].values,
        msd=msd["mean_squared_displacement"].values,
    )


def main(folder):
    """All files, anew."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    with ProcessPoolExecutor(2) as pool:
        published = [pool.submit(compared, number, folder) for number in PUBLISHED]
        fallen = pool.submit(heaps)
        dilute = [pool.submit(*job) for job in dilute_runs.jobs()]
        runs = {name: pool.submit(partial(simulate, folder, name, *run)) for name, run in scenes().items()}
        errors = [standard_error(runs[name].result()) for name in sorted(runs) if name.startswith("series")]
        for run in runs.values():
            run.result()
        numbers, gases = ([job.result() for job in jobs] for jobs in (published, dilute))
    measure_gas(folder)
    write_for_readers(folder)
    (folder / "stated.json").write_text(json.dumps(stated() | {"standard_errors": errors}, indent=1))
    (folder / "heaps.json").write_text(json.dumps(fallen.result()))
    (folder / "dilute.json").write_text(json.dumps(gases, indent=1))
    (folder / "published.json").write_text(json.dumps(numbers, indent=1))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
