"""`gaspart verify`: whether an archive is what it was, and simulates to the same bits."""

from __future__ import annotations

import argparse

from gaspart.cli.arguments import CheckFailed, Parser, config_command, integer, print_line, set_command
from gaspart.cli.progress import waiting

_EXAMPLES = """examples:
  gaspart verify archive.zip
  gaspart verify archive.zip --rerun 3   # and three points simulated again
  gaspart verify unpacked/               # a folder into which it was unpacked

exit code: 0 if all checks pass, 1 if one fails, 2 if the file is no archive"""


def add_verify(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    text = (
        "Recompute the digests of an archive of `gaspart archive`: of its files, and of the data that its "
        "claims are made of. With --rerun points drawn at random are simulated again, and compared bit for "
        "bit. Nothing is written but to a temporary folder and the cache of kernels."
    )
    set_command(parser, _verify, text, _EXAMPLES)
    parser.add_argument(
        "archive", metavar="ARCHIVE", help="an archive (.zip), or the folder of an unpacked one"
    )
    text = "number of points to simulate again; default: 0"
    parser.add_argument("--rerun", type=integer(least=0), default=0, metavar="N", help=text)


def _verify(given: argparse.Namespace) -> None:
    checks = iter(config_command("verify")(given.archive, given.rerun))
    failed = False
    while True:
        with waiting("reading the archive, or simulating a point; the first time, compiling kernels"):
            check = next(checks, None)
        if check is None:
            break
        print_line(check)
        failed |= not check.passed
    if failed:
        raise CheckFailed
