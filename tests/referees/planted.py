"""Copies of the files with an error of 3 % in one of them, each of the kind that one referee must find."""

import json
import os
import shutil

import gsd.hoomd
import netCDF4
import numpy as np

ERROR = 0.03


def copied(folder, to, *changed):
    """A folder with the same files: links, but copies of those that will be changed."""
    to.mkdir()
    for path in folder.iterdir():
        (shutil.copy if path.name in changed else os.link)(path, to / path.name)
    return to


def netcdf(name, change):
    """Plant by `change(file)`, a function of a writable netCDF file."""

    def plant(folder, to):
        with netCDF4.Dataset(copied(folder, to, name) / name, "r+") as file:
            change(file)
        return to

    return plant


def scaled(variable, factor, particles=slice(None)):
    """The values of all frames times a factor; of some particles only."""

    def change(file):
        values = file[variable][:]
        values[:, particles] *= factor
        file[variable][:] = values

    return change


def more_energy(particles=slice(None), variable="velocities"):
    """3 % more kinetic energy of flight, or of spin, of some particles."""
    return scaled(variable, (1.0 + ERROR) ** 0.5, particles)


def farther(file):
    """A mean-squared displacement that is 3 % larger."""
    for variable in ("coordinates", "cell_lengths"):
        scaled(variable, (1.0 + ERROR) ** 0.5)(file)


def misplaced(file):
    """3 % of the particles are at random places."""
    values, rng = file["coordinates"][:], np.random.default_rng(1)
    some = rng.permutation(values.shape[1])[: round(ERROR * values.shape[1])]
    values[:, some] = file["cell_lengths"][0, 0] * rng.random((len(values), len(some), 3))
    file["coordinates"][:] = values


def fluctuating(folder, to):
    """Series whose fluctuations are 3 % larger."""
    names = sorted(path.name for path in folder.glob("series_*.nc"))
    copied(folder, to, *names)
    for name in names:
        with netCDF4.Dataset(to / name, "r+") as file:
            values = file["kinetic_energy"][:]
            file["kinetic_energy"][:] = values.mean() + (1.0 + ERROR) * (values - values.mean())
    return to


def longer_steps(file):
    """Times that are 3 % later."""
    file["time"][:] *= 1.0 + ERROR


def wider(file):
    """A container that is 3 % longer along one axis."""
    file["cell_lengths"][:, 2] *= 1.0 + ERROR


def one_astray(file):
    """One particle of each frame, 3 % of the container from its place."""
    file["coordinates"][:, 7, 1] += ERROR * file["cell_lengths"][0, 1]


def heavier(file):
    """The first species is 3 % heavier."""
    masses = file["mass"][:]
    file["mass"][:] = np.where(masses == masses[0], (1.0 + ERROR) * masses, masses)


def without_walls(file):
    """A container that states periodic faces where it has walls."""
    file.boundary = "periodic periodic periodic"


def gsd_box(folder, to, name="gas.gsd"):
    """A container that is 3 % longer along one axis, in a GSD file."""
    path = copied(folder, to, name) / name
    with gsd.hoomd.open(path) as file:
        frames = list(file)
    for frame in frames:
        frame.configuration.box = frame.configuration.box * np.array([1.0, 1.0 + ERROR, 1.0, 1.0, 1.0, 1.0])
    with gsd.hoomd.open(path, "w") as file:
        for frame in frames:
            file.append(frame)
    return to


def data_box(folder, to, name="gas.data"):
    """The same in a LAMMPS data file."""
    path = copied(folder, to, name) / name
    text = path.read_text()
    (line,) = (line for line in text.splitlines() if line.endswith("ylo yhi"))
    low, high, *names = line.split()
    path.write_text(text.replace(line, f"{low} {float(high) * (1.0 + ERROR)} {' '.join(names)}"))
    return to


def text(name, good, wrong):
    """Plant by another word in a text file."""

    def plant(folder, to):
        path = copied(folder, to, name) / name
        before = path.read_text()
        assert good in before, good
        path.write_text(before.replace(good, wrong))
        return to

    return plant


def number(which):
    """A measured pressure that is 3 % larger."""

    def plant(folder, to):
        path = copied(folder, to, "published.json") / "published.json"
        rows = json.loads(path.read_text())
        rows[which]["ours"] += ERROR * rows[which]["change"]
        path.write_text(json.dumps(rows))
        return to

    return plant


def stated(which, key):
    """A quantity of one row of dilute.json, which SPARTA reads there, is 3 % larger than in our run."""

    def plant(folder, to):
        path = copied(folder, to, "dilute.json") / "dilute.json"
        rows = json.loads(path.read_text())
        (row,) = (row for row in rows if row["name"] == which)
        row[key] *= 1.0 + ERROR
        path.write_text(json.dumps(rows))
        return to

    return plant


def wider_heaps(folder, to):
    """The box in which LAMMPS lets discs fall is 3 % wider than in our runs."""
    path = copied(folder, to, "heaps.json") / "heaps.json"
    heaps = json.loads(path.read_text())
    heaps["width"] *= 1.0 + ERROR
    path.write_text(json.dumps(heaps))
    return to
