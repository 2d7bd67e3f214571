"""What no reader takes from a file of another program is refused in one line."""

import netCDF4
import numpy as np
import pytest
from inspection.foreign import RNG, ROWS, change, gas_of, gsd_with, refused, unfill, write_netcdf, xyz

from gaspart.inspection.netcdf_contents import needed_bytes
from gaspart.inspection.readers import read_frames

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
    "Conventions": (lambda path: change(path, "id", Conventions="CF-1.8"), "must be AMBER"),
    "ConventionVersion": (lambda path: change(path, "id", ConventionVersion="2.0"), "must be 1.0"),
    "cell_lengths": (lambda path: change(path, "cell_lengths", -8.0), "must be positive"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused_in_netcdf(tmp_path, name):
    make, rule = REFUSED[name]
    write_netcdf(tmp_path / "a.nc", gas_of())
    make(tmp_path / "a.nc")
    refused(tmp_path / "a.nc", rule)


SPHERE = {"type": "Sphere", "diameter": 1.5}


@pytest.mark.parametrize(
    ("fields", "rule"),
    [
        ({"configuration__box": [np.array([8.0] * 3 + [0] * 3), np.array([8.0] * 4 + [0] * 2)]}, "tilted"),
        ({"configuration__dimensions": [3, 2]}, "changes its number of dimensions"),
        ({"particles__diameter": None}, "radius = None: is not stated: give --radius"),
        ({"particles__diameter": np.array([1.0, -1.0, 1.0, 1.0])}, "must be positive"),
        ({"particles__body": np.zeros(4, int)}, "rigid bodies"),
        ({"particles__type_shapes": ({"type": "Ellipsoid", "a": 1, "b": 2, "c": 1},)}, "no spheres"),
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
    ("old", "new", "rule"),
    [
        ("8.0 0.0 0.0 0.0", "8.0 0.0 0.0 1.0", "Lattice = .*a tilted box"),
        ("pos:R:3", "pos:R:3:", "Properties = .*must be of the form"),
        ("pos:R:3", "forces:R:3", "must have pos"),
        ("pos:R:3", "pos:R:3:radius:R:1", "has a line of 4 columns in frame 0, where 5"),
        ("species:S:1", 'pbc="T T" species:S:1', "pbc = .*must be T or F"),
        ("species:S:1", 'Origin="1 2" species:S:1', "origin = .*must be 3 numbers"),
        ("species:S:1", 'time=soon species:S:1', "time = 'soon': must be 1 numbers"),
        ("A 4 4 4", "A 4 4 nan", "positions that are not finite"),
        ("A 4 4 4", "A 4 4 1e31", "positions that are not finite, absent or above 1e.30, in frame 0"),
        ("A 4 4 4", "A 4 4 1e20", "has a position that is more than 1e.12 containers away"),
        ("species:S:1", "time=1e999999999 species:S:1", "has a time in frame 0"),
        ("A 4 4 4", "A 4 4 x", "cannot be read"),
        ("A 4 4 4\n", "", "is truncated: frame 0 has 1"),
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


WORDS = [word * 100_000 for word in ("xxxx", "a={", "a=[", 'a="', "a ", "=", "a=")]


@pytest.mark.parametrize("word", [*WORDS, "x" + " " * 300_000], ids=lambda word: word[:3])
def test_a_long_comment_is_read_at_once(tmp_path, word):
    """A pattern that is tried anew at each character would take hours."""
    path = xyz(tmp_path / "a.xyz", ROWS, more=word)
    assert read_frames(path, radius=0.5).count == 2


def test_frames_of_xyz_that_differ_are_refused(tmp_path):
    path = xyz(tmp_path / "a.xyz", ROWS, ["1 1 1"])
    refused(path, "has 1 particles in frame 1 and 2 in frame 0: a changing number", radius=0.5)
    path = xyz(tmp_path / "a.xyz", ROWS, ROWS)
    text = path.read_text()
    path.write_text(text[::-1].replace("3:R:sop", '"F F F"=cbp 3:R:sop', 1)[::-1])
    refused(path, "boundary in some frames only", radius=0.5)
    path.write_text(text[::-1].replace("1 1 1 A", "1 1 1 B", 1)[::-1])
    refused(path, "another order in frame 1", radius=0.5)


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
