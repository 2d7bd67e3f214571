"""`gaspart collisions`: a data set of the collisions of a scene."""

from __future__ import annotations

import argparse

from gaspart.cli.arguments import Commands, add_output, real, say, whole

_EXAMPLE = """
example:
    gaspart collisions scene.yaml -o collisions.nc --count 100000 --equilibration 10
"""


def add_collisions(commands: Commands) -> None:
    """Add the command to the others."""
    text = (
        "Run a scene under the event-driven engine and write down its collisions (netCDF): the bodies, the "
        "normal, the speed of approach, the time and path since each body's last event."
    )
    help_text = "a data set of collisions"
    parser = commands.add_parser("collisions", help=help_text, description=text, epilog=_EXAMPLE)
    parser.set_defaults(command=_collisions)
    add = parser.add_argument
    add("scene", metavar="SCENE")
    add_output(parser, "data set (netCDF)", "a data set of collisions")
    add("--count", type=whole(least=1), required=True, metavar="M", help="collisions, at least")
    text = "time before the first; default: 0"
    add("--equilibration", type=real(least=0.0), default=0.0, metavar="T", help=text)
    add("--seed", type=whole(least=0), default=0, metavar="N", help="default: 0")


def _collisions(given: argparse.Namespace) -> None:
    from gaspart.collisions import record_collisions
    from gaspart.scene import Scene

    scene = Scene.from_file(given.scene)
    data = record_collisions(
        scene, given.output, given.count, given.seed, given.equilibration, overwrite=given.force
    )
    paths = data["free_path"].mean().item()
    say(f"{given.output}: {data.sizes['collision']} collisions, mean free path {paths:.6g}")
