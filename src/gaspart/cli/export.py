"""`gaspart export`: states and trajectories for other programs."""

from __future__ import annotations

import argparse

from gaspart.cli.arguments import (
    Parser,
    add_output,
    add_trajectory,
    integer,
    print_line,
    print_note,
    set_command,
)

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
    """Read a number, or the word all."""
    return text if text == "all" else integer()(text)


def _export(options: argparse.Namespace) -> None:
    from gaspart.cli.conventions import conventions
    from gaspart.trajectory.export import export
    from gaspart.trajectory.recipe import read_recipe

    path = export(options.trajectory, options.output, options.frame, options.force)
    print_line(path)
    print_note(conventions(read_recipe(options.trajectory).scene, path.suffix))
