"""Every field of every format: what a file states is what is judged, or it is refused in one line.

A gas is drawn at random, written in each format in any of the ways that its specification allows, and must be
the same when it is read. `docs/formats.md` has the fields of each format; those refused are at the end.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path

import netCDF4
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import gaspart as gp
from gaspart.inspection import xyz_contents
from gaspart.inspection.checks import judge_places
from gaspart.inspection.netcdf_size import needed_bytes
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
        ways={name: draw(st.booleans()) for name in ("scaled", "double", "diameter", "momenta", "shapes")},
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
        places, name = gas.positions + gas.origin[:, None], "coordinates"
        if gas.ways["scaled"]:
            places, name = gas.positions / gas.lengths[:, None], "scaled_coordinates"
        add(name, gas.shuffled(places), "atom", "spatial")
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
                row += [f"{x:.9e}".replace("e", "D") for x in moving]
            lines.append("  ".join(row))
        lines += [""] * (n % 2)
    path.write_text("\n".join(lines) + "\n")


def agrees(frames, gas, atol):
    """Whether what was read is the gas."""
    steady = np.ptp(gas.lengths, axis=0).max() == 0.0
    sides = gas.lengths[:1] if steady else gas.lengths
    found = frames.lengths[None] if frames.lengths_by_frame is None else frames.lengths_by_frame
    assert frames.dimension == 3 and frames.periodic == tuple(word == "periodic" for word in gas.boundary)
    assert np.allclose(found, sides, rtol=1e-6)
    gap = frames.positions - gas.positions
    gap -= np.where(frames.periodic, found[:, None] * np.round(gap / found[:, None]), 0.0)
    assert np.abs(gap).max() < atol
    for n in range(len(gas.order)):
        one = frames.at(n)
        assert np.allclose(one.radii, gas.radii[min(n, len(gas.radii) - 1)], rtol=1e-6)
        assert np.allclose(one.lengths, gas.lengths[n], rtol=1e-6)
        assert np.array_equal(one.positions[0], frames.positions[n])
    assert (frames.velocities is None) == (gas.velocities is None)
    if gas.velocities is not None:
        assert np.allclose(frames.velocities, gas.velocities, atol=atol)
    if gas.masses is not None:
        assert np.allclose(frames.masses, gas.masses[0], rtol=1e-6)
    constant = (steady and len(gas.radii) == 1) or len(gas.order) == 1
    assert frames.plain == (constant and gas.masses is None)
    return True


def same_times(frames, time, atol):
    if time is None or (len(time) == 1 and frames.time is None):
        return frames.time is None
    return np.allclose(frames.time, time, atol=atol)


@settings(max_examples=40, deadline=None)
@given(gas=gases())
def test_netcdf(tmp_path_factory, gas):
    path = tmp_path_factory.mktemp("nc") / "a.nc"
    write_netcdf(path, gas)
    if "wall" in gas.boundary:
        with pytest.raises(gp.SceneError, match="--lengths"):
            read_frames(path)
        gas.lengths = np.broadcast_to(gas.lengths[0], gas.lengths.shape)
        rng = np.random.default_rng(1)
        gas.positions = rng.random(gas.positions.shape) * gas.lengths[0]
        write_netcdf(path, gas)
        frames = read_frames(path, lengths=tuple(gas.lengths[0]))
    else:
        frames = read_frames(path)
    assert agrees(frames, gas, 1e-5) and same_times(frames, gas.time, 1e-5)
    assert frames.resolution < 1e-5


@settings(max_examples=40, deadline=None)
@given(gas=gases())
def test_gsd(tmp_path_factory, gas):
    pytest.importorskip("gsd")
    path = tmp_path_factory.mktemp("gsd") / "a.gsd"
    gas.boundary = ("periodic",) * 3
    write_gsd(path, gas)
    frames = read_frames(path, time_step=0.01)
    assert agrees(frames, gas, 1e-5) and read_frames(path).time is None
    assert same_times(frames, 0.01 * (100.0 * np.arange(len(gas.order)) + 7.0), 1e-9)


@settings(max_examples=40, deadline=None)
@given(gas=gases())
def test_xyz(tmp_path_factory, gas):
    path = tmp_path_factory.mktemp("xyz") / "a.xyz"
    write_xyz(path, gas)
    frames = read_frames(path)
    assert agrees(frames, gas, 1e-8) and same_times(frames, gas.time, 1e-8)
    assert 1e-10 < frames.resolution < 1e-7


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
        "ways": dict.fromkeys(("scaled", "double", "diameter", "momenta", "shapes"), False),
    }
    return Gas(**{**fields, **changes})


def overlaps(path, **settings):
    """The verdict on overlaps, its text, and the number of frames."""
    frames = read_frames(path, **settings)
    check = judge_places(frames)[0]
    return check.passed, check.text, len(frames.positions)


def xyz(path, *frames, lattice=8.0, more=""):
    """An extended XYZ file of frames of rows."""
    cell = " ".join(f"{x:.1f}" for x in np.diag(np.broadcast_to(lattice, 3)).ravel())
    text = ""
    for rows in frames:
        text += f'{len(rows)}\nLattice="{cell}" Properties=species:S:1:pos:R:3 {more}\n'
        text += "".join(f"A {row}\n" for row in rows)
    path.write_text(text)
    return path


def test_an_overlap_in_the_last_frame_is_found_behind_a_blank_line(tmp_path):
    path = xyz(tmp_path / "a.xyz", ["1 1 1", "4 4 4"], ["1 1 1", "1 1 1.2"])
    path.write_text(path.read_text().replace("4 4 4\n", "4 4 4\n\n"))
    passed, text, frames = overlaps(path, radius=0.5)
    assert (passed, frames) == (False, 2) and "0.8 of a contact distance, in frame 1" in text


def test_diameters_and_boxes_of_each_frame_are_used(tmp_path):
    grows = gas_of(radii=np.array([[0.2] * 4, [1.6] * 4]))
    shrinks = gas_of(lengths=np.array([[8.0] * 3, [8.0, 3.9, 8.0]]))
    for gas in (grows, shrinks):
        for name, write in (("a.nc", write_netcdf), ("a.gsd", write_gsd), ("a.xyz", write_xyz)):
            write(tmp_path / name, gas)
            passed, text, _ = overlaps(tmp_path / name)
            assert passed is False and "in frame 1" in text, (name, text)


def test_axes_that_are_not_periodic_have_no_images(tmp_path):
    rows = ["0.3 4 4", "7.7 4 4", "4 4 4"]
    assert overlaps(xyz(tmp_path / "a.xyz", rows), radius=0.5)[0] is False
    for pbc in ("F F F", "F T T"):
        path = xyz(tmp_path / "a.xyz", rows, more=f'pbc="{pbc}"')
        assert overlaps(path, radius=0.5)[0] is True
    assert overlaps(path, radius=0.5, boundary="periodic")[0] is False
    assert read_frames(path, 0.5, boundary=("wall", "periodic", "wall")).periodic == (False, True, False)


def test_short_numbers_do_not_make_a_file_coarse(tmp_path):
    rows = ["0 0 0", "4.12345678 4.00000001 4.5", "4.12345678 4.00000001 5.41", "2.5 2.25 6.0"]
    passed, text, _ = overlaps(xyz(tmp_path / "a.xyz", rows), radius=0.5)
    assert passed is False and "0.09 of a contact distance" in text and "up to 1e-07" in text
    rounded = ["0.00 1.00 1.00", "0.99 1.00 1.00"]
    assert overlaps(xyz(tmp_path / "a.xyz", rounded), radius=0.5)[0] is True


def test_times_in_single_precision_are_even(tmp_path):
    late = 5000.0 + 0.2 * np.arange(400)
    gas = gas_of(frames=400, time=late)
    for kind in ("f4", "f8"):
        write_netcdf(tmp_path / "a.nc", gas)
        with netCDF4.Dataset(tmp_path / "a.nc", "a") as file:
            file.renameVariable("time", "other")
            file.createVariable("time", kind, ("frame",))[:] = late
        time = read_frames(tmp_path / "a.nc").time
        assert np.ptp(np.diff(time)) < 1e-9 and abs(time - late).max() < 3e-4
    uneven = late + np.where(np.arange(400) == 7, 0.01, 0.0)
    with netCDF4.Dataset(tmp_path / "a.nc", "a") as file:
        file["time"][:] = uneven
    assert np.array_equal(read_frames(tmp_path / "a.nc").time, uneven)


def test_a_time_step_gives_times_to_every_format(tmp_path):
    for time in (None, np.full(2, 3.0), np.array([2.0, 1.0])):
        write_netcdf(tmp_path / "a.nc", gas_of(time=time))
        write_xyz(tmp_path / "a.xyz", gas_of(time=time))
        for name in ("a.nc", "a.xyz"):
            assert list(read_frames(tmp_path / name, time_step=0.5).time) == [0.0, 0.5]
            if time is not None and time[0] > time[1]:
                with pytest.raises(gp.SceneError, match="frame 1 that is not later.*--time-step"):
                    read_frames(tmp_path / name)
            else:
                assert read_frames(tmp_path / name).time is None


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


def test_what_was_never_filled_counts_as_absent(tmp_path):
    for name in ("velocities", "time"):
        write_netcdf(tmp_path / "a.nc", gas_of())
        change(tmp_path / "a.nc", name, netCDF4.default_fillvals["f4"])
        frames = read_frames(tmp_path / "a.nc")
        assert getattr(frames, name) is None and judge_places(frames)[0].passed


REFUSED = {
    "cell_angles": (lambda path: change(path, "cell_angles", 60.0), "a tilted cell"),
    "a part of the coordinates": (lambda path: unfill(path, "coordinates"), "a changing number"),
    "a part of the velocities": (lambda path: unfill(path, "velocities"), "velocities that are not finite"),
    "id, other": (
        lambda path: change(path, "id", [[1, 2, 3, 4], [1, 2, 3, 9]]),
        "other particles in frame 1",
    ),
    "id, twice": (lambda path: change(path, "id", [[1, 2, 3, 3], [1, 2, 3, 3]]), "the same id"),
    "radius": (lambda path: change(path, "radius", -1.0), "radius = -1.0: must be positive"),
    "temp0": (lambda path: change(path, "temp0", [300.0, 310.0]), "replica exchange"),
    "remd_indices": (lambda path: change(path, "remd_indices", [1, 2]), "replica exchange"),
    "Conventions": (lambda path: change(path, "id", Conventions="CF-1.8"), "must be AMBER"),
    "ConventionVersion": (lambda path: change(path, "id", ConventionVersion="2.0"), "must be 1.0"),
    "cell_lengths": (lambda path: change(path, "cell_lengths", -8.0), "must be positive"),
}


def unfill(path, name):
    with netCDF4.Dataset(path, "a") as file:
        file[name].set_auto_scale(False)
        file[name][1, 2:] = netCDF4.default_fillvals["f4"]


@pytest.mark.parametrize("name", REFUSED)
def test_refused_in_netcdf(tmp_path, name):
    make, rule = REFUSED[name]
    write_netcdf(tmp_path / "a.nc", gas_of())
    make(tmp_path / "a.nc")
    refused(tmp_path / "a.nc", rule)


def refused(path, rule, **settings):
    with pytest.raises(gp.SceneError, match=rule) as error:
        read_frames(path, **settings)
    assert "\n" not in str(error.value) and path.name in str(error.value)


def test_refused_in_netcdf_of_other_units(tmp_path):
    write_netcdf(tmp_path / "a.nc", gas_of())
    with netCDF4.Dataset(tmp_path / "a.nc", "a") as file:
        file["velocities"].units, file["time"].units = "Bohr/atomic time units", "femtoseconds"
    refused(tmp_path / "a.nc", "units .* of time differ.*--time-step")
    assert read_frames(tmp_path / "a.nc", time_step=0.1).time is not None


def test_types_that_change_places_show_another_order(tmp_path):
    write_netcdf(tmp_path / "a.nc", gas_of())
    with netCDF4.Dataset(tmp_path / "a.nc", "a") as file:
        file.renameVariable("id", "other")
    assert read_frames(tmp_path / "a.nc").count == 4
    change(tmp_path / "a.nc", "type", [[1, 1, 2, 2], [2, 1, 1, 2]])
    refused(tmp_path / "a.nc", "in another order in frame 1, and has no ids")


SPHERE = {"type": "Sphere", "diameter": 1.5}


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


@pytest.mark.parametrize(
    ("fields", "rule"),
    [
        ({"configuration__box": np.array([8.0, 8, 8, 0.5, 0, 0])}, "a tilted box"),
        ({"configuration__box": [np.array([8.0] * 3 + [0] * 3), np.array([8.0] * 4 + [0] * 2)]}, "tilted"),
        ({"configuration__dimensions": [3, 2]}, "changes its number of dimensions"),
        ({"particles__diameter": None}, "radius = None: is not stated: give --radius"),
        ({"particles__diameter": np.array([1.0, -1.0, 1.0, 1.0])}, "must be positive"),
        ({"particles__body": np.zeros(4, int)}, "rigid bodies"),
        ({"particles__type_shapes": ({"type": "Ellipsoid", "a": 1, "b": 2, "c": 1},)}, "no spheres"),
        ({"particles__type_shapes": ({"type": "ConvexPolyhedron", "vertices": []},)}, "no spheres"),
        (
            {"particles__type_shapes": (SPHERE,), "particles__diameter": np.full(4, 2.0)},
            "other sizes .*--radius",
        ),
    ],
)  # fmt: skip
def test_refused_in_gsd(tmp_path, fields, rule):
    pytest.importorskip("gsd")
    gsd_with(tmp_path / "a.gsd", **fields)
    refused(tmp_path / "a.gsd", rule)


def test_a_gsd_file_of_a_changing_number_is_refused(tmp_path):
    hoomd = pytest.importorskip("gsd.hoomd")
    with hoomd.open(str(tmp_path / "a.gsd"), "w") as file:
        for count in (4, 3):
            frame = hoomd.Frame()
            frame.particles.N, frame.configuration.box = count, [8, 8, 8, 0, 0, 0]
            frame.particles.position = np.zeros((count, 3))
            file.append(frame)
    refused(tmp_path / "a.gsd", "3 particles in frame 1 and 4 in frame 0: a changing number")


@pytest.mark.parametrize(
    "fields",
    [
        {"particles__charge": np.ones(4)},
        {"bonds__N": 1, "bonds__typeid": [[0], [0]], "bonds__group": np.array([[0, 1]])},
        {"constraints__N": 1, "constraints__group": np.array([[0, 1]]), "constraints__value": np.ones(1)},
        {"particles__mass": np.array([1.0, 2.0, 1.0, 1.0])},
    ],
)
def test_what_is_more_than_elastic_contacts_in_gsd(tmp_path, fields):
    pytest.importorskip("gsd")
    gsd_with(tmp_path / "a.gsd", **fields)
    frames = read_frames(tmp_path / "a.gsd", radius=0.5)
    assert not frames.plain and judge_places(frames)[0].passed


def test_spheres_of_a_type_and_the_default_diameter(tmp_path):
    pytest.importorskip("gsd")
    shape = ({"type": "Ellipsoid", "a": 0.75, "b": 0.75, "c": 0.75},)
    gsd_with(tmp_path / "a.gsd", particles__diameter=None, particles__type_shapes=shape)
    assert read_frames(tmp_path / "a.gsd").diameter == 1.5
    gsd_with(tmp_path / "a.gsd", particles__diameter=[np.ones(4), np.full(4, 1.5)])
    frames = read_frames(tmp_path / "a.gsd")  # a default value, of a file that states diameters elsewhere
    assert frames.at(0).diameter == 1.0 and frames.at(1).diameter == 1.5


ROWS = ["1 1 1", "4 4 4"]


@pytest.mark.parametrize(
    ("old", "new", "rule"),
    [
        ("8.0 0.0 0.0 0.0", "8.0 0.0 0.0 1.0", "Lattice = .*a tilted box"),
        ("8.0 0.0 0.0 0.0", "8.0 0.0 0.0", "lattice = .*must be 3 or 9 numbers"),
        ("pos:R:3", "pos:R:3:", "Properties = .*must be of the form"),
        ("pos:R:3", "forces:R:3", "must have pos"),
        ("pos:R:3", "pos:R:3:radius:R:1", "has a line of 4 columns in frame 0, where 5"),
        ("pos:R:3", "pos:R:2", "has a line of 4 columns in frame 0, where 3"),
        ("species:S:1", 'pbc="T T" species:S:1', "pbc = .*must be T or F"),
        ("species:S:1", 'Origin="1 2" species:S:1', "origin = .*must be 3 numbers"),
        ("species:S:1", 'time=soon species:S:1', "time = 'soon': must be 1 numbers"),
        ("A 4 4 4", "A 4 4 nan", "positions that are not finite"),
        ("A 4 4 4", "A 4 4 x", "cannot be read"),
        ("A 4 4 4\n", "", "is truncated: frame 0 has 1"),
        ("2\n", "-2\n", "is truncated: frame 0 has 0"),
    ],
)  # fmt: skip
def test_refused_in_xyz(tmp_path, old, new, rule):
    path = xyz(tmp_path / "a.xyz", ROWS)
    text = path.read_text()
    if old == "species:S:1":  # a key of the comment
        old, new = "Properties=species", new.replace("species:S:1", "Properties=species")
    assert old in text
    path.write_text(text.replace(old, new, 1))
    refused(path, rule, radius=0.5)


def test_frames_of_xyz_that_differ_are_refused(tmp_path):
    path = xyz(tmp_path / "a.xyz", ROWS, ["1 1 1"])
    refused(path, "has 1 particles in frame 1 and 2 in frame 0: a changing number", radius=0.5)
    path = xyz(tmp_path / "a.xyz", ROWS, ROWS)
    text = path.read_text()
    path.write_text(text[::-1].replace("3:R:sop", '"F F F"=cbp 3:R:sop', 1)[::-1])
    refused(path, "boundary in some frames only", radius=0.5)
    path.write_text(text[::-1].replace("1 1 1 A", "1 1 1 B", 1)[::-1])
    refused(path, "another order in frame 1", radius=0.5)


def test_charges_forces_and_fixed_atoms_in_xyz(tmp_path):
    for column, value in (("charge:R:1", "0.5"), ("forces:R:3", "0 1 0"), ("move_mask:L:1", "F")):
        path = tmp_path / "a.xyz"
        path.write_text(f'2\nLattice="8 8 8" Properties=pos:R:3:{column}\n1 1 1 {value}\n4 4 4 {value}\n')
        frames = read_frames(path, 0.5)
        assert not frames.plain and list(frames.lengths) == [8.0] * 3


def test_coplanar_particles_are_discs_only_if_they_move_in_a_plane(tmp_path):
    flat = ["1 1 4", "5 5 4"]
    path = xyz(tmp_path / "a.xyz", flat)
    assert read_frames(path, 0.5).dimension == 3
    assert read_frames(xyz(path, flat, lattice=(8.0, 8.0, 1.0)), 0.5).dimension == 2
    assert read_frames(xyz(path, flat, ["1 2 4", "5 6 4"]), 0.5).dimension == 2
    assert read_frames(path, 0.5, (8.0, 8.0, 8.0)).dimension == 3
    refused(xyz(path, ROWS), "must be 3 sides", radius=0.5, lengths=(8.0, 8.0))


@pytest.mark.parametrize("form", ["NETCDF3_CLASSIC", "NETCDF3_64BIT_OFFSET", "NETCDF3_64BIT_DATA", "NETCDF4"])
@pytest.mark.parametrize("alone", [True, False])
def test_a_truncated_netcdf_file_is_refused(tmp_path, form, alone):
    """The library reads zeros where a file of the version 3 ends too early."""
    path = tmp_path / "a.nc"
    with netCDF4.Dataset(path, "w", format=form) as file:
        file.setncatts({"Conventions": "AMBER", "ConventionVersion": "1.0", "note": "odd"})
        for name, size in (("frame", None), ("atom", 3), ("spatial", 3)):
            file.createDimension(name, size)
        file.createVariable("spatial", "S1", ("spatial",))[:] = list("xyz")
        file.createVariable("coordinates", "f4", ("frame", "atom", "spatial"))[:] = 1.0 + RNG.random(
            (5, 3, 3)
        )
        if not alone:
            file.createVariable("flag", "i1", ("frame", "atom"))[:] = np.ones((5, 3))
    size = path.stat().st_size
    needed = {True: size, False: size - 1}[alone]  # the last padding may be absent
    if form != "NETCDF4":
        with path.open("rb") as file:
            assert needed_bytes(file) == needed
    assert read_frames(path, 0.1, (8.0, 8.0, 8.0)).positions.shape == (5, 3, 3)
    for kept in (needed - 1, needed - 50, 40):
        path.write_bytes(path.read_bytes()[:kept])
        refused(path, "cannot be read" if form == "NETCDF4" or kept == 40 else "is truncated", radius=0.1)


def test_a_restart_file_is_a_frame(tmp_path):
    with netCDF4.Dataset(tmp_path / "a.nc", "w", format="NETCDF3_64BIT_OFFSET") as file:
        file.setncatts({"Conventions": "AMBERRESTART", "ConventionVersion": "1.0"})
        for name, size in (("atom", 2), ("spatial", 3), ("cell_spatial", 3)):
            file.createDimension(name, size)
        file.createVariable("coordinates", "f8", ("atom", "spatial"))[:] = [[1, 1, 1], [4, 4, 4]]
        file.createVariable("cell_lengths", "f8", ("cell_spatial",))[:] = 8.0
        file.createVariable("time", "f8", ())[...] = 3.0
    frames = read_frames(tmp_path / "a.nc", 0.5)
    assert list(frames.time) == [3.0] and len(frames.positions) == 1 and list(frames.lengths) == [8.0] * 3


AMBER = """
    Conventions ConventionVersion title application program programVersion spatial cell_spatial cell_angular
    time coordinates velocities forces cell_lengths cell_angles scale_factor units temp0 remd_indices
    remd_repidx remd_crdidx remd_values unwrapped_coordinates scaled_coordinates cell_origin radius diameter
    mass id type q
"""
"""Of AMBER's convention, and of LAMMPS in addition."""


def test_every_field_of_the_specifications_is_in_the_documentation():
    hoomd = pytest.importorskip("gsd.hoomd")
    text = (Path(__file__).parents[2] / "docs/formats.md").read_text(encoding="utf-8")
    sections = text.split("\n## ")[1:]
    named = [set(re.findall(r"`([^`]+)`", section)) for section in sections]
    frame = hoomd.Frame()
    schema = {f"configuration/{name}" for name in frame.configuration._default_value}
    schema |= {f"particles/{name}" for name in frame.particles._default_value}
    schema |= {"bonds", "angles", "dihedrals", "impropers", "constraints", "pairs", "log"}
    columns = {name for names in xyz_contents._NAMES.values() for name in names} - {"z"} | {"Z"}
    columns |= {"Lattice", "Properties", "pbc", "Origin", "Time"}
    for fields, found in zip((set(AMBER.split()), schema, columns), named, strict=True):
        assert fields <= found, fields - found
    rows = [line for section in sections for line in section.splitlines() if line.startswith("| ")]
    words = ("used", "refused", "not elastic", "no effect")
    assert not [row for row in rows if not any(word in row for word in (*words, "field", "---"))]
