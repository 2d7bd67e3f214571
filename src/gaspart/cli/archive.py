"""`gaspart archive`: the archive of a finished run of the workflow."""

from __future__ import annotations

import argparse

from gaspart.cli.arguments import Parser, add_output, config_command, print_line, set_command
from gaspart.cli.progress import waiting

_EXAMPLES = """examples:
  gaspart archive results -o archive.zip       # the full reproduction
  gaspart archive results/smoke -o smoke.zip   # of a config with `run: smoke`
  gaspart archive results -o all.zip --trajectories"""


def add_archive(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    text = (
        "A finished run of the workflow as one file to deposit, a Workflow Run RO-Crate: sources, config, "
        "locked environment, figures, captions, claims with the digests of their data, the digests of all "
        "trajectories, machine, and the time of each job. Title, creators and licence are those of "
        "CITATION.cff."
    )
    set_command(parser, _archive, text, _EXAMPLES)
    parser.add_argument("results", metavar="FOLDER", help="results, or results/<run>")
    add_output(parser, "ends in .zip", "an older archive")
    text = "the config of the run; default: the one in config, or above, that states its name"
    parser.add_argument("--config", metavar="FILE", help=text)
    text = "include the trajectories, not only their digests"
    parser.add_argument("--trajectories", action="store_true", help=text)


def _archive(given: argparse.Namespace) -> None:
    write = config_command("archive")
    with waiting("reading the results"):
        line = write(given.results, given.output, given.config, given.trajectories, given.force)
    print_line(line)
