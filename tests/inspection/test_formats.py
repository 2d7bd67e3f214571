"""Every field of every format: what a file states is what is judged, or it is refused in one line.

A gas is drawn at random, written in each format in any of the ways that its specification allows, and must be
the same when it is read. `docs/files.md` has the fields of each format; those refused are in
`test_refused_fields.py`.
"""

import netCDF4
import numpy as np
import pytest
from hypothesis import given, settings
from inspection.foreign import (
    ROWS,
    change,
    gas_of,
    gases,
    gsd_with,
    refused,
    write_gsd,
    write_netcdf,
    write_xyz,
    xyz,
)

import gaspart as gp
from gaspart.inspection.checks import judge_places
from gaspart.inspection.readers import read_frames


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


def overlaps(path, **settings):
    """The verdict on overlaps, its text, and the number of frames."""
    frames = read_frames(path, **settings)
    check = judge_places(frames)[0]
    return check.passed, check.text, len(frames.positions)


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


def test_what_was_never_filled_counts_as_absent(tmp_path):
    for name in ("velocities", "time"):
        write_netcdf(tmp_path / "a.nc", gas_of())
        change(tmp_path / "a.nc", name, netCDF4.default_fillvals["f4"])
        frames = read_frames(tmp_path / "a.nc")
        assert getattr(frames, name) is None and judge_places(frames)[0].passed


def test_types_that_change_places_show_another_order(tmp_path):
    write_netcdf(tmp_path / "a.nc", gas_of())
    with netCDF4.Dataset(tmp_path / "a.nc", "a") as file:
        file.renameVariable("id", "other")
    assert read_frames(tmp_path / "a.nc").count == 4
    change(tmp_path / "a.nc", "type", [[1, 1, 2, 2], [2, 1, 1, 2]])
    refused(tmp_path / "a.nc", "in another order in frame 1, and has no ids")


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
