"""The line on conventions of other programs: on stderr of `export`, and in `info`."""

import errno
import io
import os
import re

import pytest

import gaspart as gp
from gaspart.cli import main
from gaspart.cli.export import conventions

BALL = gp.Species(count=20, radius=0.4, temperature=1.0)
AT_WALLS = gp.Container(lengths=(8.0, 6.0, 6.0), boundary=("wall", "periodic", "periodic"))
SCENES = {
    "periodic": gp.Scene(container=gp.Container((6.0,) * 3, boundary="periodic"), species=[BALL]),
    "walls": gp.Scene(container=gp.Container((6.0,) * 3, boundary="wall"), species=[BALL]),
    "discs": gp.Scene(container=gp.Container((8.0, 6.0), boundary=("periodic", "wall")), species=[BALL]),
    "open": gp.Scene(
        container=AT_WALLS,
        species=[BALL],
        faces={"x_low": gp.Open(activity=0.01, temperature=1.0)},
        centres_to_walls=True,
    ),
    "piston": gp.Scene(
        container=AT_WALLS, species=[BALL], faces={"x_high": gp.Piston(mass=10.0, pressure=0.5)}
    ),
}
SLAB = "g(r) of discs is theirs times 2 r / L_z, that of a slab"
FREUD = "g(r) of freud is smaller by (N - 1) / N"
VELO = "velocities are the property velo in ASE and chemfiles"
LINES = {
    ("periodic", ".nc"): [],
    ("discs", ".nc"): ["walls across y are read as periodic", SLAB],
    ("open", ".nc"): ["walls across x are read as periodic", "rows of NaN are numbers that no particle has"],
    ("piston", ".nc"): [
        "walls across x are read as periodic",
        "positions are in the cell after subtraction of cell_origin",
    ],
    ("discs", ".gsd"): ["walls across y are read as periodic", FREUD],
    ("periodic", ".xyz"): [VELO],
    ("discs", ".xyz"): [VELO, "chemfiles has no pbc", SLAB],
    ("periodic", ".data"): ["LAMMPS needs boundary p p p"],
    ("walls", ".data"): ["LAMMPS needs boundary f f f", "its temp is larger by N / (N - 1)"],
    ("discs", ".data"): ["LAMMPS needs boundary p f p, dimension 2"],
}


@pytest.mark.parametrize(("name", "suffix"), LINES, ids=lambda part: part.strip("."))
def test_a_line_states_what_concerns_the_file(name, suffix):
    found = conventions(SCENES[name], suffix)
    parts = LINES[name, suffix]
    assert found == ("in other programs: " + "; ".join(parts) if parts else "")


@pytest.fixture
def walled(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return gp.run(SCENES["walls"], gp.EventDriven(), 1, 1.0, 0.5, "run.nc")


@pytest.mark.interpreted
@pytest.mark.parametrize("suffix", [".gsd", ".xyz", ".data"])
def test_scripts_read_the_path_alone(walled, capsys, suffix):
    assert main(["export", "run.nc", "-o", f"state{suffix}"]) == 0
    printed = capsys.readouterr()
    assert printed.out == f"state{suffix}\n"
    assert printed.err == f"gaspart: {conventions(SCENES['walls'], suffix)}\n"


@pytest.mark.interpreted
def test_info_has_the_line_of_the_trajectory(walled, capsys):
    assert main(["info", "run.nc"]) == 0
    assert re.search("^in other programs: walls across x, y, z are read", capsys.readouterr().out, re.M)
    gp.run(SCENES["periodic"], gp.EventDriven(), 1, 1.0, 0.5, "periodic.nc")
    assert main(["info", "periodic.nc"]) == 0
    assert "in other programs" not in capsys.readouterr().out


class Full(io.StringIO):
    """A stream on a full disk."""

    def write(self, text):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@pytest.mark.interpreted
def test_a_stderr_that_takes_nothing_does_not_make_an_export_fail(walled, capsys, monkeypatch):
    monkeypatch.setattr("sys.stderr", Full())
    assert main(["export", "run.nc", "-o", "state.data"]) == 0
    monkeypatch.undo()
    assert capsys.readouterr().out == "state.data\n"
