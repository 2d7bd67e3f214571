"""`gaspart collisions`: data set of the collisions of a scene."""

from __future__ import annotations

import argparse

from gaspart.cli.arguments import Parser, add_output, integer, print_line, real, set_command
from gaspart.cli.progress import waiting
from gaspart.scene.scene import Scene

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
