"""`gaspart export` and `gaspart collisions`: files for other programs."""

from __future__ import annotations

import argparse

from gaspart.cli.arguments import (
    Parser,
    add_output,
    add_trajectory,
    integer,
    print_line,
    print_note,
    real,
    set_command,
)
from gaspart.cli.progress import waiting
from gaspart.scene.scene import Scene

_EXAMPLES = """examples:
  gaspart export run.nc -o state.gsd              # last frame, for HOOMD
  gaspart export run.nc -o start.data --frame 0   # first frame, for LAMMPS
  gaspart export run.nc -o run.xyz --frame all   # each frame with its number"""


def add_export(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    text = (
        "A frame of a trajectory, or all, for other programs: GSD, extended XYZ, or LAMMPS data (atom_style "
        "sphere; one frame)."
    )
    set_command(parser, _export, text, _EXAMPLES)
    add_trajectory(parser)
    add_output(parser, "ends in .gsd, .xyz or .data", "an exported state")
    text = "counted from 0, or from the end if negative, or all; default: -1"
    parser.add_argument("--frame", type=_frame, default=-1, metavar="N", help=text)


def _frame(text: str) -> int | str:
    """Read a frame number, or the word "all"."""
    return text if text == "all" else integer()(text)


def _export(options: argparse.Namespace) -> None:
    from gaspart.trajectory.export import export
    from gaspart.trajectory.recipe import read_recipe

    path = export(options.trajectory, options.output, options.frame, options.force)
    print_line(path)
    print_note(conventions(read_recipe(options.trajectory).scene, path.suffix))


# Remarks on conventions of other programs for files of a scene, in a line of `info` and `export`. Each
# statement is documented in docs/tools.md or docs/conventions.md, and tested by the referees.


_SLAB = "g(r) of discs is theirs times 2 r / L_z, that of a slab"


def conventions(scene: Scene, suffix: str) -> str:
    """Return a remark for users of a scene's file in other programs; "" without a remark. The suffix is .nc
    for a trajectory, or the suffix of an exported file.
    """
    state = {".nc": _of_trajectory, ".gsd": _of_gsd, ".xyz": _of_xyz, ".data": _of_data}[suffix]
    remarks = "; ".join(state(scene))
    return f"in other programs: {remarks}" if remarks else ""


def _as_periodic(scene: Scene) -> list[str]:
    """Describe the axes whose walls a format cannot represent."""
    axes = zip("xyz", scene.container.periodic, strict=False)
    walled = ", ".join(axis for axis, periodic in axes if not periodic)
    return [f"walls across {walled} are read as periodic"] if walled else []


def _of_trajectory(scene: Scene) -> list[str]:
    remarks = _as_periodic(scene)
    if scene.dimension == 2:
        remarks.append(_SLAB)
    if scene.is_open:
        remarks.append("rows of NaN are numbers that no particle has")
    if scene.has_piston:
        remarks.append("positions are in the cell after subtraction of cell_origin")
    return remarks


def _of_gsd(scene: Scene) -> list[str]:
    return [*_as_periodic(scene), "g(r) of freud is smaller by (N - 1) / N"]


def _of_xyz(scene: Scene) -> list[str]:
    remarks = ["velocities are the property velo in ASE and chemfiles"]
    if not all(scene.container.periodic):
        remarks.append("chemfiles has no pbc")
    return remarks + ([_SLAB] if scene.dimension == 2 else [])


def _of_data(scene: Scene) -> list[str]:
    periodic = (*scene.container.periodic, True)[:3]
    flat = ", dimension 2" if scene.dimension == 2 else ""
    remarks = [f"LAMMPS needs boundary {' '.join('p' if along else 'f' for along in periodic)}{flat}"]
    if not any(scene.container.periodic):
        remarks.append("its temp is larger by N / (N - 1)")
    return remarks


_EXAMPLE = """example:
  gaspart collisions scene.yaml -o met.nc --count 100000 --equilibration 10"""


def add_collisions(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    text = (
        "Run a scene under the event-driven engine and record its collisions (netCDF): the particles, the "
        "normal, the speed of approach, the time and path since each particle's last event."
    )
    set_command(parser, _collisions, text, _EXAMPLE)
    add = parser.add_argument
    add("scene", help="scene file (YAML)")
    add_output(parser, "data set (netCDF)", "a data set of collisions")
    add("--count", type=integer(least=1), required=True, metavar="M", help="least number of collisions")
    text = "time before the first of them; default: 0"
    add("--equilibration", type=real(least=0.0), default=0.0, metavar="T", help=text)
    add("--seed", type=integer(least=0), default=0, metavar="N", help="default: 0")


def _collisions(options: argparse.Namespace) -> None:
    from gaspart.analysis.collisions import record_collisions

    scene = Scene.from_file(options.scene)
    with waiting("recording collisions; the first time, compiling kernels"):
        data = record_collisions(
            scene, options.output, options.count, options.seed, options.equilibration, overwrite=options.force
        )
    path = data.attrs["mean_free_path"]
    print_line(f"{options.output}: {data.sizes['collision']} collisions, mean free path {path:.6g}")
