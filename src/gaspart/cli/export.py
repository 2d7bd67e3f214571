"""`gaspart export`: a state for other programs."""

from __future__ import annotations

import argparse

from gaspart.cli.arguments import Commands, add_output, say, whole

_EXAMPLES = """examples:
  gaspart export run.nc -o state.gsd                the last frame, for HOOMD and OVITO
  gaspart export run.nc -o start.data --frame 0     the first, for LAMMPS: read_data start.data"""


def add_export(commands: Commands) -> None:
    """Add the command to the others."""
    text = "One frame of a trajectory as a state for other programs: GSD, or LAMMPS data (atom_style sphere)."
    export = commands.add_parser(
        "export", help="a state for other programs", description=text, epilog=_EXAMPLES
    )
    export.set_defaults(command=_export)
    export.add_argument("trajectory", metavar="FILE")
    add_output(export, "ends in .gsd or .data", "a state that was exported")
    text = "counted from 0, or from the end if negative; default: -1"
    export.add_argument("--frame", type=whole(), default=-1, metavar="N", help=text)


def _export(given: argparse.Namespace) -> None:
    from gaspart.exports import export

    say(export(given.trajectory, given.output, given.frame, given.force))
