"""`gaspart collisions`: a data set of the collisions of a scene."""

from __future__ import annotations

import argparse

from gaspart.cli.arguments import Commands

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
    add("-o", "--output", required=True, metavar="FILE")
    add("--count", type=int, required=True, metavar="M", help="collisions, at least")
    add("--equilibration", type=float, default=0.0, metavar="T", help="time before the first; default: 0")
    add("--seed", type=int, default=0, metavar="N", help="default: 0")


def _collisions(given: argparse.Namespace) -> None:
    from gaspart.analysis.collisions import collision_data
    from gaspart.files import writing
    from gaspart.scene.scene import Scene

    scene = Scene.from_file(given.scene)
    data = collision_data(scene, given.count, given.seed, given.equilibration)
    with writing(given.output) as partial:
        data.to_netcdf(partial, engine="netcdf4", encoding={name: {"zlib": True} for name in data})
    paths = data["free_path"].mean().item()
    print(f"{given.output}: {data.sizes['collision']} collisions, mean free path {paths:.6g}")
