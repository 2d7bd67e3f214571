"""Files of other programs: a gas, and how AMBER, LAMMPS, HOOMD and extended XYZ write it."""

from dataclasses import dataclass, field

import netCDF4
import numpy as np
import pytest
from hypothesis import strategies as st

import gaspart as gp
from gaspart.inspection.readers import read_frames

RNG = np.random.default_rng(7)


@dataclass
class Gas:
    """What is written: positions (T, N, 3) from a corner `origin` of a container of `lengths`, (T, 3)."""

    positions: np.ndarray
    velocities: np.ndarray | None
    time: np.ndarray | None
    radii: np.ndarray
    masses: np.ndarray | None
    lengths: np.ndarray
    origin: np.ndarray
    boundary: tuple[str, ...]
    order: np.ndarray
    ways: dict = field(default_factory=dict)

    def shuffled(self, values):
        """(T, N, ...) in the order in which each frame lists its particles."""
        values = np.broadcast_to(values, (*self.order.shape, *values.shape[2:]))
        return np.stack([frame[order] for frame, order in zip(values, self.order, strict=True)])


@st.composite
def gases(draw):
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    frames, count = draw(st.integers(1, 4)), draw(st.integers(2, 6))
    lengths = rng.uniform(4.0, 9.0, 3) * np.ones((frames, 1))
    if draw(st.booleans()):
        lengths = lengths * rng.uniform(0.9, 1.1, (frames, 1))
    origin = rng.uniform(-20.0, 20.0, 3) * np.ones((frames, 1)) * draw(st.booleans())
    if draw(st.booleans()):
        origin = origin + rng.uniform(-1.0, 1.0, (frames, 3))
    radii = rng.uniform(0.1, 0.6, (1 if draw(st.booleans()) else frames, count))
    time = np.cumsum(rng.uniform(0.5, 1.0, frames)) if draw(st.booleans()) else None
    mixed = draw(st.booleans())
    order = np.stack([rng.permutation(count) if mixed else np.arange(count) for _ in range(frames)])
    return Gas(
        positions=rng.random((frames, count, 3)) * lengths[:, None],
        velocities=rng.standard_normal((frames, count, 3)) if draw(st.booleans()) else None,
        time=time,
        radii=radii,
        masses=rng.uniform(1.0, 2.0, (1, count)) if draw(st.booleans()) else None,
        lengths=lengths,
        origin=origin,
        boundary=tuple(draw(st.sampled_from(["periodic", "wall"])) for _ in range(3)),
        order=order,
        ways={name: draw(st.booleans()) for name in ("double", "diameter", "momenta", "shapes")},
    )


def write_netcdf(path, gas):
    """As LAMMPS: a length of 0 where there are walls, time in steps of a scale factor, ids."""
    kind = "f8" if gas.ways["double"] else "f4"
    frames, count = gas.order.shape
    stated = gas.lengths * [word == "periodic" for word in gas.boundary]
    with netCDF4.Dataset(path, "w", format="NETCDF3_64BIT_OFFSET") as file:
        file.setncatts({"Conventions": "AMBER", "ConventionVersion": "1.0", "program": "LAMMPS"})
        for name, size in (("frame", None), ("atom", count), ("spatial", 3), ("cell_spatial", 3)):
            file.createDimension(name, size)

        def add(name, values, *dimensions, of=kind, **attributes):
            variable = file.createVariable(name, of, ("frame", *dimensions))
            variable.set_auto_scale(False)
            variable.setncatts(attributes)
            variable[:] = values

        add("cell_lengths", stated, "cell_spatial")
        add("cell_angles", np.full((frames, 3), 90.0), "cell_spatial")
        add("cell_origin", gas.origin, "cell_spatial")
        add("coordinates", gas.shuffled(gas.positions + gas.origin[:, None]), "atom", "spatial")
        add("id", gas.shuffled(np.arange(1, count + 1)[None]), "atom", of="i4")
        size = "diameter" if gas.ways["diameter"] else "radius"
        add(size, gas.shuffled(gas.radii) * (2.0 if size == "diameter" else 1.0), "atom")
        if gas.velocities is not None:
            add(
                "velocities",
                0.5 * gas.shuffled(gas.velocities),
                "atom",
                "spatial",
                scale_factor=np.float32(2),
            )
        if gas.masses is not None:
            add("mass", gas.shuffled(gas.masses), "atom")
        if gas.time is not None:
            add("time", gas.time / 0.25, scale_factor=np.float32(0.25))


def write_gsd(path, gas):
    """As HOOMD: the origin in the middle; sizes as diameters, or as shapes of a type for each particle."""
    import gsd.hoomd

    with gsd.hoomd.open(str(path), "w") as file:
        for n, radii in enumerate(np.broadcast_to(gas.radii, gas.order.shape)):
            frame = gsd.hoomd.Frame()
            frame.configuration.step = 100 * n + 7
            frame.configuration.box = [*gas.lengths[n], 0, 0, 0]
            frame.particles.N = len(radii)
            frame.particles.position = gas.positions[n] - 0.5 * gas.lengths[n]
            if gas.ways["shapes"]:
                frame.particles.types = [f"t{k}" for k in range(len(radii))]
                frame.particles.typeid = np.arange(len(radii))
                frame.particles.type_shapes = [{"type": "Sphere", "diameter": float(2.0 * r)} for r in radii]
            else:
                frame.particles.diameter = 2.0 * radii
            if gas.velocities is not None:
                frame.particles.velocity = gas.velocities[n]
            if gas.masses is not None:
                frame.particles.mass = gas.masses[0]
            file.append(frame)


def write_xyz(path, gas):
    """As OVITO, ASE and LAMMPS: everything in the comment and in columns; momenta instead of velocities."""
    names = {"id": "id:I:1", "pos": "pos:R:3", "radius": "radius:R:1"}
    momenta = gas.ways["momenta"] and gas.masses is not None
    if gas.masses is not None:
        names["mass"] = "masses:R:1"
    if gas.velocities is not None:
        names["velo"] = "momenta:R:3" if momenta else "velo:R:3"
    lines = []
    for n, order in enumerate(gas.order):
        cell = " ".join(f"{x:.9f}" for x in np.diag(gas.lengths[n]).ravel())
        origin = " ".join(f"{x:.9f}" for x in gas.origin[n])
        pbc = " ".join("T" if word == "periodic" else "F" for word in gas.boundary)
        comment = (
            f'Lattice="{cell}" Origin="{origin}" pbc="{pbc}" Properties={":".join(names.values())} e = 1'
        )
        if gas.time is not None:
            comment += f" Time={gas.time[n]:.9f}"
        lines += [str(len(order)), comment]
        for k in order:
            place = gas.positions[n, k] + gas.origin[n]
            row = [str(k + 1), *(f"{x:.9f}" for x in place)]
            row.append(f"{np.broadcast_to(gas.radii, gas.order.shape)[n, k]:.9f}")
            if gas.masses is not None:
                row.append(f"{gas.masses[0, k]:.9f}")
            if gas.velocities is not None:
                moving = gas.velocities[n, k] * (gas.masses[0, k] if momenta else 1.0)
                row += [f"{x:.9e}" for x in moving]
            lines.append("  ".join(row))
        lines += [""] * (n % 2)
    path.write_text("\n".join(lines) + "\n")


def gas_of(frames=2, count=4, **changes):
    """A gas on a lattice, whose particles do not touch."""
    rng = np.random.default_rng(3)
    grid = np.stack(np.meshgrid(*3 * [np.arange(2)], indexing="ij"), axis=-1).reshape(-1, 3)[:count]
    places = 1.0 + 3.0 * grid + 0.1 * rng.random((frames, count, 3))
    fields = {
        "positions": places,
        "velocities": rng.standard_normal((frames, count, 3)),
        "time": np.arange(1.0, frames + 1.0),
        "radii": np.full((1, count), 0.45),
        "masses": None,
        "lengths": np.full((frames, 3), 8.0),
        "origin": np.zeros((frames, 3)),
        "boundary": ("periodic",) * 3,
        "order": np.broadcast_to(np.arange(count), (frames, count)),
        "ways": dict.fromkeys(("double", "diameter", "momenta", "shapes"), False),
    }
    return Gas(**{**fields, **changes})


def xyz(path, *frames, lattice=8.0, more=""):
    """An extended XYZ file of frames of rows."""
    cell = " ".join(f"{x:.1f}" for x in np.diag(np.broadcast_to(lattice, 3)).ravel())
    text = ""
    for rows in frames:
        text += f'{len(rows)}\nLattice="{cell}" Properties=species:S:1:pos:R:3 {more}\n'
        text += "".join(f"A {row}\n" for row in rows)
    path.write_text(text)
    return path


def change(path, name, values=None, **attributes):
    """Set a variable of a netCDF file, of a value for each frame and particle or for each frame."""
    values = np.asarray(values, dtype=np.int32) if isinstance(np.ravel(values)[0], np.int64) else values
    with netCDF4.Dataset(path, "a") as file:
        file.setncatts(attributes)
        if name not in file.variables:
            dimensions = ("frame", "atom") if np.ndim(values) == 2 else ("frame",)
            file.createVariable(name, np.asarray(values).dtype, dimensions)
        if values is not None:
            file[name].set_auto_scale(False)
            file[name][...] = values


def unfill(path, name):
    with netCDF4.Dataset(path, "a") as file:
        file[name].set_auto_scale(False)
        file[name][1, 2:] = netCDF4.default_fillvals["f4"]


def refused(path, rule, **settings):
    with pytest.raises(gp.SceneError, match=rule) as error:
        read_frames(path, **settings)
    assert "\n" not in str(error.value) and path.name in str(error.value)


def gsd_with(path, **fields):
    """The GSD file of a gas with changed fields, such as particles__mass; a list has one of each frame."""
    import gsd.hoomd

    write_gsd(path, gas_of())
    with gsd.hoomd.open(str(path), "r") as file:
        frames = list(file)
    with gsd.hoomd.open(str(path), "w") as file:
        for n, frame in enumerate(frames):
            for key, value in fields.items():
                part, name = key.split("__")
                setattr(getattr(frame, part), name, value[n] if isinstance(value, list) else value)
            file.append(frame)


ROWS = ["1 1 1", "4 4 4"]
